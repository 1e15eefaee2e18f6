/* rheolog diff: prints the first difference of two recordings, and how it grows. */
#include "cli/cli.h"

#include <string.h>

#include "cli/provenance.h"
#include "json/json_parameter.h"

static void print_json(const char *const path[2], const rheo_verification *v)
{
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "a", path[0]);
    cli_json_text(&json, "b", path[1]);
    cli_verification_json(&json, v);
    cli_lengths_json(&json, v);
    if (v->commands_differ)
        cli_json_integer(&json, "commands_step", v->commands_step);
    else
        cli_json_null(&json, "commands_step");
    if (v->commands_differ) {
        cli_commands_json(&json, "commands_a", path[0], v->commands_step);
        cli_commands_json(&json, "commands_b", path[1], v->commands_step);
    }
    if (v->has_cause)
        cli_difference_json(&json, "cause", &v->cause);
    else
        cli_json_null(&json, "cause");
    cli_json_begin_list(&json, "parameters");
    for (uint32_t i = 0; i < v->parameter_count; i++) {
        const rheo_parameter_difference *d = &v->parameters[i];
        cli_json_begin_object(&json, NULL);
        cli_json_text(&json, "path", d->parameter->path);
        cli_json_parameter(&json, "a", d->parameter, d->a);
        cli_json_parameter(&json, "b", d->parameter, d->b);
        cli_json_end_object(&json);
    }
    cli_json_end_list(&json);
    cli_json_end_object(&json);
}

static void print_cause(const rheo_verification *v)
{
    const rheo_difference *d = &v->cause;
    printf("  from the same state, the parameters first show in step %llu: %s after stage %s",
           (unsigned long long)d->step, d->field, d->stage);
    if (d->origin != RHEO_VALUES_NONE)
        printf(" (item %llu, component %u: %.9g, %.9g; %llu differ)", (unsigned long long)d->id, d->component,
               d->expected, d->actual, (unsigned long long)d->count);
    putchar('\n');
}

static void print_text(const char *const path[2], const rheo_verification *v)
{
    printf("%s, %s: %s\n", path[0], path[1], v->message);
    if (v->verdict == RHEO_UNREADABLE)
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
    if (v->first.step > 0 && v->first.stage[0])
        printf("  next: `rheolog inspect %s --step %llu --stage %s` shows the state right there\n", path[0],
               (unsigned long long)v->first.step, v->first.stage);
}

static int run(int argc, char **argv)
{
    bool json = false, common = false;
    const cli_option options[] = {
        {"--common", NULL, NULL, CLI_FLAG, &common},
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {0},
    };
    const int status = cli_parse(&cli_diff, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc != 2)
        return cli_usage(&cli_diff, "needs two recordings; got %d", argc);
    const char *const path[2] = {argv[0], argv[1]};
    rheo_verification v;
    memset(&v, 0, sizeof v);
    for (int i = 0; i < 2; i++)
        if (cli_check_recording(path[i]) != CLI_DONE) {
            v.verdict = RHEO_UNREADABLE;
            snprintf(v.message, sizeof v.message, "unreadable: %.500s cannot be read", path[i]);
        }
    rheo_error error = {""};
    if (v.verdict == RHEO_NOT_COMPARED) {
        const rheo_result result = rheo_diff(path[0], path[1], &v, &error);
        if (result != RHEO_OK)
            return cli_fail(CLI_SYSTEM, "%s, %s: %s", path[0], path[1], error.message);
    }
    if (common)
        cli_accept_lengths(&v);
    if (json)
        print_json(path, &v);
    else
        print_text(path, &v);
    return cli_verdict_code(v.verdict);
}

static const char help[] = {
#include "cli/help/diff.txt.inc"
    0};

const cli_command cli_diff = {"diff", help, run};
