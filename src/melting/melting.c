/* What the stages of the melting model share: constants, memory, rheology (melting/melting.h). */
#include "melting/melting.h"

#include <string.h>

#include "core/math.h"

/* What the kernel is divided by, in h^3: 120 pi makes its integral 1; the paper prints 359 pi/3. */
static double kernel_constant(const rheo_world_def *def)
{
    const double pi = 3.14159265358979323846;
    return def->paper.kernel ? 3 / (359 * pi) : 1 / (120 * pi);
}

static void configure_walls(rheo__melting *m, const rheo_world_def *def)
{
    m->walls = def->walls.count;
    for (uint32_t w = 0; w < m->walls; w++) {
        const double *n = def->walls.plane[w].normal, *point = def->walls.plane[w].point;
        const double scale = 1 / __builtin_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double offset = 0;
        for (int axis = 0; axis < 3; axis++) {
            m->wall_normal[w][axis] = (rheo_real)(n[axis] * scale);
            offset += n[axis] * scale * point[axis];
        }
        m->wall_offset[w] = (rheo_real)offset;
    }
}

void rheo__melting_configure(rheo__melting *m, const rheo_world_def *def)
{
    const double spacing = def->fluid.spacing, h = rheo__melting_smoothing_length(def);
    m->def = def;
    m->smoothing_length = h;
    m->support = 3 * h;
    m->mass = def->melting.rest_density * spacing * spacing * spacing;
    m->kernel_scale = (rheo_real)(kernel_constant(def) / (h * h * h));
    for (int axis = 0; axis < 3; axis++)
        m->gravity[axis] = (rheo_real)def->gravity[axis];
    configure_walls(m, def);
    if (m->walls)
        rheo__wall_tables(m);
}

/* ---- Memory ---- */

bool rheo__melting_reserve(rheo__melting *m, uint32_t particles)
{
    /* Idle rows of the last block, and the one more particle of rheo__gather(). */
    if (m->slab && (size_t)particles + RHEO__BLOCK_ROWS <= m->particle_capacity)
        return true;
    rheo__point **points[] = {&m->position, &m->velocity, &m->velocity_before, &m->acceleration,
                              &m->viscous,  &m->residual, &m->direction,       &m->image,
                              &m->solution, &m->drift,    &m->velocity_last};
    rheo_real **reals[] = {&m->shear_rate,  &m->viscosity,   &m->temperature, &m->density_rate, &m->heat_rate,
                           &m->diagonal[0], &m->diagonal[1], &m->diagonal[2], &m->diagonal[3],  &m->diagonal[4],
                           &m->diagonal[5], &m->gradient[0], &m->gradient[1], &m->gradient[2],  &m->gradient[3],
                           &m->gradient[4], &m->gradient[5]};
    enum { POINTS = sizeof points / sizeof *points, REALS = sizeof reals / sizeof *reals };
    const size_t blocks = ((size_t)particles + particles / 4) / RHEO__BLOCK_ROWS + 2,
                 wanted = blocks * RHEO__BLOCK_ROWS;
    rheo_real *slab = rheo__allocate(&m->allocator, wanted, (4 * POINTS + REALS) * sizeof *slab);
    if (!slab)
        return false;
    rheo__release(&m->allocator, m->slab);
    m->slab = slab;
    m->particle_capacity = wanted;
    for (int i = 0; i < POINTS; i++, slab += 4 * wanted)
        *points[i] = (rheo__point *)(void *)slab;
    for (int i = 0; i < REALS; i++, slab += wanted)
        *reals[i] = slab;
    return true;
}

void rheo__melting_release(rheo__melting *m)
{
    rheo__rows *r = &m->rows;
    void *arrays[] = {m->slab, m->contact, r->start,  r->partner, r->x,      r->y,
                      r->z,    r->slope,   r->weight, r->bond_x,  r->bond_y, r->bond_z};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rheo__release(&m->allocator, arrays[i]);
    rheo__neighbours_release(&m->list, &m->allocator);
    rheo__pairs_release(&m->pairs, &m->allocator);
    memset(m, 0, sizeof *m);
}

/* ---- Rheology ---- */

double rheo__melting_jump(const rheo_world_def *def, double temperature)
{
    const double low = def->melting.temperature_min, high = def->melting.temperature_max;
    const double cold = def->melting.jump_number_max, hot = def->melting.jump_number_min;
    double u = (temperature - low) / (high - low);
    if (def->paper.jump) {
        const double jump = (1 - u) * cold - u * hot;
        return jump > 0 ? jump : 0;
    }
    u = u < 0 ? 0 : u > 1 ? 1 : u;
    return (1 - u) * cold + u * hot;
}

double rheo__melting_viscosity(const rheo_world_def *def, double jump, double shear_rate)
{
    if (def->melting.rheology == RHEO_RHEOLOGY_NEWTONIAN)
        return def->melting.viscosity;
    const double least = 1e-14, d = shear_rate * def->melting.time_scale, held = d > least ? d : least;
    return def->melting.viscosity * -rheo__expm1(-(jump + 1) * held) *
           (rheo__pow(held, def->melting.power_law_index - 1) + 1 / held);
}
