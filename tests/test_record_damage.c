/* Truncated, damaged and hostile recordings are found and never crash a reader. The documented format is correct. */
#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700 /* SIGXFSZ */
#define PATH "test_record_damage.rlog"
#include "record_support.h"

#include <locale.h>
#include <math.h>
#include <zlib.h>

#include "core/hash.h"
#include "forge.h"

/* ---- Truncated and damaged files ---- */

static void put(uint8_t *to, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> (8 * i));
}

static uint64_t get(const uint8_t *from, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)from[i] << (8 * i);
    return value;
}

static size_t chunk_size(const uint8_t *chunk)
{
    return 36 + (size_t)get(chunk + 16, 8);
}

/* Offset of the n-th chunk of a type; `type` NULL: any. */
static size_t find(const uint8_t *bytes, size_t size, const char *type, int n)
{
    for (size_t at = 8; at < size; at += chunk_size(bytes + at))
        if ((!type || memcmp(bytes + at, type, 4) == 0) && n-- == 0)
            return at;
    fail();
    return 0;
}

static void seal(uint8_t *chunk)
{
    size_t size = chunk_size(chunk) - 4;
    put(chunk + size, crc32(0, chunk, (uInt)size), 4);
}

static rheo_verification verify_bytes(const uint8_t *bytes, size_t size)
{
    /* A copy of exact size, so that reading past the end is found. */
    uint8_t *exact = malloc(size ? size : 1);
    memcpy(exact, bytes, size);
    rheo_verification v;
    OK(rheo_verify_memory(exact, size, &v, &error));
    free(exact);
    return v;
}

/* Without the chunks of one step, the file is damaged where the next one follows. */
static void a_missing_step_is_found(void **state)
{
    (void)state;
    enum { STEPS = 5 };
    for (int full = 0; full < 2; full++) {
        uint64_t hashes[STEPS + 1];
        size_t size;
        uint8_t *bytes = record(2, STEPS, 100, full, hashes, &size);
        for (int missing = 0; missing < STEPS - 1; missing++) {
            size_t start = missing ? find(bytes, size, "STEP", missing - 1) : find(bytes, size, "KEYF", 0);
            start += chunk_size(bytes + start);
            size_t end = find(bytes, size, "STEP", missing);
            end += chunk_size(bytes + end);
            uint8_t *rest = malloc(size);
            memcpy(rest, bytes, start);
            memcpy(rest + start, bytes + end, size - end);
            const rheo_verification v = verify_bytes(rest, size - (end - start));
            assert_int_equal(v.verdict, RHEO_UNREADABLE);
            assert_non_null(strstr(v.message, "is not the next step; one is missing"));
            free(rest);
        }
        free(bytes);
    }
}

static void a_truncated_file_is_valid_up_to_the_cut(void **state)
{
    (void)state;
    enum { STEPS = 6 };
    for (int full = 0; full < 2; full++) {
        uint64_t hashes[STEPS + 1];
        size_t size, steps = 0;
        uint8_t *bytes = record(2, STEPS, 2, full, hashes, &size);
        assert_true(size <= 8192 * sizeof(rheo_real)); /* every length is tried */
        size_t first_keyframe = find(bytes, size, "KEYF", 0);
        first_keyframe += chunk_size(bytes + first_keyframe);
        size_t next = find(bytes, size, "STEP", 0);
        next += chunk_size(bytes + next);
        for (size_t cut = 0; cut < size; cut++) {
            const bool at_border = cut == next;
            if (at_border && ++steps < STEPS) {
                next = find(bytes, size, "STEP", (int)steps);
                next += chunk_size(bytes + next);
            }
            if (cut % every() && !at_border)
                continue;
            rheo_verification v = verify_bytes(bytes, cut);
            assert_int_equal(v.verdict, RHEO_UNREADABLE);
            assert_int_equal(v.steps, steps);
            rheo_recording *r;
            rheo_result result = rheo_recording_open_memory(bytes, cut, &r, &why);
            assert_int_equal(result, cut < first_keyframe ? RHEO_ERROR_FORMAT : RHEO_OK);
            if (result != RHEO_OK)
                continue;
            assert_false(rheo_recording_get_info(r).complete);
            assert_int_equal(rheo_recording_get_info(r).last_step, steps);
            rheo_recording_close(r);
        }
        assert_int_equal(steps, STEPS);
        /* The part up to the cut can be used. */
        rheo_recording *r;
        rheo_world *world;
        OK(rheo_recording_open_memory(bytes, size - 1, &r, &error));
        OK(rheo_recording_world(r, STEPS, NULL, &world, &error));
        assert_true(rheo_world_hash(world) == hashes[STEPS]);
        rheo_world_destroy(world);
        rheo_recording_close(r);
        free(bytes);
    }
}

/* A length that points past the end is damage if the end mark is present. */
static void a_wrong_length_is_damage_not_truncation(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 4, 100, false, NULL, &size);
    uint8_t *chunk = bytes + find(bytes, size, "STEP", 1);
    for (size_t at = 16; at <= 24; at += 8) /* stored and raw size */
        put(chunk + at, get(chunk + at, 8) + (1 << 20), 8);
    rheo_recording *r;
    assert_int_equal(rheo_recording_open_memory(bytes, size, &r, &why), RHEO_ERROR_FORMAT);
    rheo_verification v = verify_bytes(bytes, size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "damaged"));
    free(bytes);
}

static void a_damaged_step_is_not_healthy(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 4, 100, false, NULL, &size);
    bytes[find(bytes, size, "STEP", 2) + 40] ^= 1;
    rheo_recording *r;
    rheo_diagnosis d = {.healthy = true};
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    assert_int_equal(rheo_diagnose(r, &d, &why), RHEO_ERROR_FORMAT);
    assert_false(d.healthy);
    rheo_recording_close(r);
    free(bytes);
}

static void any_changed_byte_is_found(void **state)
{
    (void)state;
    size_t size;
    for (int full = 0; full < 2; full++) {
        uint8_t *bytes = record(2, 4, 2, full, NULL, &size);
        assert_int_equal(verify_bytes(bytes, size).verdict, RHEO_SAME);
        for (size_t at = 0; at < size; at += every()) {
            uint8_t bit = (uint8_t)(1u << (at * 2654435761u >> 7 & 7));
            bytes[at] ^= bit;
            rheo_verification v = verify_bytes(bytes, size);
            if (v.verdict != RHEO_UNREADABLE || v.steps > 4)
                fail_msg("byte %zu: %d %s", at, (int)v.verdict, v.message);
            bytes[at] ^= bit;
        }
        free(bytes);
    }
    rheo_world *world = make_world(2);
    void *saved;
    save(world, &saved, &size);
    uint8_t *bytes = saved;
    for (size_t at = 0; at < size; at += every()) {
        uint8_t bit = (uint8_t)(1u << (at * 2654435761u >> 7 & 7));
        bytes[at] ^= bit;
        rheo_recording *r;
        rheo_world *loaded = NULL;
        if (rheo_recording_open_memory(bytes, size, &r, &why) == RHEO_OK) {
            assert_int_not_equal(rheo_recording_world(r, 0, NULL, &loaded, &why), RHEO_OK);
            assert_null(loaded);
            rheo_recording_close(r);
        }
        bytes[at] ^= bit;
    }
    free(saved);
    rheo_world_destroy(world);
}

/* A reader must not trust bad values, even with a correct check sum. */
static void hostile_bytes_are_harmless(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 4, 2, true, NULL, &size);
    uint32_t random = 1;
    for (size_t n = 0; n < 4000; n += every()) {
        uint8_t *copy = malloc(size);
        memcpy(copy, bytes, size);
        random = random * 1664525 + 1013904223;
        size_t chunk = find(copy, size, NULL, (int)(random >> 8) % 20);
        random = random * 1664525 + 1013904223;
        size_t length = (size_t)get(copy + chunk + 16, 8);
        if (length) {
            uint8_t *at = copy + chunk + 32 + (random >> 8) % length;
            *at = (uint8_t)(random >> 29 == 0 ? 0xFFu : *at ^ 1u << (random >> 29));
            seal(copy + chunk);
            verify_bytes(copy, size);
            rheo_recording *r;
            rheo_world *world;
            if (rheo_recording_open_memory(copy, size, &r, &why) == RHEO_OK) {
                rheo_recording_world(r, 4, NULL, &world, &why);
                rheo_world_destroy(world);
                rheo_recording_close(r);
            }
        }
        free(copy);
    }
    free(bytes);
}

/* The recording with a chunk inserted ahead of the n-th STEP. */
static uint8_t *with_chunk(const uint8_t *bytes, size_t size, uint32_t flags, size_t *new_size)
{
    size_t at = find(bytes, size, "STEP", 1), length = 5;
    uint8_t *with = calloc(1, size + 36 + length);
    memcpy(with, bytes, at);
    memcpy(with + at, "NOTE", 4);
    put(with + at + 4, flags, 4);
    put(with + at + 16, length, 8);
    put(with + at + 24, length, 8);
    memcpy(with + at + 32, "hello", length);
    seal(with + at);
    memcpy(with + at + 36 + length, bytes + at, size - at);
    *new_size = size + 36 + length;
    return with;
}

static void unknown_chunks_and_versions(void **state)
{
    (void)state;
    size_t size, other_size;
    uint8_t *bytes = record(2, 4, 0, true, NULL, &size); /* with one keyframe the index stays valid */
    uint8_t *other = with_chunk(bytes, size, 1, &other_size);
    rheo_verification v = verify_bytes(other, other_size);
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    other[find(other, other_size, "NOTE", 0) + 33] ^= 1;
    v = verify_bytes(other, other_size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_int_equal(v.steps, 1);
    free(other);

    other = with_chunk(bytes, size, 0, &other_size);
    v = verify_bytes(other, other_size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "NOTE"));
    assert_non_null(strstr(v.message, "newer"));
    rheo_recording *r;
    assert_int_equal(rheo_recording_open_memory(other, other_size, &r, &why), RHEO_ERROR_UNSUPPORTED);
    free(other);

    other = calloc(1, size + 1);
    memcpy(other, bytes, size);
    v = verify_bytes(other, size + 1);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "follow"));
    assert_non_null(strstr(v.message, "restore it from version control"));
    put(other + 8 + 32, 7, 4);
    seal(other + 8);
    v = verify_bytes(other, size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "newer rheolog"));
    assert_non_null(strstr(v.message, "update rheolog"));
    assert_null(strstr(v.message, "version control"));
    put(other + 8 + 32, 3, 4);
    seal(other + 8);
    v = verify_bytes(other, size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "older rheolog"));
    assert_non_null(strstr(v.message, "record it again and bless it"));

    /* A step is missing. */
    memcpy(other, bytes, size);
    size_t second = find(other, size, "STEP", 0);
    second += chunk_size(other + second);
    size_t third = find(other, size, "STEP", 1);
    third += chunk_size(other + third);
    memmove(other + second, other + third, size - third);
    v = verify_bytes(other, size - (third - second));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_int_equal(v.steps, 1);
    free(other);
    free(bytes);
}

static rheo_result read_head(const uint8_t *payload, size_t size)
{
    rheo__head head;
    rheo__cursor cursor = {payload, size, 0, false};
    const rheo_result result = rheo__head_get(&cursor, &head, &why);
    if (result == RHEO_OK)
        rheo__head_release(&head);
    return result;
}

/* Reads a head in which a number has this value, and puts the number back. */
static rheo_result read_with(uint8_t *payload, size_t size, size_t at, uint64_t value)
{
    const uint64_t before = get(payload + at, 4);
    put(payload + at, value, 4);
    const rheo_result result = read_head(payload, size);
    put(payload + at, before, 4);
    return result;
}

/* The largest number that is allowed is read, and the next one is refused. */
static void numbers_of_a_head_are_limited(void **state)
{
    (void)state;
    enum { MOST_FIELDS = 64, DUMMY = 2 + 4 * 4 };
    size_t file_size, at[3] = {0}, written = 0;
    uint8_t *bytes = record(2, 0, 0, false, NULL, &file_size), *payload = bytes + 8 + 32;
    const size_t size = (size_t)get(bytes + 8 + 16, 8);
    rheo__head head;
    rheo__cursor cursor = {payload, size, 0, false};
    OK(rheo__head_get(&cursor, &head, &error));
    size_t layout = 0;
    while (memcmp(payload + layout, head.layout.data, head.layout.size) != 0)
        layout++;
    const size_t end = layout + head.layout.size;
    const uint32_t fields = head.field_count;
    rheo__head_release(&head);
    /* Finds the phases of the first and the last stage, and the first field that a stage writes. */
    char name[32];
    cursor = (rheo__cursor){payload, end, layout + 4, false};
    for (uint32_t f = 0; f < fields; f++) {
        rheo__get_text(&cursor, name, sizeof name);
        cursor.offset += 16;
    }
    const uint32_t stages = rheo__get_u32(&cursor);
    for (uint32_t s = 0; s < stages; s++) {
        rheo__get_text(&cursor, name, sizeof name);
        at[s ? 1 : 0] = cursor.offset;
        rheo__get_u32(&cursor);
        const uint32_t writes = rheo__get_u32(&cursor);
        written = written || !writes ? written : cursor.offset;
        cursor.offset += 4 * (size_t)writes;
    }
    assert_true(!cursor.failed && cursor.offset == end && at[1] > 0 && written > 0);
    OK(read_with(payload, size, written, fields - 1));
    assert_int_equal(read_with(payload, size, written, fields), RHEO_ERROR_FORMAT);
    OK(read_with(payload, size, at[1], RHEO__AFTER_SUBSTEPS));
    assert_int_equal(read_with(payload, size, at[1], RHEO__AFTER_SUBSTEPS + 1), RHEO_ERROR_FORMAT);
    assert_int_equal(read_with(payload, size, at[0], RHEO__AFTER_SUBSTEPS), RHEO_ERROR_FORMAT); /* none goes back */
    assert_int_equal(read_with(payload, size, 0, 0), RHEO_ERROR_FORMAT);
    assert_int_equal(read_with(payload, size, 4, 5), RHEO_ERROR_FORMAT);
    OK(read_with(payload, size, 8, 1));
    assert_int_equal(read_with(payload, size, 8, 2), RHEO_ERROR_FORMAT);
    /* More fields, without names. */
    uint8_t *more = calloc(size + (MOST_FIELDS + 1) * DUMMY, 1);
    for (uint32_t n = MOST_FIELDS; n <= MOST_FIELDS + 1; n++) {
        const size_t added = (n - fields) * DUMMY;
        memset(more, 0, size + added);
        memcpy(more, payload, layout);
        put(more + layout, n, 4);
        memcpy(more + layout + 4 + added, payload + layout + 4, size - layout - 4);
        assert_int_equal(read_head(more, size + added), n == MOST_FIELDS ? RHEO_OK : RHEO_ERROR_FORMAT);
    }
    /* As many metrics as there are names of no letters, and one more. */
    memcpy(more, payload, end);
    memset(more + end, 0, 4 + 6);
    OK(read_with(more, end + 4 + 6, end, 3));
    assert_int_equal(read_with(more, end + 4 + 6, end, 4), RHEO_ERROR_FORMAT);
    free(more);
    free(bytes);
}

/* The name of the scene has a length of two bytes. */
static void the_name_of_a_scene_has_at_most_65535_bytes(void **state)
{
    (void)state;
    char *name = calloc(UINT16_MAX + 2, 1);
    memset(name, 'n', UINT16_MAX + 1);
    rheo_world *world = make_world(2);
    void *bytes;
    size_t size;
    REFUSED(RHEO_ERROR_ARGUMENT, "65536 bytes; at most 65535",
            rheo_world_save_memory(world, name, &bytes, &size, &error));
    name[UINT16_MAX] = 0;
    OK(rheo_world_save_memory(world, name, &bytes, &size, &error));
    rheo_recording *r;
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    assert_string_equal(rheo_recording_get_info(r).scene, name);
    assert_int_equal(rheo_recording_get_info(r).keyframe_spacing, 0);
    rheo_recording_close(r);
    free(bytes);
    rheo_world_destroy(world);
    free(name);
}

/* The index has an entry of 24 bytes for each keyframe; without it, or with one less, the recording does not end. */
static void every_keyframe_is_in_the_index(void **state)
{
    (void)state;
    for (uint64_t steps = 0; steps <= 4; steps += 4) {
        size_t size;
        uint8_t *bytes = record(2, steps, 2, false, NULL, &size), *other = malloc(size);
        const size_t index = find(bytes, size, "INDX", 0), length = chunk_size(bytes + index),
                     done = find(bytes, size, "DONE", 0);
        rheo_recording *r;
        OK(rheo_recording_open_memory(bytes, size, &r, &error));
        const uint64_t keyframes = rheo_recording_get_info(r).keyframes;
        rheo_recording_close(r);
        assert_true(get(bytes + index + 16, 8) == 24 * keyframes && get(bytes + index + 24, 8) == 24 * keyframes);
        for (int less = 0; less < 2; less++) { /* one entry less, or no index */
            const size_t cut = less ? 24 : length;
            memcpy(other, bytes, index + length);
            put(other + index + 16, 24 * keyframes - 24, 8);
            put(other + index + 24, 24 * keyframes - 24, 8);
            seal(other + index);
            memcpy(other + index + length - cut, bytes + index + length, size - index - length);
            const rheo_verification v = verify_bytes(other, size - cut);
            assert_int_equal(v.verdict, RHEO_UNREADABLE);
            assert_non_null(strstr(v.message, "does not fit the recording that it ends"));
        }
        /* The hash at the end counts. */
        memcpy(other, bytes, size);
        put(other + done + 32 + 16, get(bytes + done + 32 + 16, 8) ^ 1, 8);
        seal(other + done);
        assert_int_not_equal(verify_bytes(other, size).verdict, RHEO_SAME);
        /* A head and an end are no recording. */
        if (steps == 0) {
            const size_t head = 8 + chunk_size(bytes + 8);
            memcpy(other, bytes, head);
            memcpy(other + head, bytes + done, size - done);
            const rheo_verification v = verify_bytes(other, head + size - done);
            assert_int_equal(v.verdict, RHEO_UNREADABLE);
            assert_non_null(strstr(v.message, "does not fit the recording that it ends"));
        }
        free(other);
        free(bytes);
    }
}

static void the_other_number_type_is_refused(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 4, 0, false, NULL, &size);
    put(bytes + 8 + 32 + 4, 12 - sizeof(rheo_real), 4);
    seal(bytes + 8);
    rheo_recording *r;
    rheo_world *world;
    double metrics[64];
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    assert_int_equal(rheo_recording_get_info(r).real_bytes, 12 - sizeof(rheo_real));
    OK(rheo_recording_metrics(r, 3, metrics, &error));
    assert_true(metrics[0] == 3);
    assert_int_equal(rheo_recording_world(r, 1, NULL, &world, &why), RHEO_ERROR_UNSUPPORTED);
    assert_non_null(strstr(why.message, "this build uses"));
    rheo_recording_close(r);
    assert_int_equal(verify_bytes(bytes, size).verdict, RHEO_UNREADABLE);
    free(bytes);
}

static void the_locale_has_no_effect(void **state)
{
    (void)state;
    size_t size, german_size;
    uint8_t *bytes = record(2, 4, 2, true, NULL, &size);
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
        free(bytes);
        skip();
    }
    uint8_t *german = record(2, 4, 2, true, NULL, &german_size);
    assert_int_equal(size, german_size);
    assert_memory_equal(bytes, german, size);
    assert_int_equal(verify_bytes(german, size).verdict, RHEO_SAME);
    setlocale(LC_ALL, "C");
    free(bytes);
    free(german);
}

/* ---- docs/format.md ---- */

static void the_hash_is_as_documented(void **state)
{
    (void)state;
    /* The only particle of the world is at (1, 2, 3). Step = 7. Spring 3:7 has length 1.5. No other items. */
    uint64_t sum =
        rheo__hash_word(0, 0, UINT64_C(0x400000003F800000)) + rheo__hash_word(0, 1, UINT64_C(0x0000000040400000));
    assert_true(rheo__hash_word(0, 0, 0) == UINT64_C(0x4E17CF67001B3979));
    assert_true(sum == UINT64_C(0xBFACCCA5F447B49F));
    assert_true(rheo__hash_field(sum, 1, 1) == UINT64_C(0x8952EA0C6417AB75));
    assert_true(rheo__hash_field(rheo__hash_word(0, 0, 7), 1, 1) == UINT64_C(0x6178FA89EAFC543B));
    uint64_t key = rheo__hash_key(3) * rheo__hash_key(7);
    const uint64_t root = UINT64_C(0x3FC00000) + RHEO__HASH_LENGTH, keys = rheo__hash_key(3) + rheo__hash_key(7);
    assert_true(rheo__hash_key(3) == UINT64_C(0x4AE24EE7585B10B1) && key == UINT64_C(0xDFDC0C4C7EBC6B59));
    assert_true(rheo__hash_field(key, 1, 1) == UINT64_C(0x8B059C703B7FBCE4));
    assert_true(RHEO__HASH_LENGTH == 0x2545F491);
    assert_true(rheo__hash_field(keys * (root * root), 1, 1) == UINT64_C(0xD36D7925BF36CDCE));
    assert_true(rheo__hash_field(keys * rheo__hash_finish(UINT64_C(0x3FF8000000000000)), 1, 1) ==
                UINT64_C(0xAF824F4BDFFA0CB8));
    assert_true(rheo__hash_field(0, 1, 0) == UINT64_C(0xCDC98B6BA68426C4));
    for (uint64_t x = 1; x < UINT64_MAX / 3; x *= 3)
        assert_true(rheo__hash_unfinish(rheo__hash_finish(x)) == x);
}

/* Inflated and then unpacked, a few bytes could ask for a thousand times as much memory twice. */
static void packed_states_are_never_compressed(void **state)
{
    (void)state;
    enum { ROOM = 1 << 22 };
    size_t size;
    uint8_t *bytes = record(3, 4, 0, true, NULL, &size), *other = malloc(ROOM);
    forged f;
    forge_open(&f, bytes, size, ROOM);
    forged_chunk *states = forge_find(&f, RHEO__STAT, 0);
    assert_false(states->flags & RHEO__CHUNK_ZLIB);
    states->flags |= RHEO__CHUNK_ZLIB;
    states->data = realloc(states->data, 1 << 16);
    memset(states->data + states->size, 0, (1 << 16) - states->size);
    states->size = 1 << 16;
    const rheo_verification v = verify_bytes(other, forge_write(&f, true, other, ROOM));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "no chunk can begin as the bytes at"));
    forge_release(&f);
    free(other);
    free(bytes);
}

/* Loading does not simulate a stored state again: the hashes of the step decide. No stage writes vibrator_position. */
static void a_changed_byte_of_a_stored_state_is_refused(void **state)
{
    (void)state;
    enum { ROOM = 1 << 20, STEPS = 3 };
    uint64_t hashes[STEPS + 1];
    size_t size, wrong_hashes = 0;
    const rheo_real vibrators[] = {1, 0, 0, 4}; /* of scene_def() */
    uint8_t *bytes = record(2, STEPS, 0, true, hashes, &size), *other = malloc(ROOM);
    for (uint64_t step = 1; step <= STEPS; step++) {
        forged f;
        forge_open(&f, bytes, size, ROOM);
        forged_chunk *stored = forge_find(&f, RHEO__STAT, (size_t)step - 1);
        assert_true(stored->step == step);
        for (size_t at = 0; at < stored->size; at += every()) {
            const uint8_t bit = (uint8_t)(1u << (at * 2654435761u >> 7 & 7));
            stored->data[at] ^= bit;
            rheo_recording *r;
            rheo_world *world;
            OK(rheo_recording_open_memory(other, forge_write(&f, true, other, ROOM), &r, &error));
            const rheo_result result = rheo_recording_world(r, step, NULL, &world, &why);
            if (result == RHEO_OK) {
                memcpy(world->state.vibrator_position, vibrators, sizeof vibrators);
                assert_true(rheo_world_hash(world) == hashes[step]);
            } else
                assert_int_equal(result, RHEO_ERROR_FORMAT);
            char text[96];
            snprintf(text, sizeof text, "in the stored state of step %d position does not have its hash", (int)step);
            wrong_hashes += result != RHEO_OK && strstr(why.message, text);
            rheo_world_destroy(world);
            rheo_recording_close(r);
            stored->data[at] ^= bit;
        }
        forge_release(&f);
    }
    assert_true(wrong_hashes > STEPS);
    free(other);
    free(bytes);
}

/* Everything is checked before anything is written: no world is left with half a state. */
static void a_stored_state_that_contradicts_itself_changes_nothing(void **state)
{
    (void)state;
    enum { WAYS = 9, NEVER_WAS = 9 }; /* a rest length of 0 is possible, but this state does not have it */
    size_t size;
    uint8_t *bytes = record(3, 3, 0, true, NULL, &size);
    for (int way = 0; way <= WAYS + 1; way++) {
        rheo_recording *r;
        rheo_world *world;
        OK(rheo_recording_open_memory(bytes, size, &r, &error));
        OK(rheo_recording_world(r, 1, NULL, &world, &error));
        const uint64_t hash = rheo_world_hash(world);
        OK(rheo__values_take(&r->before, &world->state, false, &error));
        OK(rheo__recording_read_step(r, 1, &error));
        OK(rheo__recording_read_state(r, 1, world->state.present, &r->before, &r->now, &error));
        uint64_t *step = r->now.data[RHEO__FIELD_step], *rows = r->now.data[RHEO__FIELD_history_rows];
        uint32_t *ends = r->now.data[RHEO__FIELD_spring_ends];
        rheo_real *rest = r->now.data[RHEO__FIELD_spring_rest_length];
        const size_t last = r->now.items[RHEO__FIELD_spring_ends] - 1;
        assert_true(last > 3);
        switch (way) {
        case 0:
            *step += 1;
            break;
        case 1:
            *rows += 1;
            break;
        case 2:
            r->now.items[RHEO__FIELD_position]--;
            break;
        case 3:
            ends[2 * last] = ends[2 * last + 1];
            break;
        case 4:
            ends[2 * last + 1] = 27;
            break;
        case 5:
            rest[last] = -1;
            break;
        case 6:
            rest[0] = (rheo_real)INFINITY;
            break;
        case 7:
            rest[last] = (rheo_real)NAN;
            break;
        case 8:
            r->now.items[RHEO__FIELD_step] = 0;
            break;
        case NEVER_WAS:
            rest[last] = 0;
            break;
        }
        if (way < WAYS) {
            REFUSED(RHEO_ERROR_FORMAT, "the stored state of step 2 contradicts itself",
                    rheo__full_restore(r, 2, &r->now, 0, world, &error));
            assert_true(rheo_world_hash(world) == hash);
        } else if (way == NEVER_WAS) {
            REFUSED(RHEO_ERROR_FORMAT, "spring_rest_length does not have its hash",
                    rheo__full_restore(r, 2, &r->now, 0, world, &error));
        } else {
            OK(rheo__full_restore(r, 2, &r->now, 0, world, &error));
        }
        rheo_world_destroy(world);
        rheo_recording_close(r);
    }
    free(bytes);
}

/* The mark of a golden recording and how it was made are ahead of everything else but the head, and each is there once. */
static void notes_follow_the_head(void **state)
{
    (void)state;
    enum { ROOM = 1 << 20 };
    static const uint8_t MADE[] = {2, 0, 0, 0, 'm', 'e', 0, 0, 0, 0}; /* by "me", without a scene */
    static const struct {
        uint32_t type;
        const uint8_t *data;
        size_t size;
    } NOTE[] = {{RHEO__GOLD, NULL, 0}, {RHEO__MADE, MADE, sizeof MADE}};
    size_t size, kinds[2] = {0};
    uint8_t *bytes = record(2, 3, 2, true, NULL, &size), *other = malloc(ROOM);
    forged whole;
    forge_open(&whole, bytes, size, ROOM);
    assert_true(whole.chunk[0].type == RHEO__HEAD && whole.chunk[whole.count - 1].type == RHEO__DONE);
    const size_t chunks = whole.count;
    forge_release(&whole);
    for (size_t n = 0; n < 2; n++)
        for (size_t first = 1; first < chunks; first++)
            for (int twice = 0; twice < 2; twice++) {
                forged f;
                forge_open(&f, bytes, size, ROOM);
                for (int i = 0; i <= twice; i++)
                    assert_true(
                        forge_insert(&f, first, NOTE[n].type, RHEO__CHUNK_OPTIONAL, 0, NOTE[n].data, NOTE[n].size));
                const rheo_verification v = verify_bytes(other, forge_write(&f, true, other, ROOM));
                const bool good = first == 1 && !twice;
                if (v.verdict != (good ? RHEO_SAME : RHEO_UNREADABLE))
                    fail_msg("note %zu at %zu: %s", n, first, v.message);
                kinds[good]++;
                forge_release(&f);
            }
    assert_true(kinds[true] == 2 && kinds[false] > 16);
    free(other);
    free(bytes);
}

static void the_program_for_the_other_number_type_is_named(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 1, 0, false, NULL, &size);
    put(bytes + 8 + 36, 12 - sizeof(rheo_real), 4); /* real_bytes of HEAD */
    seal(bytes + 8);
    const rheo_verification v = verify_bytes(bytes, size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, sizeof(rheo_real) == 4
                                          ? "recorded with double, this build uses float; the program rheolog-double "
                                            "can read it"
                                          : "recorded with float, this build uses double; the program rheolog can"));
    free(bytes);
}

/* Regression: only the first keyframe's parameters were used, so those of later ones could be anything. */
static void a_later_keyframe_with_other_parameters_differs(void **state)
{
    (void)state;
    enum { ROOM = 1 << 22 };
    size_t size;
    uint8_t *bytes = record(2, 9, 3, false, NULL, &size), *other = malloc(ROOM);
    assert_int_equal(verify_bytes(bytes, size).verdict, RHEO_SAME);
    forged f;
    forge_open(&f, bytes, size, ROOM);
    assert_true(forge_parameter(&f, 2, "fluid.linear_viscosity", .75));
    rheo_verification v = verify_bytes(other, forge_write(&f, true, other, ROOM));
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_int_equal(v.steps, 5);
    assert_int_equal(v.first.step, 6);
    assert_string_equal(v.first.field, "fluid.linear_viscosity");
    assert_string_equal(v.first.stage, "");
    assert_non_null(strstr(v.message, "differs at step 6: fluid.linear_viscosity is 0.75 in the keyframe of the "
                                      "recording, and 0.7 in the run up to there"));
    /* The right value again, written by the same means. */
    assert_true(forge_parameter(&f, 2, "fluid.linear_viscosity", .7));
    assert_int_equal(verify_bytes(other, forge_write(&f, true, other, ROOM)).verdict, RHEO_SAME);
    forge_release(&f);
    free(other);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packed_states_are_never_compressed),
        cmocka_unit_test(notes_follow_the_head),
        cmocka_unit_test(a_changed_byte_of_a_stored_state_is_refused),
        cmocka_unit_test(a_stored_state_that_contradicts_itself_changes_nothing),
        cmocka_unit_test(the_program_for_the_other_number_type_is_named),
        cmocka_unit_test(a_later_keyframe_with_other_parameters_differs),
        cmocka_unit_test(a_missing_step_is_found),
        cmocka_unit_test(a_truncated_file_is_valid_up_to_the_cut),
        cmocka_unit_test(a_wrong_length_is_damage_not_truncation),
        cmocka_unit_test(a_damaged_step_is_not_healthy),
        cmocka_unit_test(any_changed_byte_is_found),
        cmocka_unit_test(hostile_bytes_are_harmless),
        cmocka_unit_test(unknown_chunks_and_versions),
        cmocka_unit_test(numbers_of_a_head_are_limited),
        cmocka_unit_test(the_name_of_a_scene_has_at_most_65535_bytes),
        cmocka_unit_test(every_keyframe_is_in_the_index),
        cmocka_unit_test(the_other_number_type_is_refused),
        cmocka_unit_test(the_locale_has_no_effect),
        cmocka_unit_test(the_hash_is_as_documented),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
