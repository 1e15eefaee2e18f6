/* Each measure of the doctor fires exactly beyond its limit, in recordings with forged metrics. */
#define _POSIX_C_SOURCE 200809L
#define PATH "test_doctor_limits.rlog"
#include "doctor_support.h"

typedef struct forged {
    const char *measure, *metric, *stage;
    double limit, scale; /* scale: metric value per unit of the measure */
    bool severe;
} forged;

/* Forges one metric in a quiet run, just in range and just out of range. */
static void check_forged(rheo_scheme scheme, const forged *c)
{
    for (int out = 0; out < 2; out++) {
        const double value = c->limit * (out ? 1 + 1e-6 : 1 - 1e-6) + (c->limit == 0 && out);
        file f = record_well(quiet_world(quiet_def(scheme)), 40, NULL);
        forge(&f, 20, c->metric, value * c->scale);
        rheo_diagnosis d = diagnose(&f);
        if (!out) {
            assert_healthy(&d, 0);
        } else {
            if (d.finding_count != 1 || !finding(&d, c->measure))
                fail_msg("%s does not fire alone: %u: %s", c->measure, d.finding_count, d.why);
            assert_int_equal(d.findings[0].step, 20);
            assert_string_equal(d.findings[0].stage, c->stage);
            NEAR(d.findings[0].limit, c->limit, 0);
            NEAR(d.findings[0].value, value, 1e-6 * value);
            assert_int_equal(d.findings[0].severe, c->severe);
            assert_int_equal(d.findings[0].steps, 1);
            assert_int_equal(d.healthy, !c->severe);
            if (c->severe)
                assert_cause(&d, c->measure, c->stage);
        }
        free(f.bytes);
    }
}

static void every_measure_fires_beyond_its_limit(void **state)
{
    (void)state;
    static const forged sequential[] = {
        {"stiffness_number", "stiffness_number", "spring_displacement", 2.4, 1, false},
        {"stiffness_sum", "stiffness_sum", "spring_displacement", 45, 1, false},
        {"max_spring_displacement", "max_spring_displacement", "spring_displacement", 0.5, 1, true},
        {"max_pressure_displacement", "max_pressure_displacement", "density", 0.5, 1, true},
        {"speed_jump", "max_speed", "velocity", 1, 2 / 0.033, true},
        {"courant_number", "courant_number", "velocity", 0.5, 1, false},
        {"max_density", "max_density", "density", 2, 1, false},
        {"ball_speed", "ball_vz", "ball", 0.5, 2 / 0.033, false},
    };
    static const forged summed[] = {
        {"max_spring_displacement", "max_spring_displacement", "forces", 0.4, 1, true},
        {"max_pressure_displacement", "max_pressure_displacement", "forces", 0.4, 1, true},
        {"speed_jump", "max_speed", "forces", 1, 2 / 0.033, true},
        {"courant_number", "courant_number", "forces", 0.5, 1, false},
        {"softened_springs", "softened_springs", "substeps", 0, 1, false},
        {"max_density", "max_density", "densities", 2, 1, false},
        {"ball_speed", "ball_vz", "ball", 0.5, 2 / 0.033, false},
    };
    for (size_t i = 0; i < sizeof sequential / sizeof *sequential; i++)
        check_forged(RHEO_SCHEME_SEQUENTIAL, &sequential[i]);
    for (size_t i = 0; i < sizeof summed / sizeof *summed; i++)
        check_forged(RHEO_SCHEME_SUMMED, &summed[i]);
}

static void the_speed_of_the_ball_before_its_contact_counts(void **state)
{
    (void)state;
    for (int sequential = 0; sequential < 2; sequential++) {
        const double limit = sequential ? 0.75 : 1, scale = 2 / 0.033;
        file f =
            record_well(quiet_world(quiet_def(sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED)), 40, NULL);
        forge(&f, 20, "ball_max_speed", 0.99 * limit * scale);
        rheo_diagnosis d = diagnose(&f);
        assert_healthy(&d, 1);
        assert_string_equal(d.findings[0].measure, "ball_speed");
        /* A ball that stopped within the step hit something that the step does not resolve. */
        forge(&f, 20, "ball_max_speed", 1.01 * limit * scale);
        d = diagnose(&f);
        assert_cause(&d, "ball_speed", "ball");
        assert_int_equal(d.unhealthy_step, 20);
        assert_true(finding(&d, "ball_stop")->severe);
        NEAR(finding(&d, "ball_stop")->value, 1.01 * limit, 1e-6);
        NEAR(finding(&d, "ball_stop")->limit, limit, 0);
        /* One that flies on did not. */
        forge(&f, 20, "ball_vx", -0.1 * limit * scale);
        d = diagnose(&f);
        assert_healthy(&d, 1);
        free(f.bytes);
    }
}

static void some_measures_count_only_in_motion(void **state)
{
    (void)state;
    /* Energy counts only if something moves. */
    file f = quiet(NULL);
    forge(&f, 20, "energy_jump", 2.01);
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 0);
    forge(&f, 20, "courant_number", 0.2);
    d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "energy_jump");
    free(f.bytes);
    /* A jump of speed counts only if it is large compared with the speed. */
    for (int large = 0; large < 2; large++) {
        f = quiet(NULL);
        forge(&f, 20, "max_speed", 1000);
        forge(&f, 21, "max_speed", large ? 1501 : 1499);
        d = diagnose(&f);
        assert_int_equal(finding(&d, "speed_jump")->steps, large ? 2 : 1);
        free(f.bytes);
    }
    /* Energy from a vibrator does not count. */
    rheo_world_def def = inert_def();
    def.vibrators.position = some_vibrators();
    def.vibrators.count = 1;
    def.vibrators.kind = RHEO_VIBRATOR_FORCE;
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    f = record_well(quiet_world(def), 20, NULL);
    forge(&f, 20, "energy_jump", 3);
    forge(&f, 20, "courant_number", 0.2);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
}

static void parameters_that_cannot_work_are_noticed(void **state)
{
    (void)state;
    static const struct {
        rheo_scheme scheme;
        const char *measure, *path;
        double limit;
        double scale; /* parameter value per unit of the measure, with a step of .033 and a support of 2 */
    } cases[] = {
        {RHEO_SCHEME_SEQUENTIAL, "pressure_number", "fluid.stiffness", 0.16, 2 / (0.033 * 0.033)},
        {RHEO_SCHEME_SEQUENTIAL, "near_pressure_number", "fluid.near_stiffness", 0.4, 2 / (0.033 * 0.033)},
        {RHEO_SCHEME_SEQUENTIAL, "plasticity_number", "springs.plasticity", 1, 1 / (0.033 * 1.02)},
        {RHEO_SCHEME_SEQUENTIAL, "vibrator_speed", "vibrators.amplitude", 0.5,
         2 / (0.033 * 2 * 3.14159265358979 * 5)},
        {RHEO_SCHEME_SUMMED, "pressure_number", "fluid.stiffness", 0.06, 2 / (0.011 * 0.011)},
        {RHEO_SCHEME_SUMMED, "near_pressure_number", "fluid.near_stiffness", 0.1, 2 / (0.011 * 0.011)},
        {RHEO_SCHEME_SUMMED, "plasticity_number", "springs.plasticity", 1, 1 / (0.011 * 1.02)},
        {RHEO_SCHEME_SUMMED, "vibrator_speed", "vibrators.amplitude", 0.5, 2 / (0.011 * 2 * 3.14159265358979 * 5)},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int out = 0; out < 2; out++) {
            char value[32];
            rheo_world_def def = quiet_def(cases[i].scheme);
            def.substeps = 3;
            def.vibrators.position = some_vibrators();
            def.vibrators.count = 1;
            def.walls.plane = some_walls();
            def.walls.count = 1;
            walls_of(&def)[0] = (rheo_wall){{0, -50, 0}, {0, 1, 0}};
            snprintf(value, sizeof value, "%.12g", cases[i].limit * cases[i].scale * (out ? 1.001 : 0.999));
            OK(rheo_world_def_set(&def, cases[i].path, value, &error));
            file f = record_well(quiet_world(def), 3, NULL);
            rheo_diagnosis d = diagnose(&f);
            assert_healthy(&d, (uint32_t)out);
            if (out) {
                assert_string_equal(d.findings[0].measure, cases[i].measure);
                assert_int_equal(d.findings[0].step, 0);
                assert_int_equal(d.findings[0].steps, 4);
            }
            free(f.bytes);
        }
}

/* A condition beyond its second limit is the cause of a failure, and has its own stage. */
static void a_severe_condition_is_the_cause(void **state)
{
    (void)state;
    for (int certain = 0; certain < 2; certain++) {
        rheo_world_def def = quiet_def(RHEO_SCHEME_SEQUENTIAL);
        def.fluid.stiffness = (certain ? 0.201 : 0.199) * 2 / (0.033 * 0.033);
        file f = record_well(quiet_world(def), 20, NULL);
        forge(&f, 8, "stiffness_number", 3);
        forge(&f, 12, "max_spring_displacement", 0.7);
        forge(&f, 12, "max_pressure_displacement_id", 1);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, certain ? "pressure_number" : "stiffness_number",
                     certain ? "density" : "spring_displacement");
        assert_int_equal(d.cause.step, certain ? 12 : 8);
        assert_int_equal(d.unhealthy_step, 12);
        if (certain)
            assert_int_equal(d.cause.id, 1);
        free(f.bytes);
    }
    /* A ball slows down again after its impact. */
    for (int late = 0; late < 2; late++) {
        file f = quiet(NULL);
        forge(&f, 10, "ball_vx", 0.8 * 2 / 0.033);
        forge(&f, late ? 21 : 20, "max_pressure_displacement", 0.7);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, late ? "max_pressure_displacement" : "ball_speed", late ? "density" : "ball");
        free(f.bytes);
    }
}

static void precursors_count_if_they_lead_up_to_the_failure(void **state)
{
    (void)state;
    for (int gap = 10; gap <= 11; gap++) {
        file f = quiet(NULL);
        forge(&f, 12, "stiffness_number", 3);
        forge(&f, 12, "stiffness_a", 0);
        forge(&f, 12, "stiffness_b", 1);
        forge(&f, (uint64_t)(12 + gap), "max_spring_displacement", 0.6);
        forge(&f, 30, "max_spring_displacement", 7);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, gap == 10 ? "stiffness_number" : "max_spring_displacement", "spring_displacement");
        assert_int_equal(d.cause.step, gap == 10 ? 12 : 12 + gap);
        assert_int_equal(d.unhealthy_step, 12 + gap);
        if (gap == 10)
            assert_true(d.cause.id == 0 && d.cause.other_id == 1);
        /* The findings are in the order of steps, with peaks. */
        assert_int_equal(d.finding_count, 2);
        assert_string_equal(d.findings[0].measure, "stiffness_number");
        assert_true(d.findings[1].peak == 7 && d.findings[1].peak_step == 30 && d.findings[1].steps == 2);
        free(f.bytes);
    }
}

static void limits_follow_the_solver(void **state)
{
    (void)state;
    rheo_world_def def = quiet_def(RHEO_SCHEME_SEQUENTIAL);
    def.springs.solver = RHEO_SOLVER_IMPLICIT;
    for (int change = 0; change < 2; change++) {
        file f = record_well(quiet_world(def), 20, change ? make_implicit_then_explicit : NULL);
        for (uint64_t step = 1; step <= 10; step++) {
            forge(&f, step, "stiffness_number", 100);
            forge(&f, step, "stiffness_sum", 1000);
        }
        rheo_diagnosis d = diagnose(&f);
        assert_healthy(&d, change ? 2 : 0);
        if (change) { /* the command precedes step 7, so the finding cannot be earlier */
            assert_int_equal(d.findings[0].step, 7);
            assert_int_equal(d.findings[0].steps, 4);
        }
        free(f.bytes);
    }
    /* Advice never names the solver that is already used. */
    file f = record_well(quiet_world(def), 20, NULL);
    forge(&f, 5, "max_spring_displacement", 2);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "max_spring_displacement", "spring_displacement");
    assert_int_equal(d.advice_count, 1);
    assert_string_equal(d.advice[0].set, "step=0.0041");
    free(f.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_measure_fires_beyond_its_limit),
        cmocka_unit_test(the_speed_of_the_ball_before_its_contact_counts),
        cmocka_unit_test(some_measures_count_only_in_motion),
        cmocka_unit_test(parameters_that_cannot_work_are_noticed),
        cmocka_unit_test(a_severe_condition_is_the_cause),
        cmocka_unit_test(precursors_count_if_they_lead_up_to_the_failure),
        cmocka_unit_test(limits_follow_the_solver),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
