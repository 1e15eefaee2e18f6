/*
 * The operator A = 1 + dt K of viscosity, docs/melting.md (5). Pairwise, along the line of a pair, with the harmonic
 * mean of both viscosities,
 *
 *     (K v)_i = sum b_ij (v_ij.x_ij) x_ij,   b_ij = -5 m (c_i + c_j) eta_ij slope/(rho_i rho_j (r^2 + 0.01 h^2)) >= 0
 *
 * or nested, as in the paper: D_i, S_i = eta_i D_i, then the divergence of S, all with corrected gradients:
 * (K v)_i = -sum m (S_i B_i^-1/rho_i^2 + S_j B_j^-1/rho_j^2) grad W. b_ij is the viscous coefficient of a pair.
 * The factors c and the second moments B are in gradients.c. Both forms of K are symmetric and never add energy.
 */
#include "melting/viscous_operator.h"
#include "melting/rows.h"

/* ---- Walls ---- */

static void add_walls_to_diagonal(rheo__melting *m)
{
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!rheo__is_no_slip(m, contact))
            continue;
        rheo_real block[6];
        rheo__contact_block(m, contact, block);
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
        rheo__contact_block(m, contact, b);
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

/*
 * sqrt(dt b_ij) x_ij of every pair, and the diagonal; and Av = A v without walls, which costs little while these are in
 * registers.
 */
static void make_pairwise(rheo__melting *m, const rheo__point *v, rheo__point *Av)
{
    /* Copies, so that no store makes the compiler load them again. */
    const rheo__bonds bonds = m->bonds;
    const rheo__wide_point *point = m->point;
    const double h = m->smoothing_length, mass = rheo__melting_mass(m->def);
    const rheo_real scale = (rheo_real)(-10 * mass) * m->substep, softening = (rheo_real)(0.01 * h * h),
                    support = (rheo_real)m->viscous_support;
    const rheo__lanes support2 = rheo__lanes_all(support * support);
    RHEO__EACH_VECTOR_OF_ROWS(&bonds, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        const rheo__lanes eta = rheo__lanes_at(m->viscosity, rank), factor = rheo__lanes_at(m->viscous_factor, rank);
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        rheo__lanes density;
        rheo__lanes_load_w(m->velocity, own, &density);
        const rheo__lanes3 position = rheo__lanes_load_wide_row(point + rank).at, vi = rheo__lanes_load(v, own);
        rheo__lanes3 product = vi;
        const rheo__lanes eta_by_density = eta / density;
        rheo__lanes6 sum = rheo__lanes6_zero();
        const rheo_real *slopes =
            m->rows.slope + ((size_t)m->rows.start[block] - bonds.start[block]) * RHEO__BLOCK_ROWS;
        RHEO__EACH_ENTRY(&bonds, block, first, entry)
        {
            const uint32_t *partner = bonds.partner + entry;
            const rheo__wide_lanes pair = rheo__lanes_load_wide_at(point, partner);
            const rheo__lanes3 x = rheo__lanes3_minus(position, pair.at), other = pair.more;
            const rheo__lanes3 u = rheo__lanes3_minus(vi, rheo__lanes_load_at(v, partner));
            const rheo__lanes r2 = rheo__lanes3_dot(x, x),
                              slope = rheo__lanes_keep_less(r2, support2, rheo__lanes_at(slopes, entry));
            /* Dividing first keeps the quotient in range for any viscosities; it is 0 where both are 0. */
            const rheo__lanes both = (eta + other.x) * (r2 + softening);
            const rheo__lanes coefficient =
                scale * slope * (factor + other.z) * (eta_by_density * rheo__lanes_keep(both > 0, other.y / both));
            const rheo__lanes3 bond = rheo__lanes3_times(rheo__lanes_sqrt(coefficient), x);
            rheo__lanes_put(bonds.x, entry, bond.x);
            rheo__lanes_put(bonds.y, entry, bond.y);
            rheo__lanes_put(bonds.z, entry, bond.z);
            add_product(&sum, coefficient, x);
            rheo__lanes3_add(&product, rheo__lanes3_dot(u, bond), bond);
        }
        put_diagonal(m, rank, &sum);
        rheo__lanes_store(Av, own, product);
    }
    add_walls_to_diagonal(m);
}

/* Takes most of the time of a substep. Not inlined, since inlining leaves the loop fewer registers. */
__attribute__((noinline)) static void apply_pairwise(rheo__melting *m, const rheo__point *v, rheo__point *Av)
{
    const rheo__bonds *bonds = &m->bonds;
    RHEO__EACH_VECTOR_OF_ROWS(bonds, block, first)
    {
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(block * RHEO__BLOCK_ROWS + first, own);
        const rheo__lanes3 vi = rheo__lanes_load(v, own);
        rheo__lanes3 sum = vi;
        RHEO__EACH_ENTRY(bonds, block, first, entry)
        {
            const rheo__lanes3 x = {rheo__lanes_at(bonds->x, entry), rheo__lanes_at(bonds->y, entry),
                                    rheo__lanes_at(bonds->z, entry)};
            const rheo__lanes3 u = rheo__lanes3_minus(vi, rheo__lanes_load_at(v, bonds->partner + entry));
            const rheo__lanes by = rheo__lanes3_dot(u, x);
            rheo__fetch_partners(bonds->partner, entry);
            rheo__fetch_values(bonds->x, entry);
            rheo__fetch_values(bonds->y, entry);
            rheo__fetch_values(bonds->z, entry);
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
        const rheo__lanes3 position = rheo__lanes_load_wide_row(m->point + rank).at;
        rheo__lanes6 sum = rheo__lanes6_zero();
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__wide_lanes point = rheo__lanes_load_wide_at(m->point, rows->partner + entry);
            const rheo__lanes3 x = rheo__lanes3_minus(position, point.at), other = point.more;
            const rheo__lanes by = mass * rheo__lanes_at(rows->slope, entry) / density;
            const rheo__lanes coefficient = m->substep * (by * by) * other.y, r2 = rheo__lanes3_dot(x, x);
            for (int i = 0; i < 3; i++)
                sum.of[i] += coefficient * r2;
            add_product(&sum, coefficient, x);
        }
        put_diagonal(m, rank, &sum);
    }
}

/* rho_i/m times the sum for grad v over the fluid, by rows into m->stress. */
static void sum_gradients(rheo__melting *m, const rheo__point *v)
{
    const rheo__rows *rows = &m->rows;
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        const rheo__lanes3 vi = rheo__lanes_load(v, own), position = rheo__lanes_load_wide_row(m->point + rank).at;
        rheo__lanes3 gx = rheo__lanes3_zero(), gy = gx, gz = gx;
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const rheo__lanes3 u = rheo__lanes3_minus(vi, rheo__lanes_load_at(v, rows->partner + entry));
            const rheo__lanes3 grad =
                rheo__lanes3_times(rheo__lanes_at(rows->slope, entry), rheo__offsets(m, position, entry));
            rheo__lanes3_add(&gx, u.x, grad);
            rheo__lanes3_add(&gy, u.y, grad);
            rheo__lanes3_add(&gz, u.z, grad);
        }
        rheo__lanes_store(m->stress[0], own, gx);
        rheo__lanes_store(m->stress[1], own, gy);
        rheo__lanes_store(m->stress[2], own, gz);
    }
}

/* Adds walls to these sums. */
static void add_wall_gradients(rheo__melting *m, const rheo__point *v, bool walls_move)
{
    const rheo_real mass = (rheo_real)rheo__melting_mass(m->def);
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!rheo__is_no_slip(m, contact))
            continue;
        const rheo_real *n = m->planes->plane[contact->wall].normal, *wall = m->wall_velocity[contact->wall];
        const rheo__point *own = &v[contact->rank];
        const rheo_real rate = -rheo__wall_rate(m, contact) * m->velocity[contact->rank].w / mass,
                        by = walls_move ? 1 : 0;
        const rheo_real u[3] = {own->x - by * wall[0], own->y - by * wall[1], own->z - by * wall[2]};
        for (int i = 0; i < 3; i++) {
            rheo__point *g = &m->stress[i][contact->rank];
            g->x += rate * u[i] * n[0];
            g->y += rate * u[i] * n[1];
            g->z += rate * u[i] * n[2];
        }
    }
}

/* These sums become m S_i B_i^-1/rho_i^2. */
static void find_stress(rheo__melting *m)
{
    const rheo_real mass = (rheo_real)rheo__melting_mass(m->def);
    RHEO__EACH_VECTOR_OF_ROWS(&m->rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        rheo__lanes density;
        rheo__lanes_load_w(m->velocity, own, &density);
        rheo__lanes6 inverse;
        for (int i = 0; i < 6; i++)
            inverse.of[i] = rheo__lanes_at(m->inverse_moment[i], rank);
        const rheo__lanes volume = mass / density,
                          by = -volume * rheo__lanes_at(m->viscosity, rank) * (volume / density);
        const rheo__lanes3 x = rheo__lanes6_times(&inverse, rheo__lanes_load(m->stress[0], own)),
                           y = rheo__lanes6_times(&inverse, rheo__lanes_load(m->stress[1], own)),
                           z = rheo__lanes6_times(&inverse, rheo__lanes_load(m->stress[2], own));
        const rheo__lanes xy = by * (x.y + y.x), xz = by * (x.z + z.x), yz = by * (y.z + z.y);
        const rheo__lanes3 sx = {2 * by * x.x, xy, xz}, sy = {xy, 2 * by * y.y, yz}, sz = {xz, yz, 2 * by * z.z};
        rheo__lanes_store(m->stress[0], own, rheo__lanes6_times(&inverse, sx));
        rheo__lanes_store(m->stress[1], own, rheo__lanes6_times(&inverse, sy));
        rheo__lanes_store(m->stress[2], own, rheo__lanes6_times(&inverse, sz));
    }
}

/* Adds dt K v of walls, from the stress of their particles. */
static void apply_stress_at_walls(const rheo__melting *m, rheo__point *Av)
{
    const rheo_real mass = (rheo_real)rheo__melting_mass(m->def);
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!rheo__is_no_slip(m, contact))
            continue;
        const uint32_t i = contact->rank;
        const rheo_real *n = m->planes->plane[contact->wall].normal;
        const rheo_real by = m->substep * rheo__wall_rate(m, contact) * (m->velocity[i].w / mass);
        const rheo__point *x = &m->stress[0][i], *y = &m->stress[1][i], *z = &m->stress[2][i];
        Av[i].x += by * (x->x * n[0] + x->y * n[1] + x->z * n[2]);
        Av[i].y += by * (y->x * n[0] + y->y * n[1] + y->z * n[2]);
        Av[i].z += by * (z->x * n[0] + z->y * n[1] + z->z * n[2]);
    }
}

static void apply_nested(rheo__melting *m, const rheo__point *v, rheo__point *Av, bool walls_move)
{
    const rheo__rows *rows = &m->rows;
    sum_gradients(m, v);
    add_wall_gradients(m, v, walls_move);
    find_stress(m);
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(rank, own);
        const rheo__lanes3 sx = rheo__lanes_load(m->stress[0], own), sy = rheo__lanes_load(m->stress[1], own),
                           sz = rheo__lanes_load(m->stress[2], own),
                           position = rheo__lanes_load_wide_row(m->point + rank).at;
        rheo__lanes3 sum = rheo__lanes3_zero();
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            const uint32_t *partner = rows->partner + entry;
            const rheo__lanes3 grad =
                rheo__lanes3_times(rheo__lanes_at(rows->slope, entry), rheo__offsets(m, position, entry));
            const rheo__lanes3 tx = rheo__lanes_load_at(m->stress[0], partner),
                               ty = rheo__lanes_load_at(m->stress[1], partner),
                               tz = rheo__lanes_load_at(m->stress[2], partner);
            sum.x += (sx.x + tx.x) * grad.x + (sx.y + tx.y) * grad.y + (sx.z + tx.z) * grad.z;
            sum.y += (sy.x + ty.x) * grad.x + (sy.y + ty.y) * grad.y + (sy.z + ty.z) * grad.z;
            sum.z += (sz.x + tz.x) * grad.x + (sz.y + tz.y) * grad.y + (sz.z + tz.z) * grad.z;
        }
        const rheo__lanes3 vi = rheo__lanes_load(v, own);
        rheo__lanes_store(Av, own, rheo__lanes3_minus(vi, rheo__lanes3_times(rheo__lanes_all(m->substep), sum)));
    }
    apply_stress_at_walls(m, Av);
}

/* ---- Either ---- */

void RHEO__VARIANT(make_viscous_operator)(rheo__melting *m, const rheo__point *v, rheo__point *Av)
{
    if (m->def->melting.stress == RHEO_STRESS_PAIRWISE) {
        make_pairwise(m, v, Av);
        apply_walls(m, v, Av, true);
    } else {
        make_nested(m);
        apply_nested(m, v, Av, true);
    }
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
