/*
 * The melting model: what its stages share. Each stage is a file of this folder; world/create.c puts those that a
 * world needs into its list. Equations are numbered as in docs/melting.md; the paper is Paiva, Petronetto, Lewiner,
 * Tavares, "Particle-based non-Newtonian fluid animation for melting objects" (2006).
 *
 * Sums over neighbours read the state of a substep's start and write derived arrays: no particle sees what another
 * has become, so any number of rows can be summed side by side. In each row partners come by ascending rank.
 */
#ifndef RHEO__MELTING_MELTING_H
#define RHEO__MELTING_MELTING_H

#include "core/error.h"
#include "core/real.h"
#include "core/stage.h"
#include "space/neighbours.h"

/* Rows that lie side by side in a block: the most lanes that any target has. */
enum { RHEO__BLOCK_ROWS = 16 };

/*
 * The rows of all particles, with what the kernel makes of each pair. Entry k of a block holds the k-th partners of
 * its rows, one a lane; rows that are shorter than the block's longest end in entries of no weight whose partner is
 * the row's own particle. Of row i and partner j: offset x_i - x_j, slope W'(r)/r, so that grad_i W = slope x offset,
 * and weight W(r).
 */
typedef struct rheo__rows {
    uint32_t *start; /* blocks + 1: first entry */
    uint32_t blocks;
    uint32_t *partner; /* entries x RHEO__BLOCK_ROWS ranks, as all arrays below */
    rheo_real *x, *y, *z, *slope, *weight;
    rheo_real *bond_x, *bond_y, *bond_z; /* what viscosity makes of the pair: see viscosity.c */
    size_t capacity, block_capacity;
} rheo__rows;

/*
 * Integrals over the wall behind a plane, for a particle at a distance d from it (melting/wall_integrals.c). z is how
 * far a point of the wall lies below the particle, z >= d.
 */
typedef struct rheo__wall_integrals {
    rheo_real weight;        /* of W, 1 */
    rheo_real gradient;      /* of -dW/dz, 1/L */
    rheo_real moment;        /* of -z dW/dz, 1 */
    rheo_real shear;         /* the same, over the half space instead of layers */
    rheo_real along, normal; /* of z times the viscous bond, along the wall and normal to it, 1/L */
} rheo__wall_integrals;

enum { RHEO__WALL_NODES = 385 };

/* A particle closer to a wall than the support. */
typedef struct rheo__contact {
    uint32_t rank, wall;
    rheo_real distance;
    rheo__wall_integrals of;
    bool loose; /* the wall is above, and nothing presses the particle to it: found by the stage momentum */
} rheo__contact;

/* What stages find on their way; ids are -1 where there is none. */
typedef struct rheo__melting_diagnostics {
    double mean_neighbours;
    double density_error, max_density_error, max_density_id; /* |rho/rho0 - 1| */
} rheo__melting_diagnostics;

typedef struct rheo__melting {
    rheo_allocator allocator;

    /* Constants in the number type of the state, from the definition in force. */
    const rheo_world_def *def; /* the world's own */
    double support, smoothing_length, mass;
    rheo_real gravity[3];
    rheo_real kernel_scale; /* 1/(120 pi h^3) */

    /* Walls. */
    rheo_real wall_normal[RHEO_MAX_WALLS][3], wall_offset[RHEO_MAX_WALLS];
    rheo_real wall_velocity[RHEO_MAX_WALLS][3]; /* along the wall; 0 but in tests */
    uint32_t walls;
    rheo__wall_integrals wall_table[RHEO__WALL_NODES]; /* by d, from 0 to the support */
    double wall_table_for;                             /* h that it was made for; 0: none */
    double wall_table_scale, wall_table_spacing;

    bool heat;         /* this world was made with the stages of it */
    rheo_real substep; /* duration of a substep, chosen at the start of a step */

    /* Derived in a substep, kept only to be used again; arrays are in rank order, with room for a whole block more.
     */
    rheo__neighbours list;
    rheo__pairs pairs;
    rheo__rows rows;
    bool coinciding; /* some particles lie at one place */
    rheo__contact *contact;
    uint32_t contacts;
    size_t contact_capacity;
    rheo__point *position;
    rheo__point *velocity;        /* w: density */
    rheo__point *velocity_before; /* of the substep's start */
    rheo__point *velocity_last;   /* by id: at the start of the substep before, in the same step */
    bool has_last;                /* this is not the first substep of its step */
    rheo__point *acceleration;
    rheo_real *shear_rate; /* intensity of D, 1/T */
    rheo_real *viscosity;  /* apparent, eta */
    rheo__point *viscous;  /* eta, eta/rho: what a bond is made of */
    rheo__point *residual, *direction, *image, *solution;
    rheo_real *diagonal[6]; /* of the viscous system: xx, yy, zz, xy, xz, yz; inverted */
    rheo_real *gradient[6]; /* D or S, in the same order */
    rheo_real *temperature; /* in rank order */
    rheo_real *density_rate, *heat_rate;
    rheo__point *drift; /* what XSPH adds to a velocity */
    rheo_real *slab;    /* the memory of all of them */
    size_t particle_capacity;

    rheo__melting_diagnostics diagnostics, diagnostics_before;
} rheo__melting;

static inline double rheo__melting_smoothing_length(const rheo_world_def *def)
{
    return def->melting.smoothing_length > 0 ? def->melting.smoothing_length : def->fluid.spacing;
}

/* Takes over the parameters of a definition, which stays where it is. */
void rheo__melting_configure(rheo__melting *m, const rheo_world_def *def);
/* Room for so many particles. False: no memory, nothing changed. */
bool rheo__melting_reserve(rheo__melting *m, uint32_t particles);
void rheo__melting_release(rheo__melting *m);

/* The stages, in the order of a step; those that are kernels run in the form for the target in use. */
rheo_result rheo__stage_substeps(rheo__state *s, void *context);
rheo_result rheo__stage_melting_neighbours(rheo__state *s, void *context);
rheo_result rheo__stage_summation(rheo__state *s, void *context);
rheo_result rheo__stage_momentum(rheo__state *s, void *context);
rheo_result rheo__stage_viscous(rheo__state *s, void *context);
rheo_result rheo__stage_rates(rheo__state *s, void *context);
rheo_result rheo__stage_integration(rheo__state *s, void *context);

/* Makes the table of walls, if it is not there yet. */
void rheo__wall_tables(rheo__melting *m);
/* From the table, for a distance less than the support; what is behind the wall counts as on it. */
rheo__wall_integrals rheo__wall_look_up(const rheo__melting *m, rheo_real distance);

/* J(T), and the apparent viscosity of a shear rate. */
double rheo__melting_jump(const rheo_world_def *def, double temperature);
double rheo__melting_viscosity(const rheo_world_def *def, double jump, double shear_rate);

/* The shear rate is needed where the viscosity depends on it. */
static inline bool rheo__needs_shear_rate(const rheo_world_def *def)
{
    return def->melting.rheology == RHEO_RHEOLOGY_JUMP && def->melting.viscosity > 0;
}

/*
 * What divides the integrals of a mirrored velocity: the distance, but at least a quarter of a spacing, so that a
 * particle on the wall is held firmly, not infinitely.
 */
static inline rheo_real rheo__inverse_wall_distance(const rheo__melting *m, const rheo__contact *contact)
{
    return 1 / rheo__max(contact->distance, (rheo_real)(0.25 * m->def->fluid.spacing));
}
/* How fast a velocity that is mirrored at a wall changes across it, against the velocity itself, 1/L. */
static inline rheo_real rheo__wall_rate(const rheo__melting *m, const rheo__contact *contact)
{
    return contact->of.shear * rheo__inverse_wall_distance(m, contact);
}

#endif
