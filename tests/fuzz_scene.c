/*
 * Fuzz target of scene files and of parameter texts: `=path=value`, or `~path=value` for the melting model. Property:
 * an accepted scene or parameter can be written, and reads back as the same.
 */
#include <string.h>

#include "fuzz_support.h"
#include "rheolog/rheolog.h"
#include "rheolog/scene_json.h"

/* Limits of one input, because a valid scene may have millions of particles. */
enum { MOST_BYTES = 64 * 1024, MOST_PARTICLES = 300, MOST_STEPS = 20 };

static void make_world(const rheo_scene *scene)
{
    rheo_world *world;
    rheo_error error;
    uint64_t particles;
    if (rheo_scene_particle_count(scene, &particles, &error) != RHEO_OK || particles > MOST_PARTICLES ||
        scene->settle.time > MOST_STEPS * scene->world.step)
        return;
    if (rheo_scene_create_world(scene, &world, &error) != RHEO_OK) {
        HOLDS(!world);
        return;
    }
    for (int i = 0; i < 3 && rheo_world_step(world, &error) == RHEO_OK; i++)
        HOLDS(rheo_world_step_count(world) == (uint64_t)i + 1);
    rheo_world_destroy(world);
}

static void read_scene(const char *text, size_t size)
{
    static rheo_scene scene, again;
    rheo_error error;
    if (rheo_scene_from_json(text, size, "folder/fuzz.json", &scene, &error) != RHEO_OK) {
        HOLDS(memchr(error.message, 0, sizeof error.message));
        return;
    }
    char *written = rheo_scene_to_json(&scene);
    HOLDS(written);
    HOLDS(rheo_scene_from_json(written, strlen(written), "again.json", &again, &error) == RHEO_OK);
    char *twice = rheo_scene_to_json(&again);
    HOLDS(twice && strcmp(written, twice) == 0);
    free(written);
    free(twice);
    make_world(&scene);
    rheo_scene_release(&scene);
    rheo_scene_release(&again);
}

static void read_parameter(const char *bytes, size_t size, rheo_model model)
{
    char text[512], value[96];
    rheo_scene scene = rheo_default_model_scene(model);
    rheo_error error;
    size = size < sizeof text ? size : sizeof text - 1;
    memcpy(text, bytes, size);
    text[size] = 0;
    char *path = text, *equals = strchr(text, '=');
    if (!equals)
        return;
    *equals = 0;
    if (rheo_scene_set(&scene, path, equals + 1, &error) != RHEO_OK) {
        HOLDS(*rheo_scene_parameter_nearest(path));
        return;
    }
    HOLDS(rheo_scene_get(&scene, path, value, sizeof value) == RHEO_OK);
    rheo_scene again = scene;
    char twice[96];
    HOLDS(rheo_scene_set(&again, path, value, &error) == RHEO_OK);
    HOLDS(rheo_scene_get(&again, path, twice, sizeof twice) == RHEO_OK && strcmp(value, twice) == 0);
}

void drive(const uint8_t *bytes, size_t size)
{
    if (size > MOST_BYTES)
        return;
    if (size && (*bytes == '=' || *bytes == '~'))
        read_parameter((const char *)bytes + 1, size - 1, *bytes == '~' ? RHEO_MODEL_MELTING : RHEO_MODEL_THICKENING);
    else
        read_scene((const char *)bytes, size);
}

#ifndef RHEO__LIBFUZZER
int main(int argc, char **argv)
{
    return read_arguments(argc, argv, "scenes and parameters");
}
#endif
