/* The columns of `rheolog track`, and their values in a world. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/track.h"

static const char *const MOTION[] = {"x", "y", "z", "vx", "vy", "vz"};
static const char *const SPRING[] = {"exists",       "rest_length", "length", "stretch",
                                     "history_rate", "stiffness",   "kappa"};
static const char *const BALL[] = {"speed", "spin.x", "spin.y", "spin.z"};
enum { MOTIONS = 6, SPRINGS = 7, BALLS = 4 };

/* ---- Names ---- */

/* Adds a column; with `name` NULL only counts it. */
static void add(cli_followed *t, const char *name, const char *component)
{
    if (t->name)
        snprintf(t->name[t->count], CLI_TRACK_NAME, "%s%s", name, component);
    t->count++;
}

static void add_all(cli_followed *t, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add(t, names[i], "");
}

/* Whether a quantity has columns of its own: position and velocity are in MOTION. */
static bool is_own(const rheo_quantity *q)
{
    return strcmp(q->name, "position") != 0 && strcmp(q->name, "velocity") != 0;
}

static void add_quantities(cli_followed *t, const rheo_world *world)
{
    static const char *const COMPONENT[] = {".x", ".y", ".z"};
    const rheo_quantity *q;
    for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++)
        for (uint32_t c = 0; c < q->components && is_own(q); c++)
            add(t, q->name, q->components == 3 ? COMPONENT[c] : "");
}

/* Rows that a history can have. */
static uint32_t most_rows(const rheo_world *world)
{
    const uint32_t window = rheo_world_history_window(world), lag = rheo_world_history_lag(world);
    return rheo_world_history_modes(world) ? lag + 1 : window ? lag + window + 1 : 0;
}

static void add_names(cli_followed *t, const rheo_world *world)
{
    t->count = 0;
    switch (t->kind) {
    case CLI_TRACK_PARTICLE:
        add_all(t, MOTION, MOTIONS);
        add_quantities(t, world);
        add(t, "neighbours", "");
        add(t, "springs", "");
        break;
    case CLI_TRACK_SPRING:
        add_all(t, SPRING, SPRINGS);
        break;
    case CLI_TRACK_BALL:
        add_all(t, MOTION, MOTIONS);
        add_all(t, BALL, BALLS);
        break;
    case CLI_TRACK_PROBE:
        add(t, "particles", "");
        add(t, "weight", "");
        add_all(t, MOTION + 3, 3);
        add_quantities(t, world);
        break;
    }
    for (uint32_t lag = 0; t->history && t->kind <= CLI_TRACK_SPRING && lag < most_rows(world); lag++) {
        char number[16];
        snprintf(number, sizeof number, "%u", (unsigned)lag);
        add(t, "lag.", number);
    }
}

bool cli_track_columns(cli_followed *t, const rheo_world *world)
{
    add_names(t, world); /* counts them */
    t->name = calloc(t->count, sizeof *t->name);
    t->value = calloc(t->count, sizeof *t->value);
    if (!t->name || !t->value)
        return false;
    add_names(t, world);
    return true;
}

void cli_track_release(cli_followed *t)
{
    free(t->name);
    free(t->value);
    t->name = NULL;
    t->value = NULL;
}

/* ---- Values ---- */

static double *put(double *to, const double *values, size_t count)
{
    memcpy(to, values, count * sizeof *values);
    return to + count;
}

/* The values of a particle that have columns, beside its motion. */
static double *put_quantities(double *to, const rheo_world *world, const rheo_particle_state *p)
{
    const rheo_quantity *q;
    for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++)
        if (is_own(q))
            to = put(to, (const double *)(const void *)((const char *)p + q->offset), q->components);
    return to;
}

/* Lengths of past velocities, newest first. */
static rheo_result put_history(const cli_followed *t, double *to, const rheo_world *world)
{
    const uint32_t rows = rheo_world_history_rows(world);
    if (!t->history || !rows)
        return RHEO_OK;
    rheo_real *v = malloc(3 * (size_t)rows * sizeof *v);
    rheo_result result = !v                              ? RHEO_ERROR_MEMORY
                         : t->kind == CLI_TRACK_PARTICLE ? rheo_world_particle_history(world, t->id, v)
                                                         : rheo_world_spring_history(world, t->id, t->other, v);
    for (uint32_t i = 0; i < rows && result == RHEO_OK && to + i < t->value + t->count; i++) {
        const double x = (double)v[3 * i], y = (double)v[3 * i + 1], z = (double)v[3 * i + 2];
        to[i] = sqrt(x * x + y * y + z * z);
    }
    free(v);
    return result;
}

static rheo_result particle_values(cli_followed *t, const rheo_world *world, rheo_error *error)
{
    rheo_particle_state p;
    if (t->id >= rheo_world_particle_count(world))
        return RHEO_OK; /* it has not been added yet */
    const rheo_result result = rheo_world_particle(world, t->id, &p, error);
    if (result != RHEO_OK)
        return result;
    double *to = put(put(t->value, p.position, 3), p.velocity, 3);
    to = put_quantities(to, world, &p);
    *to++ = (double)p.neighbours;
    *to++ = (double)p.springs;
    return put_history(t, to, world);
}

static rheo_result spring_values(cli_followed *t, const rheo_world *world)
{
    rheo_spring_state s;
    rheo_error none = {""};
    const uint32_t larger = t->id > t->other ? t->id : t->other;
    if (larger >= rheo_world_particle_count(world))
        return RHEO_OK;
    const rheo_result result = rheo_world_spring(world, t->id, t->other, &s, &none);
    t->value[0] = result == RHEO_OK ? 1 : 0;
    if (result == RHEO_ERROR_MEMORY)
        return result;
    if (result == RHEO_OK) {
        const double rest = (double)s.spring.rest_length;
        const double values[] = {rest,           s.length,    rest > 0 ? s.length / rest - 1 : NAN,
                                 s.history_rate, s.stiffness, s.kappa};
        put(t->value + 1, values, SPRINGS - 1);
    }
    return put_history(t, t->value + SPRINGS, world); /* of two particles, connected or not */
}

static void ball_values(cli_followed *t, const rheo_world *world)
{
    rheo_body b;
    if (rheo_world_body(world, t->id, &b) != RHEO_OK)
        return;
    double *to = put(put(t->value, b.position, 3), b.velocity, 3);
    *to++ = sqrt(b.velocity[0] * b.velocity[0] + b.velocity[1] * b.velocity[1] + b.velocity[2] * b.velocity[2]);
    put(to, b.spin, 3);
}

/* Means by the weight that the model gives to a distance (rheo_world_weight()). */
static rheo_result probe_values(cli_followed *t, const rheo_world *world, rheo_error *error)
{
    const uint32_t count = rheo_world_particle_count(world);
    const size_t means = t->count - 2;
    rheo_particle_state *p = malloc((count + (size_t)1) * sizeof *p);
    double *own = malloc(means * sizeof *own), *sum = calloc(means, sizeof *sum);
    rheo_result result = p && own && sum ? rheo_world_particles(world, p, error) : RHEO_ERROR_MEMORY;
    double weight = 0, near = 0;
    for (uint32_t i = 0; i < count && result == RHEO_OK; i++) {
        double r2 = 0;
        for (int axis = 0; axis < 3; axis++)
            r2 += (p[i].position[axis] - t->point[axis]) * (p[i].position[axis] - t->point[axis]);
        const double w = rheo_world_weight(world, sqrt(r2));
        if (!(w > 0))
            continue;
        near++;
        weight += w;
        put_quantities(put(own, p[i].velocity, 3), world, &p[i]);
        for (size_t k = 0; k < means; k++)
            sum[k] += w * own[k];
    }
    if (result == RHEO_OK) {
        t->value[0] = near;
        t->value[1] = weight;
        for (size_t k = 0; k < means && weight > 0; k++)
            t->value[2 + k] = sum[k] / weight;
    }
    free(p);
    free(own);
    free(sum);
    return result;
}

rheo_result cli_track_values(cli_followed *t, const rheo_world *world, rheo_error *error)
{
    for (size_t i = 0; i < t->count; i++)
        t->value[i] = NAN;
    switch (t->kind) {
    case CLI_TRACK_PARTICLE:
        return particle_values(t, world, error);
    case CLI_TRACK_SPRING:
        return spring_values(t, world);
    case CLI_TRACK_BALL:
        ball_values(t, world);
        return RHEO_OK;
    case CLI_TRACK_PROBE:
        break;
    }
    return probe_values(t, world, error);
}
