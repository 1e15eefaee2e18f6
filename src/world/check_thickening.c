/* What the thickening model asks of a definition beside the ranges of its parameters, and what it warns of. */
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "thickening/continuum.h"
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

/* Its square is not small enough to lose digits. */
#define LEAST_REST_DENSITY 0.001

/* What scheme positions does not have. */
static rheo_result check_positions(const rheo_world_def *def, rheo_error *error)
{
    if (def->particles.spring_count)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "scheme positions has no springs, but %u are given: use scheme summed",
                          def->particles.spring_count);
    if (def->history.hardening == RHEO_HARDENING_PASSIVE)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "scheme positions has no springs, so history.hardening must be active");
    if (!(def->fluid.rest_density >= LEAST_REST_DENSITY))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "scheme positions needs a fluid.rest_density of at least 0.001, which its constraint divides by");
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
    const char *what = def->scheme == RHEO_SCHEME_SEQUENTIAL  ? "scheme sequential"
                       : def->scheme == RHEO_SCHEME_POSITIONS ? "scheme positions"
                       : def->ball.radius > 0                 ? "a ball"
                       : def->obstacles.count > 0             ? "an obstacle"
                       : def->vibrators.count > 0             ? "vibrators"
                       : rheo__history_of_lengths(def)        ? "history.of length"
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

double rheo__thickening_plate_speed(const rheo_world_def *def)
{
    const double *v = def->plates.velocity, swing = 6.283185307179586 * def->plates.amplitude * def->plates.frequency,
                 along = (v[0] < 0 ? -v[0] : v[0]) + swing;
    return __builtin_sqrt(along * along + v[1] * v[1] + v[2] * v[2]);
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

/* The mass of a ball is a rheo_real, and the ball takes impulses divided by it. */
static rheo_result check_ball(const rheo_world_def *def, uint32_t index, rheo_error *error)
{
    const double least = 1e-36, most = 1e37, mass = rheo__ball_mass(def, index);
    const char *ball = RHEO__BALL_NAME(index);
    if (!(mass >= least && mass <= most))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s has the mass of %g particles; it must be from %g to %g: change %s.radius, "
                          "%s.density_ratio or fluid.number_density (0: that of fluid at rest, by fluid.support and "
                          "fluid.spacing)",
                          index ? ball : "the ball", mass, least, most, ball, ball);
    return RHEO_OK;
}

/* Only a ring has the velocities that any weights can be applied to. */
rheo_result rheo__thickening_check(const rheo_world_def *def, rheo_error *error)
{
    if (def->scheme == RHEO_SCHEME_POSITIONS)
        RHEO__TRY(check_positions(def, error));
    if (rheo__history_of_lengths(def))
        RHEO__TRY(check_lengths(def, error));
    RHEO__TRY(check_space(def, error));
    RHEO__TRY(check_plates(def, error));
    for (uint32_t i = 0; i < rheo_world_def_ball_count(def); i++)
        RHEO__TRY(check_ball(def, i, error));
    if (!def->history.curve_count)
        return RHEO_OK;
    if (def->history.kind != RHEO_HISTORY_WINDOW)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "history.curve needs history.kind window, which sums its weights as they are");
    return rheo__curve_check(def->history.curve, def->history.curve_count, def->step, error);
}

/* ---- Warnings ---- */

double rheo__thickening_most_substeps(const rheo_world_def *def)
{
    return def->scheme == RHEO_SCHEME_SUMMED ? (double)(def->substeps ? def->substeps : def->max_substeps) : 1;
}

static const char *substeps_name(const rheo_world_def *def)
{
    return def->substeps ? "substeps" : "max_substeps";
}

/* A curve gives all weights, and ends the window. What else would give them has no effect, unless it is the default. */
static void warn_of_curve(const rheo_world_def *def)
{
    const rheo_world_def usual = rheo_default_world_def();
    const uint32_t window = rheo_history_curve_window(def->history.curve, def->history.curve_count, def->step);
    const struct {
        bool given;
        const char *path;
    } parameters[] = {
        {def->history.order != usual.history.order, "history.order"},
        {def->history.weights != usual.history.weights, "history.weights"},
        {def->history.window_seconds > 0 ||
             (def->history.window != usual.history.window && def->history.window != window),
         "history.window"},
    };
    char text[256], paths[64] = "";
    for (size_t i = 0; i < sizeof parameters / sizeof *parameters; i++)
        if (parameters[i].given)
            snprintf(paths + strlen(paths), sizeof paths - strlen(paths), "%s%s", *paths ? ", " : "",
                     parameters[i].path);
    if (*paths) {
        snprintf(text, sizeof text,
                 "%s without effect: history.curve gives the weights and ends the window; leave out "
                 "either it or these",
                 paths);
        def->log.message(text, def->log.user);
    }
    bool zero = true;
    for (uint32_t i = 0; i < def->history.curve_count; i++)
        zero = zero && def->history.curve[i].weight == 0;
    if (zero)
        def->log.message("history.curve has the weight 0 at all ages, so the history has no effect; give it other "
                         "weights, or set history.stiffness to 0",
                         def->log.user);
}

/*
 * Rest lengths flow to L - tau alpha ((1 - gamma) L - r) or L + tau alpha (r - (1 + gamma) L). One that overshoots to the other
 * side comes back in the next substep, (1 - tau alpha (1 - gamma)) (1 - tau alpha (1 + gamma)) times as far away if that is much
 * more than gamma L. This exceeds 1 if tau alpha (1 - gamma^2) > 2. Scheme sequential has a measure for it, plasticity_number.
 */
static void warn_of_plasticity(const rheo_world_def *def)
{
    enum { MOST_SWING = 2 };
    const double substeps = rheo__thickening_substeps_at_rest(def), substep = def->step / substeps;
    double largest = 0, factor = 1;
    if (def->scheme != RHEO_SCHEME_SUMMED || !(rheo__largest_of_materials(def).springs.stiffness > 0))
        return;
    for (uint32_t a = 0; a <= def->materials.count; a++)
        for (uint32_t b = a; b <= def->materials.count; b++) { /* a spring has the means of its ends */
            const rheo_material m = rheo__material_of(def, a), n = rheo__material_of(def, b);
            const double rate = (m.springs.plasticity + n.springs.plasticity) / 2,
                         yield = (m.springs.yield_ratio + n.springs.yield_ratio) / 2;
            const double swing = rate * substep * (1 - yield * yield);
            factor = swing > largest ? 1 - yield * yield : factor;
            largest = swing > largest ? swing : largest;
        }
    if (!(largest > MOST_SWING))
        return;
    char text[320], value[32], limit[32], right[32], count[32];
    rheo__text_two(largest, MOST_SWING, value, limit);
    rheo__text_brief(1 / (substep * factor), 3, false, right);
    rheo__text_brief(substeps, 3, false, count);
    snprintf(
        text, sizeof text,
        "springs.plasticity substep (1 - springs.yield_ratio^2) is %s, more than %s, with the %s substep%s of a step at "
        "rest: rest lengths swing ever further; what helps: springs.plasticity=%s or less",
        value, limit, count, substeps > 1 ? "s" : "", right);
    def->log.message(text, def->log.user);
}

void rheo__thickening_warn(const rheo_world_def *def)
{
    rheo__thickening_warn_of_idle(def);
    warn_of_plasticity(def);
    if (def->history.curve_count)
        warn_of_curve(def);
    const double sum = rheo__stiffness_sum_at_rest(def, def->step / rheo__thickening_most_substeps(def));
    if (def->scheme != RHEO_SCHEME_SUMMED || !(sum > RHEO__STABLE_STIFFNESS_SUM))
        return;
    char text[200], number[32], path[64] = "springs.stiffness";
    rheo__text_brief(RHEO__STABLE_STIFFNESS_SUM / sum, 2, false, number);
    for (uint32_t k = 1; k <= def->materials.count; k++)
        if (rheo__material_of(def, k).springs.stiffness > def->springs.stiffness &&
            rheo__material_of(def, k).springs.stiffness == rheo__largest_of_materials(def).springs.stiffness)
            snprintf(path, sizeof path, "materials.%s.springs.stiffness", def->materials.list[k - 1].name);
    snprintf(text, sizeof text, "%s is too large for %s: springs at rest will have only about %s of it", path,
             substeps_name(def), number);
    def->log.message(text, def->log.user);
}
