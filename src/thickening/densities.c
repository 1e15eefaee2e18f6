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
#include "core/field_sums.h"
#include "space/row_blocks.h"
#include "thickening/densities.h"

typedef struct constants {
    rheo_real support, inverse_support, rate, yield;
    rheo_real half_stiffness, half_near_stiffness, rest_density, least;
} constants;

/* What a pass over the pairs reads and writes: copies, so that no store makes the compiler load them again. */
typedef struct arrays {
    rheo__wide_point *point;
    const uint32_t *partner;
    const rheo_real *rest_length; /* before the stage */
    rheo_real *new_rest_length, *density;
} arrays;

/* Sums of a vector of rows; within: partners within the support. */
typedef struct sums {
    rheo__lanes density, near_density, within;
} sums;

/* Results of all rows. */
typedef struct totals {
    rheo__lanes closest; /* square of the least distance */
    rheo__mask within;
} totals;

static inline rheo__lanes flow(rheo__lanes length, rheo__lanes r, bool at_distance, rheo__lanes rate,
                               rheo__lanes yield, const constants *c)
{
    const rheo__lanes zero = rheo__lanes_all(0), born = at_distance ? r : rheo__lanes_all(c->support);
    length = rheo__lanes_if_less(length, zero, born, length);
    const rheo__lanes tolerated = yield * length, stretch = r - length;
    /* The part of the stretch that is tolerated stays. */
    const rheo__lanes stays = rheo__lanes_max(rheo__lanes_min(stretch, tolerated), -tolerated);
    /* A rate above 1/(1 + gamma) per substep would overshoot; a length is never negative. */
    return rheo__lanes_max(length + rate * (stretch - stays), zero);
}

/* What a pass over the pairs computes. */
typedef struct pass {
    bool springs, at_distance, materials;
} pass;

RHEO__FOR_EACH_CASE void add_pair(sums *own, totals *all, const arrays *a, size_t entry, const rheo__wide_lanes *row,
                                  pass does, const constants *c)
{
    const uint32_t *partner = a->partner + entry;
    rheo__wide_lanes other;
    if (does.materials)
        other = rheo__lanes_load_wide_at(a->point, partner);
    else
        other.at = rheo__lanes_load_narrow_at(a->point, partner);
    const rheo__lanes3 d = rheo__lanes3_minus(other.at, row->at);
    const rheo__lanes r2 = d.x * d.x + d.y * d.y + d.z * d.z, r = rheo__lanes_sqrt(r2), zero = rheo__lanes_all(0);
    const rheo__lanes w = rheo__lanes_max(1 - r * c->inverse_support, zero), w2 = w * w;
    own->density += w2;
    own->near_density += w2 * w;
    own->within = rheo__lanes_add_if_less(zero, w, own->within, rheo__lanes_all(1));
    all->closest = rheo__lanes_min(all->closest, r2);
    if (does.springs) {
        const rheo__lanes rate =
                              does.materials ? RHEO__R(0.5) * (row->more.y + other.more.y) : rheo__lanes_all(c->rate),
                          yield = does.materials ? RHEO__R(0.5) * (row->more.z + other.more.z)
                                                 : rheo__lanes_all(c->yield),
                          length = flow(rheo__lanes_at(a->rest_length, entry), r, does.at_distance, rate, yield, c);
        rheo__lanes_put(a->new_rest_length, entry, rheo__lanes_if_less(zero, w, length, rheo__lanes_all(-1)));
    }
}

static bool any_within(rheo__lanes3 x, const rheo_real centre[3], rheo_real reach)
{
    const rheo__lanes dx = x.x - centre[0], dy = x.y - centre[1], dz = x.z - centre[2];
    return rheo__lanes_any(dx * dx + dy * dy + dz * dz < rheo__lanes_all(reach * reach));
}

/*
 * Sums all rows: density and pressures; finds the particles that are wet. *ends: of pairs within the support. False: no
 * memory.
 */
RHEO__FOR_EACH_CASE bool sum_all(rheo__state *s, rheo__thickening *t, const rheo_real *rest_length, pass does,
                                 const constants *c, size_t *ends)
{
    const arrays a = {t->point, t->pairs->partner, rest_length, s->springs.rest_length, t->density};
    const rheo__lanes zero = rheo__lanes_all(0);
    totals all = {.closest = rheo__lanes_all(c->support)};
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        rheo__wide_point *own_point = a.point + rank;
        const rheo__wide_lanes row = rheo__lanes_load_wide_row(own_point);
        for (uint32_t ball = 0; ball < s->bodies; ball++)
            if (any_within(row.at, s->ball_position + 3 * (size_t)ball, rheo__wetting_reach(t, ball)) &&
                !rheo__wetting_find(s, t, ball, rank, RHEO__LANES))
                return false;
        sums own = {zero, zero, zero};
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        add_pair(&own, &all, &a, entry, &row, does, c);
        if (s->spring_sums.wanted) /* the rest lengths are in the nearest cache now */
            RHEO__VARIANT(add_rest_lengths)(&s->spring_sums, &s->springs, block, first);
        all.within += rheo__lanes_whole(own.within);
        rheo__lanes_put(a.density, rank, own.density);
        rheo_real pressure[RHEO__LANES], near_pressure[RHEO__LANES];
        rheo__lanes_put(
            pressure, 0,
            rheo__lanes_max(c->half_stiffness * (own.density - c->rest_density), rheo__lanes_all(c->least)));
        rheo__lanes_put(near_pressure, 0, c->half_near_stiffness * own.near_density);
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
            own_point[lane].at.w = pressure[lane];
            own_point[lane].more.x = near_pressure[lane];
        }
    }
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        *ends += (size_t)RHEO__LANE(all.within, lane);
        t->coinciding |= RHEO__LANE(all.closest, lane) == 0;
    }
    return true;
}

static void gather(const rheo__state *s, rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo_real *x = s->position + 3 * (size_t)p->id_of[i];
        t->point[i].at = (rheo__point){x[0], x[1], x[2], 0};
    }
}

static void gather_materials(const rheo__state *s, rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo__material *m = rheo__material_at(s, t, p->id_of[i]);
        t->point[i].more.y = t->substep * m->plasticity;
        t->point[i].more.z = m->yield;
    }
}

rheo_result RHEO__VARIANT(stage_densities)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
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
               at_distance = def->springs.rest_length == RHEO_REST_DISTANCE,
               materials = with_springs && rheo__state_has(s, RHEO__FIELD_material);
    const rheo_real *rest_length = with_springs ? rheo__state_renew_rest_lengths(s) : NULL;
    if (with_springs && !rest_length)
        return RHEO_ERROR_MEMORY;
    size_t ends = 0;
    gather(s, t);
    if (materials)
        gather_materials(s, t);
    rheo__images_of_points(t);
    t->coinciding = false;
    t->wet_count = 0;
    /* Separate calls, so that each is compiled for its case. */
    const bool enough = !with_springs ? sum_all(s, t, NULL, (pass){.at_distance = true}, &c, &ends)
                        : materials   ? sum_all(s, t, rest_length, (pass){true, at_distance, true}, &c, &ends)
                        : at_distance
                            ? sum_all(s, t, rest_length, (pass){.springs = true, .at_distance = true}, &c, &ends)
                            : sum_all(s, t, rest_length, (pass){.springs = true}, &c, &ends);
    if (!enough)
        return RHEO_ERROR_MEMORY;
    s->spring_sums.made = s->spring_sums.wanted;
    if (with_springs)
        s->springs.count = ends / 2;
    t->diagnostics.mean_neighbours = s->particles ? (double)ends / s->particles : 0;
    for (uint32_t k = 0; k < t->wet_count; k++) {
        const rheo__wet *wet = &t->wet[k];
        const rheo_real density = t->density[wet->rank] += wet->integrals.density;
        t->point[wet->rank].at.w = rheo__max(c.half_stiffness * (density - c.rest_density), c.least);
        t->point[wet->rank].more.x += c.half_near_stiffness * wet->integrals.near_density;
    }
    rheo__images_of_pressures(t);
    rheo__note_densities(t);
    return RHEO_OK;
}
