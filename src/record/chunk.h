/* Chunks, the parts that a recording is made of. docs/format.md describes them to the byte. */
#ifndef RHEO__RECORD_CHUNK_H
#define RHEO__RECORD_CHUNK_H

#include "record/stream.h"

#define RHEO__CHUNK(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

enum {
    RHEO__HEAD = RHEO__CHUNK('H', 'E', 'A', 'D'), /* scene, definition, layout and build */
    RHEO__GOLD = RHEO__CHUNK('G', 'O', 'L', 'D'), /* it is blessed; optional */
    RHEO__MADE = RHEO__CHUNK('M', 'A', 'D', 'E'), /* how it was made; optional */
    RHEO__MEMB = RHEO__CHUNK('M', 'E', 'M', 'B'), /* members: runs that show what is chance; optional */
    RHEO__FILD = RHEO__CHUNK('F', 'I', 'L', 'D'), /* pieces of the fields of a keyframe, before its KEYF */
    RHEO__KEYF = RHEO__CHUNK('K', 'E', 'Y', 'F'), /* a complete state */
    RHEO__INPT = RHEO__CHUNK('I', 'N', 'P', 'T'), /* a command, before the STEP that it precedes */
    RHEO__STAT = RHEO__CHUNK('S', 'T', 'A', 'T'), /* pieces of the state after a step, before its STEP */
    RHEO__STEP = RHEO__CHUNK('S', 'T', 'E', 'P'), /* a step: hashes and metrics */
    RHEO__FAIL = RHEO__CHUNK('F', 'A', 'I', 'L'), /* the step that failed */
    RHEO__BLES = RHEO__CHUNK('B', 'L', 'E', 'S'), /* why a golden recording was accepted */
    RHEO__SAME = RHEO__CHUNK('S', 'A', 'M', 'E'), /* how far a blessed change goes, after its BLES; optional */
    RHEO__INDX = RHEO__CHUNK('I', 'N', 'D', 'X'), /* where the keyframes are */
    RHEO__DONE = RHEO__CHUNK('D', 'O', 'N', 'E'), /* the end mark */
};

enum {
    RHEO__MAGIC_SIZE = 8,
    RHEO__CHUNK_HEADER = 32,
    RHEO__CHUNK_OPTIONAL = 1,               /* flag: a reader that does not know the type skips it */
    RHEO__CHUNK_ZLIB = 2,                   /* flag: the payload is a zlib stream */
    RHEO__CHUNK_LARGEST = 16 * 1024 * 1024, /* bytes of a payload before compression */
    RHEO__PIECE = 1024 * 1024,              /* bytes at which payloads of pieces are cut */
};

extern const uint8_t rheo__magic[RHEO__MAGIC_SIZE];

typedef struct rheo__chunk {
    uint32_t type, flags;
    uint64_t step, stored, raw;
    uint64_t offset, end; /* in the file: of the header, and past the checksum */
} rheo__chunk;

/* Writes a chunk in one call, with the flags of its type. `compress`: as a zlib stream, if that is shorter. */
rheo_result rheo__chunk_write(rheo__writer *writer, uint32_t type, uint64_t step, const rheo__bytes *payload,
                              bool compress, rheo_error *error);

/*
 * Reads the header of the chunk at `offset` <= size, not its payload. RHEO_ERROR_FORMAT: damaged, or, if *truncated
 * is set, cut off by the end of the file.
 */
rheo_result rheo__chunk_at(rheo__reader *reader, uint64_t offset, rheo__chunk *chunk, bool *truncated,
                           rheo_error *error);
/* Reads, checks and inflates the payload. */
rheo_result rheo__chunk_read(rheo__reader *reader, const rheo__chunk *chunk, rheo__bytes *payload, rheo_error *error);
/* Whether this version knows the type. */
bool rheo__chunk_known(uint32_t type);
/* A type as text of 4 characters; `name` holds 5. */
void rheo__chunk_name(uint32_t type, char name[5]);

static inline rheo__cursor rheo__cursor_over(const rheo__bytes *bytes)
{
    return (rheo__cursor){bytes->data, bytes->size, 0, false};
}

#endif
