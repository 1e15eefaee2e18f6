/*
 * Queries of the melting model (docs/melting.md, 1 to 5). The sums are those of the stages summation and momentum, in
 * double.
 */
#include "core/quintic.h"
#include "melting/rheology.h"
#include "world/model_melting.h"
#include "world/query_particles.h"

double rheo__melting_weight(const rheo_world *w, double distance)
{
    const rheo__melting *m = w->model;
    return (double)m->kernel_scale * rheo__quintic(distance / m->smoothing_length);
}

/* W'(r)/r. */
static double slope(const rheo_world *w, double distance)
{
    const rheo__melting *m = w->model;
    const double h = m->smoothing_length;
    return (double)m->kernel_scale * rheo__quintic_slope(distance / h) / (h * h);
}

double rheo__melting_density_share(const rheo_world *w, double distance, double *near_share)
{
    *near_share = 0;
    return rheo__melting_mass(&w->def) * rheo__melting_weight(w, distance);
}

/* Whether a particle is closer to a wall than the support; *contact then has its integrals. */
static bool touches(const rheo_world *w, uint32_t id, uint32_t wall, rheo__contact *contact)
{
    const rheo__melting *m = w->model;
    const rheo_real *x = w->state.position + 3 * (size_t)id;
    const rheo_real distance = rheo__plane_distance(&m->planes->plane[wall], x[0], x[1], x[2]);
    if (!(distance < (rheo_real)m->support))
        return false;
    *contact = (rheo__contact){id, wall, distance, rheo__wall_look_up(m, distance), 0, false};
    return true;
}

/* Whether a particle hangs below a wall and is not pressed against it; as in stage momentum. */
static bool is_detached(const rheo_world *w, uint32_t id, const rheo__contact *contact)
{
    const rheo__melting *m = w->model;
    const rheo_real *n = m->planes->plane[contact->wall].normal, *v = w->state.velocity + 3 * (size_t)id;
    const double density = (double)w->state.density[id], c = w->def.melting.sound_speed;
    double fall = 0, speed = 0;
    for (int axis = 0; axis < 3; axis++) {
        fall += (double)n[axis] * w->def.gravity[axis];
        speed += (double)n[axis] * (double)v[axis];
    }
    const double pressure = c * c * (density - w->def.melting.rest_density), approach = speed < 0 ? speed : 0;
    return fall > 0 && !(2 * (pressure - density * c * approach) * (double)contact->integral.gradient -
                             density * fall * (double)contact->integral.moment >
                         0);
}

double rheo__melting_wall_density(const rheo_world *w, uint32_t id)
{
    const rheo__melting *m = w->model;
    double free = 1; /* union of the half spaces behind the walls: 1 - (1 - a)(1 - b) */
    rheo__contact contact;
    for (uint32_t wall = 0; wall < m->planes->count; wall++)
        if (touches(w, id, wall, &contact))
            free *= 1 - (double)contact.integral.weight;
    return w->def.melting.rest_density * (1 - free);
}

/* Sums over neighbours and walls (melting/gradients.c). Rows are the direction of the derivative. */
typedef struct gradient_sums {
    double moment[3][3], velocity[3][3];
} gradient_sums;

/* Adds a (x) b. */
static void add_product(double to[3][3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            to[i][j] += a[i] * b[j];
}

static void add_pair(const rheo_world *w, uint32_t id, uint32_t other, gradient_sums *sums)
{
    const rheo__state *s = &w->state;
    const double factor =
        -rheo__melting_mass(&w->def) / (double)s->density[id] * slope(w, rheo__query_distance(w, id, other));
    double derived[3], offset[3], velocity[3];
    for (size_t axis = 0; axis < 3; axis++) {
        const size_t a = 3 * (size_t)id + axis, b = 3 * (size_t)other + axis;
        offset[axis] = (double)s->position[a] - (double)s->position[b];
        derived[axis] = factor * offset[axis];
        velocity[axis] = (double)s->velocity[a] - (double)s->velocity[b];
    }
    add_product(sums->moment, derived, offset);
    add_product(sums->velocity, derived, velocity);
}

static void add_walls(const rheo_world *w, uint32_t id, gradient_sums *sums)
{
    const rheo__melting *m = w->model;
    rheo__contact contact;
    for (uint32_t wall = 0; wall < m->planes->count && w->def.melting.wall == RHEO_WALL_NO_SLIP; wall++) {
        if (!touches(w, id, wall, &contact) || is_detached(w, id, &contact))
            continue;
        const double inverse_distance = (double)rheo__inverse_wall_distance(m, &contact);
        double derived[3], normal[3], velocity[3];
        for (size_t axis = 0; axis < 3; axis++) {
            normal[axis] = (double)m->planes->plane[wall].normal[axis];
            derived[axis] = (double)contact.integral.shear * normal[axis];
            velocity[axis] = inverse_distance * ((double)w->state.velocity[3 * (size_t)id + axis] -
                                                 (double)m->wall_velocity[wall][axis]);
        }
        add_product(sums->moment, derived, normal);
        add_product(sums->velocity, derived, velocity);
    }
}

static double cofactor(const double t[3][3], int i, int j)
{
    const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return t[a][c] * t[b][d] - t[a][d] * t[b][c];
}
static double determinant(const double t[3][3])
{
    return t[0][0] * cofactor(t, 0, 0) + t[0][1] * cofactor(t, 0, 1) + t[0][2] * cofactor(t, 0, 2);
}

/* sqrt(tr(D^2)/2), D = grad v + (grad v)^T. */
static double intensity(gradient_sums *sums)
{
    const double(*moment)[3] = (const double(*)[3])sums->moment;
    const double missing = RHEO__LEAST_DETERMINANT - determinant(moment);
    for (int i = 0; i < 3 && missing > 0; i++)
        sums->moment[i][i] += missing;
    const double by = 1 / determinant(moment);
    double gradient[3][3] = {{0}}, sum = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                gradient[i][k] += by * cofactor(moment, i, j) * sums->velocity[j][k];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double d = gradient[i][j] + gradient[j][i];
            sum += d * d;
        }
    return __builtin_sqrt(sum / 2);
}

void rheo__melting_query_particle(const rheo_world *w, uint32_t id, const uint32_t *neighbour, size_t count,
                                  rheo_particle_state *state)
{
    const rheo_world_def *def = &w->def;
    const rheo__state *s = &w->state;
    gradient_sums sums = {{{0}}, {{0}}};
    double none;
    state->summed_density = rheo__query_density(w, id, neighbour, count, &none);
    for (size_t k = 0; k < count; k++)
        add_pair(w, id, neighbour[k], &sums);
    add_walls(w, id, &sums);
    state->density = (double)s->density[id];
    state->pressure =
        def->melting.sound_speed * def->melting.sound_speed * (state->density - def->melting.rest_density);
    state->temperature =
        rheo__state_has(s, RHEO__FIELD_temperature) ? (double)s->temperature[id] : def->melting.temperature;
    state->jump_number = rheo__melting_jump(def, state->temperature);
    state->shear_rate = intensity(&sums);
    state->viscosity = rheo__melting_viscosity(def, state->jump_number, state->shear_rate);
    state->displacement = rheo__query_displacement(w, id);
    for (size_t axis = 0; axis < 3; axis++)
        state->start_position[axis] = (double)s->start_position[3 * (size_t)id + axis];
}

const rheo_quantity rheo__melting_quantities[] = {
    RHEO__QUANTITY(position, 3, "L", "position"),
    RHEO__QUANTITY(velocity, 3, "L/T", "velocity"),
    RHEO__QUANTITY(speed, 1, "L/T", "|velocity|"),
    RHEO__QUANTITY(density, 1, "M/L^3", "density rho of the state"),
    RHEO__QUANTITY(summed_density, 1, "M/L^3", "sum of m W over neighbours, the particle itself and walls"),
    RHEO__QUANTITY(pressure, 1, "M/(L T^2)", "c^2 (rho - rho0)"),
    RHEO__QUANTITY(temperature, 1, "K", "temperature"),
    RHEO__QUANTITY(jump_number, 1, "1", "jump number J of the temperature"),
    RHEO__QUANTITY(shear_rate, 1, "1/T", "intensity of D, from the present velocities"),
    RHEO__QUANTITY(viscosity, 1, "M/(L T)", "apparent viscosity at that shear rate"),
    RHEO__QUANTITY(start_position, 3, "L", "position at which the particle began"),
    RHEO__QUANTITY(displacement, 1, "L", "distance from start_position"),
    {NULL, NULL, NULL, 0, 0},
};

const rheo_ranking rheo__melting_rankings[] = {
    {RHEO_TOP_DENSEST, "densest", "density", "M/L^3", "density of the state"},
    {RHEO_TOP_FASTEST, "fastest", "speed", "L/T", "|velocity|"},
    {RHEO_TOP_HOTTEST, "hottest", "temperature", "K", "temperature"},
    {RHEO_TOP_FURTHEST, "furthest", "displacement", "L", "distance from where the particle began"},
    {0, NULL, NULL, NULL, NULL},
};
