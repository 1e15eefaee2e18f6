/* Constants and memory of the melting model (melting/melting.h). */
#include "melting/melting.h"

#include <string.h>

/* W = w(q) times this over h^3: 1/(120 pi) makes its integral 1; the paper prints 3/(359 pi). */
static double kernel_constant(const rheo_world_def *def)
{
    const double pi = 3.14159265358979323846;
    return def->paper.kernel ? 3 / (359 * pi) : 1 / (120 * pi);
}

void rheo__melting_configure(rheo__melting *m, const rheo_world_def *def, const rheo__planes *planes)
{
    const double h = rheo__melting_smoothing_length(def);
    m->def = def;
    m->planes = planes;
    m->smoothing_length = h;
    m->support = 3 * h;
    m->viscous_support = RHEO__VISCOUS_SUPPORT * h;
    m->kernel_scale = (rheo_real)(kernel_constant(def) / (h * h * h));
    if (planes->count)
        rheo__wall_tables(m);
}

bool rheo__melting_reserve(rheo__melting *m, uint32_t particles)
{
    /* Room for the idle rows of the last block and the idle point of rheo__gather(). */
    if (m->workspace && (size_t)particles + RHEO__BLOCK_ROWS <= m->particle_capacity)
        return true;
    rheo__point **points[] = {&m->velocity,     &m->velocity_before,
                              &m->drift,        &m->searched_at,
                              &m->acceleration, &m->heat_points,
                              &m->stress[0],    &m->stress[1],
                              &m->stress[2],    &m->cg.x,
                              &m->cg.r,         &m->cg.z,
                              &m->cg.p,         &m->cg.Ap};
    rheo_real **reals[] = {&m->temperature,       &m->margin,
                           &m->shear_rate,        &m->viscous_factor,
                           &m->viscosity,         &m->density,
                           &m->density_rate,      &m->heat_rate,
                           &m->inverse_moment[0], &m->inverse_moment[1],
                           &m->inverse_moment[2], &m->inverse_moment[3],
                           &m->inverse_moment[4], &m->inverse_moment[5],
                           &m->cg.block[0],       &m->cg.block[1],
                           &m->cg.block[2],       &m->cg.block[3],
                           &m->cg.block[4],       &m->cg.block[5]};
    enum { POINTS = sizeof points / sizeof *points, REALS = sizeof reals / sizeof *reals };
    const size_t blocks = ((size_t)particles + particles / 4) / RHEO__BLOCK_ROWS + 2,
                 wanted = blocks * RHEO__BLOCK_ROWS;
    rheo_real *workspace =
        rheo__allocate(&m->allocator, wanted, sizeof *m->point + (4 * POINTS + REALS) * sizeof *workspace);
    uint32_t *ranks = workspace ? rheo__allocate(&m->allocator, wanted, 4 * sizeof *ranks) : NULL;
    if (!ranks) {
        rheo__release(&m->allocator, workspace);
        return false;
    }
    rheo__release(&m->allocator, m->workspace);
    rheo__release(&m->allocator, m->rows.row_of);
    m->rows.row_of = ranks;
    m->rows.length = ranks + wanted;
    m->rows.start = ranks + 2 * wanted;
    m->bonds.start = ranks + 3 * wanted;
    m->workspace = workspace;
    m->particle_capacity = wanted;
    m->point = (rheo__wide_point *)(void *)workspace;
    workspace += 8 * wanted;
    for (int i = 0; i < POINTS; i++, workspace += 4 * wanted)
        *points[i] = (rheo__point *)(void *)workspace;
    for (int i = 0; i < REALS; i++, workspace += wanted)
        *reals[i] = workspace;
    return true;
}

void rheo__melting_release(rheo__melting *m)
{
    rheo__rows *r = &m->rows;
    void *arrays[] = {m->workspace, m->contact, r->row_of,  r->scratch, r->partner,
                      r->slope,     r->weight,  m->bonds.x, m->bonds.y, m->bonds.z};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rheo__release(&m->allocator, arrays[i]);
    rheo__neighbours_release(&m->list, &m->allocator);
    rheo__pairs_release(&m->pairs, &m->allocator);
    memset(m, 0, sizeof *m);
}
