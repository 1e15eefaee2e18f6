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
#include "core/account_lanes.h"
#include "core/field_sums.h"
#include "thickening/stiffness.h"

typedef struct constants {
    rheo_real sigma, beta, inverse_support, least2; /* square of the least distance */
    rheo__hardening hardening;
} constants;

/* Sums of a vector of rows. */
typedef struct sums {
    rheo__lanes3 loses; /* twice the loss of velocity */
    rheo__lanes share;  /* F */
    rheo__stiffness_sums stiffness;
} sums;

/* The particles of a vector of rows. */
typedef struct rows {
    rheo__wide_lanes point; /* position and velocity */
    rheo__lanes bound;      /* max(1, F_i) */
    rheo__derivatives_of_rows derivatives;
} rows;

static inline rheo__stiffness_of stiffness_of(const rheo__wide_lanes *point, const constants *c)
{
    const rheo__lanes zero = rheo__lanes_all(0);
    return c->hardening.materials ? (rheo__stiffness_of){point->w, point->more_w} : (rheo__stiffness_of){zero, zero};
}

/* What a pass over the pairs computes. */
typedef struct pass {
    bool viscosity, bounded, springs;
} pass;

RHEO__FOR_EACH_CASE void add_pair(sums *own, const rheo__wide_point *point, const rheo_real *bound,
                                  const rheo__stiffness_arrays *a, size_t entry, const rows *row, pass does,
                                  const constants *c, const rheo__keeper *keeper)
{
    const uint32_t *partner = a->partner + entry;
    const rheo__wide_lanes other = rheo__lanes_load_wide_at(point, partner);
    const rheo__lanes3 d = rheo__lanes3_minus(other.at, row->point.at);
    const rheo__lanes r2 = rheo__lanes_max(d.x * d.x + d.y * d.y + d.z * d.z, rheo__lanes_all(c->least2)),
                      r = rheo__lanes_sqrt(r2), zero = rheo__lanes_all(0);
    if (does.springs)
        rheo__add_stiffness(&own->stiffness, a, entry, &row->derivatives, stiffness_of(&row->point, c),
                            stiffness_of(&other, c), r, &c->hardening);
    if (!does.viscosity)
        return;
    const rheo__lanes3 v = rheo__lanes3_minus(row->point.more, other.more);
    const rheo__lanes w = rheo__lanes_max(1 - r * c->inverse_support, zero), inverse = r * (1 / r2);
    const rheo__lanes u = rheo__lanes_max((v.x * d.x + v.y * d.y + v.z * d.z) * inverse, zero);
    const rheo__lanes share = w * (c->sigma + c->beta * u); /* where u > 0 */
    rheo__lanes by = share * u * inverse;
    if (does.bounded) {
        rheo__lanes bound_of_other;
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            RHEO__LANE(bound_of_other, lane) = bound[partner[lane] / RHEO__POINT_VALUES];
        by /= rheo__lanes_max(row->bound, bound_of_other);
    }
    rheo__keep_pair(keeper, RHEO__SUM_viscosity, RHEO_SOURCE_VISCOSITY, entry, by, d);
    own->loses.x += by * d.x;
    own->loses.y += by * d.y;
    own->loses.z += by * d.z;
    own->share = rheo__lanes_add_if_less(zero, u, own->share, share);
}

/* Sums all rows; the new velocities are in t->pressure_acceleration. Returns the largest F. */
RHEO__FOR_EACH_CASE rheo_real sum_all(rheo__state *s, rheo__thickening *t, const rheo_real *rest_length,
                                      rheo__stiffest *stiffest, pass does, const constants *c)
{
    const rheo__wide_point *point = t->point;
    rheo_real *bound = t->density; /* lent by stage densities */
    const rheo__stiffness_arrays a = {t->derivative, t->derivative_before,   t->pairs->partner, t->pair_derivative,
                                      rest_length,   s->springs.rest_length, t->pair_stiffness};
    const rheo__lanes zero = rheo__lanes_all(0), one = rheo__lanes_all(1);
    rheo__lanes most = zero;
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        rows row = {.point = rheo__lanes_load_wide_row(point + rank),
                    .bound = does.bounded ? rheo__lanes_at(bound, rank) : one,
                    .derivatives = {{zero, zero, zero}, {zero, zero, zero}, zero}};
        if (c->hardening.history)
            row.derivatives.now = rheo__lanes_load_row(a.derivative + rank);
        if (c->hardening.passive)
            row.derivatives.before = rheo__lanes_load_row(a.derivative_before + rank);
        if (c->hardening.history && c->hardening.materials)
            row.derivatives.now = rheo__lanes_load_row_w(a.derivative + rank, &row.derivatives.onset);
        const rheo__keeper keeper = rheo__keeper_of(s, t->pairs, rank);
        sums own = {{zero, zero, zero}, zero, rheo__no_stiffness()};
        rheo__keep_begin(&keeper, RHEO__SUM_viscosity);
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        add_pair(&own, point, bound, &a, entry, &row, does, c, &keeper);
        if (does.springs)
            rheo__keep_stiffness(t, stiffest, rank, &own.stiffness, stiffness_of(&row.point, c), &c->hardening);
        if (does.springs && s->spring_sums.wanted) /* the rest lengths are in the nearest cache now */
            RHEO__VARIANT(add_rest_lengths)(&s->spring_sums, &s->springs, block, first);
        if (!does.viscosity)
            continue;
        const rheo__lanes3 v = row.point.more, sum = own.loses;
        const rheo_real half = RHEO__R(0.5);
        rheo__lanes_store_row(t->pressure_acceleration + rank,
                              (rheo__lanes3){v.x - half * sum.x, v.y - half * sum.y, v.z - half * sum.z});
        if (!does.bounded)
            rheo__lanes_put(bound, rank, rheo__lanes_max(own.share, one));
        most = rheo__lanes_max(own.share, most);
    }
    rheo_real largest = 0;
    for (int lane = 0; lane < RHEO__LANES; lane++)
        largest = rheo__max(largest, RHEO__LANE(most, lane));
    return largest;
}

static void gather(const rheo__state *s, rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo_real *x = s->position + 3 * (size_t)p->id_of[i], *v = s->velocity + 3 * (size_t)p->id_of[i];
        t->point[i] = (rheo__wide_point){{x[0], x[1], x[2], 0}, {v[0], v[1], v[2], 0}};
    }
}

/* The parameters of materials beside positions, velocities and derivatives. */
static void gather_materials(const rheo__state *s, rheo__thickening *t, bool history, bool passive)
{
    const rheo__pairs *p = t->pairs;
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo__material *m = rheo__material_at(s, t, p->id_of[i]);
        t->point[i].at.w = m->k_min;
        t->point[i].more.w = m->k_hist;
        if (history)
            t->derivative[i].w = m->onset;
        if (passive)
            t->derivative_before[i].w = m->onset;
    }
}

rheo_result RHEO__VARIANT(stage_viscosity)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__pairs *pairs = t->pairs;
    const rheo_world_def *def = t->def;
    const rheo_real step = (rheo_real)def->step;
    const bool springs = rheo__state_has(s, RHEO__FIELD_spring_ends),
               history = rheo__state_has(s, RHEO__FIELD_history_rows),
               lengths = rheo__state_has(s, RHEO__FIELD_history_position),
               passive = springs && history && !lengths && def->history.hardening == RHEO_HARDENING_PASSIVE,
               materials = springs && rheo__state_has(s, RHEO__FIELD_material),
               viscosity = def->fluid.linear_viscosity > 0 || def->fluid.quadratic_viscosity > 0;
    constants c = {step * (rheo_real)def->fluid.linear_viscosity,
                   step * (rheo_real)def->fluid.quadratic_viscosity,
                   (rheo_real)(1 / def->fluid.support),
                   rheo__least_distance2(def),
                   {(rheo_real)def->springs.stiffness, (rheo_real)def->history.stiffness,
                    (rheo_real)def->history.onset, (rheo_real)def->fluid.support, history, passive, materials,
                    lengths}};
    const rheo_real *rest_length = passive ? rheo__state_renew_rest_lengths(s) : s->springs.rest_length;
    if (passive && !rest_length)
        return RHEO_ERROR_MEMORY;
    rheo__stiffest stiffest = {-1, 0, pairs->rows, pairs->rows};
    rheo_real largest = 0;
    gather(s, t);
    if (springs && history && !lengths)
        rheo__gather(t->derivative, s->derivative, pairs->id_of, pairs->rows);
    if (passive)
        rheo__gather(t->derivative_before, s->before[RHEO__FIELD_derivative], pairs->id_of, pairs->rows);
    if (materials)
        gather_materials(s, t, history, passive);
    rheo__images_of_points(t);
    if (springs && history)
        rheo__images_of_vectors(pairs, t->derivative);
    if (passive)
        rheo__images_of_vectors(pairs, t->derivative_before);
    /* Separate calls, so that each is compiled for its case. */
    c.hardening.history = c.hardening.passive = c.hardening.materials = c.hardening.lengths = false;
    if (lengths) {
        c.hardening.history = c.hardening.lengths = true;
        c.hardening.materials = materials;
        largest = sum_all(s, t, rest_length, &stiffest, (pass){.viscosity = viscosity, .springs = true}, &c);
    } else if (materials) {
        c.hardening = (rheo__hardening){.support = c.hardening.support, .materials = true};
        c.hardening.history = history;
        c.hardening.passive = passive;
        largest = sum_all(s, t, rest_length, &stiffest, (pass){.viscosity = viscosity, .springs = true}, &c);
    } else if (springs && viscosity && history && !passive) {
        c.hardening.history = true;
        largest = sum_all(s, t, rest_length, &stiffest, (pass){.viscosity = true, .springs = true}, &c);
    } else if (springs) {
        c.hardening.history = history;
        c.hardening.passive = passive;
        largest = sum_all(s, t, rest_length, &stiffest, (pass){.viscosity = viscosity, .springs = true}, &c);
    } else if (viscosity) {
        largest = sum_all(s, t, rest_length, &stiffest, (pass){.viscosity = true}, &c);
    }
    s->spring_sums.made = s->spring_sums.wanted;
    if (springs)
        rheo__note_stiffest(t, &s->springs, &stiffest, &c.hardening);
    if (largest > 1) {
        rheo__images_of_numbers(pairs, t->density);
        sum_all(s, t, NULL, NULL, (pass){.viscosity = true, .bounded = true}, &c);
    }
    if (!viscosity)
        return RHEO_OK;
    if (rheo__keeps_any(s))
        rheo__account_apply(s, RHEO__FIELD_velocity, RHEO_SOURCE_SUM, -RHEO__R(0.5), RHEO__SUM_viscosity);
    rheo__scatter(s->velocity, t->pressure_acceleration, pairs->id_of, s->particles);
    return RHEO_OK;
}
