/*
 * The end of a recording: FAIL, the step that failed, BLES, why a golden recording was accepted, and SAME, how far that
 * change goes. All are between the last step and the index. A file that lost its end still says at its beginning that it is blessed: GOLD.
 */
#include <stdlib.h>
#include <string.h>

#include "record/recording.h"

/* ---- FAIL ---- */

rheo_result rheo__failure_write(rheo__writer *writer, const rheo_failure *f, uint32_t inputs, const double *metrics,
                                uint32_t metric_count, rheo_error *error)
{
    rheo__bytes bytes = {0};
    rheo__put_u32(&bytes, inputs);
    rheo__put_text(&bytes, f->stage);
    rheo__put_text(&bytes, f->field);
    rheo__put_u32(&bytes, (uint32_t)f->location);
    rheo__put_u64(&bytes, f->id);
    rheo__put_u32(&bytes, f->component);
    rheo__put_u32(&bytes, (uint32_t)f->reason);
    rheo__put_f64(&bytes, f->required);
    rheo__put_f64(&bytes, f->limit);
    for (uint32_t i = 0; i < metric_count; i++)
        rheo__put_f64(&bytes, metrics[i]);
    rheo_result result = rheo__chunk_write(writer, RHEO__FAIL, f->step, &bytes, false, error);
    rheo__bytes_release(&bytes);
    return result;
}

bool rheo__failure_get(rheo__cursor *cursor, rheo_failure *f, uint32_t *inputs, double *metrics,
                       uint32_t metric_count)
{
    *inputs = rheo__get_u32(cursor);
    rheo__get_text(cursor, f->stage, sizeof f->stage);
    rheo__get_text(cursor, f->field, sizeof f->field);
    const uint32_t location = rheo__get_u32(cursor);
    f->location = (rheo_location)location;
    f->id = rheo__get_u64(cursor);
    f->component = rheo__get_u32(cursor);
    f->reason = (rheo_failure_reason)rheo__get_u32(cursor);
    f->required = rheo__get_f64(cursor);
    f->limit = rheo__get_f64(cursor);
    for (uint32_t i = 0; i < metric_count; i++)
        metrics[i] = rheo__get_f64(cursor);
    return !cursor->failed && rheo__cursor_left(cursor) == 0 && location <= RHEO_LOCATION_OBSTACLE &&
           f->reason != RHEO_FAILURE_NONE;
}

bool rheo_recording_failure(const rheo_recording *r, rheo_failure *failure)
{
    if (r->has_failure)
        *failure = r->failure;
    return r->has_failure;
}

/* ---- BLES, SAME ---- */

rheo_result rheo__blessing_write(rheo__writer *writer, uint64_t step, const rheo_blessing *blessing,
                                 rheo_error *error)
{
    rheo__bytes bytes = {0};
    rheo__put_text(&bytes, blessing->because);
    rheo__put_text(&bytes, blessing->build);
    rheo_result result = rheo__chunk_write(writer, RHEO__BLES, step, &bytes, false, error);
    rheo__bytes_release(&bytes);
    if (result != RHEO_OK || blessing->verdict == RHEO_SAMENESS_UNKNOWN)
        return result;
    bytes = (rheo__bytes){0};
    rheo__put_u32(&bytes, (uint32_t)blessing->verdict);
    rheo__put_u32(&bytes, (uint32_t)blessing->at_least);
    rheo__put_text(&bytes, blessing->same);
    result = rheo__chunk_write(writer, RHEO__SAME, step, &bytes, false, error);
    rheo__bytes_release(&bytes);
    return result;
}

rheo_result rheo__blessing_get(rheo__cursor *cursor, rheo_recording *r, rheo_error *error)
{
    size_t room = (rheo__cursor_left(cursor) < UINT16_MAX ? rheo__cursor_left(cursor) : UINT16_MAX) + 1;
    char *because = malloc(room), *build = malloc(room);
    rheo_blessing *more = realloc(r->blessings, (r->blessing_count + (size_t)1) * sizeof *more);
    r->blessings = more ? more : r->blessings;
    bool enough = because && build && more;
    if (enough) {
        rheo__get_text(cursor, because, room);
        rheo__get_text(cursor, build, room);
    }
    if (enough && !cursor->failed && rheo__cursor_left(cursor) == 0) {
        r->blessings[r->blessing_count++] = (rheo_blessing){.because = because, .build = build, .same = ""};
        return RHEO_OK;
    }
    free(because);
    free(build);
    return enough ? rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a blessing of the recording cannot be read")
                  : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the blessings of the recording");
}

rheo_result rheo__same_get(rheo__cursor *cursor, rheo_recording *r, rheo_error *error)
{
    rheo_blessing *blessing = r->blessing_count ? &r->blessings[r->blessing_count - 1] : NULL;
    const size_t room = (rheo__cursor_left(cursor) < UINT16_MAX ? rheo__cursor_left(cursor) : UINT16_MAX) + 1;
    char *same = malloc(room);
    if (!same)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the blessings of the recording");
    const uint32_t verdict = rheo__get_u32(cursor), at_least = rheo__get_u32(cursor);
    rheo__get_text(cursor, same, room);
    const bool fits = !cursor->failed && blessing && blessing->verdict == RHEO_SAMENESS_UNKNOWN;
    /* A verdict of a later version is not known here. */
    if (fits && verdict > 0 && verdict <= RHEO_SAMENESS_BITS && at_least > 0 && at_least <= RHEO_SAMENESS_BITS) {
        blessing->verdict = (rheo_sameness)verdict;
        blessing->at_least = (rheo_sameness)at_least;
        blessing->same = same;
        return RHEO_OK;
    }
    free(same);
    return fits ? RHEO_OK
                : rheo__fail(error, RHEO_ERROR_FORMAT,
                             "damaged: the verdict of a blessing cannot be read, or it has two");
}

void rheo__blessings_release(rheo_recording *r)
{
    for (uint32_t i = 0; i < r->blessing_count; i++) {
        free((char *)(uintptr_t)r->blessings[i].because);
        free((char *)(uintptr_t)r->blessings[i].build);
        if (r->blessings[i].verdict != RHEO_SAMENESS_UNKNOWN)
            free((char *)(uintptr_t)r->blessings[i].same);
    }
    free(r->blessings);
    r->blessings = NULL;
    r->blessing_count = 0;
}

rheo_result rheo__golden_write(rheo__writer *writer, rheo_error *error)
{
    return rheo__chunk_write(writer, RHEO__GOLD, 0, &(rheo__bytes){0}, false, error);
}

bool rheo__reader_is_blessed(rheo__reader *reader)
{
    for (uint64_t offset = RHEO__MAGIC_SIZE; offset + 4 <= reader->size;) {
        uint8_t letters[4];
        rheo__chunk chunk;
        bool truncated;
        if (rheo__reader_read(reader, offset, letters, sizeof letters, NULL) != RHEO_OK)
            return false;
        const uint32_t type = RHEO__CHUNK(letters[0], letters[1], letters[2], letters[3]);
        if (type == RHEO__GOLD || type == RHEO__BLES)
            return true;
        if (rheo__chunk_at(reader, offset, &chunk, &truncated, NULL) != RHEO_OK)
            return false;
        offset = chunk.end;
    }
    return false;
}

uint32_t rheo_recording_blessing_count(const rheo_recording *r)
{
    return r->blessing_count;
}

rheo_result rheo_recording_blessing(const rheo_recording *r, uint32_t index, rheo_blessing *blessing)
{
    if (index >= r->blessing_count)
        return RHEO_ERROR_ARGUMENT;
    *blessing = r->blessings[index];
    return RHEO_OK;
}
