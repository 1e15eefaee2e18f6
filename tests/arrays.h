/*
 * Zeroed arrays for the walls, vibrators and shapes of a test's definition or scene. Each call returns another array;
 * after 64 calls they are reused.
 */
#ifndef RHEO__TESTS_ARRAYS_H
#define RHEO__TESTS_ARRAYS_H

#include <string.h>

#include "rheolog/scene.h"

static inline rheo_wall *some_walls(void)
{
    static rheo_wall walls[64][8];
    static size_t next;
    return memset(walls[next++ % 64], 0, sizeof walls[0]);
}

static inline const double (*some_vibrators(void))[2]
{
    static double positions[64][32][2];
    static size_t next;
    return memset(positions[next++ % 64], 0, sizeof positions[0]);
}

static inline rheo_fill *some_fills(void)
{
    static rheo_fill fills[64][16];
    static size_t next;
    return memset(fills[next++ % 64], 0, sizeof fills[0]);
}

/* The arrays of a definition or scene that were made here, to be changed. */
static inline rheo_wall *walls_of(const rheo_world_def *def)
{
    return (rheo_wall *)(uintptr_t)def->walls.plane;
}

static inline double (*vibrators_of(const rheo_world_def *def))[2]
{
    return (double(*)[2])(uintptr_t)def->vibrators.position;
}

static inline rheo_fill *fills_of(const rheo_scene *scene)
{
    return (rheo_fill *)(uintptr_t)scene->fill;
}

#endif
