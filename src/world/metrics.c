/*
 * Metrics: numbers about the state and diagnostics of the stages, measured at every step, recorded or not. They are
 * not state: no step reads them. record/doctor.c judges the health of a run by them.
 */
#include "world/model.h"

#include <assert.h>
#include <string.h>

#include "solids/solids.h"

/* Rows of the metrics that any model may have, in the order of their members in rheo__metrics. */
static const rheo_metric_info COMMON[] = {
#define X(name, unit, meaning) {#name, unit, meaning},
    RHEO__COMMON_METRICS(X)
#undef X
};
_Static_assert(sizeof COMMON / sizeof *COMMON * sizeof(double) == offsetof(rheo__metrics, own),
               "common metrics come first in rheo__metrics");

/* Those of each ball: vectors, then one number. */
#define OF_BALL(name, ball)                                                                             \
    {name "_x", "L", "position of " ball ", x"}, {name "_y", "L", "position of " ball ", y"},           \
        {name "_z", "L", "position of " ball ", z"}, {name "_vx", "L/T", "velocity of " ball ", x"},    \
        {name "_vy", "L/T", "velocity of " ball ", y"}, {name "_vz", "L/T", "velocity of " ball ", z"}, \
        {name "_spin_x", "1/T", "angular velocity of " ball ", x"},                                     \
        {name "_spin_y", "1/T", "angular velocity of " ball ", y"},                                     \
        {name "_spin_z", "1/T", "angular velocity of " ball ", z"},                                     \
        {name "_max_speed", "L/T", "largest speed of " ball " in the substeps, before contact"},
#define OF_FURTHER(number) OF_BALL("ball" #number, "ball " #number)
enum { BALL_METRICS = 10, BALL_MAX_SPEED = BALL_METRICS - 1 };
static const rheo_metric_info BALL[RHEO_MAX_BALLS * BALL_METRICS] = {
    OF_BALL("ball", "the ball") OF_FURTHER(2) OF_FURTHER(3) OF_FURTHER(4) OF_FURTHER(5) OF_FURTHER(6) OF_FURTHER(7)
        OF_FURTHER(8) OF_FURTHER(9) OF_FURTHER(10) OF_FURTHER(11) OF_FURTHER(12) OF_FURTHER(13) OF_FURTHER(14)
            OF_FURTHER(15) OF_FURTHER(16)};

static const rheo_metric_info *info_of(const rheo__metric *row)
{
    assert(row->offset < sizeof(rheo__metrics));
    return row->offset < offsetof(rheo__metrics, own) ? &COMMON[row->offset / sizeof(double)] : &row->info;
}

double rheo_world_mean_neighbours(const rheo_world *w)
{
    return w->metrics.neighbours;
}

uint32_t rheo_world_metric_count(const rheo_world *w)
{
    return w->type->metric_count + w->state.bodies * BALL_METRICS;
}

const rheo_metric_info *rheo_world_metric_info(const rheo_world *w, uint32_t index)
{
    if (index >= rheo_world_metric_count(w))
        return NULL;
    return index < w->type->metric_count ? info_of(&w->type->metrics[index]) : &BALL[index - w->type->metric_count];
}

const char *rheo_world_metric_name(const rheo_world *w, uint32_t index)
{
    const rheo_metric_info *info = rheo_world_metric_info(w, index);
    return info ? info->name : NULL;
}

static double metric(const rheo_world *w, const rheo__metrics *m, uint32_t index)
{
    if (index < w->type->metric_count) {
        double value;
        memcpy(&value, (const char *)m + w->type->metrics[index].offset, sizeof value);
        return value;
    }
    if (index >= rheo_world_metric_count(w))
        return 0;
    const rheo_real *const vector[] = {w->state.ball_position, w->state.ball_velocity, w->state.ball_spin};
    index -= w->type->metric_count;
    const uint32_t ball = index / BALL_METRICS, of_ball = index % BALL_METRICS;
    if (of_ball == BALL_MAX_SPEED)
        return m->ball_max_speed[ball];
    return (double)vector[of_ball / 3][3 * (size_t)ball + of_ball % 3];
}

double rheo_world_metric(const rheo_world *w, uint32_t index)
{
    return metric(w, &w->metrics, index);
}

double rheo__world_failed_metric(const rheo_world *w, uint32_t index)
{
    return metric(w, &w->failed_metrics, index);
}

void rheo__world_restore_metric(rheo_world *w, const char *name, double value)
{
    for (uint32_t i = 0; i < w->type->metric_count; i++) {
        const rheo__metric *row = &w->type->metrics[i];
        if (strcmp(name, info_of(row)->name) == 0)
            memcpy((char *)&w->metrics + row->offset, &value, sizeof value);
    }
    for (uint32_t i = 0; i < w->state.bodies; i++)
        if (strcmp(name, BALL[i * BALL_METRICS + BALL_MAX_SPEED].name) == 0)
            w->metrics.ball_max_speed[i] = value;
}

/* ---- Measuring ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Kinetic and potential energy of a ball. */
static double ball_energy(const rheo_world *w, uint32_t index)
{
    rheo_body ball;
    rheo_world_body(w, index, &ball);
    return ball.mass *
           (0.5 * dot(ball.velocity, ball.velocity) + 0.2 * ball.radius * ball.radius * dot(ball.spin, ball.spin) -
            dot(w->def.gravity, ball.position));
}

static void measure_particles(const rheo_world *w, rheo__metrics *m)
{
    const rheo__state *s = &w->state;
    const double mass = rheo__def_mass(&w->def);
    double energy = 0, fastest = -1, centre[3] = {0, 0, 0};
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo_real *v = s->velocity + 3 * (size_t)i, *x = s->position + 3 * (size_t)i;
        double vx = (double)v[0], vy = (double)v[1], vz = (double)v[2];
        double speed2 = vx * vx + vy * vy + vz * vz;
        energy += speed2;
        if (speed2 > fastest) {
            fastest = speed2;
            m->max_speed_id = i;
        }
        centre[0] += (double)x[0];
        centre[1] += (double)x[1];
        centre[2] += (double)x[2];
    }
    m->kinetic_energy = 0.5 * mass * energy;
    m->energy = m->kinetic_energy - mass * dot(w->def.gravity, centre);
    if (s->particles == 0)
        return;
    m->max_speed = __builtin_sqrt(fastest);
    m->centre_x = centre[0] / s->particles;
    m->centre_y = centre[1] / s->particles;
    m->centre_z = centre[2] / s->particles;
}

/* Measures the metrics that depend only on the state, not on the step that led to it. */
static void measure_state(const rheo_world *w, rheo__metrics *m)
{
    m->step = (double)*w->state.step;
    m->time = rheo_world_time(w);
    measure_particles(w, m);
    for (uint32_t i = 0; i < w->state.bodies; i++)
        m->energy += ball_energy(w, i);
    m->courant_number = m->max_speed * w->def.step / rheo__def_support(&w->def);
    if (w->type->measure_state)
        w->type->measure_state(w, m);
}

static void take_from_stages(const rheo_world *w, rheo__metrics *m)
{
    memcpy(m->ball_max_speed, w->solids->ball_max_speed, sizeof m->ball_max_speed);
    if (w->type->measure_stages)
        w->type->measure_stages(w, m);
}

void rheo__world_measure(rheo_world *w)
{
    w->metrics = (rheo__metrics){.max_speed_id = -1};
    measure_state(w, &w->metrics);
    take_from_stages(w, &w->metrics);
}

void rheo__world_measure_commands(rheo_world *w)
{
    measure_state(w, &w->metrics);
}

void rheo__world_measure_failure(rheo_world *w)
{
    w->failed_metrics = w->metrics;
    take_from_stages(w, &w->failed_metrics);
    w->failed_metrics.step += 1;
    w->failed_metrics.time += w->def.step;
}

void rheo__world_measure_step(rheo_world *w)
{
    double before = w->metrics.energy, motion = w->metrics.kinetic_energy;
    rheo__world_measure(w);
    const double *g = w->def.gravity;
    /* Relative to the kinetic energy, which is nearly 0 in a fluid at rest; so the fall by a spacing is added. */
    double scale =
        motion + rheo__def_mass(&w->def) * w->state.particles * __builtin_sqrt(dot(g, g)) * w->def.fluid.spacing;
    w->metrics.energy_jump = scale > 0 ? (w->metrics.energy - before) / scale : 0;
}

void rheo__world_keep_diagnostics(rheo_world *w)
{
    memset(w->solids->ball_max_speed, 0, sizeof w->solids->ball_max_speed);
    if (w->type->keep_diagnostics)
        w->type->keep_diagnostics(w);
}

void rheo__world_restore_diagnostics(rheo_world *w)
{
    memset(w->solids->ball_max_speed, 0, sizeof w->solids->ball_max_speed);
    if (w->type->restore_diagnostics)
        w->type->restore_diagnostics(w);
}

void rheo__world_describe_failure(const rheo_world *w, char *text, size_t size)
{
    if (w->type->describe_failure)
        w->type->describe_failure(w, text, size);
}
