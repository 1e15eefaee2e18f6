/*
 * Hashes of fields: the same in every SIMD variant, whether made anew or brought up to date after a stage, and another
 * one after any change of one bit.
 */
#include "support.h"

#include "core/field_sums.h"
#include "record/chunk.h"
#include "world/stage_runs.h"

/* A world in motion, whose springs come and go and whose list is made again. */
static rheo_world *moving_world(rheo_scheme scheme, uint32_t substeps)
{
    rheo_scene scene = lively_scene();
    rheo_world *world;
    scene.world.scheme = scheme;
    scene.world.substeps = substeps;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/* ---- All variants ---- */

/* The sum of the first words of an array, by definition. */
static uint64_t sum_of(const char *bytes, size_t count, size_t element, uint64_t row, uint64_t first)
{
    uint64_t sum = 0;
    for (size_t n = 0; n < count; n++)
        sum += rheo__hash_word(row, first + n, rheo__hash_get_word(bytes + 8 * n, element));
    return sum;
}

static void all_variants_sum_the_same_words(void **state)
{
    (void)state;
    static rheo__sum_words *const variants[] = RHEO__ALL_VARIANTS(sum_words);
    char bytes[8 * 70];
    uint32_t random = 1;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (char)((random = random * UINT32_C(1664525) + UINT32_C(1013904223)) >> 24);
    for (uint32_t i = 0; rheo_simd_available(i); i++) {
        OK(rheo_use_simd(rheo_simd_available(i), &error));
        for (size_t element = 4; element <= 8; element += 4)
            for (size_t count = 0; count < 69; count++)
                assert_true(variants[rheo__simd_in_use()](bytes + 4, count, element, count % 3, 7 * count) ==
                            sum_of(bytes + 4, count, element, count % 3, 7 * count));
    }
}

static void all_variants_hash_the_same_springs(void **state)
{
    (void)state;
    rheo_world *world = moving_world(RHEO_SCHEME_SUMMED, 2);
    const rheo__springs *springs = &world->state.springs;
    for (int n = 0; n < 4; n++) {
        OK(rheo_world_step(world, &error));
        uint64_t ends = 0, lengths = 0;
        for (uint32_t i = 0; i < springs->pairs.rows; i++)
            RHEO__EACH_SPRING(springs, i, k)
            {
                const uint64_t a = rheo__hash_key(springs->pairs.id_of[i]),
                               b = rheo__hash_key(springs->pairs.id_of[rheo__pairs_partner(&springs->pairs, k)]);
                rheo__real_bits bits;
                memcpy(&bits, &springs->rest_length[k], sizeof bits);
                ends += a * b;
                lengths += (a + b) * rheo__hash_length(bits);
            }
        assert_true(springs->count > 10);
        for (uint32_t i = 0; rheo_simd_available(i); i++) {
            OK(rheo_use_simd(rheo_simd_available(i), &error));
            assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_spring_ends) ==
                        rheo__hash_field(ends, 1, springs->count));
            assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_spring_rest_length) ==
                        rheo__hash_field(lengths, 1, springs->count));
        }
    }
    rheo_world_destroy(world);
}

/* ---- Hashes after stages ---- */

/* The last hash of each field in the trace is that of its present values. */
static void trace_is_right(const rheo_world *world)
{
    uint64_t last[RHEO__FIELD_COUNT] = {0}, own;
    rheo__fields written = 0;
    const uint64_t substeps = rheo__world_trace_substeps(world, world->trace.count);
    for (size_t i = 0; i < world->trace.count; i++) {
        char name[32];
        rheo__field_id field;
        rheo__world_trace_entry(world, substeps, i, name, &field);
        last[field] = world->trace.hash[i];
        written |= RHEO__SET_OF(field);
    }
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (written >> f & 1) {
            rheo__state_hash_newest(&world->state, UINT32_C(1) << f, &own);
            if (own != last[f])
                fail_msg("step %llu: the trace has another hash of %s",
                         (unsigned long long)rheo_world_step_count(world), rheo__field_table[f].name);
        }
}

/* Steps a copy stage by stage and hashes everything anew after each of them. */
static void stages_are_right(rheo_world *copy, const rheo_world *traced)
{
    size_t index = 0;
    do {
        uint32_t stage;
        uint64_t hashes[RHEO__FIELD_COUNT];
        OK(rheo_world_step_stage(copy, &stage, &error));
        rheo__state_hash_newest(&copy->state, copy->stage[stage].writes, hashes);
        for (size_t i = 0; i < (size_t)__builtin_popcountll(copy->stage[stage].writes); i++, index++)
            if (index >= traced->trace.count || traced->trace.hash[index] != hashes[i])
                fail_msg("step %llu: hash %zu of the trace is not that after stage %s",
                         (unsigned long long)rheo_world_step_count(traced), index, copy->stage[stage].name);
    } while (copy->stage_runs_done);
    assert_int_equal(index, traced->trace.count);
}

static void hashes_brought_up_to_date_are_those_made_anew(void **state)
{
    (void)state;
    for (uint32_t i = 0; rheo_simd_available(i); i++)
        for (int sequential = 0; sequential < 2; sequential++) {
            OK(rheo_use_simd(rheo_simd_available(i), &error));
            const rheo_scheme scheme = sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
            rheo_world *world = moving_world(scheme, sequential ? 1 : 2),
                       *copy = moving_world(scheme, sequential ? 1 : 2);
            uint64_t springs = 0, changes = 0, lists = world->state.springs_exchanged, kept = 0;
            for (int n = 0; n < 60; n++) {
                uint32_t stage;
                if (n == 20) { /* a step without hashes, and one by stages */
                    OK(rheo_world_step(world, &error));
                    OK(rheo_world_step(copy, &error));
                    do
                        OK(rheo_world_step_stage(world, &stage, &error));
                    while (world->stage_runs_done);
                    OK(rheo_world_step(copy, &error));
                }
                if (n == 30) { /* commands change what no stage has written */
                    OK(rheo_world_push_body(world, 0, (const double[]){1, 2, 3}, NULL, &error));
                    OK(rheo_world_push_body(copy, 0, (const double[]){1, 2, 3}, NULL, &error));
                }
                kept += world->state.springs_exchanged == lists;
                lists = world->state.springs_exchanged;
                OK(rheo__world_step_traced(world, NULL, 0, &error));
                trace_is_right(world);
                stages_are_right(copy, world);
                changes += world->state.springs.count != springs;
                springs = world->state.springs.count;
            }
            assert_true(changes > 3);
            if (!sequential)
                assert_true(kept > 3 && kept < 57); /* lists that last, and lists that are made again */
            rheo_world_destroy(world);
            rheo_world_destroy(copy);
        }
}

/* The same hashes as expected let a step end; with another one, or one too few, it stops behind the stage run that has it. */
static void a_step_stops_behind_the_first_other_hash(void **state)
{
    (void)state;
    enum { MOST = 256 };
    static uint64_t known[MOST], expected[MOST];
    rheo_world *whole = moving_world(RHEO_SCHEME_SUMMED, 2);
    OK(rheo__world_step_traced(whole, NULL, 0, &error));
    const size_t count = whole->trace.count;
    assert_true(count > 10 && count < MOST);
    memcpy(known, whole->trace.hash, count * sizeof *known);
    for (size_t k = 0; k <= 2 * count + 1; k++) {
        const size_t wrong = k / 2;
        const bool missing = k % 2;
        rheo_world *world = moving_world(RHEO_SCHEME_SUMMED, 2);
        memcpy(expected, known, sizeof expected);
        if (!missing)
            expected[wrong] ^= (uint64_t)1 << wrong % 64; /* behind the last one it does not count */
        OK(rheo__world_step_traced(world, expected, missing ? wrong : count, &error));
        const uint64_t all = rheo__world_stage_runs_in_step(world);
        uint64_t runs = 1; /* that the step makes */
        while (runs < all && rheo__world_trace_start(world, runs) <= wrong)
            runs++;
        assert_int_equal(world->stage_runs_done, runs % all);
        assert_int_equal(world->trace.count, runs < all ? rheo__world_trace_start(world, runs) : count);
        assert_int_equal(rheo_world_step_count(world), runs == all);
        rheo_world_destroy(world);
    }
    rheo_world_destroy(whole);
}

/* ---- One bit ---- */

static void every_bit_of_a_rest_length_counts(void **state)
{
    (void)state;
    rheo_world *world = moving_world(RHEO_SCHEME_SUMMED, 2);
    OK(rheo_world_step(world, &error));
    rheo__springs *springs = &world->state.springs;
    const rheo__pairs *p = &springs->pairs;
    const uint64_t hash = rheo__state_hash_field(&world->state, RHEO__FIELD_spring_rest_length);
    int tried = 0;
    for (uint32_t i = 0; i < p->rows; i++)
        RHEO__EACH_SPRING(springs, i, k)
        {
            size_t other = rheo__pairs_first(p, rheo__pairs_partner(p, k));
            while (rheo__pairs_partner(p, other) != i)
                other += p->width;
            const rheo_real was = springs->rest_length[k];
            for (size_t bit = 0; bit < 8 * sizeof was - 1; bit++) { /* with the sign it would be no spring */
                rheo__real_bits bits;
                rheo__solution found;
                memcpy(&bits, &was, sizeof bits);
                bits ^= (rheo__real_bits)1 << bit;
                memcpy(&springs->rest_length[k], &bits, sizeof bits);
                if (!(springs->rest_length[k] >= 0))
                    continue; /* not a number: no spring either */
                springs->rest_length[other] = springs->rest_length[k];
                assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_spring_rest_length) != hash);
                assert_true(rheo__state_solve(&world->state, RHEO__FIELD_spring_rest_length, hash, &found));
                assert_true(found.own == bits && found.other == (bits ^ (rheo__real_bits)1 << bit));
                tried++;
            }
            springs->rest_length[k] = springs->rest_length[other] = was;
            i += 20;
            break;
        }
    assert_true(tried > 60);
    assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_spring_rest_length) == hash);
    rheo_world_destroy(world);
}

/* ---- Packed values ---- */

/* The ring has blocks of 512 numbers, and the last one of these particles has not a whole word more of float numbers. */
static void every_place_of_a_history_is_found(void **state)
{
    (void)state;
    enum { PARTICLES = 347, STEPS = 3 };
    static rheo_real position[3 * PARTICLES];
    rheo_world_def def = rheo_default_world_def();
    for (uint32_t i = 0; i < 3 * PARTICLES; i++)
        position[i] = (rheo_real)(i % 3 == 0 ? 2 * (i / 30) : i % 3 == 1 ? 2 * (i / 3 % 10) : 1);
    def.particles.count = PARTICLES;
    def.particles.position = position;
    def.history.kind = RHEO_HISTORY_WINDOW;
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    for (int n = 0; n < STEPS; n++)
        OK(rheo_world_step(world, &error));
    rheo__state *s = &world->state;
    int fields = 0;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(s, f) || rheo__field_table[f].storage != RHEO__RING)
            continue;
        uint64_t hash;
        rheo__solution found;
        rheo__state_hash_newest(s, RHEO__SET_OF(f), &hash);
        for (uint32_t i = 0; i < 3 * PARTICLES; i++) {
            rheo_real *value =
                rheo__ring_block(&s->ring, i / RHEO__RING_BLOCK, rheo__ring_slot(&s->ring, 0)) + i % RHEO__RING_BLOCK;
            const rheo_real was = *value;
            rheo__real_bits own, other;
            memcpy(&other, &was, sizeof other);
            own = other ^ 4;
            memcpy(value, &own, sizeof own);
            assert_true(rheo__state_solve(s, f, hash, &found));
            assert_true(found.id == i / 3 && found.component == i % 3);
            assert_true(found.own == own && found.other == other && found.count == 1);
            *value = was;
        }
        /* The place behind the last number would explain this hash, but has no number. */
        const uint64_t n = 3 * PARTICLES * sizeof(rheo_real) / 8, items = rheo__state_items(s, f);
        rheo__real_bits last;
        memcpy(&last, rheo__ring_block(&s->ring, 2, rheo__ring_slot(&s->ring, 0)) + 16, sizeof last);
        const uint64_t word = RHEO_DOUBLE ? 0 : (uint64_t)last, behind = word ^ UINT64_C(4) << (RHEO_DOUBLE ? 0 : 32);
        const uint64_t sum =
            rheo__hash_sum(hash, 1, items) + rheo__hash_word(0, n, behind) - rheo__hash_word(0, n, word);
        assert_false(rheo__state_solve(s, f, rheo__hash_field(sum, 1, items), &found));
        fields++;
    }
    assert_int_equal(fields, 1);
    rheo_world_destroy(world);
}

static void packed_values_are_read_again(void **state)
{
    (void)state;
    for (size_t element = 4; element <= 8; element += 4)
        for (size_t count = 0; count < 40; count++)
            for (int bits = 0; bits <= (int)(8 * element); bits++) {
                uint64_t random = (uint64_t)bits + 1, mask = bits == 64 ? UINT64_MAX : (UINT64_C(1) << bits) - 1;
                uint32_t small[40], small_read[40];
                uint64_t large[40], large_read[40];
                for (size_t i = 0; i < count; i++) {
                    random = random * UINT64_C(6364136223846793005) + 1442695040888963407;
                    large[i] = (random ^ random >> 32) & mask;
                    small[i] = (uint32_t)large[i];
                }
                const void *values = element == 4 ? (const void *)small : large;
                void *read = element == 4 ? (void *)small_read : large_read;
                rheo__bytes bytes = {0};
                rheo__put_u32(&bytes, 7);
                rheo__put_packed(&bytes, values, count, element);
                assert_true(bytes.size - 4 <= (count + 7) / 8 * (element / 4 + (size_t)bits));
                rheo__cursor cursor = rheo__cursor_over(&bytes);
                rheo__get_u32(&cursor);
                rheo__get_packed(&cursor, read, count, element);
                assert_false(cursor.failed);
                assert_int_equal(rheo__cursor_left(&cursor), 0);
                if (count)
                    assert_memory_equal(read, values, count * element);
                /* Cut off, they cannot be read. */
                if (count) {
                    bytes.size--;
                    cursor = rheo__cursor_over(&bytes);
                    rheo__get_u32(&cursor);
                    rheo__get_packed(&cursor, read, count, element);
                    assert_true(cursor.failed);
                }
                rheo__bytes_release(&bytes);
            }
}

/* Found by fuzzing: a width of 64 and more was shifted by before it was refused. */
static void a_width_that_no_packed_value_has_is_refused(void **state)
{
    (void)state;
    for (size_t element = 4; element <= 8; element += 4)
        for (int width = 33; width < 256; width++) {
            const uint64_t values[8] = {1, 2, 3, 4, 5, 6, 7, 8};
            uint64_t read[8] = {0};
            rheo__bytes bytes = {0};
            rheo__put_packed(&bytes, values, 8, element);
            for (int i = 0; i < 300; i++)
                rheo__put_u32(&bytes, 0);
            bytes.data[0] = (uint8_t)width;
            rheo__cursor cursor = rheo__cursor_over(&bytes);
            rheo__get_packed(&cursor, read, 8, element);
            assert_true(cursor.failed);
            rheo__bytes_release(&bytes);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_variants_sum_the_same_words),
        cmocka_unit_test(all_variants_hash_the_same_springs),
        cmocka_unit_test(hashes_brought_up_to_date_are_those_made_anew),
        cmocka_unit_test(a_step_stops_behind_the_first_other_hash),
        cmocka_unit_test(every_bit_of_a_rest_length_counts),
        cmocka_unit_test(every_place_of_a_history_is_found),
        cmocka_unit_test(packed_values_are_read_again),
        cmocka_unit_test(a_width_that_no_packed_value_has_is_refused),
    };
    return cmocka_run_group_tests_name("hashes", tests, NULL, NULL);
}
