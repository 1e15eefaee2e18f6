/* Texts of a page. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <math.h>
#include <string.h>

#include "cli/shell.h"

bool cli_page_begin(cli_page_text *text)
{
    text->file = open_memstream(&text->at, &text->size);
    return text->file != NULL;
}

bool cli_page_end(cli_page_text *text)
{
    const bool failed = ferror(text->file) != 0;
    const bool closed = fclose(text->file) == 0;
    text->file = NULL;
    return closed && !failed;
}

int cli_page_no_memory(void)
{
    return cli_fail(CLI_SYSTEM, "no memory for the report");
}

void cli_page_put(FILE *file, const char *text)
{
    for (const char *c = text; *c;) {
        const size_t length = rheo_printable_length(c);
        const char *name = *c == '<'    ? "&lt;"
                           : *c == '>'  ? "&gt;"
                           : *c == '&'  ? "&amp;"
                           : *c == '"'  ? "&quot;"
                           : *c == '\'' ? "&#39;"
                                        : NULL;
        if (name)
            fputs(name, file);
        else if (length)
            fwrite(c, 1, length, file);
        else
            fputs((unsigned char)*c < 0x20 || *c == 0x7f ? " " : "\xef\xbf\xbd", file);
        c += length ? length : 1;
    }
}

void cli_page_put_number(FILE *file, double value, int digits)
{
    char text[32];
    fputs(isfinite(value) ? rheo_number_brief(value, digits, text)
          : isnan(value)  ? "NaN"
          : value < 0     ? "-inf"
                          : "inf",
          file);
}

void cli_page_put_link(FILE *file, uint64_t step, const char *stage, int64_t particle)
{
    fprintf(file, "<a href=\"#step=%llu", (unsigned long long)step);
    if (stage[0]) {
        fputs("&amp;stage=", file);
        cli_page_put(file, stage);
    }
    if (particle >= 0)
        fprintf(file, "&amp;particle=%lld", (long long)particle);
    fputs("\">", file);
}

void cli_page_put_command(FILE *file, const char *begin, const char *name, const char *end)
{
    char word[CLI_FILE_WORD];
    fprintf(file, "<code>%s ", begin);
    cli_page_put(file, cli_file_word(name, word));
    fprintf(file, "%s</code>", end);
}
