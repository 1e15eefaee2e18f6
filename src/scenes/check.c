/* Examines the particles of a scene, as they are filled, for what is hardly meant. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "core/text.h"
#include "scenes/making.h"
#include "world/measure.h"

typedef struct inspection {
    const rheo__filling *filling;
    const rheo_world_def *def;
    rheo__warnings *warnings;
} inspection;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length_of(const double v[3])
{
    return sqrt(dot(v, v));
}

/* Ids of the particles of a shape: [first, end). */
static void range_of(const inspection *c, uint32_t shape, size_t *first, size_t *end)
{
    *first = shape ? (size_t)c->filling->end[shape - 1] : 0;
    *end = (size_t)c->filling->end[shape];
}

static void position_of(const inspection *c, size_t id, double x[3])
{
    for (size_t axis = 0; axis < 3; axis++)
        x[axis] = (double)c->def->particles.position[3 * id + axis];
}

double rheo__wall_distance(const rheo_wall *wall, const double x[3], double n[3])
{
    const double length = length_of(wall->normal),
                 from[3] = {x[0] - wall->point[0], x[1] - wall->point[1], x[2] - wall->point[2]};
    for (int axis = 0; axis < 3; axis++)
        n[axis] = wall->normal[axis] / length;
    return dot(from, n);
}

/* ---- Walls ---- */

/* How far jitter and rounding may move a particle at x, along a unit normal, from its point of the lattice. */
static double spread_at(const inspection *c, uint32_t shape, const double x[3], const double n[3])
{
    const double jitter = c->filling->scene->fill[shape].jitter, spacing = c->filling->spacing,
                 rounding = 1e-6 * (fabs(x[0]) + fabs(x[1]) + fabs(x[2]) + spacing);
    return jitter * spacing * (fabs(n[0]) + fabs(n[1]) + fabs(n[2])) + rounding;
}

/* Walls push back what jitter put behind them: the lattice itself is not behind the wall, or only just. */
static uint64_t count_behind(const inspection *c, const rheo_wall *wall, uint32_t shape, double *deepest)
{
    uint64_t count = 0;
    size_t first, end;
    *deepest = 0;
    range_of(c, shape, &first, &end);
    for (size_t i = first; i < end; i++) {
        double x[3], n[3];
        position_of(c, i, x);
        const double depth = -rheo__wall_distance(wall, x, n);
        if (!(depth > spread_at(c, shape, x, n)))
            continue;
        count++;
        *deepest = depth > *deepest ? depth : *deepest;
    }
    return count;
}

static void warn_behind(const inspection *c, uint32_t w, uint32_t shape, uint64_t count, double deepest)
{
    size_t first, end;
    const double *n = c->def->walls.plane[w].normal;
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_BEHIND_WALL);
    range_of(c, shape, &first, &end);
    warning.shape = (int32_t)shape;
    warning.wall = (int32_t)w;
    warning.count = count;
    warning.value = deepest;
    warning.limit = 0;
    char depth[32], away[32];
    rheo__warn(
        c->warnings, warning,
        "%llu of the %zu particles of shape %u %s behind wall %u, up to %s deep: the fluid belongs on the side "
        "that its normal [%g, %g, %g] points to; move the shape there by %s, or the wall",
        (unsigned long long)count, end - first, shape, count == 1 ? "is" : "are", w,
        rheo__text_brief(deepest, 3, false, depth), n[0], n[1], n[2],
        rheo__text_brief(deepest + c->filling->spacing / 2, 3, false, away));
}

static void check_wall(const inspection *c, uint32_t w)
{
    const rheo_wall *wall = &c->def->walls.plane[w];
    const uint32_t shapes = c->filling->scene->fill_count;
    uint64_t behind[RHEO_MAX_FILLS], all = 0;
    double depth[RHEO_MAX_FILLS], deepest = 0;
    for (uint32_t s = 0; s < shapes; s++) {
        behind[s] = count_behind(c, wall, s, &depth[s]);
        all += behind[s];
        deepest = depth[s] > deepest ? depth[s] : deepest;
    }
    if (all == 0)
        return;
    if (all == c->def->particles.count) {
        const double *n = wall->normal;
        rheo_warning warning = rheo__warning_of(RHEO_WARNING_TURNED_NORMAL);
        warning.refused = true;
        warning.wall = (int32_t)w;
        warning.count = all;
        warning.value = deepest;
        warning.limit = 0;
        rheo__warn(c->warnings, warning,
                   "all %llu particle%s behind wall %u: the fluid belongs on the side that its normal [%g, %g, %g] "
                   "points to; turn it round, [%g, %g, %g], or move the shapes to the other side",
                   (unsigned long long)all, all == 1 ? " is" : "s are", w, n[0], n[1], n[2], 0 - n[0], 0 - n[1],
                   0 - n[2]);
        return;
    }
    for (uint32_t s = 0; s < shapes; s++)
        if (behind[s])
            warn_behind(c, w, s, behind[s], depth[s]);
}

/* Particles move in every world but frozen ones. */
static bool moves(const rheo_world_def *def)
{
    const uint32_t possible = rheo__model(def->model)->possible_features;
    return !(possible & RHEO__FEATURE_FLOW) || (rheo__world_features(def) & RHEO__FEATURE_FLOW);
}

/* A plane that faces gravity anywhere stops a fall, since it is unbounded. */
static void check_floor(const inspection *c)
{
    const rheo_world_def *def = c->def;
    const double *g = def->gravity;
    const bool plates = rheo__world_features(def) & RHEO__FEATURE_PLATES; /* fluid sticks to them */
    if (!(length_of(g) > 0) || !moves(def) || plates ||
        (def->particles.count == 0 && def->emitters.count == 0 && !(def->ball.radius > 0)))
        return;
    for (uint32_t w = 0; w < def->walls.count; w++)
        if (dot(def->walls.plane[w].normal, g) < 0)
            return;
    for (uint32_t k = 0; k < def->obstacles.count; k++)
        if (def->obstacles.list[k].inside)
            return;
    rheo__warn(
        c->warnings, rheo__warning_of(RHEO_WARNING_NO_FLOOR),
        "everything falls for ever: no wall faces gravity [%g, %g, %g]; add a wall below the fluid whose normal "
        "points against gravity, or set gravity to [0, 0, 0]",
        g[0], g[1], g[2]);
}

/* ---- Places ---- */

/* Distance between the rheo_reals at a number above 0. */
static double quantum_at(double x)
{
    double power = 1;
    while (power > x)
        power /= 2;
    while (2 * power <= x)
        power *= 2;
    return power * (RHEO_DOUBLE ? 0x1p-52 : 0x1p-23);
}

/*
 * Positions are rounded to the quantum of the largest one. Forces feel it as noise; and velocities of scheme sequential are differences
 * of positions, so that gravity is lost where it moves a particle by less than a quantum in a step.
 */
static void check_places(const inspection *c)
{
    const rheo_world_def *def = c->def;
    const double coarse = 0.002 * def->fluid.spacing, fall = length_of(def->gravity) * def->step * def->step;
    double furthest = 0;
    for (size_t i = 0; i < 3 * (size_t)def->particles.count; i++) {
        const double x = (double)def->particles.position[i];
        furthest = x > furthest ? x : -x > furthest ? -x : furthest;
    }
    if (!(furthest > 0) || !moves(def))
        return;
    char place[32], quantum[32], way[32];
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_FAR);
    warning.value = quantum_at(furthest);
    rheo__text_brief(furthest, 2, false, place);
    rheo__text_brief(warning.value, 2, false, quantum);
    const char *const other = RHEO_DOUBLE ? "" : ", or use the double build";
    if (warning.value > coarse) {
        warning.limit = coarse;
        rheo__warn(
            c->warnings, warning,
            "particles are %s from the origin, where positions are multiples of %s, which shakes the fluid; move the "
            "scene to the origin%s",
            place, quantum, other);
    }
    if (def->model == RHEO_MODEL_THICKENING && def->scheme == RHEO_SCHEME_SEQUENTIAL && fall > 0 &&
        fall < warning.value) {
        warning.limit = fall;
        rheo__warn(c->warnings, warning,
                   "scheme sequential loses gravity: it moves a particle by %s in a step, and positions up to %s are "
                   "multiples of %s; take scheme summed or a longer step%s",
                   rheo__text_brief(fall, 2, false, way), place, quantum, other);
    }
}

/* ---- Parameters and speeds ---- */

/* Takes a message of a model as a warning. */
static void take_message(const char *text, void *user)
{
    rheo__warn(user, rheo__warning_of(RHEO_WARNING_PARAMETER), "%s", text);
}

static void check_parameters(const inspection *c)
{
    const rheo_scene *scene = c->filling->scene;
    const rheo__measures *measures = rheo__measures_of(c->def);
    rheo__known_speeds speeds = {.ball = rheo__arrival_speed(c->filling, c->def)};
    for (uint32_t s = 0; s < scene->fill_count; s++) {
        const double speed = length_of(scene->fill[s].velocity);
        speeds.fluid = speed > speeds.fluid ? speed : speeds.fluid;
    }
    for (uint32_t k = 0; k < c->def->emitters.count; k++)
        if (c->def->emitters.list[k].speed > speeds.fluid)
            speeds.fluid = c->def->emitters.list[k].speed;
    for (uint32_t row = 0; row < measures->count; row++) {
        rheo__condition condition;
        char text[sizeof((rheo_warning *)NULL)->text];
        if (!rheo__condition_of_scene(scene, c->def, speeds, row, &condition))
            continue;
        rheo_warning warning = rheo__warning_of(RHEO_WARNING_PARAMETER);
        warning.value = condition.value;
        warning.limit = condition.limit;
        rheo__condition_tell(&condition, text, sizeof text);
        rheo__warn(c->warnings, warning, "%s", text);
    }
    if (rheo__model(c->def->model)->warn) {
        rheo_world_def def = *c->def;
        def.log = (rheo_log){take_message, c->warnings};
        rheo__model(def.model)->warn(&def);
    }
}

/* A material that no shape is of is hardly meant: its name may be missing in one. */
static void check_materials(const inspection *c)
{
    const rheo_scene *scene = c->filling->scene;
    for (uint32_t k = 0; k < c->def->materials.count; k++) {
        const char *name = c->def->materials.list[k].name;
        bool used = false;
        for (uint32_t s = 0; s < scene->fill_count; s++)
            used = used || strcmp(scene->fill[s].material, name) == 0;
        for (uint32_t e = 0; e < c->def->emitters.count; e++)
            used = used || c->def->emitters.list[e].material == k + 1;
        if (!used)
            rheo__warn(c->warnings, rheo__warning_of(RHEO_WARNING_PARAMETER),
                       "no shape is of the material \"%s\": give one \"material\": \"%s\", or leave the material out",
                       name, name);
    }
}

/* Where a shape stops, its particles would change their speed by more than a step resolves. */
static void check_speed(const inspection *c, uint32_t shape)
{
    const rheo__measures *measures = rheo__measures_of(c->def);
    const uint32_t row = rheo__measure_index(measures, "speed_jump");
    const double speed = length_of(c->filling->scene->fill[shape].velocity), support = rheo__def_support(c->def),
                 way = speed * c->def->step / support;
    if (row == measures->count || !(way > measures->row[row].limit) || !moves(c->def))
        return;
    const double limit = measures->row[row].limit;
    char step[32], moved[32], slower[32];
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_SPEED);
    warning.shape = (int32_t)shape;
    warning.value = way;
    warning.limit = limit;
    rheo__warn(
        c->warnings, warning,
        "shape %u moves by %s supports in a step, more than %g: no impact at this speed is resolved; what helps: "
        "step=%s, or a lower velocity than %s",
        shape, rheo__text_brief(way, 3, false, moved), limit,
        rheo__text_brief(0.5 * limit * support / speed, 2, true, step),
        rheo__text_brief(limit * support / c->def->step, 3, true, slower));
}

/* ---- Plates ---- */

/* A plate is made of the particles that start beyond its height. Without any it does nothing. */
static void check_plate_particles(const inspection *c)
{
    const rheo_world_def *def = c->def;
    uint64_t lower = 0, upper = 0;
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < def->particles.count; i++) {
        double x[3];
        position_of(c, i, x);
        lower += x[1] < (double)(rheo_real)def->plates.lower; /* rounded as a world does */
        upper += x[1] > (double)(rheo_real)def->plates.upper;
        least = x[1] < least ? x[1] : least;
        most = x[1] > most ? x[1] : most;
    }
    for (int plate = 0; plate < 2 && def->particles.count; plate++) {
        if (plate == 0 ? lower : upper)
            continue;
        rheo_warning warning = rheo__warning_of(RHEO_WARNING_EMPTY);
        warning.value = plate == 0 ? def->plates.lower : def->plates.upper;
        warning.limit = plate == 0 ? least : most;
        char height[32], from[32], to[32];
        rheo__warn(c->warnings, warning,
                   "the %s plate has no particles, because none starts %s plates.%s=%s: they start from y = %s to %s",
                   plate == 0 ? "lower" : "upper", plate == 0 ? "below" : "above", plate == 0 ? "lower" : "upper",
                   rheo__text_brief(warning.value, 4, false, height), rheo__text_brief(least, 4, false, from),
                   rheo__text_brief(most, 4, false, to));
    }
}

static void check_plates(const inspection *c)
{
    if (rheo__world_features(c->def) & RHEO__FEATURE_PLATES)
        check_plate_particles(c);
}

/* ---- Public ---- */

rheo_result rheo__check_filled(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings,
                               rheo_error *error)
{
    const inspection c = {.filling = filling, .def = def, .warnings = warnings};
    if (filling->scene->fill_count == 0 && def->emitters.count == 0)
        rheo__warn(warnings, rheo__warning_of(RHEO_WARNING_EMPTY),
                   "there is no fluid, because the scene has no shapes: add one (fluid.shapes in a scene file)");
    else if (filling->scene->fill_count && def->particles.count == 0)
        rheo__warn(warnings, rheo__warning_of(RHEO_WARNING_EMPTY),
                   "the shapes are too small to hold a particle at a spacing of %g: make them larger, or "
                   "fluid.spacing smaller",
                   filling->spacing);
    check_parameters(&c);
    check_materials(&c);
    check_floor(&c);
    check_places(&c);
    for (uint32_t w = 0; w < def->walls.count && def->particles.count; w++)
        check_wall(&c, w);
    for (uint32_t s = 0; s < filling->scene->fill_count; s++)
        check_speed(&c, s);
    check_plates(&c);
    rheo__check_balls_at_walls(filling, def, warnings);
    rheo__check_emitters(def, warnings);
    if (warnings->refusals_only)
        return RHEO_OK;
    rheo__check_crowding(filling, def, warnings);
    return rheo__check_overlaps(filling, def, warnings, error);
}
