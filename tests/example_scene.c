/*
 * A program that runs a scene file as `rheolog run FILE --steps N` does, and prints the hash of the last state. To use
 * it, copy it and link it with pkg-config rheolog-scene-json.
 */
#include <stdio.h>
#include <stdlib.h>

#include <rheolog/rheolog.h>
#include <rheolog/scene_json.h>

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: example_scene FILE STEPS\n");
        return 2;
    }
    rheo_scene scene = rheo_default_scene();
    rheo_error error = {""};
    rheo_world *world = NULL;
    rheo_result result = rheo_scene_read_json(argv[1], &scene, &error);
    if (result == RHEO_OK)
        result = rheo_scene_create_world(&scene, &world, &error);
    for (int i = 0; result == RHEO_OK && i < atoi(argv[2]); i++)
        result = rheo_world_step(world, &error);
    if (result == RHEO_OK)
        printf("%016llx\n", (unsigned long long)rheo_world_hash(world));
    else
        fprintf(stderr, "%s\n", error.message);
    rheo_world_destroy(world);
    rheo_scene_release(&scene);
    return result != RHEO_OK;
}
