/*
 * The account of stage viscosity: v* becomes v* - dt K v, where v is the solution, or the velocity at the start of the
 * substep if the solver is explicit. The terms of K are those of viscous_operator.c, from its coefficients, after the
 * solver has run.
 *
 * The solution fulfils this equation but for the tolerance, and the solver rounds in another order. The rest is what
 * the solver adds beyond the terms.
 */
#include "core/account.h"
#include "core/strict.h"
#include "melting/viscous_operator.h"

static void add(const rheo__state *s, rheo_source source, uint32_t item, rheo_real by, const rheo_real loss[3])
{
    rheo__account_add(s, RHEO__SUM_viscosity, source, item, by * loss[0], by * loss[1], by * loss[2]);
}

/* t a, for a tensor by rows. */
static void apply_rows(rheo__point *const t[3], uint32_t rank, const rheo_real a[3], rheo_real to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = t[i][rank].x * a[0] + t[i][rank].y * a[1] + t[i][rank].z * a[2];
}

/* dt K v of a pair, for a particle and the entry of its partner. */
static void add_bond(const rheo__state *s, const rheo__melting *m, const rheo__point *v, uint32_t rank, size_t entry)
{
    const rheo__bonds *bonds = &m->bonds;
    const uint32_t other = bonds->partner[entry] / RHEO__POINT_VALUES;
    const rheo_real bond[3] = {bonds->x[entry], bonds->y[entry], bonds->z[entry]};
    add(s, RHEO_SOURCE_VISCOSITY, m->pairs.id_of[other],
        (v[rank].x - v[other].x) * bond[0] + (v[rank].y - v[other].y) * bond[1] + (v[rank].z - v[other].z) * bond[2],
        bond);
}
static void add_stress(const rheo__state *s, const rheo__melting *m, uint32_t rank, size_t entry)
{
    const uint32_t other = m->rows.partner[entry] / RHEO__POINT_VALUES;
    const rheo__point from = m->point[rank].at, to = m->point[other].at;
    const rheo_real slope = m->rows.slope[entry];
    const rheo_real grad[3] = {slope * (from.x - to.x), slope * (from.y - to.y), slope * (from.z - to.z)};
    rheo_real own[3], others[3];
    apply_rows(m->stress, rank, grad, own);
    apply_rows(m->stress, other, grad, others);
    const rheo_real sum[3] = {own[0] + others[0], own[1] + others[1], own[2] + others[2]};
    add(s, RHEO_SOURCE_VISCOSITY, m->pairs.id_of[other], -m->substep, sum);
}

/* dt K v of a wall. */
static void add_wall(const rheo__state *s, const rheo__melting *m, const rheo__point *v, const rheo__contact *contact)
{
    const rheo_real *wall = m->wall_velocity[contact->wall];
    const rheo__point own = v[contact->rank];
    const rheo_real u[3] = {own.x - wall[0], own.y - wall[1], own.z - wall[2]};
    rheo_real b[6];
    rheo__contact_block(m, contact, b);
    const rheo_real loss[3] = {b[0] * u[0] + b[3] * u[1] + b[4] * u[2], b[3] * u[0] + b[1] * u[1] + b[5] * u[2],
                               b[4] * u[0] + b[5] * u[1] + b[2] * u[2]};
    add(s, RHEO_SOURCE_WALL, contact->wall, 1, loss);
}
static void add_wall_stress(const rheo__state *s, const rheo__melting *m, const rheo__contact *contact)
{
    const rheo_real mass = (rheo_real)rheo__melting_mass(m->def);
    rheo_real loss[3];
    apply_rows(m->stress, contact->rank, m->planes->plane[contact->wall].normal, loss);
    add(s, RHEO_SOURCE_WALL, contact->wall,
        m->substep * rheo__wall_rate(m, contact) * (m->velocity[contact->rank].w / mass), loss);
}

void rheo__account_viscosity(const rheo__state *s, const rheo__melting *m, const rheo__point *v)
{
    if (s->account->id >= s->particles)
        return;
    const bool pairwise = m->def->melting.stress == RHEO_STRESS_PAIRWISE;
    const uint32_t rank = m->pairs.rank_of[s->account->id], block = rank / RHEO__BLOCK_ROWS;
    const uint32_t *start = pairwise ? m->bonds.start : m->rows.start;
    rheo__account_begin(s, RHEO__SUM_viscosity);
    for (size_t k = start[block]; k < start[block + 1]; k++) {
        const size_t entry = k * RHEO__BLOCK_ROWS + rank % RHEO__BLOCK_ROWS;
        if (pairwise)
            add_bond(s, m, v, rank, entry);
        else
            add_stress(s, m, rank, entry);
    }
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (contact->rank != rank || !rheo__is_no_slip(m, contact))
            continue;
        if (pairwise)
            add_wall(s, m, v, contact);
        else
            add_wall_stress(s, m, contact);
    }
    rheo__account_apply(s, RHEO__FIELD_velocity, RHEO_SOURCE_SUM, -1, RHEO__SUM_viscosity);
    const rheo__point x = m->cg.x[rank];
    rheo__account_add_rest(s, RHEO__FIELD_velocity, RHEO_SOURCE_SOLVER, (const rheo_real[]){x.x, x.y, x.z});
}
