/* A small world of the melting model with every kind of state: molten above, solid below, between inclined walls. */
#ifndef RHEO__TESTS_MELTING_H
#define RHEO__TESTS_MELTING_H

#include "support.h"

enum { MELTING_MOST = 1000 };

/*
 * side^3 particles that move relative to each other. `values` has 7 numbers each: positions, velocities,
 * temperatures.
 */
static inline rheo_world_def melting_def(uint32_t side, rheo_real *values)
{
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    const uint32_t count = side * side * side;
    rheo_real *position = values, *velocity = values + 3 * count, *temperature = values + 6 * count;
    def.fluid.spacing = 0.1;
    def.melting.sound_speed = 5;
    def.melting.diffusivity = 0.01;
    def.walls.plane = some_walls();
    def.walls.count = 2;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0.25, 1, 0}};
    walls_of(&def)[1] = (rheo_wall){{-0.1, 0, 0}, {1, 0, 0.5}};
    for (uint32_t i = 0; i < count; i++) {
        const rheo_real x = (rheo_real)(i % side), y = (rheo_real)(i / side % side), z = (rheo_real)(i / side / side);
        position[3 * i] = (rheo_real)0.1 * x + (rheo_real)0.01 * (rheo_real)(i % 3);
        position[3 * i + 1] = (rheo_real)0.1 * y + (rheo_real)0.05;
        position[3 * i + 2] = (rheo_real)0.1 * z + (rheo_real)0.01 * (rheo_real)(i % 2);
        velocity[3 * i] = (rheo_real)0.05 * y;
        velocity[3 * i + 1] = (rheo_real)-0.02 * x;
        velocity[3 * i + 2] = (rheo_real)0.03 * (rheo_real)(i % 5);
        temperature[i] = (y + (rheo_real)0.25) / (rheo_real)side;
    }
    def.particles.count = count;
    def.particles.position = position;
    def.particles.velocity = velocity;
    def.particles.temperature = temperature;
    return def;
}

/* The same world with other parameters: pairs of path and value, ended by NULL. */
static inline rheo_world *melting_world(uint32_t side, const char *const *set)
{
    rheo_real values[7 * MELTING_MOST];
    rheo_world_def def = melting_def(side, values);
    rheo_world *world;
    for (; set && *set; set += 2)
        OK(rheo_world_def_set(&def, set[0], set[1], &error));
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

#endif
