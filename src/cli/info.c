/*
 * rheolog info: what is in a recording. Besides the parameters it prints the groups that say how a scene
 * behaves in any units (docs/model.md):
 *
 *   kappa    = k_min step^2                      below 1 or so for explicit springs
 *   G        = (k_hist/k_min) h^(3/4) |g|^(1/4)  how much history thickens, for order 1/2
 *   pressure = k step^2 / h                      0.16 works, 0.27 explodes
 */
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/scene_json.h"

typedef struct groups {
    double kappa, thickening, pressure;
} groups;

static groups groups_of(const rheo_world_def *def)
{
    const double *g = def->gravity;
    const double gravity = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    const double root = sqrt(def->fluid.support);
    const bool defined = def->springs.stiffness > 0 && def->history.order == .5;
    return (groups){
        .kappa = def->springs.stiffness * def->step * def->step,
        .thickening =
            defined ? def->history.stiffness / def->springs.stiffness * root * sqrt(root) * sqrt(sqrt(gravity)) : NAN,
        .pressure = def->fluid.stiffness * def->step * def->step / def->fluid.support,
    };
}

/* The window in steps and in time, whichever way it was given. */
static void window_of(const rheo_world_def *def, double *steps, double *seconds)
{
    const double exact = def->history.window_seconds / def->step;
    *steps = exact > 0 && exact < 1e15 ? (double)(uint64_t)(exact + .5) : (double)def->history.window;
    *seconds = *steps * def->step;
}

/* The time of the last step, as it was stored; NaN without one. */
static double last_time(rheo_recording *recording, const rheo_recording_info *info)
{
    const uint32_t count = rheo_recording_metric_count(recording);
    double *values = malloc((count + 1) * sizeof *values);
    double time = NAN;
    if (values && rheo_recording_metrics(recording, info->last_step, values, NULL) == RHEO_OK)
        for (uint32_t i = 0; i < count; i++)
            if (strcmp(rheo_recording_metric_name(recording, i), "time") == 0)
                time = values[i];
    free(values);
    return time;
}

static double bytes_per_particle_step(const rheo_recording_info *info)
{
    const double updates = (double)(info->last_step - info->first_step) * (double)info->particles;
    return updates > 0 ? (double)info->step_bytes / updates : 0;
}

/* ---- How it ended, and why it is as it is ---- */

static void write_ending(cli_json *json, const rheo_recording *recording)
{
    rheo_failure failure;
    if (rheo_recording_failure(recording, &failure)) {
        char message[512];
        rheo_failure_message(&failure, message, sizeof message);
        cli_json_begin_object(json, "failure");
        cli_json_integer(json, "step", failure.step);
        cli_json_text(json, "stage", failure.stage);
        cli_json_text(json, "field", failure.field);
        cli_json_integer(json, "id", failure.id);
        cli_json_integer(json, "component", failure.component);
        cli_json_text(json, "message", message);
        cli_json_end_object(json);
    } else {
        cli_json_null(json, "failure");
    }
    cli_json_begin_list(json, "blessings");
    rheo_blessing blessing;
    for (uint32_t i = 0; rheo_recording_blessing(recording, i, &blessing) == RHEO_OK; i++) {
        cli_json_begin_object(json, NULL);
        cli_json_text(json, "because", blessing.because);
        cli_json_text(json, "build", blessing.build);
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void print_ending_text(const rheo_recording *recording)
{
    rheo_failure failure;
    if (rheo_recording_failure(recording, &failure)) {
        char message[512];
        rheo_failure_message(&failure, message, sizeof message);
        printf("ended       %s\n", message);
    }
    rheo_blessing blessing;
    for (uint32_t i = 0; rheo_recording_blessing(recording, i, &blessing) == RHEO_OK; i++)
        printf("blessed     %s\n            by %s\n", blessing.because, blessing.build);
}

static void write_parameters(cli_json *json, const rheo_world_def *def)
{
    const rheo_parameter *p = NULL;
    cli_json_begin_object(json, "parameters");
    for (size_t i = 0; (p = rheo_parameter_at(i)) != NULL; i++) {
        if (!(p->models >> def->model & 1))
            continue;
        char value[128] = "";
        rheo_world_def_get(def, p->path, value, sizeof value);
        cli_json_parameter(json, p->path, p, value);
    }
    cli_json_end_object(json);
}

static void write_derived(cli_json *json, const rheo_world_def *def)
{
    double steps = NAN, seconds = NAN;
    if (def->history.kind != RHEO_HISTORY_FULL)
        window_of(def, &steps, &seconds);
    const groups derived = groups_of(def);
    cli_json_number(json, "window_steps", steps);
    cli_json_number(json, "window_time", seconds);
    cli_json_begin_object(json, "derived");
    cli_json_number(json, "kappa", derived.kappa);
    cli_json_number(json, "G", derived.thickening);
    cli_json_number(json, "pressure", derived.pressure);
    cli_json_end_object(json);
}

static void print_json(const rheo_recording *recording, const char *file, const rheo_recording_info *info,
                       const rheo_world_def *def, double time)
{
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "file", file);
    cli_json_text(&json, "scene", info->scene);
    cli_json_text(&json, "model", rheo_model_name(def->model));
    cli_json_integer(&json, "steps", info->last_step - info->first_step);
    cli_json_integer(&json, "first_step", info->first_step);
    cli_json_integer(&json, "last_step", info->last_step);
    cli_json_number(&json, "time", time);
    cli_json_integer(&json, "particles", info->particles);
    cli_json_integer(&json, "format", info->format);
    cli_json_integer(&json, "real_bytes", info->real_bytes);
    cli_json_integer(&json, "keyframes", info->keyframes);
    cli_json_integer(&json, "keyframe_spacing", info->keyframe_spacing);
    cli_json_integer(&json, "bytes", info->bytes);
    cli_json_integer(&json, "keyframe_bytes", info->keyframe_bytes);
    cli_json_integer(&json, "step_bytes", info->step_bytes);
    cli_json_bool(&json, "full", info->full);
    cli_json_bool(&json, "complete", info->complete);
    cli_json_text(&json, "build", info->build);
    write_parameters(&json, def);
    write_derived(&json, def);
    cli_json_number(&json, "keyframe_share", info->keyframe_share);
    write_ending(&json, recording);
    cli_json_end_object(&json);
}

static void print_thickening_groups(const rheo_world_def *def)
{
    double window_steps = 0, window_seconds = 0;
    window_of(def, &window_steps, &window_seconds);
    const groups derived = groups_of(def);
    if (def->history.kind == RHEO_HISTORY_FULL)
        puts("\nhistory     full: all of it, as decaying sums");
    else if (def->history.kind == RHEO_HISTORY_TEMPERED)
        printf("\nhistory     tempered: a window of %.0f steps = %g T that fades with tau = %g T\n", window_steps,
               window_seconds, rheo_history_tempering(def->history.order, window_steps) * def->step);
    else
        printf("\nhistory     %.0f steps = %g T%s\n", window_steps, window_seconds,
               def->history.kind == RHEO_HISTORY_WINDOW_FAST ? ", as decaying sums that forget what leaves" : "");
    printf("kappa       %-10.4g springs.stiffness step^2\n", derived.kappa);
    if (!isnan(derived.thickening))
        printf("G           %-10.4g (history.stiffness/springs.stiffness) support^(3/4) |gravity|^(1/4)\n",
               derived.thickening);
    printf("pressure    %-10.4g fluid.stiffness step^2/support; 0.16 and less is known to be stable\n",
           derived.pressure);
}

static void print_melting_groups(const rheo_world_def *def)
{
    const double h = def->melting.smoothing_length > 0 ? def->melting.smoothing_length : def->fluid.spacing;
    printf("\nsupport     %-10.4g 3 melting.smoothing_length\n", 3 * h);
    printf("mass        %-10.4g of a particle: melting.rest_density fluid.spacing^3\n",
           def->melting.rest_density * def->fluid.spacing * def->fluid.spacing * def->fluid.spacing);
    printf("yield       %-10.4g melting.viscosity/melting.time_scale, the stress that solid bears\n",
           def->melting.viscosity / def->melting.time_scale);
    printf("substeps    %-10.4g in a step of fluid at rest: step melting.sound_speed/(melting.courant_number h)\n",
           def->step * def->melting.sound_speed / (def->melting.courant_number * h));
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
    printf("scene       %s (%s)\n", info->scene[0] ? info->scene : "without a name", rheo_model_name(def->model));
    printf("particles   %llu\n", (unsigned long long)info->particles);
    printf("steps       %llu (%llu to %llu) of %g T, up to time %g T\n", last - first, first, last, def->step, time);
    printf("keyframes   %llu", (unsigned long long)info->keyframes);
    if (info->keyframe_spacing > 0)
        printf(", one every %llu steps: about %.1f %% of the run's time", (unsigned long long)info->keyframe_spacing,
               100 * info->keyframe_share);
    puts(info->full ? ", and the state of every step" : "");
    printf("size        %s: keyframes %s, steps %s (%.3g bytes a particle and step)\n", all, keyframes, steps,
           bytes_per_particle_step(info));
    printf("complete    %s\n", info->complete ? "yes" : "no: truncated, it has no end mark");
    printf("format      %u, reals of %u bytes\n", (unsigned)info->format, (unsigned)info->real_bytes);
    printf("made by     %s\n", info->build);
    print_ending_text(recording);

    if (def->model == RHEO_MODEL_MELTING)
        print_melting_groups(def);
    else
        print_thickening_groups(def);
    putchar('\n');

    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_parameter_at(i)) != NULL; i++) {
        if (!(p->models >> def->model & 1))
            continue;
        char value[128] = "";
        rheo_world_def_get(def, p->path, value, sizeof value);
        printf("%-26s = %-32s %s\n", p->path, value, p->unit ? p->unit : "");
    }
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
    if (argc != 1)
        return cli_usage(&cli_info, "needs one recording; got %d", argc);
    rheo_recording *recording = NULL;
    if ((status = cli_open_recording(argv[0], &recording)) != CLI_DONE)
        return status;
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const double time = last_time(recording, &info);
    if (json)
        print_json(recording, argv[0], &info, rheo_recording_definition(recording), time);
    else
        print_text(recording, argv[0], &info, rheo_recording_definition(recording), time);
    rheo_recording_close(recording);
    return CLI_DONE;
}

static const char help[] = {
#include "cli/help/info.txt.inc"
    0};

const cli_command cli_info = {"info", help, run};
