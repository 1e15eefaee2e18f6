/*
 * rheolog run: creates a scene (run_scene.c) or starts from a state in a recording, runs and records steps, and
 * prints the cost (run_report.c).
 *
 * The time of the loop is the wall time of the steps and of their recording. It excludes the creation of the scene,
 * its settling, and the replay up to the first step.
 */
#define _POSIX_C_SOURCE 200809L
#include "cli/run.h"

#include "cli/preflight.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/shell.h"

typedef struct run_arguments {
    const char *scene, *output, *from, *simd;
    cli_number steps, keyframes, max_size;
    cli_list set;
    bool full, write_scene, force, json, resume, until_unhealthy;
} run_arguments;

/* ---- The initial state ---- */

/* Prints messages of the library while a scene is created: warnings, and unless --quiet is given what it does. */
static void library_message(const char *text, void *user)
{
    const cli_progress *p = user;
    if (!p->quiet || strncmp(text, "warning: ", 9) == 0)
        cli_print(stderr, 4, "%s\n", text);
}

static int start_from_scene(cli_run_state *run, const run_arguments *a, rheo_scene *scene)
{
    const int status = cli_check_memory(a->scene, scene, a->steps.given ? a->steps.value : scene->steps);
    if (status != CLI_DONE)
        return status;
    snprintf(run->name, sizeof run->name, "%s", scene->name);
    scene->world.log = (rheo_log){library_message, &run->progress};
    rheo_error error = {""};
    const rheo_result result = rheo_scene_create_world(scene, &run->world, &error);
    cli_preflight preflight;
    if (result == RHEO_OK && !cli_quiet() && !a->json &&
        cli_preflight_find(scene, a->steps.given ? a->steps.value : scene->steps, false, &preflight) == CLI_DONE)
        cli_preflight_brief(&preflight);
    return result == RHEO_OK ? CLI_DONE : cli_scene_error(a->scene, a->set.count > 0, result, &error);
}

/* Splits F.rlog@400, unless a file has this name. */
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
        const int status = cli_split_setting(&cli_run, set->item[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
        const rheo_parameter *p = rheo_scene_parameter_find(key);
        if (p && p->scene_only)
            return cli_fail(CLI_BAD, "%s is used only to create a scene; it cannot be set after --from", key);
        rheo_error error = {""};
        const rheo_result result = rheo_world_set(world, key, value, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

static int world_at(const char *path, rheo_recording *recording, uint64_t step, rheo_world **world)
{
    rheo_error error = {""};
    const rheo_result result = rheo_recording_world(recording, step, NULL, world, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(path, result, &error);
}

static bool same_parameters(const rheo_world_def *a, const rheo_world_def *b)
{
    char of_a[96], of_b[96];
    return !rheo_world_def_differing(a, b, &(size_t){0}, of_a, of_b);
}

/*
 * With --from, --set are commands before the first step. Compares that step of the file that is continued with this
 * run's. A file that has no step yet, or does not begin as this run, is left to the recorder.
 */
static int check_commands(const cli_run_state *run, const run_arguments *a)
{
    rheo_recording *there;
    rheo_world *recorded = NULL, *now = NULL;
    const uint64_t first = rheo_world_step_count(run->world);
    if (rheo_recording_open(a->output, &there, NULL) != RHEO_OK)
        return CLI_DONE;
    const rheo_recording_info info = rheo_recording_get_info(there);
    int status = CLI_DONE;
    if (info.first_step == first && info.last_step > first) {
        status = world_at(a->output, there, first + 1, &recorded);
        if (status == CLI_DONE)
            status = world_at(a->from, run->recording, first, &now);
        if (status == CLI_DONE)
            status = change_world(now, &a->set);
        if (status == CLI_DONE &&
            (rheo_world_step(now, NULL) != RHEO_OK || rheo_world_hash(now) != rheo_world_hash(recorded) ||
             !same_parameters(rheo_world_definition(now), rheo_world_definition(recorded))))
            status = cli_fail(
                CLI_BAD, "cannot continue %s: its first step is not that of this run; are --from and --set the same?",
                a->output);
    }
    rheo_world_destroy(recorded);
    rheo_world_destroy(now);
    rheo_recording_close(there);
    return status;
}

static int start_from_recording(cli_run_state *run, const run_arguments *a)
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
    status = cli_check_step(path, run->recording, "step", step.value);
    if (status != CLI_DONE)
        return status;
    if (a->set.count > 0) {
        /*
         * Tests every --set on the first keyframe, which needs no replay. So a bad one is found before the output is
         * created.
         */
        rheo_world *trial = NULL;
        status = world_at(path, run->recording, info.first_step, &trial);
        if (status == CLI_DONE)
            status = change_world(trial, &a->set);
        rheo_world_destroy(trial);
        if (status != CLI_DONE)
            return status;
    }
    status = world_at(path, run->recording, step.value, &run->world);
    return status == CLI_DONE && a->resume ? check_commands(run, a) : status;
}

/* ---- The loop ---- */

static void step_progress(cli_run_state *run, double start)
{
    const double time = cli_now();
    if (!cli_progress_due(&run->progress, time))
        return;
    const double seconds = time - start;
    char left[32];
    cli_duration(seconds / (double)run->done * (double)(run->wanted - run->done), left, sizeof left);
    cli_progress_say(&run->progress, time, "step %llu of %llu, %.1f ns per particle and step, %s left",
                     (unsigned long long)(run->recorded + run->done),
                     (unsigned long long)(run->recorded + run->wanted),
                     run->updates > 0 ? 1e9 * seconds / run->updates : 0., left);
}

static int loop(cli_run_state *run, const run_arguments *a)
{
    rheo_world_reset_times(run->world);
    int status = CLI_DONE;
    run->outcome = "done";
    const double start = cli_now();
    run->progress.last = start;
    while (run->done < run->wanted && !(a->until_unhealthy && run->unhealthy)) {
        if (cli_interrupted()) {
            cli_progress_end(&run->progress);
            run->outcome = "interrupted";
            snprintf(run->reason.message, sizeof run->reason.message, "interrupted after %llu of %llu step%s",
                     (unsigned long long)(run->recorded + run->done),
                     (unsigned long long)(run->recorded + run->wanted), cli_plural(run->recorded + run->wanted));
            status =
                cli_fail(CLI_INTERRUPTED, "%s%s%s%s", run->reason.message,
                         run->recorder ? "; the same command with --continue" : "",
                         run->recorder && a->force ? " instead of --force" : "", run->recorder ? " goes on" : "");
            break;
        }
        rheo_error error = {""};
        const double particles = rheo_world_particle_count(run->world);
        const rheo_result result =
            run->recorder ? rheo_recorder_step(run->recorder, &error) : rheo_world_step(run->world, &error);
        if (result != RHEO_OK) {
            cli_progress_end(&run->progress);
            run->outcome = result == RHEO_ERROR_LIMIT ? "limit" : "failed";
            run->reason = error;
            status =
                result == RHEO_ERROR_LIMIT
                    ? cli_fail(CLI_DIFFERS, "%s; the same command with --continue%s and a larger --max-size goes on",
                               error.message, a->force ? " instead of --force" : "")
                    : cli_error(result, &error);
            break;
        }
        run->done++;
        cli_run_examine(run);
        run->updates += particles;
        const double substeps = cli_metric(run->world, "substeps");
        run->substeps += substeps;
        run->substep_updates += particles * substeps;
        run->iterations += cli_metric(run->world, "iterations");
        step_progress(run, start);
    }
    run->seconds = cli_now() - start;
    cli_progress_end(&run->progress);
    if (status == CLI_DONE && a->until_unhealthy && run->unhealthy) {
        run->outcome = "unhealthy";
        status = CLI_DIFFERS;
    }
    return status;
}

/* Says at the start how large the recording will become, and what the limit will do. */
static void say_size(const cli_run_state *run)
{
    char expected[32], fewest[32], bytes[32], limit[32];
    const double all = rheo_recorder_expected_bytes(run->recorder, run->wanted),
                 least = rheo_recorder_expected_fewest_bytes(run->recorder, run->wanted),
                 most = run->max_bytes ? (double)run->max_bytes : all;
    cli_bytes(all, expected, sizeof expected);
    cli_bytes(least, fewest, sizeof fewest);
    cli_bytes((double)rheo_recorder_bytes(run->recorder), bytes, sizeof bytes);
    cli_bytes(most, limit, sizeof limit);
    if (least > most)
        fprintf(stderr,
                "the recording would have about %s even with the fewest keyframes; --max-size (%s) will end the run "
                "early; it has %s now\n",
                fewest, limit, bytes);
    else if (all > most)
        fprintf(stderr,
                "the recording would have about %s; keyframes will be left out for --max-size (%s); it has %s now\n",
                expected, limit, bytes);
    else
        fprintf(stderr, "the recording will have about %s; it has %s now\n", expected, bytes);
}

/* The last line of a run that went on although it is ill. */
static void say_unhealthy(const cli_run_state *run, const char *output)
{
    char text[320], word[CLI_FILE_WORD];
    cli_run_unhealthy(run, text, sizeof text);
    fflush(stdout);
    if (output)
        cli_warn("%s: `rheolog doctor %s`", text, cli_file_word(output, word));
    else
        cli_warn("%s; with -o F.rlog, `rheolog doctor F.rlog` says why", text);
}

/* Records and runs the world, and prints the result. */
static int carry_out(cli_run_state *run, const run_arguments *a)
{
    rheo_error error = {""};
    if (a->output) {
        const rheo_record_options options = {.scene = run->name,
                                             .keyframe_spacing = a->keyframes.value,
                                             .full = a->full,
                                             .force = a->force,
                                             .made_by = run->made_by,
                                             .scene_text = run->scene_text,
                                             .max_bytes = a->max_size.value};
        const uint64_t first = rheo_world_step_count(run->world);
        const rheo_result result =
            a->resume ? rheo_recorder_continue(&run->world, a->output, &options, &run->recorder, &error)
                      : rheo_recorder_open(run->world, a->output, &options, &run->recorder, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        if (run->begins_again && !cli_quiet())
            fprintf(stderr, "%s had no whole keyframe yet: it is begun again\n", a->output);
        run->recorded = rheo_world_step_count(run->world) - first;
        run->wanted -= run->recorded;
        run->max_bytes = a->max_size.value;
    }
    int status = run->recording && !run->recorded ? change_world(run->world, &a->set) : CLI_DONE;
    if (status == CLI_DONE)
        status = cli_run_watch(run, a->output);
    if (status == CLI_DONE && run->recorder && !cli_quiet())
        say_size(run);
    if (status == CLI_DONE)
        status = loop(run, a);
    const bool looped = run->outcome != NULL;
    const bool recorded = run->recorder != NULL;
    rheo_result closed = RHEO_OK;
    if (recorded) {
        run->spacing = rheo_recorder_keyframe_spacing(run->recorder);
        run->left_out = rheo_recorder_keyframes_left_out(run->recorder);
        const double start = cli_now();
        closed = rheo_recorder_close(run->recorder, &error);
        run->seconds += cli_now() - start;
    }
    if (closed != RHEO_OK) {
        status = cli_error(closed, &error);
        run->outcome = "failed";
        if (!run->reason.message[0])
            run->reason = error;
    }
    run->bytes = recorded ? cli_file_bytes(a->output) : 0;
    if (looped && a->json) {
        cli_run_json(run, a->output);
        run->reported = true;
    }
    if (closed != RHEO_OK)
        return status;
    rheo_failure failure;
    char word[CLI_FILE_WORD];
    if (recorded && rheo_world_failure(run->world, &failure))
        cli_warn("recorded up to the last good state: `rheolog doctor %s` says where and why it began",
                 cli_file_word(a->output, word));
    if (looped && !a->json)
        cli_run_text(run, a->output);
    if (looped && run->unhealthy)
        say_unhealthy(run, a->output);
    return status;
}

/* An option that was given although there is no run or no recording that it concerns; NULL: none. */
static const char *pointless(const run_arguments *a)
{
    const struct {
        bool given, of_recording;
        const char *name;
    } options[] = {
        {a->resume, true, "--continue"},
        {a->force, true, "--force"},
        {a->full, true, "--full"},
        {a->keyframes.given, true, "--keyframes"},
        {a->max_size.given, true, "--max-size"},
        {a->output != NULL, false, "-o"},
        {a->from != NULL, false, "--from"},
        {a->until_unhealthy, false, "--until-unhealthy"},
    };
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (options[i].given && (a->write_scene || (options[i].of_recording && !a->output)))
            return options[i].name;
    return NULL;
}

static int check_usage(const run_arguments *a, int operands, char **operand)
{
    if (operands == 0 && !a->from)
        return cli_usage(&cli_run, "needs a scene: a built-in name (`rheolog scenes` lists them) or a JSON file");
    if (operands > 0 && a->from)
        return cli_usage(&cli_run, "--from brings its own scene; leave \"%s\" out", operand[0]);
    if (operands > 1)
        return cli_usage(&cli_run, "takes one scene; got \"%s\" as well", operand[1]);
    const char *name = pointless(a);
    if (name && a->write_scene)
        return cli_usage(&cli_run, "--write-scene prints the scene and does not run; leave %s out", name);
    if (name)
        return cli_usage(&cli_run, "%s needs -o F.rlog: without it nothing is recorded", name);
    if (a->resume && a->force)
        return cli_usage(&cli_run, "--continue goes on with the file that --force would replace; give one of them");
    return CLI_DONE;
}

/* Keeps what the recording will say about how it was made. A scene that is too large for it is left out. */
static int tell_how(cli_run_state *run, const run_arguments *a, const rheo_scene *scene)
{
    run->made_by =
        cli_made_by(&(cli_run_request){a->scene, a->from, &a->set, a->keyframes.value, a->max_size.value, a->full});
    run->scene_text = a->from ? NULL : cli_scene_text(scene, a->scene);
    if (!run->made_by || (!a->from && !run->scene_text))
        return cli_fail(CLI_SYSTEM, "no memory for the command line and the scene of the recording");
    if (run->scene_text && strlen(run->scene_text) > RHEO_MAX_MADE_TEXT)
        run->scene_text[0] = 0;
    return CLI_DONE;
}

/*
 * Refuses to continue a recording that is longer than the run. Other reasons are found with the initial state. *begun: the
 * recording has a keyframe.
 */
static int check_length(const char *path, uint64_t steps, bool *begun)
{
    rheo_recording *recording;
    *begun = false;
    if (rheo_recording_open(path, &recording, NULL) != RHEO_OK)
        return CLI_DONE;
    const rheo_recording_info info = rheo_recording_get_info(recording);
    rheo_recording_close(recording);
    *begun = true;
    if (info.last_step - info.first_step <= steps)
        return CLI_DONE;
    return cli_fail(CLI_BAD, "cannot continue %s: it has %llu step%s, more than the %llu of this run", path,
                    (unsigned long long)(info.last_step - info.first_step),
                    cli_plural(info.last_step - info.first_step), (unsigned long long)steps);
}

/* Runs the command. `scene` is empty; it becomes SCENE if there is one. */
static int carry_out_arguments(cli_run_state *run, const run_arguments *a, rheo_scene *scene)
{
    int status = CLI_DONE;
    if (!a->from) {
        status = cli_find_scene(&cli_run, a->scene, scene);
        if (status == CLI_DONE && a->write_scene && a->steps.given)
            scene->steps = a->steps.value;
        if (status == CLI_DONE)
            status = cli_change_scene(&cli_run, scene, &a->set);
        if (status != CLI_DONE)
            return status;
        if (a->write_scene)
            return cli_write_scene(a->scene, a->set.count > 0, scene);
    }
    cli_watch_signals(); /* not before: one that is caught would not end the wait for a scene from a pipe */
    const rheo_output_use use = a->resume ? RHEO_OUTPUT_CONTINUE : a->force ? RHEO_OUTPUT_REPLACE : RHEO_OUTPUT_NEW;
    if (a->output && (status = cli_check_output(a->output, use)) != CLI_DONE)
        return status;
    const uint64_t steps = a->steps.given ? a->steps.value : scene->steps;
    bool begun;
    if (a->resume && (status = check_length(a->output, steps, &begun)) != CLI_DONE)
        return status;
    run->begins_again = a->resume && !begun && cli_exists(a->output);
    if (a->output && (status = tell_how(run, a, scene)) != CLI_DONE)
        return status;
    const double start = cli_now();
    status = a->from ? start_from_recording(run, a) : start_from_scene(run, a, scene);
    if (status != CLI_DONE)
        return status;
    run->creation = cli_now() - start;
    run->wanted = steps;
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
        {"--max-size", NULL, "SIZE", CLI_SIZE, &a.max_size},
        {"--full", NULL, NULL, CLI_FLAG, &a.full},
        {"--from", NULL, "F.rlog[@STEP]", CLI_TEXT, &a.from},
        {"--write-scene", NULL, NULL, CLI_FLAG, &a.write_scene},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},
        {"--force", NULL, NULL, CLI_FLAG, &a.force},
        {"--continue", NULL, NULL, CLI_FLAG, &a.resume},
        {"--until-unhealthy", NULL, NULL, CLI_FLAG, &a.until_unhealthy},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_run, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    a.scene = argc > 0 ? argv[0] : NULL;
    if ((status = check_usage(&a, argc, argv)) != CLI_DONE || (status = cli_use_simd(a.simd)) != CLI_DONE) {
        if (a.json)
            cli_run_refused_json(a.scene, a.output, status);
        return status;
    }
    cli_run_state run = {.set = &a.set, .progress = cli_progress_begin(0)};
    rheo_scene scene = rheo_default_scene();
    cli_outlive_readers();
    status = carry_out_arguments(&run, &a, &scene);
    if (status != CLI_DONE && a.json && !run.reported)
        cli_run_refused_json(a.scene, a.output, status);
    rheo_scene_release(&scene);
    rheo_health_close(run.health);
    rheo_world_destroy(run.world);
    rheo_recording_close(run.recording);
    free(run.made_by);
    free(run.scene_text);
    return status;
}

static const char help[] = {
#include "cli/help/run.txt.inc"
    0};

const cli_command cli_run = {"run", help, run_command};
