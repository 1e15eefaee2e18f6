/*
 * The operator A = 1 + dt K of viscosity, docs/melting.md (5). Pairwise, along the line of a pair, with the harmonic
 * mean of both viscosities,
 *
 *     (K v)_i = sum b_ij (v_ij.x_ij) x_ij,   b_ij = -10 m eta_ij slope/(rho_i rho_j (r^2 + 0.01 h^2)) >= 0
 *
 * or nested, as in the paper: D_i, S_i = eta_i D_i, then (K v)_i = -sum m/(rho_i rho_j) (S_i + S_j) grad W. b_ij is
 * the viscous coefficient of a pair. Both forms of K are symmetric and never add energy.
 */
#include "melting/viscous_operator.h"
#include "melting/rows.h"

/* ---- Walls ---- */

/* block = along (1 - n n^T) + normal n n^T */
static inline void wall_block(const rheo_real n[3], rheo_real along, rheo_real normal, rheo_real block[6])
{
    const rheo_real more = normal - along;
    block[0] = along + more * n[0] * n[0];
    block[1] = along + more * n[1] * n[1];
    block[2] = along + more * n[2] * n[2];
    block[3] = more * n[0] * n[1];
    block[4] = more * n[0] * n[2];
    block[5] = more * n[1] * n[2];
}

/* dt K of a particle and a wall, pairwise. */
static inline void contact_block(const rheo__melting *m, const rheo__contact *contact, rheo_real block[6])
{
    const rheo_real scale =
        m->substep * m->viscosity_ratios[contact->rank].y * rheo__inverse_wall_distance(m, contact);
    wall_block(m->planes->plane[contact->wall].normal, scale * contact->integral.along,
               scale * contact->integral.normal, block);
}

static void add_walls_to_diagonal(rheo__melting *m)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!rheo__is_no_slip(m, contact))
            continue;
        rheo_real block[6];
        contact_block(m, contact, block);
        for (int i = 0; i < 6; i++)
            m->cg.block[i][contact->rank] += block[i];
    }
}

/* Adds dt K v of walls, pairwise. */
static void apply_walls(const rheo__melting *m, const rheo__point *v, rheo__point *Av, bool walls_move)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!rheo__is_no_slip(m, contact))
            continue;
        const rheo_real *wall = m->wall_velocity[contact->wall], by = walls_move ? 1 : 0;
        const rheo__point *own = &v[contact->rank];
        rheo_real b[6];
        contact_block(m, contact, b);
        const rheo_real ux = own->x - by * wall[0], uy = own->y - by * wall[1], uz = own->z - by * wall[2];
        rheo__point *to = &Av[contact->rank];
        to->x += b[0] * ux + b[3] * uy + b[4] * uz;
        to->y += b[3] * ux + b[1] * uy + b[5] * uz;
        to->z += b[4] * ux + b[5] * uy + b[2] * uz;
    }
}

/* ---- Pairwise ---- */

/* Adds coefficient x x^T to a sum. */
static inline void add_product(rheo__lanes6 *sum, rheo__lanes coefficient, rheo__lanes3 x)
{
    const rheo__lanes bx = coefficient * x.x, by = coefficient * x.y;
    sum->of[0] += bx * x.x;
    sum->of[1] += by * x.y;
    sum->of[2] += coefficient * x.z * x.z;
    sum->of[3] += bx * x.y;
    sum->of[4] += bx * x.z;
    sum->of[5] += by * x.z;
}

static inline void put_diagonal(rheo__melting *m, uint32_t rank, const rheo__lanes6 *sum)
{
    for (int i = 0; i < 6; i++)
        rheo__lanes_put(m->cg.block[i], rank, i < 3 ? 1 + sum->of[i] : sum->of[i]);
}

/* sqrt(dt b_ij) x_ij of every pair, and the diagonal. */
static void make_pairwise(rheo__melting *m)
{
    rheo__rows *rows = &m->rows;
    const double h = m->smoothing_length, mass = rheo__melting_mass(m->def);
    const rheo_real scale = (rheo_real)(-20 * mass) * m->substep, softening = (rheo_real)(0.01 * h * h);
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        const rheo__lanes eta = rheo__lanes_at(m->viscosity, rank);
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        rheo__lanes density;
        rheo__lanes_load_w(m->velocity, own, &density);
        const rheo__lanes eta_by_density = eta / density;
        rheo__lanes6 sum = rheo__lanes6_zero();
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__lanes3 x = rheo__offsets(rows, entry),
                               other = rheo__lanes_load(m->viscosity_ratios, rows->partner + entry);
            const rheo__lanes slope = rheo__lanes_at(rows->slope, entry), r2 = rheo__lanes3_dot(x, x);
            /* Dividing first keeps the quotient in range for any viscosities; it is 0 where both are 0. */
            const rheo__lanes both = (eta + other.x) * (r2 + softening);
            const rheo__lanes coefficient =
                scale * slope * (eta_by_density * rheo__lanes_keep(both > 0, other.y / both));
            const rheo__lanes root = rheo__lanes_sqrt(coefficient);
            rheo__lanes_put(rows->viscous_x, entry, root * x.x);
            rheo__lanes_put(rows->viscous_y, entry, root * x.y);
            rheo__lanes_put(rows->viscous_z, entry, root * x.z);
            add_product(&sum, coefficient, x);
        }
        put_diagonal(m, rank, &sum);
    }
    add_walls_to_diagonal(m);
}

/* Takes most of the time of a substep. Not inlined, since inlining leaves the loop fewer registers. */
__attribute__((noinline)) static void apply_pairwise(rheo__melting *m, const rheo__point *v, rheo__point *Av)
{
    const rheo__rows *rows = &m->rows;
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(block * RHEO__BLOCK_ROWS + first, own);
        const rheo__lanes3 vi = rheo__lanes_load(v, own);
        rheo__lanes3 sum = vi;
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__lanes3 x = {rheo__lanes_at(rows->viscous_x, entry), rheo__lanes_at(rows->viscous_y, entry),
                                    rheo__lanes_at(rows->viscous_z, entry)};
            const rheo__lanes3 u = rheo__lanes3_minus(vi, rheo__lanes_load(v, rows->partner + entry));
            const rheo__lanes by = rheo__lanes3_dot(u, x);
            sum.x += by * x.x;
            sum.y += by * x.y;
            sum.z += by * x.z;
        }
        rheo__lanes_store(Av, own, sum);
    }
}

/* ---- Nested ---- */

/* The diagonal, without walls. */
static void make_nested(rheo__melting *m)
{
    const rheo__rows *rows = &m->rows;
    const rheo_real mass = (rheo_real)rheo__melting_mass(m->def);
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        rheo__lanes density;
        rheo__lanes_load_w(m->velocity, own, &density);
        rheo__lanes6 sum = rheo__lanes6_zero();
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__lanes3 x = rheo__offsets(rows, entry),
                               other = rheo__lanes_load(m->viscosity_ratios, rows->partner + entry);
            const rheo__lanes by = mass * rheo__lanes_at(rows->slope, entry) / density;
            const rheo__lanes coefficient = m->substep * (by * by) * other.y, r2 = rheo__lanes3_dot(x, x);
            for (int i = 0; i < 3; i++)
                sum.of[i] += coefficient * r2;
            add_product(&sum, coefficient, x);
        }
        put_diagonal(m, rank, &sum);
    }
}

/* D of the fluid alone, into m->gradient. */
static void find_strain(rheo__melting *m, const rheo__point *v)
{
    const rheo__rows *rows = &m->rows;
    const rheo_real mass = (rheo_real)rheo__melting_mass(m->def);
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        const rheo__lanes3 vi = rheo__lanes_load(v, own);
        rheo__lanes6 sum = rheo__lanes6_zero();
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__lanes3 x = rheo__offsets(rows, entry);
            rheo__lanes density;
            rheo__lanes_load_w(m->velocity, rows->partner + entry, &density);
            const rheo__lanes3 u = rheo__lanes3_minus(vi, rheo__lanes_load(v, rows->partner + entry));
            const rheo__lanes scale = -mass * rheo__lanes_at(rows->slope, entry) / density;
            const rheo__lanes gx = scale * x.x, gy = scale * x.y, gz = scale * x.z;
            sum.of[0] += 2 * (u.x * gx);
            sum.of[1] += 2 * (u.y * gy);
            sum.of[2] += 2 * (u.z * gz);
            sum.of[3] += u.x * gy + u.y * gx;
            sum.of[4] += u.x * gz + u.z * gx;
            sum.of[5] += u.y * gz + u.z * gy;
        }
        for (int i = 0; i < 6; i++)
            rheo__lanes_put(m->gradient[i], rank, sum.of[i]);
    }
}

/* Stress S = eta D into m->gradient. */
static void find_stress(rheo__melting *m, const rheo__point *v, bool walls_move)
{
    find_strain(m, v);
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!rheo__is_no_slip(m, contact))
            continue;
        const rheo_real *n = m->planes->plane[contact->wall].normal, *wall = m->wall_velocity[contact->wall];
        const rheo__point *own = &v[contact->rank];
        const rheo_real rate = rheo__wall_rate(m, contact), by = walls_move ? 1 : 0;
        const rheo_real u[3] = {own->x - by * wall[0], own->y - by * wall[1], own->z - by * wall[2]};
        for (int i = 0; i < 3; i++)
            m->gradient[i][contact->rank] += 2 * rate * u[i] * n[i];
        m->gradient[3][contact->rank] += rate * (u[0] * n[1] + u[1] * n[0]);
        m->gradient[4][contact->rank] += rate * (u[0] * n[2] + u[2] * n[0]);
        m->gradient[5][contact->rank] += rate * (u[1] * n[2] + u[2] * n[1]);
    }
    for (int i = 0; i < 6; i++)
        for (uint32_t rank = 0; rank < m->pairs.rows; rank++)
            m->gradient[i][rank] *= m->viscosity[rank];
}

/* Adds dt K v of walls, from the stress of their particles. */
static void apply_stress_at_walls(const rheo__melting *m, rheo__point *Av)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!rheo__is_no_slip(m, contact))
            continue;
        const rheo_real *n = m->planes->plane[contact->wall].normal;
        const rheo_real by = m->substep * rheo__wall_rate(m, contact) / m->velocity[contact->rank].w;
        rheo_real *const *stress = m->gradient;
        const uint32_t i = contact->rank;
        Av[i].x += by * (stress[0][i] * n[0] + stress[3][i] * n[1] + stress[4][i] * n[2]);
        Av[i].y += by * (stress[3][i] * n[0] + stress[1][i] * n[1] + stress[5][i] * n[2]);
        Av[i].z += by * (stress[4][i] * n[0] + stress[5][i] * n[1] + stress[2][i] * n[2]);
    }
}

static void apply_nested(rheo__melting *m, const rheo__point *v, rheo__point *Av, bool walls_move)
{
    const rheo__rows *rows = &m->rows;
    const rheo_real scale = (rheo_real)rheo__melting_mass(m->def) * m->substep;
    find_stress(m, v, walls_move);
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        rheo__lanes density, own_stress[6];
        rheo__lanes_load_w(m->velocity, own, &density);
        for (int i = 0; i < 6; i++)
            own_stress[i] = rheo__lanes_at(m->gradient[i], rank);
        rheo__lanes3 sum = rheo__lanes3_zero();
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const uint32_t *partner = rows->partner + entry;
            const rheo__lanes3 x = rheo__offsets(rows, entry);
            rheo__lanes density_j, stress[6];
            rheo__lanes_load_w(m->velocity, partner, &density_j);
            for (int i = 0; i < 6; i++)
                stress[i] = own_stress[i] + rheo__lanes_values(m->gradient[i], partner);
            const rheo__lanes by = rheo__lanes_at(rows->slope, entry) / (density * density_j);
            sum.x += by * (stress[0] * x.x + stress[3] * x.y + stress[4] * x.z);
            sum.y += by * (stress[3] * x.x + stress[1] * x.y + stress[5] * x.z);
            sum.z += by * (stress[4] * x.x + stress[5] * x.y + stress[2] * x.z);
        }
        const rheo__lanes3 vi = rheo__lanes_load(v, own);
        rheo__lanes_store(Av, own, (rheo__lanes3){vi.x - scale * sum.x, vi.y - scale * sum.y, vi.z - scale * sum.z});
    }
    apply_stress_at_walls(m, Av);
}

/* ---- Either ---- */

void RHEO__VARIANT(make_viscous_operator)(rheo__melting *m)
{
    if (m->def->melting.stress == RHEO_STRESS_PAIRWISE)
        make_pairwise(m);
    else
        make_nested(m);
}

void RHEO__VARIANT(apply_viscous_operator)(rheo__melting *m, const rheo__point *v, rheo__point *Av, bool walls_move)
{
    if (m->def->melting.stress == RHEO_STRESS_NESTED) {
        apply_nested(m, v, Av, walls_move);
    } else {
        apply_pairwise(m, v, Av);
        apply_walls(m, v, Av, walls_move);
    }
}
