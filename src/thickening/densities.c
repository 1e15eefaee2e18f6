/*
 * Stage densities of scheme summed (Clavet et al.; docs/model.md, 6): at the predicted positions, with w = 1 - r/h,
 *
 *     rho = sum w^2,  rho_near = sum w^3
 *
 * In the same pass rest lengths flow. With d = gamma L:
 *
 *     r > L + d:  L += substep alpha (r - L - d);      r < L - d:  L -= substep alpha (L - d - r)
 *
 * A pair that has come within the support gets a spring; one that has left it loses its spring. Both rows of a pair
 * compute the same bits.
 */
#include "space/row_blocks.h"
#include "thickening/thickening.h"

typedef struct constants {
    rheo_real support, inverse_support, rate, yield;
    rheo_real half_stiffness, half_near_stiffness, rest_density, least;
} constants;

/*
 * Sums of a vector of rows. within: partners within the support; together: entries at distance 0, which are
 * coinciding pairs and idle entries.
 */
typedef struct sums {
    rheo__lanes density, near_density, within, together, springs;
} sums;

static inline rheo__lanes flow(rheo__lanes length, rheo__lanes r, bool at_distance, const constants *c)
{
    const rheo__lanes zero = rheo__lanes_all(0);
    length = rheo__lanes_select(length < 0, at_distance ? r : rheo__lanes_all(c->support), length);
    const rheo__lanes tolerated = c->yield * length;
    const rheo__lanes stretched = rheo__lanes_max(r - length - tolerated, zero);
    const rheo__lanes squeezed = rheo__lanes_max(length - tolerated - r, zero);
    /* A rate above 1/(1 + gamma) per substep would overshoot; a length is never negative. */
    return rheo__lanes_max(length + c->rate * (stretched - squeezed), zero);
}

static inline void add_pair(sums *own, const rheo__thickening *t, rheo_real *rest_length, size_t entry,
                            rheo__lanes3 x, bool with_springs, bool at_distance, const constants *c)
{
    const rheo__lanes3 d = rheo__lanes3_minus(rheo__lanes_load(t->position, t->pairs->partner + entry), x);
    const rheo__lanes r2 = d.x * d.x + d.y * d.y + d.z * d.z, r = rheo__lanes_sqrt(r2);
    const rheo__mask apart = r2 > 0;
    rheo__lanes w = 1 - r * c->inverse_support;
    w = rheo__lanes_keep(apart & (w > 0), w);
    own->density += w * w;
    own->near_density += w * w * w;
    own->within += rheo__lanes_keep(w > 0, rheo__lanes_all(1));
    own->together += rheo__lanes_keep(r2 == 0, rheo__lanes_all(1));
    if (!with_springs)
        return;
    const rheo__lanes before = rheo__lanes_at(rest_length, entry), none = rheo__lanes_all(-1);
    /* Ends that coincide have no direction; their spring waits. */
    const rheo__lanes within = rheo__lanes_select(r < c->support, flow(before, r, at_distance, c), none);
    const rheo__lanes length = rheo__lanes_select(apart, within, before);
    rheo__lanes_put(rest_length, entry, length);
    own->springs += rheo__lanes_keep(length >= 0, rheo__lanes_all(1));
}

/* Numbers over all particles, so each pair counts twice. */
typedef struct numbers {
    size_t neighbours, springs;
} numbers;

/* Adds the rows of a vector to the numbers of neighbours and springs of all particles. */
static inline void sum_rows(rheo__thickening *t, rheo_real *rest_length, uint32_t block, uint32_t first,
                            bool with_springs, bool at_distance, const constants *c, numbers *ends)
{
    const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
    uint32_t own_rank[RHEO__LANES];
    rheo__own_ranks(rank, own_rank);
    const rheo__lanes3 x = rheo__lanes_load(t->position, own_rank);
    const rheo__lanes zero = rheo__lanes_all(0);
    sums own = {zero, zero, zero, zero, zero};
    RHEO__EACH_ENTRY(t->pairs, block, first, entry)
    add_pair(&own, t, rest_length, entry, x, with_springs, at_distance, c);
    /* Never below 0, also if a position is not finite: then no entry has the distance 0. */
    const rheo__lanes coinciding = rheo__lanes_max(own.together - rheo__lanes_at(t->idle_entries, rank), zero);
    t->coinciding |= rheo__lanes_any(coinciding > 0);
    own.density += coinciding; /* w = 1 */
    own.near_density += coinciding;
    rheo__lanes_put(t->density, rank, own.density);
    rheo__lanes_put(t->near_pressure, rank, c->half_near_stiffness * own.near_density);
    rheo__lanes_store_w(
        t->position, own_rank, x,
        rheo__lanes_max(c->half_stiffness * (own.density - c->rest_density), rheo__lanes_all(c->least)));
    own.within += coinciding;
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        ends->neighbours += (size_t)RHEO__LANE(own.within, lane);
        ends->springs += with_springs ? (size_t)RHEO__LANE(own.springs, lane) : 0;
    }
}

/* Diagnostics of density. Four sums, so that additions do not wait for each other. */
static void note_densities(rheo__thickening *t)
{
    const rheo__pairs *pairs = t->pairs;
    const rheo_real rest_density = (rheo_real)t->def->fluid.rest_density;
    enum { SUMS = 4 };
    double above[SUMS] = {0};
    rheo_real largest = 0;
    uint32_t densest = pairs->rows;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        above[i % SUMS] += (double)rheo__max(t->density[i] - rest_density, 0);
        if (t->density[i] > largest) {
            largest = t->density[i];
            densest = i;
        }
    }
    double scale = rest_density > 0 ? 1 / (double)rest_density : 0;
    t->diagnostics.density_error =
        pairs->rows ? ((above[0] + above[1]) + (above[2] + above[3])) * scale / pairs->rows : 0;
    t->diagnostics.largest_density = (double)largest * scale;
    t->diagnostics.densest_particle = densest < pairs->rows ? (double)pairs->id_of[densest] : -1;
}

rheo_result RHEO__VARIANT(stage_densities)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__pairs *pairs = t->pairs;
    const rheo_world_def *def = t->def;
    const constants c = {.support = (rheo_real)def->fluid.support,
                         .inverse_support = (rheo_real)(1 / def->fluid.support),
                         .rate = t->substep * (rheo_real)def->springs.plasticity,
                         .yield = (rheo_real)def->springs.yield_ratio,
                         .half_stiffness = (rheo_real)(0.5 * def->fluid.stiffness),
                         .half_near_stiffness = (rheo_real)(0.5 * def->fluid.near_stiffness),
                         .rest_density = (rheo_real)def->fluid.rest_density,
                         .least = (rheo_real)(-0.5 * def->fluid.cohesion * def->fluid.stiffness)};
    const bool with_springs = rheo__state_has(s, RHEO__FIELD_spring_ends),
               at_distance = def->springs.rest_length == RHEO_REST_DISTANCE;
    rheo_real *rest_length = s->springs.rest_length;
    numbers ends = {0, 0};
    rheo__gather(t->position, s->position, pairs->id_of, pairs->rows);
    t->coinciding = false;
    RHEO__EACH_VECTOR_OF_ROWS(pairs, block, first)
    {
        /* Separate calls, so that each is compiled for its case. */
        if (!with_springs)
            sum_rows(t, NULL, block, first, false, true, &c, &ends);
        else if (at_distance)
            sum_rows(t, rest_length, block, first, true, true, &c, &ends);
        else
            sum_rows(t, rest_length, block, first, true, false, &c, &ends);
    }
    if (with_springs)
        s->springs.count = ends.springs / 2;
    t->diagnostics.mean_neighbours = s->particles ? (double)ends.neighbours / s->particles : 0;
    if (s->bodies) {
        if (!rheo__wetting_find(s, t))
            return RHEO_ERROR_MEMORY;
        for (uint32_t k = 0; k < t->wet_count; k++) {
            const rheo__wet *wet = &t->wet[k];
            const rheo_real density = t->density[wet->rank] += wet->integrals.density;
            t->position[wet->rank].w = rheo__max(c.half_stiffness * (density - c.rest_density), c.least);
            t->near_pressure[wet->rank] += c.half_near_stiffness * wet->integrals.near_density;
        }
    }
    note_densities(t);
    return RHEO_OK;
}
