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
#include "core/quintic.h"
#include "melting/rows.h"

/* The terms that a scene needs. */
typedef struct terms {
    bool motion, heat, corrected, second, printed_weight;
} terms;

typedef struct constants {
    rheo_real mass, epsilon, softening, inverse_h, second_scale;
} constants;

RHEO__FOR_EACH_CASE void add_rows(rheo__melting *m, const constants *c, uint32_t block, uint32_t first, terms needed)
{
    const rheo__rows *rows = &m->rows;
    const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
    uint32_t own[RHEO__LANES];
    rheo__own_ranks(rank, own);
    const rheo__wide_lanes point = rheo__lanes_load_wide_row(m->point + rank);
    const rheo__lanes rho_i = point.more_w;
    const rheo__lanes3 t = needed.heat ? rheo__lanes_load(m->heat_points, own) : rheo__lanes3_zero();
    rheo__lanes divergence = {0}, heat = {0};
    rheo__lanes3 drift = rheo__lanes3_zero();
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
            drift.x -= by * u.x;
            drift.y -= by * u.y;
            drift.z -= by * u.z;
        }
        if (needed.heat) {
            const rheo__lanes3 other = rheo__lanes_load_at(m->heat_points, partner);
            const rheo__lanes difference = t.x - other.x, r2 = rheo__lanes3_dot(x, x);
            if (needed.corrected) {
                heat += by_sum * difference * (slope * (t.y + other.y));
            } else if (needed.second) {
                /* The Laplacian of W is second_scale (w'' + 2 w'/q), weighted by 1/rho_j. */
                const rheo__lanes w2 =
                    rheo__lanes_quintic_second(rheo__lanes_sqrt(r2) * c->inverse_h) * c->second_scale;
                const rheo__lanes laplacian = rheo__lanes_keep(slope < 0, w2 + 2 * slope);
                heat -= difference * laplacian / (4 * rho_j);
            } else {
                const rheo__lanes weight = needed.printed_weight ? by_sum * (rho_i / rho_j) : by_sum;
                heat += weight * difference * (slope * r2) / (r2 + c->softening);
            }
        }
    }
    if (needed.motion) {
        rheo__lanes_put(m->density_rate, rank, rho_i * (c->mass * divergence));
        const rheo_real by = 2 * c->mass * c->epsilon;
        rheo__lanes_store(m->drift, own, (rheo__lanes3){by * drift.x, by * drift.y, by * drift.z});
    }
    if (needed.heat)
        rheo__lanes_put(m->heat_rate, rank, (needed.corrected ? 2 : 4) * c->mass * heat);
}

/*
 * The drift moves particles, so it changes densities. Without this term an integrated density diverges from that of
 * the particles (measured in docs/melting.md).
 */
static void compress_by_drift(rheo__melting *m, const constants *c)
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
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__wide_lanes pair = rheo__lanes_minus_wide_at(&point, m->point, rows->partner + entry);
            rheo__fetch_partners(rows->partner, entry);
            rheo__fetch_values(rows->slope, entry);
            divergence += rheo__lanes_at(rows->slope, entry) * pair.w * rheo__lanes3_dot(pair.more, pair.at);
        }
        rheo__lanes_put(m->density_rate, rank, rheo__lanes_at(m->density_rate, rank) + rho * (c->mass * divergence));
    }
}

/* Motion towards a wall compresses, motion away from it expands, except for particles that fall off a ceiling. */
static void compress_at_walls(rheo__melting *m)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        const rheo_real *n = m->planes->plane[contact->wall].normal;
        const rheo__point *v = &m->velocity[contact->rank], *u = &m->drift[contact->rank];
        const rheo_real away = n[0] * (v->x + u->x) + n[1] * (v->y + u->y) + n[2] * (v->z + u->z);
        if (!(contact->detached && away > 0))
            m->density_rate[contact->rank] -= v->w * away * contact->integral.gradient;
    }
}

rheo_result RHEO__VARIANT(stage_rates)(rheo__state *s, void *context)
{
    (void)s;
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
        m->heat_points[i] = (rheo__point){m->temperature[i], 1, 0, 0};
    if (needed.heat)
        m->heat_points[m->pairs.rows] = (rheo__point){0, 1, 0, 0};
    for (uint32_t i = 0; i <= m->pairs.rows; i++) {
        m->point[i].at.w = 1 / m->velocity[i].w;
        m->point[i].more = m->velocity[i];
    }
    RHEO__EACH_VECTOR_OF_ROWS(&m->rows, block, first)
    {
        /* Separate calls, so that each is compiled for its case. */
        if (needed.motion && needed.heat && needed.corrected)
            add_rows(m, &c, block, first, (terms){.motion = true, .heat = true, .corrected = true});
        else if (needed.motion && !needed.heat)
            add_rows(m, &c, block, first, (terms){.motion = true});
        else
            add_rows(m, &c, block, first, needed);
    }
    if (needed.motion && def->melting.xsph > 0 && !def->paper.xsph)
        compress_by_drift(m, &c);
    if (needed.motion)
        compress_at_walls(m);
    return RHEO_OK;
}
