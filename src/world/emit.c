/*
 * Emission: at the beginning of a step, after commands, every emitter adds the layers that have left its opening since the
 * last step began. With the way w that the newest layer still has to move until the next one is due, 0 at first,
 *
 *   w -= speed (b - a),   [a, b] = the times since then at which it flows;
 *   while w <= 0: a layer begins at position + direction (-w + speed (now - b)), and w += spacing.
 *
 * So layers are a spacing apart whatever the step is, and their number follows speed x time to the last one. A step that
 * fails takes its particles back.
 */
#include "world/emit.h"

#include <string.h>

#include "core/strict.h"
#include "world/emitters.h"
#include "world/model.h"

enum { MOST_LAYERS = 1000 };

/* How far a layer has moved since the last step. Speed and step may have changed since; so many layers are never meant. */
static double way_moved(const rheo_emitter *e, double begin, double end, double spacing)
{
    const double way = e->speed * (end - begin), most = MOST_LAYERS * spacing;
    return way < most ? way : most;
}

/* Layers that are due after a way, with w as it was before. Advances w. */
static uint32_t layers_due(double *way, double moved, double spacing)
{
    uint32_t layers = 0;
    for (*way -= moved; *way <= 0; layers++)
        *way += spacing;
    return layers;
}

/* The part of the times [from, to] at which an emitter flows. False: none. */
static bool flows(const rheo_emitter *e, double from, double to, double *begin, double *end)
{
    *begin = from > e->start ? from : e->start;
    *end = to < e->end ? to : e->end;
    return e->flow == RHEO_EMITTER_ON && *end >= *begin;
}

/* Most particles that become due. */
static uint64_t most_due(const rheo_world *w, double from, double to)
{
    uint64_t most = 0;
    for (uint32_t k = 0; k < w->def.emitters.count; k++) {
        const rheo_emitter *e = &w->def.emitters.list[k];
        const uint64_t emitted = w->state.emitter_emitted[k];
        double way = w->state.emitter_way[k], begin, end;
        if (!flows(e, from, to, &begin, &end) || emitted >= e->limit)
            continue;
        const uint32_t layers =
            layers_due(&way, way_moved(e, begin, end, w->def.fluid.spacing), w->def.fluid.spacing);
        const uint64_t left = e->limit - emitted,
                       due = layers ? layers * rheo_world_def_emitter_sites(&w->def, k) : 0;
        most += due < left ? due : left;
    }
    return most;
}

/* Whether a place is free: no particle, ball or obstacle is near. */
static bool is_free(const rheo_world *w, const rheo_real place[3])
{
    const rheo__state *s = &w->state;
    const rheo_real apart = (rheo_real)(w->def.fluid.spacing / 2);
    const double point[3] = {(double)place[0], (double)place[1], (double)place[2]};
    for (size_t i = 0; i < s->particles; i++)
        if (rheo__period_distance2(&w->period, place, s->position + 3 * i) < apart * apart)
            return false;
    for (uint32_t b = 0; b < s->bodies; b++) {
        const rheo_real touch = (rheo_real)rheo__ball_of(&w->def, b)->radius + apart;
        if (rheo__period_distance2(&w->period, place, s->ball_position + 3 * (size_t)b) < touch * touch)
            return false;
    }
    for (uint32_t k = 0; k < s->obstacles; k++)
        if (rheo_world_obstacle_distance(w, k, point, NULL) < (double)apart)
            return false;
    return true;
}

/* Emits a layer whose centre has moved by `offset` from the opening. There is memory for it. */
static void emit_layer(rheo_world *w, uint32_t k, const rheo__opening *o, double offset)
{
    rheo__state *s = &w->state;
    const rheo_emitter *e = &w->def.emitters.list[k];
    double at[2];
    for (uint32_t j = 0; j < o->count[1]; j++)
        for (uint32_t i = 0; i < o->count[0] && s->emitter_emitted[k] < e->limit; i++) {
            if (!rheo__opening_site(o, i, j, at))
                continue;
            rheo_real place[3];
            for (int axis = 0; axis < 3; axis++)
                place[axis] = (rheo_real)(e->position[axis] + o->direction[axis] * offset + o->axis[0][axis] * at[0] +
                                          o->axis[1][axis] * at[1]);
            if (!is_free(w, place)) {
                s->emitter_blocked[k]++;
                continue;
            }
            const size_t id = s->particles++;
            for (size_t axis = 0; axis < 3; axis++) {
                s->position[3 * id + axis] = place[axis];
                s->velocity[3 * id + axis] = (rheo_real)(e->speed * o->direction[axis]);
            }
            if (s->material)
                s->material[id] = (uint32_t)e->material;
            const rheo_real temperature = (rheo_real)e->temperature;
            rheo__world_begin_particles(w, (uint32_t)id, NULL,
                                        rheo__emitter_has_temperature(e) ? &temperature : NULL);
            if (w->type->begin_moving)
                w->type->begin_moving(w, (uint32_t)id);
            s->emitter_emitted[k]++;
        }
}

static void emit_from(rheo_world *w, uint32_t k, double from, double to)
{
    const rheo_emitter *e = &w->def.emitters.list[k];
    const double spacing = w->def.fluid.spacing;
    double begin, end;
    if (!flows(e, from, to, &begin, &end))
        return;
    double way = w->state.emitter_way[k] - way_moved(e, begin, end, spacing);
    if (way <= 0) {
        const rheo__opening opening = rheo__emitter_opening(&w->def, e);
        for (; way <= 0; way += spacing)
            emit_layer(w, k, &opening, e->speed * (to - end) - way);
    }
    w->state.emitter_way[k] = way;
}

rheo_result rheo__emit(rheo_world *w, rheo_error *error)
{
    rheo__state *s = &w->state;
    if (!(w->features & RHEO__FEATURE_EMITTERS))
        return RHEO_OK;
    const double from = *s->emitter_time, to = rheo_world_time(w);
    const uint32_t before = s->particles;
    rheo__emission *m = &w->emission;
    const uint64_t most = most_due(w, from, to);
    if (most > (UINT32_C(1) << 30) - before) /* commands added too many */
        return rheo__fail(error, RHEO_ERROR_MEMORY, "the emitters would make more than 2^30 particles");
    if (most && (!rheo__world_reserve(w, before + (uint32_t)most) ||
                 !rheo__state_resize(s, before + (uint32_t)most, s->bodies, s->vibrators)))
        return rheo__fail(error, RHEO_ERROR_MEMORY,
                          "no memory for %u more particles of the emitters; the world stays "
                          "as it was",
                          (uint32_t)most);
    s->particles = before;
    m->made = true;
    m->particles = before;
    m->time = from;
    memcpy(m->way, s->emitter_way, sizeof m->way);
    memcpy(m->emitted, s->emitter_emitted, sizeof m->emitted);
    memcpy(m->blocked, s->emitter_blocked, sizeof m->blocked);
    for (uint32_t k = 0; k < w->def.emitters.count; k++)
        emit_from(w, k, from, to);
    *s->emitter_time = to;
    return RHEO_OK;
}

void rheo__take_emission_back(rheo_world *w)
{
    rheo__state *s = &w->state;
    const rheo__emission *m = &w->emission;
    if (!m->made)
        return;
    rheo__state_drop_particles(s, m->particles);
    *s->emitter_time = m->time;
    memcpy(s->emitter_way, m->way, sizeof m->way);
    memcpy(s->emitter_emitted, m->emitted, sizeof m->emitted);
    memcpy(s->emitter_blocked, m->blocked, sizeof m->blocked);
    w->emission.made = false;
}

bool rheo_world_emitter(const rheo_world *w, uint32_t emitter, rheo_emitter_state *state)
{
    if (emitter >= w->def.emitters.count)
        return false;
    *state = (rheo_emitter_state){w->state.emitter_emitted[emitter], w->state.emitter_blocked[emitter],
                                  rheo_world_def_emitter_sites(&w->def, emitter), w->state.emitter_way[emitter]};
    return true;
}
