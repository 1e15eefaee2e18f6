/*
 * Stage viscosity of scheme summed (Clavet et al.; docs/model.md, 4): impulses along the lines between neighbours that
 * approach each other, at the start of the step. With u = (v_i - v_j).r_ij > 0 and w = 1 - r/h:
 *
 *     f = step w (sigma + beta u),  I = f u/max(1, F_i, F_j) r_ij;   v_i -= I/2;   v_j += I/2
 *
 * where F is the sum of f over the impulses of a particle. All impulses follow from the velocities before the stage,
 * so without the divisor many small ones might together turn a particle back; with it any viscosity is stable.
 * Coinciding particles have no direction; they get none.
 *
 * The same pass over the pairs computes their stiffness (stiffness.h).
 */
#include "thickening/stiffness.h"

typedef struct constants {
    rheo_real sigma, beta, inverse_support;
    rheo__hardening hardening;
} constants;

/* Sums of a vector of rows. */
typedef struct sums {
    rheo__lanes3 loses;
    rheo__lanes share; /* F */
    rheo__stiffness_sums stiffness;
} sums;

/* The particles of a vector of rows. */
typedef struct rows {
    rheo__lanes3 x, v;
    rheo__lanes bound; /* max(1, F_i) */
    rheo__derivatives_of_rows derivatives;
} rows;

/* What a pass over the pairs computes. */
typedef struct pass {
    bool viscosity, bounded, springs;
} pass;

RHEO__FOR_EACH_CASE void add_pair(sums *own, rheo__thickening *t, rheo_real *rest_length, size_t entry,
                                  const rows *row, pass does, const constants *c)
{
    const uint32_t *partner = t->pairs->partner + entry;
    const rheo__lanes3 d = rheo__lanes3_minus(rheo__lanes_load_at(t->position, partner), row->x);
    const rheo__lanes r2 = rheo__lanes_max(d.x * d.x + d.y * d.y + d.z * d.z, rheo__lanes_all(RHEO__LEAST_DISTANCE2)),
                      r = rheo__lanes_sqrt(r2), zero = rheo__lanes_all(0);
    if (does.springs)
        rheo__add_stiffness(&own->stiffness, t, rest_length, entry, &row->derivatives, r, &c->hardening);
    if (!does.viscosity)
        return;
    const rheo__lanes3 v = rheo__lanes3_minus(row->v, rheo__lanes_load_at(t->velocity, partner));
    const rheo__lanes w = rheo__lanes_max(1 - r * c->inverse_support, zero), inverse = r * (1 / r2);
    const rheo__lanes u = rheo__lanes_max((v.x * d.x + v.y * d.y + v.z * d.z) * inverse, zero);
    const rheo__lanes share = rheo__lanes_keep_less(zero, u, w * (c->sigma + c->beta * u));
    rheo__lanes by = share * u * RHEO__R(0.5) * inverse;
    if (does.bounded) {
        rheo__lanes other;
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            RHEO__LANE(other, lane) = t->density[partner[lane] / RHEO__POINT_VALUES];
        by /= rheo__lanes_max(row->bound, other);
    }
    own->loses.x += by * d.x;
    own->loses.y += by * d.y;
    own->loses.z += by * d.z;
    own->share += share;
}

/* Sums all rows; the new velocities are in t->pressure_acceleration. Returns the largest F. */
RHEO__FOR_EACH_CASE rheo_real sum_all(rheo__state *s, rheo__thickening *t, rheo__stiffest *stiffest, pass does,
                                      const constants *c)
{
    const rheo__lanes zero = rheo__lanes_all(0), one = rheo__lanes_all(1);
    rheo__lanes most = zero;
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own_rank[RHEO__LANES];
        rheo__own_ranks(rank, own_rank);
        const rows row = {.x = rheo__lanes_load(t->position, own_rank),
                          .v = rheo__lanes_load(t->velocity, own_rank),
                          .bound = does.bounded ? rheo__lanes_at(t->density, rank) : one,
                          .derivatives = {rheo__lanes_load(t->derivative, own_rank),
                                          rheo__lanes_load(t->derivative_before, own_rank)}};
        sums own = {{zero, zero, zero}, zero, rheo__no_stiffness()};
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        add_pair(&own, t, s->springs.rest_length, entry, &row, does, c);
        if (does.springs)
            rheo__keep_stiffness(t, stiffest, rank, &own.stiffness, &c->hardening);
        if (!does.viscosity)
            continue;
        rheo__lanes_store(t->pressure_acceleration, own_rank, rheo__lanes3_minus(row.v, own.loses));
        if (!does.bounded)
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
    const bool springs = rheo__state_has(s, RHEO__FIELD_spring_ends),
               history = rheo__state_has(s, RHEO__FIELD_derivative),
               passive = springs && history && def->history.hardening == RHEO_HARDENING_PASSIVE,
               viscosity = def->fluid.linear_viscosity > 0 || def->fluid.quadratic_viscosity > 0;
    constants c = {step * (rheo_real)def->fluid.linear_viscosity,
                   step * (rheo_real)def->fluid.quadratic_viscosity,
                   (rheo_real)(1 / def->fluid.support),
                   {(rheo_real)def->springs.stiffness, (rheo_real)def->history.stiffness,
                    (rheo_real)def->history.onset, history, passive}};
    rheo__stiffest stiffest = {-1, 0, pairs->rows, pairs->rows};
    rheo_real largest = 0;
    if (viscosity)
        rheo__gather(t->velocity, s->velocity, pairs->id_of, s->particles);
    if (springs && history)
        rheo__gather(t->derivative, s->derivative, pairs->id_of, pairs->rows);
    if (passive)
        rheo__gather(t->derivative_before, s->before[RHEO__FIELD_derivative], pairs->id_of, pairs->rows);
    /* Separate calls, so that each is compiled for its case. */
    c.hardening.history = c.hardening.passive = false;
    if (springs && viscosity && history && !passive) {
        c.hardening.history = true;
        largest = sum_all(s, t, &stiffest, (pass){.viscosity = true, .springs = true}, &c);
    } else if (springs) {
        c.hardening.history = history;
        c.hardening.passive = passive;
        largest = sum_all(s, t, &stiffest, (pass){.viscosity = viscosity, .springs = true}, &c);
    } else if (viscosity) {
        largest = sum_all(s, t, &stiffest, (pass){.viscosity = true}, &c);
    }
    if (springs)
        rheo__note_stiffest(t, &s->springs, &stiffest, &c.hardening);
    if (largest > 1)
        sum_all(s, t, NULL, (pass){.viscosity = true, .bounded = true}, &c);
    if (viscosity)
        rheo__scatter(s->velocity, t->pressure_acceleration, pairs->id_of, s->particles);
    return RHEO_OK;
}
