/*
 * Stage forces of scheme summed (Clavet et al.; Ozgen et al., Eq. 6; docs/model.md, 7): all forces between pairs, at
 * the predicted positions. With w = 1 - r/h, P = k (rho - rho0) and P_near = k_near rho_near, particle i (of mass 1)
 * has the acceleration
 *
 *     a = sum [ -(P_i + P_j) w/2 - (P_near_i + P_near_j) w^2/2 + K (r - L)/2 ] r_ij
 *     v += substep a,  x += substep^2 a
 *
 * No force reads what another has moved, and the forces of a pair are opposite to the last bit.
 */
#include "core/account_lanes.h"
#include "space/row_blocks.h"
#include "thickening/thickening.h"

/* Accelerations of a vector of rows. */
typedef struct sums {
    rheo__lanes3 pressure, spring; /* `spring` is twice the acceleration */
} sums;

/* What a pass over the pairs reads: copies, so that no store makes the compiler load them again. */
typedef struct arrays {
    const rheo__wide_point *point;
    const uint32_t *partner;
    const rheo_real *rest_length, *stiffness;
} arrays;

RHEO__FOR_EACH_CASE void add_pair(sums *own, const arrays *a, size_t entry, const rheo__wide_lanes *row,
                                  rheo_real inverse_support, rheo_real least2, bool with_springs, bool with_pressure,
                                  const rheo__keeper *keeper)
{
    const rheo__wide_lanes other = rheo__lanes_load_wide_at(a->point, a->partner + entry);
    const rheo__lanes3 d = rheo__lanes3_minus(other.at, row->at);
    /* Coinciding pairs have no direction, so all this is 0: see part(). */
    const rheo__lanes r2 = rheo__lanes_max(d.x * d.x + d.y * d.y + d.z * d.z, rheo__lanes_all(least2)),
                      r = rheo__lanes_sqrt(r2), inverse = r * (1 / r2), zero = rheo__lanes_all(0);
    if (with_pressure) {
        const rheo__lanes w = rheo__lanes_max(1 - r * inverse_support, zero);
        const rheo__lanes push = w * ((row->w + other.w) + w * (row->more.x + other.more.x));
        const rheo__lanes by = push * inverse;
        rheo__keep_pair(keeper, RHEO__SUM_pressure, RHEO_SOURCE_PRESSURE, entry, -by, d);
        own->pressure = rheo__lanes3_minus(own->pressure, (rheo__lanes3){by * d.x, by * d.y, by * d.z});
    }
    if (with_springs) {
        const rheo__lanes length = rheo__lanes_at(a->rest_length, entry), k = rheo__lanes_at(a->stiffness, entry);
        const rheo__lanes by = rheo__lanes_if_less(length, zero, zero, k * (length - r) * inverse);
        rheo__keep_pair(keeper, RHEO__SUM_springs, RHEO_SOURCE_SPRING, entry, -by, d);
        own->spring = rheo__lanes3_minus(own->spring, (rheo__lanes3){by * d.x, by * d.y, by * d.z});
    }
}

RHEO__FOR_EACH_CASE void sum_all(const rheo__state *s, rheo__thickening *t, const rheo_real *rest_length,
                                 bool with_springs, bool with_pressure)
{
    const arrays a = {t->point, t->pairs->partner, rest_length, t->pair_stiffness};
    const rheo_real inverse_support = (rheo_real)(1 / t->def->fluid.support), least2 = rheo__least_distance2(t->def);
    const rheo__lanes zero = rheo__lanes_all(0);
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        const rheo__wide_lanes row = rheo__lanes_load_wide_row(a.point + rank);
        const rheo__keeper keeper = rheo__keeper_of(s, t->pairs, rank);
        sums own = {{zero, zero, zero}, {zero, zero, zero}};
        rheo__keep_begin(&keeper, RHEO__SUM_pressure);
        rheo__keep_begin(&keeper, RHEO__SUM_springs);
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        add_pair(&own, &a, entry, &row, inverse_support, least2, with_springs, with_pressure, &keeper);
        rheo__lanes_store_row(t->pressure_acceleration + rank, own.pressure);
        const rheo_real half = RHEO__R(0.5);
        rheo__keep_scale(&keeper, RHEO__SUM_springs, half);
        rheo__lanes_store_row(t->spring_acceleration + rank,
                              (rheo__lanes3){half * own.spring.x, half * own.spring.y, half * own.spring.z});
    }
}

/* Pushes coinciding particles apart, along a direction that depends on their ids. */
static void part(const rheo__state *s, rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    for (uint32_t i = 0; i < p->rows; i++)
        for (size_t k = rheo__pairs_first(p, i); k < rheo__pairs_end(p, i); k += p->width) {
            const uint32_t j = rheo__pairs_partner(p, k);
            const rheo__point *a = &t->point[i].at, *b = &t->point[rheo__pairs_place(p, k)].at;
            if (j <= i || rheo__length2(b->x - a->x, b->y - a->y, b->z - a->z) != 0)
                continue;
            rheo_real direction[3];
            rheo__part_direction(p->id_of[i], p->id_of[j], direction);
            const rheo_real push = (a->w + b->w) + (t->point[i].more.x + t->point[j].more.x);
            rheo__point *ai = &t->pressure_acceleration[i], *aj = &t->pressure_acceleration[j];
            if (rheo__keeps_account(s, p, i))
                rheo__account_add(s, RHEO__SUM_pressure, RHEO_SOURCE_PARTING, p->id_of[j], -(push * direction[0]),
                                  -(push * direction[1]), -(push * direction[2]));
            if (rheo__keeps_account(s, p, j))
                rheo__account_add(s, RHEO__SUM_pressure, RHEO_SOURCE_PARTING, p->id_of[i], push * direction[0],
                                  push * direction[1], push * direction[2]);
            ai->x -= push * direction[0];
            ai->y -= push * direction[1];
            ai->z -= push * direction[2];
            aj->x += push * direction[0];
            aj->y += push * direction[1];
            aj->z += push * direction[2];
        }
}

/* Notes the largest displacement of the substeps so far. */
static void note(rheo__moved *most, rheo_real acceleration2, rheo_real step2, const rheo__pairs *p, uint32_t row)
{
    const double length = (double)(step2 * rheo__sqrt(acceleration2));
    if (row < p->rows && !(length <= most->length))
        *most = (rheo__moved){length, (double)p->id_of[row]};
}

/* Applies the accelerations. */
static void apply(rheo__state *s, rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    const rheo_real step = t->substep, step2 = step * step;
    rheo_real most_spring = 0, most_pressure = 0;
    uint32_t by_spring = p->rows, by_pressure = p->rows;
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo__point f = t->spring_acceleration[i], g = t->pressure_acceleration[i];
        const rheo_real spring = rheo__length2(f.x, f.y, f.z), pressure = rheo__length2(g.x, g.y, g.z);
        if (spring > most_spring) {
            most_spring = spring;
            by_spring = i;
        }
        if (pressure > most_pressure) {
            most_pressure = pressure;
            by_pressure = i;
        }
        const rheo_real a[3] = {f.x + g.x, f.y + g.y, f.z + g.z};
        if (rheo__keeps_account(s, p, i)) {
            rheo__account_begin(s, RHEO__SUM_acceleration);
            rheo__account_apply(s, RHEO__SUM_acceleration, RHEO_SOURCE_SUM, 1, RHEO__SUM_springs);
            rheo__account_apply(s, RHEO__SUM_acceleration, RHEO_SOURCE_SUM, 1, RHEO__SUM_pressure);
            rheo__account_apply(s, RHEO__FIELD_velocity, RHEO_SOURCE_SUM, step, RHEO__SUM_acceleration);
            rheo__account_apply(s, RHEO__FIELD_position, RHEO_SOURCE_SUM, step2, RHEO__SUM_acceleration);
        }
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t at = 3 * (size_t)p->id_of[i] + axis;
            s->velocity[at] += step * a[axis];
            s->position[at] += step2 * a[axis]; /* not those of points, which periodic space has rounded */
        }
    }
    note(&t->diagnostics.max_spring_displacement, most_spring, step2, p, by_spring);
    note(&t->diagnostics.max_pressure_displacement, most_pressure, step2, p, by_pressure);
}

rheo_result RHEO__VARIANT(stage_forces)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo_real *rest_length = s->springs.rest_length;
    const bool springs = rheo__state_has(s, RHEO__FIELD_spring_ends),
               pressure = t->def->fluid.stiffness > 0 || t->def->fluid.near_stiffness > 0;
    /* Separate calls, so that each is compiled for its case. */
    if (springs && pressure)
        sum_all(s, t, rest_length, true, true);
    else if (springs)
        sum_all(s, t, rest_length, true, false);
    else
        sum_all(s, t, rest_length, false, true);
    if (t->coinciding)
        part(s, t);
    if (s->bodies && pressure)
        rheo__wetting_push(s, t);
    apply(s, t);
    return RHEO_OK;
}
