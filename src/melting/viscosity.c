/*
 * Stage viscosity, docs/melting.md (4, 5): the apparent viscosity of every particle, and what it does to velocities.
 *
 *     eta = mu eta*(D t0),  eta*(D) = -expm1(-(J+1) D) (D^(n-1) + 1/D)
 *
 * Pairwise, along the line of a pair, with the harmonic mean of both viscosities,
 *
 *     dv_i/dt = -sum b_ij (v_ij.x_ij) x_ij,   b_ij = -10 m eta_ij slope/(rho_i rho_j (r^2 + 0.01 h^2)) >= 0
 *
 * or nested, as the paper has it: D_i, S_i = eta_i D_i, then sum m/(rho_i rho_j) (S_i + S_j) grad W. Both are
 * symmetric and take energy out. Implicitly, v + dt K v = v* is solved by conjugate gradients, preconditioned by the
 * 3 x 3 blocks of the diagonal; dot products are added up in one order.
 */
#include "core/math.h"
#include "melting/dispatch.h"
#include "melting/rows.h"

/* ---- Apparent viscosity ---- */

/*
 * expm1 of a number from -40 to 0: a series at a 64th of it, then six doublings p <- 2p + p^2. Tests hold it to a relative
 * error of 1e-5 in float.
 */
static inline rheo__lanes expm1_negative(rheo__lanes x)
{
    const rheo__lanes u = x * RHEO__R(0.015625);
    static const double INVERSE[] = {1.0 / 15, 1.0 / 14, 1.0 / 13, 1.0 / 12, 1.0 / 11, 1.0 / 10, 1.0 / 9,
                                     1.0 / 8,  1.0 / 7,  1.0 / 6,  1.0 / 5,  1.0 / 4,  1.0 / 3,  1.0 / 2};
    enum { TERMS = sizeof INVERSE / sizeof *INVERSE };
    rheo__lanes p = rheo__lanes_all(1);
    for (int i = RHEO_DOUBLE ? 0 : TERMS - 8; i < TERMS; i++)
        p = 1 + p * (u * (rheo_real)INVERSE[i]);
    p *= u;
    for (int i = 0; i < 6; i++)
        p += p + p * p;
    return p;
}

/* J of the temperatures of a vector. */
static inline rheo__lanes jumps(const rheo_world_def *def, rheo__lanes temperature)
{
    const double low = def->melting.temperature_min, high = def->melting.temperature_max;
    const rheo__lanes cold = rheo__lanes_all((rheo_real)def->melting.jump_number_max),
                      hot = rheo__lanes_all((rheo_real)def->melting.jump_number_min);
    rheo__lanes u = (temperature - (rheo_real)low) * (rheo_real)(1 / (high - low));
    if (def->paper.jump)
        return rheo__lanes_max((1 - u) * cold - u * hot, rheo__lanes_all(0));
    u = rheo__lanes_min(rheo__lanes_max(u, rheo__lanes_all(0)), rheo__lanes_all(1));
    return (1 - u) * cold + u * hot;
}

static void find_viscosities(const rheo__state *s, rheo__melting *m)
{
    const rheo_world_def *def = m->def;
    const bool heat = rheo__state_has(s, RHEO__FIELD_temperature), jump = def->melting.rheology == RHEO_RHEOLOGY_JUMP;
    const double exponent = def->melting.power_law_index - 1;
    for (uint32_t i = 0; i < s->particles && heat; i++)
        m->temperature[i] = s->temperature[m->pairs.id_of[i]];
    for (uint32_t i = 0; i < s->particles; i += RHEO__LANES) {
        rheo__lanes eta = rheo__lanes_all((rheo_real)def->melting.viscosity);
        if (jump) {
            const rheo__lanes j = jumps(def, heat ? rheo__lanes_at(m->temperature, i)
                                                  : rheo__lanes_all((rheo_real)def->melting.temperature));
            const rheo__lanes d =
                rheo__lanes_max(rheo__lanes_at(m->shear_rate, i) * (rheo_real)def->melting.time_scale,
                                rheo__lanes_all(RHEO__R(1e-14)));
            rheo__lanes power = 1 / rheo__lanes_sqrt(d);
            for (int lane = 0; lane < RHEO__LANES && exponent != -0.5; lane++)
                RHEO__LANE(power, lane) = (rheo_real)rheo__pow((double)RHEO__LANE(d, lane), exponent);
            eta *= -expm1_negative(rheo__lanes_max(-(j + 1) * d, rheo__lanes_all(-40))) * (power + 1 / d);
        }
        rheo__lanes_put(m->viscosity, i, eta);
    }
    for (uint32_t i = 0; i < s->particles; i++)
        m->viscous[i] = (rheo__point){m->viscosity[i], m->viscosity[i] / m->velocity[i].w, 0, 0};
    m->viscous[s->particles] = (rheo__point){1, 1, 0, 0};
}

/* ---- The system ---- */

/* Adds a symmetric block to the diagonal of a row. */
static inline void add_diagonal(rheo__melting *m, uint32_t rank, const rheo_real block[6])
{
    for (int i = 0; i < 6; i++)
        m->diagonal[i][rank] += block[i];
}

/* along (1 - n n^T) + normal n n^T */
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

static bool slips(const rheo__melting *m)
{
    return m->def->melting.wall == RHEO_WALL_FREE_SLIP;
}

/* Whether a contact holds what touches it by viscosity. */
static bool holds(const rheo__melting *m, const rheo__contact *contact)
{
    return !contact->loose && !slips(m);
}

/* dt K of a particle and a wall, pairwise. */
static inline void contact_block(const rheo__melting *m, const rheo__contact *contact, rheo_real block[6])
{
    const rheo_real scale = m->substep * m->viscous[contact->rank].y * rheo__inverse_wall_distance(m, contact);
    wall_block(m->wall_normal[contact->wall], scale * contact->of.along, scale * contact->of.normal, block);
}

/* Makes sqrt(dt b_ij) x_ij of every pair, and the diagonal blocks of 1 + dt K. */
static void make_bonds(rheo__melting *m, bool pairwise)
{
    rheo__rows *rows = &m->rows;
    const double h = m->smoothing_length;
    const rheo_real scale = (rheo_real)(-20 * m->mass) * m->substep, softening = (rheo_real)(0.01 * h * h),
                    mass = (rheo_real)m->mass;
    for (uint32_t block = 0; block < rows->blocks; block++)
        RHEO__EACH_VECTOR_OF_BLOCK (first) {
            const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
            const rheo__lanes eta = rheo__lanes_at(m->viscosity, rank);
            uint32_t own[RHEO__LANES];
            rheo__own_ranks(rank, own);
            rheo__lanes density;
            rheo__lanes_load_w(m->velocity, own, &density);
            const rheo__lanes eta_by_density = eta / density;
            rheo__lanes6 sum = rheo__lanes6_zero();
            for (uint32_t entry = rows->start[block]; entry < rows->start[block + 1]; entry++) {
                const size_t place = (size_t)entry * RHEO__BLOCK_ROWS + first;
                const rheo__lanes3 x = rheo__offsets(rows, place),
                                   other = rheo__lanes_load(m->viscous, rows->partner + place);
                const rheo__lanes slope = rheo__lanes_at(rows->slope, place), r2 = rheo__lanes3_dot(x, x);
                rheo__lanes bond;
                if (pairwise) {
                    /* The quotient first: it stays in range for any viscosities, and is 0 where both are. */
                    const rheo__lanes both = (eta + other.x) * (r2 + softening);
                    bond = scale * slope * (eta_by_density * rheo__lanes_keep(both > 0, other.y / both));
                    const rheo__lanes root = rheo__lanes_sqrt(bond);
                    rheo__lanes_put(rows->bond_x, place, root * x.x);
                    rheo__lanes_put(rows->bond_y, place, root * x.y);
                    rheo__lanes_put(rows->bond_z, place, root * x.z);
                } else {
                    const rheo__lanes by = mass * slope / density;
                    bond = m->substep * (by * by) * other.y;
                    for (int i = 0; i < 3; i++)
                        sum.of[i] += bond * r2;
                }
                const rheo__lanes bx = bond * x.x, by = bond * x.y;
                sum.of[0] += bx * x.x;
                sum.of[1] += by * x.y;
                sum.of[2] += bond * x.z * x.z;
                sum.of[3] += bx * x.y;
                sum.of[4] += bx * x.z;
                sum.of[5] += by * x.z;
            }
            for (int i = 0; i < 6; i++)
                rheo__lanes_put(m->diagonal[i], rank, i < 3 ? 1 + sum.of[i] : sum.of[i]);
        }
    for (uint32_t k = 0; k < m->contacts && pairwise; k++) {
        if (!holds(m, &m->contact[k]))
            continue;
        rheo_real block[6];
        contact_block(m, &m->contact[k], block);
        add_diagonal(m, m->contact[k].rank, block);
    }
}

/* Inverts the blocks, which are symmetric and positive. */
static void invert_diagonal(rheo__melting *m)
{
    rheo_real *const *d = m->diagonal;
    for (uint32_t i = 0; i < m->pairs.rows; i++) {
        const rheo_real xx = d[0][i], yy = d[1][i], zz = d[2][i], xy = d[3][i], xz = d[4][i], yz = d[5][i];
        const rheo_real a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
        const rheo_real scale = 1 / (xx * a + xy * b + xz * c);
        d[0][i] = a * scale;
        d[1][i] = (xx * zz - xz * xz) * scale;
        d[2][i] = (xx * yy - xy * xy) * scale;
        d[3][i] = b * scale;
        d[4][i] = c * scale;
        d[5][i] = (xy * xz - xx * yz) * scale;
    }
}

/* ---- Its product with velocities ---- */

static void multiply_pairwise(rheo__melting *m, const rheo__point *v, rheo__point *image)
{
    const rheo__rows *rows = &m->rows;
    for (uint32_t block = 0; block < rows->blocks; block++)
        RHEO__EACH_VECTOR_OF_BLOCK (first) {
            uint32_t own[RHEO__LANES];
            rheo__own_ranks(block * RHEO__BLOCK_ROWS + first, own);
            const rheo__lanes3 vi = rheo__lanes_load(v, own);
            rheo__lanes3 sum = vi;
            for (uint32_t entry = rows->start[block]; entry < rows->start[block + 1]; entry++) {
                const size_t place = (size_t)entry * RHEO__BLOCK_ROWS + first;
                const rheo__lanes3 x = {rheo__lanes_at(rows->bond_x, place), rheo__lanes_at(rows->bond_y, place),
                                        rheo__lanes_at(rows->bond_z, place)};
                const rheo__lanes3 u = rheo__lanes3_minus(vi, rheo__lanes_load(v, rows->partner + place));
                const rheo__lanes by = rheo__lanes3_dot(u, x);
                sum.x += by * x.x;
                sum.y += by * x.y;
                sum.z += by * x.z;
            }
            rheo__lanes_store(image, own, sum);
        }
}

/* S = eta (grad v + (grad v)^T) into m->gradient[0..5]; walls as they are or, for directions, at rest. */
static void find_stress(rheo__melting *m, const rheo__point *v, bool walls_move)
{
    const rheo__rows *rows = &m->rows;
    const rheo_real mass = (rheo_real)m->mass;
    for (uint32_t block = 0; block < rows->blocks; block++)
        RHEO__EACH_VECTOR_OF_BLOCK (first) {
            const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
            uint32_t own[RHEO__LANES];
            rheo__own_ranks(rank, own);
            const rheo__lanes3 vi = rheo__lanes_load(v, own);
            rheo__lanes6 sum = rheo__lanes6_zero();
            for (uint32_t entry = rows->start[block]; entry < rows->start[block + 1]; entry++) {
                const size_t place = (size_t)entry * RHEO__BLOCK_ROWS + first;
                const rheo__lanes3 x = rheo__offsets(rows, place);
                rheo__lanes density;
                rheo__lanes_load_w(m->velocity, rows->partner + place, &density);
                const rheo__lanes3 u = rheo__lanes3_minus(vi, rheo__lanes_load(v, rows->partner + place));
                const rheo__lanes scale = -mass * rheo__lanes_at(rows->slope, place) / density;
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
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!holds(m, contact))
            continue;
        const rheo_real *n = m->wall_normal[contact->wall], *wall = m->wall_velocity[contact->wall];
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

static void multiply_nested(rheo__melting *m, const rheo__point *v, rheo__point *image, bool walls_move)
{
    const rheo__rows *rows = &m->rows;
    const rheo_real scale = (rheo_real)m->mass * m->substep;
    find_stress(m, v, walls_move);
    for (uint32_t block = 0; block < rows->blocks; block++)
        RHEO__EACH_VECTOR_OF_BLOCK (first) {
            const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
            uint32_t own[RHEO__LANES];
            rheo__own_ranks(rank, own);
            rheo__lanes density, own_stress[6];
            rheo__lanes_load_w(m->velocity, own, &density);
            for (int i = 0; i < 6; i++)
                own_stress[i] = rheo__lanes_at(m->gradient[i], rank);
            rheo__lanes3 sum = rheo__lanes3_zero();
            for (uint32_t entry = rows->start[block]; entry < rows->start[block + 1]; entry++) {
                const size_t place = (size_t)entry * RHEO__BLOCK_ROWS + first;
                const uint32_t *partner = rows->partner + place;
                const rheo__lanes3 x = rheo__offsets(rows, place);
                rheo__lanes density_j, stress[6];
                rheo__lanes_load_w(m->velocity, partner, &density_j);
                for (int i = 0; i < 6; i++)
                    stress[i] = own_stress[i] + rheo__lanes_values(m->gradient[i], partner);
                const rheo__lanes by = rheo__lanes_at(rows->slope, place) / (density * density_j);
                sum.x += by * (stress[0] * x.x + stress[3] * x.y + stress[4] * x.z);
                sum.y += by * (stress[3] * x.x + stress[1] * x.y + stress[5] * x.z);
                sum.z += by * (stress[4] * x.x + stress[5] * x.y + stress[2] * x.z);
            }
            const rheo__lanes3 vi = rheo__lanes_load(v, own);
            rheo__lanes_store(image, own,
                              (rheo__lanes3){vi.x - scale * sum.x, vi.y - scale * sum.y, vi.z - scale * sum.z});
        }
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!holds(m, contact))
            continue;
        const rheo_real *n = m->wall_normal[contact->wall];
        const rheo_real by = m->substep * rheo__wall_rate(m, contact) / m->velocity[contact->rank].w;
        rheo_real *const *stress = m->gradient;
        const uint32_t i = contact->rank;
        image[i].x += by * (stress[0][i] * n[0] + stress[3][i] * n[1] + stress[4][i] * n[2]);
        image[i].y += by * (stress[3][i] * n[0] + stress[1][i] * n[1] + stress[5][i] * n[2]);
        image[i].z += by * (stress[4][i] * n[0] + stress[5][i] * n[1] + stress[2][i] * n[2]);
    }
}

/* image = v + dt K v. walls_move: with what moving walls do; K alone is linear. */
static void multiply(rheo__melting *m, const rheo__point *v, rheo__point *image, bool walls_move)
{
    if (m->def->melting.stress == RHEO_STRESS_NESTED) {
        multiply_nested(m, v, image, walls_move);
        return;
    }
    multiply_pairwise(m, v, image);
    for (uint32_t k = 0; k < m->contacts; k++) {
        const rheo__contact *contact = &m->contact[k];
        if (!holds(m, contact))
            continue;
        const rheo_real *wall = m->wall_velocity[contact->wall], by = walls_move ? 1 : 0;
        const rheo__point *own = &v[contact->rank];
        rheo_real b[6];
        contact_block(m, contact, b);
        const rheo_real ux = own->x - by * wall[0], uy = own->y - by * wall[1], uz = own->z - by * wall[2];
        rheo__point *to = &image[contact->rank];
        to->x += b[0] * ux + b[3] * uy + b[4] * uz;
        to->y += b[3] * ux + b[1] * uy + b[5] * uz;
        to->z += b[4] * ux + b[5] * uy + b[2] * uz;
    }
}

/* ---- Conjugate gradients ---- */

/* Four sums, so that none waits for the one before; always in this order. */
static double dot(const rheo__point *a, const rheo__point *b, uint32_t count)
{
    enum { SUMS = 4 };
    double sum[SUMS] = {0};
    for (uint32_t i = 0; i < count; i++)
        sum[i % SUMS] += (double)(a[i].x * b[i].x + a[i].y * b[i].y + a[i].z * b[i].z);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* a + by b */
static inline rheo__point along(rheo__point a, rheo_real by, rheo__point b)
{
    return (rheo__point){a.x + by * b.x, a.y + by * b.y, a.z + by * b.z, 0};
}

static inline rheo__point precondition(const rheo__melting *m, uint32_t i)
{
    rheo_real *const *d = m->diagonal;
    const rheo__point r = m->residual[i];
    return (rheo__point){d[0][i] * r.x + d[3][i] * r.y + d[4][i] * r.z, d[3][i] * r.x + d[1][i] * r.y + d[5][i] * r.z,
                         d[4][i] * r.x + d[5][i] * r.y + d[2][i] * r.z, 0};
}

/* Preconditions the residual into m->image; their product. */
static double precondition_all(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    for (uint32_t i = 0; i < count; i++)
        m->image[i] = precondition(m, i);
    return dot(m->residual, m->image, count);
}

/*
 * Where no wall holds the fluid, K does nothing to what all particles have in common: the mean of the residual is
 * solved for by adding it. So the tolerance takes no momentum.
 */
static void solve_mean(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    bool held = false;
    for (uint32_t k = 0; k < m->contacts; k++)
        held = held || holds(m, &m->contact[k]);
    if (held || count == 0)
        return;
    double sum[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        sum[0] += (double)m->residual[i].x;
        sum[1] += (double)m->residual[i].y;
        sum[2] += (double)m->residual[i].z;
    }
    const rheo__point mean = {(rheo_real)(sum[0] / count), (rheo_real)(sum[1] / count), (rheo_real)(sum[2] / count),
                              0};
    for (uint32_t i = 0; i < count; i++) {
        m->solution[i] = along(m->solution[i], 1, mean);
        m->residual[i] = along(m->residual[i], -1, mean);
    }
}

enum { UNSOLVABLE = -1 };

static bool is_number(double x)
{
    return x - x == 0;
}

/*
 * Goes on from residual and solution until no more than `enough` rests of the square; how many iterations it took, or
 * UNSOLVABLE if numbers are none.
 */
static int64_t iterate(rheo__melting *m, double enough)
{
    const uint32_t count = m->pairs.rows;
    int64_t iterations = 0;
    double old = 0, rest;
    while (!((rest = dot(m->residual, m->residual, count)) <= enough) &&
           iterations < (int64_t)m->def->melting.max_iterations) {
        const double now = precondition_all(m);
        if (iterations == 0) {
            memcpy(m->direction, m->image, (size_t)count * sizeof *m->direction);
            m->direction[count] = (rheo__point){0, 0, 0, 0};
        } else {
            const rheo_real by = (rheo_real)(now / old);
            for (uint32_t i = 0; i < count; i++)
                m->direction[i] = along(m->image[i], by, m->direction[i]);
        }
        multiply(m, m->direction, m->image, false);
        const double curvature = dot(m->direction, m->image, count);
        if (!is_number(rest) || !is_number(now) || !is_number(curvature))
            return UNSOLVABLE;
        if (!(curvature > 0)) /* what rests is too small for its squares to be told from 0 */
            break;
        const rheo_real step = (rheo_real)(now / curvature);
        for (uint32_t i = 0; i < count; i++) {
            m->solution[i] = along(m->solution[i], step, m->direction[i]);
            m->residual[i] = along(m->residual[i], -step, m->image[i]);
        }
        old = now;
        iterations++;
    }
    return iterations;
}

/*
 * Where the solver begins: velocities that go on changing as they did in the substep before. Of the first substep of
 * a step that is not known, so that a step depends on nothing but the state that it begins with. Returns the square
 * of the change that is assumed.
 */
static double begin_solution(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    for (uint32_t i = 0; i < count; i++) {
        rheo__point *last = &m->velocity_last[m->pairs.id_of[i]];
        const rheo__point now = along((rheo__point){0, 0, 0, 0}, 1, m->velocity_before[i]);
        m->direction[i] = m->has_last ? along(now, -1, *last) : (rheo__point){0, 0, 0, 0};
        m->solution[i] = along(now, 1, m->direction[i]);
        *last = now;
    }
    m->solution[count] = (rheo__point){0, 0, 0, 0};
    return dot(m->direction, m->direction, count);
}

/*
 * Solves (1 + dt K) v = v* for m->solution; how many iterations it took, or UNSOLVABLE. The tolerance is of changes:
 * of what other forces have done in this substep, and of what velocities changed by in the one before (in the first,
 * of what viscosity would do). It is the same whatever the fluid as a whole moves at, or what falls fast would no
 * longer feel gravity. Rounding sets a limit, and that is of velocities.
 */
static int64_t solve(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    const double least = 4 * (RHEO_DOUBLE ? 0x1p-53 : 0x1p-24), tolerance = m->def->melting.tolerance;
    const bool first = !m->has_last;
    double change = begin_solution(m);
    m->has_last = true;
    for (uint32_t i = 0; i < count; i++)
        m->direction[i] = along(m->velocity[i], -1, m->velocity_before[i]);
    change += dot(m->direction, m->direction, count);
    multiply(m, m->solution, m->image, true);
    for (uint32_t i = 0; i < count; i++)
        m->residual[i] = along(m->velocity[i], -1, m->image[i]);
    solve_mean(m);
    if (first)
        change += dot(m->residual, m->residual, count);
    const double enough = tolerance * tolerance * change,
                 rounding = least * least * dot(m->velocity, m->velocity, count);
    if (!is_number(enough))
        return UNSOLVABLE;
    const int64_t iterations = iterate(m, enough > rounding ? enough : rounding);
    solve_mean(m);
    return iterations;
}

/* What a solver without a solution found: velocities that were no numbers before, which the step will find, or
 * others. */
static rheo_result give_up(rheo__state *s, const rheo__melting *m)
{
    uint32_t worst = 0;
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo__point v = m->velocity[i];
        if (!is_number((double)(v.x + v.y + v.z)))
            return RHEO_OK; /* momentum has left them in the state */
        worst = m->viscosity[i] > m->viscosity[worst] ? i : worst;
    }
    s->refusal = (rheo__refusal){RHEO__FIELD_velocity, s->particles ? m->pairs.id_of[worst] : 0,
                                 RHEO_FAILURE_VISCOSITY_OUT_OF_RANGE, 0, 0};
    return RHEO_ERROR_STATE;
}

rheo_result RHEO__VARIANT(stage_viscous)(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const bool pairwise = m->def->melting.stress == RHEO_STRESS_PAIRWISE,
               implicit = m->def->melting.solver == RHEO_VISCOSITY_IMPLICIT;
    find_viscosities(s, m);
    if (pairwise || implicit)
        make_bonds(m, pairwise);
    if (implicit) {
        invert_diagonal(m);
        const int64_t iterations = solve(m);
        if (iterations == UNSOLVABLE)
            return give_up(s, m);
        *s->iterations += (uint64_t)iterations;
    } else {
        /* v* - dt K v, of the velocities at the start. */
        for (uint32_t i = 0; i <= s->particles; i++)
            m->direction[i] = along((rheo__point){0, 0, 0, 0}, 1, m->velocity_before[i]);
        multiply(m, m->direction, m->image, true);
        for (uint32_t i = 0; i < s->particles; i++)
            m->solution[i] = along(along(m->velocity[i], -1, m->image[i]), 1, m->direction[i]);
    }
    for (uint32_t i = 0; i < s->particles; i++)
        m->velocity[i] = (rheo__point){m->solution[i].x, m->solution[i].y, m->solution[i].z, m->velocity[i].w};
    rheo__scatter(s->velocity, m->velocity, m->pairs.id_of, s->particles);
    return RHEO_OK;
}
