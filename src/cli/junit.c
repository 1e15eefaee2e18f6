/*
 * Writes JUnit XML: one test suite, one test case for each file. A difference is a <failure>, a file that cannot be
 * compared an <error>.
 */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/verdicts.h"

int cli_check_junit(const char *path)
{
    struct stat status = {0};
    char start = '<';
    if (!*path || strcmp(path, "-") == 0)
        return cli_fail(CLI_BAD, "--junit needs the name of a file; got \"%s\"", path);
    if (lstat(path, &status) == 0) {
        FILE *file = S_ISREG(status.st_mode) ? fopen(path, "rb") : NULL;
        /* `verify --junit *.rlog` must not replace the first recording. */
        const bool xml = file && (fread(&start, 1, 1, file) == 0 || start == '<');
        if (file)
            fclose(file);
        if (!xml)
            return cli_fail(CLI_BAD, "--junit does not replace %s, which is not XML; give another name", path);
    }
    return cli_check_folder(path);
}

/* Writes text, of an attribute or an element. XML has no way to write most control characters. */
static void put(FILE *file, const char *text)
{
    while (*text) {
        const size_t length = rheo_printable_length(text);
        if (strchr("&<>\"'\n\r\t", *text))
            fprintf(file, "&#%d;", *text);
        else if (length == 0 && (unsigned char)*text < 0x80)
            fputc('?', file);
        else if (length == 0)
            fputs("\xef\xbf\xbd", file); /* U+FFFD */
        else if (length == 3 && memcmp(text, "\xef\xbf", 2) == 0 && (unsigned char)text[2] >= 0xbe)
            fputc('?', file); /* U+FFFE and U+FFFF are no characters */
        else
            fwrite(text, 1, length, file);
        text += length ? length : 1;
    }
}

static void put_attribute(FILE *file, const char *name, const char *value)
{
    fprintf(file, " %s=\"", name);
    put(file, value);
    fputc('"', file);
}

static void put_case(FILE *file, const cli_verdicts *report, const cli_case *c)
{
    fputs("    <testcase", file);
    fprintf(file, " classname=\"rheolog.%s\"", report->command);
    put_attribute(file, "name", c->name);
    put_attribute(file, "file", c->file);
    fprintf(file, " time=\"%.6f\"", c->seconds);
    if (c->outcome == CLI_OUTCOME_SAME) {
        fputs("/>\n", file);
        return;
    }
    const char *element = c->outcome == CLI_OUTCOME_DIFFERS ? "failure" : "error";
    fprintf(file, ">\n      <%s type=\"%s\"", element, cli_outcome_name(c->outcome));
    put_attribute(file, "message", c->message);
    fputc('>', file);
    put(file, c->message);
    if (c->details) {
        put(file, "\n");
        put(file, c->details);
    }
    fprintf(file, "</%s>\n    </testcase>\n", element);
}

static void put_report(FILE *file, const void *of)
{
    const cli_verdicts *report = of;
    double seconds = 0;
    for (size_t i = 0; i < report->count; i++)
        seconds += report->cases[i].seconds;
    const size_t failures = report->of[CLI_OUTCOME_DIFFERS];
    const size_t errors = report->count - report->of[CLI_OUTCOME_SAME] - failures;
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", file);
    fprintf(file, "<testsuites tests=\"%zu\" failures=\"%zu\" errors=\"%zu\" time=\"%.6f\">\n", report->count,
            failures, errors, seconds);
    fprintf(file,
            "  <testsuite name=\"rheolog %s\" tests=\"%zu\" failures=\"%zu\" errors=\"%zu\" skipped=\"0\" "
            "time=\"%.6f\">\n",
            report->command, report->count, failures, errors, seconds);
    for (size_t i = 0; i < report->count; i++)
        put_case(file, report, &report->cases[i]);
    fputs("  </testsuite>\n</testsuites>\n", file);
}

int cli_junit_write(const cli_verdicts *report, const char *path)
{
    return cli_write_file(path, put_report, report);
}
