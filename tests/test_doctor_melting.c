/* Diagnoses of runs of the melting model. */
#define _POSIX_C_SOURCE 200809L
#ifndef PATH
#define PATH "test_doctor_melting.rlog"
#endif
#include "doctor_support.h"

/* ---- Melting worlds ---- */

/* Diagnoses a run of the melting model; returns the recording in *f. */
static rheo_diagnosis diagnose_melting(uint32_t side, const char *const *set, int steps, file *f)
{
    rheo_result result;
    *f = record(melting_world(side, set), steps, NULL, &result);
    return diagnose(f);
}

/* Continues from the step before the cause with a piece of advice. */
static rheo_diagnosis follow(const file *f, const rheo_diagnosis *d, const rheo_advice *advice, int steps)
{
    rheo_recording *recording;
    rheo_world *world;
    char path[64];
    snprintf(path, sizeof path, "%s", advice->set);
    char *value = strchr(path, '=');
    assert_non_null(value);
    *value++ = 0;
    OK(rheo_recording_open_memory(f->bytes, f->size, &recording, &error));
    OK(rheo_recording_world(recording, d->first_step, NULL, &world, &error));
    rheo_recording_close(recording);
    OK(rheo_world_set(world, path, value, &error));
    rheo_result result;
    file cured = record(world, steps, NULL, &result);
    rheo_diagnosis after = diagnose(&cured);
    free(cured.bytes);
    return after;
}

static void assert_each_cures(const file *f, const rheo_diagnosis *d, uint32_t count, int steps)
{
    assert_int_equal(d->advice_count, count);
    for (uint32_t i = 0; i < count; i++) {
        rheo_diagnosis after = follow(f, d, &d->advice[i], steps);
        if (!after.healthy)
            fail_msg("%s: %s", d->advice[i].set, after.why);
    }
}

static void healthy_melting_runs_are_healthy(void **state)
{
    (void)state;
    static const char *const SETS[][8] = {
        {NULL},
        {"melting.flow", "frozen", NULL},
        {"melting.solver", "explicit", "melting.jump_number_max", "5", NULL},
        {"melting.viscosity", "0", "melting.diffusivity", "0", NULL},
    };
    file f;
    for (size_t i = 0; i < sizeof SETS / sizeof *SETS; i++) {
        rheo_diagnosis d = diagnose_melting(6, SETS[i], 30, &f);
        assert_healthy(&d, 0);
        assert_int_equal(d.last_step, 30);
        free(f.bytes);
    }
}

/* Substeps violate the acoustic limit: (c + speed) substep/h is 3.5. Solid would be stable. */
static void substeps_that_are_too_long_are_named(void **state)
{
    (void)state;
    static const char *const SET[] = {"melting.substeps", "1", "step", "0.07", "melting.jump_number_max", "0", NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(6, SET, 200, &f);
    assert_cause(&d, "substep_courant_number", "integration");
    assert_true(d.cause.value > 2.35 && d.cause.id >= 0 && finding(&d, "substep_courant_number")->step == 0);
    assert_in("melting.substeps=0", d.advice[0].set);
    assert_each_cures(&f, &d, 2, 60);
    free(f.bytes);
    /* The doctor names a Courant number that is too large. */
    static const char *const LARGE[] = {"melting.courant_number",  "3.6", "step", "0.2",
                                        "melting.jump_number_max", "0",   NULL};
    d = diagnose_melting(6, LARGE, 200, &f);
    assert_cause(&d, "substep_courant_number", "integration");
    assert_in("melting.courant_number=", d.advice[0].set);
    assert_each_cures(&f, &d, 1, 20);
    free(f.bytes);
}

static void explicit_viscosity_that_is_too_large_is_named(void **state)
{
    (void)state;
    static const char *const SET[] = {
        "melting.substeps", "4", "melting.solver", "explicit", "melting.viscosity", "3", "melting.rheology",
        "newtonian",        NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(6, SET, 100, &f);
    assert_cause(&d, "viscous_number", "viscosity");
    NEAR(d.cause.value, 0.02 / 4 * 3 / (0.1 * 0.1 * 0.16), 1e-6);
    assert_string_equal(d.advice[0].set, "melting.solver=implicit");
    assert_each_cures(&f, &d, 3, 40);
    free(f.bytes);
}

static void heat_that_is_too_fast_is_named(void **state)
{
    (void)state;
    static const char *const SET[] = {"melting.substeps", "1", "melting.diffusivity", "1", "melting.flow",
                                      "frozen",           NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(5, SET, 3000, &f);
    assert_cause(&d, "heat_number", "integration");
    NEAR(d.cause.value, 0.02 / (0.1 * 0.1), 1e-6);
    assert_in("temperature of particle", d.why);
    assert_each_cures(&f, &d, 2, 100);
    free(f.bytes);
}

/* Temperatures grow from the first step on, and leave their range long before one is not finite. */
static void heat_that_is_too_fast_is_unhealthy_before_a_step_fails(void **state)
{
    (void)state;
    static const char *const SET[] = {"melting.substeps", "1", "melting.diffusivity", "1", "melting.flow",
                                      "frozen",           NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(5, SET, 3, &f);
    assert_false(d.failed);
    assert_cause(&d, "heat_number", "integration");
    assert_int_equal(d.unhealthy_step, 1);
    assert_false(d.ill_from_start);
    free(f.bytes);
}

static void a_fluid_that_is_too_soft_is_named(void **state)
{
    (void)state;
    static const char *const SET[] = {"melting.sound_speed",     "1", "gravity", "[0, -5, 0]",
                                      "melting.jump_number_max", "0", NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(8, SET, 150, &f);
    assert_false(d.healthy);
    if (strcmp(d.cause.measure, "mach_number") != 0 && strcmp(d.cause.measure, "max_density_error") != 0)
        fail_msg("%s", d.why);
    assert_int_equal(strncmp(d.advice[0].set, "melting.sound_speed=", 20), 0);
    assert_each_cures(&f, &d, 1, 60);
    free(f.bytes);
}

/* A step refused for its substeps reports their number, and both remedies work. */
static void a_refused_step_is_reported(void **state)
{
    (void)state;
    static const char *const SET[] = {
        "melting.solver", "explicit", "melting.jump_number_max", "200", "melting.max_substeps", "10", NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(4, SET, 3, &f);
    assert_cause(&d, "", "substeps");
    assert_true(d.failed && d.failure.step == 1);
    assert_in("step 1 went bad: stage substeps cannot go on because of substeps of the world", d.why);
    assert_in("it would need 408 substeps, and melting.max_substeps is 10", d.why);
    assert_int_equal(!strstr(d.why, "it would need"), REWORDED);
    assert_int_equal(d.failure.reason, RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY);
    assert_true(d.failure.required == 408 && d.failure.limit == 10);
    assert_null(strstr(d.why, "finite"));
    assert_null(strstr(d.why, "world stays"));
    assert_string_equal(d.advice[0].set, "melting.solver=implicit");
    assert_in("melting.max_substeps=", d.advice[1].set);
    assert_each_cures(&f, &d, 2, 2);
    free(f.bytes);
}

static void every_melting_measure_fires_beyond_its_limit(void **state)
{
    (void)state;
    static const struct {
        const char *measure, *metric, *stage;
        double limit, scale, beside; /* beside: largest number of other measures out of range */
        bool severe;
    } cases[] = {
        {"max_density_error", "max_density_error", "integration", 0.2, 1, 0, false},
        {"density_error", "density_error", "integration", 0.2, 1, 0, true},
        {"energy_jump", "energy_jump", "momentum", 0.5, 1, 0, true},
        {"mach_number", "max_speed", "momentum", 0.3, 5, 0, false},
        {"speed_rise", "max_speed", "momentum", 0.5, 5, 1, true},
        {"solver_share", "iterations", "viscosity", 0.99, 4 * 100, 0, false},
    };
    static const char *const SET[] = {"melting.substeps", "4", "gravity", "[0, 0, 0]", NULL};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int out = 0; out < 2; out++) {
            file f = record_well(melting_world(3, SET), 20, NULL);
            if (strcmp(cases[i].metric, "max_speed") == 0)
                for (uint64_t step = 1; step < 20; step++)
                    forge(&f, step, "max_speed", 0);
            forge(&f, 10, cases[i].metric, cases[i].limit * cases[i].scale * (out ? 1 + 1e-6 : 1 - 1e-6));
            rheo_diagnosis d = diagnose(&f);
            const rheo_finding *found = finding(&d, cases[i].measure);
            if (!found != !out || d.finding_count > out + cases[i].beside)
                fail_msg("%s, %d: %u: %s", cases[i].measure, out, d.finding_count, d.why);
            if (out) {
                assert_int_equal(found->step, 10);
                assert_string_equal(found->stage, cases[i].stage);
                NEAR(found->limit, cases[i].limit, 0);
                NEAR(found->value, cases[i].limit, 2e-6 * cases[i].limit);
                assert_int_equal(d.healthy, !cases[i].severe);
            }
            free(f.bytes);
        }
}

/* A mean and a gain of energy have no particle; the worst one is named with its own value. */
static void the_particle_named_has_the_value_printed(void **state)
{
    (void)state;
    static const char *const SET[] = {"melting.substeps", "4", "gravity", "[0, 0, 0]", NULL};
    file f = record_well(melting_world(3, SET), 20, NULL);
    forge(&f, 10, "density_error", 0.3);
    forge(&f, 10, "max_density_error", 0.19);
    forge(&f, 10, "max_density_id", 17);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "density_error", "integration");
    assert_in("is 0.3, more than 0.2; max_density_error is 0.19 at particle 17", d.why);
    assert_true(d.cause.id == 17 && d.cause.seen_step == 10 && d.cause.seen_value == 0.19);
    forge(&f, 9, "energy_jump", 0.7);
    forge(&f, 9, "max_speed", 0.25);
    forge(&f, 9, "max_speed_id", 5);
    d = diagnose(&f);
    assert_cause(&d, "energy_jump", "momentum");
    assert_in("is 0.7, more than 0.5; mach_number is 0.05 at particle 5", d.why);
    forge(&f, 8, "max_density_error", 0.21);
    forge(&f, 8, "max_density_id", 3);
    d = diagnose(&f);
    assert_in("step 8, stage integration: max_density_error", d.why);
    assert_in("is 0.21, more than 0.2, particle 3", d.why);
    assert_true(d.cause.id == 3 && strcmp(d.cause.seen, "max_density_error") == 0);
    free(f.bytes);
    /* One particle is twice as fast as sound. */
    for (uint32_t sick = 0; sick < 8; sick += 7) {
        rheo_real values[7 * 8];
        rheo_world_def def = melting_def(2, values);
        values[3 * 8 + 3 * sick + 1] = 10;
        rheo_world *world;
        OK(rheo_world_create(&def, &world, &error));
        rheo_result result;
        f = record(world, 2, NULL, &result);
        d = diagnose(&f);
        const rheo_finding *fast = finding(&d, "mach_number");
        assert_non_null(fast);
        assert_true(fast->step == 0 && fast->id == sick);
        NEAR(fast->value, 2, 0.01);
        free(f.bytes);
    }
}

static void melting_parameters_that_cannot_work_are_noticed(void **state)
{
    (void)state;
    /* A world at rest with small forged speeds; substeps of 0.02, h = 0.1. */
    static const struct {
        const char *measure, *path, *low, *high;
        const char *set[8];
    } cases[] = {
        {"substep_courant_number", "melting.sound_speed", "9.9", "10.01", {"melting.viscosity", "0", NULL}},
        {"viscous_number",
         "melting.viscosity",
         "0.0799",
         "0.0801",
         {"melting.solver", "explicit", "melting.rheology", "newtonian", NULL}},
        {"viscous_number",
         "melting.viscosity",
         "0.1999",
         "0.2001",
         {"melting.solver", "explicit", "melting.rheology", "newtonian", "melting.stress", "nested", NULL}},
        {"heat_number", "melting.diffusivity", "0.1999", "0.2001", {NULL}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int out = 0; out < 2; out++) {
            rheo_real values[7 * 8];
            rheo_world_def def = melting_def(2, values);
            for (int k = 0; cases[i].set[k]; k += 2)
                OK(rheo_world_def_set(&def, cases[i].set[k], cases[i].set[k + 1], &error));
            OK(rheo_world_def_set(&def, cases[i].path, out ? cases[i].high : cases[i].low, &error));
            def.melting.substeps = 1;
            def.gravity[1] = 0;
            memset(values + 24, 0, 24 * sizeof *values);
            rheo_world *world;
            OK(rheo_world_create(&def, &world, &error));
            file f = record_well(world, 1, NULL);
            rheo_diagnosis d = diagnose(&f);
            if (!finding(&d, cases[i].measure) != !out)
                fail_msg("%s, %d: %s", cases[i].measure, out, d.why);
            free(f.bytes);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(healthy_melting_runs_are_healthy),
        cmocka_unit_test(substeps_that_are_too_long_are_named),
        cmocka_unit_test(explicit_viscosity_that_is_too_large_is_named),
        cmocka_unit_test(heat_that_is_too_fast_is_named),
        cmocka_unit_test(heat_that_is_too_fast_is_unhealthy_before_a_step_fails),
        cmocka_unit_test(a_fluid_that_is_too_soft_is_named),
        cmocka_unit_test(a_refused_step_is_reported),
        cmocka_unit_test(every_melting_measure_fires_beyond_its_limit),
        cmocka_unit_test(the_particle_named_has_the_value_printed),
        cmocka_unit_test(melting_parameters_that_cannot_work_are_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
