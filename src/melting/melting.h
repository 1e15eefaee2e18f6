/*
 * The melting model: declarations shared by its stages. Each stage is a file of this folder. Equations are numbered
 * as in docs/melting.md; the paper is Paiva, Petronetto, Lewiner, Tavares, "Particle-based non-Newtonian fluid
 * animation for melting objects" (2006).
 *
 * Sums over neighbours read the values at the start of a substep and write other arrays, so rows may be summed in any
 * order, side by side. In each row partners are in ascending rank.
 */
#ifndef RHEO__MELTING_MELTING_H
#define RHEO__MELTING_MELTING_H

#include "core/error.h"
#include "core/real.h"
#include "core/stage.h"
#include "space/neighbours.h"
#include "space/planes.h"

/*
 * The rows of all particles, with the kernel of each pair. Entry k of a block holds the k-th partner of each of its
 * rows, one a lane. The partners are those particles that may come closer than the support while the rows are kept;
 * the kernel of the others is 0. Rows shorter than the longest of their block end in idle entries, whose partner is
 * the row's own particle; sums of differences over a row need not tell them apart. For row i and partner j: slope
 * W'(r)/r (so that grad_i W = slope x offset, offset x_i - x_j), and weight W(r).
 */
typedef struct rheo__rows {
    uint32_t *start; /* blocks + 1: first entry */
    uint32_t blocks;
    uint32_t *row_of, *length; /* by rank: its row in m->list; number of entries that are not idle */
    uint64_t idle;             /* idle entries of all rows */
    uint64_t partners;         /* of all rows, closer than the support */
    /* Indices of the partners' first values in an array of points; this array and the next ones have entries x
     * RHEO__BLOCK_ROWS values. */
    uint32_t *partner;
    rheo_real *slope, *weight;
    size_t capacity;
    uint32_t *scratch; /* for the rows of one block: four numbers of each entry */
    uint32_t stride;
    size_t scratch_capacity;
} rheo__rows;

/*
 * The pairs of viscosity: the first entries of the rows of each block, which are as many as its row with the most
 * partners that may come closer than m->viscous_support.
 */
typedef struct rheo__bonds {
    uint32_t *start; /* blocks + 1 */
    uint32_t blocks;
    uint32_t *partner;    /* as in rheo__rows */
    rheo_real *x, *y, *z; /* sqrt(dt b_ij) x offset (viscous_operator.c) */
} rheo__bonds;

/*
 * Integrals over the wall behind a plane, for a particle at distance d from it (wall_integrals.c). z is the depth of
 * a point of the wall below the particle, z >= d.
 */
typedef struct rheo__wall_integrals {
    rheo_real weight;        /* integral of W, unit 1 */
    rheo_real gradient;      /* integral of -dW/dz, unit 1/L */
    rheo_real moment;        /* integral of -z dW/dz, unit 1 */
    rheo_real shear;         /* like moment, but over the half space instead of layers */
    rheo_real along, normal; /* integrals of z times the viscous coefficient, for both directions, unit 1/L */
} rheo__wall_integrals;

enum { RHEO__WALL_NODES = 385 };

/* A particle closer to a wall than the support. */
typedef struct rheo__contact {
    uint32_t rank, wall;
    rheo_real distance;
    rheo__wall_integrals integral;
    /* Set by stage momentum: */
    rheo_real push; /* acceleration by the pressure of the wall */
    bool detached;  /* the wall is above, and no pressure holds the particle to it */
} rheo__contact;

/* Results that the stages measure as they run. An id is -1 where there is none. */
typedef struct rheo__melting_diagnostics {
    double mean_neighbours;
    double density_error, max_density_error, max_density_id; /* |rho/rho0 - 1| */
} rheo__melting_diagnostics;

typedef struct rheo__melting {
    rheo_allocator allocator;

    const rheo_world_def *def;  /* definition in force, owned by the world */
    const rheo__planes *planes; /* walls, owned by the world */
    double support, smoothing_length, viscous_support;
    rheo_real kernel_scale; /* 1/(120 pi h^3) */
    /* What this world was made with: stages for heat, for motion and for viscosity, and temperatures. It has arrays for no
     * other. */
    bool heat, flow, viscous, warm;

    rheo_real wall_velocity[RHEO_MAX_WALLS][3];        /* along the wall; other than 0 in tests only */
    rheo__wall_integrals wall_table[RHEO__WALL_NODES]; /* by d, from 0 to the support */
    double wall_table_for;                             /* h of the table; 0: no table */
    double wall_table_scale, wall_table_spacing;

    rheo_real substep; /* duration of a substep, chosen at the start of a step */

    /* Derived in a substep; the memory is kept. Arrays are in rank order, with room for one more block. */
    rheo__neighbours list;    /* its row_start is in the order before rows were sorted by length */
    rheo__pairs pairs;        /* ranks only */
    bool searched;            /* the rows are of this step */
    rheo_real *margin;        /* by id: so far may a particle move, beyond the mean, before the next search */
    rheo__point *searched_at; /* positions at the search; w: half of viscous_support, and the margin */
    rheo__rows rows;
    rheo__bonds bonds;
    bool coinciding; /* two particles have the same position */
    rheo__contact *contact;
    uint32_t contacts;
    size_t contact_capacity;
    /*
     * at: position. A stage that sums over pairs sets its w and `more` to the values of partners that it reads: density, velocity
     * and temperature (gradients.c); eta, eta/rho and viscous_factor (viscosity.c); 1/rho, velocity and density, then
     * the drift (rates.c).
     */
    rheo__wide_point *point;
    rheo__point *velocity;        /* w: density */
    rheo__point *velocity_before; /* at the start of the substep */
    rheo__point *acceleration;
    rheo_real *temperature;
    rheo__point *heat_points;     /* temperature and factor of heat (gradients.c), in x and y */
    rheo_real *shear_rate;        /* 1/T */
    rheo_real *viscous_factor;    /* of the pairs of a particle (gradients.c) */
    rheo_real *viscosity;         /* apparent, eta */
    rheo_real *inverse_moment[6]; /* B^-1 with walls (gradients.c): xx, yy, zz, xy, xz, yz */
    rheo__point *stress[3];       /* rows of the nested stress (viscous_operator.c) */
    rheo_real *density;           /* summed */
    rheo_real *density_rate, *heat_rate;
    rheo__point *drift; /* XSPH velocity minus velocity */
    /* Conjugate gradients for A x = b (conjugate_gradient.c). */
    struct {
        rheo__point *x, *r, *z, *p, *Ap;
        rheo_real
            *block[6]; /* 3 x 3 blocks of the diagonal of A, xx, yy, zz, xy, xz, yz; inverted before iterating */
    } cg;
    rheo_real *workspace; /* memory of these arrays */
    size_t particle_capacity;

    rheo__melting_diagnostics diagnostics, diagnostics_before;
} rheo__melting;

/*
 * The longest substep for a largest speed and a largest viscosity eta, docs/melting.md (9); *reason: what sets it,
 * RHEO_FAILURE_NONE for the whole step.
 */
double rheo__melting_longest_substep(const rheo_world_def *def, double speed, double eta, bool heat,
                                     rheo_failure_reason *reason);

static inline double rheo__melting_smoothing_length(const rheo_world_def *def)
{
    return def->melting.smoothing_length > 0 ? def->melting.smoothing_length : def->fluid.spacing;
}
/* Mass of a particle. */
static inline double rheo__melting_mass(const rheo_world_def *def)
{
    const double spacing = def->fluid.spacing;
    return def->melting.rest_density * spacing * spacing * spacing;
}

/* Takes over a definition and its planes, which must outlive the model. */
void rheo__melting_configure(rheo__melting *m, const rheo_world_def *def, const rheo__planes *planes);
/* Makes room for this many particles. False: no memory, nothing changed. */
bool rheo__melting_reserve(rheo__melting *m, uint32_t particles);
void rheo__melting_release(rheo__melting *m);

/* The stages. */
#define STAGE(name, function, ...) RHEO__DECLARE_STAGE(function)
#define SIMD_STAGE(name, function, ...) RHEO__DECLARE_SIMD_STAGE(function)
#define SOLIDS_STAGE(...)
#define END_SUBSTEPS()
#include "melting/stages.def"
#undef STAGE
#undef SIMD_STAGE
#undef SOLIDS_STAGE
#undef END_SUBSTEPS

/* Fills m->rows and m->bonds, which have room, from m->list. */
typedef void rheo__fill_rows_function(rheo__melting *m);
rheo__fill_rows_function rheo__fill_rows;
RHEO__DECLARE_VARIANTS(rheo__fill_rows_function, fill_rows)

/* Finds the kernel of all pairs, for worlds where another stage needs it before momentum does. */
typedef void rheo__find_kernels_function(rheo__melting *m);
rheo__find_kernels_function rheo__find_kernels;
RHEO__DECLARE_VARIANTS(rheo__find_kernels_function, find_kernels)

/* Whether stage neighbours finds the kernel of all pairs. If not, stage momentum does. */
static inline bool rheo__needs_kernels_early(const rheo_world_def *def)
{
    return def->melting.flow != RHEO_FLOW_ON || def->melting.density == RHEO_DENSITY_SUMMATION || def->paper.leapfrog;
}

/* Makes the table of wall integrals, unless it exists. */
void rheo__wall_tables(rheo__melting *m);
/* Interpolates the table, for a distance less than the support. A negative distance counts as 0. */
rheo__wall_integrals rheo__wall_look_up(const rheo__melting *m, rheo_real distance);

/* Pairs farther apart than this in h exert no viscosity on each other: docs/melting.md (5). */
#define RHEO__VISCOUS_SUPPORT 2.5

/* Second moments with a smaller determinant get a multiple of the unit tensor. A corner of a lattice has 0.024. */
#define RHEO__LEAST_DETERMINANT 0.01

/* Whether viscosity needs the shear rate, for itself or for the factors of pairs. */
static inline bool rheo__needs_shear_rate(const rheo__melting *m)
{
    return m->viscous && m->def->melting.viscosity > 0;
}
/* Whether the heat of pairs has factors. The variants for comparison have none. */
static inline bool rheo__corrects_heat(const rheo_world_def *def)
{
    return def->melting.laplacian == RHEO_LAPLACIAN_FIRST && !def->paper.heat;
}

/*
 * Divisor of the integrals of a mirrored velocity: the distance, but at least a quarter of a spacing, so that the
 * drag on a particle at the wall is large, not infinite.
 */
static inline rheo_real rheo__inverse_wall_distance(const rheo__melting *m, const rheo__contact *contact)
{
    return 1 / rheo__max(contact->distance, (rheo_real)(0.25 * m->def->fluid.spacing));
}
/* Whether a wall drags the particle of a contact along by viscosity. */
static inline bool rheo__is_no_slip(const rheo__melting *m, const rheo__contact *contact)
{
    return !contact->detached && m->def->melting.wall == RHEO_WALL_NO_SLIP;
}
/* block = along (1 - n n^T) + normal n n^T */
static inline void rheo__wall_block(const rheo_real n[3], rheo_real along, rheo_real normal, rheo_real block[6])
{
    const rheo_real more = normal - along;
    block[0] = along + more * n[0] * n[0];
    block[1] = along + more * n[1] * n[1];
    block[2] = along + more * n[2] * n[2];
    block[3] = more * n[0] * n[1];
    block[4] = more * n[0] * n[2];
    block[5] = more * n[1] * n[2];
}
/* dt K of a particle and a wall, pairwise (viscous_operator.c). Stage viscosity has set m->point. */
static inline void rheo__contact_block(const rheo__melting *m, const rheo__contact *contact, rheo_real block[6])
{
    const rheo_real scale = m->substep * (m->point[contact->rank].more.y * m->viscous_factor[contact->rank]) *
                            rheo__inverse_wall_distance(m, contact);
    rheo__wall_block(m->planes->plane[contact->wall].normal, scale * contact->integral.along,
                     scale * contact->integral.normal, block);
}
/* Derivative across a wall of a velocity that is mirrored there, over that velocity, 1/L. */
static inline rheo_real rheo__wall_rate(const rheo__melting *m, const rheo__contact *contact)
{
    return contact->integral.shear * rheo__inverse_wall_distance(m, contact);
}

#endif
