/* A ball: lattice points no farther from the centre than the radius; the centre is a lattice point. */
#include "core/strict.h"
#include "scenes/shape.h"

static const rheo_shape_member members[] = {
    RHEO__MEMBER("centre", centre, RHEO_SHAPE_VECTOR, "L", "centre", RHEO__FINITE, .required = true),
    RHEO__MEMBER("radius", radius, RHEO_SHAPE_NUMBER, "L", "radius", .maximum = 1e30, .required = true),
    RHEO__COMMON_MEMBERS,
};

static void measure(const rheo_fill *fill, const void *data, double size[3])
{
    (void)data;
    size[0] = size[1] = size[2] = fill->radius;
}

static rheo__lattice lattice(const rheo__solid *solid, const double size[3])
{
    rheo__lattice l;
    for (int axis = 0; axis < 3; axis++) {
        l.high[axis] = (int64_t)size[axis] + 1; /* one point more than fits, so that rounding loses none */
        l.low[axis] = -l.high[axis];
        l.origin[axis] = solid->fill->centre[axis];
    }
    return l;
}

static rheo_result run_rows(const rheo__solid *solid, const rheo__lattice *l, rheo__run *run, void *user,
                            rheo_error *error)
{
    (void)error;
    const double radius = solid->fill->radius / solid->spacing;
    /* Truncation loses no point, because x^2 + y^2 + z^2 is an integer. */
    const int64_t radius2 = (int64_t)(radius * (1 + 1e-9) * (radius * (1 + 1e-9)));
    for (int64_t z = l->low[2]; z <= l->high[2]; z++)
        for (int64_t y = l->low[1]; y <= l->high[1]; y++) {
            const int64_t left = radius2 - y * y - z * z;
            if (left < 0)
                continue;
            int64_t x = (int64_t)__builtin_sqrt((double)left);
            x += (x + 1) * (x + 1) <= left;
            x -= x * x > left;
            if (!run(user, -x, x + 1, y, z))
                return RHEO_OK;
        }
    return RHEO_OK;
}

const rheo__shape rheo__shape_sphere = {
    .row = RHEO__ROW("sphere", "a ball", members),
    .max_points = 1e9,
    .measure = measure,
    .lattice = lattice,
    .run = run_rows,
};
