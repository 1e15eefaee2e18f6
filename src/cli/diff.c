/* rheolog diff: the first place where two recordings differ, and how the difference grows. */
#include "cli/cli.h"

#include <string.h>

#include "cli/scene_json.h"

/* ---- Parameters ---- */

/* The parameters that the two began with other values of: into a list, or as text without one. */
static void print_differing(cli_json *json, const rheo_world_def *a, const rheo_world_def *b)
{
    bool any = false;
    for (size_t i = 0; i < rheo_parameter_count(); i++) {
        const rheo_parameter *p = rheo_parameter_at(i);
        char in_a[128] = "", in_b[128] = "";
        rheo_world_def_get(a, p->path, in_a, sizeof in_a);
        rheo_world_def_get(b, p->path, in_b, sizeof in_b);
        if (strcmp(in_a, in_b) == 0)
            continue;
        if (json) {
            cli_json_begin_object(json, NULL);
            cli_json_text(json, "path", p->path);
            cli_json_parameter(json, "a", p, in_a);
            cli_json_parameter(json, "b", p, in_b);
            cli_json_end_object(json);
        } else {
            printf("%s    %s = %s in the first, %s in the second\n",
                   any ? "" : "  parameters at the start that differ:\n", p->path, in_a, in_b);
        }
        any = true;
    }
}

static void print_parameters(const char *const path[2], cli_json *json)
{
    rheo_recording *r[2] = {NULL, NULL};
    rheo_error unreadable;
    if (rheo_recording_open(path[0], &r[0], &unreadable) == RHEO_OK &&
        rheo_recording_open(path[1], &r[1], &unreadable) == RHEO_OK)
        print_differing(json, rheo_recording_definition(r[0]), rheo_recording_definition(r[1]));
    rheo_recording_close(r[0]);
    rheo_recording_close(r[1]);
}

/* ---- Results ---- */

static void print_json(const char *const path[2], const rheo_verification *v)
{
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "a", path[0]);
    cli_json_text(&json, "b", path[1]);
    cli_verification_json(&json, v);
    if (v->commands_differ)
        cli_json_integer(&json, "commands_step", v->commands_step);
    else
        cli_json_null(&json, "commands_step");
    if (v->has_cause)
        cli_difference_json(&json, "cause", &v->cause);
    else
        cli_json_null(&json, "cause");
    cli_json_begin_list(&json, "parameters");
    print_parameters(path, &json);
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
    print_parameters(path, NULL);
    if (v->verdict == RHEO_SAME)
        return;
    if (v->commands_differ)
        printf("  the commands given before step %llu differ\n", (unsigned long long)v->commands_step);
    if (v->has_cause)
        print_cause(v);
    cli_growth_text(v);
    if (v->first.step > 0 && v->first.stage[0])
        printf("  next: `rheolog inspect %s --step %llu --stage %s` shows the state right there\n", path[0],
               (unsigned long long)v->first.step, v->first.stage);
}

static int run(int argc, char **argv)
{
    bool json = false;
    const cli_option options[] = {
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
    if (v.verdict == RHEO_SAME) {
        const rheo_result result = rheo_diff(path[0], path[1], &v, &error);
        if (result != RHEO_OK)
            return cli_fail(CLI_SYSTEM, "%s, %s: %s", path[0], path[1], error.message);
    }
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
