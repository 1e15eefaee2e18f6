/* The lattice around a shape, and its points inside the shape. */
#include "core/strict.h"
#include "scenes/fill.h"

static const rheo__shape *shape_of(const rheo__filling *filling, uint32_t f)
{
    return rheo__shape_of(filling->scene->fill[f].kind);
}

bool rheo__fill_size(const rheo__filling *filling, uint32_t f, double spacing, double size[3])
{
    const rheo__shape *shape = shape_of(filling, f);
    const double limit = shape->max_points * spacing;
    bool fits = true;
    shape->measure(&filling->scene->fill[f], filling->data[f], size);
    for (int axis = 0; axis < 3; axis++) {
        fits = fits && size[axis] >= -limit && size[axis] <= limit;
        size[axis] /= spacing;
    }
    return fits;
}

static rheo__solid solid_of(const rheo__filling *filling, uint32_t f, double spacing)
{
    return (rheo__solid){&filling->scene->fill[f], filling->data[f], spacing};
}

bool rheo__fill_lattice(const rheo__filling *filling, uint32_t f, double spacing, rheo__lattice *lattice)
{
    const rheo__solid solid = solid_of(filling, f, spacing);
    double size[3];
    const bool fits = rheo__fill_size(filling, f, spacing, size);
    if (fits)
        *lattice = shape_of(filling, f)->lattice(&solid, size);
    return fits;
}

static void run_all(const rheo__lattice *l, rheo__run *run, void *user)
{
    for (int64_t z = l->low[2]; z <= l->high[2]; z++)
        for (int64_t y = l->low[1]; y <= l->high[1]; y++)
            if (l->high[0] >= l->low[0] && !run(user, l->low[0], l->high[0] + 1, y, z))
                return;
}

rheo_result rheo__fill_run(const rheo__filling *filling, uint32_t f, double spacing, const rheo__lattice *lattice,
                           rheo__run *run, void *user, rheo_error *error)
{
    const rheo__shape *shape = shape_of(filling, f);
    const rheo__solid solid = solid_of(filling, f, spacing);
    if (shape->run)
        return shape->run(&solid, lattice, run, user, error);
    run_all(lattice, run, user);
    return RHEO_OK;
}
