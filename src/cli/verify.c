/* rheolog verify: simulates recordings again and compares every step, as tests with golden recordings do. */
#include <string.h>

#include "cli/verdicts.h"
#include "cli/shell.h"

static void print_json(const char *file, const rheo_verification *v)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", file);
    if (v->has_hash)
        rheo__json_hash(&json, "hash", v->hash);
    else
        rheo__json_null(&json, "hash");
    cli_verification_json(&json, v);
    rheo__json_end_object(&json);
}

/* Whether a recording has no values because it was made without --full. */
static bool has_hashes_only(const char *file)
{
    rheo_recording *recording;
    if (rheo_recording_open(file, &recording, NULL) != RHEO_OK)
        return false;
    const bool full = rheo_recording_get_info(recording).full;
    rheo_recording_close(recording);
    return !full;
}

static void print_next(const char *file, const rheo_difference *d)
{
    if (d->stage[0] && d->step > 0) {
        cli_print_command("  next: look at the last state that agrees:\n    rheolog inspect", file);
        printf(" --step %llu", (unsigned long long)d->step - 1);
        cli_print_particle(d);
        putchar('\n');
    } else {
        puts("  next: all stages agree, but a stored state does not fit them: restore the file from version control");
    }
    if (d->stage[0] && d->origin == RHEO_VALUES_NONE && has_hashes_only(file)) {
        cli_print_command("  or, for the values, make it again by the build that made it, and verify that:\n"
                          "    rheolog rerecord",
                          file);
        puts(" --full -o full.rlog\n    rheolog verify full.rlog");
    }
    cli_print_command("  or, if the change is meant, record it again with this build and accept that:\n"
                      "    rheolog rerecord",
                      file);
    cli_print_command(" -o new.rlog\n    rheolog bless", file);
    puts(" new.rlog --because \"...\"");
    cli_print_command("  is it only rounding, and are the statistics the same?\n    rheolog same", file);
    putchar('\n');
}

static void print_text(const char *file, const rheo_verification *v)
{
    cli_print(stdout, 4, "%s: %s\n", file, v->message); /* the message begins with the verdict */
    if (v->verdict != RHEO_DIFFERS)
        return;
    cli_growth_text(v);
    print_next(file, &v->first);
}

/* Adds how to go on with a run to the message about its truncated recording. */
static void add_continue(const char *file, rheo_verification *v)
{
    rheo_recording *recording;
    if (v->verdict != RHEO_UNREADABLE || rheo_recording_open(file, &recording, NULL) != RHEO_OK)
        return;
    const size_t length = strlen(v->message);
    if (cli_can_continue(recording))
        snprintf(v->message + length, sizeof v->message - length, "%s", CLI_CONTINUE);
    rheo_recording_close(recording);
}

/* Verifies a file. A file that cannot be read has a verdict, too. */
static cli_outcome verify(const char *file, rheo_verification *v)
{
    rheo_error error = {""};
    memset(v, 0, sizeof *v);
    if (!cli_is_file(file, &error)) {
        v->verdict = RHEO_UNREADABLE;
        snprintf(v->message, sizeof v->message, "unreadable: %s", error.message);
        return CLI_OUTCOME_UNREADABLE;
    }
    cli_watch_name(file);
    const rheo_result result = rheo_verify(file, v, &error);
    cli_watch_end();
    add_continue(file, v);
    return result == RHEO_OK ? cli_outcome_of(v->verdict) : cli_outcome_of_error(result, &error, v);
}

/* Verifies a file, prints the result and adds it to the report. */
static int verify_and_report(cli_verdicts *report, const char *file)
{
    rheo_verification v = {0};
    if (report->of[CLI_OUTCOME_INTERRUPTED]) {
        snprintf(v.message, sizeof v.message, "not compared: interrupted before");
        if (report->json)
            print_json(file, &v);
        return cli_verdicts_add(report, file, file, CLI_OUTCOME_INTERRUPTED, &v, 0);
    }
    const double start = cli_now();
    const cli_outcome outcome = verify(file, &v);
    if (report->json)
        print_json(file, &v);
    else if (!report->tap)
        print_text(file, &v);
    return cli_verdicts_add(report, file, file, outcome, &v, cli_now() - start);
}

static int run(int argc, char **argv)
{
    const char *simd = NULL;
    cli_verdicts report = {.command = "verify", .items = "recordings"};
    const cli_option options[] = {
        {"--json", NULL, NULL, CLI_FLAG, &report.json},     {"--tap", NULL, NULL, CLI_FLAG, &report.tap},
        {"--junit", NULL, "FILE", CLI_TEXT, &report.junit}, {"--github", NULL, NULL, CLI_FLAG, &report.github},
        {"--simd", NULL, "NAME", CLI_TEXT, &simd},          {0},
    };
    int status = cli_parse(&cli_verify, options, &argc, argv);
    if (status != CLI_GO_ON || (status = cli_use_simd(simd)) != CLI_DONE)
        return status;
    if (argc == 0)
        return cli_usage(&cli_verify, "no recordings given: nothing was verified");
    if ((status = cli_verdicts_begin(&report, (size_t)argc)) != CLI_DONE)
        return status;
    cli_watch_signals();
    for (int i = 0; i < argc && status == CLI_DONE; i++)
        status = verify_and_report(&report, argv[i]);
    const int end = cli_verdicts_end(&report);
    return status == CLI_DONE ? end : status;
}

static const char help[] = {
#include "cli/help/verify.txt.inc"
    0};

const cli_command cli_verify = {"verify", help, run};
