/* Solids: plane walls, obstacles, rigid balls, vibrators in the floor. Declarations shared by their stages. */
#ifndef RHEO__SOLIDS_SOLIDS_H
#define RHEO__SOLIDS_SOLIDS_H

#include "core/error.h"
#include "core/real.h"
#include "core/stage.h"
#include "space/planes.h"
#include "space/rigid_shapes.h"

/* A particle that touches the ball. */
typedef struct rheo__touch {
    uint32_t id;
    bool overlaps, active; /* active: pushes */
    double normal[3];      /* out of the ball */
    double distance;       /* from the centre of the ball */
    double velocity;       /* of the particle, along the normal */
    double target;         /* velocity along the normal after the contact, relative to the ball; 0 or less */
} rheo__touch;

typedef struct rheo__solids {
    rheo_allocator allocator;
    const rheo_world_def *def;  /* definition in force, owned by the world */
    const rheo__planes *planes; /* walls, owned by the world */
    uint32_t vibrating_wall;    /* the first wall that is a level floor, if vibrators raise it; UINT32_MAX: none */

    rheo__rigid *obstacle; /* shapes of the obstacles, made once */
    uint32_t obstacles;

    /* Set by the model. */
    const rheo_real *substep;            /* duration of a substep */
    rheo_real wall_distance;             /* walls stop particles closer than this */
    rheo_real ball_mass[RHEO_MAX_BALLS]; /* in masses of particles */
    double ball_distance;                /* the ball stops particles closer than this to its surface, */
    double friction_distance;            /* and slows those closer than this */
    const rheo_real *wall_friction;      /* derived: by id, unit 1; NULL if fluid does not stick to walls */

    /* Derived in a step, which begins with 0: largest speeds before contact; no stage reads them. */
    double ball_max_speed[RHEO_MAX_BALLS];

    rheo__touch *touch; /* derived: the particles that touch a ball, by ascending id */
    size_t touch_capacity;

    rheo_real max_bump;                      /* upper bound of the height of the raised floor */
    rheo_real wave[RHEO_MAX_VIBRATORS];      /* derived in a step: sin(phase) */
    rheo_real wave_rate[RHEO_MAX_VIBRATORS]; /* 2 pi f cos(phase) */
} rheo__solids;

/* Takes over a definition and its planes, which must outlive the solids. */
void rheo__solids_configure(rheo__solids *solids, const rheo_world_def *def, const rheo__planes *planes);
/* Finds max_bump. Must be called when vibrators have moved, since overlapping ones add up. */
void rheo__solids_vibrators_moved(rheo__solids *solids, const rheo__state *s);
/* Makes the shapes of obstacles. RHEO_ERROR_MEMORY; RHEO_ERROR_ARGUMENT: a bad mesh. */
rheo_result rheo__solids_make_obstacles(rheo__solids *solids, const rheo_world_def *def, rheo_error *error);
/* Largest speed of a point of any obstacle. */
double rheo__obstacles_speed(const rheo__solids *solids, const rheo_world_def *def);
void rheo__solids_release(rheo__solids *solids);
/* Draws the first frequencies from the state's random numbers. */
void rheo__vibrators_begin(const rheo__solids *solids, rheo__state *s);

/* The stages. */
rheo__stage_function rheo__stage_vibrators, rheo__stage_ball_push, rheo__stage_ball_motion, rheo__stage_ball,
    rheo__stage_balls, rheo__stage_obstacles;
RHEO__DECLARE_SIMD_STAGE(walls)

static inline rheo_real rheo__dot(const rheo_real a[3], const rheo_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline double rheo__dot_double(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline void rheo__cross_double(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}
static inline void rheo__cross(const rheo_real a[3], const rheo_real b[3], rheo_real out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
