/*
 * Solids: plane walls, a rigid ball, vibrating vibrators under the fluid. What its stages share. Walls read a
 * per-particle wall_friction, whoever computes it.
 */
#ifndef RHEO__SOLIDS_SOLIDS_H
#define RHEO__SOLIDS_SOLIDS_H

#include "core/error.h"
#include "core/real.h"
#include "core/stage.h"

typedef struct rheo__plane {
    rheo_real normal[3]; /* unit, into the fluid */
    rheo_real offset;    /* normal . x = offset on the plane */
    bool vibrates;       /* this is the floor that vibrators raise */
} rheo__plane;

typedef struct rheo__solids {
    rheo_allocator allocator;
    rheo_real step, gravity[3];

    rheo__plane plane[RHEO_MAX_WALLS];
    uint32_t planes;
    rheo_real reach, tiny, sticking;

    rheo_real radius, mass, friction;
    uint32_t *touching; /* derived: ids of the particles inside the ball, ascending */
    size_t touching_capacity;

    rheo_vibrator_kind kind;
    rheo_real amplitude, frequency, spread, wander, vibrator_radius, height;
    rheo_real largest_bump;                  /* no point of the floor is raised by more */
    rheo_real wave[RHEO_MAX_VIBRATORS];      /* derived in a step: sin(phase) */
    rheo_real wave_rate[RHEO_MAX_VIBRATORS]; /* 2 pi f cos(phase) */
} rheo__solids;

/* Takes over the parameters of a definition. */
void rheo__solids_configure(rheo__solids *solids, const rheo_world_def *def);
/* How many vibrators may overlap decides how high the floor can rise: to be called when vibrators have moved. */
void rheo__solids_vibrators_moved(rheo__solids *solids, const rheo__state *s);
/* Room for so many particles. False: no memory, nothing changed. */
bool rheo__solids_reserve(rheo__solids *solids, uint32_t particles);
void rheo__solids_release(rheo__solids *solids);
/* First frequencies inside the band, from the state's random numbers. */
void rheo__vibrators_begin(const rheo__solids *solids, rheo__state *s);

/* The stages, in the order of a step. */
rheo_result rheo__stage_vibrators(rheo__state *s, void *context);
rheo_result rheo__stage_ball_motion(rheo__state *s, void *context);
rheo_result rheo__stage_ball(rheo__state *s, void *context);
rheo_result rheo__stage_walls(rheo__state *s, void *context);

static inline rheo_real rheo__dot(const rheo_real a[3], const rheo_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline void rheo__cross(const rheo_real a[3], const rheo_real b[3], rheo_real out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
