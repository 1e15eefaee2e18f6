/*
 * A box with sides along the axes: round(size / spacing) particles along each axis, the first half a spacing inside.
 */
#include "core/error.h"
#include "core/strict.h"
#include "scenes/shape.h"

static const rheo_shape_member members[] = {
    RHEO__MEMBER("min", min, RHEO_SHAPE_VECTOR, "L", "lowest corner", RHEO__FINITE, .required = true),
    RHEO__MEMBER("max", max, RHEO_SHAPE_VECTOR, "L", "highest corner", RHEO__FINITE, .required = true),
    RHEO__COMMON_MEMBERS,
};

static rheo_result check(const rheo_fill *fill, rheo_error *error)
{
    for (int axis = 0; axis < 3; axis++)
        if (fill->min[axis] > fill->max[axis])
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "no number of \"min\" may be above that of \"max\"; %g and %g along %c are",
                              fill->min[axis], fill->max[axis], "xyz"[axis]);
    return RHEO_OK;
}

static void measure(const rheo_fill *fill, const void *data, double size[3])
{
    (void)data;
    for (int axis = 0; axis < 3; axis++)
        size[axis] = fill->max[axis] - fill->min[axis];
}

static rheo__lattice lattice(const rheo__solid *solid, const double size[3])
{
    rheo__lattice l = {.low = {0, 0, 0}};
    for (int axis = 0; axis < 3; axis++) {
        l.high[axis] = rheo__round_half_up(size[axis]) - 1;
        l.origin[axis] = solid->fill->min[axis] + solid->spacing / 2;
    }
    return l;
}

const rheo__shape rheo__shape_block = {
    .row = RHEO__ROW("block", "a box with sides along the axes", members),
    .max_points = 1e9,
    .check = check,
    .measure = measure,
    .lattice = lattice,
};
