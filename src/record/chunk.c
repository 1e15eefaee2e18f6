/*
 * Chunks: a header of 32 bytes (type, flags, step, stored bytes, raw bytes), the payload, and a CRC-32 over
 * both. Lengths come from files that may be damaged or hostile: what they make a reader allocate is bounded
 * by a cap, and by what zlib can make of the bytes that are there.
 */
#include "record/chunk.h"

#include <string.h>
#include <zlib.h>

#include "core/error.h"

const uint8_t rheo_magic[RHEO_MAGIC_SIZE] = {0x89, 'R', 'L', 'O', 'G', 0x0D, 0x0A, 0x1A};

enum { CRC_SIZE = 4, ZLIB_LEVEL = 1, ZLIB_EXPANSION = 1032 };

bool rheo_chunk_known(uint32_t type)
{
    switch (type) {
    case RHEO_HEAD:
    case RHEO_FILD:
    case RHEO_KEYF:
    case RHEO_INPT:
    case RHEO_STAT:
    case RHEO_STEP:
    case RHEO_FAIL:
    case RHEO_BLES:
    case RHEO_INDX:
    case RHEO_DONE:
        return true;
    default:
        return false;
    }
}

void rheo_chunk_name(uint32_t type, char name[5])
{
    for (int i = 0; i < 4; i++) {
        char c = (char)(type >> (8 * i) & 0x7F);
        name[i] = c >= 0x20 && c < 0x7F ? c : '?';
    }
    name[4] = 0;
}

rheo_result rheo_chunk_write(rheo_writer *writer, uint32_t type, uint64_t step, const rheo_bytes *payload,
                             bool compress, rheo_error *error)
{
    if (payload->failed)
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory to write a part of the recording");
    if (payload->size > RHEO_CHUNK_LARGEST)
        return rheo_fail(error, RHEO_ERROR_UNSUPPORTED, "a part of the recording has %zu bytes; at most %d fit",
                         payload->size, RHEO_CHUNK_LARGEST);
    rheo_bytes *frame = &writer->frame;
    frame->failed = false;
    uLongf stored = (uLongf)payload->size;
    if (!rheo_bytes_resize(frame, RHEO_CHUNK_HEADER + (compress ? compressBound(stored) : stored) + CRC_SIZE))
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory to write a part of the recording");
    uint8_t *body = frame->data + RHEO_CHUNK_HEADER;
    if (compress) {
        stored = compressBound(stored);
        int result = compress2(body, &stored, payload->data, (uLong)payload->size, ZLIB_LEVEL);
        if (result != Z_OK)
            return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory to compress a part of the recording");
        compress = stored < payload->size;
    }
    if (!compress) {
        stored = (uLongf)payload->size;
        if (stored)
            memcpy(body, payload->data, stored);
    }
    frame->size = 0;
    rheo_put_u32(frame, type);
    rheo_put_u32(frame, compress ? RHEO_CHUNK_ZLIB : 0);
    rheo_put_u64(frame, step);
    rheo_put_u64(frame, stored);
    rheo_put_u64(frame, payload->size);
    frame->size += stored;
    rheo_put_u32(frame, (uint32_t)crc32(0, frame->data, (uInt)frame->size));
    return rheo_writer_write(writer, frame->data, frame->size, error);
}

rheo_result rheo_chunk_at(rheo_reader *reader, uint64_t at, rheo_chunk *chunk, bool *torn, rheo_error *error)
{
    unsigned long long place = at;
    *torn = reader->size - at < RHEO_CHUNK_HEADER;
    if (*torn)
        return rheo_fail(error, RHEO_ERROR_FORMAT, "torn: the file ends at byte %llu without an end mark",
                         (unsigned long long)reader->size);
    uint8_t header[RHEO_CHUNK_HEADER];
    RHEO_TRY(rheo_reader_read(reader, at, header, sizeof header, error));
    rheo_cursor cursor = {header, sizeof header, 0, false};
    chunk->at = at;
    chunk->type = rheo_get_u32(&cursor);
    chunk->flags = rheo_get_u32(&cursor);
    chunk->step = rheo_get_u64(&cursor);
    chunk->stored = rheo_get_u64(&cursor);
    chunk->raw = rheo_get_u64(&cursor);
    bool zlib = chunk->flags & RHEO_CHUNK_ZLIB;
    if (chunk->flags & ~(uint32_t)(RHEO_CHUNK_OPTIONAL | RHEO_CHUNK_ZLIB) ||
        (rheo_chunk_known(chunk->type) && chunk->flags & RHEO_CHUNK_OPTIONAL) || chunk->raw > RHEO_CHUNK_LARGEST ||
        (zlib ? chunk->stored >= chunk->raw || chunk->raw / ZLIB_EXPANSION > chunk->stored
              : chunk->stored != chunk->raw))
        return rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: no chunk can begin as the bytes at %llu do", place);
    *torn = chunk->stored + CRC_SIZE > reader->size - at - RHEO_CHUNK_HEADER;
    if (*torn)
        return rheo_fail(error, RHEO_ERROR_FORMAT, "torn: the file ends inside of the chunk at byte %llu", place);
    chunk->end = at + RHEO_CHUNK_HEADER + chunk->stored + CRC_SIZE;
    return RHEO_OK;
}

rheo_result rheo_chunk_read(rheo_reader *reader, const rheo_chunk *chunk, rheo_bytes *payload, rheo_error *error)
{
    unsigned long long place = chunk->at;
    rheo_bytes *frame = &reader->frame;
    frame->failed = payload->failed = false;
    size_t size = (size_t)(chunk->end - chunk->at), raw = (size_t)chunk->raw;
    if (!rheo_bytes_resize(frame, size) || !rheo_bytes_resize(payload, raw))
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory for a part of the recording of %zu bytes", raw);
    RHEO_TRY(rheo_reader_read(reader, chunk->at, frame->data, size, error));
    rheo_cursor crc = {frame->data, size, size - CRC_SIZE, false};
    if (rheo_get_u32(&crc) != (uint32_t)crc32(0, frame->data, (uInt)(size - CRC_SIZE)))
        return rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: the chunk at byte %llu does not have its check sum",
                         place);
    const uint8_t *body = frame->data + RHEO_CHUNK_HEADER;
    if (!(chunk->flags & RHEO_CHUNK_ZLIB)) {
        if (raw)
            memcpy(payload->data, body, raw);
        return RHEO_OK;
    }
    uLongf got = (uLongf)raw;
    uLong used = (uLong)chunk->stored;
    int result = uncompress2(payload->data, &got, body, &used);
    if (result == Z_MEM_ERROR)
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory to read a part of the recording");
    if (result != Z_OK || got != raw || used != chunk->stored)
        return rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: the chunk at byte %llu cannot be inflated", place);
    return RHEO_OK;
}
