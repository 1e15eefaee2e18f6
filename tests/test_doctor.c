/*
 * Diagnoses: what went bad is named by measure, step, stage and particle; what did not, is healthy; and every measure
 * fires exactly beyond its limit, shown with recordings whose metrics are forged.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <unistd.h>
#include <zlib.h>

#include "melting.h"

/* ---- Recordings ---- */

typedef struct file {
    uint8_t *bytes;
    size_t size;
} file;

static file read_and_remove(const char *path)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    fseek(stream, 0, SEEK_END);
    file f = {NULL, (size_t)ftell(stream)};
    rewind(stream);
    f.bytes = malloc(f.size);
    assert_int_equal(fread(f.bytes, 1, f.size, stream), f.size);
    fclose(stream);
    remove(path);
    return f;
}

typedef void give(rheo_world *world, int step);

/* Records a world, which is destroyed; `commands` (or NULL) is asked before every step. Stops where a step fails. */
static file record(rheo_world *world, int steps, give *commands, rheo_result *result)
{
    static const char PATH[] = "test_doctor.rlog";
    rheo_recorder *recorder;
    rheo_error why = {""};
    rheo_record_options options = {.scene = "doctor", .keyframe_spacing = 100000, .force = true};
    *result = RHEO_OK;
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (int step = 0; step < steps && *result == RHEO_OK; step++) {
        if (commands)
            commands(world, step);
        *result = rheo_recorder_step(recorder, &why);
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    return read_and_remove(PATH);
}

static file record_well(rheo_world *world, int steps, give *commands)
{
    rheo_result result;
    file f = record(world, steps, commands, &result);
    assert_int_equal(result, RHEO_OK);
    return f;
}

static rheo_diagnosis diagnose(const file *f)
{
    static rheo_diagnosis d;
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f->bytes, f->size, &recording, &error));
    OK(rheo_diagnose(recording, &d, &error));
    rheo_recording_close(recording);
    return d;
}

static const rheo_finding *finding(const rheo_diagnosis *d, const char *measure)
{
    for (uint32_t i = 0; i < d->finding_count; i++)
        if (strcmp(d->findings[i].measure, measure) == 0)
            return &d->findings[i];
    return NULL;
}

static void assert_in(const char *part, const char *text)
{
    if (!strstr(text, part))
        fail_msg("\"%s\" is missing in: %s", part, text);
}

static void assert_healthy(const rheo_diagnosis *d, uint32_t notices)
{
    if (!d->healthy || d->finding_count != notices)
        fail_msg("%u out of range: %s", d->finding_count, d->why);
    assert_int_equal(d->advice_count, 0);
    assert_int_equal(strncmp(d->why, "healthy", 7), 0);
}

static void assert_cause(const rheo_diagnosis *d, const char *measure, const char *stage)
{
    if (d->healthy || strcmp(d->cause.measure, measure) != 0 || strcmp(d->cause.stage, stage) != 0)
        fail_msg("%s, %s is not: %s", measure, stage, d->why);
    assert_int_equal(strncmp(d->why, "unhealthy", 9), 0);
}

/* ---- Runs that go bad ---- */

/* A ball on a pool whose history stiffens springs more than a step of .033 bears: k_hist = ratio k_min. */
static rheo_world *stiff_world(double ratio)
{
    rheo_scene scene = lively_scene();
    scene.world.vibrators.count = 0;
    scene.world.springs.stiffness = 37.5;
    scene.world.history.stiffness = ratio * 37.5;
    scene.world.history.window = 150;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/*
 * A run that such springs bring down, after they have thrown particles for some steps. Which ratio does is chance:
 * doubles have room for particles that are thrown for ever. So the first that does is taken.
 */
static file record_stiff(void)
{
    for (double ratio = 30; ratio < 200; ratio += 5) {
        rheo_result result;
        file f = record(stiff_world(ratio), 200, NULL, &result);
        rheo_recording *recording;
        OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
        uint64_t last = rheo_recording_get_info(recording).last_step;
        rheo_recording_close(recording);
        if (result == RHEO_ERROR_STATE && last >= 5)
            return f;
        free(f.bytes);
    }
    fail_msg("springs of any stiffness do no harm");
    return (file){NULL, 0};
}

static void springs_that_are_too_stiff_are_named(void **state)
{
    (void)state;
    file f = record_stiff();
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "stiffness_number", "spring_displacement");
    assert_true(d.failed && d.complete);
    assert_int_equal(d.failure.step, d.last_step + 1);
    assert_true(d.unhealthy_step <= d.failure.step && d.cause.step <= d.unhealthy_step);
    assert_true(d.cause.value > 2.4 && d.cause.limit == 2.4);
    assert_in("went bad: after stage spring_displacement", d.why);

    /* The spring is one, and is as stiff as it says, in the step that it says. */
    rheo_recording *recording;
    rheo_world *world;
    rheo_spring_state spring;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    OK(rheo_recording_world(recording, d.cause.step - 1, NULL, &world, &error));
    assert_true(d.cause.id >= 0 && d.cause.other_id > d.cause.id);
    uint32_t a = (uint32_t)d.cause.id, b = (uint32_t)d.cause.other_id;
    if (rheo_world_spring(world, a, b, &spring, NULL) == RHEO_OK)
        NEAR(spring.stiffness * 0.033 * 0.033, d.cause.value, 1e-4 * d.cause.value);
    OK(rheo_world_step(world, &error));
    NEAR(metric(world, "stiffness_number"), d.cause.value, 0);
    OK(rheo_world_spring(world, a, b, &spring, &error));
    rheo_world_destroy(world);

    /* The step that could not be made is looked at as far as it came: what it did not measure does not count again.
     */
    assert_int_equal(finding(&d, "stiffness_number")->peak_step, d.failure.step);
    double values[64];
    uint64_t fast = 0;
    uint32_t courant = 0;
    while (strcmp(rheo_recording_metric_name(recording, courant), "courant_number") != 0)
        courant++;
    for (uint64_t step = 0; step <= d.last_step; step++) {
        OK(rheo_recording_metrics(recording, step, values, &error));
        fast += values[courant] > 0.5;
    }
    assert_true(fast > 0 && values[courant] > 0.5);
    assert_int_equal(finding(&d, "courant_number")->steps, fast);

    /* Each piece of advice, taken before the step that went bad, brings the run through what killed it. */
    assert_true(d.advice_count >= 3);
    assert_string_equal(d.advice[0].set, "springs.solver=implicit");
    assert_in("step=0.0", d.advice[1].set);
    assert_in("history.stiffness=", d.advice[2].set);
    for (uint32_t i = 0; i < d.advice_count; i++) {
        char path[64];
        snprintf(path, sizeof path, "%s", d.advice[i].set);
        char *value = strchr(path, '=');
        *value++ = 0;
        OK(rheo_recording_world(recording, d.cause.step - 1, NULL, &world, &error));
        OK(rheo_world_set(world, path, value, &error));
        step(world, 60);
        rheo_world_destroy(world);
    }
    rheo_recording_close(recording);
    free(f.bytes);
}

/* The pressure stage beyond what a step bears, with springs that tear first and with none. */
static void pressure_that_is_too_stiff_is_named(void **state)
{
    (void)state;
    for (int springs = 0; springs < 2; springs++) {
        rheo_scene scene = lively_scene();
        scene.settle.time = 0;
        scene.world.vibrators.count = 0;
        scene.world.ball.radius = 0;
        scene.world.fluid.stiffness = 0.3 * scene.world.fluid.support / (0.033 * 0.033);
        scene.world.fluid.near_stiffness = scene.world.fluid.stiffness * 5 / 3;
        if (!springs)
            scene.world.springs.stiffness = scene.world.history.stiffness = 0;
        rheo_world *world;
        rheo_result result;
        OK(rheo_scene_create_world(&scene, &world, &error));
        file f = record(world, 300, NULL, &result);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, "pressure_number", "density");
        NEAR(d.cause.value, 0.3, 1e-6);
        assert_true(d.cause.id >= 0 && d.advice_count == 2);
        assert_true(d.cause.step > 0 && d.cause.step <= d.last_step);
        assert_string_equal(d.advice[1].set, "fluid.stiffness=580");
        free(f.bytes);
    }
}

/* A block as dense as eight: pressure throws it apart in its first step. */
static void a_start_that_is_too_dense_is_ill_at_once(void **state)
{
    (void)state;
    rheo_real position[3 * 216];
    for (uint32_t i = 0; i < 216; i++) {
        position[3 * i] = (rheo_real)(i % 6);
        position[3 * i + 1] = (rheo_real)(i / 6 % 6) + (rheo_real)0.01 * (rheo_real)(i % 5);
        position[3 * i + 2] = (rheo_real)(i / 36);
    }
    rheo_world_def def = rheo_default_world_def();
    rheo_result result;
    file f = record(world_of(def, 216, position, NULL), 10, NULL, &result);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "max_pressure_displacement", "density");
    assert_int_equal(d.cause.step, 1);
    assert_in("too close", d.advice[0].text);
    assert_string_equal(d.advice[0].set, "");
    free(f.bytes);
}

/* A recording that begins in the middle of an illness: a checkpoint knows how its last step went. */
static void what_begins_ill_is_ill_at_its_first_step(void **state)
{
    (void)state;
    file f = record_stiff();
    rheo_diagnosis d = diagnose(&f);
    rheo_recording *recording;
    rheo_world *world;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    OK(rheo_recording_world(recording, d.last_step, NULL, &world, &error));
    void *bytes;
    size_t size;
    OK(rheo_world_save_memory(world, "ill", &bytes, &size, &error));
    rheo_world_destroy(world);
    rheo_recording_close(recording);
    file checkpoint = {bytes, size};
    rheo_diagnosis later = diagnose(&checkpoint);
    assert_cause(&later, "stiffness_number", "spring_displacement");
    assert_int_equal(later.cause.step, d.last_step);
    assert_int_equal(later.first_step, d.last_step);
    free(f.bytes);
    free(bytes);
}

/* ---- Runs that do not ---- */

static void make_implicit_then_explicit(rheo_world *world, int step)
{
    if (step == 3)
        OK(rheo_world_set(world, "gravity", "[0, -1, 0]", &error)); /* which changes no limit */
    if (step == 6)
        OK(rheo_world_set(world, "springs.solver", "explicit", &error));
}

static void healthy_runs_are_healthy(void **state)
{
    (void)state;
    rheo_diagnosis d;
    file f = record_well(lively_world(), 150, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    assert_int_equal(d.last_step, 150);
    free(f.bytes);

    rheo_scene scene = lively_scene();
    scene.world.history.stiffness = 15000; /* kappa above 50, which implicit springs bear */
    scene.world.springs.solver = RHEO_SOLVER_IMPLICIT;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    f = record_well(world, 100, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);

    scene.world.springs.stiffness = scene.world.history.stiffness = 0;
    OK(rheo_scene_create_world(&scene, &world, &error));
    f = record_well(world, 100, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
}

static void add_fast_ones(rheo_world *world, int step)
{
    const rheo_real position[6] = {0, 50, 0, 40, 50, 0}, velocity[6] = {0, 0, 300, 0, 0, 300};
    if (step == 4)
        OK(rheo_world_add_particles(world, 2, position, velocity, &error));
}

static void small_worlds_are_healthy(void **state)
{
    (void)state;
    const rheo_real one[3] = {0, 5, 0}, same[6] = {1, 1, 1, 1, 1, 1}, fast[3] = {1e5f, 0, 0};
    rheo_world_def def = rheo_default_world_def();
    file f = record_well(world_of(def, 0, NULL, NULL), 5, NULL);
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
    f = record_well(world_of(def, 1, one, NULL), 50, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
    f = record_well(world_of(def, 2, same, NULL), 50, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
    /* Flying fast alone is a notice at most, and so is what a command throws. */
    f = record_well(world_of(def, 1, one, fast), 5, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "courant_number");
    assert_int_equal(d.findings[0].step, 0);
    assert_int_equal(d.findings[0].id, 0);
    free(f.bytes);
    f = record_well(world_of(def, 1, one, NULL), 8, add_fast_ones);
    d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "courant_number");
    assert_int_equal(d.findings[0].step, 5);
    free(f.bytes);
    /* No step at all. */
    f = record_well(world_of(def, 1, one, NULL), 0, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
}

/* ---- Forged metrics ---- */

static uint64_t number(const uint8_t *at, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = bytes; i-- > 0;)
        value = value << 8 | at[i];
    return value;
}

static void put(uint8_t *at, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

static void seal(uint8_t *chunk)
{
    size_t stored = (size_t)number(chunk + 16, 8);
    put(chunk + 32 + stored, crc32(0, chunk, (uInt)(32 + stored)), 4);
}

/* The chunk of this type and step. */
static uint8_t *chunk_of(const file *f, const char *type, uint64_t step)
{
    for (size_t at = 8; at < f->size; at += 36 + (size_t)number(f->bytes + at + 16, 8))
        if (memcmp(f->bytes + at, type, 4) == 0 && number(f->bytes + at + 8, 8) == step)
            return f->bytes + at;
    fail_msg("no chunk %s of step %llu", type, (unsigned long long)step);
    return NULL;
}

/* Metrics stand at the end of a STEP, which is not compressed. */
static void forge(const file *f, uint64_t step, const char *name, double value)
{
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f->bytes, f->size, &recording, &error));
    uint32_t count = rheo_recording_metric_count(recording), index = 0;
    while (index < count && strcmp(rheo_recording_metric_name(recording, index), name) != 0)
        index++;
    rheo_recording_close(recording);
    assert_true(index < count);
    uint8_t *chunk = chunk_of(f, "STEP", step);
    assert_int_equal(number(chunk + 4, 4), 0);
    size_t stored = (size_t)number(chunk + 16, 8);
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(chunk + 32 + stored - 8 * (size_t)(count - index), bits, 8);
    seal(chunk);
}

/* Forty steps of a world in which nothing happens, with a ball that hangs in space. */
static rheo_world *quiet_world(const rheo_world_def *change)
{
    const rheo_real position[6] = {0, 0, 0, 50, 0, 0};
    rheo_world_def def = change ? *change : inert_def();
    if (!change)
        def.springs.stiffness = 1;
    def.ball.radius = 1;
    def.ball.position[1] = 100;
    return world_of(def, 2, position, NULL);
}

static file quiet(give *commands)
{
    return record_well(quiet_world(NULL), 40, commands);
}

static void every_measure_fires_beyond_its_limit(void **state)
{
    (void)state;
    static const struct {
        const char *measure, *metric, *stage, *also; /* also: the only other measure out of range then */
        double limit, scale;                         /* scale: of the metric in units of the measure */
        bool severe;
    } cases[] = {
        {"stiffness_number", "stiffness_number", "spring_displacement", NULL, 2.4, 1, false},
        {"stiffness_sum", "stiffness_sum", "spring_displacement", NULL, 45, 1, false},
        {"max_spring_displacement", "max_spring_displacement", "spring_displacement", NULL, 0.5, 1, true},
        {"max_pressure_displacement", "max_pressure_displacement", "density", NULL, 0.5, 1, true},
        {"speed_jump", "max_speed", "velocity", NULL, 1, 2 / 0.033, true},
        {"courant_number", "courant_number", "velocity", NULL, 0.5, 1, false},
        {"max_density", "max_density", "density", NULL, 2, 1, false},
        {"ball_speed", "ball_vz", "ball", NULL, 0.5, 2 / 0.033, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int out = 0; out < 2; out++) {
            file f = quiet(NULL);
            forge(&f, 20, cases[i].metric, cases[i].limit * cases[i].scale * (out ? 1 + 1e-6 : 1 - 1e-6));
            rheo_diagnosis d = diagnose(&f);
            if (!out) {
                assert_healthy(&d, 0);
            } else {
                if (d.finding_count != 1 || !finding(&d, cases[i].measure))
                    fail_msg("%s does not fire alone: %u: %s", cases[i].measure, d.finding_count, d.why);
                assert_int_equal(d.findings[0].step, 20);
                assert_string_equal(d.findings[0].stage, cases[i].stage);
                NEAR(d.findings[0].limit, cases[i].limit, 0);
                NEAR(d.findings[0].value, cases[i].limit, 2e-6 * cases[i].limit);
                assert_int_equal(d.findings[0].severe, cases[i].severe);
                assert_int_equal(d.findings[0].steps, 1);
                assert_int_equal(d.healthy, !cases[i].severe);
                if (cases[i].severe)
                    assert_cause(&d, cases[i].measure, cases[i].stage);
            }
            free(f.bytes);
        }
    /* Energy counts only where something moves. */
    file f = quiet(NULL);
    forge(&f, 20, "energy_jump", 2.01);
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 0);
    forge(&f, 20, "courant_number", 0.2);
    d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "energy_jump");
    free(f.bytes);
    /* A jump of speed is one as far as it is large against the speed. */
    for (int large = 0; large < 2; large++) {
        f = quiet(NULL);
        forge(&f, 20, "max_speed", 1000);
        forge(&f, 21, "max_speed", large ? 1501 : 1499);
        d = diagnose(&f);
        assert_int_equal(finding(&d, "speed_jump")->steps, large ? 2 : 1);
        free(f.bytes);
    }
    /* Energy that a vibrator brings is none. */
    rheo_world_def def = inert_def();
    def.vibrators.count = 1;
    def.vibrators.kind = RHEO_VIBRATOR_FORCE;
    f = record_well(quiet_world(&def), 20, NULL);
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
        const char *measure, *path;
        double limit,
            scale; /* scale: of the parameter in units of the measure, at a step of .033 and a support of 2 */
    } cases[] = {
        {"pressure_number", "fluid.stiffness", 0.16, 2 / (0.033 * 0.033)},
        {"near_pressure_number", "fluid.near_stiffness", 0.4, 2 / (0.033 * 0.033)},
        {"plasticity_number", "springs.plasticity", 1, 1 / (0.033 * 1.03)},
        {"vibrator_speed", "vibrators.amplitude", 0.5, 2 / (0.033 * 2 * 3.14159265358979 * 5)},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int out = 0; out < 2; out++) {
            char value[32];
            rheo_world_def def = inert_def();
            def.springs.stiffness = 1;
            def.vibrators.count = 1;
            def.walls.count = 1;
            def.walls.plane[0] = (rheo_wall){{0, -50, 0}, {0, 1, 0}};
            snprintf(value, sizeof value, "%.12g", cases[i].limit * cases[i].scale * (out ? 1.001 : 0.999));
            OK(rheo_world_def_set(&def, cases[i].path, value, &error));
            file f = record_well(quiet_world(&def), 3, NULL);
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

/* Beyond its second limit a condition is the cause of what goes bad, and shows where its own stage shows. */
static void conditions_take_the_blame(void **state)
{
    (void)state;
    for (int certain = 0; certain < 2; certain++) {
        rheo_world_def def = inert_def();
        def.springs.stiffness = 1;
        def.fluid.stiffness = (certain ? 0.201 : 0.199) * 2 / (0.033 * 0.033);
        file f = record_well(quiet_world(&def), 20, NULL);
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
    /* A ball is slow again once it has hit. */
    for (int late = 0; late < 2; late++) {
        file f = quiet(NULL);
        forge(&f, 10, "ball_vx", 0.8 * 2 / 0.033);
        forge(&f, late ? 21 : 20, "max_pressure_displacement", 0.7);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, late ? "max_pressure_displacement" : "ball_speed", late ? "density" : "ball");
        free(f.bytes);
    }
}

static void signs_count_as_far_as_they_lead_up(void **state)
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
        /* The story is in the order of steps, with peaks. */
        assert_int_equal(d.finding_count, 2);
        assert_string_equal(d.findings[0].measure, "stiffness_number");
        assert_true(d.findings[1].peak == 7 && d.findings[1].peak_step == 30 && d.findings[1].steps == 2);
        free(f.bytes);
    }
}

static void limits_follow_the_solver(void **state)
{
    (void)state;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 1;
    def.springs.solver = RHEO_SOLVER_IMPLICIT;
    for (int change = 0; change < 2; change++) {
        file f = record_well(quiet_world(&def), 20, change ? make_implicit_then_explicit : NULL);
        for (uint64_t step = 1; step <= 10; step++) {
            forge(&f, step, "stiffness_number", 100);
            forge(&f, step, "stiffness_sum", 1000);
        }
        rheo_diagnosis d = diagnose(&f);
        assert_healthy(&d, change ? 2 : 0);
        if (change) { /* the command before step 7, and no sooner */
            assert_int_equal(d.findings[0].step, 7);
            assert_int_equal(d.findings[0].steps, 4);
        }
        free(f.bytes);
    }
    /* And advice does not name the solver that is in force. */
    file f = record_well(quiet_world(&def), 20, NULL);
    forge(&f, 5, "max_spring_displacement", 2);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "max_spring_displacement", "spring_displacement");
    assert_int_equal(d.advice_count, 1);
    assert_string_equal(d.advice[0].set, "step=0.0041");
    free(f.bytes);
}

/* ---- Recordings that are not as they should be ---- */

static void absurd_metrics_do_no_harm(void **state)
{
    (void)state;
    static const double absurd[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 4294967296.0, -1, 0.5};
    static const char *const metrics[] = {"stiffness_number",
                                          "stiffness_a",
                                          "stiffness_b",
                                          "max_spring_displacement",
                                          "max_spring_displacement_id",
                                          "max_speed",
                                          "courant_number",
                                          "max_density_id",
                                          "energy_jump",
                                          "ball_vx",
                                          "max_density",
                                          "step"};
    for (size_t i = 0; i < sizeof absurd / sizeof *absurd; i++) {
        file f = quiet(NULL);
        for (size_t k = 0; k < sizeof metrics / sizeof *metrics; k++)
            for (uint64_t step = 5; step < 9; step++)
                forge(&f, step, metrics[k], absurd[(i + (k + step) % 2) % 8]);
        rheo_diagnosis d = diagnose(&f);
        assert_true(d.finding_count <= RHEO_MAX_FINDINGS);
        for (uint32_t k = 0; k < d.finding_count; k++)
            assert_true(d.findings[k].id >= -1 && d.findings[k].id <= UINT32_MAX && d.findings[k].steps > 0);
        free(f.bytes);
    }
    file f = quiet(NULL);
    forge(&f, 5, "max_spring_displacement", NAN);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "max_spring_displacement", "spring_displacement");
    assert_true(isnan(d.cause.value));
    assert_in("not a number", d.why);
    free(f.bytes);
}

/* An older recording lacks what was not yet measured. */
static void metrics_that_are_not_there_are_not_missed(void **state)
{
    (void)state;
    file f = quiet(NULL);
    forge(&f, 5, "max_spring_displacement", 2);
    forge(&f, 9, "stiffness_number", 3);
    uint8_t *head = chunk_of(&f, "HEAD", 0);
    size_t stored = (size_t)number(head + 16, 8);
    assert_int_equal(number(head + 4, 4), 0);
    for (size_t at = 32; at + 11 < 32 + stored; at++)
        if (memcmp(head + at, "max_spring_displacement", 11) == 0)
            head[at] = 'S';
    seal(head);
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "stiffness_number");
    free(f.bytes);
}

static void torn_recordings_are_diagnosed_as_far_as_they_go(void **state)
{
    (void)state;
    file f = quiet(NULL);
    forge(&f, 30, "max_spring_displacement", 2);
    size_t whole = f.size;
    f.size = (size_t)(chunk_of(&f, "STEP", 30) - f.bytes) + 40;
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 0);
    assert_false(d.complete);
    assert_int_equal(d.last_step, 29);
    assert_in("truncated after step 29", d.why);
    f.size = whole;
    uint8_t *after = chunk_of(&f, "STEP", 31);
    f.size = (size_t)(after - f.bytes) + 3;
    d = diagnose(&f);
    assert_cause(&d, "max_spring_displacement", "spring_displacement");
    assert_int_equal(d.last_step, 30);
    /* A step that is damaged inside is an error. */
    f.size = whole;
    after[32]++;
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    REFUSED(RHEO_ERROR_FORMAT, "damaged", rheo_diagnose(recording, &d, &error));
    rheo_recording_close(recording);
    free(f.bytes);
}

/* A step that could not be made without any measure out of range before: all that is known is where. */
static void a_failure_without_signs_is_still_named(void **state)
{
    (void)state;
    const bool large = sizeof(rheo_real) == 8;
    const rheo_real position[3] = {0, 0, 0}, velocity[3] = {large ? (rheo_real)1e303 : (rheo_real)3e38, 0, 0};
    rheo_world_def def = inert_def();
    def.step = large ? 1e6 : 10;
    rheo_result result;
    file f = record(world_of(def, 1, position, velocity), 3, NULL, &result);
    assert_int_equal(result, RHEO_ERROR_STATE);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "", "prediction");
    assert_int_equal(d.cause.step, 1);
    assert_int_equal(d.cause.id, 0);
    assert_true(d.advice_count == 1 && strncmp(d.advice[0].set, "step=5", 6) == 0);
    free(f.bytes);
}

static void make_fail(rheo_world *world, int step)
{
    if (step == 20)
        OK(rheo_world_set(world, "step", "1e6", &error));
}

/* Signs lead up to a step that fails as they do to a grave one: without a gap. */
static void signs_long_before_a_failure_are_not_its_cause(void **state)
{
    (void)state;
    const rheo_real position[3] = {0, 0, 0},
                    velocity[3] = {sizeof(rheo_real) == 8 ? (rheo_real)1e303 : (rheo_real)3e38, 0, 0};
    for (uint64_t gap = 10; gap <= 11; gap++) {
        rheo_world_def def = inert_def();
        def.step = 1e-12;
        rheo_result result;
        file f = record(world_of(def, 1, position, velocity), 30, make_fail, &result);
        assert_int_equal(result, RHEO_ERROR_STATE);
        forge(&f, 21 - gap, "stiffness_number", 3);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, gap == 10 ? "stiffness_number" : "", gap == 10 ? "spring_displacement" : "prediction");
        assert_int_equal(d.unhealthy_step, 21);
        assert_int_equal(d.cause.step, gap == 10 ? 11 : 21);
        free(f.bytes);
    }
}

static void commands_that_are_damaged_are_told(void **state)
{
    (void)state;
    file f = quiet(make_implicit_then_explicit);
    uint8_t *command = chunk_of(&f, "INPT", 4);
    assert_int_equal(number(command + 4, 4), 0);
    command[32 + 4 + 2] ^= 0x20; /* gravity becomes Gravity */
    seal(command);
    rheo_recording *recording;
    rheo_diagnosis d;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    REFUSED(RHEO_ERROR_FORMAT, "a command before step 4", rheo_diagnose(recording, &d, &error));
    rheo_recording_close(recording);
    free(f.bytes);
}

/* ---- Worlds that melt ---- */

/* What such a run is diagnosed with; the file is left to be looked into. */
static rheo_diagnosis diagnose_melting(uint32_t side, const char *const *set, int steps, file *f)
{
    rheo_result result;
    *f = record(melting_world(side, set), steps, NULL, &result);
    return diagnose(f);
}

/* Goes on from the step before the cause with a piece of advice. */
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

/* Substeps too long for sound: (c + speed) substep/h from 5/0.1 x 0.02 x 3. */
static void substeps_that_are_too_long_are_named(void **state)
{
    (void)state;
    static const char *const SET[] = {"melting.substeps", "1", "step", "0.07", NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(6, SET, 200, &f);
    assert_cause(&d, "substep_courant_number", "integration");
    assert_true(d.cause.value > 2.35 && d.cause.id >= 0 && finding(&d, "substep_courant_number")->step == 0);
    assert_in("melting.substeps=0", d.advice[0].set);
    assert_each_cures(&f, &d, 2, 60);
    free(f.bytes);
    /* Where the Courant number is what is too large, that is what is told. */
    static const char *const LARGE[] = {"melting.courant_number", "3.6", "step", "0.2", NULL};
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
        "melting.substeps", "4", "melting.solver", "explicit", "melting.viscosity", "1.5", "melting.rheology",
        "newtonian",        NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(6, SET, 100, &f);
    assert_cause(&d, "viscous_number", "viscosity");
    NEAR(d.cause.value, 0.02 / 4 * 1.5 / (0.1 * 0.1 * 0.16), 1e-6);
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

/* A step refused for its substeps tells how many they would be, and both ways out lead on. */
static void a_refused_step_is_told(void **state)
{
    (void)state;
    static const char *const SET[] = {
        "melting.solver", "explicit", "melting.jump_number_max", "200", "melting.max_substeps", "10", NULL};
    file f;
    rheo_diagnosis d = diagnose_melting(4, SET, 3, &f);
    assert_cause(&d, "", "substeps");
    assert_true(d.failed && d.failure.step == 1);
    assert_in("step 1 went bad: stage substeps cannot go on because of substeps of the world", d.why);
    assert_in("substeps, and melting.max_substeps is 10", d.why);
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
        double limit, scale, beside; /* beside: what else is out of range then, at most */
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

static void melting_parameters_that_cannot_work_are_noticed(void **state)
{
    (void)state;
    /* Of a world at rest but for its own small speeds, of substeps of 0.02 and h = 0.1. */
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
         "0.499",
         "0.501",
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
        cmocka_unit_test(springs_that_are_too_stiff_are_named),
        cmocka_unit_test(pressure_that_is_too_stiff_is_named),
        cmocka_unit_test(a_start_that_is_too_dense_is_ill_at_once),
        cmocka_unit_test(what_begins_ill_is_ill_at_its_first_step),
        cmocka_unit_test(healthy_runs_are_healthy),
        cmocka_unit_test(small_worlds_are_healthy),
        cmocka_unit_test(every_measure_fires_beyond_its_limit),
        cmocka_unit_test(parameters_that_cannot_work_are_noticed),
        cmocka_unit_test(conditions_take_the_blame),
        cmocka_unit_test(signs_count_as_far_as_they_lead_up),
        cmocka_unit_test(limits_follow_the_solver),
        cmocka_unit_test(absurd_metrics_do_no_harm),
        cmocka_unit_test(metrics_that_are_not_there_are_not_missed),
        cmocka_unit_test(torn_recordings_are_diagnosed_as_far_as_they_go),
        cmocka_unit_test(a_failure_without_signs_is_still_named),
        cmocka_unit_test(signs_long_before_a_failure_are_not_its_cause),
        cmocka_unit_test(commands_that_are_damaged_are_told),
        cmocka_unit_test(healthy_melting_runs_are_healthy),
        cmocka_unit_test(substeps_that_are_too_long_are_named),
        cmocka_unit_test(explicit_viscosity_that_is_too_large_is_named),
        cmocka_unit_test(heat_that_is_too_fast_is_named),
        cmocka_unit_test(a_fluid_that_is_too_soft_is_named),
        cmocka_unit_test(a_refused_step_is_told),
        cmocka_unit_test(every_melting_measure_fires_beyond_its_limit),
        cmocka_unit_test(melting_parameters_that_cannot_work_are_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
