/*
 * A golden test of your own scene and code with the library alone, and the program that records for it:
 *
 *   example_plain golden.rlog           exit code 0: the run has all steps of the golden recording, bit for bit; else 1
 *   example_plain --record new.rlog     records the run, to be blessed: rheolog bless golden.rlog new.rlog --because "..."
 */
#include <stdio.h>
#include <string.h>

#include <rheolog/rheolog.h>

#include "my_scene.h"

static rheo_result record(rheo_world *world, const char *path, rheo_error *error)
{
    rheo_recorder *recorder = NULL;
    const rheo_record_options options = {.scene = "my scene", .force = true};
    rheo_result result = rheo_recorder_open(world, path, &options, &recorder, error);
    while (result == RHEO_OK && rheo_world_step_count(world) < MY_SCENE_STEPS) {
        result = my_scene_act(world, error);
        if (result == RHEO_OK)
            result = rheo_recorder_step(recorder, error);
    }
    const rheo_result closed = rheo_recorder_close(recorder, result == RHEO_OK ? error : NULL);
    return result == RHEO_OK ? closed : result;
}

static rheo_result compare(rheo_world *world, const char *path, rheo_error *error)
{
    rheo_golden *golden = NULL;
    rheo_result result = rheo_golden_open(world, path, &golden, error);
    while (result == RHEO_OK && rheo_world_step_count(world) < MY_SCENE_STEPS) {
        result = my_scene_act(world, error);
        if (result == RHEO_OK)
            result = rheo_golden_step(golden, error);
    }
    const rheo_result closed = rheo_golden_close(golden, NULL, result == RHEO_OK ? error : NULL);
    return result == RHEO_OK ? closed : result;
}

int main(int argc, char **argv)
{
    const bool records = argc == 3 && strcmp(argv[1], "--record") == 0;
    if (argc != 2 && !records) {
        fprintf(stderr, "usage: example_plain golden.rlog | --record new.rlog\n");
        return 2;
    }
    rheo_error error = {""};
    rheo_world *world = NULL;
    rheo_result result = my_scene_create(&world, &error);
    if (result == RHEO_OK)
        result = records ? record(world, argv[2], &error) : compare(world, argv[1], &error);
    if (result != RHEO_OK)
        fprintf(stderr, "%s\n", error.message);
    rheo_world_destroy(world);
    return result != RHEO_OK;
}
