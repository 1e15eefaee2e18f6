/*
 * The thickening model: what its stages share. Each stage is a file of this folder; world/create.c puts those that a
 * world needs into its list. Equations are numbered as in docs/model.md.
 */
#ifndef RHEO__THICKENING_THICKENING_H
#define RHEO__THICKENING_THICKENING_H

#include "core/error.h"
#include "core/real.h"
#include "core/stage.h"
#include "space/neighbours.h"

/* What stages find on their way; ids are -1 where there is none. */
typedef struct rheo__diagnostics {
    double stiffness_number, stiffest[2]; /* the largest kappa, and the ends of its spring */
    double largest_stiffness_sum, stiffest_particle;
    double density_error; /* mean of how far a particle is above the rest density, in rest densities */
    double largest_density, densest_particle;                       /* in rest densities */
    rheo__moved max_spring_displacement, max_pressure_displacement; /* the particle that the stage moved furthest */
    double mean_neighbours;
} rheo__diagnostics;

enum { RHEO__STEPS_AHEAD = 8 };

/*
 * Sums over the rows of the ring that were made ahead, for a block of it and the next steps (stage
 * fractional_derivative). Derived from ring and weights, whose bits they do not change.
 */
typedef struct rheo__ahead {
    rheo_real *sum;   /* RHEO__STEPS_AHEAD x blocks x RHEO__RING_BLOCK */
    uint64_t *pushed; /* of each block: how many rows had been pushed into the ring */
    size_t capacity, pushed_capacity;
    size_t blocks;      /* that they were made for, */
    uint64_t rewritten; /* and of the ring then */
    bool valid;
} rheo__ahead;

/* A memory of modes (docs/model.md, History), in the number type of the state. */
typedef struct rheo__modes {
    uint32_t count, slow;                      /* modes, the slowest first; so many of them with a second row */
    rheo_real decay[RHEO_HISTORY_MAX_MODES];   /* g, 1 - what a step leaves */
    rheo_real weight[RHEO_HISTORY_MAX_MODES];  /* w */
    rheo_real first[RHEO_HISTORY_MAX_MODES];   /* what the first velocity of all enters times */
    rheo_real leaving[RHEO_HISTORY_MAX_MODES]; /* what a velocity that leaves the window is added times */
    rheo_real filling[RHEO_HISTORY_MAX_MODES]; /* what the first one is added times when the window is full */
} rheo__modes;

/* One mode in one step: of y, of the newest velocity, of that at the far end of the window. */
typedef struct rheo__mode {
    rheo_real decay, enters, far;
} rheo__mode;

typedef struct rheo__thickening {
    rheo_allocator allocator;

    /* Constants in the number type of the state, from the definition in force. */
    rheo_real step, gravity[3];
    double support;
    rheo_real inverse_support;
    rheo_real stiffness, near_stiffness, rest_density, linear_viscosity, quadratic_viscosity;
    rheo_real spring_stiffness, plasticity, yield_ratio, history_stiffness;
    rheo_rest_length rest_length;
    rheo_spring_solver solver;

    /* Weights of the fractional derivative by lag, those of the oldest row of a window that is not full, and C0; of
     * memories of modes these. */
    rheo_real *weight, *first_weight;
    rheo_real derivative_scale;
    uint32_t window, weight_rows; /* filled rows that the weights suffice for */
    double weight_order;          /* what the weights were made for */
    rheo_weights weight_kind;
    rheo_history_kind kind;
    rheo__modes modes;

    /* Derived in a step, kept only to be used again. */
    rheo__neighbours list;
    rheo_real *derivative;            /* D^q x by id, 3 a particle */
    rheo__point *position, *velocity; /* in rank order */
    uint32_t *rank_before;            /* by rank: the rank of the same particle in the step before */
    rheo_real *density;               /* in rank order */
    void *round;                      /* what the density stage keeps of the rows of a round */
    size_t round_bytes, particle_capacity;

    rheo__ahead ahead;

    rheo__diagnostics diagnostics, diagnostics_before; /* in the last step, and when it began */
} rheo__thickening;

/* Takes over the parameters of a definition; makes the weights of `rows` lags anew if order, window or kind changed.
 * False: no memory. */
bool rheo__thickening_configure(rheo__thickening *t, const rheo_world_def *def, uint32_t window, uint32_t rows);
/* Room in the ring, if there is one, and weights, for so many filled rows. False: no memory, nothing changed. */
bool rheo__thickening_remember(rheo__thickening *t, rheo__state *s, uint64_t rows);
/* The rows of the modes that a memory of this definition has; 0 without modes. window: d in steps. */
uint32_t rheo__mode_rows(const rheo_world_def *def, uint32_t window);
/* Makes the sums anew from the ring: those that would have been gathered with the present parameters. */
void rheo__modes_remake(rheo__state *s, const rheo__thickening *t);
/* Room for so many particles. False: no memory, nothing changed. */
bool rheo__thickening_reserve(rheo__thickening *t, uint32_t particles);
void rheo__thickening_release(rheo__thickening *t);

/* The stages. */
rheo__stage_function rheo__stage_gravity, rheo__stage_neighbours_start, rheo__stage_prediction,
    rheo__stage_neighbours, rheo__stage_velocity, rheo__stage_history;
#define RHEO__THICKENING_SIMD_STAGES(X) \
    X(viscosity)                        \
    X(springs)                          \
    X(fractional_derivative)            \
    X(fractional_derivative_modes)      \
    X(spring_displacement)              \
    X(density)
RHEO__THICKENING_SIMD_STAGES(RHEO__DECLARE_SIMD_STAGE)

/* The velocities of a step become the newest of a memory that has had so many rows: all but counting them. */
void rheo__remember(rheo__state *s, const rheo__thickening *t, uint64_t rows);
/* The part of it that updates the sums of modes (history_modes.c). */
typedef void rheo__remember_function(rheo__state *s, const rheo__thickening *t, uint64_t rows);
RHEO__DECLARE_VARIANTS(rheo__remember_function, remember_modes)

/*
 * Rows of the modes: first, without a ring, the newest velocity; then y of each mode; then what rounding has cut off
 * of the slow ones.
 */
static inline uint32_t rheo__mode_slot(const rheo__state *s, uint32_t k)
{
    return rheo__ring_slot(&s->modes, (s->ring.length == 0) + k);
}
/* Of a block; if there are rows. */
static inline const rheo_real *rheo__newest_velocities(const rheo__state *s, size_t block)
{
    const rheo__ring *ring = s->ring.length ? &s->ring : &s->modes;
    return rheo__ring_block(ring, block, rheo__ring_slot(ring, 0));
}

/*
 * For looking at a state, from the memory as it is: D^q x of every particle (3 values each, by id), of one, and of
 * the difference of a pair. All give the bits that the stage gives.
 */
void rheo__derivatives(const rheo__state *s, const rheo__thickening *t, rheo_real *derivative);
void rheo__particle_derivative(const rheo__state *s, const rheo__thickening *t, uint32_t id, rheo_real d[3]);
void rheo__pair_derivative(const rheo__state *s, const rheo__thickening *t, uint32_t a, uint32_t b, rheo_real d[3]);

/* K of a spring whose ends differ by d in D^q x, and kappa = step^2 K: the bits of stage spring_displacement. */
static inline rheo_real rheo__spring_stiffness(const rheo__thickening *t, const rheo_real d[3])
{
    return t->spring_stiffness + t->history_stiffness * rheo__sqrt(rheo__length2(d[0], d[1], d[2]));
}
static inline rheo_real rheo__spring_kappa(const rheo__thickening *t, const rheo_real d[3])
{
    return t->step * t->step * rheo__spring_stiffness(t, d);
}

/*
 * The pairs of the present step: a world with springs keeps them as its springs once the springs stage has run.
 */
static inline rheo__pairs *rheo__step_pairs(rheo__state *s)
{
    return s->springs_stepped ? &s->springs.pairs : &s->springs_next.pairs;
}

#endif
