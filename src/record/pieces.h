/*
 * Arrays in pieces. A state of any size is written to and read from chunks of about 1 MiB. A chunk holds pieces; a
 * piece is a run of values of one array: in keyframes as byte planes, which compress better than values; in the states
 * of steps packed, which takes a sixth more bytes than zlib and much less time.
 */
#ifndef RHEO__RECORD_PIECES_H
#define RHEO__RECORD_PIECES_H

#include "record/chunk.h"

typedef struct rheo__pieces_writer {
    rheo__writer *writer;
    uint32_t type; /* type of the chunks */
    uint64_t step;
    uint64_t chunks; /* number written */
    bool compress;
    rheo__bytes bytes;
} rheo__pieces_writer;

/* Writes values first .. first + count - 1 of array `part` of a field. */
rheo_result rheo__pieces_put(rheo__pieces_writer *pieces, uint32_t field, uint32_t part, uint64_t first,
                             const void *values, size_t count, size_t element_size, rheo_error *error);
/* Writes the last chunk, which may not be full. */
rheo_result rheo__pieces_flush(rheo__pieces_writer *pieces, rheo_error *error);

typedef struct rheo__pieces_reader {
    rheo__reader *reader;
    uint32_t type;
    uint64_t step, offset, end; /* reads chunks of this type from `offset` to `end` and skips others */
    rheo__bytes bytes;
    rheo__cursor cursor;
} rheo__pieces_reader;

/* Reads the values of one rheo__pieces_put(), which must be the next; else RHEO_ERROR_FORMAT. */
rheo_result rheo__pieces_get(rheo__pieces_reader *pieces, uint32_t field, uint32_t part, uint64_t first, void *values,
                             size_t count, size_t element_size, rheo_error *error);
/* Checks that nothing is left to read. */
rheo_result rheo__pieces_end(rheo__pieces_reader *pieces, rheo_error *error);

#endif
