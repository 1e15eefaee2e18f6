/* Health of a run while it is made: the same steps and findings as the doctor has from its recording. */
#define _POSIX_C_SOURCE 200809L
#define PATH "test_health.rlog"
#include "doctor_support.h"

#include <math.h>

/* A small scene that settled with the default parameters, with others from step 0 on. */
static rheo_world *world_with(const char *const *set)
{
    rheo_scene scene = lively_scene();
    if (!*set || strncmp(*set, "vibrators.", 10) != 0)
        scene.world.vibrators.count = 0;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    for (; *set; set += 2)
        OK(rheo_world_set(world, set[0], set[1], &error));
    return world;
}

static void same_finding(const rheo_finding *live, const rheo_diagnosis *d)
{
    const rheo_finding *recorded = finding(d, live->measure);
    assert_non_null(recorded);
    assert_true(live->severe);
    assert_int_equal(live->step, d->unhealthy_step);
    assert_int_equal(live->step, recorded->step);
    assert_int_equal(live->id, recorded->id);
    assert_int_equal(live->other_id, recorded->other_id);
    assert_true(live->value == recorded->value);
    assert_true(live->limit == recorded->limit);
    assert_string_equal(live->stage, recorded->stage);
    assert_string_equal(live->meaning, recorded->meaning);
}

static void a_run_becomes_unhealthy_in_the_step_that_the_doctor_names(void **state)
{
    (void)state;
    static const char *const cases[][7] = {
        {NULL},
        {"fluid.linear_viscosity", "2", NULL},
        {"substeps", "1", "fluid.stiffness", "1100", NULL},
        {"max_substeps", "2", "fluid.near_stiffness", "6000", NULL},
        {"substeps", "2", "step", "0.1", NULL},
        {"vibrators.amplitude", "30", "max_substeps", "2", NULL},
        {"gravity", "[0, -3000, 0]", NULL},
    };
    uint32_t ill = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_world *world = world_with(cases[i]);
        rheo_record_options options = {.scene = "health", .keyframe_spacing = 100000, .force = true};
        rheo_recorder *recorder;
        rheo_health *health;
        rheo_finding live, again;
        bool unhealthy = false, good = true;
        OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
        OK(rheo_health_open(world, &health, &error));
        for (int step = 0; step < 60 && good; step++) {
            good = rheo_recorder_step(recorder, NULL) == RHEO_OK;
            if (good)
                unhealthy = rheo_health_step(health, unhealthy ? &again : &live);
        }
        if (unhealthy) { /* the first finding remains */
            rheo_health_step(health, &again);
            assert_string_equal(again.measure, live.measure);
            assert_int_equal(again.step, live.step);
        }
        rheo_health_close(health);
        OK(rheo_recorder_close(recorder, &error));
        rheo_world_destroy(world);
        const file f = read_and_remove(PATH);
        const rheo_diagnosis d = diagnose(&f);
        free(f.bytes);
        if (unhealthy == d.healthy)
            fail_msg("case %zu: %s", i, d.why);
        if (unhealthy)
            same_finding(&live, &d);
        ill += unhealthy;
    }
    assert_in_range(ill, 4, 5);
}

/* Added particles have speeds of their own, which are no jump of a speed. */
static void added_particles_make_no_run_unhealthy(void **state)
{
    (void)state;
    const char *const nothing[] = {NULL};
    rheo_world *world = world_with(nothing);
    rheo_health *health;
    OK(rheo_health_open(world, &health, &error));
    OK(rheo_world_add_particles(world, 1, (rheo_real[]){0, 100, 0}, (rheo_real[]){0, 400, 0}, &error));
    OK(rheo_world_step(world, &error));
    assert_false(rheo_health_step(health, NULL));
    rheo_health_close(health);
    rheo_world_destroy(world);
}

static void an_ill_state_is_noticed_at_the_start(void **state)
{
    (void)state;
    const char *const healthy[] = {NULL};
    const char *const sick[] = {"substeps", "1", "fluid.stiffness", "1100", NULL};
    rheo_health *health;
    rheo_finding f;
    rheo_world *world = world_with(healthy);
    OK(rheo_health_open(world, &health, &error));
    assert_false(rheo_health_start(health, &f));
    rheo_health_close(health);
    rheo_world_destroy(world);
    world = world_with(sick);
    bool unhealthy = false;
    OK(rheo_health_open(world, &health, &error));
    for (int step = 0; step < 60 && !unhealthy; step++) {
        OK(rheo_world_step(world, &error));
        unhealthy = rheo_health_step(health, NULL);
    }
    assert_true(unhealthy);
    assert_false(rheo_health_start(health, NULL)); /* it became so later */
    rheo_health_close(health);
    OK(rheo_health_open(world, &health, &error)); /* a run that starts here starts ill */
    assert_true(rheo_health_start(health, &f));
    assert_true(f.value > f.limit);
    assert_int_equal(f.step, rheo_world_step_count(world));
    rheo_health_close(health);
    rheo_world_destroy(world);
}

/* The kinetic energy of the step before, and that of a fall by a spacing, are what the energy is compared with. */
static void a_jump_of_the_energy_is_relative_to_motion_and_a_fall(void **state)
{
    (void)state;
    rheo_world_def def = inert_def();
    memcpy(def.gravity, (const double[3]){2, -3, 6}, sizeof def.gravity); /* of length 7 */
    def.fluid.spacing = 0.5;
    const rheo_real position[6] = {0, 0, 0, 50, 0, 0}, velocity[6] = {1, 2, 0, 0, 0, -3};
    rheo_world *world = world_of(def, 2, position, velocity);
    const double mass = metric(world, "kinetic_energy") / (0.5 * (1 + 4 + 9)); /* of a particle */
    assert_true(mass > 0);
    for (int n = 0; n < 3; n++) {
        const double before = metric(world, "energy"), motion = metric(world, "kinetic_energy");
        step(world, 1);
        const double fall = 2 * mass * 7 * 0.5;
        const double jump = (metric(world, "energy") - before) / (motion + fall);
        assert_true(jump != 0);
        NEAR(metric(world, "energy_jump"), jump, 1e-9 * fabs(jump));
    }
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_becomes_unhealthy_in_the_step_that_the_doctor_names),
        cmocka_unit_test(added_particles_make_no_run_unhealthy),
        cmocka_unit_test(an_ill_state_is_noticed_at_the_start),
        cmocka_unit_test(a_jump_of_the_energy_is_relative_to_motion_and_a_fall),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
