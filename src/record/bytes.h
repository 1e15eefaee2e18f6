/* Little-endian bytes: a growing buffer to write into, and a cursor to read from that never leaves its bytes.
 */
#ifndef RHEO__RECORD_BYTES_H
#define RHEO__RECORD_BYTES_H

#include "rheolog/base.h"

/* From malloc. `failed` stays set once memory ran out; what is written after that is lost. */
typedef struct rheo__bytes {
    uint8_t *data;
    size_t size, capacity;
    bool failed;
} rheo__bytes;

void rheo__bytes_release(rheo__bytes *bytes);
/* Makes the size `size`, contents beyond the old size undefined. False: no memory. */
bool rheo__bytes_resize(rheo__bytes *bytes, size_t size);

void rheo__put_raw(rheo__bytes *bytes, const void *data, size_t size);
void rheo__put_u32(rheo__bytes *bytes, uint32_t value);
void rheo__put_u64(rheo__bytes *bytes, uint64_t value);
void rheo__put_f64(rheo__bytes *bytes, double value);
void rheo__put_text(rheo__bytes *bytes, const char *text); /* at most 65535 bytes of it */
/* Byte planes: the lowest bytes of all the values, then their second bytes, ... element_size: 4 or 8. */
void rheo__put_planes(rheo__bytes *bytes, const void *values, size_t count, size_t element_size);

/* `failed` is set by reading past the end and stays; all reads give 0 then. */
typedef struct rheo__cursor {
    const uint8_t *data;
    size_t size, at;
    bool failed;
} rheo__cursor;

static inline size_t rheo__cursor_left(const rheo__cursor *cursor)
{
    return cursor->size - cursor->at;
}

uint32_t rheo__get_u32(rheo__cursor *cursor);
uint64_t rheo__get_u64(rheo__cursor *cursor);
double rheo__get_f64(rheo__cursor *cursor);
/* Into `room` bytes, ended by 0. A text that is too long, or has a 0 inside, is a failed read. */
void rheo__get_text(rheo__cursor *cursor, char *text, size_t room);
void rheo__get_planes(rheo__cursor *cursor, void *values, size_t count, size_t element_size);

#endif
