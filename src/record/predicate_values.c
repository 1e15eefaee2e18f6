/* Evaluates a condition (record/predicate.h) on the metrics of a step and on the items of a world. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "core/error.h"
#include "core/text.h"
#include "record/predicate.h"
#include "world/model.h"

/* ---- Quantities ---- */

static const double NOT_A_NUMBER = __builtin_nan("");

/* Components of vectors that have names of their own. */
static const struct {
    const char *name, *vector;
    int component;
} SHORT[] = {{"x", "position", 0},  {"y", "position", 1},  {"z", "position", 2},
             {"vx", "velocity", 0}, {"vy", "velocity", 1}, {"vz", "velocity", 2}};

/* Of particles, beside rheo_world_quantity(): counts. */
enum { NEIGHBOURS = 1000, SPRINGS };

static const char *const SPRING[] = {"length", "rest_length", "stretch", "history_rate", "stiffness", "kappa"};
static const char *const BALL[] = {"position", "velocity", "spin", "speed"};

/* Splits "velocity.x", and turns "vx" into the same. */
static void split(const char *name, char vector[64], int *component)
{
    *component = -1;
    rheo__text_print(vector, 64, "%s", name);
    for (size_t i = 0; i < sizeof SHORT / sizeof *SHORT; i++)
        if (strcmp(name, SHORT[i].name) == 0) {
            rheo__text_print(vector, 64, "%s", SHORT[i].vector);
            *component = SHORT[i].component;
        }
    char *dot = strrchr(vector, '.');
    if (dot && dot[1] >= 'x' && dot[1] <= 'z' && !dot[2]) {
        *component = dot[1] - 'x';
        *dot = 0;
    }
}

bool rheo__term_resolve(rheo__term *term, const rheo_world *world)
{
    char name[64];
    int component;
    const rheo_quantity *q;
    split(term->name, name, &component);
    term->component = component;
    if (term->about == RHEO__ABOUT_PARTICLE) {
        const bool springs = rheo__state_has(&world->state, RHEO__FIELD_spring_ends);
        for (term->quantity = 0; (q = rheo_world_quantity(world, term->quantity)) != NULL; term->quantity++)
            if (strcmp(q->name, name) == 0)
                return component < 0 || q->components == 3;
        term->quantity = strcmp(name, "neighbours") == 0 ? NEIGHBOURS : SPRINGS;
        return component < 0 && (term->quantity == NEIGHBOURS || (springs && strcmp(name, "springs") == 0));
    }
    const char *const *names = term->about == RHEO__ABOUT_SPRING ? SPRING : BALL;
    const uint32_t count =
        term->about == RHEO__ABOUT_SPRING ? sizeof SPRING / sizeof *SPRING : sizeof BALL / sizeof *BALL;
    for (term->quantity = 0; term->quantity < count; term->quantity++)
        if (strcmp(names[term->quantity], name) == 0)
            return component < 0 || (term->about == RHEO__ABOUT_BALL && term->quantity < 3);
    return false;
}

void rheo__term_names(rheo__about about, const rheo_world *world, char *text, size_t size)
{
    const rheo_quantity *q;
    if (about == RHEO__ABOUT_SPRING) {
        for (size_t i = 0; i < sizeof SPRING / sizeof *SPRING; i++)
            rheo__text_add(text, size, "%s%s", i ? ", " : "", SPRING[i]);
        return;
    }
    rheo__text_add(text, size, "x, y, z, vx, vy, vz");
    if (about == RHEO__ABOUT_BALL)
        rheo__text_add(text, size, ", speed, spin");
    for (uint32_t i = 0; about == RHEO__ABOUT_PARTICLE && (q = rheo_world_quantity(world, i)) != NULL; i++)
        rheo__text_add(text, size, ", %s", q->name);
    if (about == RHEO__ABOUT_PARTICLE)
        rheo__text_add(text, size, ", neighbours, springs");
}

/* ---- Comparing ---- */

static bool holds(rheo__operator op, double value, double number)
{
    switch (op) {
    case RHEO__LESS:
        return value < number;
    case RHEO__AT_MOST:
        return value <= number;
    case RHEO__MORE:
        return value > number;
    case RHEO__AT_LEAST:
        return value >= number;
    case RHEO__EQUAL:
        return value == number;
    case RHEO__UNEQUAL:
        return value != number;
    case RHEO__EXISTS:
        break;
    }
    return false;
}

/* Compares one of several things: the outcome is the one for which a comparison holds most clearly, or the first. */
static void consider(const rheo__term *t, double value, uint64_t id, uint64_t other, rheo__outcome *best)
{
    if (!holds(t->op, value, t->number))
        return;
    const bool clearer = t->op <= RHEO__AT_MOST    ? value < best->value
                         : t->op <= RHEO__AT_LEAST ? value > best->value
                                                   : false;
    if (best->truth != RHEO__TRUE || clearer)
        *best = (rheo__outcome){RHEO__TRUE, id, other, value};
}

static double component_of(const rheo__term *t, const double v[3])
{
    return t->component >= 0 ? v[t->component] : __builtin_sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* ---- Particles ---- */

static double value_of_particle(const rheo__term *t, const rheo_world *world, const rheo_particle_state *p)
{
    if (t->quantity >= NEIGHBOURS)
        return t->quantity == NEIGHBOURS ? (double)p->neighbours : (double)p->springs;
    const rheo_quantity *q = rheo_world_quantity(world, t->quantity);
    const double *value = (const double *)((const char *)p + q->offset);
    return q->components == 3 ? component_of(t, value) : *value;
}

/* Whether a term needs no more than positions and velocities, which need not be computed; sets these of a particle. */
static bool is_motion(const rheo__term *t, const rheo_world *world)
{
    const rheo_quantity *q = t->quantity < NEIGHBOURS ? rheo_world_quantity(world, t->quantity) : NULL;
    return q &&
           (strcmp(q->name, "position") == 0 || strcmp(q->name, "velocity") == 0 || strcmp(q->name, "speed") == 0);
}

static rheo_particle_state motion_of(const rheo_world *world, uint32_t id)
{
    rheo_particle_state p = {.speed = 0};
    double speed2 = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        p.position[axis] = (double)world->state.position[3 * (size_t)id + axis];
        p.velocity[axis] = (double)world->state.velocity[3 * (size_t)id + axis];
        speed2 += p.velocity[axis] * p.velocity[axis];
    }
    p.speed = __builtin_sqrt(speed2);
    return p;
}

static rheo_result look_at_particles(const rheo__term *t, const rheo_world *world, rheo_particle_state **states,
                                     rheo__outcome *outcome, rheo_error *error)
{
    const uint32_t count = world->state.particles;
    const bool motion = t->op == RHEO__EXISTS || is_motion(t, world);
    if (!t->any) {
        rheo_particle_state p = {.speed = 0};
        if (t->id >= count)
            return RHEO_OK;
        if (motion)
            p = motion_of(world, t->id);
        else
            RHEO__TRY(rheo_world_particle(world, t->id, &p, error));
        if (t->op == RHEO__EXISTS)
            *outcome = (rheo__outcome){RHEO__TRUE, t->id, 0, 1};
        else
            consider(t, value_of_particle(t, world, &p), t->id, 0, outcome);
        if (outcome->truth != RHEO__TRUE)
            outcome->value = value_of_particle(t, world, &p);
        return RHEO_OK;
    }
    if (!motion && !*states) { /* once for all terms */
        *states = malloc((count + (size_t)1) * sizeof **states);
        if (!*states)
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the values of %u particles", count);
        RHEO__TRY(rheo_world_particles(world, *states, error));
    }
    for (uint32_t i = 0; i < count; i++) {
        const rheo_particle_state p = motion ? motion_of(world, i) : (*states)[i];
        consider(t, value_of_particle(t, world, &p), i, 0, outcome);
    }
    return RHEO_OK;
}

/* ---- Springs ---- */

static double value_of_spring(const rheo__term *t, const rheo_spring_state *s)
{
    const double rest = (double)s->spring.rest_length;
    const double values[] = {s->length,       rest,         rest > 0 ? s->length / rest - 1 : NOT_A_NUMBER,
                             s->history_rate, s->stiffness, s->kappa};
    _Static_assert(sizeof values / sizeof *values == sizeof SPRING / sizeof *SPRING, "a value for each name");
    return values[t->quantity];
}

static rheo_result look_at_springs(const rheo__term *t, const rheo_world *world, rheo__outcome *outcome,
                                   rheo_error *error)
{
    const size_t count = rheo_world_spring_count(world);
    rheo_spring *spring = malloc((count + 1) * sizeof *spring);
    rheo_result result = spring ? rheo_world_springs(world, spring, count) : RHEO_ERROR_MEMORY;
    if (result != RHEO_OK)
        rheo__fail(error, result, "no memory for the values of %zu springs", count);
    for (size_t k = 0; k < count && result == RHEO_OK; k++) {
        rheo_spring_state state;
        if (!t->any && (spring[k].a != t->id || spring[k].b != t->other))
            continue;
        if (t->op == RHEO__EXISTS) {
            *outcome = (rheo__outcome){RHEO__TRUE, t->id, t->other, 1};
            break;
        }
        result = rheo_world_spring(world, spring[k].a, spring[k].b, &state, error);
        if (result == RHEO_OK)
            consider(t, value_of_spring(t, &state), spring[k].a, spring[k].b, outcome);
    }
    free(spring);
    return result;
}

/* ---- Balls ---- */

static void look_at_ball(const rheo__term *t, const rheo_world *world, rheo__outcome *outcome)
{
    rheo_body body;
    if (rheo_world_body(world, t->id, &body) != RHEO_OK)
        return;
    const double *const vectors[] = {body.position, body.velocity, body.spin, body.velocity};
    consider(t, component_of(t, vectors[t->quantity]), t->id, 0, outcome);
}

/* ---- The condition ---- */

void rheo__predicate_metrics(const rheo__predicate *c, const double *metrics, rheo__outcome *outcome)
{
    for (uint32_t i = 0; i < c->terms; i++) {
        const rheo__term *t = &c->term[i];
        outcome[i] = (rheo__outcome){RHEO__UNKNOWN, 0, 0, NOT_A_NUMBER};
        if (t->about == RHEO__ABOUT_METRIC && metrics) {
            outcome[i].value = metrics[t->quantity];
            outcome[i].truth = holds(t->op, outcome[i].value, t->number) ? RHEO__TRUE : RHEO__FALSE;
        }
    }
}

rheo_result rheo__predicate_items(const rheo__predicate *c, const rheo_world *world, rheo__outcome *outcome,
                                  rheo_error *error)
{
    rheo_particle_state *states = NULL;
    rheo_result result = RHEO_OK;
    for (uint32_t i = 0; i < c->terms && result == RHEO_OK; i++) {
        const rheo__term *t = &c->term[i];
        if (t->about == RHEO__ABOUT_METRIC)
            continue;
        outcome[i] = (rheo__outcome){RHEO__FALSE, t->id, t->other, NOT_A_NUMBER};
        if (t->about == RHEO__ABOUT_PARTICLE)
            result = look_at_particles(t, world, &states, &outcome[i], error);
        else if (t->about == RHEO__ABOUT_SPRING)
            result = look_at_springs(t, world, &outcome[i], error);
        else
            look_at_ball(t, world, &outcome[i]);
    }
    free(states);
    return result;
}

static rheo__truth combine(rheo__node_kind kind, rheo__truth a, rheo__truth b)
{
    const rheo__truth decides = kind == RHEO__AND ? RHEO__FALSE : RHEO__TRUE;
    return a == decides || b == decides ? decides : a == RHEO__UNKNOWN || b == RHEO__UNKNOWN ? RHEO__UNKNOWN : a;
}

rheo__truth rheo__predicate_truth(const rheo__predicate *c, const rheo__outcome *outcome)
{
    rheo__truth stack[RHEO__MOST_NODES];
    size_t depth = 0;
    for (uint32_t i = 0; i < c->nodes; i++) {
        const rheo__node *node = &c->node[i];
        if (node->kind == RHEO__TERM) {
            stack[depth++] = outcome[node->term].truth;
        } else if (node->kind == RHEO__NOT) {
            rheo__truth *top = &stack[depth - 1];
            *top = *top == RHEO__UNKNOWN ? RHEO__UNKNOWN : *top == RHEO__TRUE ? RHEO__FALSE : RHEO__TRUE;
        } else {
            depth--;
            stack[depth - 1] = combine(node->kind, stack[depth - 1], stack[depth]);
        }
    }
    return stack[0];
}
