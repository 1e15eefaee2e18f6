/* Examines the balls of a scene, at walls, among particles and with each other, for what is hardly meant. */
#include <math.h>
#include <stdio.h>

#include "core/strict.h"
#include "core/text.h"
#include "scenes/making.h"
#include "world/parameters.h"

typedef struct inspection {
    const rheo__filling *filling;
    const rheo_world_def *def;
    rheo__warnings *warnings;
    const rheo_ball *ball;
    uint32_t index;
    const char *name;      /* in sentences: "the ball", "ball 2" */
    const char *parameter; /* its group of parameters: "ball", "ball2" */
} inspection;

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static inspection inspection_of(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings,
                                uint32_t index, char name[16], char parameter[RHEO__BALL_NAME_SIZE])
{
    snprintf(name, 16, index ? "ball %u" : "the ball", (unsigned)(index + 1) % 1000);
    return (inspection){
        filling, def, warnings, rheo__ball_of(def, index), index, name, rheo__ball_name(index, parameter)};
}

/* told: it has been said already that the ball is too large. */
static void check_at_wall(const inspection *c, uint32_t w, bool told)
{
    const rheo_wall *wall = &c->def->walls.plane[w];
    const double radius = c->ball->radius, *x = c->ball->position;
    double n[3];
    const double distance = rheo__wall_distance(wall, x, n);
    if (!(distance < radius * (1 - 1e-6)) || (told && distance >= 0))
        return;
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_BALL_IN_WALL);
    warning.refused = distance < 0;
    warning.wall = (int32_t)w;
    warning.value = radius - distance;
    warning.limit = 0;
    char overlap[32];
    rheo__warn(c->warnings, warning,
               "%s, of radius %g at [%g, %g, %g], %s wall %u by %s: move it by as much along the wall's normal "
               "[%g, %g, %g]%s",
               c->name, radius, x[0], x[1], x[2], distance < 0 ? "has its centre behind" : "overlaps", w,
               rheo__text_brief(distance < 0 ? -distance : radius - distance, 3, false, overlap), wall->normal[0],
               wall->normal[1], wall->normal[2], distance < 0 ? " and by its radius, or turn the normal round" : "");
}

/* Two walls that face each other leave room for the diameter of the ball, or not. */
static bool fits_between(const inspection *c, uint32_t a, uint32_t b)
{
    const rheo_wall *wall = c->def->walls.plane;
    double n[3], m[3];
    const double diameter = 2 * c->ball->radius, gap = rheo__wall_distance(&wall[a], wall[b].point, n);
    rheo__wall_distance(&wall[b], wall[a].point, m);
    if (!(n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < -1 + 1e-9) || !(gap > 0 && gap < diameter * (1 - 1e-6)))
        return true;
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_BALL_TOO_LARGE);
    warning.wall = (int32_t)a;
    warning.value = diameter;
    warning.limit = gap;
    char apart[32], wide[32], most[32];
    rheo__warn(c->warnings, warning,
               "%s does not fit between walls %u and %u: they are %s apart and its diameter is %s; its radius "
               "must be at most %s",
               c->name, a, b, rheo__text_brief(gap, 4, false, apart), rheo__text_brief(diameter, 4, false, wide),
               rheo__text_brief(gap / 2, 4, true, most));
    return false;
}

/* A ball that has room between particles feels no fluid. Such a radius is likely in another unit. */
static void check_size(const inspection *c)
{
    const double diameter = 2 * c->ball->radius, spacing = c->filling->spacing;
    if (!(diameter < spacing))
        return;
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_BALL_TOO_SMALL);
    warning.value = diameter;
    warning.limit = spacing;
    char radius[32], apart[32], least[32];
    rheo__warn(c->warnings, warning,
               "%s falls between the particles: %s.radius is %s, and they are %s apart; is it in the unit of "
               "fluid.spacing? It should be %s or more",
               c->name, c->parameter, rheo__text_brief(c->ball->radius, 3, false, radius),
               rheo__text_brief(spacing, 3, false, apart), rheo__text_brief(2 * spacing, 2, false, least));
}

static void check_at_walls(const inspection *c)
{
    const uint32_t walls = c->def->walls.count;
    bool told[RHEO_MAX_WALLS] = {false};
    for (uint32_t a = 0; a < walls; a++) {
        for (uint32_t b = a + 1; b < walls; b++)
            if (!fits_between(c, a, b))
                told[a] = told[b] = true;
        check_at_wall(c, a, told[a]);
    }
}

static void check_in_fluid(const inspection *c)
{
    const rheo_world_def *def = c->def;
    /* Of a rough surface a few particles stand out by less. */
    const double radius = c->ball->radius, reach = radius - c->filling->spacing / 2;
    double nearest = reach, rise = 0; /* rise: to a place above all particles */
    uint64_t inside = 0;
    for (size_t i = 0; reach > 0 && i < def->particles.count; i++) {
        double x[3];
        for (size_t axis = 0; axis < 3; axis++)
            x[axis] = (double)def->particles.position[3 * i + axis] - c->ball->position[axis];
        const double distance = length_of(x), below = radius * radius - x[0] * x[0] - x[2] * x[2],
                     up = below > 0 ? x[1] + sqrt(below) : 0;
        inside += distance < reach;
        nearest = distance < nearest ? distance : nearest;
        rise = up > rise ? up : rise;
    }
    if (inside == 0)
        return;
    const double clearance = rheo__ball_clearance(c->filling->scene, c->index);
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_BALL_IN_FLUID);
    warning.count = inside;
    warning.value = radius - nearest;
    warning.limit = c->filling->spacing / 2;
    char cure[128], deep[32], number[32];
    rheo__text_brief(clearance >= 0 ? clearance + rise : rise, 4, false, number);
    if (clearance >= 0)
        snprintf(cure, sizeof cure, "set %s.clearance to %s", c->parameter, number);
    else
        snprintf(cure, sizeof cure, "raise %s.position by %s, or set %s.clearance to 0 or more", c->parameter, number,
                 c->parameter);
    rheo__warn(c->warnings, warning,
               "%llu particle%s inside %s, up to %s below its surface, and will be thrown out; %s",
               (unsigned long long)inside, inside == 1 ? " begins" : "s begin", c->name,
               rheo__text_brief(warning.value, 3, false, deep), cure);
}

/* Balls that overlap are moved apart in the first step. */
static void check_other(const inspection *c, uint32_t other)
{
    const rheo_ball *a = rheo__ball_of(c->def, other), *b = c->ball;
    const double between[3] = {b->position[0] - a->position[0], b->position[1] - a->position[1],
                               b->position[2] - a->position[2]},
                 distance = length_of(between), apart = a->radius + b->radius;
    if (!(distance < apart * (1 - 1e-6)))
        return;
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_BALLS_OVERLAP);
    warning.value = apart - distance;
    warning.limit = 0;
    char first[16], overlap[32];
    snprintf(first, sizeof first, other ? "ball %u" : "the ball", (unsigned)(other + 1) % 1000);
    rheo__warn(c->warnings, warning, "%s overlaps %s by %s: move one of them away by as much", c->name, first,
               rheo__text_brief(apart - distance, 3, false, overlap));
}

void rheo__check_balls_at_walls(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings)
{
    for (uint32_t i = 0; i < rheo_world_def_ball_count(def); i++) {
        char name[16], parameter[RHEO__BALL_NAME_SIZE];
        const inspection c = inspection_of(filling, def, warnings, i, name, parameter);
        check_size(&c);
        check_at_walls(&c);
    }
}

void rheo__check_balls(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings)
{
    for (uint32_t i = 0; i < rheo_world_def_ball_count(def); i++) {
        char name[16], parameter[RHEO__BALL_NAME_SIZE];
        const inspection c = inspection_of(filling, def, warnings, i, name, parameter);
        check_in_fluid(&c);
        for (uint32_t other = 0; other < i; other++)
            check_other(&c, other);
    }
}
