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

/* Sums of a vector of rows. within: partners within the support; closest: square of the least distance. */
typedef struct sums {
    rheo__lanes density, near_density, within, closest;
} sums;

static inline rheo__lanes flow(rheo__lanes length, rheo__lanes r, bool at_distance, const constants *c)
{
    const rheo__lanes zero = rheo__lanes_all(0), born = at_distance ? r : rheo__lanes_all(c->support);
    length = rheo__lanes_if_less(length, zero, born, length);
    const rheo__lanes tolerated = c->yield * length, stretch = r - length;
    /* The part of the stretch that is tolerated stays. */
    const rheo__lanes stays = rheo__lanes_max(rheo__lanes_min(stretch, tolerated), -tolerated);
    /* A rate above 1/(1 + gamma) per substep would overshoot; a length is never negative. */
    return rheo__lanes_max(length + c->rate * (stretch - stays), zero);
}

RHEO__FOR_EACH_CASE void add_pair(sums *own, const rheo__thickening *t, rheo_real *rest_length, size_t entry,
                                  rheo__lanes3 x, bool with_springs, bool at_distance, const constants *c)
{
    const rheo__lanes3 d = rheo__lanes3_minus(rheo__lanes_load_wide_at(t->pressed, t->pairs->partner + entry), x);
    const rheo__lanes r2 = d.x * d.x + d.y * d.y + d.z * d.z, r = rheo__lanes_sqrt(r2), zero = rheo__lanes_all(0);
    const rheo__lanes w = rheo__lanes_max(1 - r * c->inverse_support, zero), w2 = w * w;
    own->density += w2;
    own->near_density += w2 * w;
    own->closest = rheo__lanes_min(own->closest, r2);
    own->within += rheo__lanes_keep_less(zero, w, rheo__lanes_all(1));
    if (with_springs) {
        const rheo__lanes length = flow(rheo__lanes_at(rest_length, entry), r, at_distance, c);
        rheo__lanes_put(rest_length, entry, rheo__lanes_if_less(zero, w, length, rheo__lanes_all(-1)));
    }
}

/* Sums the rows of a vector. Returns the number of neighbours of each. */
RHEO__FOR_EACH_CASE rheo__lanes sum_rows(rheo__thickening *t, rheo_real *rest_length, uint32_t block, uint32_t first,
                                         bool with_springs, bool at_distance, const constants *c)
{
    const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
    uint32_t own_at[RHEO__LANES];
    rheo__own_points(rank, own_at);
    const rheo__lanes3 x = rheo__lanes_load_wide_at(t->pressed, own_at);
    const rheo__lanes zero = rheo__lanes_all(0);
    sums own = {zero, zero, zero, rheo__lanes_all(c->support)};
    RHEO__EACH_ENTRY(t->pairs, block, first, entry)
    add_pair(&own, t, rest_length, entry, x, with_springs, at_distance, c);
    t->coinciding |= rheo__lanes_any(own.closest == 0);
    const rheo__lanes pressure = rheo__lanes_max(c->half_stiffness * (own.density - c->rest_density),
                                                 rheo__lanes_all(c->least)),
                      near_pressure = c->half_near_stiffness * own.near_density;
    rheo__lanes_put(t->density, rank, own.density);
    rheo_real w[RHEO__LANES], more[RHEO__LANES];
    rheo__lanes_put(w, 0, pressure);
    rheo__lanes_put(more, 0, near_pressure);
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        t->pressed[rank + lane].at.w = w[lane];
        t->pressed[rank + lane].more = more[lane];
    }
    return own.within;
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

static void gather(const rheo__state *s, rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo_real *x = s->position + 3 * (size_t)p->id_of[i];
        t->pressed[i].at = (rheo__point){x[0], x[1], x[2], 0};
    }
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
    size_t ends = 0;
    gather(s, t);
    t->coinciding = false;
    RHEO__EACH_VECTOR_OF_ROWS(pairs, block, first)
    {
        /* Separate calls, so that each is compiled for its case. */
        const rheo__lanes within = !with_springs ? sum_rows(t, NULL, block, first, false, true, &c)
                                   : at_distance ? sum_rows(t, rest_length, block, first, true, true, &c)
                                                 : sum_rows(t, rest_length, block, first, true, false, &c);
        rheo_real number[RHEO__LANES];
        rheo__lanes_put(number, 0, within);
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            ends += (uint32_t)number[lane];
    }
    if (with_springs)
        s->springs.count = ends / 2;
    t->diagnostics.mean_neighbours = s->particles ? (double)ends / s->particles : 0;
    if (s->bodies) {
        if (!rheo__wetting_find(s, t))
            return RHEO_ERROR_MEMORY;
        for (uint32_t k = 0; k < t->wet_count; k++) {
            const rheo__wet *wet = &t->wet[k];
            const rheo_real density = t->density[wet->rank] += wet->integrals.density;
            t->pressed[wet->rank].at.w = rheo__max(c.half_stiffness * (density - c.rest_density), c.least);
            t->pressed[wet->rank].more += c.half_near_stiffness * wet->integrals.near_density;
        }
    }
    note_densities(t);
    return RHEO_OK;
}
