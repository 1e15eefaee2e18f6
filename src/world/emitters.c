/*
 * The emitters of a definition, a list of named items (world/listed.c): parameters, openings, checks.
 *
 * The opening is a plane with the normal d. Its first axis is horizontal, a = y x d/|y x d|, or x where d is vertical; the
 * second is b = d x a. A disc has the sites spacing (i a + j b) with integers i, j and i^2 + j^2 <= (radius/spacing)^2.
 */
#include "world/emitters.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "core/text.h"
#include "world/parameters.h"
#include "world/model.h"

/* ---- Rows ---- */

enum { MOST_SPACINGS = 1000 };
#define LARGEST_LIMIT 1073741824.0 /* 2^30 */

static const char *const shapes[] = {[RHEO_EMITTER_DISC] = "disc", [RHEO_EMITTER_RECTANGLE] = "rectangle"};
static const char *const flows[] = {[RHEO_EMITTER_OFF] = "off", [RHEO_EMITTER_ON] = "on"};
#define HEAD(kind, unit_, meaning) .type = RHEO_PARAMETER_##kind, .unit = unit_, .about = meaning
#define WORDS(words) .choices = words, .choice_count = 2, .maximum = 1
#define PLACE .minimum = -RHEO__UNBOUNDED, .maximum = RHEO__UNBOUNDED
#define LENGTH .minimum = 0, .maximum = RHEO__UNBOUNDED
#define TIME .minimum = 0, .maximum = RHEO__UNBOUNDED
#define LIVE .models = UINT32_MAX, .live = true
#define OF_MODEL(model) .models = UINT32_C(1) << (model)

/* X(number of the emitter, member of rheo_emitter, default, members of rheo_parameter) */
#define PARAMETERS(X, n)                                                                                             \
    X(n, shape, {RHEO_EMITTER_DISC}, HEAD(CHOICE, "", "shape of the opening"), WORDS(shapes), LIVE)                  \
    X(n, flow, {RHEO_EMITTER_ON}, HEAD(CHOICE, "", "whether fluid flows out"), WORDS(flows), LIVE)                   \
    X(n, position, {0}, HEAD(VECTOR, "L", "centre of the opening, in front of all walls"), PLACE, LIVE)              \
    X(n, direction, DOWN, HEAD(VECTOR, "1", "direction of the flow, of any length but 0"), PLACE, LIVE)              \
    X(n, radius, {0}, HEAD(REAL, "L", "radius of a disc; below a spacing: a thread of single particles"), LENGTH,    \
      LIVE)                                                                                                          \
    X(n, width, {0}, HEAD(REAL, "L", "width of a rectangle, along the horizontal; if it flows up or down, along x"), \
      LENGTH, LIVE)                                                                                                  \
    X(n, height, {0}, HEAD(REAL, "L", "height of a rectangle, along its other side"), LENGTH, LIVE)                  \
    X(n, speed, {1}, HEAD(REAL, "L/T", "speed of the particles, at most a support in a step"),                       \
      .maximum = RHEO__UNBOUNDED, .above_minimum = true, LIVE)                                                       \
    X(n, start, {0}, HEAD(REAL, "T", "time at which it begins to flow"), TIME, LIVE)                                 \
    X(n, end, {RHEO__UNBOUNDED}, HEAD(REAL, "T", "time at which it ends to flow"), TIME, LIVE)                       \
    X(n, limit, {10000}, HEAD(INTEGER, "", "most particles that it emits"), .minimum = 1, .maximum = LARGEST_LIMIT,  \
      LIVE)                                                                                                          \
    X(n, material, {0}, HEAD(INTEGER, "", "number of the material of its particles; in a scene file the name"),      \
      .maximum = RHEO_MAX_MATERIALS, OF_MODEL(RHEO_MODEL_THICKENING))                                                \
    X(n, temperature, {-RHEO__UNBOUNDED},                                                                            \
      HEAD(REAL, "K", "temperature of its particles; -1e30: melting.temperature"), .minimum = -RHEO__UNBOUNDED,      \
      .maximum = 1e12, OF_MODEL(RHEO_MODEL_MELTING))
#define DOWN     \
    {            \
        0, -1, 0 \
    }

#define OF_ANY(n, member, initial, ...) {.path = "emitters.NAME." #member, __VA_ARGS__},
#define ROW(n, member, initial, ...)                        \
    {{.path = "emitters." #n "." #member, __VA_ARGS__},     \
     offsetof(rheo_world_def, emitters.list[(n)-1].member), \
     0,                                                     \
     initial},
#define ROWS(n) RHEO__NAME_ROW("emitters", n, emitters.list, "name of the emitter", UINT32_MAX) PARAMETERS(ROW, n)

static const rheo_parameter of_any[] = {PARAMETERS(OF_ANY, 0)};
static const rheo__parameter_row rows[] = {ROWS(1) ROWS(2) ROWS(3) ROWS(4) ROWS(5) ROWS(6) ROWS(7) ROWS(8)};

enum { LENGTH_OF_ANY = sizeof of_any / sizeof *of_any, ROWS_OF_ONE = LENGTH_OF_ANY + 1 };
_Static_assert(sizeof rows / sizeof *rows == RHEO_MAX_EMITTERS * ROWS_OF_ONE, "every emitter has its rows");

const rheo_parameter *rheo_emitter_parameter_at(size_t index)
{
    return index < LENGTH_OF_ANY ? &of_any[index] : NULL;
}

/* ---- Emitters ---- */

rheo_emitter rheo_default_emitter(const char *name)
{
    rheo_world_def def = {.emitters = {.count = 1}};
    for (size_t i = 0; i < ROWS_OF_ONE; i++)
        rheo__row_set_default(&def, &rows[i]);
    snprintf(def.emitters.list[0].name, sizeof def.emitters.list[0].name, "%s", name);
    return def.emitters.list[0];
}

rheo_result rheo_emitter_default(const rheo_parameter *parameter, char *value, size_t size)
{
    rheo_world_def def = {.emitters = {.count = 1}};
    char path[64];
    def.emitters.list[0] = rheo_default_emitter("");
    snprintf(path, sizeof path, "emitters.1.%s", rheo__in_item(parameter->path));
    return rheo_world_def_get(&def, path, value, size);
}

rheo_result rheo_world_def_add_emitter(rheo_world_def *def, const rheo_emitter *emitter, rheo_error *error)
{
    return rheo__list_add(def, &rheo__emitters, emitter, error);
}

static rheo_result add(rheo_world_def *def, const char *name, rheo_error *error)
{
    const rheo_emitter emitter = rheo_default_emitter(name);
    return rheo_world_def_add_emitter(def, &emitter, error);
}

const rheo__list rheo__emitters = {
    .group = "emitters.",
    .item = "emitter",
    .most = RHEO_MAX_EMITTERS,
    .row = rows,
    .rows_of_one = ROWS_OF_ONE,
    .count_offset = offsetof(rheo_world_def, emitters.count),
    .items_offset = offsetof(rheo_world_def, emitters.list),
    .item_size = sizeof(rheo_emitter),
    .add = add,
};

bool rheo__emitter_has_temperature(const rheo_emitter *emitter)
{
    return emitter->temperature > -RHEO__UNBOUNDED;
}

/* ---- Openings ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalise(const double v[3], double unit[3])
{
    const double length = __builtin_sqrt(dot(v, v));
    for (int axis = 0; axis < 3; axis++)
        unit[axis] = v[axis] / length;
}

/* Sites along a side of a rectangle. */
static uint32_t sites_along(double length, double spacing)
{
    const uint32_t count = (uint32_t)(length / spacing + 0.5);
    return count ? count : 1;
}

rheo__opening rheo__emitter_opening(const rheo_world_def *def, const rheo_emitter *e)
{
    static const double up[3] = {0, 1, 0};
    const double spacing = def->fluid.spacing;
    rheo__opening o = {.spacing = spacing, .radius2 = -1};
    double horizontal[3];
    normalise(e->direction, o.direction);
    cross(up, o.direction, horizontal);
    if (dot(horizontal, horizontal) > 1e-24)
        normalise(horizontal, o.axis[0]);
    else
        o.axis[0][0] = 1;
    cross(o.direction, o.axis[0], o.axis[1]);
    if (e->shape == RHEO_EMITTER_DISC) {
        const double radius = e->radius / spacing;
        o.radius2 = radius * radius;
        o.count[0] = o.count[1] = 2 * (uint32_t)radius + 1;
    } else {
        o.count[0] = sites_along(e->width, spacing);
        o.count[1] = sites_along(e->height, spacing);
    }
    return o;
}

bool rheo__opening_site(const rheo__opening *o, uint32_t i, uint32_t j, double place[2])
{
    const double x = (double)i - 0.5 * (double)(o->count[0] - 1), y = (double)j - 0.5 * (double)(o->count[1] - 1);
    place[0] = o->spacing * x;
    place[1] = o->spacing * y;
    return o->radius2 < 0 || x * x + y * y <= o->radius2;
}

uint64_t rheo__opening_sites(const rheo__opening *o)
{
    uint64_t sites = 0;
    double place[2];
    for (uint32_t j = 0; j < o->count[1]; j++)
        for (uint32_t i = 0; i < o->count[0]; i++)
            sites += rheo__opening_site(o, i, j, place);
    return sites;
}

double rheo__opening_reach(const rheo__opening *o, const double along[3])
{
    double reach = 0, part[2];
    for (int k = 0; k < 2; k++) {
        part[k] = dot(along, o->axis[k]);
        reach += 0.5 * o->spacing * (double)(o->count[k] - 1) * (part[k] < 0 ? -part[k] : part[k]);
    }
    return o->radius2 < 0 ? reach : o->spacing * __builtin_sqrt(o->radius2 * (part[0] * part[0] + part[1] * part[1]));
}

uint64_t rheo_world_def_emitter_sites(const rheo_world_def *def, uint32_t emitter)
{
    if (emitter >= def->emitters.count)
        return 0;
    const rheo__opening opening = rheo__emitter_opening(def, &def->emitters.list[emitter]);
    return rheo__opening_sites(&opening);
}

double rheo__emitted_until(const rheo_world_def *def, double time)
{
    double all = 0;
    for (uint32_t k = 0; k < def->emitters.count; k++) {
        const rheo_emitter *e = &def->emitters.list[k];
        const double end = time < e->end ? time : e->end;
        if (!(end >= e->start))
            continue;
        const double later = (end - e->start) * e->speed / def->fluid.spacing,
                     layers = 1 + (later < 0x1p62 ? (double)(int64_t)later : later),
                     emitted = layers * (double)rheo_world_def_emitter_sites(def, k);
        all += emitted < (double)e->limit ? emitted : (double)e->limit;
    }
    return all;
}

/* ---- Checks ---- */

static rheo_result check_opening(const rheo_world_def *def, const rheo_emitter *e, rheo_error *error)
{
    const double *d = e->direction, most = MOST_SPACINGS * def->fluid.spacing, length2 = dot(d, d);
    if (!(length2 > 1e-100 && length2 < 1e100))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "emitters.%s.direction is [%g, %g, %g]; it must be a finite vector other than zero",
                          e->name, d[0], d[1], d[2]);
    const bool disc = e->shape == RHEO_EMITTER_DISC;
    if (disc ? e->radius > most : e->width > most || e->height > most)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "emitters.%s: its opening is wider than %d spacings of %g, from the centre of a disc or along a "
            "side; make it smaller",
            e->name, MOST_SPACINGS, def->fluid.spacing);
    const rheo__opening opening = rheo__emitter_opening(def, e);
    const uint64_t sites = rheo__opening_sites(&opening);
    return sites <= e->limit
               ? RHEO_OK
               : rheo__fail(
                     error, RHEO_ERROR_ARGUMENT,
                     "emitters.%s: a layer has %llu particles, more than its limit of %llu; raise the limit, or "
                     "make the opening smaller",
                     e->name, (unsigned long long)sites, (unsigned long long)e->limit);
}

static rheo_result check_walls(const rheo_world_def *def, const rheo_emitter *e, rheo_error *error)
{
    const rheo__opening opening = rheo__emitter_opening(def, e);
    for (uint32_t w = 0; w < def->walls.count; w++) {
        const rheo_wall *wall = &def->walls.plane[w];
        const double from[3] = {e->position[0] - wall->point[0], e->position[1] - wall->point[1],
                                e->position[2] - wall->point[2]};
        double normal[3];
        char depth[32];
        normalise(wall->normal, normal);
        const double behind = rheo__opening_reach(&opening, normal) - dot(from, normal);
        if (behind > 1e-6 * def->fluid.spacing)
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "emitters.%s: its opening is behind wall %u, up to %s deep; the fluid belongs on the side that the wall's "
                "normal [%g, %g, %g] points to: move the emitter there",
                e->name, w, rheo__text_brief(behind, 3, false, depth), wall->normal[0], wall->normal[1],
                wall->normal[2]);
    }
    return RHEO_OK;
}

static rheo_result check_emitter(const rheo_world_def *def, const rheo_emitter *e, rheo_error *error)
{
    const double support = rheo__def_support(def);
    char way[32], slower[32], step[32];
    if (e->speed * def->step > support)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "emitters.%s.speed is %g: that is %s supports in a step, and more than one is not resolved; it "
            "must be at most %s, or step at most %s",
            e->name, e->speed, rheo__text_brief(e->speed * def->step / support, 3, false, way),
            rheo__text_brief(support / def->step, 4, true, slower),
            rheo__text_brief(support / e->speed, 4, true, step));
    if (def->model == RHEO_MODEL_MELTING && def->melting.flow == RHEO_FLOW_FROZEN)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "emitters.%s: nothing moves with melting.flow frozen; set it to on, or leave the emitter out", e->name);
    if (e->end < e->start)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "emitters.%s.end is %g, before its start at %g", e->name,
                          e->end, e->start);
    if (e->material > def->materials.count)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "emitters.%s.material is %llu; the last material is %u",
                          e->name, (unsigned long long)e->material, def->materials.count);
    RHEO__TRY(check_opening(def, e, error));
    return check_walls(def, e, error);
}

rheo_result rheo__emitters_check(const rheo_world_def *def, rheo_error *error)
{
    uint64_t all = def->particles.count;
    for (uint32_t k = 0; k < def->emitters.count; k++) {
        RHEO__TRY(check_emitter(def, &def->emitters.list[k], error));
        all += def->emitters.list[k].limit;
    }
    if (def->emitters.count && all > (UINT32_C(1) << 30))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the limits of the emitters and the particles are %llu together; at most 2^30 are possible",
                          (unsigned long long)all);
    return RHEO_OK;
}
