/* Writers and readers of bytes: to and from a file, or memory. */
#ifndef RHEO__RECORD_STREAM_H
#define RHEO__RECORD_STREAM_H

#include <stdio.h>

#include "record/bytes.h"

typedef struct rheo__writer {
    FILE *file; /* or NULL: */
    rheo__bytes *memory;
    char path[256]; /* of the file, for messages; may be cut off */
    uint64_t written;
    rheo__bytes frame; /* a chunk is assembled here and written in one call */
} rheo__writer;

/* Sets the path that messages name. */
void rheo__writer_name(rheo__writer *writer, const char *path);
/* Writes and flushes. */
rheo_result rheo__writer_write(rheo__writer *writer, const void *data, size_t size, rheo_error *error);
/* Closes the file, if it is one, and releases the frame. */
rheo_result rheo__writer_close(rheo__writer *writer, rheo_error *error);

typedef struct rheo__reader {
    FILE *file; /* or NULL: */
    const uint8_t *memory;
    uint64_t size;     /* without the zeros at the end of a file */
    bool zeros;        /* more follow than a recording can end with */
    uint64_t offset;   /* position of the file */
    bool growing;      /* a recorder was writing the file when it was opened */
    rheo__bytes frame; /* stored bytes of the chunk that was read last */
} rheo__reader;

rheo_result rheo__reader_open(rheo__reader *reader, const char *path, rheo_error *error);
void rheo__reader_close(rheo__reader *reader);
/* The caller has checked that the bytes are within `size`. */
rheo_result rheo__reader_read(rheo__reader *reader, uint64_t offset, void *to, size_t size, rheo_error *error);

#endif
