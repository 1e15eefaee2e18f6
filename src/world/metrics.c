/*
 * Metrics: what is measured at every step, whether it is recorded or not; the signs by which a run that goes bad is
 * known (record/doctor.c) are among them. They are no state: nothing is computed from them.
 */
#include "world/world.h"

#include <stddef.h>
#include <string.h>

#include "solids/solids.h"
#include "thickening/thickening.h"

static const struct {
    const char *name;
    size_t offset;
} TABLE[] = {
#define X(name) {#name, offsetof(rheo_metrics, name)},
    RHEO_METRICS(X)
#undef X
};
enum { MEASURED = sizeof TABLE / sizeof *TABLE };

static const char *const BALL[] = {"ball_x",  "ball_y",      "ball_z",      "ball_vx",    "ball_vy",
                                   "ball_vz", "ball_spin_x", "ball_spin_y", "ball_spin_z"};
enum { BALL_METRICS = sizeof BALL / sizeof *BALL };

double rheo_world_mean_neighbours(const rheo_world *w)
{
    return w->metrics.neighbours;
}

uint32_t rheo_world_metric_count(const rheo_world *w)
{
    return MEASURED + (w->state.bodies ? BALL_METRICS : 0);
}

const char *rheo_world_metric_name(const rheo_world *w, uint32_t index)
{
    if (index >= rheo_world_metric_count(w))
        return NULL;
    return index < MEASURED ? TABLE[index].name : BALL[index - MEASURED];
}

static double metric(const rheo_world *w, const rheo_metrics *m, uint32_t index)
{
    if (index >= rheo_world_metric_count(w))
        return 0;
    if (index < MEASURED) {
        double value;
        memcpy(&value, (const char *)m + TABLE[index].offset, sizeof value);
        return value;
    }
    const rheo_real *const vector[] = {w->state.ball_position, w->state.ball_velocity, w->state.ball_spin};
    index -= MEASURED;
    return (double)vector[index / 3][index % 3];
}

double rheo_world_metric(const rheo_world *w, uint32_t index)
{
    return metric(w, &w->metrics, index);
}

double rheo_world_failed_metric(const rheo_world *w, uint32_t index)
{
    return metric(w, &w->failed_metrics, index);
}

void rheo_world_restore_metric(rheo_world *w, const char *name, double value)
{
    for (size_t i = 0; i < MEASURED; i++)
        if (strcmp(name, TABLE[i].name) == 0)
            memcpy((char *)&w->metrics + TABLE[i].offset, &value, sizeof value);
}

/* ---- Measuring ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Kinetic energy of the ball and its energy in the field of gravity. */
static double ball_energy(const rheo_world *w)
{
    rheo_body ball;
    rheo_world_body(w, 0, &ball);
    return ball.mass *
           (0.5 * dot(ball.velocity, ball.velocity) + 0.2 * ball.radius * ball.radius * dot(ball.spin, ball.spin) -
            dot(w->def.gravity, ball.position));
}

static void measure_particles(const rheo_world *w, rheo_metrics *m)
{
    const rheo_state *s = &w->state;
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
    m->kinetic_energy = 0.5 * energy;
    m->energy = m->kinetic_energy - dot(w->def.gravity, centre);
    if (s->particles == 0)
        return;
    m->max_speed = __builtin_sqrt(fastest);
    m->centre_x = centre[0] / s->particles;
    m->centre_y = centre[1] / s->particles;
    m->centre_z = centre[2] / s->particles;
}

/* What stages have found on their way. */
static void take_from_stages(const rheo_world *w, rheo_metrics *m)
{
    const struct rheo_thickening *t = w->thickening;
    m->neighbours = t->found.mean_neighbours;
    m->stiffness_number = t->found.stiffness_number;
    m->stiffness_a = t->found.stiffest[0];
    m->stiffness_b = t->found.stiffest[1];
    m->stiffness_sum = t->found.largest_stiffness_sum;
    m->stiffness_sum_id = t->found.stiffest_particle;
    m->density_error = t->found.density_error;
    m->max_density = t->found.largest_density;
    m->max_density_id = t->found.densest_particle;
}

/* What can be measured of a state that no step has led to. */
static void measure_state(const rheo_world *w, rheo_metrics *m)
{
    m->step = (double)*w->state.step;
    m->time = rheo_world_time(w);
    measure_particles(w, m);
    if (w->state.bodies)
        m->energy += ball_energy(w);
    m->courant = m->max_speed * w->def.step / w->def.fluid.support;
    m->springs = (double)rheo_world_spring_count(w);
}

void rheo_world_measure(rheo_world *w)
{
    w->metrics = (rheo_metrics){.max_speed_id = -1};
    measure_state(w, &w->metrics);
    take_from_stages(w, &w->metrics);
}

void rheo_world_measure_commands(rheo_world *w)
{
    measure_state(w, &w->metrics);
}

void rheo_world_measure_failure(rheo_world *w)
{
    w->failed_metrics = w->metrics;
    take_from_stages(w, &w->failed_metrics);
    w->failed_metrics.step += 1;
    w->failed_metrics.time += w->def.step;
}

void rheo_world_measure_step(rheo_world *w)
{
    double before = w->metrics.energy, motion = w->metrics.kinetic_energy;
    rheo_world_measure(w);
    const double *g = w->def.gravity;
    /* Against the energy of motion; that of a fluid at rest is next to nothing, so against falling a spacing, too. */
    double scale = motion + w->state.particles * __builtin_sqrt(dot(g, g)) * w->def.fluid.spacing;
    w->metrics.energy_jump = scale > 0 ? (w->metrics.energy - before) / scale : 0;
}
