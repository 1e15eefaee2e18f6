/*
 * The thickening model: declarations shared by its stages. Each stage is a file of this folder. Equations are
 * numbered as in docs/model.md.
 */
#ifndef RHEO__THICKENING_THICKENING_H
#define RHEO__THICKENING_THICKENING_H

#include "core/error.h"
#include "core/real.h"
#include "core/stage.h"
#include "space/neighbours.h"
#include "thickening/materials.h"

enum { RHEO__PLATES = 2 };

/* Results that the stages measure as they run. An id is -1 where there is none. */
typedef struct rheo__diagnostics {
    double substeps;                      /* 1 in a scheme without them */
    double stiffness_number, stiffest[2]; /* largest kappa, and the ends of its spring */
    double largest_stiffness_sum, stiffest_particle;
    double density_error;                     /* mean excess over the rest density, in rest densities */
    double largest_density, densest_particle; /* in rest densities */
    double softened_springs;                  /* whose stiffness is lower than K; scheme summed */
    rheo__moved max_spring_displacement, max_pressure_displacement; /* largest displacement by the stage */
    double mean_neighbours;
    double plate_force[RHEO__PLATES][3]; /* mean of the step, as in rheo_plate */
} rheo__diagnostics;

/* Shares of the ball in the sums of a particle at a distance from its surface (wetting.c). */
typedef struct rheo__wetting_integrals {
    rheo_real density, near_density; /* unit 1 */
    rheo_real push, near_push;       /* factors of P and P_near, unit 1 */
} rheo__wetting_integrals;

enum { RHEO__WETTING_NODES = 65 };

/* A particle closer to the ball than the support. */
typedef struct rheo__wet {
    uint32_t rank, ball;
    rheo_real normal[3]; /* out of the ball */
    rheo__wetting_integrals integrals;
} rheo__wet;

/* Where idle entries of schemes summed and positions point: further away than the support from all particles. */
#define RHEO__NOWHERE ((rheo__point){0x1.6a09e6p60F, 0x1.bb67aep60F, 0x1.1e377ap60F, 0})
/*
 * Square of the least distance at which pairs have a direction: 2.5e-11 supports, far below the spacing of floats in a
 * scene. It scales as all lengths do. Its inverse is finite.
 */
static inline rheo_real rheo__least_distance2(const rheo_world_def *def)
{
    const double h = def->fluid.support, square = 6.25e-22 * (h * h), floor = 1e-36;
    return (rheo_real)(square > floor ? square : floor);
}

enum { RHEO__STEPS_AHEAD = 8 };

/*
 * Scheme summed bears k substep^2/h, k_near substep^2/h and sums of kappa up to the first of these, and no run is well
 * beyond the second (docs/debugging.md). Stage substeps keeps three quarters of the first.
 */
#define RHEO__STABLE_PRESSURE 0.06
#define RHEO__UNSTABLE_PRESSURE 0.085
#define RHEO__STABLE_NEAR_PRESSURE 0.1
#define RHEO__UNSTABLE_NEAR_PRESSURE 0.18
#define RHEO__STABLE_STIFFNESS_SUM 2.0
/* The same for k step^2/h in scheme sequential. */
#define RHEO__SEQUENTIAL_STABLE_PRESSURE 0.16
#define RHEO__SEQUENTIAL_UNSTABLE_PRESSURE 0.2

/*
 * Partial sums over the rows of the ring for the next steps (stage fractional_derivative). They follow from ring and
 * weights, and using them changes no bits.
 */
typedef struct rheo__ahead {
    rheo_real *sum;   /* [block][RHEO__STEPS_AHEAD][RHEO__RING_BLOCK] */
    uint64_t *pushed; /* for each block: ring.pushed when the sums were made */
    size_t capacity, pushed_capacity;
    size_t blocks;      /* number of blocks then */
    uint64_t rewritten; /* ring.rewritten then */
    bool valid;
} rheo__ahead;

/* A memory of modes (docs/model.md, History), in the number type of the state. */
typedef struct rheo__modes {
    uint32_t count, slow;                      /* modes, slowest first; the first `slow` of them have a second row */
    uint32_t window;                           /* d, if velocities leave the sums; else 0 */
    rheo_real decay[RHEO_HISTORY_MAX_MODES];   /* g = 1 - factor of a step */
    rheo_real weight[RHEO_HISTORY_MAX_MODES];  /* w */
    rheo_real first[RHEO_HISTORY_MAX_MODES];   /* factor of the very first velocity */
    rheo_real leaving[RHEO_HISTORY_MAX_MODES]; /* factor of a velocity that leaves the window */
    rheo_real filling[RHEO_HISTORY_MAX_MODES]; /* factor of the very first one when the window fills */
} rheo__modes;

enum { RHEO__MOST_SAMPLES = 64 };

/*
 * A memory of positions (fractional_derivative_lengths.c): their lags from history.lag on, and the weights of the differences of
 * length between two of them.
 */
typedef struct rheo__samples {
    uint32_t count, lag[RHEO__MOST_SAMPLES];
    rheo_real weight[RHEO__MOST_SAMPLES];
    double order; /* of the weights, and their kind */
    rheo_weights kind;
    rheo__point *point; /* by rank: `count` sampled positions each */
    size_t capacity;
} rheo__samples;

/* One mode in one step: factors of y, of the newest velocity and of that at the far end of the window. */
typedef struct rheo__mode {
    rheo_real decay, enters, far;
} rheo__mode;

typedef struct rheo__thickening {
    rheo_allocator allocator;

    const rheo_world_def *def;  /* definition in force, owned by the world */
    const rheo__period *period; /* likewise */
    bool springs, history,
        sticking; /* this world was made with them (sticking: at walls); it has no arrays of others */
    rheo__material material[RHEO__MATERIALS];

    /*
     * Weights of a memory of kind window: of the fractional derivative by lag, and of the oldest row until the window
     * is full. Other memories have modes.
     */
    rheo_real *weight, *first_weight;
    rheo_real derivative_scale;   /* C0 */
    uint32_t window, weight_rows; /* window d, and the number of rows that have weights */
    double weight_order;          /* order q of the weights */
    rheo_weights weight_kind;     /* kind of the weights */
    rheo__modes modes;
    rheo__samples samples;

    rheo_real ball_mass[RHEO_MAX_BALLS]; /* in masses of particles */
    double obstacle_speed;               /* largest speed of a point of an obstacle; 0 without */
    rheo_real substep;                   /* duration of a substep; in a scheme without them: of the step */

    /* Derived in a step; the memory is kept. Arrays are in rank order unless it says by id. */
    rheo__neighbours list;
    const rheo__pairs *pairs;                    /* found_pairs, or the pairs of the springs */
    rheo__pairs found_pairs;                     /* found by the stages neighbours_start and neighbours */
    rheo__point *position, *velocity;            /* of scheme sequential, within a stage; share memory with `point` */
    rheo__point *derivative, *derivative_before; /* D^q x of this step and the one before, within a stage */
    rheo_real *wall_friction;                    /* by id, share of its history stiffness; NULL without sticking */
    rheo_real *density;
    uint32_t *rank_before; /* scheme sequential: the rank of the particle in the previous step */
    void *round;           /* workspace of stage density */
    size_t round_bytes;
    rheo_real *workspace; /* memory of the arrays of particles */
    size_t particle_capacity;
    /* Of schemes summed and positions. */
    /*
     * What a pass over pairs reads of a partner. Stage viscosity: position and velocity. Stages densities and forces:
     * predicted position, w: half the pressure, more.x: half the near pressure. With several materials, stage viscosity
     * also: k_min in w, k_hist in more.w, the onset in w of the derivative; stage densities: substep x plasticity in
     * more.y, the yield ratio in more.z.
     */
    rheo__wide_point *point;
    uint64_t list_made_for;   /* state->rewritten + 1 when the list was made; 0: there is none */
    rheo_real *stiffness_sum; /* of the springs of a particle, 1/T^2; NULL without springs and history */
    rheo_real *multiplier;    /* scheme positions: m of a particle; has the memory of stiffness_sum */
    rheo__place *place;       /* workspace of stage neighbours, as is `carried`; has the memory of rank_before */
    rheo_real *carried;
    rheo_real max_stiffness, max_stiffness_sum;
    rheo__point *pressure_acceleration, *spring_acceleration;
    rheo_real *pair_stiffness; /* K of every pair, parallel to pairs->partner */
    size_t pair_capacity;
    rheo_real *pair_derivative; /* |D^q of the length| of every pair, likewise; of history.of length */
    size_t pair_derivative_capacity;
    bool coinciding; /* two particles have the same position */
    rheo__wetting_integrals wetting[RHEO_MAX_BALLS]
                                   [RHEO__WETTING_NODES]; /* of a ball, by distance, from 0 to the support */
    rheo__wet *wet;
    uint32_t wet_count;
    size_t wet_capacity;

    rheo__ahead ahead;

    rheo__diagnostics diagnostics, diagnostics_before; /* of the last step, and those before it */
} rheo__thickening;

/*
 * Takes over a definition, which must outlive the model. Makes weights of `rows` lags if order, window or kind
 * changed. False: no memory.
 */
bool rheo__thickening_configure(rheo__thickening *t, const rheo_world_def *def, uint32_t window, uint32_t rows);
/*
 * Makes room for this many filled rows in the ring, if there is one, and weights. False: no memory, nothing changed.
 */
bool rheo__thickening_remember(rheo__thickening *t, rheo__state *s, uint64_t rows);
/* Rows that a memory of this definition, in steps, has: of the ring, if there is one, and of modes, 0 without. */
uint32_t rheo__ring_rows(const rheo_world_def *def);
uint32_t rheo__mode_rows(const rheo_world_def *def);
/* Recomputes the sums of modes from the ring, with the present parameters. */
void rheo__modes_remake(rheo__state *s, const rheo__thickening *t);
/*
 * In periodic space, these write what images have of their particles: points, whose coordinates are rounded first; half
 * pressures in points; and arrays by rank. They do nothing where there are no images.
 */
void rheo__images_of_points(rheo__thickening *t);
void rheo__images_of_pressures(rheo__thickening *t);
void rheo__images_of_vectors(const rheo__pairs *pairs, rheo__point *value);
void rheo__images_of_numbers(const rheo__pairs *pairs, rheo_real *value);

/* Makes room for this many particles and their images. False: no memory, nothing changed. */
bool rheo__thickening_reserve(rheo__thickening *t, uint32_t particles);
void rheo__thickening_release(rheo__thickening *t);

/* The stages. */
#define STAGE(name, function, ...) RHEO__DECLARE_STAGE(function)
#define SIMD_STAGE(name, function, ...) RHEO__DECLARE_SIMD_STAGE(function)
#define SOLIDS_STAGE(...)
#define END_SUBSTEPS()
#include "thickening/stages.def"
#undef STAGE
#undef SIMD_STAGE
#undef SOLIDS_STAGE
#undef END_SUBSTEPS

/*
 * Substeps in a step of a definition: as many as it gives, or the least number that stage substeps chooses. 1 in a
 * scheme without substeps.
 */
uint64_t rheo__thickening_least_substeps(const rheo_world_def *def);

/* Gives particles from `first` on their fields of plates; those that are added later belong to none. */
void rheo__plates_begin(rheo__state *s, const rheo_world_def *def, uint32_t first);
/* Displacement of the upper plate with its oscillation. */
void rheo__plate_displacement(const rheo__state *s, const rheo_world_def *def, double displacement[3]);
/* rheo_world_plate() */
bool rheo__plates_query(const rheo__state *s, const rheo__thickening *t, uint32_t plate, rheo_plate *values);

/* Makes the tables of integrals over the balls. */
void rheo__wetting_make(rheo__thickening *t);
/* Distance from the centre of a ball below which a particle is wet. */
rheo_real rheo__wetting_reach(const rheo__thickening *t, uint32_t ball);
/* Adds those of `count` particles from this rank on that a ball wets to t->wet. False: no memory. */
bool rheo__wetting_find(const rheo__state *s, rheo__thickening *t, uint32_t ball, uint32_t rank, uint32_t count);
/* Adds the forces between them and the balls. */
void rheo__wetting_push(rheo__state *s, rheo__thickening *t);

/*
 * Substeps that a step of scheme summed needs, at most max_substeps. stiffness_sum: largest sum of K over the springs
 * of a particle; speed2: square of the largest speed.
 */
uint64_t rheo__substeps_for(const rheo_world_def *def, double stiffness_sum, double speed2);

/* Whether the history is that of the lengths of springs, not of the vectors between their ends. */
static inline bool rheo__history_of_lengths(const rheo_world_def *def)
{
    return def->history.of == RHEO_HISTORY_OF_LENGTH;
}
/* Sampled positions of a memory of lengths with this window. */
uint32_t rheo__sample_count(uint32_t window);
/* Makes lags and weights, if they are not those of the definition. False: no memory. */
bool rheo__samples_make(rheo__samples *samples, const rheo_allocator *allocator, const rheo_world_def *def,
                        uint32_t window);
/* Samples that are needed for this many steps between positions; the last one stands for the oldest position. */
static inline uint32_t rheo__samples_used(const rheo__samples *samples, uint32_t steps)
{
    uint32_t used = 1;
    while (used < samples->count && samples->lag[used - 1] < steps)
        used++;
    return used;
}
/* Makes a memory of positions that of particles at rest, from this particle on. */
void rheo__remember_rest(rheo__state *s, uint32_t first);
/* Makes the memory that of particles that have always moved with their velocity, from this particle on. */
void rheo__remember_motion(rheo__state *s, const rheo__thickening *t, uint32_t first);

/* Stores the velocities or positions as the newest of a memory that already has `rows` rows. Does not change that number. */
void rheo__remember(rheo__state *s, const rheo__thickening *t, uint64_t rows);
/* Type of the function that updates the sums of modes (history_modes.c). */
typedef void rheo__remember_function(rheo__state *s, const rheo__thickening *t, uint64_t rows);
RHEO__DECLARE_VARIANTS(rheo__remember_function, remember_modes)

/*
 * Of `rows` rows of history, those that count: they are at least the lag old. The newest of them has the lag in the
 * ring.
 */
static inline uint64_t rheo__old_rows(const rheo__thickening *t, uint64_t rows)
{
    if (rheo__history_of_lengths(t->def) && rows) /* two positions have one velocity */
        rows--;
    return rows > t->def->history.lag ? rows - t->def->history.lag : 0;
}

/*
 * Rows of the modes: without a ring, first the newest velocity; then y of each mode; then the accumulated rounding
 * errors of the slow modes.
 */
static inline uint32_t rheo__mode_slot(const rheo__state *s, uint32_t k)
{
    return rheo__ring_slot(&s->modes, (s->ring.length == 0) + k);
}
/* The newest velocities of a block that count; there must be some. Only a ring has a lag. */
static inline const rheo_real *rheo__newest_velocities(const rheo__state *s, const rheo__thickening *t, size_t block)
{
    const rheo__ring *ring = s->ring.length ? &s->ring : &s->modes;
    return rheo__ring_block(ring, block, rheo__ring_slot(ring, t->def->history.lag));
}

/*
 * For queries: D^q x of every particle (3 values each, by id) and of one particle. They have the bits that the stage
 * computes.
 */
void rheo__derivatives(const rheo__state *s, const rheo__thickening *t, rheo_real *derivative);
void rheo__particle_derivative(const rheo__state *s, const rheo__thickening *t, uint32_t id, rheo_real d[3]);
/* |D^q of the length| of a pair, with history.of length. */
rheo_real rheo__length_derivative(const rheo__state *s, const rheo__thickening *t, uint32_t a, uint32_t b);

/* Scheme positions: the positions, by rank. */
static inline void rheo__positions_gather(const rheo__state *s, rheo__thickening *t)
{
    for (uint32_t i = 0; i < t->pairs->rows; i++) {
        const rheo_real *x = s->position + 3 * (size_t)t->pairs->id_of[i];
        t->point[i].at = (rheo__point){x[0], x[1], x[2], 0};
    }
}

/* Duration of a substep: of the last one, or before the first step that of the definition. */
static inline rheo_real rheo__present_substep(const rheo__state *s, const rheo__thickening *t)
{
    const bool summed = rheo__state_has(s, RHEO__FIELD_substeps);
    const uint64_t last = summed ? *s->substeps : 1, count = last ? last : t->def->substeps;
    return (rheo_real)(t->def->step / (double)(count ? count : 1));
}

/* The material of a particle. */
static inline const rheo__material *rheo__material_at(const rheo__state *s, const rheo__thickening *t, uint32_t id)
{
    return &t->material[s->material ? s->material[id] : 0];
}
/* Parameter of a spring between two materials; that of either if they have the same. */
static inline rheo_real rheo__mean(rheo_real a, rheo_real b)
{
    return RHEO__R(0.5) * (a + b);
}

/*
 * K of the spring between two particles with this n, |D^q| of its history, and kappa = substep^2 K. Bits as in the
 * stages viscosity and spring_displacement.
 */
static inline rheo_real rheo__spring_stiffness(const rheo__state *s, const rheo__thickening *t, uint32_t a,
                                               uint32_t b, rheo_real n)
{
    const rheo__material *of_a = rheo__material_at(s, t, a), *of_b = rheo__material_at(s, t, b);
    const rheo_real onset = rheo__mean(of_a->onset, of_b->onset);
    return rheo__mean(of_a->k_min, of_b->k_min) +
           rheo__mean(of_a->k_hist, of_b->k_hist) * (n > 0 ? n * (n / (n + onset)) : 0);
}
static inline rheo_real rheo__spring_kappa(const rheo__state *s, const rheo__thickening *t, uint32_t a, uint32_t b,
                                           rheo_real n)
{
    const rheo_real substep = rheo__present_substep(s, t);
    return substep * substep * rheo__spring_stiffness(s, t, a, b, n);
}

#endif
