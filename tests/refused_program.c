/*
 * A small world that uses all SIMD loops, built by refused.sh with arbitrary options. Prints why it is refused (exit
 * code 3), or the hash after some steps. With the argument "probe" it checks the environment only.
 */
#include <stdio.h>
#include <string.h>

#include "core/environment.h"
#include "rheolog/world.h"
#include "arrays.h"

#ifndef PROBE_ALONE
enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE, STEPS = 40 };

static rheo_result run(uint64_t *hash, rheo_error *error)
{
    static rheo_real position[3 * COUNT];
    for (int i = 0; i < COUNT; i++) {
        position[3 * i] = (rheo_real)(2 * (i % SIDE)) + (rheo_real)0.125 * (rheo_real)(i % 3);
        position[3 * i + 1] = (rheo_real)(2 * (i / SIDE % SIDE) + 1);
        position[3 * i + 2] = (rheo_real)(2 * (i / SIDE / SIDE)) + (rheo_real)0.0625 * (rheo_real)(i % 5);
    }
    rheo_world_def def = rheo_default_world_def();
    def.history.window = 12;
    def.walls.plane = some_walls();
    def.walls.count = 2;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    walls_of(&def)[1] = (rheo_wall){{-1, 0, 0}, {1, 0.1, 0.2}};
    def.ball.radius = 3;
    def.ball.position[0] = def.ball.position[2] = 5;
    def.ball.position[1] = 17;
    def.ball.velocity[0] = 3;
    def.ball.spin[2] = 1;
    def.vibrators.position = some_vibrators();
    def.vibrators.count = 1;
    vibrators_of(&def)[0][0] = 4;
    def.particles.count = COUNT;
    def.particles.position = position;
    rheo_world *world;
    rheo_result result = rheo_world_create(&def, &world, error);
    const double impulse[3] = {-300, 20, 100}, point[3] = {4, 12, 6};
    for (int step = 0; step < STEPS && result == RHEO_OK; step++) {
        if (step == 20)
            result = rheo_world_push_body(world, 0, impulse, point, error);
        if (result == RHEO_OK)
            result = rheo_world_step(world, error);
    }
    *hash = result == RHEO_OK ? rheo_world_hash(world) : 0;
    rheo_world_destroy(world);
    return result;
}
#endif

int main(void)
{
    rheo_error error = {""};
    uint64_t hash = 0;
#ifdef PROBE_ALONE
    rheo_result result = rheo__check_environment(&error);
#else
    rheo_result result = run(&hash, &error);
#endif
    if (result == RHEO_ERROR_ENVIRONMENT) {
        printf("refused: %s\n", error.message);
        return 3;
    }
    printf("fit: %s %016llx\n", error.message, (unsigned long long)hash);
    return result == RHEO_OK ? 0 : 1;
}
