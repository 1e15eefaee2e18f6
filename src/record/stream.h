/* Where the bytes of a recording go to and come from: a file, or memory. */
#ifndef RHEO__RECORD_STREAM_H
#define RHEO__RECORD_STREAM_H

#include <stdio.h>

#include "record/bytes.h"

typedef struct rheo__writer {
    FILE *file; /* or NULL: */
    rheo__bytes *memory;
    uint64_t written;
    rheo__bytes frame; /* a chunk is put together here, and leaves at once */
} rheo__writer;

/* Writes and flushes. */
rheo_result rheo__writer_write(rheo__writer *writer, const void *data, size_t size, rheo_error *error);
/* Closes the file, if it is one, and releases the frame. */
rheo_result rheo__writer_close(rheo__writer *writer, rheo_error *error);

typedef struct rheo__reader {
    FILE *file; /* or NULL: */
    const uint8_t *memory;
    uint64_t size;
    uint64_t at;       /* place of the file */
    rheo__bytes frame; /* what is stored of the chunk read last */
} rheo__reader;

rheo_result rheo__reader_open(rheo__reader *reader, const char *path, rheo_error *error);
void rheo__reader_close(rheo__reader *reader);
/* The caller has checked that the bytes lie inside of `size`. */
rheo_result rheo__reader_read(rheo__reader *reader, uint64_t at, void *to, size_t size, rheo_error *error);

#endif
