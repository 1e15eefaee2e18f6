/* The block of `rheolog rheometer` (rheometer_block.h): making it, and shearing it step by step. */
#include "cli/rheometer_block.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- The block ---- */

static double derived_of(const rheo_world_def *def, const char *name)
{
    rheo_derived derived;
    for (uint32_t i = 0; rheo_world_def_derived(def, i, &derived); i++)
        if (strcmp(derived.name, name) == 0)
            return derived.value;
    return NAN;
}

/* Particles along x and z, and along y between the plates. */
static void counts_of(const cli_measurement *m, double support, double spacing, int count[3], int *plate)
{
    /* Space may not be so narrow that a particle meets an image of itself: docs/model.md. */
    const int least = (int)ceil(2.6 * support / spacing);
    count[0] = count[2] = m->small || least > 8 ? least : 8;
    count[1] = m->small ? 6 : 8;
    *plate = (int)ceil(support / spacing);
}

/* Replaces shapes, walls, ball and vibrators by the block. */
static rheo_result make_scene(const cli_measurement *m, cli_block *b, rheo_error *error)
{
    rheo_scene *s = &b->scene;
    *s = m->scene;
    memset(&s->owned, 0, sizeof s->owned);
    rheo_world_def *def = &s->world;
    s->fill_count = 0;
    s->fill = NULL;
    s->particles = 0;
    s->ball.clearance = -1;
    def->walls.count = def->vibrators.count = 0;
    def->walls.plane = NULL;
    def->vibrators.position = NULL;
    def->ball.radius = 0;
    memset(def->gravity, 0, sizeof def->gravity);
    memset(&def->plates, 0, sizeof def->plates);
    memset(&def->particles, 0, sizeof def->particles);
    b->density = def->fluid.number_density > 0 ? def->fluid.number_density : derived_of(def, "number_density");
    if (!(b->density > 0))
        b->density = 1 / (def->fluid.spacing * def->fluid.spacing * def->fluid.spacing);
    /* A scene with a resolution divides its lengths by it when its world is created. */
    const double finer = s->resolution, spacing = cbrt(1 / b->density) / finer, support = def->fluid.support / finer;
    b->density *= finer * finer * finer;
    int count[3], plate;
    counts_of(m, support, spacing, count, &plate);
    rheo_fill fill = {.kind = RHEO_FILL_BLOCK, .jitter = .3};
    for (int axis = 0; axis < 3; axis++)
        fill.max[axis] = (count[axis] + (axis == 1 ? 2 * plate : 0)) * spacing;
    def->fluid.spacing = spacing * finer;
    s->settle.time = (m->small ? 100 : 300) * def->step;
    s->settle.damping = .1 / def->step;
    s->settle.fraction = .7;
    b->step = def->step;
    b->area = fill.max[0] * fill.max[2];
    char period[112], side[3][32];
    for (int axis = 0; axis < 3; axis++)
        rheo_number_text(fill.max[axis], side[axis]);
    snprintf(period, sizeof period, "[%s, %s, %s]", side[0], side[1], side[2]);
    b->height = fill.max[1];
    b->lower = plate * spacing;
    b->upper = (plate + count[1]) * spacing;
    b->gap = b->upper - b->lower;
    const rheo_result result = rheo_scene_add_fill(s, &fill, error);
    return result == RHEO_OK ? rheo_scene_set(s, "space.period", period, error) : result;
}

int cli_block_make(const cli_measurement *m, cli_block *b)
{
    rheo_error error = {""};
    *b = (cli_block){0};
    rheo_result result = make_scene(m, b, &error);
    cli_watch_name(m->scene_name);
    if (result == RHEO_OK)
        result = rheo_scene_create_world(&b->scene, &b->rest, &error);
    cli_watch_name(NULL);
    if (result != RHEO_OK)
        return cli_fail(cli_code(result), "the block of %s: %s", m->scene_name, error.message);
    const rheo_world_def *def = rheo_world_definition(b->rest);
    b->shear_modulus = derived_of(def, "shear_modulus");
    b->history_modulus = derived_of(def, "history_modulus");
    b->yield_stress = derived_of(def, "yield_stress");
    b->viscosity = derived_of(def, "viscosity");
    const double plastic = derived_of(def, "plastic_viscosity");
    const double all = (b->viscosity > 0 ? b->viscosity : 0) + (plastic > 0 ? plastic : 0);
    b->diffusion_time = all > 0 ? b->gap * b->gap / (10 * all) : 0;
    return CLI_DONE;
}

void cli_block_release(cli_block *b)
{
    rheo_world_destroy(b->rest);
    rheo_scene_release(&b->scene);
    *b = (cli_block){0};
}

int cli_block_measure(cli_measurement *m, int (*measure)(cli_measurement *m, const cli_block *b))
{
    cli_block b;
    int status = cli_block_make(m, &b);
    if (status == CLI_DONE)
        status = measure(m, &b);
    cli_block_release(&b);
    return status;
}

size_t cli_block_steps(const cli_block *b, double time)
{
    const double steps = floor(time / b->step + .5);
    return steps < 1 ? 1 : (size_t)steps;
}

double cli_block_rate(const cli_block *b)
{
    const double alpha = rheo_world_definition(b->rest)->springs.plasticity;
    return fmin(alpha > 0 ? alpha / 4 : .03 / b->step, .1 / b->step);
}

double cli_block_omega(const cli_block *b)
{
    /* Fluid without springs is a soft solid itself, of about the modulus of the springs by default: docs/model.md. */
    return b->shear_modulus > 0 ? .5 * sqrt(2 * b->shear_modulus) / b->gap : cli_block_rate(b);
}

double cli_block_most_rate(const cli_block *b)
{
    return rheo_world_definition(b->rest)->fluid.support / (4 * b->gap * b->step);
}

/* ---- Shearing ---- */

/* Arrays of a copy. */
struct copy {
    rheo_real *position, *velocity;
    rheo_spring *spring;
    uint32_t *ends;
    rheo_real *length;
};

/* Makes the copy in these arrays. */
static rheo_result fill_copy(const cli_block *b, const char *control, double rate, struct copy *c, rheo_world **world,
                             rheo_error *error)
{
    rheo_world_def def = *rheo_world_definition(b->rest);
    const uint32_t particles = rheo_world_particle_count(b->rest);
    const size_t springs = rheo_world_spring_count(b->rest);
    rheo_result result = rheo_world_springs(b->rest, c->spring, springs);
    uint32_t kept = 0;
    if (result != RHEO_OK)
        return result;
    memcpy(c->position, rheo_world_positions(b->rest), 3 * (size_t)particles * sizeof *c->position);
    for (uint32_t i = 0; i < particles; i++) {
        rheo_real *y = &c->position[3 * (size_t)i + 1];
        *y -= (rheo_real)(b->height * floor((double)*y / b->height));
        c->velocity[3 * (size_t)i] = (rheo_real)(rate * fmin(fmax((double)*y - b->lower, 0), b->gap));
    }
    for (size_t i = 0; i < springs; i++) {
        const rheo_spring *one = &c->spring[i];
        const double rise = (double)c->position[3 * (size_t)one->a + 1] - (double)c->position[3 * (size_t)one->b + 1];
        if (fabs(rise) > b->height / 2) /* it went around; now the space ends there */
            continue;
        c->ends[2 * kept] = one->a;
        c->ends[2 * kept + 1] = one->b;
        c->length[kept++] = one->rest_length;
    }
    def.particles.count = particles;
    def.particles.position = c->position;
    def.particles.velocity = c->velocity;
    def.particles.spring_count = kept;
    def.particles.spring_ends = c->ends;
    def.particles.spring_rest_length = c->length;
    def.space.period[1] = 0;
    def.plates.lower = b->lower;
    def.plates.upper = b->upper;
    def.plates.velocity[0] = rate * b->gap;
    result = rheo_world_def_set(&def, "plates.control", control, error);
    return result == RHEO_OK ? rheo_world_create(&def, world, error) : result;
}

/* A copy of the block at rest, cut at its middle heights into plates and fluid, with the velocities of a uniform shear. */
static rheo_result copy_of(const cli_block *b, const char *control, double rate, rheo_world **world,
                           rheo_error *error)
{
    const size_t particles = rheo_world_particle_count(b->rest), springs = rheo_world_spring_count(b->rest);
    struct copy c = {calloc(3 * particles + 1, sizeof *c.position), calloc(3 * particles + 1, sizeof *c.velocity),
                     calloc(springs + 1, sizeof *c.spring), calloc(2 * springs + 1, sizeof *c.ends),
                     calloc(springs + 1, sizeof *c.length)};
    rheo_result result = RHEO_ERROR_MEMORY;
    if (c.position && c.velocity && c.spring && c.ends && c.length)
        result = fill_copy(b, control, rate, &c, world, error);
    free(c.position);
    free(c.velocity);
    free(c.spring);
    free(c.ends);
    free(c.length);
    return result;
}

int cli_shear_begin(cli_shear *s, const cli_block *b, cli_measurement *m, const char *name, const char *control,
                    double rate)
{
    rheo_error error = {"no memory for a copy of the block"};
    *s = (cli_shear){.block = b, .measurement = m, .name = name};
    rheo_result result = copy_of(b, control, rate, &s->world, &error);
    /* Plates begin to move in the first step, whose viscosity still sees them at rest. */
    if (result == RHEO_OK && rate > 0)
        result = rheo_world_step(s->world, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

void cli_shear_release(cli_shear *s)
{
    rheo_world_destroy(s->world);
    free(s->time);
    free(s->strain);
    free(s->stress);
    free(s->unbalance);
    *s = (cli_shear){0};
}

int cli_shear_set(cli_shear *s, const char *path, bool vector, double value)
{
    char number[32], text[64];
    rheo_error error = {""};
    rheo_number_text(value, number);
    snprintf(text, sizeof text, vector ? "[%s, 0, 0]" : "%s", number);
    const rheo_result result = rheo_world_set(s->world, path, text, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_shear_ramp(cli_shear *s, double from, double to, size_t steps)
{
    int status = CLI_DONE;
    for (size_t i = 1; i <= steps && status == CLI_DONE; i++) {
        const double rate = from + (to - from) * (double)i / (double)steps;
        status = cli_shear_set(s, "plates.velocity", true, rate * s->block->gap);
        if (status == CLI_DONE)
            status = cli_shear_run(s, 1);
    }
    return status;
}

static bool has_room(cli_shear *s, size_t more)
{
    if (s->samples + more <= s->capacity)
        return true;
    const size_t capacity = 2 * (s->samples + more);
    double **const array[] = {&s->time, &s->strain, &s->stress, &s->unbalance};
    for (int i = 0; i < 4; i++) {
        double *grown = realloc(*array[i], capacity * sizeof *grown);
        if (!grown)
            return false;
        *array[i] = grown;
    }
    s->capacity = capacity;
    return true;
}

static void keep(cli_shear *s)
{
    const cli_block *b = s->block;
    rheo_plate lower, upper;
    rheo_world_plate(s->world, 0, &lower);
    rheo_world_plate(s->world, 1, &upper);
    s->time[s->samples] = rheo_world_time(s->world);
    s->strain[s->samples] = (upper.displacement[0] - lower.displacement[0]) / b->gap;
    s->unbalance[s->samples] = (lower.force[0] + upper.force[0]) / (b->area * b->density);
    s->stress[s->samples++] = (2 * lower.force[0] - upper.force[0]) / (3 * b->area * b->density);
}

int cli_shear_run(cli_shear *s, size_t steps)
{
    if (!has_room(s, steps))
        return cli_fail(CLI_SYSTEM, "no memory for the samples of %s", s->name);
    for (size_t i = 0; i < steps; i++) {
        rheo_error error = {""};
        const rheo_result result = rheo_world_step(s->world, &error);
        if (result != RHEO_OK)
            return cli_fail(cli_code(result), "%s of %s: %s", s->name, s->measurement->scene_name, error.message);
        keep(s);
        if (cli_interrupted())
            return cli_fail(CLI_INTERRUPTED, "interrupted in %s of %s", s->name, s->measurement->scene_name);
        const double now = cli_now();
        if (cli_progress_due(s->measurement->progress, now))
            cli_progress_say(s->measurement->progress, now, "%s: step %zu", s->name, s->samples);
    }
    return CLI_DONE;
}
