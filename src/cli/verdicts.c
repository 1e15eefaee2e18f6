/* Collects the outcomes of `verify` and `diff`, and prints totals, TAP and annotations of GitHub (verdicts.h). */
#define _POSIX_C_SOURCE 200809L
#include "cli/verdicts.h"

#include <stdlib.h>
#include <string.h>

cli_outcome cli_outcome_of(rheo_verdict verdict)
{
    return verdict == RHEO_SAME      ? CLI_OUTCOME_SAME
           : verdict == RHEO_DIFFERS ? CLI_OUTCOME_DIFFERS
                                     : CLI_OUTCOME_UNREADABLE;
}

const char *cli_outcome_name(cli_outcome outcome)
{
    static const char *const NAMES[] = {"same", "differs", "unreadable", "failed", "interrupted"};
    return NAMES[outcome];
}

cli_outcome cli_outcome_of_error(rheo_result result, const rheo_error *error, rheo_verification *v)
{
    if (result == RHEO_ERROR_STOPPED) {
        snprintf(v->message, sizeof v->message, "interrupted after %llu step%s: same so far",
                 (unsigned long long)v->steps, cli_plural(v->steps));
        return CLI_OUTCOME_INTERRUPTED;
    }
    snprintf(v->message, sizeof v->message, "failed: %.500s", error->message);
    return CLI_OUTCOME_FAILED;
}

int cli_verdicts_begin(cli_verdicts *report, size_t room)
{
    if (report->json && report->tap)
        return cli_fail(CLI_BAD, "--json and --tap both go to standard output; give one of them");
    if (report->junit) {
        const int status = cli_check_junit(report->junit);
        if (status != CLI_DONE)
            return status;
        remove(report->junit);
    }
    report->room = room;
    report->cases = calloc(room, sizeof *report->cases);
    if (!report->cases)
        return cli_fail(CLI_SYSTEM, "no memory");
    if (report->tap)
        printf("TAP version 13\n1..%zu\n", room);
    return CLI_DONE;
}

/* ---- TAP ---- */

/* A description ends at a #, and a line cannot have control characters. */
static void put_description(const char *text)
{
    for (; *text; text++) {
        if (*text == '#' || *text == '\\')
            putchar('\\');
        putchar((unsigned char)*text < ' ' ? '?' : *text);
    }
}

static void put_string(const char *key, const char *text)
{
    rheo__json json = {.file = stdout}; /* a string of JSON is one of YAML */
    printf("  %s: ", key);
    rheo__json_text(&json, NULL, text);
    putchar('\n');
}

static void print_tap(const cli_verdicts *report, const cli_case *c, const rheo_verification *v)
{
    printf("%s %zu - ", c->outcome == CLI_OUTCOME_SAME ? "ok" : "not ok", report->count);
    put_description(c->name);
    puts("\n  ---");
    put_string("verdict", cli_outcome_name(c->outcome));
    put_string("message", c->message);
    printf("  steps: %llu\n", (unsigned long long)v->steps);
    if (c->outcome == CLI_OUTCOME_DIFFERS) {
        const rheo_difference *d = &v->first;
        printf("  step: %llu\n", (unsigned long long)d->step);
        put_string("stage", d->stage);
        put_string("field", d->field);
        if (d->origin != RHEO_VALUES_NONE) {
            char expected[32], actual[32];
            rheo__number_text(d->expected, expected, sizeof expected);
            rheo__number_text(d->actual, actual, sizeof actual);
            printf("  id: %llu\n  component: %u\n", (unsigned long long)d->id, d->component);
            put_string("wanted", expected);
            put_string("found", actual);
        }
    }
    printf("  duration_ms: %.3f\n  ...\n", 1000 * c->seconds);
}

/* ---- Annotations of GitHub ---- */

/* Escapes what would end the value of a property or a message. */
static void put_escaped(const char *text, bool property)
{
    for (; *text; text++)
        if (*text == '%' || (unsigned char)*text < ' ' || (property && (*text == ':' || *text == ',')))
            fprintf(stderr, "%%%02X", (unsigned)(unsigned char)*text);
        else
            fputc(*text, stderr);
}

static void print_annotation(const cli_verdicts *report, const cli_case *c)
{
    fputs("::error file=", stderr);
    put_escaped(c->file, true);
    fprintf(stderr, ",title=rheolog %s::", report->command);
    put_escaped(c->name, false);
    fputs(": ", stderr);
    put_escaped(c->message, false);
    fputc('\n', stderr);
}

/* ---- Cases ---- */

/* The growth of a difference, one line a step and field. NULL: none, or no memory. */
static char *describe_growth(const rheo_verification *v)
{
    const size_t line = 160, size = line * ((size_t)v->growth_count + 1);
    char *text = v->growth_count ? malloc(size) : NULL;
    size_t length = 0;
    for (uint32_t i = 0; text && i < v->growth_count; i++) {
        const rheo_growth *g = &v->growth[i];
        length += (size_t)snprintf(text + length, line, "end of step %llu: %llu item%s of %s differ%s\n",
                                   (unsigned long long)g->step, (unsigned long long)g->count, cli_plural(g->count),
                                   g->field, g->count == 1 ? "s" : "");
    }
    return text;
}

int cli_verdicts_add(cli_verdicts *report, const char *name, const char *file, cli_outcome outcome,
                     const rheo_verification *v, double seconds)
{
    cli_case *c = &report->cases[report->count++];
    *c = (cli_case){.name = strdup(name),
                    .file = strdup(file),
                    .message = strdup(v->message),
                    .details = outcome == CLI_OUTCOME_DIFFERS ? describe_growth(v) : NULL,
                    .outcome = outcome,
                    .seconds = seconds};
    report->of[outcome]++;
    if (!c->name || !c->file || !c->message)
        return cli_fail(CLI_SYSTEM, "no memory for the report");
    if (report->tap)
        print_tap(report, c, v);
    if (report->github && outcome != CLI_OUTCOME_SAME)
        print_annotation(report, c);
    fflush(stdout); /* the next file may take minutes */
    return CLI_DONE;
}

static void print_totals(const cli_verdicts *report)
{
    printf("%zu %s: %zu same, %zu differ%s, %zu unreadable", report->count, report->items,
           report->of[CLI_OUTCOME_SAME], report->of[CLI_OUTCOME_DIFFERS],
           report->of[CLI_OUTCOME_DIFFERS] == 1 ? "s" : "", report->of[CLI_OUTCOME_UNREADABLE]);
    for (cli_outcome o = CLI_OUTCOME_FAILED; o < CLI_OUTCOMES; o++)
        if (report->of[o])
            printf(", %zu %s", report->of[o], cli_outcome_name(o));
    putchar('\n');
}

int cli_verdicts_end(cli_verdicts *report)
{
    int status = report->of[CLI_OUTCOME_INTERRUPTED]  ? CLI_INTERRUPTED
                 : report->of[CLI_OUTCOME_FAILED]     ? CLI_SYSTEM
                 : report->of[CLI_OUTCOME_UNREADABLE] ? CLI_BAD
                 : report->of[CLI_OUTCOME_DIFFERS]    ? CLI_DIFFERS
                                                      : CLI_DONE;
    if (report->count > 1 && !report->json && !report->tap)
        print_totals(report);
    if (report->junit && cli_junit_write(report, report->junit) != CLI_DONE)
        status = CLI_SYSTEM;
    for (size_t i = 0; i < report->count; i++) {
        free(report->cases[i].name);
        free(report->cases[i].file);
        free(report->cases[i].message);
        free(report->cases[i].details);
    }
    free(report->cases);
    return status;
}
