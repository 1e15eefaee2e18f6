/* Reads words and polygons of mesh files, and reports errors in them. */
#include "scenes/mesh_reader.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "core/text.h"

rheo_result rheo__mesh_no_memory(const rheo__mesh_reader *r)
{
    return rheo__fail(r->error, RHEO_ERROR_MEMORY, "%.200s: no memory for a mesh of %zu triangles", r->name,
                      r->mesh->triangles);
}

const char *rheo__token_shown(const rheo__token *t, char text[RHEO__TOKEN])
{
    size_t length = t->length < 24 ? t->length : 24;
    for (size_t i = 0; i < length; i++)
        text[i] = t->text[i] >= 0x20 && t->text[i] < 0x7f ? t->text[i] : '?';
    text[length] = 0;
    return text;
}

rheo_result rheo__mesh_wrong(const rheo__mesh_reader *r, const char *format, ...)
{
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return rheo__fail(r->error, RHEO_ERROR_FORMAT, "%.200s:%zu: %s", r->name, r->line, message);
}

bool rheo__token_is(const rheo__token *t, const char *word)
{
    return t->length == strlen(word) && memcmp(t->text, word, t->length) == 0;
}

bool rheo__token_number(const rheo__token *t, double *value)
{
    char text[RHEO__TOKEN];
    const char *end;
    if (t->length == 0 || t->length >= sizeof text)
        return false;
    memcpy(text, t->text, t->length);
    text[t->length] = 0;
    *value = rheo__text_to_double(text, &end);
    return end == text + t->length;
}

bool rheo__fan_add(rheo__fan *fan, rheo__mesh *mesh, uint32_t vertex)
{
    bool enough = fan->corners < 2 || rheo__mesh_add_triangle(mesh, fan->first, fan->last, vertex);
    if (fan->corners == 0)
        fan->first = vertex;
    fan->last = vertex;
    fan->corners++;
    return enough;
}

/* Skips blanks, and line ends after a backslash. */
static void skip_blanks(rheo__mesh_reader *r)
{
    while (r->at < r->end) {
        size_t left = (size_t)(r->end - r->at);
        if (*r->at == ' ' || *r->at == '\t' || *r->at == '\r') {
            r->at++;
        } else if (left >= 2 && r->at[0] == '\\' && r->at[1] == '\n') {
            r->at += 2;
            r->line++;
        } else if (left >= 3 && r->at[0] == '\\' && r->at[1] == '\r' && r->at[2] == '\n') {
            r->at += 3;
            r->line++;
        } else {
            return;
        }
    }
}

rheo__token rheo__mesh_word(rheo__mesh_reader *r)
{
    skip_blanks(r);
    rheo__token t = {r->at, 0};
    if (r->at < r->end && *r->at == '#')
        return t;
    for (; r->at < r->end; r->at++) {
        char c = *r->at;
        if (c == ' ' || c == '\t' || c == '\r' || c == '\n' ||
            (c == '\\' && r->at + 1 < r->end && (r->at[1] == '\n' || r->at[1] == '\r')))
            break;
        t.length++;
    }
    return t;
}

void rheo__mesh_skip_line(rheo__mesh_reader *r)
{
    while (r->at < r->end && *r->at != '\n') {
        const char *before = r->at;
        skip_blanks(r);
        r->at += r->at == before; /* any other character */
    }
    if (r->at < r->end) {
        r->at++;
        r->line++;
    }
}
