/*
 * Recordings of the melting model, whose steps have substeps. A saved state is restored to the bit. Every run of a
 * stage can be reached. A difference is reported with its substep. Truncated, damaged and forged files are found.
 */
#include <zlib.h>

#include "forge.h"
#include "melting.h"
#include "record/recording.h"

enum { SIDE = 6, STEPS = 8, MOST_STAGES = 200 };

static rheo_error why; /* error of calls that may be refused */
static const char *const PATH = "test_melting_record.rlog", *const OTHER = "test_melting_record_2.rlog";

/* Kinds of world: default; isothermal; frozen; frozen and isothermal; as printed in the paper; summed densities. */
static const char *const SETS[][12] = {
    {NULL},
    {"melting.diffusivity", "0", NULL},
    {"melting.flow", "frozen", "melting.diffusivity", "0.2", NULL},
    {"melting.flow", "frozen", "melting.diffusivity", "0", NULL},
    {"paper.leapfrog", "on", "paper.xsph", "on", "melting.stress", "nested", "melting.jump_number_max", "10", NULL},
    {"melting.density", "summation", "melting.solver", "explicit", "melting.jump_number_max", "3", NULL},
};
enum { KINDS = sizeof SETS / sizeof *SETS };

/* Gives commands of every kind that such a world accepts, before the named steps. */
static void command(rheo_world *world, uint64_t step)
{
    const rheo_real position[6] = {(rheo_real)0.3, (rheo_real)0.9,  (rheo_real)0.3,
                                   (rheo_real)0.1, (rheo_real)0.95, 0},
                    velocity[6] = {0, -1, 0, 0, (rheo_real)-1.5, 0};
    if (step == 2)
        OK(rheo_world_set(world, "gravity", "[0.5, -3, 0]", &error));
    if (step == 3)
        OK(rheo_world_set(world, "melting.viscosity", "0.1", &error));
    if (step == 4)
        OK(rheo_world_add_particles(world, 2, position, velocity, &error));
    if (step == 5) {
        OK(rheo_world_set(world, "step", "0.03", &error));
        OK(rheo_world_set(world, "melting.courant_number", "0.6", &error));
    }
    if (step == 6)
        OK(rheo_world_set(world, "melting.substeps", "2", &error));
}

/* Records a world and keeps it; hashes (steps + 1) may be NULL. */
static file record(rheo_world *world, uint64_t steps, uint64_t spacing, bool full, bool commanded, uint64_t *hashes)
{
    rheo_recorder *recorder;
    rheo_record_options options = {.scene = "melting", .keyframe_spacing = spacing, .full = full, .force = true};
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (uint64_t step = 0; step < steps; step++) {
        if (hashes)
            hashes[step] = rheo_world_hash(world);
        if (commanded)
            command(world, step);
        OK(rheo_recorder_step(recorder, &error));
    }
    if (hashes)
        hashes[steps] = rheo_world_hash(world);
    OK(rheo_recorder_close(recorder, &error));
    return read_and_remove(PATH);
}

static file record_new(uint32_t side, const char *const *set, uint64_t steps, uint64_t spacing, bool full,
                       bool commanded)
{
    rheo_world *world = melting_world(side, set);
    file f = record(world, steps, spacing, full, commanded, NULL);
    rheo_world_destroy(world);
    return f;
}

static rheo_world *load(const file *f, uint64_t step)
{
    rheo_recording *r;
    rheo_world *world;
    OK(rheo_recording_open_memory(f->bytes, f->size, &r, &error));
    OK(rheo_recording_world(r, step, NULL, &world, &error));
    rheo_recording_close(r);
    return world;
}

static file save(const rheo_world *world)
{
    void *bytes;
    file f;
    OK(rheo_world_save_memory(world, "melting", &bytes, &f.size, &error));
    f.bytes = bytes;
    return f;
}

static rheo_verification verify(const file *f)
{
    static rheo_verification v;
    OK(rheo_verify_memory(f->bytes, f->size, &v, &error));
    return v;
}

static void assert_same(const file *f, uint64_t steps)
{
    rheo_verification v = verify(f);
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    assert_int_equal(v.steps, steps);
}

static void assert_in(const char *part, const char *text)
{
    if (!strstr(text, part))
        fail_msg("\"%s\" is missing in: %s", part, text);
}

/* ---- Saving and loading ---- */

static void a_loaded_world_continues_identically(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < KINDS; kind++) {
        rheo_world *world = melting_world(SIDE, SETS[kind]);
        const bool moves = rheo_world_definition(world)->melting.flow == RHEO_FLOW_ON;
        const uint64_t began = rheo_world_hash(world);
        for (uint64_t step = 0; step < STEPS; step++) {
            if (moves)
                command(world, step);
            file first = save(world);
            rheo_world *copy = load(&first, step);
            file second = save(copy);
            assert_int_equal(first.size, second.size);
            assert_memory_equal(first.bytes, second.bytes, first.size);
            for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
                assert_true(rheo_world_metric(copy, i) == rheo_world_metric(world, i));
            OK(rheo_world_step(world, &error));
            OK(rheo_world_step(copy, &error));
            assert_true(rheo_world_hash(copy) == rheo_world_hash(world));
            OK(rheo_world_step(copy, &error));
            rheo_world_destroy(copy);
            free(first.bytes);
            free(second.bytes);
        }
        assert_true(rheo_world_hash(world) != began);
        assert_true(kind != 0 || metric(world, "substeps") > 1);
        rheo_world_destroy(world);
    }
}

static void a_recording_replays(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < KINDS; kind++)
        for (int full = 0; full < 2; full++) {
            uint64_t hashes[STEPS + 1];
            rheo_world *world = melting_world(SIDE, SETS[kind]);
            const bool moves = rheo_world_definition(world)->melting.flow == RHEO_FLOW_ON;
            const char *kernels;
            file f = record(world, STEPS, 3, full, moves, hashes);
            /* Every SIMD variant reproduces the recorded hashes of every stage run. */
            for (uint32_t k = 0; (kernels = rheo_simd_available(k)); k++) {
                OK(rheo_use_simd(kernels, &error));
                assert_same(&f, STEPS);
            }
            OK(rheo_use_simd(rheo_simd_available(0), &error));
            rheo_recording *r;
            OK(rheo_recording_open_memory(f.bytes, f.size, &r, &error));
            assert_int_equal(rheo_recording_get_info(r).keyframes, 3);
            assert_int_equal(rheo_recording_definition(r)->model, RHEO_MODEL_MELTING);
            for (uint64_t step = 0; step <= STEPS; step++) {
                rheo_world *there;
                double metrics[64];
                OK(rheo_recording_world(r, step, NULL, &there, &error));
                assert_true(rheo_world_hash(there) == hashes[step]);
                OK(rheo_recording_metrics(r, step, metrics, &error));
                for (uint32_t i = 0; i < rheo_recording_metric_count(r); i++)
                    assert_true(metrics[i] == rheo_world_metric(there, i));
                rheo_world_destroy(there);
            }
            if (full && kind == 0) {
                rheo_recording_info info = rheo_recording_get_info(r);
                print_message("full: %.1f bytes a particle and step\n",
                              (double)info.step_bytes / STEPS / (double)info.particles);
            }
            rheo_recording_close(r);
            rheo_world_destroy(world);
            free(f.bytes);
        }
}

/* A full recording supplies its states even if this build would compute others. */
static void a_full_recording_is_not_simulated(void **unused)
{
    (void)unused;
    file f = record_new(3, NULL, 5, 100, true, false);
    rheo_world *whole = load(&f, 5);
    const uint64_t hash = rheo_world_hash(whole);
    rheo_world_destroy(whole);
    /* Another gravity in the first keyframe would change the hashes of a simulation. */
    static forged parts;
    forge_open(&parts, f.bytes, f.size, 1 << 24);
    bool changed = false;
    for (size_t i = 0; i < parts.count; i++)
        for (size_t at = 0; parts.chunk[i].type == RHEO__KEYF && at + 7 + 4 + 24 <= parts.chunk[i].size; at++)
            if (memcmp(parts.chunk[i].data + at, "gravity", 7) == 0) {
                const double stronger = -2;
                uint64_t bits;
                memcpy(&bits, &stronger, sizeof bits);
                forge_put(parts.chunk[i].data + at + 7 + 4 + 8, bits, 8);
                changed = true;
            }
    assert_true(changed);
    uint8_t *forged_bytes = malloc(f.size + 65536);
    file forgery = {forged_bytes, forge_write(&parts, true, forged_bytes, f.size + 65536)};
    assert_true(forgery.size > 0);
    rheo_world *there = load(&forgery, 5);
    assert_true(rheo_world_hash(there) == hash);
    rheo_world_destroy(there);
    rheo_verification v = verify(&forgery);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_string_equal(v.first.stage, "momentum@1");
    assert_int_equal(v.first.step, 1);
    assert_true(v.first.origin == RHEO_VALUES_STORED);
    forge_release(&parts);
    free(forged_bytes);
    free(f.bytes);
}

/* ---- Into the middle of a step ---- */

static void every_stage_run_can_be_reached(void **unused)
{
    (void)unused;
    file f = record_new(4, NULL, 4, 2, false, true);
    rheo_recording *r;
    rheo_player *player;
    OK(rheo_recording_open_memory(f.bytes, f.size, &r, &error));
    OK(rheo_player_open(r, NULL, &player, &error));
    for (uint64_t step = 4; step >= 1; step--) {
        char name[MOST_STAGES][32];
        uint64_t hash[MOST_STAGES];
        uint32_t made = 0, stage;
        rheo_world *own = load(&f, step - 1);
        command(own, step - 1);
        do {
            OK(rheo_world_step_stage(own, &stage, &error));
            rheo_stage_info info;
            OK(rheo_world_stage(own, stage, &info));
            rheo_world_last_stage(own, name[made]);
            if (name[made][0])
                assert_true(strncmp(name[made], info.name, strlen(info.name)) == 0);
            else
                snprintf(name[made], 32, "%s@%.0f", info.name, metric(own, "substeps"));
            hash[made++] = rheo_world_hash(own);
            assert_true(rheo_world_stages_done(own) == 0 || rheo_world_stages_in_step(own) >= made);
        } while (rheo_world_stages_done(own));
        assert_string_equal(name[0], "substeps");
        assert_string_equal(name[1], "neighbours@1");
        assert_true(made > 13 && made % 6 == 1); /* at least three substeps of six stages */
        /* Forwards, then backwards. */
        for (uint32_t n = 0; n < 2 * made; n++) {
            const uint32_t at = n < made ? n : 2 * made - 1 - n;
            OK(rheo_player_seek_stage(player, step, name[at], &error));
            assert_true(rheo_world_hash(rheo_player_world(player)) == hash[at]);
        }
        /* The first substep is meant if no number is given. */
        OK(rheo_player_seek_stage(player, step, "viscosity", &error));
        uint32_t viscosity = 0;
        while (strcmp(name[viscosity], "viscosity@1") != 0)
            viscosity++;
        assert_true(rheo_world_hash(rheo_player_world(player)) == hash[viscosity]);
        rheo_world_destroy(own);
    }
    REFUSED(RHEO_ERROR_ARGUMENT, "no viscosity@999 in it",
            rheo_player_seek_stage(player, 2, "viscosity@999", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "made once in a step", rheo_player_seek_stage(player, 2, "substeps@2", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "number of a substep", rheo_player_seek_stage(player, 2, "viscosity@0", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "number of a substep", rheo_player_seek_stage(player, 2, "viscosity@", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no stage", rheo_player_seek_stage(player, 2, "springs@1", &error));
    OK(rheo_player_seek(player, 4, &error));
    rheo_player_close(player);
    rheo_recording_close(r);
    free(f.bytes);
}

/* ---- Differences ---- */

static rheo_verification verify_changed(const file *f, const char *path, const char *value)
{
    static rheo_verification v;
    rheo_recording *r;
    rheo_world *world = melting_world(SIDE, NULL);
    OK(rheo_world_set(world, path, value, &error));
    rheo__world_forget_commands(world);
    OK(rheo_recording_open_memory(f->bytes, f->size, &r, &error));
    OK(rheo__verify_world(r, world, &v, &error));
    rheo_recording_close(r);
    rheo_world_destroy(world);
    return v;
}

static void a_changed_parameter_is_named(void **unused)
{
    (void)unused;
    static const struct {
        const char *path, *value, *stage, *field;
    } changes[] = {
        {"gravity", "[0, -1.001, 0]", "momentum@1", "velocity"},
        {"melting.sound_speed", "5.0001", "momentum@1", "velocity"},
        {"melting.alpha", "0.11", "momentum@1", "velocity"},
        {"melting.viscosity", "0.051", "viscosity@1", "velocity"},
        {"melting.tolerance", "0.00001", "viscosity@1", "velocity"},
        {"melting.diffusivity", "0.011", "integration@1", "temperature"},
        {"melting.xsph", "0.4", "integration@1", "position"},
        {"melting.substeps", "7", "substeps", "substeps"},
        {"melting.courant_number", "0.1", "substeps", "substeps"},
        {"step", "0.05", "substeps", "substeps"},
    };
    file f = record_new(SIDE, NULL, 3, 100, true, false);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        rheo_verification v = verify_changed(&f, changes[i].path, changes[i].value);
        if (v.verdict != RHEO_DIFFERS || v.first.step != 1 || strcmp(v.first.stage, changes[i].stage) != 0 ||
            strcmp(v.first.field, changes[i].field) != 0)
            fail_msg("%s: %s", changes[i].path, v.message);
        assert_in(changes[i].stage, v.message);
        assert_true(v.first.origin != RHEO_VALUES_NONE && v.has_hash && v.growth_count > 0);
        assert_int_equal(v.steps, 0);
    }
    /* A different number of substeps is reported with both numbers. */
    rheo_verification v = verify_changed(&f, "melting.substeps", "7");
    assert_true(v.first.expected > 1 && v.first.expected != 7 && v.first.actual == 7);
    free(f.bytes);
}

static void recordings_are_compared(void **unused)
{
    (void)unused;
    static const char *const OTHER_SET[] = {"melting.xsph", "0.4", NULL};
    static rheo_verification v;
    file a = record_new(4, NULL, 5, 2, false, true), b = record_new(4, OTHER_SET, 5, 2, false, true),
         c = record_new(4, NULL, 3, 100, false, true);
    OK(rheo_diff_memory(a.bytes, a.size, a.bytes, a.size, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    OK(rheo_diff_memory(a.bytes, a.size, c.bytes, c.size, &v, &error));
    assert_true(v.verdict == RHEO_DIFFERS && v.lengths_differ);
    assert_int_equal(v.steps, 3);
    OK(rheo_diff_memory(a.bytes, a.size, b.bytes, b.size, &v, &error));
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_int_equal(v.first.step, 1);
    assert_string_equal(v.first.stage, "integration@1");
    assert_string_equal(v.first.field, "position");
    assert_int_equal(v.first.origin, RHEO_VALUES_SIMULATED);
    /* Other commands lead to another number of substeps. */
    rheo_world *world = melting_world(4, NULL);
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    for (uint64_t step = 0; step < 5; step++) {
        command(world, step);
        if (step == 3)
            OK(rheo_world_set(world, "melting.courant_number", "0.1", &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    file d = read_and_remove(PATH);
    OK(rheo_diff_memory(a.bytes, a.size, d.bytes, d.size, &v, &error));
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_int_equal(v.first.step, 4);
    assert_string_equal(v.first.stage, "substeps");
    assert_string_equal(v.first.field, "substeps");
    assert_true(v.first.actual > v.first.expected && v.commands_differ && v.commands_step == 4);
    /* Recordings of different models cannot be compared. */
    world = lively_world();
    file e = record(world, 2, 100, false, false, NULL);
    rheo_world_destroy(world);
    for (int turned = 0; turned < 2; turned++) {
        const file *one = turned ? &e : &a, *two = turned ? &a : &e;
        OK(rheo_diff_memory(one->bytes, one->size, two->bytes, two->size, &v, &error));
        print_message("%s\n", v.message);
        assert_true(v.verdict != RHEO_SAME);
    }
    free(a.bytes);
    free(b.bytes);
    free(c.bytes);
    free(d.bytes);
    free(e.bytes);
}

/* ---- Forged and damaged files ---- */

static uint32_t metric_count(void)
{
    rheo_world *world = melting_world(2, NULL);
    const uint32_t count = rheo_world_metric_count(world);
    rheo_world_destroy(world);
    return count;
}

static size_t chunk_of(const forged *f, uint32_t type, uint64_t step)
{
    for (size_t i = 0; i < f->count; i++)
        if (f->chunk[i].type == type && f->chunk[i].step == step)
            return i;
    fail();
    return 0;
}

/* A step with too few hashes, too many or none is refused, even if the file's check sums match. */
static void a_wrong_number_of_hashes_is_refused(void **unused)
{
    (void)unused;
    file f = record_new(3, NULL, 3, 100, false, false);
    rheo_world *world = melting_world(3, NULL);
    const size_t once = rheo__world_trace_once(world), repeated = rheo__world_trace_repeated(world);
    rheo_world_destroy(world);
    assert_true(once == 2 && repeated == 9);
    const long changes[] = {
        -1, 1, -(long)repeated, (long)repeated, -(long)(once + repeated), 1 - (long)repeated, 1000 * (long)repeated};
    for (size_t n = 0; n < sizeof changes / sizeof *changes; n++) {
        static forged parts;
        forge_open(&parts, f.bytes, f.size, 1 << 24);
        forged_chunk *c = &parts.chunk[chunk_of(&parts, RHEO__STEP, 2)];
        const size_t metrics = 8 * (size_t)metric_count();
        const size_t hashes = c->size - 8 - metrics;
        const size_t kept = (size_t)((long)hashes + 8 * changes[n]);
        if ((long)hashes + 8 * changes[n] < 0) {
            forge_release(&parts);
            continue;
        }
        uint8_t *data = calloc(8 + kept + metrics, 1);
        memcpy(data, c->data, 8 + (kept < hashes ? kept : hashes));
        memcpy(data + 8 + kept, c->data + 8 + hashes, metrics);
        free(c->data);
        c->data = data;
        c->size = 8 + kept + metrics;
        uint8_t *to = malloc(f.size + 200000);
        file forgery = {to, forge_write(&parts, true, to, f.size + 200000)};
        assert_true(forgery.size > 0);
        rheo_verification v = verify(&forgery);
        if (v.verdict == RHEO_SAME || v.steps != 1)
            fail_msg("%ld hashes more: %llu steps: %s", changes[n], (unsigned long long)v.steps, v.message);
        const bool whole = changes[n] % (long)repeated == 0;
        if (whole) /* the number of substeps differs, or a hash is missing */
            assert_true(v.verdict == RHEO_DIFFERS || v.verdict == RHEO_UNREADABLE);
        else
            assert_int_equal(v.verdict, RHEO_UNREADABLE);
        forge_release(&parts);
        free(to);
    }
    free(f.bytes);
}

static void truncated_files_are_valid_up_to_the_cut(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        file f = record_new(2, NULL, 3, 100, full, false);
        uint64_t before = 0;
        for (size_t cut = 0; cut < f.size; cut += every()) {
            uint8_t *exact = malloc(cut + 1);
            memcpy(exact, f.bytes, cut);
            file truncated = {exact, cut};
            rheo_verification v = verify(&truncated);
            assert_int_equal(v.verdict, RHEO_UNREADABLE);
            assert_true(v.steps == before || v.steps == before + 1);
            before = v.steps;
            free(exact);
        }
        assert_true(before == 3 || every() > 1);
        free(f.bytes);
    }
}

static void damaged_bytes_are_found(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        file f = record_new(2, NULL, 3, 2, full, false);
        for (size_t at = 0; at < f.size; at += 3 * every()) {
            f.bytes[at] ^= 0x10;
            rheo_verification v = verify(&f);
            if (v.verdict != RHEO_UNREADABLE)
                fail_msg("byte %zu: %s", at, v.message);
            f.bytes[at] ^= 0x10;
        }
        assert_same(&f, 3);
        free(f.bytes);
    }
}

/* ---- Commands ---- */

static void commands_that_do_not_fit_are_refused(void **unused)
{
    (void)unused;
    static const char *const ISOTHERMAL[] = {"melting.diffusivity", "0", NULL};
    rheo_world *world = melting_world(3, ISOTHERMAL), *other = lively_world();
    const uint64_t hash = rheo_world_hash(world);
    const double impulse[3] = {1, 0, 0};
    size_t count;
    REFUSED(RHEO_ERROR_ARGUMENT, "is a parameter of the model thickening; the model here is melting",
            rheo_world_set(world, "springs.stiffness", "3", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "is a parameter of the model melting; the model here is thickening",
            rheo_world_set(other, "melting.viscosity", "3", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "fixed when a world is made",
            rheo_world_set(world, "melting.flow", "frozen", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "fixed when a world is made",
            rheo_world_set(world, "melting.density", "summation", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "fixed when a world is made", rheo_world_set(world, "paper.leapfrog", "on", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "with a melting.diffusivity of 0",
            rheo_world_set(world, "melting.diffusivity", "0.1", &error));
    OK(rheo_world_set(world, "gravity", "[0, -1, 0]", &error)); /* all of these are wrong */
    rheo__world_forget_commands(world);
    REFUSED(RHEO_ERROR_ARGUMENT, "no body", rheo_world_push_body(world, 0, impulse, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no vibrator", rheo_world_move_vibrator(world, 0, 0, 0, &error));
    rheo__world_commands(world, &count);
    assert_int_equal(count, 0);
    assert_true(rheo_world_hash(world) == hash);
    rheo_world_destroy(world);
    rheo_world_destroy(other);
}

static void added_particles_have_initial_values(void **unused)
{
    (void)unused;
    static const char *const WARM[] = {"melting.temperature", "0.75", "melting.rest_density", "1.5", NULL};
    rheo_world *world = melting_world(3, WARM);
    const uint32_t before = rheo_world_particle_count(world);
    const rheo_real position[6] = {0, 3, 0, (rheo_real)0.05, 4, 0};
    step(world, 1);
    OK(rheo_world_add_particles(world, 2, position, NULL, &error));
    for (uint32_t i = 0; i < 2; i++) {
        rheo_particle_state state;
        OK(rheo_world_particle(world, before + i, &state, &error));
        NEAR(state.density, 1.5, 0);
        NEAR(state.temperature, 0.75, 0);
        NEAR(state.displacement, 0, 0);
        for (int axis = 0; axis < 3; axis++)
            NEAR(state.start_position[axis], (double)position[3 * i + (uint32_t)axis], 0);
    }
    step(world, 2);
    rheo_particle_state state;
    OK(rheo_world_particle(world, before, &state, &error));
    assert_true(state.displacement > 0 && state.start_position[1] == 3);
    rheo_world_destroy(world);
}

/* ---- First and last states ---- */

static void a_recording_can_begin_in_the_middle(void **unused)
{
    (void)unused;
    rheo_world *world = melting_world(SIDE, NULL);
    file f = record(world, 4, 100, false, true, NULL);
    rheo_world *middle = load(&f, 3);
    OK(rheo_world_save(middle, "middle", OTHER, true, &error));
    rheo_world_destroy(middle);
    file checkpoint = read_and_remove(OTHER);
    assert_same(&checkpoint, 0);
    middle = load(&checkpoint, 3);
    command(middle, 3);
    file later = record(middle, 1, 100, false, false, NULL);
    assert_same(&later, 1);
    assert_true(rheo_world_hash(middle) == rheo_world_hash(world));
    static rheo_verification v;
    OK(rheo_diff_memory(f.bytes, f.size, later.bytes, later.size, &v, &error));
    assert_true(v.verdict == RHEO_DIFFERS && v.lengths_differ);
    assert_int_equal(v.steps, 1);
    rheo_world_destroy(middle);
    rheo_world_destroy(world);
    free(f.bytes);
    free(checkpoint.bytes);
    free(later.bytes);
}

/* A step that needs too many substeps is refused, recorded, verified and reported. */
static void a_refused_step_is_recorded(void **unused)
{
    (void)unused;
    static const char *const FEW[] = {"melting.max_substeps", "20", NULL};
    rheo_world *world = melting_world(3, FEW);
    const rheo_real position[3] = {0, 5, 0}, fast[3] = {0, -1000, 0};
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_world_add_particles(world, 1, position, fast, &error));
    const uint64_t hash = rheo_world_hash(world);
    REFUSED(RHEO_ERROR_STATE, "melting.max_substeps is 20", rheo_recorder_step(recorder, &error));
    assert_true(rheo_world_hash(world) == hash);
    OK(rheo_recorder_close(recorder, &error));
    file f = read_and_remove(PATH);
    assert_same(&f, 1);
    rheo_recording *r;
    rheo_failure failure;
    rheo_player *player;
    char message[512];
    OK(rheo_recording_open_memory(f.bytes, f.size, &r, &error));
    assert_true(rheo_recording_failure(r, &failure));
    assert_int_equal(failure.reason, RHEO_FAILURE_SUBSTEPS_FOR_SOUND);
    assert_true(failure.required > 20 && failure.limit == 20);
    rheo_failure_message(&failure, message, sizeof message);
    assert_in("melting.max_substeps is 20", message);
    assert_string_equal(failure.stage, "substeps");
    assert_string_equal(failure.field, "velocity");
    assert_true(failure.step == 2 && failure.id == 27 && failure.location == RHEO_LOCATION_PARTICLE);
    OK(rheo_player_open(r, NULL, &player, &error));
    REFUSED(RHEO_ERROR_STATE, "substeps", rheo_player_seek_stage(player, 2, "viscosity@1", &error));
    OK(rheo_player_seek(player, 1, &error));
    rheo_player_close(player);
    rheo_recording_close(r);
    rheo_world_destroy(world);
    free(f.bytes);
}

/* The step that was recorded and is refused here is the first that differs. */
static void a_step_that_is_refused_only_here_differs(void **unused)
{
    (void)unused;
    static const char *const FEW[] = {"melting.max_substeps", "1", "step", "1", NULL}, *const ENOUGH[] = {"step", "1",
                                                                                                          NULL};
    rheo_world *world = melting_world(3, ENOUGH);
    file f = record(world, 2, 100, false, false, NULL);
    rheo_world_destroy(world);
    world = melting_world(3, FEW);
    rheo_recording *r;
    static rheo_verification v;
    OK(rheo_recording_open_memory(f.bytes, f.size, &r, &error));
    OK(rheo__verify_world(r, world, &v, &error));
    assert_in("differs at step 1: it was recorded, but fails here: ", v.message);
    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 1 && v.steps == 0);
    assert_string_equal(v.first.stage, "substeps");
    rheo_recording_close(r);
    rheo_world_destroy(world);
    free(f.bytes);
}

/* A failed substep is reported by its number, and the earlier steps remain valid. */
static void a_failed_substep_is_named(void **unused)
{
    (void)unused;
    static const char *const COARSE[] = {"melting.substeps", "3", "step", "1", NULL};
    rheo_world *world = melting_world(4, COARSE);
    rheo_recorder *recorder;
    rheo_result result = RHEO_OK;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true, .full = true}, &recorder, &error));
    uint64_t steps = 0;
    for (; steps < 400 && (result = rheo_recorder_step(recorder, &why)) == RHEO_OK; steps++)
        ;
    assert_int_equal(result, RHEO_ERROR_STATE);
    OK(rheo_recorder_close(recorder, &error));
    file f = read_and_remove(PATH);
    rheo_failure failure;
    assert_true(rheo_world_failure(world, &failure));
    assert_non_null(strchr(failure.stage, '@'));
    assert_in(failure.stage, why.message);
    assert_same(&f, steps);
    /* The recording can be played up to the failed substep. */
    rheo_recording *r;
    rheo_player *player;
    OK(rheo_recording_open_memory(f.bytes, f.size, &r, &error));
    OK(rheo_player_open(r, NULL, &player, &error));
    REFUSED(RHEO_ERROR_STATE, failure.stage, rheo_player_seek_stage(player, steps + 1, failure.stage, &error));
    OK(rheo_player_seek_stage(player, steps + 1, "substeps", &error));
    rheo_player_close(player);
    rheo_recording_close(r);
    rheo_world_destroy(world);
    free(f.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loaded_world_continues_identically),
        cmocka_unit_test(a_recording_replays),
        cmocka_unit_test(a_full_recording_is_not_simulated),
        cmocka_unit_test(every_stage_run_can_be_reached),
        cmocka_unit_test(a_changed_parameter_is_named),
        cmocka_unit_test(recordings_are_compared),
        cmocka_unit_test(a_wrong_number_of_hashes_is_refused),
        cmocka_unit_test(truncated_files_are_valid_up_to_the_cut),
        cmocka_unit_test(damaged_bytes_are_found),
        cmocka_unit_test(commands_that_do_not_fit_are_refused),
        cmocka_unit_test(added_particles_have_initial_values),
        cmocka_unit_test(a_recording_can_begin_in_the_middle),
        cmocka_unit_test(a_refused_step_is_recorded),
        cmocka_unit_test(a_step_that_is_refused_only_here_differs),
        cmocka_unit_test(a_failed_substep_is_named),
    };
    return cmocka_run_group_tests_name("melting_record", tests, NULL, NULL);
}
