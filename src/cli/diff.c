/* rheolog diff: prints the first difference of two recordings, and how it grows. */
#include <string.h>

#include "cli/pairs.h"
#include "cli/provenance.h"
#include "cli/verdicts.h"
#include "cli/shell.h"
#include "json/json_parameter.h"

static void print_json(const char *const path[2], const rheo_verification *v)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "a", path[0]);
    rheo__json_text(&json, "b", path[1]);
    cli_verification_json(&json, v);
    cli_lengths_json(&json, v);
    rheo__json_known_integer(&json, "commands_step", v->commands_differ, v->commands_step);
    if (v->commands_differ) {
        cli_commands_json(&json, "commands_a", path[0], v->commands_step);
        cli_commands_json(&json, "commands_b", path[1], v->commands_step);
    }
    if (v->has_cause)
        cli_difference_json(&json, "cause", &v->cause);
    else
        rheo__json_null(&json, "cause");
    rheo__json_begin_list(&json, "parameters");
    for (uint32_t i = 0; i < v->parameter_count; i++) {
        const rheo_parameter_difference *d = &v->parameters[i];
        rheo__json_begin_object(&json, NULL);
        rheo__json_text(&json, "path", d->parameter->path);
        rheo__json_parameter(&json, "a", d->parameter, d->a);
        rheo__json_parameter(&json, "b", d->parameter, d->b);
        rheo__json_end_object(&json);
    }
    rheo__json_end_list(&json);
    rheo__json_end_object(&json);
}

static void print_cause(const rheo_verification *v)
{
    const rheo_difference *d = &v->cause;
    char values[160] = "";
    if (d->origin != RHEO_VALUES_NONE)
        snprintf(values, sizeof values, " (item %llu, component %u: %.9g, %.9g; %llu differ)",
                 (unsigned long long)d->id, d->component, d->expected, d->actual, (unsigned long long)d->count);
    cli_print(stdout, 4, "  from the same state, the parameters first show in step %llu: %s after stage %s%s\n",
              (unsigned long long)d->step, d->field, d->stage, values);
}

/* Whether this build reaches the state after a stage of a step, or at the end of the step if `stage` is NULL. */
static bool can_inspect(const char *path, uint64_t step, const char *stage)
{
    rheo_recording *recording;
    rheo_player *player = NULL;
    if (rheo_recording_open(path, &recording, NULL) != RHEO_OK)
        return false;
    rheo_result result = rheo_player_open(recording, NULL, &player, NULL);
    if (result == RHEO_OK)
        result = stage ? rheo_player_seek_stage(player, step, stage, NULL) : rheo_player_seek(player, step, NULL);
    rheo_player_close(player);
    rheo_recording_close(recording);
    return result == RHEO_OK;
}

/* Suggests the nearest state that this build reproduces: right there in one recording, or the last that agrees. */
static void print_next(const char *const path[2], const rheo_difference *d)
{
    if (d->step == 0 || !d->stage[0])
        return;
    for (int i = 0; i < 2; i++)
        if (can_inspect(path[i], d->step, d->stage)) {
            cli_print_command("  next: look at the state right there:\n    rheolog inspect", path[i]);
            printf(" --step %llu --stage %s", (unsigned long long)d->step, d->stage);
            cli_print_particle(d);
            putchar('\n');
            return;
        }
    for (int i = 0; i < 2; i++)
        if (can_inspect(path[i], d->step - 1, NULL)) {
            cli_print_command(
                "  next: this build reproduces neither of them there; look at the last state that agrees:\n"
                "    rheolog inspect",
                path[i]);
            printf(" --step %llu", (unsigned long long)d->step - 1);
            cli_print_particle(d);
            putchar('\n');
            return;
        }
    if (cli_interrupted())
        return;
    cli_print_command(
        "  next: this build reproduces neither of them; see what they were made with:\n    rheolog info", path[0]);
    cli_print_command("", path[1]);
    putchar('\n');
}

static void print_text(const char *const path[2], const rheo_verification *v)
{
    cli_print(stdout, 4, "%s, %s: %s\n", path[0], path[1], v->message);
    if (v->verdict != RHEO_SAME && v->verdict != RHEO_DIFFERS)
        return;
    if (v->parameter_count)
        puts("  parameters at the start that differ:");
    for (uint32_t i = 0; i < v->parameter_count; i++)
        printf("    %s = %s in the first, %s in the second\n", v->parameters[i].parameter->path, v->parameters[i].a,
               v->parameters[i].b);
    if (v->verdict == RHEO_SAME)
        return;
    if (v->commands_differ) {
        printf("  the commands given before step %llu differ:\n", (unsigned long long)v->commands_step);
        cli_commands_text(path[0], v->commands_step, "first");
        cli_commands_text(path[1], v->commands_step, "second");
    }
    if (v->has_cause)
        print_cause(v);
    cli_growth_text(v);
    print_next(path, &v->first);
}

/* Compares two files. A file that cannot be read has a verdict, too. */
static cli_outcome compare(const char *const path[2], bool common, rheo_verification *v)
{
    rheo_error error = {""};
    memset(v, 0, sizeof *v);
    for (int i = 0; i < 2; i++)
        if (!cli_is_file(path[i], &error)) {
            v->verdict = RHEO_UNREADABLE;
            snprintf(v->message, sizeof v->message, "unreadable: %s", error.message);
            return CLI_OUTCOME_UNREADABLE;
        }
    cli_watch_name(path[1]);
    const rheo_result result = rheo_diff(path[0], path[1], v, &error);
    cli_watch_end();
    if (result == RHEO_OK && common)
        cli_accept_lengths(v);
    return result == RHEO_OK ? cli_outcome_of(v->verdict) : cli_outcome_of_error(result, &error, v);
}

static int compare_pair(cli_verdicts *report, const cli_pair *pair, bool common)
{
    const char *const path[2] = {pair->a, pair->b};
    char name[2 * 4096 + 8];
    snprintf(name, sizeof name, "%.4095s, %.4095s", path[0], path[1]);
    rheo_verification v = {0};
    if (report->of[CLI_OUTCOME_INTERRUPTED]) {
        snprintf(v.message, sizeof v.message, "not compared: interrupted before");
        if (report->json)
            print_json(path, &v);
        return cli_verdicts_add(report, name, path[0], CLI_OUTCOME_INTERRUPTED, &v, 0);
    }
    const double start = cli_now();
    const cli_outcome outcome = compare(path, common, &v);
    if (report->json)
        print_json(path, &v);
    else if (!report->tap)
        print_text(path, &v);
    return cli_verdicts_add(report, name, path[0], outcome, &v, cli_now() - start);
}

static int run(int argc, char **argv)
{
    bool common = false;
    cli_verdicts report = {.command = "diff", .items = "pairs"};
    const cli_option options[] = {
        {"--common", NULL, NULL, CLI_FLAG, &common},        {"--json", NULL, NULL, CLI_FLAG, &report.json},
        {"--tap", NULL, NULL, CLI_FLAG, &report.tap},       {"--junit", NULL, "FILE", CLI_TEXT, &report.junit},
        {"--github", NULL, NULL, CLI_FLAG, &report.github}, {0},
    };
    int status = cli_parse(&cli_diff, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    cli_pairs pairs = {0};
    if ((status = cli_find_pairs(&cli_diff, argc, argv, &pairs)) == CLI_DONE &&
        (status = cli_verdicts_begin(&report, pairs.count)) == CLI_DONE) {
        cli_watch_signals();
        for (size_t i = 0; i < pairs.count && status == CLI_DONE; i++)
            status = compare_pair(&report, &pairs.pair[i], common);
        const int end = cli_verdicts_end(&report);
        status = status == CLI_DONE ? end : status;
    }
    cli_release_pairs(&pairs);
    return status;
}

static const char help[] = {
#include "cli/help/diff.txt.inc"
    0};

const cli_command cli_diff = {"diff", help, run};
