/*
 * Conjugate gradients for A x = v*, A = 1 + dt K (viscous_operator.h), preconditioned by the inverse of the 3 x 3
 * blocks of the diagonal of A. r = v* - A x is the residual, z = M^-1 r, p the direction. Dot products have one fixed
 * order of additions.
 */
#include <string.h>

#include "melting/rows.h"
#include "melting/viscous_operator.h"

/* Four sums over particles, so that additions do not wait for each other. */
enum { SUMS = 4 };
_Static_assert(RHEO__LANES == 1 || RHEO__LANES % SUMS == 0, "the first lane of a vector belongs to the first sum");

/* Adds the terms of the particles from rank i on. */
static inline void add_terms(double sum[SUMS], rheo__lanes terms, uint32_t i, uint32_t count)
{
    rheo_real term[RHEO__LANES];
    memcpy(term, &terms, sizeof term);
    if (count - i >= RHEO__LANES)
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            sum[(RHEO__LANES == 1 ? i : lane) % SUMS] += (double)term[lane];
    else
        for (uint32_t lane = 0; lane < count - i; lane++)
            sum[lane % SUMS] += (double)term[lane];
}
static double total(const double sum[SUMS])
{
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static double dot(const rheo__point *a, const rheo__point *b, uint32_t count)
{
    double sum[SUMS] = {0};
    for (uint32_t i = 0; i < count; i += RHEO__LANES) {
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(i, own);
        add_terms(sum, rheo__lanes3_dot(rheo__lanes_load(a, own), rheo__lanes_load(b, own)), i, count);
    }
    return total(sum);
}

/* to = a + by b for all values of `count` points, with w 0 in both. */
static void combine(rheo__point *to, const rheo__point *a, rheo_real by, const rheo__point *b, uint32_t count)
{
    rheo_real *value = &to->x;
    const rheo_real *first = &a->x, *second = &b->x;
    for (size_t k = 0; k < RHEO__POINT_VALUES * (size_t)count; k++)
        value[k] = first[k] + by * second[k];
}

/* Inverts the blocks of the diagonal, which are symmetric and positive. */
static void invert_blocks(rheo__melting *m)
{
    rheo_real *const *d = m->cg.block;
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

/* z = M^-1 r. Returns r z. */
static double precondition(rheo__melting *m)
{
    double sum[SUMS] = {0};
    for (uint32_t i = 0; i < m->pairs.rows; i += RHEO__LANES) {
        uint32_t own[RHEO__LANES];
        rheo__own_ranks(i, own);
        rheo__lanes6 block;
        for (int k = 0; k < 6; k++)
            block.of[k] = rheo__lanes_at(m->cg.block[k], i);
        const rheo__lanes3 r = rheo__lanes_load(m->cg.r, own), z = rheo__lanes6_times(&block, r);
        rheo__lanes_store(m->cg.z, own, z);
        add_terms(sum, rheo__lanes3_dot(r, z), i, m->pairs.rows);
    }
    return total(sum);
}

/*
 * Without no-slip walls, K v = 0 for a velocity that all particles share. So adding
 * the mean of the residual to x solves for it exactly, and the tolerance does not cost momentum.
 */
static void solve_mean(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    bool no_slip = false;
    for (uint32_t k = 0; k < m->contacts; k++)
        no_slip = no_slip || rheo__is_no_slip(m, &m->contact[k]);
    if (no_slip || count == 0)
        return;
    double sum[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        sum[0] += (double)m->cg.r[i].x;
        sum[1] += (double)m->cg.r[i].y;
        sum[2] += (double)m->cg.r[i].z;
    }
    const rheo__point mean = {(rheo_real)(sum[0] / count), (rheo_real)(sum[1] / count), (rheo_real)(sum[2] / count),
                              0};
    for (uint32_t i = 0; i < count; i++) {
        m->cg.x[i] = rheo__point_add(m->cg.x[i], 1, mean);
        m->cg.r[i] = rheo__point_add(m->cg.r[i], -1, mean);
    }
}

static bool is_number(double x)
{
    return x - x == 0;
}

/* Iterates from x and r until r2 = |r|^2 is at most r2_target. */
static int64_t iterate(rheo__melting *m, double r2_target)
{
    rheo__point *x = m->cg.x, *r = m->cg.r, *z = m->cg.z, *p = m->cg.p, *Ap = m->cg.Ap;
    const uint32_t count = m->pairs.rows;
    int64_t iterations = 0;
    double rz_previous = 0, r2;
    while (!((r2 = dot(r, r, count)) <= r2_target) && iterations < (int64_t)m->def->melting.max_iterations) {
        const double rz = precondition(m);
        if (iterations == 0) {
            memcpy(p, z, (size_t)count * sizeof *p);
            p[count] = (rheo__point){0, 0, 0, 0};
        } else {
            combine(p, z, (rheo_real)(rz / rz_previous), p, count);
        }
        RHEO__VARIANT(apply_viscous_operator)(m, p, Ap, false);
        const double pAp = dot(p, Ap, count);
        if (!is_number(r2) || !is_number(rz) || !is_number(pAp))
            return RHEO__UNSOLVABLE;
        if (!(pAp > 0)) /* the squares of the residual underflow */
            break;
        const rheo_real alpha = (rheo_real)(rz / pAp);
        combine(x, x, alpha, p, count);
        combine(r, r, -alpha, Ap, count);
        rz_previous = rz;
        iterations++;
    }
    return iterations;
}

/*
 * Initial x: velocities at the start of the substep, plus their change in the previous substep of this step, plus half
 * the difference of that change to the one before it; the whole difference would double the noise. The first substeps
 * have no changes before them, so a step depends only on the state that it begins with. Returns the square of the last
 * change.
 */
static double begin(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t id = m->pairs.id_of[i];
        rheo__point *last = &m->velocity_last[id], *last_change = &m->change_last[id];
        const rheo__point none = {0, 0, 0, 0}, now = rheo__point_add(none, 1, m->velocity_before[i]),
                          change = m->solved ? rheo__point_add(now, -1, *last) : none;
        m->cg.p[i] = change;
        m->cg.x[i] = rheo__point_add(now, 1, change);
        if (m->solved > 1)
            m->cg.x[i] = rheo__point_add(m->cg.x[i], RHEO__R(0.5), rheo__point_add(change, -1, *last_change));
        *last = now;
        *last_change = change;
    }
    m->cg.x[count] = (rheo__point){0, 0, 0, 0};
    return dot(m->cg.p, m->cg.p, count);
}

/*
 * The tolerance is relative to velocity changes, hence Galilean invariant: the change by other forces in this
 * substep, and the change in the previous substep (in the first one, the change by viscosity itself). Relative to
 * velocities, fluid in fast fall would no longer feel gravity. Rounding sets a lower limit, which is relative to
 * velocities.
 */
int64_t RHEO__VARIANT(conjugate_gradient)(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    const double rounding = 4 * (RHEO_DOUBLE ? 0x1p-53 : 0x1p-24), tolerance = m->def->melting.tolerance;
    const bool first = m->solved == 0;
    double change2 = begin(m);
    for (uint32_t i = 0; i < count; i++)
        m->cg.p[i] = rheo__point_add(m->velocity[i], -1, m->velocity_before[i]);
    change2 += dot(m->cg.p, m->cg.p, count);
    m->solved++;
    RHEO__VARIANT(make_viscous_operator)(m, m->cg.x, m->cg.Ap);
    invert_blocks(m);
    for (uint32_t i = 0; i < count; i++)
        m->cg.r[i] = rheo__point_add(m->velocity[i], -1, m->cg.Ap[i]);
    solve_mean(m);
    if (first)
        change2 += dot(m->cg.r, m->cg.r, count);
    const double r2_tolerated = tolerance * tolerance * change2,
                 r2_rounding = rounding * rounding * dot(m->velocity, m->velocity, count);
    if (!is_number(r2_tolerated))
        return RHEO__UNSOLVABLE;
    const int64_t iterations = iterate(m, r2_tolerated > r2_rounding ? r2_tolerated : r2_rounding);
    solve_mean(m);
    return iterations;
}
