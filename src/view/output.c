/*
 * Buffered output to a temporary file, or to memory. rheo__output_close() reports the first failure, so that writers need not check
 * every call.
 */
#include "view/output.h"

#include <errno.h>
#include <locale.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "record/replace.h"

rheo_result rheo__output_open(rheo__output *out, const char *path, bool force, rheo_error *error)
{
    out->path = path;
    out->used = 0;
    out->trouble = 0;
    out->z_up = false;
    if (!force && rheo__file_exists(path))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.300s exists already; replacing it needs force", path);
    RHEO__TRY(rheo__output_target(path, &out->target, error));
    out->name = malloc(strlen(out->target) + 16);
    out->file = out->name ? rheo__open_beside(out->target, out->name) : NULL;
    if (out->file)
        return RHEO_OK;
    const rheo_result result =
        out->name ? rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", path, strerror(errno))
                  : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write %.300s", path);
    free(out->name);
    free(out->target);
    return result;
}

/* Keeps room for a 0. */
static void flush_to_memory(rheo__output *out)
{
    if (out->used >= out->room - out->size) {
        const size_t room = 2 * out->room + out->used + 1;
        char *memory = out->trouble ? NULL : realloc(out->memory, room);
        out->trouble = memory ? 0 : ENOMEM;
        out->memory = memory ? memory : out->memory;
        out->room = memory ? room : out->room;
    }
    if (!out->trouble) {
        memcpy(out->memory + out->size, out->buffer, out->used);
        out->size += out->used;
    }
    out->used = 0;
}

static void flush(rheo__output *out)
{
    if (!out->file) {
        flush_to_memory(out);
        return;
    }
    errno = 0;
    if (out->used && !out->trouble && fwrite(out->buffer, 1, out->used, out->file) != out->used)
        out->trouble = errno ? errno : EIO;
    out->used = 0;
}

rheo_result rheo__output_close(rheo__output *out, rheo_result result, rheo_error *error)
{
    flush(out);
    errno = 0;
    if (fclose(out->file) != 0 && !out->trouble)
        out->trouble = errno ? errno : EIO;
    if (result == RHEO_OK && out->trouble)
        result = rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", out->path, strerror(out->trouble));
    if (result == RHEO_OK)
        result = rheo__replace_by(out->target, NULL, out->name, error);
    else
        remove(out->name);
    free(out->name);
    free(out->target);
    return result;
}

void rheo__output_open_memory(rheo__output *out)
{
    out->file = NULL;
    out->memory = NULL;
    out->size = out->room = out->used = 0;
    out->trouble = 0;
}

rheo_result rheo__output_close_memory(rheo__output *out, char **bytes, size_t *size, rheo_error *error)
{
    flush(out);
    if (out->trouble)
        free(out->memory);
    else
        out->memory[out->size] = 0;
    *bytes = out->trouble ? NULL : out->memory;
    *size = out->trouble ? 0 : out->size;
    return out->trouble ? rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write a text") : RHEO_OK;
}

void rheo__output_bytes(rheo__output *out, const void *bytes, size_t size)
{
    const unsigned char *from = bytes;
    while (size) {
        const size_t room = RHEO__OUTPUT_BUFFER - out->used, part = size < room ? size : room;
        memcpy(out->buffer + out->used, from, part);
        out->used += part;
        from += part;
        size -= part;
        if (out->used == RHEO__OUTPUT_BUFFER)
            flush(out);
    }
}

void rheo__output_text(rheo__output *out, const char *text)
{
    rheo__output_bytes(out, text, strlen(text));
}

void rheo__output_format(rheo__output *out, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    rheo__output_text(out, text);
}

/* Does the same as rheo__text_from_double(), with 7 to 9 digits. */
void rheo__output_float(rheo__output *out, float value)
{
    char text[64];
    for (int digits = 7; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value)
            break;
    }
    const char *point = localeconv()->decimal_point;
    char *separator = point && strcmp(point, ".") != 0 ? strstr(text, point) : NULL;
    if (separator) { /* it may have several bytes */
        *separator = '.';
        memmove(separator + 1, separator + strlen(point), strlen(separator + strlen(point)) + 1);
    }
    rheo__output_text(out, text);
}

void rheo__output_double(rheo__output *out, double value)
{
    char text[32];
    rheo__text_from_double(value, text);
    rheo__output_text(out, text);
}

void rheo__output_floats(rheo__output *out, const float *value, int count, const char *between)
{
    for (int i = 0; i < count; i++) {
        rheo__output_text(out, i ? between : "");
        rheo__output_float(out, value[i]);
    }
}

void rheo__output_doubles(rheo__output *out, const double *value, int count, const char *between)
{
    for (int i = 0; i < count; i++) {
        rheo__output_text(out, i ? between : "");
        rheo__output_double(out, value[i]);
    }
}

void rheo__output_little(rheo__output *out, uint64_t value, size_t bytes)
{
    unsigned char little[8];
    for (size_t i = 0; i < bytes; i++)
        little[i] = (unsigned char)(value >> 8 * i);
    rheo__output_bytes(out, little, bytes);
}

void rheo__output_little_float(rheo__output *out, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    rheo__output_little(out, bits, sizeof bits);
}
