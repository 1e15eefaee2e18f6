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

/* An array with a point or a number for each particle, and whether the world has it. */
typedef struct points {
    rheo__point **at;
    bool needed;
} points;
typedef struct reals {
    rheo_real **at;
    bool needed;
} reals;

enum { POINTS = 14, REALS = 20 };

static void list_arrays(rheo__melting *m, points point[POINTS], reals real[REALS])
{
    const bool flow = m->flow, viscous = m->viscous, summed = m->def->melting.density == RHEO_DENSITY_SUMMATION;
    const points all_points[POINTS] = {
        {&m->velocity, true},     {&m->searched_at, true},    {&m->velocity_before, flow}, {&m->drift, flow},
        {&m->acceleration, flow}, {&m->heat_points, m->heat}, {&m->stress[0], viscous},    {&m->stress[1], viscous},
        {&m->stress[2], viscous}, {&m->cg.x, viscous},        {&m->cg.r, viscous},         {&m->cg.z, viscous},
        {&m->cg.p, viscous},      {&m->cg.Ap, viscous}};
    const reals all_reals[REALS] = {{&m->margin, true},
                                    {&m->temperature, m->warm},
                                    {&m->heat_rate, m->heat},
                                    {&m->density_rate, flow},
                                    {&m->density, flow && summed},
                                    {&m->shear_rate, viscous},
                                    {&m->viscous_factor, viscous},
                                    {&m->viscosity, viscous},
                                    {&m->inverse_moment[0], viscous},
                                    {&m->inverse_moment[1], viscous},
                                    {&m->inverse_moment[2], viscous},
                                    {&m->inverse_moment[3], viscous},
                                    {&m->inverse_moment[4], viscous},
                                    {&m->inverse_moment[5], viscous},
                                    {&m->cg.block[0], viscous},
                                    {&m->cg.block[1], viscous},
                                    {&m->cg.block[2], viscous},
                                    {&m->cg.block[3], viscous},
                                    {&m->cg.block[4], viscous},
                                    {&m->cg.block[5], viscous}};
    memcpy(point, all_points, sizeof all_points);
    memcpy(real, all_reals, sizeof all_reals);
}

bool rheo__melting_reserve(rheo__melting *m, uint32_t particles)
{
    /* Room for the idle rows of the last block and the idle point of rheo__gather(). */
    if (m->workspace && (size_t)particles + RHEO__BLOCK_ROWS <= m->particle_capacity)
        return true;
    points point[POINTS];
    reals real[REALS];
    size_t numbers = 0;
    list_arrays(m, point, real);
    for (int i = 0; i < POINTS; i++)
        numbers += point[i].needed ? 4 : 0;
    for (int i = 0; i < REALS; i++)
        numbers += real[i].needed;
    const size_t blocks = ((size_t)particles + particles / 4) / RHEO__BLOCK_ROWS + 2,
                 wanted = blocks * RHEO__BLOCK_ROWS, lists = m->viscous ? 4 : 3;
    rheo_real *workspace = rheo__allocate(&m->allocator, wanted, sizeof *m->point + numbers * sizeof *workspace);
    uint32_t *ranks = workspace ? rheo__allocate(&m->allocator, wanted, lists * sizeof *ranks) : NULL;
    if (!ranks) {
        rheo__release(&m->allocator, workspace);
        return false;
    }
    rheo__release(&m->allocator, m->workspace);
    rheo__release(&m->allocator, m->rows.row_of);
    m->rows.row_of = ranks;
    m->rows.length = ranks + wanted;
    m->rows.start = ranks + 2 * wanted;
    m->bonds.start = m->viscous ? ranks + 3 * wanted : NULL;
    m->workspace = workspace;
    m->particle_capacity = wanted;
    m->point = (rheo__wide_point *)(void *)workspace;
    workspace += 8 * wanted;
    for (int i = 0; i < POINTS; i++)
        if (point[i].needed) {
            *point[i].at = (rheo__point *)(void *)workspace;
            workspace += 4 * wanted;
        }
    for (int i = 0; i < REALS; i++)
        if (real[i].needed) {
            *real[i].at = workspace;
            workspace += wanted;
        }
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
}
