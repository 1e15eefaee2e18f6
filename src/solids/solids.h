/*
 * Solids: plane walls, a rigid ball, vibrating sources under the fluid. What its stages share. Walls read a
 * per-particle grip, whoever computes it.
 */
#ifndef RHEO_SOLIDS_SOLIDS_H
#define RHEO_SOLIDS_SOLIDS_H

#include "core/error.h"
#include "core/real.h"
#include "core/stage.h"

typedef struct rheo_plane {
    rheo_real normal[3]; /* unit, into the fluid */
    rheo_real offset;    /* normal . x = offset on the plane */
    bool vibrates;       /* this is the floor that sources raise */
} rheo_plane;

typedef struct rheo_solids {
    rheo_allocator allocator;
    rheo_real step, gravity[3];

    rheo_plane plane[RHEO_MAX_WALLS];
    uint32_t planes;
    rheo_real reach, tiny, sticking;

    rheo_real radius, mass, friction;
    uint32_t *touching; /* derived: ids of the particles inside the ball, ascending */
    size_t touching_capacity;

    rheo_source_kind kind;
    rheo_real amplitude, frequency, spread, wander, source_radius, height;
    rheo_real largest_bump;                /* no point of the floor is raised by more */
    rheo_real wave[RHEO_MAX_SOURCES];      /* derived in a step: sin(phase) */
    rheo_real wave_rate[RHEO_MAX_SOURCES]; /* 2 pi f cos(phase) */
} rheo_solids;

/* Takes over the parameters of a definition. */
void rheo_solids_configure(rheo_solids *solids, const rheo_world_def *def);
/* How many sources may overlap decides how high the floor can rise: to be called when sources have moved. */
void rheo_solids_sources_moved(rheo_solids *solids, const rheo_state *s);
/* Room for so many particles. False: no memory, nothing changed. */
bool rheo_solids_reserve(rheo_solids *solids, uint32_t particles);
void rheo_solids_release(rheo_solids *solids);
/* First frequencies inside the band, from the state's random numbers. */
void rheo_sources_begin(const rheo_solids *solids, rheo_state *s);

/* The stages, in the order of a step. */
rheo_result rheo_stage_sources(rheo_state *s, void *context);
rheo_result rheo_stage_ball_motion(rheo_state *s, void *context);
rheo_result rheo_stage_ball(rheo_state *s, void *context);
rheo_result rheo_stage_walls(rheo_state *s, void *context);

static inline rheo_real rheo_dot(const rheo_real a[3], const rheo_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline void rheo_cross(const rheo_real a[3], const rheo_real b[3], rheo_real out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
