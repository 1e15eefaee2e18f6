/*
 * Numbers to bytes and back. Files are little-endian on every machine: numbers are converted by shifts, so no code
 * depends on the byte order of the machine.
 */
#include "record/bytes.h"

#include <stdlib.h>
#include <string.h>

#include "core/text.h"

void rheo__bytes_release(rheo__bytes *bytes)
{
    free(bytes->data);
    *bytes = (rheo__bytes){0};
}

bool rheo__bytes_resize(rheo__bytes *bytes, size_t size)
{
    if (bytes->failed)
        return false;
    if (size > bytes->capacity) {
        size_t capacity = size > SIZE_MAX / 2 ? size : size + size / 2 + 64;
        uint8_t *data = realloc(bytes->data, capacity);
        if (!data) {
            bytes->failed = true;
            return false;
        }
        bytes->data = data;
        bytes->capacity = capacity;
    }
    bytes->size = size;
    return true;
}

/* Makes room for `size` more bytes. NULL: no memory. */
static uint8_t *extend(rheo__bytes *bytes, size_t size)
{
    size_t offset = bytes->size;
    if (size > SIZE_MAX - offset) {
        bytes->failed = true;
        return NULL;
    }
    return rheo__bytes_resize(bytes, offset + size) ? bytes->data + offset : NULL;
}

void rheo__put_raw(rheo__bytes *bytes, const void *data, size_t size)
{
    uint8_t *to = extend(bytes, size);
    if (to && size)
        memcpy(to, data, size);
}

static void put_number(rheo__bytes *bytes, uint64_t value, size_t size)
{
    uint8_t *to = extend(bytes, size);
    for (size_t i = 0; to && i < size; i++)
        to[i] = (uint8_t)(value >> (8 * i));
}

void rheo__put_u32(rheo__bytes *bytes, uint32_t value)
{
    put_number(bytes, value, 4);
}

void rheo__put_u64(rheo__bytes *bytes, uint64_t value)
{
    put_number(bytes, value, 8);
}

void rheo__put_f64(rheo__bytes *bytes, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    rheo__put_u64(bytes, bits);
}

void rheo__put_text(rheo__bytes *bytes, const char *text)
{
    size_t length = strlen(text);
    if (length > UINT16_MAX)
        length = UINT16_MAX;
    put_number(bytes, length, 2);
    rheo__put_raw(bytes, text, length);
}

void rheo__put_planes(rheo__bytes *bytes, const void *values, size_t count, size_t element_size)
{
    uint8_t *to = extend(bytes, count * element_size);
    if (!to || !count)
        return;
    const char *from = values;
    for (size_t i = 0; i < count; i++, from += element_size) {
        if (element_size == 4) {
            uint32_t value;
            memcpy(&value, from, sizeof value);
            for (size_t plane = 0; plane < 4; plane++)
                to[plane * count + i] = (uint8_t)(value >> (8 * plane));
        } else {
            uint64_t value;
            memcpy(&value, from, sizeof value);
            for (size_t plane = 0; plane < 8; plane++)
                to[plane * count + i] = (uint8_t)(value >> (8 * plane));
        }
    }
}

static uint8_t *put_word(uint8_t *to, uint64_t word)
{
    for (int byte = 0; byte < 4; byte++)
        to[byte] = (uint8_t)(word >> (8 * byte));
    return to + 4;
}

/* Packs eight numbers; returns the end of what it wrote. Writes up to four bytes more. */
static uint8_t *pack(uint8_t *to, const uint32_t value[8])
{
    uint32_t any = 0;
    for (int i = 0; i < 8; i++)
        any |= value[i];
    const int bits = any ? 32 - __builtin_clz(any) : 0;
    uint8_t *end = to + 1 + bits;
    *to++ = (uint8_t)bits;
    uint64_t word = 0;
    for (int i = 0, filled = 0; i < 8 && bits; i++) {
        word |= (uint64_t)value[i] << filled;
        filled += bits;
        if (filled >= 32) {
            to = put_word(to, word);
            word >>= 32;
            filled -= 32;
        }
    }
    put_word(to, word);
    return end;
}

void rheo__put_packed(rheo__bytes *bytes, const void *values, size_t count, size_t element_size)
{
    const size_t parts = element_size / 4, groups = count / 8 + (count % 8 != 0);
    uint8_t *to = extend(bytes, groups * parts * 33 + 4);
    if (!to)
        return;
    for (size_t first = 0; first < count; first += 8)
        for (size_t part = 0; part < parts; part++) {
            uint32_t group[8] = {0};
            for (size_t i = 0; i < 8 && first + i < count; i++) {
                const char *from = (const char *)values + (first + i) * element_size;
                uint64_t value;
                if (parts == 1) {
                    memcpy(&group[i], from, 4);
                } else {
                    memcpy(&value, from, 8);
                    group[i] = (uint32_t)(value >> (32 * part));
                }
            }
            to = pack(to, group);
        }
    bytes->size = (size_t)(to - bytes->data);
}

/* The next `size` bytes, or NULL. */
static const uint8_t *take(rheo__cursor *cursor, size_t size)
{
    if (cursor->failed || size > rheo__cursor_left(cursor)) {
        cursor->failed = true;
        return NULL;
    }
    cursor->offset += size;
    return cursor->data + (cursor->offset - size);
}

static uint64_t get_number(rheo__cursor *cursor, size_t size)
{
    const uint8_t *from = take(cursor, size);
    uint64_t value = 0;
    for (size_t i = 0; from && i < size; i++)
        value |= (uint64_t)from[i] << (8 * i);
    return value;
}

uint32_t rheo__get_u32(rheo__cursor *cursor)
{
    return (uint32_t)get_number(cursor, 4);
}

uint64_t rheo__get_u64(rheo__cursor *cursor)
{
    return get_number(cursor, 8);
}

double rheo__get_f64(rheo__cursor *cursor)
{
    uint64_t bits = rheo__get_u64(cursor);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

void rheo__get_exact_text(rheo__cursor *cursor, char *text, size_t room)
{
    size_t length = (size_t)get_number(cursor, 2);
    const uint8_t *from = take(cursor, length);
    text[0] = 0;
    if (!from)
        return;
    if (length >= room || memchr(from, 0, length)) {
        cursor->failed = true;
        return;
    }
    memcpy(text, from, length);
    text[length] = 0;
}

void rheo__get_text(rheo__cursor *cursor, char *text, size_t room)
{
    rheo__get_exact_text(cursor, text, room);
    rheo__text_make_printable(text);
}

void rheo__get_planes(rheo__cursor *cursor, void *values, size_t count, size_t element_size)
{
    if (count > rheo__cursor_left(cursor) / element_size) {
        cursor->failed = true;
        return;
    }
    const uint8_t *from = take(cursor, count * element_size);
    char *to = values;
    for (size_t i = 0; from && i < count; i++, to += element_size) {
        if (element_size == 4) {
            uint32_t value = 0;
            for (size_t plane = 0; plane < 4; plane++)
                value |= (uint32_t)from[plane * count + i] << (8 * plane);
            memcpy(to, &value, sizeof value);
        } else {
            uint64_t value = 0;
            for (size_t plane = 0; plane < 8; plane++)
                value |= (uint64_t)from[plane * count + i] << (8 * plane);
            memcpy(to, &value, sizeof value);
        }
    }
}

/* Reads eight numbers that were packed; leaves them alone if there are none to read. */
static void unpack(rheo__cursor *cursor, uint32_t value[8])
{
    const uint8_t *from = take(cursor, 1);
    const int bits = from ? *from : 0;
    if (bits > 32)
        cursor->failed = true;
    from = take(cursor, (size_t)bits);
    if (!from)
        return;
    uint64_t word = 0;
    for (int i = 0, filled = 0; i < 8; i++) {
        for (; filled < bits; filled += 8)
            word |= (uint64_t)*from++ << filled;
        value[i] = (uint32_t)(word & ((UINT64_C(1) << bits) - 1));
        word >>= bits;
        filled -= bits;
    }
}

void rheo__get_packed(rheo__cursor *cursor, void *values, size_t count, size_t element_size)
{
    const size_t parts = element_size / 4;
    for (size_t first = 0; first < count && !cursor->failed; first += 8) {
        uint32_t group[2][8] = {{0}};
        for (size_t part = 0; part < parts; part++)
            unpack(cursor, group[part]);
        for (size_t i = 0; i < 8; i++) {
            char *to = (char *)values + (first + i) * element_size;
            const uint64_t value = group[0][i] | (uint64_t)group[1][i] << 32;
            if (first + i >= count)
                cursor->failed = cursor->failed || value != 0; /* the last group is filled up with 0 */
            else if (parts == 1)
                memcpy(to, &group[0][i], 4);
            else
                memcpy(to, &value, 8);
        }
    }
}
