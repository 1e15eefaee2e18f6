/* Chunks, the parts that a recording is made of. docs/format.md describes them to the byte. */
#ifndef RHEO_RECORD_CHUNK_H
#define RHEO_RECORD_CHUNK_H

#include "record/stream.h"

#define RHEO_CHUNK(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

enum {
    RHEO_HEAD = RHEO_CHUNK('H', 'E', 'A', 'D'), /* what was recorded, by whom */
    RHEO_FILD = RHEO_CHUNK('F', 'I', 'L', 'D'), /* pieces of the fields of a keyframe, before its KEYF */
    RHEO_KEYF = RHEO_CHUNK('K', 'E', 'Y', 'F'), /* a whole state */
    RHEO_INPT = RHEO_CHUNK('I', 'N', 'P', 'T'), /* a command given before a step, before its STEP */
    RHEO_STAT = RHEO_CHUNK('S', 'T', 'A', 'T'), /* pieces of the state after a step, before its STEP */
    RHEO_STEP = RHEO_CHUNK('S', 'T', 'E', 'P'), /* a step: hashes and metrics */
    RHEO_FAIL = RHEO_CHUNK('F', 'A', 'I', 'L'), /* the step that could not be made */
    RHEO_BLES = RHEO_CHUNK('B', 'L', 'E', 'S'), /* why a golden recording was made anew */
    RHEO_INDX = RHEO_CHUNK('I', 'N', 'D', 'X'), /* where the keyframes are */
    RHEO_DONE = RHEO_CHUNK('D', 'O', 'N', 'E'), /* the end mark */
};

enum {
    RHEO_MAGIC_SIZE = 8,
    RHEO_CHUNK_HEADER = 32,
    RHEO_CHUNK_OPTIONAL = 1,               /* flag: readers that do not know the type skip it */
    RHEO_CHUNK_ZLIB = 2,                   /* flag: the payload is a zlib stream */
    RHEO_CHUNK_LARGEST = 16 * 1024 * 1024, /* bytes of a payload before it is compressed */
    RHEO_PIECE = 1024 * 1024,              /* payloads of pieces are cut at about this many bytes */
};

extern const uint8_t rheo_magic[RHEO_MAGIC_SIZE];

typedef struct rheo_chunk {
    uint32_t type, flags;
    uint64_t step, stored, raw;
    uint64_t at, end; /* in the file */
} rheo_chunk;

/* Writes a chunk at once; `compress`: as a zlib stream if that is shorter. */
rheo_result rheo_chunk_write(rheo_writer *writer, uint32_t type, uint64_t step, const rheo_bytes *payload,
                             bool compress, rheo_error *error);

/*
 * The header of the chunk at `at` <= size. RHEO_ERROR_FORMAT: damaged, or, if *torn is set, cut off by the
 * end of the file. Does not look at the payload.
 */
rheo_result rheo_chunk_at(rheo_reader *reader, uint64_t at, rheo_chunk *chunk, bool *torn, rheo_error *error);
/* Reads, checks and inflates the payload. */
rheo_result rheo_chunk_read(rheo_reader *reader, const rheo_chunk *chunk, rheo_bytes *payload, rheo_error *error);
/* Whether this version knows the type. */
bool rheo_chunk_known(uint32_t type);
/* A type as text of 4 characters; `name` holds 5. */
void rheo_chunk_name(uint32_t type, char name[5]);

static inline rheo_cursor rheo_cursor_over(const rheo_bytes *bytes)
{
    return (rheo_cursor){bytes->data, bytes->size, 0, false};
}

#endif
