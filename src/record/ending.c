/*
 * How a recording ends: FAIL, where a run went bad, and BLES, why a golden recording was made anew. Both stand
 * between the last step and the index.
 */
#include <stdlib.h>
#include <string.h>

#include "record/recording.h"

/* ---- FAIL ---- */

rheo_result rheo_failure_write(rheo_writer *writer, const rheo_failure *f, uint32_t inputs, const char *message,
                               const double *metrics, uint32_t metric_count, rheo_error *error)
{
    rheo_bytes bytes = {0};
    rheo_put_u32(&bytes, inputs);
    rheo_put_text(&bytes, f->stage);
    rheo_put_text(&bytes, f->field);
    rheo_put_u32(&bytes, (uint32_t)f->per);
    rheo_put_u64(&bytes, f->id);
    rheo_put_u32(&bytes, f->component);
    rheo_put_text(&bytes, message);
    for (uint32_t i = 0; i < metric_count; i++)
        rheo_put_f64(&bytes, metrics[i]);
    rheo_result result = rheo_chunk_write(writer, RHEO_FAIL, f->step, &bytes, false, error);
    rheo_bytes_release(&bytes);
    return result;
}

bool rheo_failure_get(rheo_cursor *cursor, rheo_failure *f, uint32_t *inputs, rheo_error *message, double *metrics,
                      uint32_t metric_count)
{
    *inputs = rheo_get_u32(cursor);
    rheo_get_text(cursor, f->stage, sizeof f->stage);
    rheo_get_text(cursor, f->field, sizeof f->field);
    uint32_t per = rheo_get_u32(cursor);
    f->per = (rheo_per)per;
    f->id = rheo_get_u64(cursor);
    f->component = rheo_get_u32(cursor);
    rheo_get_text(cursor, message->message, sizeof message->message);
    for (uint32_t i = 0; i < metric_count; i++)
        metrics[i] = rheo_get_f64(cursor);
    return !cursor->failed && rheo_cursor_left(cursor) == 0 && per <= RHEO_PER_SOURCE;
}

bool rheo_recording_failure(const rheo_recording *r, rheo_failure *failure, const char **message)
{
    if (!r->has_failure)
        return false;
    *failure = r->failure;
    if (message)
        *message = r->failure_message.message;
    return true;
}

/* ---- BLES ---- */

rheo_result rheo_blessing_write(rheo_writer *writer, uint64_t step, const rheo_blessing *blessing, rheo_error *error)
{
    rheo_bytes bytes = {0};
    rheo_put_text(&bytes, blessing->because);
    rheo_put_text(&bytes, blessing->build);
    rheo_result result = rheo_chunk_write(writer, RHEO_BLES, step, &bytes, false, error);
    rheo_bytes_release(&bytes);
    return result;
}

rheo_result rheo_blessing_get(rheo_cursor *cursor, rheo_recording *r, rheo_error *error)
{
    size_t room = (rheo_cursor_left(cursor) < UINT16_MAX ? rheo_cursor_left(cursor) : UINT16_MAX) + 1;
    char *because = malloc(room), *build = malloc(room);
    rheo_blessing *more = realloc(r->blessings, (r->blessing_count + (size_t)1) * sizeof *more);
    r->blessings = more ? more : r->blessings;
    bool enough = because && build && more;
    if (enough) {
        rheo_get_text(cursor, because, room);
        rheo_get_text(cursor, build, room);
    }
    if (enough && !cursor->failed && rheo_cursor_left(cursor) == 0) {
        r->blessings[r->blessing_count++] = (rheo_blessing){because, build};
        return RHEO_OK;
    }
    free(because);
    free(build);
    return enough ? rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: a blessing of the recording cannot be read")
                  : rheo_fail(error, RHEO_ERROR_MEMORY, "no memory for the blessings of the recording");
}

void rheo_blessings_release(rheo_recording *r)
{
    for (uint32_t i = 0; i < r->blessing_count; i++) {
        free((char *)(uintptr_t)r->blessings[i].because);
        free((char *)(uintptr_t)r->blessings[i].build);
    }
    free(r->blessings);
    r->blessings = NULL;
    r->blessing_count = 0;
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
