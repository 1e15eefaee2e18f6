/*
 * A user's program, compiled by installed.sh with the options of pkg-config. It prints the size of a number and the
 * hash of a small run.
 */
#include <stdio.h>

#include <rheolog/rheolog.h>

#ifndef ENTRY
#define ENTRY main
#endif

#ifdef __cplusplus
extern "C"
#endif
    int
    ENTRY(void);

int ENTRY(void)
{
    rheo_scene scene;
    rheo_error error = {""};
    rheo_world *world = NULL;
    rheo_result result = rheo_scene_builtin("bowling-ball-small", &scene, &error);
    if (result == RHEO_OK)
        result = rheo_scene_set(&scene, "particles", "300", &error);
    if (result == RHEO_OK)
        result = rheo_scene_create_world(&scene, &world, &error);
    for (int i = 0; result == RHEO_OK && i < 3; i++)
        result = rheo_world_step(world, &error);
    if (result == RHEO_OK)
        printf("%zu bytes %016llx\n", sizeof(rheo_real), (unsigned long long)rheo_world_hash(world));
    else
        fprintf(stderr, "%s\n", error.message);
    rheo_world_destroy(world);
    rheo_scene_release(&scene);
    return result != RHEO_OK;
}
