/* Examines the emitters of a scene for what is hardly meant. What cannot work at all is refused with the definition. */
#include <math.h>

#include "core/strict.h"
#include "core/text.h"
#include "scenes/making.h"
#include "world/emitters.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A wall stops it within two steps, before its neighbours feel it. */
static void check_speed(const rheo_world_def *def, const rheo_emitter *e, rheo__warnings *warnings)
{
    const rheo__measures *measures = rheo__measures_of(def);
    const uint32_t row = rheo__measure_index(measures, "courant_number");
    const double support = rheo__def_support(def), way = e->speed * def->step / support;
    if (row == measures->count || !(way > measures->row[row].limit))
        return;
    const double limit = measures->row[row].limit;
    char step[32], moved[32], slower[32];
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_SPEED);
    warning.value = way;
    warning.limit = limit;
    rheo__warn(
        warnings, warning,
        "the fluid of emitter %s moves by %s supports in a step, more than %g, so an impact is hardly resolved; "
        "what helps: step=%s, or a speed below %s",
        e->name, rheo__text_brief(way, 3, false, moved), limit,
        rheo__text_brief(0.5 * limit * support / e->speed, 2, true, step),
        rheo__text_brief(limit * support / def->step, 3, true, slower));
}

/* A wall nearer than a support in front of the opening dams the flow up to it. */
static void check_way(const rheo_world_def *def, const rheo_emitter *e, const rheo__opening *o,
                      rheo__warnings *warnings)
{
    for (uint32_t w = 0; w < def->walls.count; w++) {
        const rheo_wall *wall = &def->walls.plane[w];
        const double length = sqrt(dot(wall->normal, wall->normal)),
                     towards = -dot(wall->normal, o->direction) / length,
                     from[3] = {e->position[0] - wall->point[0], e->position[1] - wall->point[1],
                                e->position[2] - wall->point[2]},
                     way = dot(from, wall->normal) / length / towards, support = rheo__def_support(def);
        if (!(towards > 1e-6) || way >= support)
            continue;
        rheo_warning warning = rheo__warning_of(RHEO_WARNING_EMITTER);
        warning.wall = (int32_t)w;
        warning.value = way;
        warning.limit = support;
        char near_text[32], far_text[32];
        rheo__warn(
            warnings, warning,
            "emitter %s flows into wall %u, %s in front of it: the fluid backs up, and what has no room is left out; "
            "move it away by more than a support, %s, or turn it",
            e->name, w, rheo__text_brief(way, 3, false, near_text), rheo__text_brief(support, 3, false, far_text));
    }
}

/* Sites of the opening that are nearer than half a spacing to a particle of the shapes. */
static uint64_t count_taken(const rheo_world_def *def, const rheo_emitter *e, const rheo__opening *o)
{
    uint64_t taken = 0;
    double at[2];
    for (uint32_t j = 0; j < o->count[1]; j++)
        for (uint32_t i = 0; i < o->count[0]; i++) {
            bool free = true;
            if (!rheo__opening_site(o, i, j, at))
                continue;
            for (size_t k = 0; k < def->particles.count && free; k++) {
                double d[3];
                for (size_t axis = 0; axis < 3; axis++)
                    d[axis] = e->position[axis] + o->axis[0][axis] * at[0] + o->axis[1][axis] * at[1] -
                              (double)def->particles.position[3 * k + axis];
                free = !(dot(d, d) < o->spacing * o->spacing / 4);
            }
            taken += !free;
        }
    return taken;
}

static void check_room(const rheo_world_def *def, const rheo_emitter *e, const rheo__opening *o,
                       rheo__warnings *warnings)
{
    const uint64_t taken = count_taken(def, e, o);
    if (!taken || e->start > 0)
        return;
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_EMITTER);
    warning.count = taken;
    rheo__warn(
        warnings, warning,
        "emitter %s is in the fluid: %llu of the %llu particles of its first layer have no room and are left out; "
        "move it or the shape",
        e->name, (unsigned long long)taken, (unsigned long long)rheo__opening_sites(o));
}

void rheo__check_emitters(const rheo_world_def *def, rheo__warnings *warnings)
{
    for (uint32_t k = 0; k < def->emitters.count; k++) {
        const rheo_emitter *e = &def->emitters.list[k];
        const rheo__opening opening = rheo__emitter_opening(def, e);
        check_speed(def, e, warnings);
        check_way(def, e, &opening, warnings);
        if (!warnings->refusals_only)
            check_room(def, e, &opening, warnings);
    }
}
