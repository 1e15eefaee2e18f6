/*
 * The MADE chunk: how a recording was made. It is optional, so that earlier readers of the format skip it, and no hash
 * contains it. Only people read it. Texts that no recorder writes are not shown; the recording is valid without them.
 */
#include "record/made.h"

#include <stdlib.h>
#include <string.h>

#include "core/error.h"
#include "core/text.h"
#include "rheolog/record.h"

_Static_assert(2 * (RHEO_MAX_MADE_TEXT + 4) <= RHEO__CHUNK_LARGEST, "two texts fit into a chunk");

static void put_long_text(rheo__bytes *bytes, const char *text)
{
    rheo__put_u32(bytes, (uint32_t)strlen(text));
    rheo__put_raw(bytes, text, strlen(text));
}

/* A command is one line, a scene has several. */
static const char *const ALSO[2] = {"", "\n\t"};

rheo_result rheo__made_write(rheo__writer *writer, const char *made_by, const char *scene_text, rheo_error *error)
{
    const char *const name[2] = {"made_by", "scene_text"};
    const char *const text[2] = {made_by ? made_by : "", scene_text ? scene_text : ""};
    if (!*text[0] && !*text[1])
        return RHEO_OK;
    for (int i = 0; i < 2; i++) {
        if (strlen(text[i]) > RHEO_MAX_MADE_TEXT)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s has %zu bytes; at most %d are possible", name[i],
                              strlen(text[i]), RHEO_MAX_MADE_TEXT);
        if (!rheo__text_is_printable(text[i], ALSO[i]))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s has control characters or is not UTF-8; it must be %s",
                              name[i], i ? "lines of printable text" : "one line of printable text");
    }
    rheo__bytes bytes = {0};
    put_long_text(&bytes, text[0]);
    put_long_text(&bytes, text[1]);
    rheo_result result = rheo__chunk_write(writer, RHEO__MADE, 0, &bytes, true, error);
    rheo__bytes_release(&bytes);
    return result;
}

/* Sets cursor->failed if there is no such text; NULL: no memory. */
static char *get_long_text(rheo__cursor *cursor)
{
    uint32_t length = rheo__get_u32(cursor);
    const uint8_t *from = cursor->data + cursor->offset;
    if (length > rheo__cursor_left(cursor) || (length && memchr(from, 0, length))) {
        cursor->failed = true;
        length = 0;
    }
    char *text = malloc((size_t)length + 1);
    if (!text)
        return NULL;
    if (length)
        memcpy(text, from, length);
    text[length] = 0;
    cursor->offset += length;
    return text;
}

rheo_result rheo__made_get(rheo__cursor *cursor, rheo__made *made, rheo_error *error)
{
    rheo__made read = {.by = get_long_text(cursor)};
    read.scene = get_long_text(cursor);
    rheo_result result = RHEO_OK;
    if (!read.by || !read.scene)
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open the recording");
    else if (cursor->failed || rheo__cursor_left(cursor))
        result = rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: how the recording was made cannot be read");
    if (result != RHEO_OK) {
        rheo__made_release(&read);
        return result;
    }
    char *const text[2] = {read.by, read.scene};
    for (int i = 0; i < 2; i++)
        if (strlen(text[i]) > RHEO_MAX_MADE_TEXT || !rheo__text_is_printable(text[i], ALSO[i]))
            read.refused = true;
    if (read.refused)
        *read.by = *read.scene = 0;
    *made = read;
    return RHEO_OK;
}

void rheo__made_release(rheo__made *made)
{
    free(made->by);
    free(made->scene);
    *made = (rheo__made){0};
}
