/* Plates (thickening/plates.c, docs/model.md): where they are, what moves them, what force they feel. */
#include <math.h>

#include "support.h"

#include "world/world.h"

enum { MOST = 2000, SIDE = 5, LAYERS = 9 };
#define PERIOD 10.5

static uint32_t seed;

static double unit(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (double)(seed >> 8) / (1 << 24);
}

/* Nine layers, two of which belong to each plate. */
static rheo_world_def plates_def(rheo_real *position)
{
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    def.history.window = 6;
    def.space.period[0] = def.space.period[2] = PERIOD;
    def.plates.lower = -5;
    def.plates.upper = 5;
    uint32_t n = 0;
    seed = 3;
    for (int x = 0; x < SIDE; x++)
        for (int y = 0; y < LAYERS; y++)
            for (int z = 0; z < SIDE; z++, n++) {
                position[3 * n] = (rheo_real)(2.1 * (x - 2) + 0.3 * unit());
                position[3 * n + 1] = (rheo_real)(2.1 * (y - 4) + 0.3 * unit());
                position[3 * n + 2] = (rheo_real)(2.1 * (z - 2) + 0.3 * unit());
            }
    def.particles.count = n;
    def.particles.position = position;
    return def;
}

static rheo_world *make(const rheo_world_def *def)
{
    rheo_world *world;
    OK(rheo_world_create(def, &world, &error));
    return world;
}

static rheo_plate plate_of(const rheo_world *world, uint32_t plate)
{
    rheo_plate values;
    assert_true(rheo_world_plate(world, plate, &values));
    return values;
}

/* ---- Motion ---- */

/* The position of a plate's particle that is `displacement` away, at some image, as a real. */
static void is_in_place(const rheo_world *world, uint32_t id, const rheo_real *began, const double displacement[3])
{
    const double length[3] = {(double)(rheo_real)PERIOD, 0, (double)(rheo_real)PERIOD};
    for (uint32_t axis = 0; axis < 3; axis++) {
        const double x = (double)began[3 * id + axis] + displacement[axis],
                     found = (double)rheo_world_positions(world)[3 * id + axis],
                     turns = length[axis] > 0 ? floor((x - found) / length[axis] + 0.5) : 0;
        assert_true((rheo_real)(x - turns * length[axis]) == (rheo_real)found);
    }
}

static void plates_hold_their_particles_exactly(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.plates.velocity[0] = 7;
    def.plates.velocity[1] = 0.25;
    def.plates.velocity[2] = -3;
    rheo_world *world = make(&def);
    const double rest[3] = {0, 0, 0};
    double moved[3] = {0, 0, 0};
    for (int s = 0; s < 90; s++) {
        step(world, 1);
        const double substeps = metric(world, "substeps"), tau = (double)(rheo_real)(def.step / substeps);
        for (int axis = 0; axis < 3; axis++)
            for (int k = 0; k < (int)substeps; k++)
                moved[axis] += tau * def.plates.velocity[axis];
        const rheo_plate upper = plate_of(world, RHEO_PLATE_UPPER), lower = plate_of(world, RHEO_PLATE_LOWER);
        assert_int_equal(upper.particles, 2 * SIDE * SIDE);
        assert_int_equal(lower.particles, 2 * SIDE * SIDE);
        for (uint32_t axis = 0; axis < 3; axis++) {
            assert_true(upper.displacement[axis] == moved[axis] && lower.displacement[axis] == 0);
            assert_true(upper.velocity[axis] == def.plates.velocity[axis] && lower.velocity[axis] == 0);
        }
        for (uint32_t i = 0; i < def.particles.count; i++) {
            const double y = (double)x[3 * i + 1];
            if (y > -5 && y < 5)
                continue;
            is_in_place(world, i, x, y > 5 ? moved : rest);
            for (uint32_t axis = 0; axis < 3; axis++)
                assert_true(rheo_world_velocities(world)[3 * i + axis] ==
                            (rheo_real)(y > 5 ? def.plates.velocity[axis] : 0));
        }
    }
    assert_true(moved[0] > 1.9 * PERIOD);
    rheo_world_destroy(world);
}

static void an_oscillation_is_a_sine(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.plates.velocity[2] = 1;
    def.plates.amplitude = 1.5;
    def.plates.frequency = 1.25;
    rheo_world *world = make(&def);
    const double two_pi = 6.283185307179586;
    for (int s = 0; s < 60; s++) {
        step(world, 1);
        const double t = rheo_world_time(world), phase = two_pi * def.plates.frequency * t;
        const rheo_plate upper = plate_of(world, RHEO_PLATE_UPPER);
        /* A substep is rounded to a real. */
        NEAR(upper.displacement[0], 1.5 * sin(phase), 1e-5);
        NEAR(upper.velocity[0], 1.5 * two_pi * 1.25 * cos(phase), 1e-4);
        NEAR(upper.displacement[2], t, 1e-6);
        for (uint32_t i = 0; i < def.particles.count; i++)
            if (x[3 * i + 1] > 5)
                is_in_place(world, i, x, upper.displacement);
    }
    OK(rheo_world_set(world, "plates.amplitude", "0", &error));
    step(world, 1);
    assert_true(plate_of(world, RHEO_PLATE_UPPER).displacement[0] == 0);
    /* A phase of a damaged recording. */
    const double phase[] = {0, 0.5, -0.25, 1, 1e300};
    for (size_t k = 0; k < sizeof phase / sizeof *phase; k++) {
        *world->state.plate_phase = phase[k];
        if (k < 2)
            OK(rheo__world_check_state(world, true, &error));
        else
            REFUSED(RHEO_ERROR_FORMAT, "the phase of the upper plate", rheo__world_check_state(world, true, &error));
    }
    rheo_world_destroy(world);
}

static void the_velocity_is_live(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    const rheo_world_def def = plates_def(x);
    rheo_world *world = make(&def);
    step(world, 2);
    assert_true(plate_of(world, RHEO_PLATE_UPPER).displacement[0] == 0);
    OK(rheo_world_set(world, "plates.velocity", "[2, 0, 0]", &error));
    step(world, 10);
    NEAR(plate_of(world, RHEO_PLATE_UPPER).displacement[0], 20 * def.step, 1e-6);
    OK(rheo_world_set(world, "plates.velocity", "[0, 0, 0]", &error));
    step(world, 3);
    NEAR(plate_of(world, RHEO_PLATE_UPPER).displacement[0], 20 * def.step, 1e-6);
    assert_true(plate_of(world, RHEO_PLATE_UPPER).velocity[0] == 0);
    rheo_world_destroy(world);
}

static void later_particles_belong_to_no_plate(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    const rheo_world_def def = plates_def(x);
    rheo_world *world = make(&def);
    const rheo_real far[3] = {0, 40, 0}, up[3] = {0, 1, 0};
    step(world, 1);
    OK(rheo_world_add_particles(world, 1, far, up, &error));
    step(world, 4);
    assert_int_equal(plate_of(world, RHEO_PLATE_UPPER).particles, 2 * SIDE * SIDE);
    NEAR((double)rheo_world_positions(world)[3 * def.particles.count + 1], 40 + 4 * def.step, 1e-4);
    rheo_world_destroy(world);
}

/* ---- Force ---- */

static double momentum_of_fluid(const rheo_world *world, const rheo_real *began, size_t axis)
{
    double sum = 0;
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
        if (began[3 * i + 1] > -5 && began[3 * i + 1] < 5)
            sum += (double)rheo_world_velocities(world)[3 * i + axis];
    return sum;
}

/* What the plates do not take, the fluid has. */
static void forces_balance_the_momentum_of_the_fluid(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.plates.velocity[0] = 4;
    rheo_world *world = make(&def);
    assert_true(isnan(plate_of(world, RHEO_PLATE_UPPER).force[0]));
    for (int s = 0; s < 40; s++) {
        double before[3];
        for (size_t axis = 0; axis < 3; axis++)
            before[axis] = momentum_of_fluid(world, x, axis);
        step(world, 1);
        const rheo_plate upper = plate_of(world, RHEO_PLATE_UPPER), lower = plate_of(world, RHEO_PLATE_LOWER);
        for (size_t axis = 0; axis < 3; axis++)
            NEAR(def.step * (upper.force[axis] + lower.force[axis]), before[axis] - momentum_of_fluid(world, x, axis),
                 2e-3); /* of forces up to 1e4 */
    }
    rheo_world_destroy(world);
}

static void dragged_fluid_pulls_the_upper_plate_back(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.plates.velocity[0] = 4;
    rheo_world *world = make(&def);
    double upper = 0, lower = 0;
    step(world, 60);
    for (int s = 0; s < 60; s++) {
        step(world, 1);
        upper += plate_of(world, RHEO_PLATE_UPPER).force[0] / 60;
        lower += plate_of(world, RHEO_PLATE_LOWER).force[0] / 60;
    }
    assert_true(upper < -20 && lower > 20);
    NEAR(upper + lower, 0, 0.25 * lower);
    rheo_world_destroy(world);
}

/* The force of the linear viscosity alone is a sum over pairs (docs/model.md, 4). */
static void the_viscous_force_is_the_sum_over_pairs(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST], v[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.fluid.stiffness = def.fluid.near_stiffness = def.fluid.quadratic_viscosity = 0;
    def.springs.stiffness = 0;
    def.fluid.linear_viscosity = 2; /* no bound is reached */
    const uint32_t n = def.particles.count;
    for (uint32_t i = 0; i < n; i++)
        v[3 * i] = x[3 * i + 1] > -5 && x[3 * i + 1] < 5 ? x[3 * i + 1] / 4 : 0;
    def.particles.velocity = v;
    rheo_world *world = make(&def);
    double force[2][3] = {{0}}, most = 0;
    for (uint32_t i = 0; i < n; i++) {
        double share = 0;
        for (uint32_t j = 0; j < n; j++) {
            double d[3], r2 = 0, approach = 0;
            for (uint32_t axis = 0; axis < 3; axis++) {
                d[axis] = (double)x[3 * j + axis] - (double)x[3 * i + axis];
                d[axis] -= axis == 1 ? 0 : PERIOD * floor(d[axis] / PERIOD + 0.5);
                r2 += d[axis] * d[axis];
            }
            const double r = sqrt(r2), w = 1 - r / def.fluid.support;
            for (uint32_t axis = 0; axis < 3; axis++)
                approach += (double)(v[3 * i + axis] - v[3 * j + axis]) * d[axis] / r;
            if (i == j || w <= 0 || approach <= 0)
                continue;
            share += def.step * w * def.fluid.linear_viscosity;
            for (uint32_t axis = 0; axis < 3 && i < j; axis++) {
                const double f = w * def.fluid.linear_viscosity * approach * d[axis] / r / 2;
                for (int plate = 0; plate < 2; plate++) {
                    const bool has_i = plate ? x[3 * i + 1] > 5 : x[3 * i + 1] < -5,
                               has_j = plate ? x[3 * j + 1] > 5 : x[3 * j + 1] < -5;
                    force[plate][axis] += has_j == has_i ? 0 : has_j ? f : -f;
                }
            }
        }
        most = fmax(most, share);
    }
    assert_true(most < 1);
    step(world, 1);
    for (uint32_t plate = 0; plate < 2; plate++)
        for (uint32_t axis = 0; axis < 3; axis++)
            NEAR(plate_of(world, plate).force[axis], force[plate][axis], 2e-4 * fabs(force[1][0]));
    assert_true(fabs(force[1][0]) > 5);
    rheo_world_destroy(world);
}

static void a_stress_accelerates_the_mass_of_the_plate(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.plates.control = RHEO_PLATES_STRESS;
    def.plates.stress = 20;
    def.fluid.number_density = 0.11;
    rheo_world *world = make(&def);
    const double length = (double)(rheo_real)PERIOD, drive = 20 * 0.11 * length * length;
    for (int s = 0; s < 60; s++) {
        const rheo_plate before = plate_of(world, RHEO_PLATE_UPPER);
        if (s == 30)
            OK(rheo_world_set(world, "plates.stress", "-40", &error));
        step(world, 1);
        const rheo_plate after = plate_of(world, RHEO_PLATE_UPPER);
        const double expected = def.step * (after.force[0] + (s < 30 ? drive : -2 * drive)) / after.particles;
        NEAR(after.velocity[0] - before.velocity[0], expected, 1e-6 * (1 + fabs(expected)));
        for (uint32_t axis = 1; axis < 3; axis++)
            assert_true(after.velocity[axis] == 0 && after.displacement[axis] == 0);
        for (uint32_t i = 0; i < def.particles.count; i++)
            if (x[3 * i + 1] > 5)
                is_in_place(world, i, x, after.displacement);
        if (s == 29)
            assert_true(after.displacement[0] > 0.05);
    }
    assert_true(plate_of(world, RHEO_PLATE_UPPER).velocity[0] < 0);
    rheo_world_destroy(world);
}

/* ---- Loading ---- */

static void plates_can_be_loaded_at_every_step(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.plates.velocity[0] = 9;
    def.plates.amplitude = 0.3;
    def.plates.frequency = 3;
    for (int control = 0; control < 2; control++) {
        def.plates.control = control ? RHEO_PLATES_STRESS : RHEO_PLATES_VELOCITY;
        def.plates.stress = 60;
        rheo_world *world = make(&def);
        for (int s = 0; s < 40; s++) {
            void *bytes;
            size_t size;
            if (s == 20) /* values of 0 are kept, too */
                OK(rheo_world_set(world, "plates.amplitude", "0", &error));
            OK(rheo_world_save_memory(world, "plates", &bytes, &size, &error));
            rheo_recording *recording;
            rheo_world *loaded;
            OK(rheo_recording_open_memory(bytes, size, &recording, &error));
            OK(rheo_recording_world(recording, rheo_world_step_count(world), NULL, &loaded, &error));
            rheo_recording_close(recording);
            free(bytes);
            assert_true(isnan(plate_of(loaded, RHEO_PLATE_LOWER).force[1]));
            step(world, 1);
            step(loaded, 1);
            assert_true(rheo_world_hash(loaded) == rheo_world_hash(world));
            const rheo_plate a = plate_of(world, RHEO_PLATE_UPPER), b = plate_of(loaded, RHEO_PLATE_UPPER);
            assert_memory_equal(&a, &b, sizeof a);
            rheo_world_destroy(loaded);
        }
        rheo_world_destroy(world);
    }
}

/* ---- What is refused ---- */

static void bad_plates_are_refused(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = plates_def(x);
    def.plates.lower = 6;
    REFUSED(RHEO_ERROR_ARGUMENT, "plates.lower is 6 and plates.upper is 5", rheo_world_def_check(&def, &error));
    def.plates.lower = -5;
    def.space.period[1] = 30;
    REFUSED(RHEO_ERROR_ARGUMENT, "and 0 along y", rheo_world_def_check(&def, &error));
    def.space.period[1] = def.space.period[2] = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "with plates it must be above 0 along x and z", rheo_world_def_check(&def, &error));
    def.plates.lower = def.plates.upper = 0;
    rheo_world *world = make(&def);
    rheo_plate plate;
    assert_false(rheo_world_plate(world, RHEO_PLATE_LOWER, &plate));
    REFUSED(RHEO_ERROR_ARGUMENT, "this world was made without plates",
            rheo_world_set(world, "plates.velocity", "[1, 0, 0]", &error));
    rheo_world_destroy(world);
    def = plates_def(x);
    world = make(&def);
    assert_false(rheo_world_plate(world, 2, &plate));
    REFUSED(RHEO_ERROR_ARGUMENT, "plates.control", rheo_world_set(world, "plates.control", "stress", &error));
    rheo_world_destroy(world);
    def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.plates.upper = 1; /* ignored, as any parameter of the other model */
    world = make(&def);
    assert_false(rheo_world_plate(world, RHEO_PLATE_UPPER, &plate));
    rheo_world_destroy(world);
}

/* A particle at the height of a plate is none of its own. */
static void a_plate_begins_beyond_its_height(void **unused)
{
    (void)unused;
    for (int lower = 0; lower < 2; lower++) {
        rheo_scene scene;
        rheo_warning found[2];
        size_t count;
        OK(rheo_scene_builtin("plates", &scene, &error));
        double *height = lower ? &scene.world.plates.lower : &scene.world.plates.upper;
        *height = lower ? -1000 : 1000;
        OK(rheo_scene_warnings(&scene, found, 2, &count, &error));
        assert_true(count == 1 && found[0].value == *height);
        *height = found[0].limit; /* that of the last particle */
        OK(rheo_scene_warnings(&scene, found, 2, &count, &error));
        assert_true(count == 1 && found[0].value == *height && found[0].limit == *height);
        *height += lower ? 1e-3 : -1e-3;
        OK(rheo_scene_warnings(&scene, found, 2, &count, &error));
        assert_int_equal(count, 0);
        rheo_scene_release(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plates_hold_their_particles_exactly),
        cmocka_unit_test(an_oscillation_is_a_sine),
        cmocka_unit_test(the_velocity_is_live),
        cmocka_unit_test(later_particles_belong_to_no_plate),
        cmocka_unit_test(forces_balance_the_momentum_of_the_fluid),
        cmocka_unit_test(dragged_fluid_pulls_the_upper_plate_back),
        cmocka_unit_test(the_viscous_force_is_the_sum_over_pairs),
        cmocka_unit_test(a_stress_accelerates_the_mass_of_the_plate),
        cmocka_unit_test(plates_can_be_loaded_at_every_step),
        cmocka_unit_test(bad_plates_are_refused),
        cmocka_unit_test(a_plate_begins_beyond_its_height),
    };
    return cmocka_run_group_tests_name("plates", tests, NULL, NULL);
}
