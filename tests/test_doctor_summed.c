/* Diagnoses of scheme summed. Every cure that the doctor prints works on its sick scene. */
#define _POSIX_C_SOURCE 200809L
#define PATH "test_doctor_summed.rlog"
#include "doctor_support.h"

#include "forge.h"

/* A small scene that settled with the default parameters, with others from step 0 on; vibrators if they come first. */
static rheo_world *world_with(const char *const *set)
{
    rheo_scene scene = lively_scene();
    if (!*set || strncmp(*set, "vibrators.", 10) != 0)
        scene.world.vibrators.count = 0;
    for (const char *const *of_ball = set; *of_ball; of_ball += 2)
        if (strncmp(*of_ball, "ball.", 5) == 0)
            OK(rheo_scene_set(&scene, of_ball[0], of_ball[1], &error));
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    for (; *set; set += 2)
        OK(rheo_world_set(world, set[0], set[1], &error));
    return world;
}

/* The cure is applied to a recording's state, and the run continues well. */
static void assert_cured(const file *f, uint64_t from, const rheo_advice *advice)
{
    rheo_recording *recording;
    rheo_world *world;
    char path[64];
    snprintf(path, sizeof path, "%s", advice->set);
    char *value = strchr(path, '=');
    *value++ = 0;
    OK(rheo_recording_open_memory(f->bytes, f->size, &recording, &error));
    OK(rheo_recording_world(recording, from, NULL, &world, &error));
    rheo_recording_close(recording);
    OK(rheo_world_set(world, path, value, &error));
    file cured = record_well(world, 60, NULL);
    rheo_diagnosis d = diagnose(&cured);
    if (!d.healthy)
        fail_msg("%s does not help: %s", advice->set, d.why);
    free(cured.bytes);
}

static void every_cure_works(void **state)
{
    (void)state;
    static const struct {
        const char *set[9];
        const char *measure, *stage;
        uint32_t cures;
    } cases[] = {
        {{"substeps", "1", "fluid.stiffness", "1100", NULL}, "pressure_number", "forces", 1},
        {{"max_substeps", "2", "fluid.stiffness", "2200", NULL}, "pressure_number", "forces", 2},
        {{"substeps", "2", "step", "0.1", NULL}, "pressure_number", "forces", 1},
        {{"substeps", "1", "fluid.near_stiffness", "1500", NULL}, "near_pressure_number", "forces", 1},
        {{"max_substeps", "2", "fluid.near_stiffness", "6000", NULL}, "near_pressure_number", "forces", 2},
        {{"ball.velocity", "[0, -300, 0]", NULL}, "ball_speed", "ball", 1},
        {{"vibrators.amplitude", "30", "max_substeps", "2", NULL}, "vibrator_speed", "vibrators", 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_result result;
        file f = record(world_with(cases[i].set), 200, NULL, &result);
        rheo_diagnosis d = diagnose(&f);
        if (d.healthy)
            fail_msg("case %zu: %s", i, d.why);
        assert_cause(&d, cases[i].measure, cases[i].stage);
        assert_int_equal(d.advice_count, cases[i].cures);
        for (uint32_t k = 0; k < d.advice_count; k++)
            assert_cured(&f, d.cause.step > 1 ? d.cause.step - 1 : 0, &d.advice[k]);
        free(f.bytes);
    }
}

/* Springs are softened where the substeps are too few for them, so none is too stiff. */
static void no_spring_is_too_stiff(void **state)
{
    (void)state;
    static const char *const sets[][7] = {
        {"history.stiffness", "15000", "substeps", "2", NULL},
        {"springs.stiffness", "1e6", "history.stiffness", "1e8", NULL},
        {"springs.stiffness", "1e6", "history.stiffness", "1e8", "substeps", "2", NULL},
    };
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        file f = record_well(world_with(sets[i]), 100, NULL);
        rheo_diagnosis d = diagnose(&f);
        assert_healthy(&d, 1);
        assert_string_equal(d.findings[0].measure, "softened_springs");
        assert_string_equal(d.findings[0].seen, "stiffness_sum"); /* no particle has a number of springs */
        assert_true(d.findings[0].id >= 0 && d.findings[0].seen_value > 2);
        assert_string_equal(d.findings[0].stage, "substeps");
        assert_true(d.findings[0].id >= 0);
        free(f.bytes);
    }
}

/* A step of five times the default length, and fluid 50 times as stiff, need more substeps and nothing else. */
static void substeps_of_the_state_bear_long_steps_and_stiff_fluid(void **state)
{
    (void)state;
    static const char *const sets[][5] = {{"step", "0.1", NULL},
                                          {"fluid.stiffness", "15000", "fluid.near_stiffness", "25000", NULL}};
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        file f = record_well(world_with(sets[i]), 60, NULL);
        rheo_diagnosis d = diagnose(&f);
        if (!d.healthy)
            fail_msg("%s", d.why);
        free(f.bytes);
    }
}

/* ---- A ball that passes through the pool ---- */

static void push_hard(rheo_world *world, int step)
{
    if (step != 3)
        return;
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    OK(rheo_world_push_body(world, 0, (const double[3]){0, -2000 * ball.mass, 0}, NULL, &error));
}

/* It is at the floor after one step and at rest, so nothing of its speed is left to see. */
static void a_ball_pushed_through_the_pool_is_seen(void **state)
{
    (void)state;
    for (int sequential = 0; sequential < 2; sequential++) {
        rheo_scene scene = lively_scene();
        rheo_world *world;
        scene.world.vibrators.count = 0;
        scene.world.scheme = sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
        OK(rheo_scene_create_world(&scene, &world, &error));
        rheo_result result;
        file f = record(world, 4, push_hard, &result);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, "ball_speed", "ball");
        assert_int_equal(d.unhealthy_step, 4);
        assert_true(finding(&d, "ball_speed")->value > 2000 * 0.033 / 4 - 1);
        assert_non_null(finding(&d, "ball_stop"));
        free(f.bytes);
    }
}

/* Names a metric otherwise, as if the recording had been made before there was one. */
static void rename_metric(file *f, const char *from, const char *to)
{
    static forged chunks;
    const size_t length = strlen(from), room = 4 * f->size;
    forge_open(&chunks, f->bytes, f->size, 1 << 26);
    forged_chunk *head = &chunks.chunk[0];
    size_t at = 0;
    while (at + length <= head->size && memcmp(head->data + at, from, length) != 0)
        at++;
    assert_true(at + length <= head->size && strlen(to) == length);
    memcpy(head->data + at, to, length);
    uint8_t *bytes = malloc(room);
    assert_non_null(bytes);
    memcpy(bytes, f->bytes, 8);
    f->size = forge_write(&chunks, true, bytes, room);
    assert_true(f->size > 0);
    free(f->bytes);
    f->bytes = bytes;
    forge_release(&chunks);
}

static void older_recordings_have_the_speed_after_the_step(void **state)
{
    (void)state;
    rheo_scene scene = lively_scene();
    rheo_world *world;
    rheo_result result;
    scene.world.scheme = RHEO_SCHEME_SEQUENTIAL;
    scene.world.vibrators.count = 0;
    OK(rheo_scene_create_world(&scene, &world, &error));
    file f = record(world, 4, push_hard, &result);
    rename_metric(&f, "ball_max_speed", "ball_old_speed");
    rheo_diagnosis d = diagnose(&f);
    assert_null(finding(&d, "ball_stop"));
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    OK(rheo_recording_world(recording, 4, NULL, &world, &error));
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    const double *v = ball.velocity, after = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * 0.033 / 4;
    rheo_world_destroy(world);
    rheo_recording_close(recording);
    const rheo_finding *speed = finding(&d, "ball_speed");
    assert_true(after < 14);
    if (after > 0.5)
        NEAR(speed->value, after, 1e-5 * after);
    else
        assert_null(speed);
    free(f.bytes);
}

/* ---- Warnings ---- */

static char warnings[1024];

static void keep_warning(const char *message, void *user)
{
    (void)user;
    snprintf(warnings + strlen(warnings), sizeof warnings - strlen(warnings), "%s\n", message);
}

static void assert_warning(const char *const *set, const char *expected)
{
    rheo_world_def def = rheo_default_world_def();
    rheo_world *world;
    def.log.message = keep_warning;
    warnings[0] = 0;
    for (; *set; set += 2)
        OK(rheo_world_def_set(&def, set[0], set[1], &error));
    OK(rheo_world_create(&def, &world, &error));
    rheo_world_destroy(world);
    if (expected)
        assert_in(expected, warnings);
    else
        assert_string_equal(warnings, "");
}

static void creation_warns_of_too_few_substeps(void **state)
{
    (void)state;
    assert_warning((const char *const[]){NULL}, NULL);
    assert_warning((const char *const[]){"substeps", "2", NULL}, NULL);
    assert_warning((const char *const[]){"substeps", "1", NULL},
                   "warning: pressure_number (fluid.stiffness substep^2 / support) is 0.0817, more than 0.06");
    assert_warning((const char *const[]){"fluid.stiffness", "2200", "max_substeps", "2", NULL},
                   "support) is 0.15, more than 0.085: expect the run to go bad; what helps: max_substeps=4 ");
    /* Pressure waves that cross several supports in a step need a shorter one: neighbours are listed once a step. */
    assert_warning((const char *const[]){"fluid.stiffness", "1e5", NULL},
                   "support) is 0.106, more than 0.085: expect the run to go bad; what helps: step=0.0089 (");
    assert_warning((const char *const[]){"springs.stiffness", "500", "substeps", "2", NULL},
                   "warning: springs.stiffness is too large for substeps: springs at rest will have only about 0.4");
    assert_warning((const char *const[]){"springs.stiffness", "500", NULL}, NULL);
    assert_warning((const char *const[]){"scheme", "sequential", "fluid.stiffness", "1000", NULL},
                   "pressure_number (fluid.stiffness step^2 / support) is 0.27");
}

/* More than 2^64 substeps: a conversion to an integer would have made few of them. */
static void no_impossible_number_of_substeps_is_advised(void **state)
{
    (void)state;
    assert_warning((const char *const[]){"step", "1e6", "fluid.stiffness", "1e29", NULL}, "expect the run to go bad");
    assert_null(strstr(warnings, "max_substeps="));
    assert_warning((const char *const[]){"step", "1e6", "fluid.near_stiffness", "1e29", NULL},
                   "expect the run to go bad");
    assert_null(strstr(warnings, "max_substeps="));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_cure_works),
        cmocka_unit_test(no_spring_is_too_stiff),
        cmocka_unit_test(substeps_of_the_state_bear_long_steps_and_stiff_fluid),
        cmocka_unit_test(a_ball_pushed_through_the_pool_is_seen),
        cmocka_unit_test(older_recordings_have_the_speed_after_the_step),
        cmocka_unit_test(creation_warns_of_too_few_substeps),
        cmocka_unit_test(no_impossible_number_of_substeps_is_advised),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
