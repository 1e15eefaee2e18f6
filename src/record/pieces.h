/*
 * Arrays in pieces. A state of any size is written into and read from chunks of about a mebibyte: each holds
 * pieces; a piece is a run of values of one array, as byte planes, which compress better than values.
 */
#ifndef RHEO_RECORD_PIECES_H
#define RHEO_RECORD_PIECES_H

#include "record/chunk.h"

typedef struct rheo_pieces_writer {
    rheo_writer *writer;
    uint32_t type; /* of the chunks */
    uint64_t step;
    uint64_t chunks; /* written */
    bool compress;
    rheo_bytes bytes;
} rheo_pieces_writer;

/* Writes values first .. first + count - 1 of array `part` of a field. */
rheo_result rheo_pieces_put(rheo_pieces_writer *pieces, uint32_t field, uint32_t part, uint64_t first,
                            const void *values, size_t count, size_t element_size, rheo_error *error);
/* Writes the chunk that is not full yet. */
rheo_result rheo_pieces_flush(rheo_pieces_writer *pieces, rheo_error *error);

typedef struct rheo_pieces_reader {
    rheo_reader *reader;
    uint32_t type;
    uint64_t step, at, end; /* chunks of this type from `at` to `end` are read, others passed over */
    rheo_bytes bytes;
    rheo_cursor cursor;
} rheo_pieces_reader;

/* Reads what one rheo_pieces_put() wrote, which must come next; RHEO_ERROR_FORMAT else. */
rheo_result rheo_pieces_get(rheo_pieces_reader *pieces, uint32_t field, uint32_t part, uint64_t first, void *values,
                            size_t count, size_t element_size, rheo_error *error);
/* Checks that everything has been read. */
rheo_result rheo_pieces_end(rheo_pieces_reader *pieces, rheo_error *error);

#endif
