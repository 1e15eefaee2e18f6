/* Little-endian bytes: a growing buffer to write into, and a cursor to read from that never leaves its bytes.
 */
#ifndef RHEO_RECORD_BYTES_H
#define RHEO_RECORD_BYTES_H

#include "rheolog/base.h"

/* From malloc. `failed` stays set once memory ran out; what is written after that is lost. */
typedef struct rheo_bytes {
    uint8_t *data;
    size_t size, capacity;
    bool failed;
} rheo_bytes;

void rheo_bytes_release(rheo_bytes *bytes);
/* Makes the size `size`, contents beyond the old size undefined. False: no memory. */
bool rheo_bytes_resize(rheo_bytes *bytes, size_t size);

void rheo_put_raw(rheo_bytes *bytes, const void *data, size_t size);
void rheo_put_u32(rheo_bytes *bytes, uint32_t value);
void rheo_put_u64(rheo_bytes *bytes, uint64_t value);
void rheo_put_f64(rheo_bytes *bytes, double value);
void rheo_put_text(rheo_bytes *bytes, const char *text); /* at most 65535 bytes of it */
/* Byte planes: the lowest bytes of all the values, then their second bytes, ... element_size: 4 or 8. */
void rheo_put_planes(rheo_bytes *bytes, const void *values, size_t count, size_t element_size);

/* `failed` is set by reading past the end and stays; all reads give 0 then. */
typedef struct rheo_cursor {
    const uint8_t *data;
    size_t size, at;
    bool failed;
} rheo_cursor;

static inline size_t rheo_cursor_left(const rheo_cursor *cursor)
{
    return cursor->size - cursor->at;
}

uint32_t rheo_get_u32(rheo_cursor *cursor);
uint64_t rheo_get_u64(rheo_cursor *cursor);
double rheo_get_f64(rheo_cursor *cursor);
/* Into `room` bytes, ended by 0. A text that is too long, or has a 0 inside, is a failed read. */
void rheo_get_text(rheo_cursor *cursor, char *text, size_t room);
void rheo_get_planes(rheo_cursor *cursor, void *values, size_t count, size_t element_size);

#endif
