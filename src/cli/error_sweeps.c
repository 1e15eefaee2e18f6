/*
 * rheolog bench error, study sweeps: what the order of pairs does. In scheme sequential each pair sees the results of the
 * pairs before it, in an order of cells and ids; in the other schemes all act at once. So a run and that of its image,
 * mirrored, rotated or renumbered, differ; a drop at rest begins to turn; and pressures carry a part of the weight only.
 * All references are 0 or 1.
 */
#include "cli/error_trials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SEQUENTIAL             \
    {                          \
        "scheme", "sequential" \
    }

static const cli_setting SETTINGS[] = {
    {"summed, step/2", "summed", "summed", 2, false, {{NULL}}},
    {"summed, step", "summed", "summed", 1, false, {{NULL}}},
    {"summed, substeps 4", "", "summed", 1, false, {{"substeps", "4"}}},
    {"sequential, step/4", "sequential", "sequential", 4, false, {SEQUENTIAL}},
    {"sequential, step/2", "sequential", "sequential", 2, false, {SEQUENTIAL}},
    {"sequential, step", "sequential", "sequential", 1, false, {SEQUENTIAL}},
    {"implicit, step", "", "sequential", 1, false, {SEQUENTIAL, {"springs.solver", "implicit"}}},
    {"paper, step", "", "paper", 1, false, {SEQUENTIAL, {"history.onset", "0"}}},
    {"positions, step", "", "positions", 1, false, {{"scheme", "positions"}}},
};
enum { SETTING_COUNT = sizeof SETTINGS / sizeof *SETTINGS };

/* ---- Images of a state ---- */

typedef enum change { MIRROR, ROTATION, RENUMBERING, CHANGES } change;

/* Mirrors along x, or turns by 90 degrees about y. */
static void change_vector(change c, double x[3])
{
    const double old = x[0];
    if (c == MIRROR)
        x[0] = -old;
    if (c == ROTATION) {
        x[0] = x[2];
        x[2] = -old;
    }
}

static void change_vectors(change c, const rheo_real *from, rheo_real *to, uint32_t count)
{
    for (size_t i = 0; i < count; i++) {
        const size_t id = c == RENUMBERING ? count - 1 - i : i;
        double x[3] = {(double)from[3 * i], (double)from[3 * i + 1], (double)from[3 * i + 2]};
        change_vector(c, x);
        for (size_t axis = 0; axis < 3; axis++)
            to[3 * id + axis] = (rheo_real)x[axis];
    }
}

static int by_ends(const void *left, const void *right)
{
    const rheo_spring *l = left, *r = right;
    return l->a != r->a ? (l->a > r->a) - (l->a < r->a) : (l->b > r->b) - (l->b < r->b);
}

/* Copies the springs; where particles are renumbered, with the new ids in their order. False: no memory. */
static bool change_springs(change c, const cli_settled *from, cli_settled *to)
{
    const size_t springs = from->def.particles.spring_count;
    const uint32_t last = from->def.particles.count - 1;
    rheo_spring *row = malloc((springs + 1) * sizeof *row);
    to->ends = malloc((2 * springs + 1) * sizeof *to->ends);
    to->rest_length = malloc((springs + 1) * sizeof *to->rest_length);
    const bool room = row && to->ends && to->rest_length;
    for (size_t k = 0; k < springs && room; k++) {
        const uint32_t a = from->ends[2 * k], b = from->ends[2 * k + 1];
        row[k] = c == RENUMBERING ? (rheo_spring){last - b, last - a, from->rest_length[k]}
                                  : (rheo_spring){a, b, from->rest_length[k]};
    }
    if (room)
        qsort(row, springs, sizeof *row, by_ends);
    for (size_t k = 0; k < springs && room; k++) {
        to->ends[2 * k] = row[k].a;
        to->ends[2 * k + 1] = row[k].b;
        to->rest_length[k] = row[k].rest_length;
    }
    free(row);
    return room;
}

/* The image of a settled state. */
static rheo_result change_state(change c, const cli_settled *from, cli_settled *to, rheo_error *error)
{
    const uint32_t n = from->def.particles.count, walls = from->def.walls.count;
    *to = (cli_settled){.def = from->def, .surface = from->surface};
    to->position = malloc(3 * (size_t)n * sizeof *to->position);
    to->velocity = malloc(3 * (size_t)n * sizeof *to->velocity);
    to->wall = malloc((walls + 1) * sizeof *to->wall);
    if (!to->position || !to->velocity || !to->wall || !change_springs(c, from, to)) {
        snprintf(error->message, sizeof error->message, "no memory for the image of %u particles", n);
        return RHEO_ERROR_MEMORY;
    }
    change_vectors(c, from->position, to->position, n);
    change_vectors(c, from->velocity, to->velocity, n);
    for (uint32_t w = 0; w < walls; w++) {
        to->wall[w] = from->wall[w];
        change_vector(c, to->wall[w].point);
        change_vector(c, to->wall[w].normal);
    }
    change_vector(c, to->def.ball.position);
    change_vector(c, to->def.ball.velocity);
    to->def.walls.plane = to->wall;
    to->def.particles.position = to->position;
    to->def.particles.velocity = to->velocity;
    to->def.particles.spring_ends = to->ends;
    to->def.particles.spring_rest_length = to->rest_length;
    return RHEO_OK;
}

/* ---- A run beside those of its images ---- */

/* The images run here; their time does not count. */
typedef struct images {
    rheo_world *world[CHANGES];
} images;

static const double LAST = 3.3; /* time of the last comparison */

/* Root mean square distance of the particles from the images of those of the original run. NaN: no memory. */
static double distance_from_image(const rheo_world *image, const rheo_world *original, change c)
{
    const uint32_t n = rheo_world_particle_count(original);
    const rheo_real *x = rheo_world_positions(image);
    rheo_real *expected = malloc(3 * (size_t)n * sizeof *expected);
    if (!expected)
        return NAN;
    change_vectors(c, rheo_world_positions(original), expected, n);
    double sum = 0;
    for (size_t i = 0; i < 3 * (size_t)n; i++)
        sum += pow((double)(expected[i] - x[i]), 2);
    free(expected);
    return sqrt(sum / n);
}

/* A world of an image, with the setting of the trial. */
static rheo_result create_image(const cli_trial *t, const cli_settled *state, rheo_world **world)
{
    rheo_world_def def = t->def;
    def.particles = state->def.particles;
    def.particles.spring_count = t->def.particles.spring_count;
    def.walls = state->def.walls;
    memcpy(def.ball.position, state->def.ball.position, sizeof def.ball.position);
    memcpy(def.ball.velocity, state->def.ball.velocity, sizeof def.ball.velocity);
    return rheo_world_create(&def, world, t->error);
}

static bool measure_images(cli_trial *t, rheo_world *world)
{
    images *m = t->memory;
    const cli_settled *state = t->of->data;
    const uint64_t step = rheo_world_step_count(world);
    const bool last = rheo_world_time(world) + 0.5 * t->def.step > LAST;
    for (change c = 0; c < CHANGES && t->result == RHEO_OK; c++) {
        t->result = step == 0 ? create_image(t, &state[c], &m->world[c]) : rheo_world_step(m->world[c], t->error);
        if (t->result == RHEO_OK && (step == 1 || last))
            t->quantity[2 * c + (step > 1)] = distance_from_image(m->world[c], world, c);
    }
    return t->result == RHEO_OK && !last;
}

static void finish_images(cli_trial *t)
{
    images *m = t->memory;
    for (int c = 0; c < CHANGES; c++)
        rheo_world_destroy(m->world[c]);
}

/* A ball meets a pool off its middle, in contact from the first step on. */
static int compare_images(cli_bench_arguments *a, cli_error_points *points)
{
    rheo_scene scene;
    cli_settled original = {0}, image[CHANGES] = {{.surface = 0}};
    rheo_error error = {""};
    rheo_result result = cli_pool_scene(&scene, 14, 8, 14, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    scene.world.ball.radius = 4;
    scene.world.ball.velocity[0] = 3;
    scene.world.ball.velocity[1] = -12;
    scene.world.ball.position[0] -= 5;
    scene.ball.clearance = 0;
    result = cli_settle(&original, &scene, a, &error);
    rheo_scene_release(&scene);
    original.def.ball.position[1] -= 1;
    for (change c = 0; c < CHANGES && result == RHEO_OK; c++)
        result = change_state(c, &original, &image[c], &error);
    const cli_case c = {.name = "image",
                        .quantity = {"mirrored_1", "mirrored", "rotated_1", "rotated", "renumbered_1", "renumbered"},
                        .def = original.def,
                        .longest = LAST,
                        .data = image,
                        .bytes = sizeof(images),
                        .measure = measure_images,
                        .finish = finish_images};
    const int status =
        result == RHEO_OK ? cli_try(&c, SETTINGS, SETTING_COUNT, a, points) : cli_error(result, &error);
    for (int k = 0; k < CHANGES; k++)
        cli_settled_release(&image[k]);
    cli_settled_release(&original);
    return status;
}

/* ---- A free drop ---- */

static const double TURNS = 33; /* time after which its spin is measured */

/* A motion that all share adds nothing to the momentum about the centre of mass. */
double cli_spin(const rheo_world *world)
{
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    const uint32_t n = rheo_world_particle_count(world);
    double c[3] = {0}, moment[3] = {0}, inertia = 0;
    for (size_t i = 0; i < 3 * (size_t)n; i++)
        c[i % 3] += (double)x[i] / n;
    for (size_t i = 0; i < n; i++) {
        const rheo_real *own = v + 3 * i;
        double d[3];
        for (size_t axis = 0; axis < 3; axis++) {
            d[axis] = (double)x[3 * i + axis] - c[axis];
            inertia += d[axis] * d[axis] * 2 / 3; /* nearly a ball: the same about every axis */
        }
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
            moment[axis] += d[next] * (double)own[last] - d[last] * (double)own[next];
        }
    }
    return sqrt(moment[0] * moment[0] + moment[1] * moment[1] + moment[2] * moment[2]) / inertia;
}

static bool measure_spin(cli_trial *t, rheo_world *world)
{
    if (rheo_world_time(world) + 0.5 * t->def.step < TURNS)
        return true;
    t->quantity[0] = cli_spin(world);
    return false;
}

static int turn_drop(cli_bench_arguments *a, cli_error_points *points)
{
    static const rheo_fill sphere = {.kind = RHEO_FILL_SPHERE, .radius = 11, .jitter = 0.1};
    rheo_scene scene = rheo_default_scene();
    scene.fill = &sphere;
    scene.fill_count = 1;
    scene.settle.time = 6;
    scene.world.gravity[1] = 0;
    cli_settled from = {0};
    rheo_error error = {""};
    const rheo_result result = cli_settle(&from, &scene, a, &error);
    const cli_case c = {
        .name = "free-drop", .quantity = {"spin"}, .def = from.def, .longest = TURNS + 0.1, .measure = measure_spin};
    const int status =
        result == RHEO_OK ? cli_try(&c, SETTINGS, SETTING_COUNT, a, points) : cli_error(result, &error);
    cli_settled_release(&from);
    return status;
}

/* ---- All cases ---- */

static int hydrostatics(cli_bench_arguments *a, cli_error_points *points)
{
    return cli_hydrostatics(SETTINGS, SETTING_COUNT, a, points);
}

int cli_error_sweeps(cli_bench_arguments *a, cli_error_points *points)
{
    static const cli_named_case cases[] = {
        {"image", compare_images}, {"free-drop", turn_drop}, {"hydrostatics", hydrostatics}};
    return cli_try_cases(cases, sizeof cases / sizeof *cases, a, points);
}
