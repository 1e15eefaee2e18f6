/*
 * Proves that the checks can fail. One bit of one value is flipped after every stage, in every field that the stage
 * writes, and the reports must name exactly that. A separate library has a hook for the fault.
 */
#include "melting.h"
#include "record/recording.h"

enum { STEPS = 10, AT = 6 };

/* ---- Faults ---- */

static struct sabotage {
    bool active;
    uint64_t stage_run;
    rheo__field_id field;
    /* The fault that the reports must name. */
    uint64_t id, other_id, before, after;
    uint32_t component;
} plan;

static uint64_t bits_of(rheo_real value)
{
    return rheo__element_bits(RHEO__ELEMENT_REAL, &value, 0);
}

static void set_spring(uint32_t a, uint32_t b)
{
    plan.id = a < b ? a : b;
    plan.other_id = a < b ? b : a;
}

/* An entry of the spring in the middle of all, for any layout of rows. */
static size_t some_spring(const rheo__springs *springs)
{
    const rheo__pairs *p = &springs->pairs;
    size_t n = 0;
    for (uint32_t row = 0; row < p->rows; row++)
        RHEO__EACH_SPRING(springs, row, k)
    if (n++ == springs->count / 2) {
        set_spring(p->id_of[row], p->id_of[rheo__pairs_partner(p, k)]);
        return k;
    }
    fail_msg("there is no spring");
    return 0;
}

/* The entry in the row of the other end; the same one if rows have higher partners only. */
static size_t other_entry(const rheo__springs *springs, size_t k)
{
    const rheo__pairs *p = &springs->pairs;
    const uint32_t a = p->rank_of[plan.id], b = p->rank_of[plan.other_id];
    for (int side = 0; side < 2; side++) {
        const uint32_t row = side ? a : b, partner = side ? b : a;
        for (size_t n = rheo__pairs_first(p, row); n < rheo__pairs_end(p, row); n += p->width)
            if (n != k && rheo__pairs_partner(p, n) == partner)
                return n;
    }
    return k;
}

static void flip_rest_length(rheo__springs *springs)
{
    const size_t k = some_spring(springs), other = other_entry(springs, k);
    rheo_real *length = &springs->rest_length[k];
    plan.before = bits_of(*length);
    ((uint8_t *)length)[0] ^= 4;
    plan.after = bits_of(*length);
    springs->rest_length[other] = *length;
}

/* The sign of a rest length decides whether a pair is a spring. */
static void remove_spring(rheo__springs *springs)
{
    const size_t k = some_spring(springs), other = other_entry(springs, k);
    plan.before = 1;
    plan.after = 0;
    springs->rest_length[k] = springs->rest_length[other] = -1;
    springs->count--;
}

static void flip_value(rheo__state *s)
{
    const rheo__field *field = &rheo__field_table[plan.field];
    size_t size = rheo__element_size(field->element), values = rheo__state_items(s, plan.field) * field->components;
    size_t value = values * 2 / 3;
    uint32_t row = field->storage == RHEO__MODES ? s->modes.length / 2 : 0;
    uint8_t *bytes;
    if (field->storage == RHEO__FLAT)
        bytes = (uint8_t *)rheo__state_values(s, plan.field) + value * size;
    else
        bytes = (uint8_t *)&rheo__ring_block(
            rheo__state_ring(s, plan.field), value / RHEO__RING_BLOCK,
            rheo__ring_slot(rheo__state_ring(s, plan.field), row))[value % RHEO__RING_BLOCK];
    plan.id = value / field->components;
    plan.component = (uint32_t)(row * field->components + value % field->components);
    plan.before = rheo__element_bits(field->element, bytes, 0);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    bytes[size - 1] ^= 1;
#else
    bytes[0] ^= 1;
#endif
    plan.after = rheo__element_bits(field->element, bytes, 0);
}

static void sabotage(rheo_world *world, uint32_t stage)
{
    if (!plan.active || *world->state.step + 1 != AT || world->stage_runs_done != plan.stage_run)
        return;
    assert_int_equal(stage, rheo__world_stage_of(world, plan.stage_run));
    plan.active = false;
    if (plan.field == RHEO__FIELD_spring_ends)
        remove_spring(&world->state.springs);
    else if (plan.field == RHEO__FIELD_spring_rest_length)
        flip_rest_length(&world->state.springs);
    else
        flip_value(&world->state);
}

/* ---- Recordings with a fault, and their reports ---- */

static const char *const CLEAN = "test_sabotage_clean.rlog", *const BAD = "test_sabotage_bad.rlog";

static void record(const rheo_world *from, const char *path, bool full)
{
    void *bytes;
    size_t size;
    rheo_recording *checkpoint;
    rheo_world *world;
    rheo_recorder *recorder;
    OK(rheo_world_save_memory(from, "sabotage", &bytes, &size, &error));
    OK(rheo_recording_open_memory(bytes, size, &checkpoint, &error));
    OK(rheo_recording_world(checkpoint, rheo_world_step_count(from), NULL, &world, &error));
    OK(rheo_recorder_open(world, path, &(rheo_record_options){.full = full, .force = true, .keyframe_spacing = 100},
                          &recorder, &error));
    for (int i = 0; i < STEPS; i++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    rheo_recording_close(checkpoint);
    free(bytes);
}

/* `before`: the value on the side without a fault. */
static void names_it(const rheo_verification *v, const char *stage, uint64_t expected, uint64_t actual,
                     rheo_value_origin known)
{
    const char *field = rheo__field_table[plan.field].name;
    const rheo_difference *d = &v->first;
    if (v->verdict != RHEO_DIFFERS || d->step != AT || strcmp(d->stage, stage) != 0 || strcmp(d->field, field) != 0 ||
        strcmp(d->value_field, field) != 0 || d->origin != known || d->id != plan.id ||
        d->other_id != plan.other_id || d->component != plan.component || d->expected_bits != expected ||
        d->actual_bits != actual || d->count != 1)
        fail_msg("%s after %s, item %llu:%llu, component %u, %llx and %llx: the report says %s", field, stage,
                 (unsigned long long)plan.id, (unsigned long long)plan.other_id, plan.component,
                 (unsigned long long)expected, (unsigned long long)actual, v->message);
    assert_int_equal(v->steps, AT - 1);
}

static void check_reports(const char *stage)
{
    rheo_verification v;
    /* This build makes the clean recording. The bit in the other one is solved from its hash. */
    OK(rheo_diff(CLEAN, BAD, &v, &error));
    names_it(&v, stage, plan.before, plan.after, RHEO_VALUES_SOLVED);
    OK(rheo_diff(BAD, CLEAN, &v, &error));
    names_it(&v, stage, plan.after, plan.before, RHEO_VALUES_SOLVED);
    OK(rheo_verify(BAD, &v, &error));
    names_it(&v, stage, plan.after, plan.before, RHEO_VALUES_SOLVED);
    OK(rheo_verify(CLEAN, &v, &error));
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    /* The fault is in this build. */
    plan.active = true;
    OK(rheo_verify(CLEAN, &v, &error));
    assert_false(plan.active);
    names_it(&v, stage, plan.before, plan.after, RHEO_VALUES_SOLVED);
}

/* Tries every stage and field of a world with this number of substeps per step, 1 if it has none; returns their number. */
static int every_stage_run_and_field(rheo_world *world, uint64_t substeps)
{
    int cases = 0;
    for (uint64_t stage_run = 0; stage_run < rheo__world_stage_runs(world, substeps); stage_run++)
        for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
            for (int full = 0; full < 2; full++) {
                char name[32];
                if (!(world->stage[rheo__world_stage_of(world, stage_run)].writes >> f & 1))
                    continue;
                if (cases++ % (int)every() != 0)
                    continue;
                rheo__world_stage_run_name(world, stage_run, name);
                plan = (struct sabotage){.stage_run = stage_run, .field = f};
                record(world, CLEAN, full);
                plan.active = true;
                record(world, BAD, full);
                assert_false(plan.active);
                check_reports(name);
            }
    remove(CLEAN);
    remove(BAD);
    return cases;
}

static void one_bit_is_named_in_every_stage_and_field(void **unused)
{
    (void)unused;
    for (int scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++) {
        const bool summed = scheme == RHEO_SCHEME_SUMMED;
        rheo_scene scene = lively_scene();
        rheo_world *world;
        scene.world.substeps = 2;
        scene.world.scheme = (rheo_scheme)scheme;
        OK(rheo_scene_create_world(&scene, &world, &error));
        if (summed)
            *world->state.substeps = 2; /* stage runs are named before the first step */
        const int tried = every_stage_run_and_field(world, summed ? 2 : 1);
        print_message("%d cases\n", tried);
        assert_true(tried > (scheme == RHEO_SCHEME_POSITIONS ? 30 : 40));
        rheo_world_destroy(world);
        if (!summed)
            continue;
        /* Vibrators of the other kind push particles; a history of modes has one more field. */
        scene.world.vibrators.kind = RHEO_VIBRATOR_FORCE;
        scene.world.vibrators.height = 4;
        scene.world.history.kind = RHEO_HISTORY_WINDOW_FAST;
        OK(rheo_scene_create_world(&scene, &world, &error));
        *world->state.substeps = 2;
        assert_true(every_stage_run_and_field(world, 2) > tried);
        rheo_world_destroy(world);
    }
}

/* The report names the substep in a step of three. */
static void one_bit_is_named_in_every_substep(void **unused)
{
    (void)unused;
    static const char *const THREE[] = {"melting.substeps", "3", NULL};
    rheo_world *world = melting_world(4, THREE);
    *world->state.substeps = 3; /* stage runs are named before the first step */
    int tried = every_stage_run_and_field(world, 3);
    print_message("%d cases\n", tried);
    assert_int_equal(tried, 2 * (2 + 3 * 9));
    rheo_world_destroy(world);
}

/* A difference grows from one value to many. */
static void a_fault_begins_with_one_value(void **unused)
{
    (void)unused;
    rheo_scene scene = lively_scene();
    rheo_world *world;
    scene.world.substeps = 1; /* the difference is that at the end of the step */
    OK(rheo_scene_create_world(&scene, &world, &error));
    rheo_verification v;
    plan = (struct sabotage){.field = RHEO__FIELD_position};
    while (strcmp(world->stage[plan.stage_run].name, "walls") != 0)
        plan.stage_run++;
    record(world, CLEAN, true);
    plan.active = true;
    record(world, BAD, true);
    OK(rheo_diff(CLEAN, BAD, &v, &error));
    assert_true(v.growth_count > 4);
    assert_true(v.growth[0].step == AT && v.growth[0].count == 1 && v.growth[0].ulps == 1);
    assert_string_equal(v.growth[0].field, "position");
    uint64_t last = 0;
    for (uint32_t i = 0; i < v.growth_count; i++)
        if (strcmp(v.growth[i].field, "position") == 0)
            last = v.growth[i].count;
    assert_true(last > 10);
    remove(CLEAN);
    remove(BAD);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_bit_is_named_in_every_stage_and_field),
        cmocka_unit_test(one_bit_is_named_in_every_substep),
        cmocka_unit_test(a_fault_begins_with_one_value),
    };
    rheo__sabotage = sabotage;
    return cmocka_run_group_tests_name("sabotage", tests, NULL, NULL);
}
