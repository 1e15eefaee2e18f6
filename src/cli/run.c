/*
 * rheolog run: makes a scene, or takes a state out of a recording, steps it, records it, and says what it
 * cost.
 *
 * The loop's time is the wall time of the steps and of recording them; making the scene, settling and
 * replaying up to the step to start from are not in it.
 */
#define _POSIX_C_SOURCE 200809L
#include "cli/cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifndef __wasi__
#include <signal.h>
#endif

#include "cli/scene_json.h"

typedef struct run_arguments {
    const char *scene, *output, *from, *simd;
    cli_number steps, keyframes;
    cli_list set;
    bool full, write_scene, force, json, quiet;
} run_arguments;

/* A run: what it starts from, and what has come of it. */
typedef struct run_state {
    rheo_recording *recording; /* of --from, else NULL */
    rheo_world *world;
    rheo_recorder *recorder; /* of -o, else NULL */
    char name[128];
    uint64_t wanted, done;    /* steps */
    double creation, seconds; /* wall time before, and of the loop */
    double updates;           /* particles x steps */
    double substep_updates;   /* particles x substeps; of melting, as what follows */
    double substeps, iterations;
    const char *outcome;
    cli_progress progress;
} run_state;

/* What the library says while it makes a scene: that it settles, or that it expects trouble. It stays on the
 * screen. */
static void library_message(const char *text, void *user)
{
    const cli_progress *p = user;
    if (!p->quiet)
        fprintf(stderr, "%s\n", text);
}

static void step_progress(run_state *run, double start)
{
    const double time = cli_now();
    if (!cli_progress_due(&run->progress, time))
        return;
    const double seconds = time - start;
    char left[32];
    cli_duration(seconds / (double)run->done * (double)(run->wanted - run->done), left, sizeof left);
    cli_progress_say(&run->progress, time, "step %llu of %llu, %.1f ns per particle and step, %s left",
                     (unsigned long long)run->done, (unsigned long long)run->wanted,
                     run->updates > 0 ? 1e9 * seconds / run->updates : 0., left);
}

/* ---- The scene ---- */

static bool is_builtin(const char *name)
{
    rheo_scene scene;
    return rheo_scene_builtin(name, &scene, NULL) == RHEO_OK;
}

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), of_end = strlen(end);
    return length > of_end && strcmp(text + length - of_end, end) == 0;
}

static bool is_file_name(const char *name)
{
    return strchr(name, '/') || ends_with(name, ".json") || (!is_builtin(name) && cli_exists(name));
}

static int unknown_scene(const char *name)
{
    rheo_scene scene;
    char nearest[sizeof scene.name] = "";
    fprintf(stderr, "rheolog run: unknown scene \"%s\"; the built-in ones are", name);
    for (size_t i = 0; rheo_scene_builtin_at(i, &scene) == RHEO_OK; i++) {
        fprintf(stderr, "%s %s", i ? "," : "", scene.name);
        if (i == 0 || cli_word_distance(name, scene.name) < cli_word_distance(name, nearest))
            memcpy(nearest, scene.name, sizeof nearest);
    }
    fprintf(stderr, "; did you mean \"%s\"? (a scene file's name ends in .json)\n", nearest);
    return CLI_BAD;
}

static int read_scene_file(const char *path, rheo_scene *scene)
{
    const int status = cli_check_input(path);
    if (status != CLI_DONE)
        return status;
    FILE *file = fopen(path, "rb");
    if (!file)
        return cli_fail(CLI_BAD, "cannot read %s: %s", path, strerror(errno));
    char *text = NULL;
    size_t size = 0, room = 0;
    while (size <= CLI_MAX_SCENE_BYTES) {
        if (size == room) {
            room = room ? 2 * room : 65536;
            char *larger = realloc(text, room);
            if (!larger) {
                free(text);
                fclose(file);
                return cli_fail(CLI_SYSTEM, "no memory to read %s", path);
            }
            text = larger;
        }
        const size_t got = fread(text + size, 1, room - size, file);
        if (got == 0)
            break;
        size += got;
    }
    const bool failed = ferror(file) != 0;
    fclose(file);
    rheo_error error = {""};
    int code = CLI_DONE;
    if (failed)
        code = cli_fail(CLI_SYSTEM, "cannot read %s to its end", path);
    else if (size > CLI_MAX_SCENE_BYTES)
        code = cli_fail(CLI_BAD, "%s is no scene file: it has more than %zu MiB", path, CLI_MAX_SCENE_BYTES >> 20);
    else {
        const rheo_result result = cli_scene_from_json(text, size, path, scene, &error);
        code = result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
    }
    free(text);
    return code;
}

static int find_scene(const char *name, rheo_scene *scene)
{
    if (ends_with(name, ".rlog"))
        return cli_usage(&cli_run, "%s is a recording, not a scene; to go on from it: --from %s", name, name);
    if (is_file_name(name))
        return read_scene_file(name, scene);
    return rheo_scene_builtin(name, scene, NULL) == RHEO_OK ? CLI_DONE : unknown_scene(name);
}

/* Splits KEY=VALUE; the key is copied. */
static int split_set(const char *text, char *key, size_t size, const char **value)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return cli_usage(&cli_run, "--set needs KEY=VALUE, e.g. fluid.support=4; got \"%s\"", text);
    snprintf(key, size, "%.*s", (int)(equals - text < 4096 ? equals - text : 4096), text);
    *value = equals + 1;
    return CLI_DONE;
}

static int change_scene(rheo_scene *scene, const cli_list *set)
{
    for (size_t i = 0; i < set->count; i++) {
        char key[128];
        const char *value = NULL;
        rheo_error error = {""};
        const int status = split_set(set->item[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
        const rheo_result result = cli_scene_set(scene, key, value, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        if (strcmp(key, "ball.position") == 0)
            scene->clearance = -1; /* or the ball would start above the surface and not where it was put */
    }
    rheo_error error = {""};
    const rheo_result result = rheo_scene_check(scene, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

static int write_scene(const rheo_scene *scene)
{
    char *text = cli_scene_to_json(scene);
    if (!text)
        return cli_fail(CLI_SYSTEM, "no memory to write the scene");
    fputs(text, stdout);
    free(text);
    return CLI_DONE;
}

static int start_from_scene(run_state *run, rheo_scene *scene)
{
    snprintf(run->name, sizeof run->name, "%s", scene->name);
    scene->world.log = (rheo_log){library_message, &run->progress};
    rheo_error error = {""};
    const rheo_result result = rheo_scene_create_world(scene, &run->world, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* ---- The state of a recording ---- */

/* F.rlog@400; a file that is really called so is meant whole. */
static int split_from(const char *text, char *path, size_t size, cli_number *step)
{
    const size_t length = strlen(text);
    if (length >= size)
        return cli_fail(CLI_BAD, "the name after --from is too long: %zu bytes", length);
    memcpy(path, text, length + 1);
    char *at = strrchr(path, '@');
    if (!at || cli_exists(text))
        return CLI_DONE;
    if (!cli_number_from(at + 1, &step->value))
        return cli_usage(&cli_run, "--from needs F.rlog or F.rlog@STEP with a whole number; got \"%s\"", text);
    step->given = true;
    *at = 0;
    return CLI_DONE;
}

static int change_world(rheo_world *world, const cli_list *set)
{
    for (size_t i = 0; i < set->count; i++) {
        char key[128];
        const char *value = NULL;
        const int status = split_set(set->item[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
        if (cli_scene_only(key))
            return cli_fail(CLI_BAD, "%s belongs to the making of a scene; with --from it comes too late", key);
        rheo_error error = {""};
        const rheo_result result = rheo_world_set(world, key, value, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

static int world_at(rheo_recording *recording, uint64_t step, rheo_world **world)
{
    rheo_error error = {""};
    const rheo_result result = rheo_recording_world(recording, step, NULL, world, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

static int start_from_recording(run_state *run, const run_arguments *a)
{
    char path[4096];
    cli_number step = {false, 0};
    int status = split_from(a->from, path, sizeof path, &step);
    if (status == CLI_DONE && a->output && cli_same_file(path, a->output))
        status = cli_fail(CLI_BAD, "%s is read by --from and cannot be written by -o too", path);
    if (status == CLI_DONE)
        status = cli_open_recording(path, &run->recording);
    if (status != CLI_DONE)
        return status;
    const rheo_recording_info info = rheo_recording_get_info(run->recording);
    snprintf(run->name, sizeof run->name, "%s", info.scene);
    if (!step.given)
        step.value = info.last_step;
    if (step.value < info.first_step || step.value > info.last_step)
        return cli_fail(CLI_BAD, "%s holds steps %llu to %llu; step %llu is none of them", path,
                        (unsigned long long)info.first_step, (unsigned long long)info.last_step,
                        (unsigned long long)step.value);
    if (a->set.count > 0) {
        /* Tried on the first keyframe, which costs no replay, so that a bad --set is told before a file is
         * made. */
        rheo_world *trial = NULL;
        status = world_at(run->recording, info.first_step, &trial);
        if (status == CLI_DONE)
            status = change_world(trial, &a->set);
        rheo_world_destroy(trial);
        if (status != CLI_DONE)
            return status;
    }
    return world_at(run->recording, step.value, &run->world);
}

/* ---- The loop ---- */

/* Of the last step; 0 where the model has no such metric. */
static double metric(const rheo_world *world, const char *name)
{
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        if (strcmp(rheo_world_metric_name(world, i), name) == 0)
            return rheo_world_metric(world, i);
    return 0;
}

static bool melts(const run_state *run)
{
    return rheo_world_definition(run->world)->model == RHEO_MODEL_MELTING;
}

#ifdef __wasi__
/* WebAssembly has no signals: nothing can interrupt a run but the end of the program. */
enum { interrupted = 0 };

static void catch_signals(void)
{
}
#else
static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

/* The first Ctrl-C ends the run after the step at hand; a second one ends the program. */
static void catch_signals(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    action.sa_flags = (int)SA_RESETHAND;
    const int signals[] = {SIGINT, SIGTERM};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        struct sigaction before;
        /* A shell that starts a job in the background has it ignore them: it stays so. */
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(signals[i], &action, NULL);
    }
}
#endif

static int loop(run_state *run)
{
    rheo_world_reset_times(run->world);
    catch_signals();
    int status = CLI_DONE;
    run->outcome = "done";
    const double start = cli_now();
    run->progress.last = start;
    while (run->done < run->wanted) {
        if (interrupted) {
            cli_progress_end(&run->progress);
            run->outcome = "interrupted";
            status = cli_fail(CLI_DIFFERS, "interrupted after %llu of %llu steps", (unsigned long long)run->done,
                              (unsigned long long)run->wanted);
            break;
        }
        rheo_error error = {""};
        const double particles = rheo_world_particle_count(run->world);
        const rheo_result result =
            run->recorder ? rheo_recorder_step(run->recorder, &error) : rheo_world_step(run->world, &error);
        if (result != RHEO_OK) {
            cli_progress_end(&run->progress);
            run->outcome = "failed";
            status = cli_error(result, &error);
            break;
        }
        run->done++;
        run->updates += particles;
        const double substeps = metric(run->world, "substeps");
        run->substeps += substeps;
        run->substep_updates += particles * substeps;
        run->iterations += metric(run->world, "iterations");
        step_progress(run, start);
    }
    run->seconds = cli_now() - start;
    cli_progress_end(&run->progress);
    return status;
}

/* ---- The end ---- */

static double per_update(const run_state *run, double seconds)
{
    return run->updates > 0 ? 1e9 * seconds / run->updates : 0;
}

static double per_substep_update(const run_state *run)
{
    return run->substep_updates > 0 ? 1e9 * run->seconds / run->substep_updates : 0;
}

static void write_stages(cli_json *json, const run_state *run)
{
    rheo_stage_info stage;
    cli_json_begin_list(json, "stages");
    for (uint32_t i = 0; rheo_world_stage(run->world, i, &stage) == RHEO_OK; i++) {
        cli_json_begin_object(json, NULL);
        cli_json_text(json, "name", stage.name);
        cli_json_decimals(json, "ns_per_particle_step", 3, per_update(run, stage.seconds));
        cli_json_end_object(json);
    }
    cli_json_end_list(json);
}

static void print_json(const run_state *run, const char *output)
{
    rheo_world *world = run->world;
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "scene", run->name);
    cli_json_text(&json, "model", rheo_model_name(rheo_world_definition(world)->model));
    cli_json_text(&json, "outcome", run->outcome);
    cli_json_integer(&json, "particles", rheo_world_particle_count(world));
    cli_json_integer(&json, "steps", run->done);
    cli_json_integer(&json, "step", rheo_world_step_count(world));
    cli_json_number(&json, "time", rheo_world_time(world));
    cli_json_hash(&json, "hash", rheo_world_hash(world));
    cli_json_decimals(&json, "ns_per_particle_step", 3, per_update(run, run->seconds));
    cli_json_number(&json, "neighbours", rheo_world_mean_neighbours(world));
    cli_json_integer(&json, "springs", rheo_world_spring_count(world));
    cli_json_integer(&json, "history_bytes", rheo_world_history_bytes(world));
    cli_json_decimals(&json, "creation_seconds", 6, run->creation);
    cli_json_decimals(&json, "loop_seconds", 6, run->seconds);
    cli_json_text(&json, "simd", rheo_simd());
    cli_json_text(&json, "file", output);
    write_stages(&json, run);
    if (melts(run)) {
        cli_json_decimals(&json, "substeps", 0, run->substeps);
        cli_json_decimals(&json, "iterations", 0, run->iterations);
        cli_json_decimals(&json, "ns_per_particle_substep", 3, per_substep_update(run));
    }
    cli_json_end_object(&json);
}

static void print_cost(const run_state *run, const char *name, double seconds)
{
    printf("  %-28s %10.2f %8.1f %%\n", name, per_update(run, seconds),
           run->seconds > 0 ? 100 * seconds / run->seconds : 0.);
}

static void print_text(const run_state *run, const char *output)
{
    rheo_world *world = run->world;
    if (run->updates > 0) {
        printf("  %-28s %10s %10s\n", "stage", "ns/p/step", "share");
        double rest = run->seconds;
        for (uint32_t i = 0; i < rheo_world_stage_count(world); i++) {
            rheo_stage_info stage;
            if (rheo_world_stage(world, i, &stage) != RHEO_OK)
                continue;
            print_cost(run, stage.name, stage.seconds);
            rest -= stage.seconds;
        }
        print_cost(run, run->recorder ? "recording, and the rest" : "the rest", rest > 0 ? rest : 0);
        print_cost(run, "all", run->seconds);
        putchar('\n');
    }
    char creation[32], seconds[32], history[32];
    cli_duration(run->creation, creation, sizeof creation);
    cli_duration(run->seconds, seconds, sizeof seconds);
    cli_bytes((double)rheo_world_history_bytes(world), history, sizeof history);
    printf("scene       %s (%s)\n", run->name, rheo_model_name(rheo_world_definition(world)->model));
    printf("particles   %u\n", (unsigned)rheo_world_particle_count(world));
    printf("steps       %llu in %s, after %s for the start\n", (unsigned long long)run->done, seconds, creation);
    printf("step, time  %llu, %g T\n", (unsigned long long)rheo_world_step_count(world), rheo_world_time(world));
    printf("neighbours  %.1f (mean)\n", rheo_world_mean_neighbours(world));
    if (melts(run)) {
        if (run->done > 0)
            printf("substeps    %.1f a step, of %.2f ns a particle; %.2f iterations of the solver in each\n",
                   run->substeps / (double)run->done, per_substep_update(run), run->iterations / run->substeps);
    } else {
        printf("springs     %zu\n", rheo_world_spring_count(world));
        printf("history     %s\n", history);
    }
    printf("hash        %016llx\n", (unsigned long long)rheo_world_hash(world));
    if (output)
        printf("recording   %s\n", output);
}

/* From a world to the end of its run. */
static int carry_out(run_state *run, const run_arguments *a)
{
    rheo_error error = {""};
    if (a->output) {
        const rheo_record_options options = {run->name, a->keyframes.value, a->full, a->force};
        const rheo_result result = rheo_recorder_open(run->world, a->output, &options, &run->recorder, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    int status = run->recording ? change_world(run->world, &a->set) : CLI_DONE;
    if (status == CLI_DONE)
        status = loop(run);
    const bool looped = run->outcome != NULL;
    const bool recorded = run->recorder != NULL;
    rheo_result closed = RHEO_OK;
    if (recorded) {
        const double start = cli_now();
        closed = rheo_recorder_close(run->recorder, &error);
        run->seconds += cli_now() - start;
    }
    if (closed != RHEO_OK)
        return cli_error(closed, &error);
    rheo_failure failure;
    if (recorded && rheo_world_failure(run->world, &failure))
        cli_warn("recorded up to the last good state: `rheolog doctor %s` says where and why it began", a->output);
    if (looped && a->json)
        print_json(run, a->output);
    else if (looped)
        print_text(run, a->output);
    return status;
}

static int check_usage(const run_arguments *a, int operands, char **operand)
{
    if (operands == 0 && !a->from)
        return cli_usage(&cli_run, "needs a scene: a built-in name (`rheolog scenes` lists them) or a JSON file");
    if (operands > 0 && a->from)
        return cli_usage(&cli_run, "--from brings its own scene; leave \"%s\" out", operand[0]);
    if (operands > 1)
        return cli_usage(&cli_run, "takes one scene; got \"%s\" as well", operand[1]);
    if (!a->output && (a->full || a->keyframes.given))
        return cli_usage(&cli_run, "%s says how to record; it needs -o F.rlog too",
                         a->full ? "--full" : "--keyframes");
    if (a->write_scene && (a->from || a->output))
        return cli_usage(&cli_run, "--write-scene does not run; it goes with neither -o nor --from");
    return CLI_DONE;
}

static int carry_out_arguments(run_state *run, const run_arguments *a)
{
    rheo_scene scene;
    int status = CLI_DONE;
    if (!a->from) {
        status = find_scene(a->scene, &scene);
        if (status == CLI_DONE && a->write_scene && a->steps.given)
            scene.steps = a->steps.value;
        if (status == CLI_DONE)
            status = change_scene(&scene, &a->set);
        if (status != CLI_DONE)
            return status;
        if (a->write_scene)
            return write_scene(&scene);
    }
    if (a->output && (status = cli_check_output(a->output, a->force)) != CLI_DONE)
        return status;
    if (a->output && !a->from && is_file_name(a->scene) && cli_same_file(a->scene, a->output))
        return cli_fail(CLI_BAD, "%s is the scene and cannot be written by -o too", a->scene);
    const double start = cli_now();
    status = a->from ? start_from_recording(run, a) : start_from_scene(run, &scene);
    if (status != CLI_DONE)
        return status;
    run->creation = cli_now() - start;
    run->wanted = a->steps.given ? a->steps.value : a->from ? rheo_default_scene().steps : scene.steps;
    return carry_out(run, a);
}

static int run_command(int argc, char **argv)
{
    run_arguments a = {.scene = NULL};
    const cli_option options[] = {
        {"--output", "-o", "F.rlog", CLI_TEXT, &a.output},
        {"--steps", NULL, "N", CLI_NUMBER, &a.steps},
        {"--set", NULL, "KEY=VALUE", CLI_LIST, &a.set},
        {"--keyframes", NULL, "N", CLI_NUMBER, &a.keyframes},
        {"--full", NULL, NULL, CLI_FLAG, &a.full},
        {"--from", NULL, "F.rlog[@STEP]", CLI_TEXT, &a.from},
        {"--write-scene", NULL, NULL, CLI_FLAG, &a.write_scene},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},
        {"--force", NULL, NULL, CLI_FLAG, &a.force},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {"--quiet", NULL, NULL, CLI_FLAG, &a.quiet},
        {0},
    };
    int status = cli_parse(&cli_run, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if ((status = check_usage(&a, argc, argv)) != CLI_DONE || (status = cli_use_simd(a.simd)) != CLI_DONE)
        return status;
    a.scene = argc > 0 ? argv[0] : NULL;
    run_state run = {.progress = {.quiet = a.quiet, .terminal = isatty(STDERR_FILENO) == 1}};
    status = carry_out_arguments(&run, &a);
    rheo_world_destroy(run.world);
    rheo_recording_close(run.recording);
    return status;
}

static const char help[] = {
#include "cli/help/run.txt.inc"
    0};

const cli_command cli_run = {"run", help, run_command};
