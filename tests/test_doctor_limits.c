/* Each measure of the doctor fires exactly beyond its limit, in recordings with forged metrics. */
#define _POSIX_C_SOURCE 200809L
#define PATH "test_doctor_limits.rlog"
#include "doctor_support.h"
#include "world/measure.h"

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

/* Regression: the doctor knew no plates, and advised to leave a spacing between particles. */
static void a_plate_that_is_too_fast_is_named(void **state)
{
    (void)state;
    const rheo_real position[6] = {0, 0, 0, 15, 0, 0};
    for (int axis = 0; axis < 3; axis++)
        for (int out = 0; out < 2; out++) {
            rheo_world_def def = quiet_def(RHEO_SCHEME_SUMMED);
            def.space.period[0] = def.space.period[2] = 30;
            def.plates.lower = -50;
            def.plates.upper = 50;
            /* Half a support of 2 in a step, along x with a swing of 2 pi 0.2 0.5 and otherwise without. */
            const double most = 1 / def.step * (out ? 1.001 : 0.999), swing = 6.283185307179586 * .2 * .5;
            def.plates.velocity[axis] = axis == 0 ? -(most - swing) : most;
            def.plates.amplitude = axis == 0 ? .2 : 0;
            def.plates.frequency = .5;
            file f = record_well(world_of(def, 2, position, NULL), 3, NULL);
            rheo_diagnosis d = diagnose(&f);
            assert_healthy(&d, (uint32_t)out);
            if (out) {
                assert_string_equal(d.findings[0].measure, "plate_speed");
                assert_string_equal(d.findings[0].stage, "plates");
            }
            free(f.bytes);
            def.plates.control = RHEO_PLATES_STRESS; /* velocity has no effect */
            f = record_well(world_of(def, 2, position, NULL), 3, NULL);
            d = diagnose(&f);
            assert_healthy(&d, 0);
            free(f.bytes);
        }
}

/* The number of each advice follows from what was measured; it is printed rounded down to two digits. */
static void advice_has_the_numbers_that_it_says(void **state)
{
    (void)state;
    const double angular = 2 * 3.14159265358979 * 5, step = 0.033;
    const struct {
        const char *path; /* is set, unless NULL */
        double value;
        const char *cause, *metric[2]; /* forged in step 20 */
        double metric_value[2];
        const char *advice[2];
        double advised[2];
    } cases[] = {
        {"vibrators.amplitude",
         1.5 * 2 / (step * angular),
         "vibrator_speed",
         {"max_speed", NULL},
         {1.5 * 2 / step, 0},
         {"vibrators.amplitude", NULL},
         {0.1 * 2 / (step * angular), 0}},
        {"springs.plasticity",
         2 / (step * 1.02),
         "plasticity_number",
         {"stiffness_number", "max_spring_displacement"},
         {3, 0.7},
         {"springs.plasticity", "step"},
         {1 / (step * 1.02), step / 2}},
        {NULL,
         0,
         "ball_speed",
         {"ball_vx", "max_pressure_displacement"},
         {0.8 * 2 / step, 0.7},
         {"step", NULL},
         {step * 0.5 / 0.8, 0}},
        {NULL,
         0,
         "max_spring_displacement",
         {"max_spring_displacement", NULL},
         {0.7, 0},
         {"step", NULL},
         {step * 0.25 / 0.7, 0}},
        {NULL,
         0,
         "max_pressure_displacement",
         {"max_pressure_displacement", NULL},
         {2, 0},
         {"step", NULL},
         {step * 0.25 / 2, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_world_def def = quiet_def(RHEO_SCHEME_SEQUENTIAL);
        if (i == 0) {
            def.vibrators.position = some_vibrators();
            def.vibrators.count = 1;
            def.walls.plane = some_walls();
            def.walls.count = 1;
            walls_of(&def)[0] = (rheo_wall){{0, -50, 0}, {0, 1, 0}};
        }
        char text[32];
        snprintf(text, sizeof text, "%.12g", cases[i].value);
        if (cases[i].path)
            OK(rheo_world_def_set(&def, cases[i].path, text, &error));
        file f = record_well(quiet_world(def), 30, NULL);
        for (int m = 0; m < 2 && cases[i].metric[m]; m++)
            forge(&f, 20, cases[i].metric[m], cases[i].metric_value[m]);
        const rheo_diagnosis d = diagnose(&f);
        assert_false(d.healthy);
        assert_string_equal(d.cause.measure, cases[i].cause);
        for (uint32_t a = 0; a < 2 && cases[i].advice[a]; a++) {
            const char *equals = strchr(d.advice[a].set, '=');
            assert_true(a < d.advice_count && equals);
            assert_int_equal(strncmp(d.advice[a].set, cases[i].advice[a], strlen(cases[i].advice[a])), 0);
            const double share = atof(equals + 1) / cases[i].advised[a];
            assert_true(share > 0.9 && share < 1 + 1e-9);
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
    /* The first sign is the first step of those without a gap. */
    file f = quiet(NULL);
    static const int fast[] = {8, 11, 12, 13};
    for (size_t i = 0; i < sizeof fast / sizeof *fast; i++)
        forge(&f, fast[i], "ball_vx", 0.8 * 2 / 0.033);
    forge(&f, 14, "max_pressure_displacement", 0.7);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "ball_speed", "ball");
    assert_int_equal(d.sign_step, 11);
    free(f.bytes);
}

/* The finding of a measure with a particle of its own names the particle that has the value printed, in the step printed. */
static void assert_own_particle(const rheo_diagnosis *d, uint64_t step, double value, int64_t id)
{
    const rheo_finding *c = &d->cause;
    char words[160];
    assert_int_equal(c->step, step);
    assert_true(c->value == value && c->seen_value == value);
    assert_int_equal(c->id, id);
    assert_string_equal(c->seen, c->measure);
    assert_int_equal(c->seen_step, step);
    snprintf(words, sizeof words, "step %u, stage ", (unsigned)step);
    assert_in(words, d->why);
    snprintf(words, sizeof words, "is %.3g, more than %.3g, particle %u", value, c->limit, (unsigned)id);
    assert_in(words, d->why);
}

/*
 * Numbers of the parameters have no particle: the one in which they show is named with the measure and the value that
 * it has there, and each value is of the step printed with it.
 */
static void the_particle_named_has_the_value_printed(void **state)
{
    (void)state;
    file f = quiet(NULL);
    forge(&f, 11, "max_pressure_displacement", 0.6);
    forge(&f, 11, "max_pressure_displacement_id", 1);
    forge(&f, 12, "max_pressure_displacement", 0.7);
    forge(&f, 12, "max_pressure_displacement_id", 0);
    rheo_diagnosis d = diagnose(&f);
    assert_own_particle(&d, 11, 0.6, 1);
    assert_true(d.cause.peak == 0.7 && d.cause.peak_step == 12);
    free(f.bytes);
    /* A condition that is always certain shows in the step that makes the run unhealthy. */
    rheo_world_def def = quiet_def(RHEO_SCHEME_SEQUENTIAL);
    def.fluid.stiffness = 0.201 * 2 / (0.033 * 0.033);
    f = record_well(quiet_world(def), 20, NULL);
    forge(&f, 12, "max_spring_displacement", 0.7);
    forge(&f, 12, "max_pressure_displacement", 0.3);
    forge(&f, 12, "max_pressure_displacement_id", 1);
    for (int known = 0; known < 2; known++) {
        forge(&f, 12, "max_spring_displacement_id", known ? 0 : -1);
        d = diagnose(&f);
        assert_cause(&d, "pressure_number", "density");
        assert_in(
            "step 12, stage density: pressure_number (fluid.stiffness step^2 / support) is 0.201, more than 0.2; ",
            d.why);
        assert_in(known ? "; max_spring_displacement is 0.7 at particle 0"
                        : "; max_pressure_displacement is 0.3 at particle 1",
                  d.why);
        assert_int_equal(d.cause.id, known ? 0 : 1);
    }
    free(f.bytes);
    /* The ball is slow again when what it did shows. Its speed is that of the step printed with it. */
    f = quiet(NULL);
    forge(&f, 10, "ball_vx", 0.8 * 2 / 0.033);
    forge(&f, 10, "max_pressure_displacement_id", 0);
    forge(&f, 14, "max_pressure_displacement", 0.7);
    forge(&f, 14, "max_pressure_displacement_id", 1);
    d = diagnose(&f);
    assert_cause(&d, "ball_speed", "ball");
    assert_int_equal(d.cause.step, 10);
    assert_in(
        "step 10, stage ball: ball_speed (how far the ball moves in a step, in supports) is 0.8, more than 0.75; "
        "max_pressure_displacement is 0.7 at particle 1 in step 14",
        d.why);
    assert_true(d.cause.id == 1 && d.cause.seen_step == 14 && d.cause.seen_value == 0.7);
    free(f.bytes);
}

/* One particle flies away at a speed that is known. */
static void a_fast_particle_is_the_one_named(void **state)
{
    (void)state;
    for (uint32_t sick = 0; sick < 3; sick++) {
        const rheo_real position[9] = {0, 0, 0, 50, 0, 0, 100, 0, 0};
        rheo_real velocity[9] = {0};
        velocity[3 * sick + 2] = 500; /* 8.25 supports a step */
        file f = record_well(world_of(quiet_def(RHEO_SCHEME_SUMMED), 3, position, velocity), 3, NULL);
        rheo_diagnosis d = diagnose(&f);
        const rheo_finding *fast = finding(&d, "courant_number");
        assert_non_null(fast);
        assert_int_equal(fast->id, sick);
        assert_true(fast->step == 0 && fast->seen_step == 0 && fast->seen_value == fast->value);
        NEAR(fast->value, 500 * 0.033 / 2, 1e-5);
        free(f.bytes);
    }
}

/* 0.5004 is more than 0.5, and so it must read. */
static void numbers_that_differ_are_printed_differently(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *words;
    } cases[] = {{0.5004, "is 0.5004, more than 0.5, particle 1"},
                 {0.500000001, "is 0.500000001, more than 0.5, particle 1"},
                 {0.5 + 0x1p-53, "is 0.5000000000000001, more than 0.5, particle 1"},
                 {0.6004, "is 0.6, more than 0.5, particle 1"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        file f = quiet(NULL);
        forge(&f, 11, "max_pressure_displacement", cases[i].value);
        forge(&f, 11, "max_pressure_displacement_id", 1);
        rheo_diagnosis d = diagnose(&f);
        assert_in(cases[i].words, d.why);
        free(f.bytes);
    }
}

/* `info` explains its pressure by the limits of the doctor, and has its value. */
static void derived_numbers_have_the_limits_of_the_doctor(void **state)
{
    (void)state;
    rheo_derived pressure = {0};
    rheo_world_def def = quiet_def(RHEO_SCHEME_SUMMED);
    for (uint32_t i = 0; rheo_world_def_derived(&def, i, &pressure) && strcmp(pressure.name, "pressure") != 0; i++)
        ;
    for (int sequential = 0; sequential < 2; sequential++)
        for (int certain = 0; certain < 2; certain++) {
            char words[64], limit[32];
            def = quiet_def(sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED);
            const rheo__measures *measures = rheo__measures_of(&def);
            const rheo__measure *row = &measures->row[rheo__measure_index(measures, "pressure_number")];
            rheo_number_text(certain ? row->certain : row->limit, limit);
            snprintf(words, sizeof words,
                     sequential ? certain ? ", %s)" : "(scheme sequential: %s, "
                     : certain  ? "above %s expect it to"
                                : "above %s a run may go bad",
                     limit);
            assert_in(words, pressure.meaning);
        }
    def = quiet_def(RHEO_SCHEME_SUMMED);
    def.substeps = 2;
    def.fluid.stiffness = 0.07 * 2 * 4 / (0.033 * 0.033);
    for (uint32_t i = 0; rheo_world_def_derived(&def, i, &pressure) && strcmp(pressure.name, "pressure") != 0; i++)
        ;
    file f = record_well(quiet_world(def), 2, NULL);
    rheo_diagnosis d = diagnose(&f);
    NEAR(finding(&d, "pressure_number")->value, pressure.value, 1e-12);
    NEAR(pressure.value, 0.07, 1e-12);
    free(f.bytes);
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
        cmocka_unit_test(a_plate_that_is_too_fast_is_named),
        cmocka_unit_test(advice_has_the_numbers_that_it_says),
        cmocka_unit_test(a_severe_condition_is_the_cause),
        cmocka_unit_test(the_particle_named_has_the_value_printed),
        cmocka_unit_test(a_fast_particle_is_the_one_named),
        cmocka_unit_test(numbers_that_differ_are_printed_differently),
        cmocka_unit_test(derived_numbers_have_the_limits_of_the_doctor),
        cmocka_unit_test(precursors_count_if_they_lead_up_to_the_failure),
        cmocka_unit_test(limits_follow_the_solver),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
