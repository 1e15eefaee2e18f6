/*
 * The place of a `rheolog debug` session, and its fork: a new run from a state of the recording with other parameters. The
 * fork is recorded in memory, so that one can go back in it, too; the recording stays as it is.
 */
#include "cli/debug.h"

#include <stdlib.h>
#include <string.h>

#include "rheolog/view.h"

/* ---- The place ---- */

const rheo_world *cli_debug_world(const cli_session *s)
{
    return !s->fork.tip     ? rheo_player_world(s->player)
           : s->fork.at_tip ? s->fork.tip
                            : rheo_player_world(s->fork.player);
}

uint64_t cli_debug_place(const cli_session *s, char stage[32])
{
    const rheo_world *world = cli_debug_world(s);
    rheo_world_last_stage(world, stage);
    return rheo_world_step_count(world) + (*stage != 0);
}

uint64_t cli_debug_first(const cli_session *s)
{
    return s->fork.tip ? s->fork.start : s->info.first_step;
}

uint64_t cli_debug_last(const cli_session *s)
{
    return s->fork.tip ? rheo_world_step_count(s->fork.tip) : s->info.last_step;
}

static void forget_copy(cli_fork *fork)
{
    rheo_player_close(fork->player);
    rheo_recording_close(fork->recording);
    free(fork->bytes);
    fork->player = NULL;
    fork->recording = NULL;
    fork->bytes = NULL;
}

void cli_debug_fork_release(cli_fork *fork)
{
    forget_copy(fork);
    rheo_recorder_close(fork->recorder, NULL);
    rheo_world_destroy(fork->tip);
    *fork = (cli_fork){.tip = NULL};
}

int cli_debug_recording(cli_session *s, rheo_recording **recording)
{
    cli_fork *fork = &s->fork;
    rheo_error error = {""};
    rheo_result result = RHEO_OK;
    size_t size = 0;
    if (fork->tip && !fork->recording) {
        result = rheo_recorder_copy_memory(fork->recorder, &fork->bytes, &size, &error);
        if (result == RHEO_OK)
            result = rheo_recording_open_memory(fork->bytes, size, &fork->recording, &error);
        if (result != RHEO_OK)
            forget_copy(fork);
    }
    *recording = fork->tip ? fork->recording : s->recording;
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* The player that moves the session. That of a fork starts anywhere; the caller moves it. */
static int take_player(cli_session *s, rheo_player **player)
{
    cli_fork *fork = &s->fork;
    *player = s->player;
    if (!fork->tip)
        return CLI_DONE;
    rheo_recording *recording;
    rheo_error error = {""};
    const int status = cli_debug_recording(s, &recording);
    if (status != CLI_DONE)
        return status;
    if (!fork->player) {
        const rheo_result result = rheo_player_open(recording, NULL, &fork->player, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    *player = fork->player;
    return CLI_DONE;
}

int cli_debug_seek(cli_session *s, uint64_t step)
{
    const uint64_t first = cli_debug_first(s), last = cli_debug_last(s);
    rheo_player *player;
    rheo_error error = {""};
    if (step < first || step > last)
        return cli_fail(CLI_BAD, "there is no step %llu; %s has %llu to %llu", (unsigned long long)step,
                        s->fork.tip ? "the fork" : s->file, (unsigned long long)first, (unsigned long long)last);
    if (s->fork.tip && step == last) {
        s->fork.at_tip = true;
        return CLI_DONE;
    }
    char stage[32];
    const uint64_t now = cli_debug_place(s, stage);
    const bool one_back = step + 1 == now && !*stage && !(s->fork.tip && s->fork.at_tip);
    const int status = take_player(s, &player);
    if (status != CLI_DONE)
        return status;
    const rheo_result result =
        one_back ? rheo_player_step_back(player, &error) : rheo_player_seek(player, step, &error);
    /* A fork's player that was interrupted has left the tip, too; it has a state. */
    s->fork.at_tip = false;
    return result == RHEO_OK ? CLI_DONE : cli_file_error(s->file, result, &error);
}

int cli_debug_find(cli_session *s, const char *condition, const rheo_find_options *options, rheo_search *found)
{
    rheo_player *player;
    rheo_error error = {""};
    *found = (rheo_search){.hits = 0};
    const int status = take_player(s, &player);
    if (status != CLI_DONE)
        return status;
    const rheo_result result = rheo_player_find(player, condition, options, found, &error);
    if (result == RHEO_OK && found->hits && s->fork.tip)
        s->fork.at_tip = found->found.step == cli_debug_last(s);
    return cli_debug_searched(s, result, &error);
}

int cli_debug_seek_stage(cli_session *s, uint64_t step, const char *stage)
{
    const bool at_tip = s->fork.tip && s->fork.at_tip;
    const uint64_t place = rheo_world_step_count(cli_debug_world(s));
    rheo_player *player;
    rheo_error error = {""};
    rheo_result result = RHEO_OK;
    uint32_t index;
    /* A step of the fork can be looked into once it is made, or has failed. */
    if (s->fork.tip && step == cli_debug_last(s) + 1) {
        forget_copy(&s->fork);
        s->fork.at_tip = true;
        result = rheo_recorder_step(s->fork.recorder, &error);
        if (result != RHEO_OK && result != RHEO_ERROR_STATE)
            return cli_error(result, &error);
    }
    const int status = take_player(s, &player);
    if (status != CLI_DONE)
        return status;
    if (stage)
        result = rheo_player_seek_stage(player, step, stage, &error);
    else {
        if (at_tip)
            result = rheo_player_seek(player, place, &error);
        if (result == RHEO_OK)
            result = rheo_player_stage(player, &index, &error);
    }
    const rheo_world *world = rheo_player_world(player);
    s->fork.at_tip =
        s->fork.tip && rheo_world_stages_done(world) == 0 && rheo_world_step_count(world) == cli_debug_last(s);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(s->file, result, &error);
}

/* ---- The fork ---- */

int cli_debug_run_on(cli_session *s, uint64_t steps)
{
    s->fork.at_tip = true;
    forget_copy(&s->fork);
    for (uint64_t i = 0; i < steps; i++) {
        rheo_error error = {""};
        if (cli_interrupted())
            return cli_fail(CLI_INTERRUPTED, "interrupted after step %llu of the fork",
                            (unsigned long long)cli_debug_last(s));
        const rheo_result result = rheo_recorder_step(s->fork.recorder, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

/* Makes a world with the same state and definition. */
static rheo_result copy_world(const rheo_world *world, rheo_world **copy, rheo_error *error)
{
    void *bytes = NULL;
    size_t size = 0;
    rheo_recording *checkpoint = NULL;
    rheo_result result = rheo_world_save_memory(world, "", &bytes, &size, error);
    if (result == RHEO_OK)
        result = rheo_recording_open_memory(bytes, size, &checkpoint, error);
    if (result == RHEO_OK)
        result = rheo_recording_world(checkpoint, rheo_world_step_count(world), NULL, copy, error);
    rheo_recording_close(checkpoint);
    free(bytes);
    return result;
}

/* Begins a fork at the present state, and gives it its first command. Nothing has changed after an error. */
static rheo_result begin(cli_session *s, const char *path, const char *value, rheo_error *error)
{
    char made_by[256];
    cli_fork fork = {.at_tip = true, .start = rheo_world_step_count(cli_debug_world(s))};
    snprintf(made_by, sizeof made_by, "rheolog debug, a fork of %s.rlog from step %llu", s->name,
             (unsigned long long)fork.start);
    const rheo_record_options options = {.scene = s->info.scene, .made_by = made_by};
    rheo_result result = copy_world(cli_debug_world(s), &fork.tip, error);
    if (result == RHEO_OK)
        result = rheo_recorder_open_memory(fork.tip, &options, &fork.recorder, error);
    if (result == RHEO_OK)
        result = rheo_world_set(fork.tip, path, value, error);
    if (result != RHEO_OK) {
        cli_debug_fork_release(&fork);
        return result;
    }
    cli_debug_fork_release(&s->fork);
    s->fork = fork;
    return RHEO_OK;
}

int cli_debug_set(cli_session *s, const char *text)
{
    char path[64], stage[32];
    rheo_error error = {""};
    const uint64_t step = cli_debug_place(s, stage);
    if (!cli_debug_word(&text, path, sizeof path) || !*text)
        return cli_fail(CLI_BAD, "set needs a parameter and a value, as in: set step 0.02");
    if (*stage)
        return cli_fail(CLI_BAD, "a parameter is set between steps; this is step %llu, after %s: step finishes it",
                        (unsigned long long)step, stage);
    const rheo_parameter *p = rheo_scene_parameter_find(path);
    if (p && p->scene_only)
        return cli_fail(CLI_BAD, "%s is used only to create a scene; a run does not have it", path);
    const bool had_fork = s->fork.tip != NULL, goes_on = had_fork && s->fork.at_tip;
    const rheo_result result =
        goes_on ? rheo_world_set(s->fork.tip, path, text, &error) : begin(s, path, text, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (goes_on)
        forget_copy(&s->fork);
    else
        printf("a fork begins at step %llu%s; the recording does not change\n", (unsigned long long)step,
               had_fork ? ", in place of the one before" : "");
    return CLI_DONE;
}

static int check_fork(const cli_session *s, const char *command)
{
    return s->fork.tip ? CLI_DONE : cli_fail(CLI_BAD, "%s needs a fork; `set PARAMETER VALUE` begins one", command);
}

int cli_debug_original(cli_session *s, const char *text)
{
    const uint64_t start = s->fork.start;
    int status = *text ? cli_fail(CLI_BAD, "original takes no arguments") : check_fork(s, "original");
    if (status != CLI_DONE)
        return status;
    cli_debug_fork_release(&s->fork);
    return cli_debug_seek(s, start);
}

static int save_fork(cli_session *s, const char *path)
{
    void *bytes = NULL;
    size_t size = 0;
    rheo_error error = {""};
    rheo_result result = rheo_recorder_copy_memory(s->fork.recorder, &bytes, &size, &error);
    if (result == RHEO_OK)
        result = rheo_export_bytes(path, bytes, size, false, &error);
    free(bytes);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    printf("%s: the fork, step %llu to %llu\n", path, (unsigned long long)s->fork.start,
           (unsigned long long)cli_debug_last(s));
    return CLI_DONE;
}

int cli_debug_save(cli_session *s, const char *text)
{
    char stage[32];
    rheo_error error = {""};
    const uint64_t step = cli_debug_place(s, stage);
    if (!*text)
        return cli_fail(CLI_BAD, "save needs a file, as in: save before.rlog");
    const int status = cli_check_output(text, RHEO_OUTPUT_NEW);
    if (status != CLI_DONE)
        return status;
    if (s->fork.tip)
        return save_fork(s, text);
    if (*stage)
        return cli_fail(CLI_BAD, "a state is saved between steps; this is step %llu, after %s: step finishes it",
                        (unsigned long long)step, stage);
    const rheo_result result = rheo_world_save(cli_debug_world(s), s->info.scene, text, false, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    printf("%s: the state of step %llu, hash %016llx\n", text, (unsigned long long)step,
           (unsigned long long)rheo_world_hash(cli_debug_world(s)));
    return CLI_DONE;
}

/* ---- The difference ---- */

static void print_difference(const rheo_verification *v, uint64_t step)
{
    for (uint32_t i = 0; i < v->parameter_count; i++)
        printf("%s = %s in the recording, %s in the fork\n", v->parameters[i].parameter->path, v->parameters[i].a,
               v->parameters[i].b);
    if (v->verdict == RHEO_SAME || !v->growth_count) {
        printf("step %llu: the states have the same bits\n", (unsigned long long)step);
        return;
    }
    printf("step %llu: items that differ, the largest difference, and its ratio to the field's largest value\n",
           (unsigned long long)step);
    for (uint32_t i = 0; i < v->growth_count && v->growth[i].step == v->growth[0].step; i++) {
        const rheo_growth *g = &v->growth[i];
        char largest[32] = "-", ratio[32] = "-";
        if (g->largest > 0)
            rheo_number_brief(g->largest, 3, largest);
        if (g->largest > 0 && g->scale > 0)
            rheo_number_brief(g->largest / g->scale, 2, ratio);
        printf("  %-22s %9llu  %-11s %s\n", g->field, (unsigned long long)g->count, largest, ratio);
    }
}

int cli_debug_diff(cli_session *s, const char *text)
{
    char stage[32];
    const uint64_t step = cli_debug_place(s, stage);
    void *bytes[2] = {NULL, NULL};
    size_t size[2] = {0, 0};
    rheo_verification v;
    rheo_error error = {""};
    const int status = *text ? cli_fail(CLI_BAD, "diff takes no arguments") : check_fork(s, "diff");
    if (status != CLI_DONE)
        return status;
    if (*stage)
        return cli_fail(CLI_BAD, "diff compares ends of steps; this is step %llu, after %s: step finishes it",
                        (unsigned long long)step, stage);
    if (step > s->info.last_step)
        return cli_fail(CLI_BAD, "the recording ends with step %llu; there is no step %llu to compare with",
                        (unsigned long long)s->info.last_step, (unsigned long long)step);
    rheo_result result = rheo_player_seek(s->player, step, &error);
    if (result == RHEO_OK)
        result = rheo_world_save_memory(rheo_player_world(s->player), "", &bytes[0], &size[0], &error);
    if (result == RHEO_OK)
        result = rheo_world_save_memory(cli_debug_world(s), "", &bytes[1], &size[1], &error);
    if (result == RHEO_OK)
        result = rheo_diff_memory(bytes[0], size[0], bytes[1], size[1], &v, &error);
    free(bytes[0]);
    free(bytes[1]);
    if (result != RHEO_OK)
        return cli_file_error(s->file, result, &error);
    print_difference(&v, step);
    return CLI_DONE;
}
