/* What the thickening model asks of a definition beside the ranges of its parameters. */
#include "thickening/thickening.h"
#include "thickening/weights.h"
#include "world/model_thickening.h"

/* The length of a spring is no sum over its ends, so it does not follow from sums of velocities. */
static rheo_result check_lengths(const rheo_world_def *def, rheo_error *error)
{
    if (def->scheme != RHEO_SCHEME_SUMMED)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "history.of length needs scheme summed");
    if (def->history.kind != RHEO_HISTORY_WINDOW)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "history.of length needs history.kind window, which remembers positions; modes have only sums");
    if (def->history.hardening != RHEO_HARDENING_ACTIVE)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "history.of length needs history.hardening active");
    return RHEO_OK;
}

/* A pair has only one image in range, and a particle images across only one border of an axis. */
static rheo_result check_space(const rheo_world_def *def, rheo_error *error)
{
    const double least = 2.5 * def->fluid.support; /* twice the support and two margins (thickening/neighbours.c) */
    uint32_t axes = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double period = def->space.period[axis];
        if (period > 0 && !(period >= least))
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "space.period is %g along %c; it must be 0 (open) or at least %g, 2.5 times fluid.support", period,
                "xyz"[axis], least);
        axes += period > 0;
        for (uint32_t w = 0; w < def->walls.count && period > 0; w++)
            if (def->walls.plane[w].normal[axis] != 0)
                return rheo__fail(
                    error, RHEO_ERROR_ARGUMENT,
                    "walls: wall %u crosses the axis %c, along which space.period makes space periodic; "
                    "its normal must have no component along this axis",
                    w, "xyz"[axis]);
    }
    if (!axes)
        return RHEO_OK;
    const char *what = def->scheme != RHEO_SCHEME_SUMMED ? "scheme sequential"
                       : def->ball.radius > 0            ? "a ball"
                       : def->vibrators.count > 0        ? "vibrators"
                       : rheo__history_of_lengths(def)   ? "history.of length"
                                                         : NULL;
    if (what)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "space.period makes space periodic, which %s does not support; leave out one of them",
                          what);
    return RHEO_OK;
}

bool rheo__thickening_has_plates(const rheo_world_def *def)
{
    return def->plates.lower != 0 || def->plates.upper != 0;
}

static rheo_result check_plates(const rheo_world_def *def, rheo_error *error)
{
    const double *period = def->space.period;
    if (!rheo__thickening_has_plates(def))
        return RHEO_OK;
    if (!(def->plates.lower < def->plates.upper))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "plates.lower is %g and plates.upper is %g; the upper plate must be above the lower one, or "
            "both heights must be 0 (no plates)",
            def->plates.lower, def->plates.upper);
    if (!(period[0] > 0 && period[2] > 0) || period[1] > 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "space.period is [%g, %g, %g]; with plates it must be above 0 along x and z, and 0 along y",
                          period[0], period[1], period[2]);
    return RHEO_OK;
}

/* Only a ring has the velocities that any weights can be applied to. */
rheo_result rheo__thickening_check(const rheo_world_def *def, rheo_error *error)
{
    if (rheo__history_of_lengths(def))
        RHEO__TRY(check_lengths(def, error));
    RHEO__TRY(check_space(def, error));
    RHEO__TRY(check_plates(def, error));
    if (!def->history.curve_count)
        return RHEO_OK;
    if (def->history.kind != RHEO_HISTORY_WINDOW)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "history.curve needs history.kind window, which sums its weights as they are");
    return rheo__curve_check(def->history.curve, def->history.curve_count, def->step, error);
}
