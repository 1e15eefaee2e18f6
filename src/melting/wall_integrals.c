/*
 * Walls as half spaces full of fluid, docs/melting.md (8). Integrals replace the sums over fixed particles behind a
 * plane, so a plane needs no particles, has no rim, and costs nothing away from the fluid. With d the distance of a
 * particle from the plane, z the depth of a point of the wall below the particle, lengths in h, and the substitution
 * rho drho = q dq in each plane parallel to the wall:
 *
 *     plane(z) = 2 pi k int_z^3 w(q) q dq,   slope(z) = -d plane/dz = 2 pi k z w(z)
 *
 * Pressure and density terms must balance sums over layers of particles, so they are summed over layers too. A
 * lattice of particles that ends half a spacing s from the plane continues behind it at z = d + s/2, d + 3 s/2, ...
 * (With integrals over the half space, pressure is 4.5 % too weak at the first layer of fluid and too strong at the
 * second; the pressures of a column at rest were then wrong by 4 % of rho g H.)
 *
 *     weight = s sum plane(z)      gradient = s sum slope(z)      moment = s sum z slope(z)
 *
 * Viscous terms are integrated over the half space, since with layers a flow in a channel is up to 8 % too fast. b is
 * the viscous coefficient of viscous_operator.c without masses and viscosities:
 *
 *     shear    = int_d^3 z slope(z) dz                           = d plane(d) + int_d^3 plane dz
 *     b(q)     = -10 k w'(q)/(q (q^2 + 0.01))         normal = int_d^3 z^3 2 pi int_z^3 b q dq dz
 *                                                     along  = int_d^3 z/2 2 pi int_z^3 b (q^2 - z^2) q dq dz
 *
 * The velocity in the wall is mirrored: it is linear in z, through that of the particle and that of the plane. So the
 * difference to the particle grows as z/d. The integrals contain z; their users divide by d.
 */
#include <assert.h>

#include "core/quintic.h"
#include "melting/melting.h"

enum { FINE = 8, POINTS = (RHEO__WALL_NODES - 1) * FINE + 1 };

/* The integrands of a layer: w q, b q, b q^3, without 2 pi k. */
static void integrands(double q, double value[3])
{
    value[0] = rheo__quintic(q) * q;
    value[1] = -10 * rheo__quintic_slope(q) / (q * q + 0.01) * q;
    value[2] = value[1] * q * q;
}

/* Integrands of the outer integrals at z. */
static void layer_integrands(double z, const double inner[3], double value[3])
{
    value[0] = inner[0];
    value[1] = z * z * z * inner[1];
    value[2] = z / 2 * (inner[2] - z * z * inner[1]);
}

/* plane(z) and slope(z) without 2 pi k: int_0^u t^5 (a - t) dt = u^6 (a/6 - u/7) for each term of w. */
static void plane_of_wall(double z, double *plane, double *slope)
{
    static const double FACTOR[] = {15, -6, 1};
    double value[3];
    integrands(z, value);
    *slope = value[0];
    *plane = 0;
    for (int a = 1; a <= 3; a++) {
        const double u = a - z;
        *plane += u > 0 ? FACTOR[a - 1] * rheo__fifth_power_of_positive(u) * u * (a / 6.0 - u / 7) : 0;
    }
}

/* At most 200 layers are summed: closer layers change nothing. */
static void sum_layers(rheo__wall_integrals *integral, double d, double spacing, double two_pi_k, double h)
{
    spacing = spacing > 1.0 / 64 ? spacing : 1.0 / 64;
    double weight = 0, gradient = 0, moment = 0;
    for (double z = d + spacing / 2; z < 3; z += spacing) {
        double plane, slope;
        plane_of_wall(z, &plane, &slope);
        weight += plane;
        gradient += slope;
        moment += z * slope;
    }
    integral->weight = (rheo_real)(two_pi_k * spacing * weight);
    integral->gradient = (rheo_real)(two_pi_k * spacing * gradient / h);
    integral->moment = (rheo_real)(two_pi_k * spacing * moment);
}

void rheo__wall_tables(rheo__melting *m)
{
    const double h = m->smoothing_length, k = (double)m->kernel_scale * h * h * h,
                 spacing = m->def->fluid.spacing / h;
    if (m->wall_table_for == h && m->wall_table_scale == k && m->wall_table_spacing == spacing)
        return;
    const double cell = 3.0 / (POINTS - 1), two_pi_k = 6.283185307179586 * k;
    double inner[3] = {0, 0, 0}, outer[3] = {0, 0, 0}, low[3], middle[3], high[3];
    /* Simpson's rule from the rim of the support inwards, two cells at a time, in each layer and over layers. */
    double layer[3][3]; /* outer integrands at both ends of the two cells and in the middle */
    integrands(3, high);
    layer_integrands(3, inner, layer[2]);
    for (int point = POINTS - 1; point >= 0; point--) {
        const double z = point * cell;
        if (point < POINTS - 1) {
            integrands(z, low);
            integrands(z + cell / 2, middle);
            for (int i = 0; i < 3; i++) {
                inner[i] += cell / 6 * (low[i] + 4 * middle[i] + high[i]);
                high[i] = low[i];
            }
            layer_integrands(z, inner, layer[point % 2 ? 1 : 0]);
            for (int i = 0; i < 3 && point % 2 == 0; i++) {
                outer[i] += cell / 3 * (layer[0][i] + 4 * layer[1][i] + layer[2][i]);
                layer[2][i] = layer[0][i];
            }
        }
        if (point % FINE == 0) {
            rheo__wall_integrals *integral = &m->wall_table[point / FINE];
            sum_layers(integral, z, spacing, two_pi_k, h);
            integral->shear = (rheo_real)(two_pi_k * (z * inner[0] + outer[0]));
            integral->along = (rheo_real)(two_pi_k * outer[2] / h);
            integral->normal = (rheo_real)(two_pi_k * outer[1] / h);
        }
    }
    m->wall_table_for = h;
    m->wall_table_scale = k;
    m->wall_table_spacing = spacing;
}

rheo__wall_integrals rheo__wall_look_up(const rheo__melting *m, rheo_real distance)
{
    const rheo_real position =
        rheo__max(distance, 0) * (rheo_real)((RHEO__WALL_NODES - 1) / (3 * m->smoothing_length));
    uint32_t node = (uint32_t)rheo__min(position, RHEO__WALL_NODES - 2);
    assert(node + 1 < RHEO__WALL_NODES);
    const rheo_real share = position - (rheo_real)node;
    const rheo__wall_integrals *a = &m->wall_table[node], *b = a + 1;
    return (rheo__wall_integrals){.weight = a->weight + share * (b->weight - a->weight),
                                  .gradient = a->gradient + share * (b->gradient - a->gradient),
                                  .moment = a->moment + share * (b->moment - a->moment),
                                  .shear = a->shear + share * (b->shear - a->shear),
                                  .along = a->along + share * (b->along - a->along),
                                  .normal = a->normal + share * (b->normal - a->normal)};
}
