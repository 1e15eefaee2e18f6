/* Where the bytes of a recording go to and come from: a file, or memory. */
#ifndef RHEO_RECORD_STREAM_H
#define RHEO_RECORD_STREAM_H

#include <stdio.h>

#include "record/bytes.h"

typedef struct rheo_writer {
    FILE *file; /* or NULL: */
    rheo_bytes *memory;
    uint64_t written;
    rheo_bytes frame; /* a chunk is put together here, and leaves at once */
} rheo_writer;

/* Writes and flushes. */
rheo_result rheo_writer_write(rheo_writer *writer, const void *data, size_t size, rheo_error *error);
/* Closes the file, if it is one, and releases the frame. */
rheo_result rheo_writer_close(rheo_writer *writer, rheo_error *error);

typedef struct rheo_reader {
    FILE *file; /* or NULL: */
    const uint8_t *memory;
    uint64_t size;
    uint64_t at;      /* place of the file */
    rheo_bytes frame; /* what is stored of the chunk read last */
} rheo_reader;

rheo_result rheo_reader_open(rheo_reader *reader, const char *path, rheo_error *error);
void rheo_reader_close(rheo_reader *reader);
/* The caller has checked that the bytes lie inside of `size`. */
rheo_result rheo_reader_read(rheo_reader *reader, uint64_t at, void *to, size_t size, rheo_error *error);

#endif
