/*
 * Stage density_constraint of scheme positions (Macklin and Mueller, "Position based fluids"; docs/model.md, Scheme
 * positions): at the predicted positions, with w = 1 - r/h, unit vectors e_ij from i to j and m_i of stage multiplier,
 *
 *     rho = sum w^2,  C = max(rho/rho0 - 1, -cohesion/rho0),  h grad_i C_i = G = 2/rho0 sum w e_ij
 *     lambda = -C/(h^2 sum_k |grad_k C|^2 + epsilon/m),  h^2 sum_k |grad_k C|^2 = 4/rho0 max(rho/rho0, 1) + G^2
 *     x_i += OMEGA 2 h/rho0 sum (lambda_i + lambda_j) w e_ij
 *
 * A gradient multiplied by m, in C(x + lambda m grad C) = -epsilon lambda, gives the same as a compliance epsilon/m. All
 * particles move at once, `iterations` times; then v += displacement/step. The displacements of a pair are opposite to
 * the last bit.
 */
#include "core/account_lanes.h"
#include "space/row_blocks.h"
#include "thickening/densities.h"

/* Corrections by constraints that share particles add up; this part of them keeps the iterations from overshooting. */
#define OMEGA RHEO__R(0.5)

typedef struct constants {
    rheo_real inverse_support, inverse_rest_density;
    rheo_real least2;   /* square of the least distance */
    rheo_real least;    /* of C */
    rheo_real hardness; /* 4/rho0 */
    rheo_real epsilon;  /* in 1/h^2 */
    rheo_real move;     /* OMEGA 2 h/rho0 */
    bool history;       /* multiplied */
} constants;

/* A vector from one row to its partners: w, and w divided by the distance, which is 0 where they coincide. */
typedef struct pair {
    rheo__lanes3 d;
    rheo__lanes r2, w, by;
} pair;

static inline pair pair_of(rheo__lanes3 from, rheo__lanes3 to, const constants *c)
{
    const rheo__lanes3 d = rheo__lanes3_minus(to, from);
    const rheo__lanes exact = d.x * d.x + d.y * d.y + d.z * d.z,
                      r2 = rheo__lanes_max(exact, rheo__lanes_all(c->least2)), r = rheo__lanes_sqrt(r2),
                      w = rheo__lanes_max(1 - r * c->inverse_support, rheo__lanes_all(0));
    return (pair){d, exact, w, w * (r * (1 / r2))};
}

/* Densities; with `solve` also the multipliers lambda, in w of the points. Returns the number of ends of pairs. */
RHEO__FOR_EACH_CASE size_t sum_densities(rheo__thickening *t, const constants *c, bool solve)
{
    const rheo__lanes zero = rheo__lanes_all(0), one = rheo__lanes_all(1);
    rheo__lanes closest = rheo__lanes_all(1);
    rheo__mask ends = {0};
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        const rheo__lanes3 at = rheo__lanes_load_wide_row(t->point + rank).at;
        rheo__lanes density = zero, within = zero;
        rheo__lanes3 sum = {zero, zero, zero};
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        {
            const pair l = pair_of(at, rheo__lanes_load_narrow_at(t->point, t->pairs->partner + entry), c);
            density += l.w * l.w;
            within = rheo__lanes_add_if_less(zero, l.w, within, one);
            sum.x += l.by * l.d.x;
            sum.y += l.by * l.d.y;
            sum.z += l.by * l.d.z;
            closest = rheo__lanes_min(closest, l.r2);
        }
        ends += rheo__lanes_whole(within);
        rheo__lanes_put(t->density, rank, density);
        if (!solve)
            continue;
        const rheo__lanes ratio = density * c->inverse_rest_density,
                          violation = rheo__lanes_max(ratio - 1, rheo__lanes_all(c->least)),
                          slope2 = (sum.x * sum.x + sum.y * sum.y + sum.z * sum.z) *
                                   (c->hardness * c->inverse_rest_density),
                          compliance = c->history ? c->epsilon / rheo__lanes_at(t->multiplier, rank)
                                                  : rheo__lanes_all(c->epsilon);
        rheo_real lambda[RHEO__LANES];
        rheo__lanes_put(lambda, 0, -violation / ((c->hardness * rheo__lanes_max(ratio, one) + slope2) + compliance));
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            t->point[rank + lane].at.w = lambda[lane];
    }
    size_t count = 0;
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        count += (size_t)RHEO__LANE(ends, lane);
        t->coinciding |= RHEO__LANE(closest, lane) == 0;
    }
    return count;
}

/* The displacements of an iteration, in pressure_acceleration. */
static void sum_displacements(const rheo__state *s, rheo__thickening *t, const constants *c)
{
    const rheo__lanes zero = rheo__lanes_all(0);
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        const rheo__wide_lanes row = rheo__lanes_load_wide_row(t->point + rank);
        const rheo__keeper keeper = rheo__keeper_of(s, t->pairs, rank);
        rheo__lanes3 sum = {zero, zero, zero};
        rheo__keep_begin(&keeper, RHEO__SUM_correction);
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        {
            rheo__lanes lambda;
            const rheo__lanes3 at = rheo__lanes_load_values(&t->point->at.x, t->pairs->partner + entry, 2, &lambda);
            const pair l = pair_of(row.at, at, c);
            const rheo__lanes by = (row.w + lambda) * l.by;
            rheo__keep_pair(&keeper, RHEO__SUM_correction, RHEO_SOURCE_PRESSURE, entry, by, l.d);
            sum.x += by * l.d.x;
            sum.y += by * l.d.y;
            sum.z += by * l.d.z;
        }
        rheo__keep_scale(&keeper, RHEO__SUM_correction, c->move);
        rheo__lanes_store_row(t->pressure_acceleration + rank,
                              (rheo__lanes3){c->move * sum.x, c->move * sum.y, c->move * sum.z});
    }
}

/* Moves coinciding particles apart, along a direction that depends on their ids. */
static void part(const rheo__state *s, rheo__thickening *t, const constants *c)
{
    const rheo__pairs *p = t->pairs;
    for (uint32_t i = 0; i < p->rows; i++)
        for (size_t k = rheo__pairs_first(p, i); k < rheo__pairs_end(p, i); k += p->width) {
            const uint32_t j = rheo__pairs_partner(p, k);
            const rheo__point *a = &t->point[i].at, *b = &t->point[j].at;
            if (rheo__length2(b->x - a->x, b->y - a->y, b->z - a->z) != 0)
                continue;
            rheo_real direction[3];
            rheo__part_direction(p->id_of[i], p->id_of[j], direction);
            const rheo_real by = c->move * (a->w + b->w);
            if (rheo__keeps_account(s, p, i))
                rheo__account_add(s, RHEO__SUM_correction, RHEO_SOURCE_PARTING, p->id_of[j], by * direction[0],
                                  by * direction[1], by * direction[2]);
            t->pressure_acceleration[i].x += by * direction[0];
            t->pressure_acceleration[i].y += by * direction[1];
            t->pressure_acceleration[i].z += by * direction[2];
        }
}

/* Moves all particles. The sum of the displacements is in spring_acceleration. */
static void move(const rheo__state *s, rheo__thickening *t)
{
    for (uint32_t i = 0; i < t->pairs->rows; i++) {
        const rheo__point d = t->pressure_acceleration[i];
        if (rheo__keeps_account(s, t->pairs, i)) {
            rheo__account_apply(s, RHEO__FIELD_position, RHEO_SOURCE_SUM, 1, RHEO__SUM_correction);
            rheo__account_apply(s, RHEO__SUM_displacement, RHEO_SOURCE_SUM, 1, RHEO__SUM_correction);
        }
        rheo__point *at = &t->point[i].at, *sum = &t->spring_acceleration[i];
        at->x += d.x;
        at->y += d.y;
        at->z += d.z;
        sum->x += d.x;
        sum->y += d.y;
        sum->z += d.z;
    }
}

/* The new positions, and velocities from the displacements. */
static void apply(rheo__state *s, rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    const rheo_real rate = 1 / t->substep;
    rheo_real most = 0;
    uint32_t furthest = p->rows;
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo__point x = t->point[i].at, d = t->spring_acceleration[i];
        const rheo_real at[3] = {x.x, x.y, x.z}, moved[3] = {d.x, d.y, d.z}, length2 = rheo__length2(d.x, d.y, d.z);
        if (length2 > most) {
            most = length2;
            furthest = i;
        }
        if (rheo__keeps_account(s, p, i))
            rheo__account_apply(s, RHEO__FIELD_velocity, RHEO_SOURCE_SUM, rate, RHEO__SUM_displacement);
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t value = 3 * (size_t)p->id_of[i] + axis;
            s->position[value] = at[axis];
            s->velocity[value] += rate * moved[axis];
        }
    }
    t->diagnostics.max_pressure_displacement =
        (rheo__moved){(double)rheo__sqrt(most), furthest < p->rows ? (double)p->id_of[furthest] : -1};
}

rheo_result RHEO__VARIANT(stage_positions_constraint)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo_world_def *def = t->def;
    const double rest = def->fluid.rest_density;
    const constants c = {.inverse_support = (rheo_real)(1 / def->fluid.support),
                         .least2 = rheo__least_distance2(def),
                         .inverse_rest_density = (rheo_real)(1 / rest),
                         .least = (rheo_real)(-def->fluid.cohesion / rest),
                         .hardness = (rheo_real)(4 / rest),
                         .epsilon = (rheo_real)def->positions.relaxation,
                         .move = OMEGA * (rheo_real)(2 * def->fluid.support / rest),
                         .history = rheo__state_has(s, RHEO__FIELD_derivative) &&
                                    def->positions.history != RHEO_POSITIONS_VISCOSITY};
    rheo__positions_gather(s, t);
    memset(t->spring_acceleration, 0, t->pairs->rows * sizeof *t->spring_acceleration);
    if (rheo__keeps_any(s))
        rheo__account_begin(s, RHEO__SUM_displacement);
    for (uint64_t k = 0; k < def->positions.iterations; k++) {
        t->coinciding = false;
        sum_densities(t, &c, true);
        sum_displacements(s, t, &c);
        if (t->coinciding)
            part(s, t, &c);
        move(s, t);
    }
    const size_t ends = sum_densities(t, &c, false);
    t->diagnostics.mean_neighbours = s->particles ? (double)ends / s->particles : 0;
    apply(s, t);
    rheo__note_densities(t);
    return RHEO_OK;
}
