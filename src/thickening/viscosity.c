/*
 * Stage viscosity of scheme summed (Clavet et al.; docs/model.md, 4): impulses along the lines between neighbours that
 * approach each other, at the start of the step. With u = (v_i - v_j).r_ij > 0 and w = 1 - r/h:
 *
 *     f = step w (sigma + beta u),  I = f u/max(1, F_i, F_j) r_ij;   v_i -= I/2;   v_j += I/2
 *
 * where F is the sum of f over the impulses of a particle. All impulses follow from the velocities before the stage,
 * so without the divisor many small ones might together turn a particle back; with it any viscosity is stable.
 * Coinciding particles have no direction; they get none.
 */
#include "space/row_blocks.h"
#include "thickening/thickening.h"

typedef struct constants {
    rheo_real sigma, beta, inverse_support;
} constants;

/* Sums of a vector of rows. */
typedef struct sums {
    rheo__lanes3 loses;
    rheo__lanes share; /* F */
} sums;

/* bound: max(1, F_i), or NULL while all F are at most 1. */
static inline void add_pair(sums *own, const rheo__thickening *t, size_t entry, rheo__lanes3 xi, rheo__lanes3 vi,
                            const rheo__lanes *bound, const constants *c)
{
    const uint32_t *partner = t->pairs->partner + entry;
    const rheo__lanes3 d = rheo__lanes3_minus(rheo__lanes_load(t->position, partner), xi);
    const rheo__lanes3 v = rheo__lanes3_minus(vi, rheo__lanes_load(t->velocity, partner));
    const rheo__lanes r2 = d.x * d.x + d.y * d.y + d.z * d.z, r = rheo__lanes_sqrt(r2), inverse = 1 / r;
    const rheo__lanes w = 1 - r * c->inverse_support;
    const rheo__lanes u = (v.x * d.x + v.y * d.y + v.z * d.z) * inverse;
    const rheo__lanes share = rheo__lanes_keep((r2 > 0) & (w > 0) & (u > 0), w * (c->sigma + c->beta * u));
    rheo__lanes by = share * u * RHEO__R(0.5) * inverse;
    if (bound)
        by /= rheo__lanes_max(*bound, rheo__lanes_values(t->density, partner));
    by = rheo__lanes_keep(share > 0, by);
    own->loses.x += by * d.x;
    own->loses.y += by * d.y;
    own->loses.z += by * d.z;
    own->share += share;
}

/* Sums all rows; the new velocities are in t->pressure_acceleration. Returns the largest F. */
static inline rheo_real sum_all(rheo__thickening *t, bool bounded, const constants *c)
{
    const rheo__lanes zero = rheo__lanes_all(0), one = rheo__lanes_all(1);
    rheo__lanes most = zero;
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own_rank[RHEO__LANES];
        rheo__own_ranks(rank, own_rank);
        const rheo__lanes3 x = rheo__lanes_load(t->position, own_rank), v = rheo__lanes_load(t->velocity, own_rank);
        const rheo__lanes bound = bounded ? rheo__lanes_at(t->density, rank) : one;
        sums own = {{zero, zero, zero}, zero};
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        add_pair(&own, t, entry, x, v, bounded ? &bound : NULL, c);
        rheo__lanes_store(t->pressure_acceleration, own_rank, rheo__lanes3_minus(v, own.loses));
        if (!bounded)
            rheo__lanes_put(t->density, rank, rheo__lanes_max(own.share, one)); /* lent by stage densities */
        most = rheo__lanes_max(own.share, most);
    }
    rheo_real largest = 0;
    for (int lane = 0; lane < RHEO__LANES; lane++)
        largest = rheo__max(largest, RHEO__LANE(most, lane));
    return largest;
}

rheo_result RHEO__VARIANT(stage_viscosity)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__pairs *pairs = t->pairs;
    const rheo_world_def *def = t->def;
    const rheo_real step = (rheo_real)def->step;
    const constants c = {step * (rheo_real)def->fluid.linear_viscosity,
                         step * (rheo_real)def->fluid.quadratic_viscosity, (rheo_real)(1 / def->fluid.support)};
    rheo__gather(t->velocity, s->velocity, pairs->id_of, s->particles);
    if (sum_all(t, false, &c) > 1)
        sum_all(t, true, &c);
    rheo__scatter(s->velocity, t->pressure_acceleration, pairs->id_of, s->particles);
    return RHEO_OK;
}
