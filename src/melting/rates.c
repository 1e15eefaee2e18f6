/*
 * Stage rates, docs/melting.md (2, 6, 7): one sum over pairs for the rates of densities, temperatures and positions,
 * with the velocities after momentum and viscosity (with paper.leapfrog, before them),
 *
 *     drho_i/dt = rho_i sum m/rho_j v_ij.grad W                                  (Eq. 6 of the paper)
 *     lap T_i   = sum 2 m (c_i + c_j)/(rho_i + rho_j) (T_i - T_j) x.grad W/r^2   keeps sum m T to round-off
 *     drift_i   = epsilon sum m/((rho_i + rho_j)/2) (v_j - v_i) W                (XSPH, Eq. 9)
 *
 * The factors c complete the sums near surfaces and walls (gradients.c). Walls are insulated and do not affect the
 * drift. Two variants exist for comparison, without factors: the paper's weight of the Laplacian, which loses heat,
 * and the Laplacian by second derivatives of the kernel, which change sign.
 */
#include <string.h>

#include "core/quintic.h"
#include "melting/rows.h"

/* The terms that a scene needs. */
typedef struct terms {
    bool motion, heat, corrected, second, printed_weight;
} terms;

typedef struct constants {
    rheo_real mass, epsilon, softening, inverse_h, second_scale;
} constants;

/*
 * 2 m epsilon, less where the sum of volumes times W is above MOST_SHARE: in a clump of more than twelve particles it would
 * move each against its own velocity, and they would never part. On a lattice the sum is 0.82. `share`: the sum of
 * W/(rho_i + rho_j), with idle entries, which have W(0).
 */
#define MOST_SHARE RHEO__R(1.5)
static inline rheo__lanes drift_scale(const rheo__melting *m, const constants *c, uint32_t block, uint32_t first,
                                      rheo__lanes density, rheo__lanes share)
{
    const rheo__rows *rows = &m->rows;
    const uint32_t entries = rows->start[block + 1] - rows->start[block];
    rheo_real idle[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        idle[lane] = (rheo_real)(entries - rows->length[block * RHEO__BLOCK_ROWS + first + lane]);
    const rheo__lanes self = RHEO__QUINTIC_AT_0 * m->kernel_scale / (2 * density);
    rheo__lanes all;
    memcpy(&all, idle, sizeof all);
    const rheo_real by = 2 * c->mass;
    share = by * (share - all * self);
    return by * c->epsilon / rheo__lanes_max(share * (1 / MOST_SHARE), rheo__lanes_all(1));
}

RHEO__FOR_EACH_CASE void add_rows(const rheo__state *s, rheo__melting *m, const constants *c, uint32_t block,
                                  uint32_t first, terms needed)
{
    const rheo__rows *rows = &m->rows;
    const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
    uint32_t own[RHEO__LANES];
    rheo__own_ranks(rank, own);
    const rheo__wide_lanes point = rheo__lanes_load_wide_row(m->point + rank);
    const rheo__lanes rho_i = point.more_w;
    const rheo__lanes3 t = needed.heat ? rheo__lanes_load(m->heat_points, own) : rheo__lanes3_zero();
    rheo__lanes divergence = {0}, heat = {0}, share = {0};
    rheo__lanes3 drift = rheo__lanes3_zero();
    const rheo__keeper keeper = rheo__row_keeper(s, m, rank);
    rheo__row_begins(&keeper, RHEO__SUM_density_rate);
    rheo__row_begins(&keeper, RHEO__SUM_drift);
    rheo__row_begins(&keeper, RHEO__SUM_heat_rate);
    RHEO__EACH_ENTRY(rows, block, first, entry)
    {
        const uint32_t *partner = rows->partner + entry;
        const rheo__lanes slope = rheo__lanes_at(rows->slope, entry);
        const rheo__wide_lanes pair = rheo__lanes_minus_wide_at(&point, m->point, partner);
        rheo__fetch_partners(rows->partner, entry);
        rheo__fetch_values(rows->slope, entry);
        rheo__fetch_values(rows->weight, entry);
        const rheo__lanes volume = pair.w, rho_j = pair.more_w;
        const rheo__lanes3 x = pair.at, u = pair.more;
        const rheo__lanes by_sum = 1 / (rho_i + rho_j);
        if (needed.motion) {
            const rheo__lanes tilt = slope * volume, weight = rheo__lanes_at(rows->weight, entry);
            divergence += tilt * rheo__lanes3_dot(u, x);
            const rheo__lanes by = weight * by_sum;
            share += by;
            drift.x -= by * u.x;
            drift.y -= by * u.y;
            drift.z -= by * u.z;
            rheo__row_adds_number(&keeper, RHEO__SUM_density_rate, RHEO_SOURCE_FLOW, partner,
                                  tilt * rheo__lanes3_dot(u, x));

            rheo__row_adds(&keeper, RHEO__SUM_drift, RHEO_SOURCE_DRIFT, partner, rheo__lanes3_times(-by, u));
        }
        if (needed.heat) {
            const rheo__lanes3 other = rheo__lanes_load_at(m->heat_points, partner);
            const rheo__lanes difference = t.x - other.x, r2 = rheo__lanes3_dot(x, x);
            if (needed.corrected) {
                rheo__row_adds_number(&keeper, RHEO__SUM_heat_rate, RHEO_SOURCE_HEAT, partner,
                                      by_sum * difference * (slope * (t.y + other.y)));
                heat += by_sum * difference * (slope * (t.y + other.y));
            } else if (needed.second) {
                /* The Laplacian of W is second_scale (w'' + 2 w'/q), weighted by 1/rho_j. */
                const rheo__lanes w2 =
                    rheo__lanes_quintic_second(rheo__lanes_sqrt(r2) * c->inverse_h) * c->second_scale;
                const rheo__lanes laplacian = rheo__lanes_keep(slope < 0, w2 + 2 * slope);
                rheo__row_adds_number(&keeper, RHEO__SUM_heat_rate, RHEO_SOURCE_HEAT, partner,
                                      -(difference * laplacian / (4 * rho_j)));
                heat -= difference * laplacian / (4 * rho_j);
            } else {
                const rheo__lanes weight = needed.printed_weight ? by_sum * (rho_i / rho_j) : by_sum;
                rheo__row_adds_number(&keeper, RHEO__SUM_heat_rate, RHEO_SOURCE_HEAT, partner,
                                      weight * difference * (slope * r2) / (r2 + c->softening));
                heat += weight * difference * (slope * r2) / (r2 + c->softening);
            }
        }
    }
    if (needed.motion) {
        rheo__lanes_put(m->density_rate, rank, rho_i * (c->mass * divergence));
        const rheo__lanes by = drift_scale(m, c, block, first, rho_i, share);
        rheo__row_scales(&keeper, RHEO__SUM_density_rate, c->mass);
        rheo__row_scales(&keeper, RHEO__SUM_density_rate, RHEO__LANE(rho_i, 0));
        rheo__row_scales(&keeper, RHEO__SUM_drift, RHEO__LANE(by, 0));
        rheo__lanes_store(m->drift, own, (rheo__lanes3){by * drift.x, by * drift.y, by * drift.z});
    }
    if (needed.heat) {
        rheo__row_scales(&keeper, RHEO__SUM_heat_rate, (needed.corrected ? 2 : 4) * c->mass);
        rheo__lanes_put(m->heat_rate, rank, (needed.corrected ? 2 : 4) * c->mass * heat);
    }
}

/*
 * The drift moves particles, so it changes densities. Without this term an integrated density diverges from that of
 * the particles (measured in docs/melting.md).
 */
static void compress_by_drift(const rheo__state *s, rheo__melting *m, const constants *c)
{
    const rheo__rows *rows = &m->rows;
    for (uint32_t i = 0; i < m->pairs.rows; i++)
        m->point[i].more = m->drift[i];
    m->point[m->pairs.rows].more = (rheo__point){0, 0, 0, 0};
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        rheo__lanes rho, divergence = rheo__lanes_all(0);
        rheo__lanes_load_w(m->velocity, own, &rho);
        const rheo__wide_lanes point = rheo__lanes_load_wide_row(m->point + rank);
        const rheo__keeper keeper = rheo__row_keeper(s, m, rank);
        rheo__row_begins(&keeper, RHEO__SUM_drift_rate);
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__wide_lanes pair = rheo__lanes_minus_wide_at(&point, m->point, rows->partner + entry);
            rheo__fetch_partners(rows->partner, entry);
            rheo__fetch_values(rows->slope, entry);

            rheo__row_adds_number(&keeper, RHEO__SUM_drift_rate, RHEO_SOURCE_DRIFT, rows->partner + entry,
                                  rheo__lanes_at(rows->slope, entry) * pair.w * rheo__lanes3_dot(pair.more, pair.at));
            divergence += rheo__lanes_at(rows->slope, entry) * pair.w * rheo__lanes3_dot(pair.more, pair.at);
        }
        rheo__row_scales(&keeper, RHEO__SUM_drift_rate, c->mass);
        rheo__row_scales(&keeper, RHEO__SUM_drift_rate, RHEO__LANE(rho, 0));
        rheo__row_applies(&keeper, RHEO__SUM_density_rate, 1, RHEO__SUM_drift_rate);
        rheo__lanes_put(m->density_rate, rank, rheo__lanes_at(m->density_rate, rank) + rho * (c->mass * divergence));
    }
}

/* Motion towards a wall compresses, motion away from it expands, except for particles that fall off a ceiling. */
static void compress_at_walls(const rheo__state *s, rheo__melting *m)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        const rheo_real *n = m->planes->plane[contact->wall].normal;
        const rheo__point *v = &m->velocity[contact->rank], *u = &m->drift[contact->rank];
        const rheo_real away = n[0] * (v->x + u->x) + n[1] * (v->y + u->y) + n[2] * (v->z + u->z);
        if (!(contact->detached && away > 0)) {
            rheo__rank_adds(s, m, contact->rank, RHEO__SUM_density_rate, RHEO_SOURCE_WALL, contact->wall,
                            -(v->w * away * contact->integral.gradient), 0, 0);
            m->density_rate[contact->rank] -= v->w * away * contact->integral.gradient;
        }
    }
}

rheo_result RHEO__VARIANT(stage_rates)(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const rheo_world_def *def = m->def;
    const double h = m->smoothing_length;
    const constants c = {.mass = (rheo_real)rheo__melting_mass(def),
                         .epsilon = (rheo_real)def->melting.xsph,
                         .softening = (rheo_real)(0.01 * h * h),
                         .inverse_h = (rheo_real)(1 / h),
                         .second_scale = m->kernel_scale * (rheo_real)(1 / (h * h))};
    const terms needed = {.motion = def->melting.flow == RHEO_FLOW_ON,
                          .heat = m->heat,
                          .corrected = rheo__corrects_heat(def),
                          .second = def->melting.laplacian == RHEO_LAPLACIAN_SECOND,
                          .printed_weight = def->paper.heat};
    for (uint32_t i = 0; needed.heat && !needed.corrected && i < m->pairs.rows; i++)
        m->heat_points[i] = (rheo__point){.x = m->temperature[i], .y = 1};
    if (needed.heat)
        m->heat_points[m->pairs.rows] = (rheo__point){.y = 1};
    for (uint32_t i = 0; i <= m->pairs.rows; i++) {
        m->point[i].at.w = 1 / m->velocity[i].w;
        m->point[i].more = m->velocity[i];
    }
    RHEO__EACH_VECTOR_OF_ROWS(&m->rows, block, first)
    {
        /* Separate calls, so that each is compiled for its case. */
        if (needed.motion && needed.heat && needed.corrected)
            add_rows(s, m, &c, block, first, (terms){.motion = true, .heat = true, .corrected = true});
        else if (needed.motion && !needed.heat)
            add_rows(s, m, &c, block, first, (terms){.motion = true});
        else
            add_rows(s, m, &c, block, first, needed);
    }
    if (needed.motion && def->melting.xsph > 0 && !def->paper.xsph)
        compress_by_drift(s, m, &c);
    if (needed.motion)
        compress_at_walls(s, m);
    return RHEO_OK;
}
