/*
 * Chunks: a header of 32 bytes (type, flags, step, stored bytes, raw bytes), the payload, and a CRC-32 over
 * both. Lengths come from files that may be damaged or hostile, so a reader allocates at most a fixed size, and
 * at most as much as zlib can inflate the present bytes to.
 */
#include "record/chunk.h"

#include <string.h>
#include <zlib.h>

#include "core/error.h"

const uint8_t rheo__magic[RHEO__MAGIC_SIZE] = {0x89, 'R', 'L', 'O', 'G', 0x0D, 0x0A, 0x1A};

enum { CRC_SIZE = 4, ZLIB_LEVEL = 1, ZLIB_EXPANSION = 1032 };

bool rheo__chunk_known(uint32_t type)
{
    switch (type) {
    case RHEO__HEAD:
    case RHEO__GOLD:
    case RHEO__MADE:
    case RHEO__MEMB:
    case RHEO__FILD:
    case RHEO__KEYF:
    case RHEO__INPT:
    case RHEO__STAT:
    case RHEO__STEP:
    case RHEO__FAIL:
    case RHEO__BLES:
    case RHEO__SAME:
    case RHEO__INDX:
    case RHEO__DONE:
        return true;
    default:
        return false;
    }
}

/* The flag that every chunk of a type has, or none has. */
static uint32_t flag_of(uint32_t type)
{
    return type == RHEO__GOLD || type == RHEO__MADE || type == RHEO__MEMB || type == RHEO__SAME ? RHEO__CHUNK_OPTIONAL
                                                                                                : 0;
}

void rheo__chunk_name(uint32_t type, char name[5])
{
    for (int i = 0; i < 4; i++) {
        char c = (char)(type >> (8 * i) & 0x7F);
        name[i] = c >= 0x20 && c < 0x7F ? c : '?';
    }
    name[4] = 0;
}

rheo_result rheo__chunk_write(rheo__writer *writer, uint32_t type, uint64_t step, const rheo__bytes *payload,
                              bool compress, rheo_error *error)
{
    if (payload->failed)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write a part of the recording");
    if (payload->size > RHEO__CHUNK_LARGEST)
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED, "a part of the recording has %zu bytes; at most %d fit",
                          payload->size, RHEO__CHUNK_LARGEST);
    rheo__bytes *frame = &writer->frame;
    frame->failed = false;
    uLongf stored = (uLongf)payload->size;
    if (!rheo__bytes_resize(frame, RHEO__CHUNK_HEADER + (compress ? compressBound(stored) : stored) + CRC_SIZE))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write a part of the recording");
    uint8_t *body = frame->data + RHEO__CHUNK_HEADER;
    if (compress) {
        stored = compressBound(stored);
        int result = compress2(body, &stored, payload->data, (uLong)payload->size, ZLIB_LEVEL);
        if (result != Z_OK)
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to compress a part of the recording");
        compress = stored < payload->size;
    }
    if (!compress) {
        stored = (uLongf)payload->size;
        if (stored)
            memcpy(body, payload->data, stored);
    }
    frame->size = 0;
    rheo__put_u32(frame, type);
    rheo__put_u32(frame, flag_of(type) | (compress ? RHEO__CHUNK_ZLIB : 0));
    rheo__put_u64(frame, step);
    rheo__put_u64(frame, stored);
    rheo__put_u64(frame, payload->size);
    frame->size += stored;
    rheo__put_u32(frame, (uint32_t)crc32(0, frame->data, (uInt)frame->size));
    return rheo__writer_write(writer, frame->data, frame->size, error);
}

rheo_result rheo__chunk_at(rheo__reader *reader, uint64_t offset, rheo__chunk *chunk, bool *truncated,
                           rheo_error *error)
{
    unsigned long long byte = offset;
    *truncated = reader->size - offset < RHEO__CHUNK_HEADER;
    const char *zeros = reader->zeros ? "; only zeros follow" : "";
    if (*truncated)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "truncated: the file ends at byte %llu without an end mark%s",
                          (unsigned long long)reader->size, zeros);
    uint8_t header[RHEO__CHUNK_HEADER];
    RHEO__TRY(rheo__reader_read(reader, offset, header, sizeof header, error));
    rheo__cursor cursor = {header, sizeof header, 0, false};
    chunk->offset = offset;
    chunk->type = rheo__get_u32(&cursor);
    chunk->flags = rheo__get_u32(&cursor);
    chunk->step = rheo__get_u64(&cursor);
    chunk->stored = rheo__get_u64(&cursor);
    chunk->raw = rheo__get_u64(&cursor);
    bool zlib = chunk->flags & RHEO__CHUNK_ZLIB;
    if (chunk->flags & ~(uint32_t)(RHEO__CHUNK_OPTIONAL | RHEO__CHUNK_ZLIB) || (zlib && chunk->type == RHEO__STAT) ||
        (rheo__chunk_known(chunk->type) && (chunk->flags & RHEO__CHUNK_OPTIONAL) != flag_of(chunk->type)) ||
        chunk->raw > RHEO__CHUNK_LARGEST ||
        (zlib ? chunk->stored >= chunk->raw || chunk->raw / ZLIB_EXPANSION > chunk->stored
              : chunk->stored != chunk->raw))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: no chunk can begin as the bytes at %llu do", byte);
    *truncated = chunk->stored + CRC_SIZE > reader->size - offset - RHEO__CHUNK_HEADER;
    if (*truncated)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "truncated: the file ends inside of the chunk at byte %llu%s",
                          byte, zeros);
    chunk->end = offset + RHEO__CHUNK_HEADER + chunk->stored + CRC_SIZE;
    return RHEO_OK;
}

rheo_result rheo__chunk_read(rheo__reader *reader, const rheo__chunk *chunk, rheo__bytes *payload, rheo_error *error)
{
    unsigned long long byte = chunk->offset;
    rheo__bytes *frame = &reader->frame;
    frame->failed = payload->failed = false;
    size_t size = (size_t)(chunk->end - chunk->offset), raw = (size_t)chunk->raw;
    if (!rheo__bytes_resize(frame, size) || !rheo__bytes_resize(payload, raw))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a part of the recording of %zu bytes", raw);
    RHEO__TRY(rheo__reader_read(reader, chunk->offset, frame->data, size, error));
    rheo__cursor crc = {frame->data, size, size - CRC_SIZE, false};
    if (rheo__get_u32(&crc) != (uint32_t)crc32(0, frame->data, (uInt)(size - CRC_SIZE)))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the chunk at byte %llu does not have its check sum",
                          byte);
    const uint8_t *body = frame->data + RHEO__CHUNK_HEADER;
    if (!(chunk->flags & RHEO__CHUNK_ZLIB)) {
        if (raw)
            memcpy(payload->data, body, raw);
        return RHEO_OK;
    }
    uLongf got = (uLongf)raw;
    uLong used = (uLong)chunk->stored;
    int result = uncompress2(payload->data, &got, body, &used);
    if (result == Z_MEM_ERROR)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to read a part of the recording");
    if (result != Z_OK || got != raw || used != chunk->stored)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the chunk at byte %llu cannot be inflated", byte);
    return RHEO_OK;
}
