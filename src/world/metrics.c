/*
 * Metrics: what is measured at every step, whether it is recorded or not; the signs by which a run that goes bad is
 * known (record/doctor.c) are among them. They are no state: nothing is computed from them.
 */
#include "world/world.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "world/model_melting.h"
#include "solids/solids.h"
#include "world/model_thickening.h"

static const struct {
    const char *name;
    size_t offset;
    uint32_t models;
} TABLE[] = {
#define X(name, models) {#name, offsetof(rheo__metrics, name), models},
    RHEO__METRICS(X)
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

/* Lines of the table that a world has; and of its index-th one the place, or MEASURED. */
static uint32_t measured(const rheo_world *w)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < MEASURED; i++)
        count += TABLE[i].models >> w->def.model & 1;
    return count;
}
static uint32_t place(const rheo_world *w, uint32_t index)
{
    uint32_t i = 0;
    for (; i < MEASURED; i++)
        if ((TABLE[i].models >> w->def.model & 1) && index-- == 0)
            break;
    return i;
}

uint32_t rheo_world_metric_count(const rheo_world *w)
{
    return measured(w) + (w->state.bodies ? BALL_METRICS : 0);
}

const char *rheo_world_metric_name(const rheo_world *w, uint32_t index)
{
    if (index >= rheo_world_metric_count(w))
        return NULL;
    return index < measured(w) ? TABLE[place(w, index)].name : BALL[index - measured(w)];
}

static double metric(const rheo_world *w, const rheo__metrics *m, uint32_t index)
{
    const uint32_t at = place(w, index);
    if (at < MEASURED) {
        double value;
        memcpy(&value, (const char *)m + TABLE[at].offset, sizeof value);
        return value;
    }
    if (index >= rheo_world_metric_count(w))
        return 0;
    const rheo_real *const vector[] = {w->state.ball_position, w->state.ball_velocity, w->state.ball_spin};
    index -= measured(w);
    return (double)vector[index / 3][index % 3];
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

/* ---- Of the melting model ---- */

/* A sum over particles, and how many they were. */
typedef struct mean {
    double sum[3];
    uint32_t count;
} mean;

/* Where an object began: the height of its underside, and its own, half a spacing beyond its outermost particles. */
static double object_height(const rheo_world *w, double *base)
{
    const rheo__state *s = &w->state;
    double low = 0, high = 0;
    for (uint32_t i = 0; i < s->particles; i++) {
        const double y = (double)s->start_position[3 * (size_t)i + 1];
        low = i == 0 || y < low ? y : low;
        high = i == 0 || y > high ? y : high;
    }
    *base = low - w->def.fluid.spacing / 2;
    return high - low + w->def.fluid.spacing;
}

/* Hot is what began in the upper three tenths, cold what began below 0.35; lengths are in heights of the object. */
static void measure_melting(const rheo_world *w, rheo__metrics *m)
{
    const rheo__state *s = &w->state;
    double base, height = object_height(w, &base), displaced = 0, heat = 0;
    mean hot = {{0, 0, 0}, 0}, cold = {{0, 0, 0}, 0};
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo_real *x = s->position + 3 * (size_t)i, *start = s->start_position + 3 * (size_t)i;
        const double from = ((double)start[1] - base) / height;
        heat += s->temperature ? (double)s->temperature[i] : w->def.melting.temperature;
        mean *of = from > 0.7 ? &hot : from < 0.35 ? &cold : NULL;
        if (!of)
            continue;
        of->count++;
        double moved[3];
        for (int axis = 0; axis < 3; axis++) {
            of->sum[axis] += (double)x[axis];
            moved[axis] = (double)x[axis] - (double)start[axis];
        }
        displaced += of == &cold ? __builtin_sqrt(dot(moved, moved)) : 0;
    }
    m->heat = rheo__def_mass(&w->def) * heat;
    double spread = 0, centre[3] = {0, 0, 0};
    for (int axis = 0; axis < 3 && hot.count; axis++)
        centre[axis] = hot.sum[axis] / hot.count;
    for (uint32_t i = 0; i < s->particles && hot.count; i++) {
        if (!(((double)s->start_position[3 * (size_t)i + 1] - base) / height > 0.7))
            continue;
        const double x = (double)s->position[3 * (size_t)i] - centre[0],
                     z = (double)s->position[3 * (size_t)i + 2] - centre[2];
        spread += x * x + z * z;
    }
    m->hot_height = hot.count ? (centre[1] - base) / height : 0;
    m->hot_spread = hot.count ? __builtin_sqrt(spread / hot.count) / height : 0;
    m->cold_height = cold.count ? (cold.sum[1] / cold.count - base) / height : 0;
    m->cold_displacement = cold.count ? displaced / cold.count / height : 0;
    m->substeps = (double)*s->substeps;
    m->iterations = (double)*s->iterations;
}

/* What stages have found on their way. */
static void take_from_stages(const rheo_world *w, rheo__metrics *m)
{
    if (rheo__melting_of(w)) {
        const rheo__melting_diagnostics *found = &rheo__melting_of(w)->diagnostics;
        m->neighbours = found->mean_neighbours;
        m->density_error = found->density_error;
        m->max_density_error = found->max_density_error;
        m->max_density_id = found->max_density_id;
        return;
    }
    const struct rheo__thickening *t = rheo__thickening_of(w);
    m->neighbours = t->diagnostics.mean_neighbours;
    m->stiffness_number = t->diagnostics.stiffness_number;
    m->stiffness_a = t->diagnostics.stiffest[0];
    m->stiffness_b = t->diagnostics.stiffest[1];
    m->stiffness_sum = t->diagnostics.largest_stiffness_sum;
    m->stiffness_sum_id = t->diagnostics.stiffest_particle;
    m->max_spring_displacement = t->diagnostics.max_spring_displacement.length / w->def.fluid.support;
    m->max_spring_displacement_id = t->diagnostics.max_spring_displacement.id;
    m->max_pressure_displacement = t->diagnostics.max_pressure_displacement.length / w->def.fluid.support;
    m->max_pressure_displacement_id = t->diagnostics.max_pressure_displacement.id;
    m->density_error = t->diagnostics.density_error;
    m->max_density = t->diagnostics.largest_density;
    m->max_density_id = t->diagnostics.densest_particle;
}

/* What can be measured of a state that no step has led to. */
static void measure_state(const rheo_world *w, rheo__metrics *m)
{
    m->step = (double)*w->state.step;
    m->time = rheo_world_time(w);
    measure_particles(w, m);
    if (w->state.bodies)
        m->energy += ball_energy(w);
    m->courant_number = m->max_speed * w->def.step / rheo__def_support(&w->def);
    if (rheo__melting_of(w))
        measure_melting(w, m);
    m->springs = (double)rheo_world_spring_count(w);
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
    /* Against the energy of motion; that of a fluid at rest is next to nothing, so against falling a spacing, too. */
    double scale =
        motion + rheo__def_mass(&w->def) * w->state.particles * __builtin_sqrt(dot(g, g)) * w->def.fluid.spacing;
    w->metrics.energy_jump = scale > 0 ? (w->metrics.energy - before) / scale : 0;
}

void rheo__world_keep_diagnostics(rheo_world *w)
{
    if (rheo__thickening_of(w))
        rheo__thickening_of(w)->diagnostics_before = rheo__thickening_of(w)->diagnostics;
    if (rheo__melting_of(w))
        rheo__melting_of(w)->diagnostics_before = rheo__melting_of(w)->diagnostics;
}

void rheo__world_restore_diagnostics(rheo_world *w)
{
    if (rheo__thickening_of(w))
        rheo__thickening_of(w)->diagnostics = rheo__thickening_of(w)->diagnostics_before;
    if (rheo__melting_of(w))
        rheo__melting_of(w)->diagnostics = rheo__melting_of(w)->diagnostics_before;
}

void rheo__world_describe_failure(const rheo_world *w, char *text, size_t size)
{
    const rheo__metrics *m = &w->failed_metrics;
    if (rheo__melting_of(w)) {
        int used = 0;
        text[0] = 0;
        if (m->max_density_id >= 0)
            used = snprintf(text, size, " The largest error of density was %.3g (particle %.0f).",
                            m->max_density_error, m->max_density_id);
        snprintf(text + used, size - (size_t)used, " %s may help",
                 w->def.melting.substeps ? "More melting.substeps" : "A smaller melting.courant_number");
        return;
    }
    int length = 0;
    if (m->stiffness_a >= 0)
        length = snprintf(text, size, " The stiffness number was %.3g (spring %.0f:%.0f).", m->stiffness_number,
                          m->stiffness_a, m->stiffness_b);
    if (m->max_density_id >= 0)
        length += snprintf(text + length, size - (size_t)length,
                           " The largest density was %.3g times that at rest (particle %.0f).", m->max_density,
                           m->max_density_id);
    snprintf(text + length, size - (size_t)length, " A smaller step may help%s",
             m->stiffness_number > 1 ? ", or softer springs, or springs.solver implicit" : "");
}
