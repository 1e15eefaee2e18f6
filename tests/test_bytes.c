/* Numbers, texts and byte planes of recordings, as docs/format.md has them: whole, cut anywhere, and into any room. */
#include "support.h"

#include "record/bytes.h"

enum { MOST = 20 };

static rheo__cursor cursor_over(const rheo__bytes *bytes, size_t size)
{
    return (rheo__cursor){.data = bytes->data, .size = size};
}

static void numbers_are_little_endian(void **state)
{
    (void)state;
    static const uint8_t expected[] = {0x04, 0x03, 0x02, 0x81, 0x08, 0x07, 0x06, 0x05, 0x04, 0x03,
                                       0x02, 0xf1, 0,    0,    0,    0,    0,    0,    0xf8, 0xbf};
    rheo__bytes bytes = {0};
    rheo__put_u32(&bytes, 0x81020304);
    rheo__put_u64(&bytes, UINT64_C(0xf102030405060708));
    rheo__put_f64(&bytes, -1.5);
    assert_int_equal(bytes.size, sizeof expected);
    assert_memory_equal(bytes.data, expected, sizeof expected);
    for (size_t size = 0; size <= sizeof expected; size++) {
        rheo__cursor cursor = cursor_over(&bytes, size);
        assert_true(rheo__get_u32(&cursor) == (size < 4 ? 0 : 0x81020304));
        assert_true(cursor.failed == (size < 4));
        assert_true(rheo__get_u64(&cursor) == (size < 12 ? 0 : UINT64_C(0xf102030405060708)));
        assert_true(cursor.failed == (size < 12));
        assert_true(rheo__get_f64(&cursor) == (size < 20 ? 0 : -1.5));
        assert_true(cursor.failed == (size < 20));
        assert_int_equal(cursor.offset, size < 4 ? 0 : size < 12 ? 4 : size < 20 ? 12 : 20);
    }
    rheo__bytes_release(&bytes);
}

/* A failed cursor stays where it is, and gives nothing even where bytes are left. */
static void nothing_is_read_after_a_failure(void **state)
{
    (void)state;
    const uint8_t data[16] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    rheo__cursor cursor = {.data = data, .size = sizeof data, .failed = true};
    char text[4] = "abc";
    uint32_t values[2] = {7, 8};
    assert_true(rheo__get_u32(&cursor) == 0 && rheo__get_u64(&cursor) == 0 && rheo__get_f64(&cursor) == 0);
    rheo__get_text(&cursor, text, sizeof text);
    rheo__get_planes(&cursor, values, 2, 4);
    rheo__get_packed(&cursor, values, 2, 4);
    assert_string_equal(text, "");
    assert_true(values[0] == 7 && values[1] == 8 && cursor.offset == 0);
}

/* A text fits if it and the 0 behind it do, and no byte of it is 0. Nothing is written beyond the room. */
static void a_text_fits_or_is_refused(void **state)
{
    (void)state;
    static const char letters[] = "abcdefghijklmnopqrst";
    for (size_t length = 0; length <= 9; length++)
        for (size_t room = 1; room <= 11; room++)
            for (size_t zero = 0; zero <= length; zero++) /* length: there is none */
                for (size_t cut = 0; cut <= length + 2; cut++) {
                    char source[MOST] = "", text[MOST];
                    rheo__bytes bytes = {0};
                    memcpy(source, letters, length);
                    rheo__put_text(&bytes, source);
                    assert_int_equal(bytes.size, length + 2);
                    assert_true(bytes.data[0] == length && bytes.data[1] == 0);
                    if (zero < length)
                        bytes.data[2 + zero] = 0;
                    memset(text, '#', sizeof text);
                    rheo__cursor cursor = cursor_over(&bytes, cut);
                    rheo__get_exact_text(&cursor, text, room);
                    const bool good = cut == length + 2 && zero == length && length < room;
                    assert_true(cursor.failed == !good);
                    assert_string_equal(text, good ? source : "");
                    for (size_t i = good ? length + 1 : 1; i < sizeof text; i++)
                        assert_true(text[i] == '#');
                    rheo__bytes_release(&bytes);
                }
}

static void the_longest_text_has_65535_bytes(void **state)
{
    (void)state;
    static char source[70001], text[70001];
    for (size_t length = 65534; length <= 70000; length += length < 65537 ? 1 : 4463) {
        const size_t kept = length < 65535 ? length : 65535;
        rheo__bytes bytes = {0};
        memset(source, 'x', length);
        source[length] = 0;
        rheo__put_text(&bytes, source);
        assert_int_equal(bytes.size, kept + 2);
        rheo__cursor cursor = cursor_over(&bytes, bytes.size);
        rheo__get_text(&cursor, text, sizeof text);
        assert_true(!cursor.failed && cursor.offset == bytes.size);
        assert_int_equal(strlen(text), kept);
        rheo__bytes_release(&bytes);
    }
}

/* Byte i of value k is at i n + k. */
static void planes_hold_the_bytes_of_all_values(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (size_t size = 4; size <= 8; size += 4)
        for (size_t count = 0; count <= MOST; count++) {
            uint8_t values[8 * MOST], read[8 * MOST + 1];
            rheo__bytes bytes = {0};
            for (size_t i = 0; i < sizeof values; i++) {
                random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
                values[i] = (uint8_t)(random >> 56);
            }
            rheo__put_u32(&bytes, 0);
            rheo__put_planes(&bytes, values, count, size);
            assert_int_equal(bytes.size, 4 + size * count);
            for (size_t k = 0; k < count; k++)
                for (size_t i = 0; i < size; i++) {
                    uint64_t value = 0;
                    uint32_t half;
                    memcpy(&half, values + size * k, 4);
                    if (size == 8)
                        memcpy(&value, values + size * k, 8);
                    value = size == 8 ? value : half;
                    assert_true(bytes.data[4 + i * count + k] == (uint8_t)(value >> 8 * i));
                }
            for (size_t cut = 0; cut <= size * count; cut++) {
                rheo__cursor cursor = {.data = bytes.data, .size = 4 + cut, .offset = 4};
                memset(read, 0x5a, sizeof read);
                rheo__get_planes(&cursor, read, count, size);
                assert_true(cursor.failed == (cut < size * count));
                if (!cursor.failed) {
                    assert_memory_equal(read, values, size * count);
                    assert_int_equal(cursor.offset, 4 + size * count);
                }
                assert_int_equal(read[cursor.failed ? 0 : size * count], 0x5a);
            }
            rheo__bytes_release(&bytes);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_little_endian),           cmocka_unit_test(nothing_is_read_after_a_failure),
        cmocka_unit_test(a_text_fits_or_is_refused),           cmocka_unit_test(the_longest_text_has_65535_bytes),
        cmocka_unit_test(planes_hold_the_bytes_of_all_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
