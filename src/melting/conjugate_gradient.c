/*
 * Conjugate gradients for A x = v*, A = 1 + dt K (viscous_operator.h), preconditioned by the inverse of the 3 x 3
 * blocks of the diagonal of A. r = v* - A x is the residual, e = A^-1 r the error, z = M^-1 r, p the direction. Dot
 * products have one fixed order of additions.
 *
 * The measure of an error is its energy e A e: that of its motion, |e|^2, and what viscosity would take from it in a
 * substep. In solids |r|^2 is a thousand times the energy. Each iteration lowers the energy by alpha r z [Hestenes and
 * Stiefel 1952, Theorem 6:1].
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

/* Energy of the rounding of velocities, from the blocks of the diagonal. */
static double rounding_energy(const rheo__melting *m)
{
    rheo_real *const *d = m->cg.block;
    const double rounding = RHEO_DOUBLE ? 0x1p-53 : 0x1p-24;
    double sum = 0;
    for (uint32_t i = 0; i < m->pairs.rows; i++) {
        const rheo__point *v = &m->velocity[i];
        sum += (double)(rheo__length2(v->x, v->y, v->z) * (d[0][i] + d[1][i] + d[2][i]));
    }
    return rounding * rounding / 3 * sum;
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

/*
 * How much of the energy may be left after an iteration, in units of its decrease in that iteration. The decreases of a
 * solid that bends fall slowly (docs/melting.md, 5).
 */
static const double LEFT = 100;

/*
 * Iterates from x and r until the energy of the error is at most `least`, or tolerance^2 times the square of the
 * velocity change: that by forces and prediction, and that by the iterations.
 */
static int64_t iterate(rheo__melting *m, double change2, double least)
{
    rheo__point *x = m->cg.x, *r = m->cg.r, *z = m->cg.z, *p = m->cg.p, *Ap = m->cg.Ap;
    const uint32_t count = m->pairs.rows;
    const double tolerance2 = m->def->melting.tolerance * m->def->melting.tolerance;
    int64_t iterations = 0;
    /* |r|^2 is at least e A e, since no eigenvalue of A is below 1; in liquids it is hardly more. */
    double rz_previous = 0, energy = dot(r, r, count);
    while (!(energy <= least || energy <= tolerance2 * change2) &&
           iterations < (int64_t)m->def->melting.max_iterations) {
        const double rz = precondition(m);
        if (iterations == 0) {
            memcpy(p, z, (size_t)count * sizeof *p);
            p[count] = (rheo__point){0, 0, 0, 0};
        } else {
            combine(p, z, (rheo_real)(rz / rz_previous), p, count);
        }
        RHEO__VARIANT(apply_viscous_operator)(m, p, Ap, false);
        const double pAp = dot(p, Ap, count);
        if (!is_number(energy) || !is_number(rz) || !is_number(pAp))
            return RHEO__UNSOLVABLE;
        if (!(pAp > 0)) /* the squares of the residual underflow */
            break;
        const rheo_real alpha = (rheo_real)(rz / pAp);
        combine(x, x, alpha, p, count);
        combine(r, r, -alpha, Ap, count);
        const double taken = (double)alpha * rz, r2 = dot(r, r, count);
        energy = r2 < LEFT * taken ? r2 : LEFT * taken;
        change2 += taken;
        rz_previous = rz;
        iterations++;
    }
    return iterations;
}

/*
 * Initial x: velocities at the start of the substep, plus their change at the predicted acceleration. Returns the square
 * of that change.
 */
static double begin(const rheo__state *s, rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    for (uint32_t i = 0; i < count; i++) {
        const rheo_real *a = s->predicted_acceleration + 3 * (size_t)m->pairs.id_of[i];
        const rheo__point now = m->velocity_before[i];
        m->cg.p[i] = (rheo__point){m->substep * a[0], m->substep * a[1], m->substep * a[2], 0};
        m->cg.x[i] = rheo__point_add((rheo__point){now.x, now.y, now.z, 0}, 1, m->cg.p[i]);
    }
    m->cg.x[count] = (rheo__point){0, 0, 0, 0};
    return dot(m->cg.p, m->cg.p, count);
}

/*
 * Predicts the acceleration of the next substep: that of this one, plus half the error of its prediction. The whole error
 * would amplify noise.
 */
static void predict(rheo__state *s, const rheo__melting *m)
{
    const rheo_real per_substep = 1 / m->substep, half = RHEO__R(0.5);
    for (uint32_t i = 0; i < m->pairs.rows; i++) {
        rheo_real *predicted = s->predicted_acceleration + 3 * (size_t)m->pairs.id_of[i];
        const rheo__point x = m->cg.x[i], from = m->velocity_before[i];
        const rheo_real change[3] = {x.x - from.x, x.y - from.y, x.z - from.z};
        for (int axis = 0; axis < 3; axis++) {
            const rheo_real acceleration = per_substep * change[axis];
            predicted[axis] = acceleration + half * (acceleration - predicted[axis]);
        }
    }
}

/*
 * The tolerance is relative to velocity changes, hence Galilean invariant. Relative to velocities, fluid in fast fall
 * would no longer feel gravity. The rounding of velocities sets a lower limit.
 */
int64_t RHEO__VARIANT(conjugate_gradient)(rheo__state *s, rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    double change2 = begin(s, m);
    for (uint32_t i = 0; i < count; i++)
        m->cg.p[i] = rheo__point_add(m->velocity[i], -1, m->velocity_before[i]);
    change2 += dot(m->cg.p, m->cg.p, count);
    RHEO__VARIANT(make_viscous_operator)(m, m->cg.x, m->cg.Ap);
    const double least = rounding_energy(m);
    invert_blocks(m);
    for (uint32_t i = 0; i < count; i++)
        m->cg.r[i] = rheo__point_add(m->velocity[i], -1, m->cg.Ap[i]);
    solve_mean(m);
    if (!is_number(change2))
        return RHEO__UNSOLVABLE;
    const int64_t iterations = iterate(m, change2, least);
    if (iterations == RHEO__UNSOLVABLE)
        return RHEO__UNSOLVABLE;
    solve_mean(m);
    predict(s, m);
    return iterations;
}
