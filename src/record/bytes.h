/* Little-endian bytes: a growing buffer to write into, and a cursor that never reads beyond its bytes.
 */
#ifndef RHEO__RECORD_BYTES_H
#define RHEO__RECORD_BYTES_H

#include "rheolog/base.h"

/* Memory is from malloc. `failed` is set when memory runs out and stays set; later writes are lost. */
typedef struct rheo__bytes {
    uint8_t *data;
    size_t size, capacity;
    bool failed;
} rheo__bytes;

void rheo__bytes_release(rheo__bytes *bytes);
/* Sets the size; bytes beyond the old size are undefined. False: no memory. */
bool rheo__bytes_resize(rheo__bytes *bytes, size_t size);

void rheo__put_raw(rheo__bytes *bytes, const void *data, size_t size);
void rheo__put_u32(rheo__bytes *bytes, uint32_t value);
void rheo__put_u64(rheo__bytes *bytes, uint64_t value);
void rheo__put_f64(rheo__bytes *bytes, double value);
void rheo__put_text(rheo__bytes *bytes, const char *text); /* writes at most the first 65535 bytes */
/* Byte planes: the lowest bytes of all the values, then their second bytes, ... element_size: 4 or 8. */
void rheo__put_planes(rheo__bytes *bytes, const void *values, size_t count, size_t element_size);
/* Packed: groups of eight values, each with only as many bits as its largest one has. element_size: 4 or 8. */
void rheo__put_packed(rheo__bytes *bytes, const void *values, size_t count, size_t element_size);

/* `failed` is set by reading past the end and stays set; all later reads return 0. */
typedef struct rheo__cursor {
    const uint8_t *data;
    size_t size, offset;
    bool failed;
} rheo__cursor;

static inline size_t rheo__cursor_left(const rheo__cursor *cursor)
{
    return cursor->size - cursor->offset;
}

uint32_t rheo__get_u32(rheo__cursor *cursor);
uint64_t rheo__get_u64(rheo__cursor *cursor);
double rheo__get_f64(rheo__cursor *cursor);
/* Reads a text and ends it with 0, in `room` bytes. A text that is too long or contains a 0 fails. */
void rheo__get_exact_text(rheo__cursor *cursor, char *text, size_t room);
/* The same for people: made printable, since anyone may have written the file. */
void rheo__get_text(rheo__cursor *cursor, char *text, size_t room);
void rheo__get_planes(rheo__cursor *cursor, void *values, size_t count, size_t element_size);
void rheo__get_packed(rheo__cursor *cursor, void *values, size_t count, size_t element_size);

#endif
