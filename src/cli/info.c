/*
 * rheolog info: prints the contents of a recording: its parameters, and the derived, mostly dimensionless numbers
 * that determine how the scene behaves (docs/model.md, docs/melting.md). Nothing is simulated.
 */
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/provenance.h"
#include "json/json_parameter.h"

/* Converts a time that is given in steps, or in seconds above 0, to both. */
static void convert(const rheo_world_def *def, uint32_t given, double given_seconds, double *steps, double *seconds)
{
    const double exact = given_seconds / def->step;
    *steps = exact > 0 && exact < 1e15 ? (double)(uint64_t)(exact + .5) : (double)given;
    *seconds = *steps * def->step;
}

/* A curve ends its window. */
static void window_of(const rheo_world_def *def, double *steps, double *seconds)
{
    if (def->history.curve_count) {
        *steps = rheo_history_curve_window(def->history.curve, def->history.curve_count, def->step);
        *seconds = *steps * def->step;
        return;
    }
    convert(def, def->history.window, def->history.window_seconds, steps, seconds);
}

static void lag_of(const rheo_world_def *def, double *steps, double *seconds)
{
    convert(def, def->history.lag, def->history.lag_seconds, steps, seconds);
}

/* Recorded time of the last step; NaN if there is none. */
static double last_time(rheo_recording *recording, const rheo_recording_info *info)
{
    const uint32_t count = rheo_recording_metric_count(recording),
                   index = rheo_recording_metric_by_name(recording, "time");
    double *values = malloc((count + 1) * sizeof *values);
    double time = NAN;
    if (values && rheo_recording_metrics(recording, info->last_step, values, NULL) == RHEO_OK)
        time = index < count ? values[index] : NAN;
    free(values);
    return time;
}

static double bytes_per_particle_step(const rheo_recording_info *info)
{
    const double updates = (double)(info->last_step - info->first_step) * (double)info->particles;
    return updates > 0 ? (double)info->step_bytes / updates : 0;
}

/* ---- End of the run and blessings ---- */

static void write_ending(rheo__json *json, const rheo_recording *recording)
{
    rheo_failure failure;
    char message[512] = "";
    const bool failed = rheo_recording_failure(recording, &failure);
    if (failed)
        rheo_failure_message(&failure, message, sizeof message);
    cli_failure_json(json, failed, &failure, "location", message);
    cli_blessings_json(json, recording);
}

static void print_ending_text(const rheo_recording *recording)
{
    rheo_failure failure;
    if (rheo_recording_failure(recording, &failure)) {
        char message[512];
        rheo_failure_message(&failure, message, sizeof message);
        cli_print(stdout, 12, "ended       %s\n", message);
    }
    cli_blessings_text(recording);
}

static void write_parameters(rheo__json *json, const rheo_world_def *def)
{
    const rheo_parameter *p = NULL;
    rheo__json_begin_object(json, "parameters");
    for (size_t i = 0; (p = rheo_world_def_parameter_at(def, i)) != NULL; i++) {
        if (!(p->models >> def->model & 1))
            continue;
        char value[128] = "";
        rheo_world_def_get(def, p->path, value, sizeof value);
        rheo__json_parameter(json, p->path, p, value);
    }
    rheo__json_end_object(json);
}

static void write_derived(rheo__json *json, const rheo_world_def *def, bool history)
{
    double steps = NAN, seconds = NAN, lag = NAN, lag_seconds = NAN;
    rheo_derived derived;
    if (history && def->history.kind != RHEO_HISTORY_FULL)
        window_of(def, &steps, &seconds);
    rheo__json_number(json, "window_steps", steps);
    rheo__json_number(json, "window_time", seconds);
    if (history)
        lag_of(def, &lag, &lag_seconds);
    rheo__json_number(json, "lag_steps", lag);
    rheo__json_number(json, "lag_time", lag_seconds);
    rheo__json_begin_list(json, "curve");
    for (uint32_t i = 0; i < def->history.curve_count; i++) {
        const double point[2] = {def->history.curve[i].age, def->history.curve[i].weight};
        rheo__json_vector(json, NULL, point, 2);
    }
    rheo__json_end_list(json);
    rheo__json_begin_object(json, "derived");
    for (uint32_t i = 0; rheo_world_def_derived(def, i, &derived); i++)
        rheo__json_number(json, derived.name, derived.value);
    rheo__json_end_object(json);
    rheo__json_begin_list(json, "derived_numbers");
    for (uint32_t i = 0; rheo_world_def_derived(def, i, &derived); i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "name", derived.name);
        rheo__json_number(json, "value", derived.value);
        rheo__json_text(json, "unit", derived.unit);
        rheo__json_text(json, "meaning", derived.meaning);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void print_json(const rheo_recording *recording, const char *file, const rheo_recording_info *info,
                       const rheo_world_def *def, double time)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "file", file);
    rheo__json_text(&json, "scene", info->scene);
    rheo__json_text(&json, "model", rheo_model_name(def->model));
    rheo__json_integer(&json, "steps", info->last_step - info->first_step);
    rheo__json_integer(&json, "first_step", info->first_step);
    rheo__json_integer(&json, "last_step", info->last_step);
    rheo__json_number(&json, "time", time);
    rheo__json_integer(&json, "particles", info->particles);
    rheo__json_integer(&json, "format", info->format);
    rheo__json_integer(&json, "real_bytes", info->real_bytes);
    rheo__json_integer(&json, "keyframes", info->keyframes);
    rheo__json_integer(&json, "keyframe_spacing", info->keyframe_spacing);
    rheo__json_integer(&json, "bytes", info->bytes);
    rheo__json_integer(&json, "keyframe_bytes", info->keyframe_bytes);
    rheo__json_integer(&json, "step_bytes", info->step_bytes);
    rheo__json_bool(&json, "full", info->full);
    rheo__json_bool(&json, "complete", info->complete);
    rheo__json_bool(&json, "being_written", info->being_written);
    rheo__json_text(&json, "build", info->build);
    rheo__json_text(&json, "made_by", info->made_by[0] ? info->made_by : NULL);
    rheo__json_integer(&json, "commands", rheo_recording_command_count(recording));
    rheo__json_bool(&json, "made_refused", info->made_refused);
    cli_differing_parameters_json(&json, "differing", def, def);
    write_parameters(&json, def);
    write_derived(&json, def, info->history);
    rheo__json_number(&json, "keyframe_share", info->keyframe_share);
    write_ending(&json, recording);
    rheo__json_end_object(&json);
}

static void print_history(const rheo_world_def *def)
{
    double steps = 0, seconds = 0, lag = 0, lag_seconds = 0;
    char after[96] = "";
    window_of(def, &steps, &seconds);
    lag_of(def, &lag, &lag_seconds);
    if (lag > 0)
        snprintf(after, sizeof after, ", after a lag of %.0f step%s = %g T", lag, cli_plural((uint64_t)lag),
                 lag_seconds);
    if (def->history.of == RHEO_HISTORY_OF_LENGTH)
        strcat(after, ", of the lengths of springs");
    if (def->history.kind == RHEO_HISTORY_FULL)
        cli_print(stdout, 12, "history     full: all of it, as decaying sums%s\n", after);
    else if (def->history.kind == RHEO_HISTORY_TEMPERED)
        cli_print(stdout, 12, "history     tempered: a window of %.0f steps = %g T that fades with tau = %g T%s\n",
                  steps, seconds, rheo_history_tempering(def->history.order, steps) * def->step, after);
    else if (def->history.curve_count)
        cli_print(stdout, 12, "history     a curve of %u points in %.0f steps = %g T%s\n",
                  (unsigned)def->history.curve_count, steps, seconds, after);
    else
        cli_print(stdout, 12, "history     %.0f steps = %g T%s%s\n", steps, seconds,
                  def->history.kind == RHEO_HISTORY_WINDOW_FAST ? ", as decaying sums that forget what leaves" : "",
                  after);
}

static void print_derived(const rheo_world_def *def, bool history)
{
    rheo_derived derived;
    char number[32];
    putchar('\n');
    if (history)
        print_history(def);
    for (uint32_t i = 0; rheo_world_def_derived(def, i, &derived); i++)
        if (!isnan(derived.value))
            cli_print(stdout, 43, "%-19s %-10s %-11s %s\n", derived.name, rheo_number_brief(derived.value, 4, number),
                      derived.unit, derived.meaning);
}

static void print_parameters(const rheo_world_def *def)
{
    const rheo_parameter *p = NULL;
    int width = 0;
    for (size_t i = 0; (p = rheo_world_def_parameter_at(def, i)) != NULL; i++)
        if (p->models >> def->model & 1 && (int)strlen(p->path) > width)
            width = (int)strlen(p->path);
    for (size_t i = 0; (p = rheo_world_def_parameter_at(def, i)) != NULL; i++) {
        if (!(p->models >> def->model & 1))
            continue;
        char value[128] = "";
        rheo_world_def_get(def, p->path, value, sizeof value);
        printf("%-*s = %-32s %s\n", width, p->path, value, p->unit ? p->unit : "");
    }
}

static void print_text(const rheo_recording *recording, const char *file, const rheo_recording_info *info,
                       const rheo_world_def *def, double time)
{
    char all[32], keyframes[32], steps[32];
    cli_bytes((double)info->bytes, all, sizeof all);
    cli_bytes((double)info->keyframe_bytes, keyframes, sizeof keyframes);
    cli_bytes((double)info->step_bytes, steps, sizeof steps);
    const unsigned long long first = info->first_step, last = info->last_step;
    printf("%s\n", file);
    cli_print(stdout, 12, "scene       %s (%s)\n", info->scene[0] ? info->scene : "without a name",
              rheo_model_name(def->model));
    printf("particles   %llu\n", (unsigned long long)info->particles);
    cli_print(stdout, 12, "steps       %llu (%llu to %llu) of %g T, up to time %g T\n", last - first, first, last,
              def->step, time);
    printf("keyframes   %llu", (unsigned long long)info->keyframes);
    if (info->keyframe_spacing > 0)
        printf(", one every %llu step%s: about %.1f %% of the run's time", (unsigned long long)info->keyframe_spacing,
               cli_plural(info->keyframe_spacing), 100 * info->keyframe_share);
    puts(info->full ? ", and the state of every step" : "");
    cli_print(stdout, 12, "size        %s: keyframes %s, steps %s (%.3g bytes per particle and step)\n", all,
              keyframes, steps, bytes_per_particle_step(info));
    char completeness[256];
    cli_completeness(recording, completeness, sizeof completeness);
    cli_print(stdout, 12, "complete    %s%s\n", info->complete ? "yes" : "no: ", info->complete ? "" : completeness);
    printf("format      %u, reals of %u bytes\n", (unsigned)info->format, (unsigned)info->real_bytes);
    cli_print(stdout, 12, "build       %s\n", info->build);
    if (info->made_by[0] || info->made_refused)
        cli_print(stdout, 12, "made by     %s\n", cli_made_text(info));
    const unsigned long long commands = rheo_recording_command_count(recording);
    cli_print(stdout, 12, "commands    %llu%s\n", commands, commands ? ": rheolog log lists them" : "");
    cli_emitters_text(def);
    cli_differing_parameters_text(def);
    print_ending_text(recording);

    print_derived(def, info->history);
    putchar('\n');
    print_parameters(def);
}

void cli_info_print(const char *file, rheo_recording *recording, bool json)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const double time = last_time(recording, &info);
    if (json)
        print_json(recording, file, &info, rheo_recording_definition(recording), time);
    else
        print_text(recording, file, &info, rheo_recording_definition(recording), time);
}

static int print_info(const char *file, bool json, bool separate)
{
    rheo_recording *recording = NULL;
    const int status = cli_open_recording(file, &recording);
    if (status != CLI_DONE)
        return status;
    if (separate && !json)
        putchar('\n');
    cli_info_print(file, recording, json);
    rheo_recording_close(recording);
    return CLI_DONE;
}

static int run(int argc, char **argv)
{
    bool json = false;
    const cli_option options[] = {
        {"--json", NULL, NULL, CLI_FLAG, &json},
        {0},
    };
    int status = cli_parse(&cli_info, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc == 0)
        return cli_usage(&cli_info, "needs at least one recording");
    int worst = CLI_DONE;
    for (int i = 0; i < argc; i++) {
        status = print_info(argv[i], json, i > 0);
        worst = status > worst ? status : worst;
    }
    return worst;
}

static const char help[] = {
#include "cli/help/info.txt.inc"
    0};

const cli_command cli_info = {"info", help, run};
