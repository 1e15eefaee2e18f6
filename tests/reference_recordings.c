/*
 * Records small worlds for tests/reference: what the golden recordings lack, in the number type of this build. Every kind of
 * command, coinciding particles, passive hardening, a viscosity that is bounded, springs that are softened, both solvers, a
 * ball that is pushed and a floor that vibrates, several balls, materials that a command changes, a failure in a substep, periods of two
 * cells, plates that commands move, and more particles than the ranks of a window and the sample of the mean velocity hold.
 *
 *   reference_recordings FOLDER
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rheolog/rheolog.h"

enum { MOST = 1200 };

static rheo_error error;

static void ok(rheo_result result, const char *what)
{
    if (result == RHEO_OK)
        return;
    fprintf(stderr, "reference_recordings: %s: %s: %s\n", what, rheo_result_name(result), error.message);
    exit(1);
}
#define OK(call) ok(call, #call)

/* Particles on a lattice of nx x ny x nz, 1.9 apart and each a little beside its place. */
static rheo_real position[3 * MOST];
static void fill(rheo_world_def *def, uint32_t nx, uint32_t ny, uint32_t nz)
{
    uint32_t count = 0, random = 1;
    for (uint32_t i = 0; i < nx * ny * nz; i++, count++) {
        const uint32_t at[3] = {i % nx, i / nx % ny, i / nx / ny};
        for (int axis = 0; axis < 3; axis++) {
            random = random * 1664525U + 1013904223U;
            position[3 * count + (uint32_t)axis] =
                (rheo_real)(1 + 1.9 * at[axis]) + (rheo_real)(random >> 24) / (rheo_real)1024;
        }
    }
    def->particles.count = count;
    def->particles.position = position;
}

/* Puts a particle where another is. */
static void coincide(uint32_t a, uint32_t b)
{
    memcpy(position + 3 * (size_t)b, position + 3 * (size_t)a, 3 * sizeof *position);
}

static const rheo_wall WALLS[] = {{{0, 0, 0}, {0, 1, 0}},
                                  {{0, 0, 0}, {3, 0.1, 0}},
                                  {{9, 0, 0}, {-1, 0, 0}},
                                  {{0, 0, 0}, {0, 0, 2}},
                                  {{0, 0, 9}, {0, 0, -1}}};
static const double VIBRATORS[][2] = {{2, 3}, {6, 5}, {4, 7}};

static void set(rheo_world *w, const char *path, const char *value)
{
    ok(rheo_world_set(w, path, value, &error), path);
}

/* A command before each step, among them every kind; histories of lengths refuse two of them. */
static void command(rheo_world *w, uint64_t step)
{
    const bool lengths = rheo_world_definition(w)->history.of == RHEO_HISTORY_OF_LENGTH;
    const double impulse[3] = {30, -700, 11}, point[3] = {4, 13, 3}, sideways[3] = {0, 0, 200};
    rheo_particle_state first;
    switch (step) {
    case 2:
        OK(rheo_world_push_body(w, 0, impulse, point, &error));
        break;
    case 4:
        OK(rheo_world_push_body(w, 0, sideways, NULL, &error));
        break;
    case 5: {
        OK(rheo_world_particle(w, 7, &first, &error));
        const double *at = first.position; /* one of the new particles coincides with particle 7 */
        const rheo_real x[6] = {(rheo_real)at[0], (rheo_real)at[1], (rheo_real)at[2], 4, 9, 4},
                        v[6] = {1, 0, -2, 0, 3, 0};
        OK(rheo_world_add_particles(w, 2, x, v, &error));
        break;
    }
    case 7:
        OK(rheo_world_move_vibrator(w, 1, 5.5, 3.25, &error));
        set(w, "vibrators.frequency", "9");
        set(w, "vibrators.spread", "0.1");
        break;
    case 8:
        if (!lengths)
            set(w, "step", "0.02");
        set(w, "history.order", "0.7");
        break;
    case 10:
        set(w, "fluid.support", "4.25");
        set(w, "springs.rest_length", "support");
        break;
    case 12:
        if (!lengths)
            set(w, "history.hardening", "passive");
        set(w, "substeps", "4");
        set(w, "gravity", "[1.5, -7, 0.25]");
        break;
    case 14:
        set(w, "ball.density_ratio", "0.7");
        set(w, "ball.push_frequency", "70");
        set(w, "ball.push_duty", "0.9");
        set(w, "ball.spin", "[3, -20, 9]");
        set(w, "history.weights", "l1");
        break;
    default:
        break;
    }
}

static void material_command(rheo_world *w, uint64_t step)
{
    const rheo_real x[6] = {2, 8, 2, 4, 8, 4}, v[6] = {0, -3, 0, 1, -3, 0};
    if (step == 3)
        set(w, "materials.stiff.springs.stiffness", "70");
    if (step == 4)
        OK(rheo_world_add_particles_of(w, 2, 2, x, v, &error));
    if (step == 6)
        set(w, "history.hardening", "passive");
    if (step == 8)
        set(w, "materials.2.history.onset", "0.5");
    if (step == 9)
        set(w, "springs.stiffness", "9");
}

static void plate_command(rheo_world *w, uint64_t step)
{
    const rheo_real x[3] = {2, 30, 2};
    if (step == 4)
        set(w, "plates.velocity", "[-3, 0.5, 20]");
    if (step == 6)
        set(w, "plates.frequency", "0.75");
    if (step == 8)
        OK(rheo_world_add_particles(w, 1, x, NULL, &error));
    if (step == 10)
        set(w, "plates.velocity", "[0, 0, 0]");
}

static void ball_command(rheo_world *w, uint64_t step)
{
    const double impulse[3] = {30, -70, 11}, point[3] = {4, 13, 3};
    if (step == 3)
        OK(rheo_world_push_body(w, 1, impulse, point, &error));
    if (step == 5)
        set(w, "ball3.velocity", "[2, 30, -1]");
    if (step == 6)
        set(w, "ball2.spin", "[3, -20, 9]");
    if (step == 7)
        set(w, "ball2.density_ratio", "0.7");
    if (step == 8)
        set(w, "ball3.push", "[2, 80, -1]");
    if (step == 9)
        set(w, "ball2.friction", "400");
}

static void record(const rheo_world_def *def, const char *folder, const char *name, uint64_t steps, bool commands)
{
    char path[1024];
    rheo_world *world;
    rheo_recorder *recorder;
    snprintf(path, sizeof path, "%s/%s.rlog", folder, name);
    const rheo_record_options options = {.scene = name, .keyframe_spacing = 6, .full = !commands, .force = true};
    OK(rheo_world_create(def, &world, &error));
    OK(rheo_recorder_open(world, path, &options, &recorder, &error));
    for (uint64_t step = 1; step <= steps; step++) {
        if (commands && def->materials.count)
            material_command(world, step);
        else if (commands && def->balls.count)
            ball_command(world, step);
        else if (commands && def->space.period[0] > 0)
            plate_command(world, step);
        else if (commands)
            command(world, step);
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

/* A run that fails in the second step, in a substep. Doubles have no parameter that large. */
static void record_failure(const rheo_world_def *def, const char *folder, const char *name)
{
    char path[1024];
    rheo_world *world;
    rheo_recorder *recorder;
    if (sizeof(rheo_real) != sizeof(float))
        return;
    snprintf(path, sizeof path, "%s/%s.rlog", folder, name);
    OK(rheo_world_create(def, &world, &error));
    OK(rheo_recorder_open(world, path, &(rheo_record_options){.scene = name, .force = true}, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    set(world, "gravity", "[0, -1e30, 0]");
    if (rheo_recorder_step(recorder, &error) != RHEO_ERROR_STATE) {
        fprintf(stderr, "reference_recordings: %s does not fail\n", name);
        exit(1);
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

/* A box of fluid with walls, a ball and vibrators. */
static rheo_world_def box(void)
{
    rheo_world_def def = rheo_default_world_def();
    fill(&def, 4, 3, 4);
    def.walls.count = sizeof WALLS / sizeof *WALLS;
    def.walls.plane = WALLS;
    def.history.window = 4;
    def.ball.radius = 3;
    def.ball.position[0] = def.ball.position[2] = 4;
    def.ball.position[1] = 8;
    def.ball.velocity[1] = -9;
    def.ball.push[0] = 40;
    def.ball.push[1] = -300;
    def.ball.push[2] = 0.7;
    def.ball.push_frequency = 12;
    def.ball.push_duty = 0.35;
    def.vibrators.count = sizeof VIBRATORS / sizeof *VIBRATORS;
    def.vibrators.position = VIBRATORS;
    def.vibrators.amplitude = 0.6;
    return def;
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: reference_recordings FOLDER\n");
        return 2;
    }
    rheo_world_def def = box();
    record(&def, argv[1], "made-commands", 18, true);

    def.history.kind = RHEO_HISTORY_WINDOW_FAST;
    record(&def, argv[1], "made-commands-fast", 18, true);

    def.history.lag = 5;
    record(&def, argv[1], "made-lag-fast", 18, true);
    def.history.kind = RHEO_HISTORY_TEMPERED;
    record(&def, argv[1], "made-lag-tempered", 9, false);

    /* Its points are at samples, between them, and several between two samples. */
    const rheo_curve_point curve[] = {{0, 3}, {0.066, 1.5}, {0.08, 2}, {0.085, -1}, {0.17, 0.5}, {0.231, 0}};
    def = box();
    def.history.curve = curve;
    def.history.curve_count = sizeof curve / sizeof *curve;
    def.history.lag = 1;
    record(&def, argv[1], "made-curve", 14, false);

    def = box();
    def.history.of = RHEO_HISTORY_OF_LENGTH;
    def.history.window = 12;
    record(&def, argv[1], "made-lengths-commands", 18, true);
    def.history.lag = 2;
    record(&def, argv[1], "made-lengths", 18, false);
    def.history.curve = curve;
    def.history.curve_count = sizeof curve / sizeof *curve;
    record(&def, argv[1], "made-lengths-curve", 14, false);

    def = box();
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    def.springs.solver = RHEO_SOLVER_IMPLICIT;
    coincide(3, 9);
    record(&def, argv[1], "made-implicit", 12, false);

    def = box();
    def.max_substeps = 2;
    def.history.stiffness = 20000;
    def.history.onset = 0;
    def.fluid.linear_viscosity = 90;
    def.fluid.quadratic_viscosity = 6;
    def.vibrators.kind = RHEO_VIBRATOR_FORCE;
    def.vibrators.height = 3;
    record(&def, argv[1], "made-soft", 12, false);

    /* A ball that falls on the floor and is at first in the fluid; particles that coincide, three of them in one place. */
    def = box();
    coincide(5, 40);
    coincide(11, 12);
    coincide(11, 30);
    def.ball.position[1] = 5;
    def.ball.velocity[1] = -60;
    record(&def, argv[1], "made-coinciding", 12, false);

    /* Balls that fall on each other, and overlap. */
    def = box();
    rheo_ball second = rheo_default_ball(), third = rheo_default_ball();
    second.radius = 1.5;
    second.position[0] = 4.5, second.position[1] = 13, second.position[2] = 4.25;
    second.velocity[1] = -40;
    second.spin[0] = 5, second.spin[2] = -30;
    second.push[0] = 60;
    third.radius = 2;
    third.density_ratio = 0.25;
    third.position[0] = third.position[1] = third.position[2] = 5;
    OK(rheo_world_def_add_ball(&def, &second, &error));
    OK(rheo_world_def_add_ball(&def, &third, &error));
    record(&def, argv[1], "made-balls", 12, true);
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    record(&def, argv[1], "made-balls-sequential", 8, false);

    def = box();
    def.history.kind = RHEO_HISTORY_FULL;
    record_failure(&def, argv[1], "made-failure");

    def = box();
    rheo_material stiff = rheo_default_material("stiff"), soft = rheo_default_material("soft");
    stiff.springs.stiffness = 50;
    stiff.springs.yield_ratio = 0.2;
    stiff.history.stiffness = 400;
    soft.springs.plasticity = 9;
    soft.history.stiffness = 0;
    OK(rheo_world_def_add_material(&def, &stiff, &error));
    OK(rheo_world_def_add_material(&def, &soft, &error));
    uint32_t of[MOST];
    for (uint32_t i = 0; i < MOST; i++)
        of[i] = i * 5 % 3;
    def.particles.material = of;
    record(&def, argv[1], "made-materials", 12, true);
    def.max_substeps = 2;
    record(&def, argv[1], "made-materials-soft", 12, false);
    def.history.of = RHEO_HISTORY_OF_LENGTH;
    record(&def, argv[1], "made-materials-lengths", 12, false);

    /* Periods of two cells; across the border, particles coincide and are of several materials. */
    def = rheo_default_world_def();
    fill(&def, 5, 8, 6);
    def.space.period[0] = 10.25;
    def.space.period[2] = 11.4;
    def.plates.lower = 3;
    def.plates.upper = 13;
    def.plates.velocity[0] = 4;
    def.plates.amplitude = 1;
    def.plates.frequency = 1.5;
    def.history.window = 4;
    def.history.hardening = RHEO_HARDENING_PASSIVE;
    def.fluid.linear_viscosity = 60;
    OK(rheo_world_def_add_material(&def, &stiff, &error));
    OK(rheo_world_def_add_material(&def, &soft, &error));
    def.particles.material = of;
    position[3 * 100] = position[3 * 104] - (rheo_real)10.25;
    position[3 * 100 + 1] = position[3 * 104 + 1];
    position[3 * 100 + 2] = position[3 * 104 + 2];
    record(&def, argv[1], "made-plates", 14, true);
    def.plates.lower = def.plates.upper = 0;
    def.space.period[1] = 15.3;
    record(&def, argv[1], "made-periodic", 8, false);

    /* Only read. */
    def = rheo_default_world_def();
    fill(&def, 3, 3, 3);
    rheo_emitter jet = rheo_default_emitter("jet");
    jet.position[1] = 40;
    jet.radius = 3;
    jet.speed = 30;
    OK(rheo_world_def_add_emitter(&def, &jet, &error));
    record(&def, argv[1], "made-emitters", 14, false);

    def = rheo_default_world_def();
    fill(&def, 11, 10, 10);
    def.history.window = 12;
    record(&def, argv[1], "made-many", 3, false);
    return 0;
}
