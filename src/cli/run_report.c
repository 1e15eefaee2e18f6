/* Prints the results of `rheolog run`: the cost of the stages, and the final state. */
#include "cli/run.h"

static bool has_substeps(const cli_run_state *run)
{
    return cli_has_metric(run->world, "substeps");
}

static bool has_iterations(const cli_run_state *run)
{
    return cli_has_metric(run->world, "iterations");
}

static bool has_springs(const cli_run_state *run)
{
    return cli_has_metric(run->world, "springs");
}

static double per_update(const cli_run_state *run, double seconds)
{
    return run->updates > 0 ? 1e9 * seconds / run->updates : 0;
}

static double per_substep_update(const cli_run_state *run)
{
    return run->substep_updates > 0 ? 1e9 * run->seconds / run->substep_updates : 0;
}

/* Why the run ended early or is ill, where, and with which changes of the scene. */
static void write_ending(rheo__json *json, const cli_run_state *run)
{
    rheo_failure failure;
    char ill[320] = "";
    const rheo_finding *f = &run->finding;
    const bool failed = rheo_world_failure(run->world, &failure);
    if (run->unhealthy)
        cli_run_unhealthy(run, ill, sizeof ill);
    const char *reason = run->reason.message[0] ? run->reason.message : ill, *stage = failed           ? failure.stage
                                                                                      : run->unhealthy ? f->stage
                                                                                                       : "";
    rheo__json_text(json, "reason", reason[0] ? reason : NULL);
    rheo__json_text(json, "stage", stage[0] ? stage : NULL);
    rheo__json_bool(json, "healthy", !failed && !run->unhealthy);
    if (run->unhealthy) {
        rheo__json_begin_object(json, "health");
        rheo__json_integer(json, "unhealthy_step", f->step);
        rheo__json_text(json, "measure", f->measure);
        rheo__json_number(json, "value", f->value);
        rheo__json_number(json, "limit", f->limit);
        rheo__json_end_object(json);
    } else {
        rheo__json_null(json, "health");
    }
    rheo__json_begin_list(json, "set");
    for (size_t i = 0; i < run->set->count; i++)
        rheo__json_text(json, NULL, run->set->item[i]);
    rheo__json_end_list(json);
}

static void write_stages(rheo__json *json, const cli_run_state *run)
{
    rheo_stage_info stage;
    rheo__json_begin_list(json, "stages");
    for (uint32_t i = 0; rheo_world_stage(run->world, i, &stage) == RHEO_OK; i++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "name", stage.name);
        rheo__json_decimals(json, "ns_per_particle_step", 3, per_update(run, stage.seconds));
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

void cli_run_refused_json(const char *scene, const char *output, int status)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "scene", scene);
    rheo__json_text(&json, "outcome", cli_status_name(status));
    rheo__json_integer(&json, "steps", 0);
    rheo__json_text(&json, "file", output);
    rheo__json_text(&json, "reason", cli_said());
    rheo__json_end_object(&json);
}

void cli_run_json(const cli_run_state *run, const char *output)
{
    rheo_world *world = run->world;
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "scene", run->name);
    rheo__json_text(&json, "model", rheo_model_name(rheo_world_definition(world)->model));
    rheo__json_text(&json, "outcome", run->outcome);
    rheo__json_integer(&json, "particles", rheo_world_particle_count(world));
    rheo__json_integer(&json, "steps", run->done);
    rheo__json_integer(&json, "steps_before", run->recorded);
    rheo__json_integer(&json, "step", rheo_world_step_count(world));
    rheo__json_number(&json, "time", rheo_world_time(world));
    rheo__json_hash(&json, "hash", rheo_world_hash(world));
    rheo__json_decimals(&json, "ns_per_particle_step", 3, per_update(run, run->seconds));
    rheo__json_number(&json, "neighbours", rheo_world_mean_neighbours(world));
    rheo__json_integer(&json, "springs", rheo_world_spring_count(world));
    rheo__json_integer(&json, "history_bytes", rheo_world_history_bytes(world));
    rheo__json_decimals(&json, "creation_seconds", 6, run->creation);
    rheo__json_decimals(&json, "loop_seconds", 6, run->seconds);
    rheo__json_text(&json, "simd", rheo_simd());
    rheo__json_text(&json, "file", output);
    if (output)
        rheo__json_decimals(&json, "bytes", 0, run->bytes);
    else
        rheo__json_null(&json, "bytes");
    rheo__json_known_integer(&json, "max_size", run->max_bytes > 0, run->max_bytes);
    rheo__json_integer(&json, "keyframe_spacing", run->spacing);
    rheo__json_integer(&json, "keyframes_left_out", run->left_out);
    write_ending(&json, run);
    write_stages(&json, run);
    if (has_substeps(run)) {
        rheo__json_decimals(&json, "substeps", 0, run->substeps);
        if (has_iterations(run))
            rheo__json_decimals(&json, "iterations", 0, run->iterations);
        rheo__json_decimals(&json, "ns_per_particle_substep", 3, per_substep_update(run));
    }
    rheo__json_end_object(&json);
}

static void print_cost(const cli_run_state *run, const char *name, double seconds)
{
    printf("  %-28s %10.2f %8.1f %%\n", name, per_update(run, seconds),
           run->seconds > 0 ? 100 * seconds / run->seconds : 0.);
}

static void print_costs(const cli_run_state *run)
{
    rheo_stage_info stage;
    double rest = run->seconds;
    printf("  %-28s %10s %10s\n", "stage", "ns/p/step", "share");
    for (uint32_t i = 0; rheo_world_stage(run->world, i, &stage) == RHEO_OK; i++) {
        print_cost(run, stage.name, stage.seconds);
        rest -= stage.seconds;
    }
    print_cost(run, run->recorder ? "recording, and the rest" : "the rest", rest > 0 ? rest : 0);
    print_cost(run, "all", run->seconds);
    putchar('\n');
}

void cli_run_text(const cli_run_state *run, const char *output)
{
    rheo_world *world = run->world;
    if (run->updates > 0 && !run->progress.quiet)
        print_costs(run);
    char creation[32], seconds[32], history[32];
    cli_duration(run->creation, creation, sizeof creation);
    cli_duration(run->seconds, seconds, sizeof seconds);
    cli_bytes((double)rheo_world_history_bytes(world), history, sizeof history);
    printf("scene       %s (%s)\n", run->name, rheo_model_name(rheo_world_definition(world)->model));
    printf("particles   %u\n", (unsigned)rheo_world_particle_count(world));
    printf("steps       %llu in %s, after %s for the start\n", (unsigned long long)run->done, seconds, creation);
    printf("step, time  %llu, %g T\n", (unsigned long long)rheo_world_step_count(world), rheo_world_time(world));
    printf("neighbours  %.1f (mean)\n", rheo_world_mean_neighbours(world));
    if (has_substeps(run) && run->done > 0) {
        printf("substeps    %.1f per step, %.2f ns per particle each", run->substeps / (double)run->done,
               per_substep_update(run));
        if (has_iterations(run))
            printf("; %.2f solver iterations per substep", run->iterations / run->substeps);
        printf("\n");
    }
    if (has_springs(run)) {
        printf("springs     %zu\n", rheo_world_spring_count(world));
        printf("history     %s\n", history);
    }
    printf("hash        %016llx\n", (unsigned long long)rheo_world_hash(world));
    if (!output)
        return;
    char bytes[32];
    cli_bytes(run->bytes, bytes, sizeof bytes);
    printf("recording   %s, %s", output, bytes);
    if (run->recorded > 0)
        printf(", of which it had %llu step%s", (unsigned long long)run->recorded, cli_plural(run->recorded));
    putchar('\n');
    if (run->left_out > 0)
        printf("keyframes   one every %llu steps; %llu were left out for --max-size\n",
               (unsigned long long)run->spacing, (unsigned long long)run->left_out);
}
