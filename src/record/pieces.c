/* Arrays in pieces (record/pieces.h): memory stays bounded by a piece, however large the state is. */
#include "record/pieces.h"

#include "core/error.h"

enum { PIECE_HEADER = 24 };

rheo_result rheo__pieces_flush(rheo__pieces_writer *p, rheo_error *error)
{
    if (p->bytes.size == 0 && !p->bytes.failed)
        return RHEO_OK;
    RHEO__TRY(rheo__chunk_write(p->writer, p->type, p->step, &p->bytes, p->compress, error));
    p->bytes.size = 0;
    p->chunks++;
    return RHEO_OK;
}

rheo_result rheo__pieces_put(rheo__pieces_writer *p, uint32_t field, uint32_t part, uint64_t first,
                             const void *values, size_t count, size_t element_size, rheo_error *error)
{
    while (count) {
        /* Begin a new chunk rather than append a few values. */
        if (p->bytes.size + PIECE_HEADER + 64 * element_size > RHEO__PIECE)
            RHEO__TRY(rheo__pieces_flush(p, error));
        size_t room = (RHEO__PIECE - p->bytes.size - PIECE_HEADER) / element_size;
        size_t n = count < room ? count : room;
        rheo__put_u32(&p->bytes, field);
        rheo__put_u32(&p->bytes, part);
        rheo__put_u64(&p->bytes, first);
        rheo__put_u64(&p->bytes, n);
        if (p->type == RHEO__STAT)
            rheo__put_packed(&p->bytes, values, n, element_size);
        else
            rheo__put_planes(&p->bytes, values, n, element_size);
        if (p->bytes.failed)
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write a part of the recording");
        values = (const char *)values + n * element_size;
        first += n;
        count -= n;
    }
    return RHEO_OK;
}

/* The next chunk of the type; RHEO_ERROR_FORMAT if there is none. */
static rheo_result next_chunk(rheo__pieces_reader *p, rheo_error *error)
{
    while (p->offset < p->end) {
        rheo__chunk chunk;
        bool truncated;
        RHEO__TRY(rheo__chunk_at(p->reader, p->offset, &chunk, &truncated, error));
        p->offset = chunk.end;
        if (chunk.type != p->type)
            continue;
        if (chunk.step != p->step)
            return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the chunk at byte %llu has the step %llu, not %llu",
                              (unsigned long long)chunk.offset, (unsigned long long)chunk.step,
                              (unsigned long long)p->step);
        RHEO__TRY(rheo__chunk_read(p->reader, &chunk, &p->bytes, error));
        p->cursor = rheo__cursor_over(&p->bytes);
        return RHEO_OK;
    }
    return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the stored state of step %llu ends early",
                      (unsigned long long)p->step);
}

rheo_result rheo__pieces_get(rheo__pieces_reader *p, uint32_t field, uint32_t part, uint64_t first, void *values,
                             size_t count, size_t element_size, rheo_error *error)
{
    for (size_t have = 0; have < count;) {
        if (rheo__cursor_left(&p->cursor) == 0)
            RHEO__TRY(next_chunk(p, error));
        rheo__cursor *cursor = &p->cursor;
        bool expected = rheo__get_u32(cursor) == field;
        expected = rheo__get_u32(cursor) == part && expected;
        expected = rheo__get_u64(cursor) == first + have && expected;
        uint64_t n = rheo__get_u64(cursor);
        void *to = (char *)values + have * element_size;
        if (!expected || n == 0 || n > count - have)
            cursor->failed = true;
        else if (p->type == RHEO__STAT)
            rheo__get_packed(cursor, to, (size_t)n, element_size);
        else
            rheo__get_planes(cursor, to, (size_t)n, element_size);
        if (cursor->failed)
            return rheo__fail(error, RHEO_ERROR_FORMAT,
                              "damaged: a piece of the state of step %llu is not the next one",
                              (unsigned long long)p->step);
        have += (size_t)n;
    }
    return RHEO_OK;
}

rheo_result rheo__pieces_end(rheo__pieces_reader *p, rheo_error *error)
{
    rheo_error ignored;
    if (rheo__cursor_left(&p->cursor) || next_chunk(p, &ignored) == RHEO_OK)
        return rheo__fail(error, RHEO_ERROR_FORMAT,
                          "damaged: the stored state of step %llu does not end where it should",
                          (unsigned long long)p->step);
    return RHEO_OK;
}
