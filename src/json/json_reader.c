/* Reads values of a JSON file (json_reader.h). */
#include "json/json_reader.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- Lines: the text is valid JSON, and `p` never passes its end ---- */

static const char *skip_space(const char *p, const char *end)
{
    while (p < end && (*p == ' ' || *p == '\t' || *p == '\n' || *p == '\r'))
        p++;
    return p;
}

static const char *skip_string(const char *p, const char *end)
{
    for (p++; p < end && *p != '"'; p++)
        if (*p == '\\')
            p++;
    return p < end ? p + 1 : end;
}

/* Skips a value of any depth. It counts brackets, so deep nesting needs no stack. */
static const char *skip_value(const char *p, const char *end)
{
    size_t depth = 0;
    while (p < end) {
        if (*p == '"') {
            p = skip_string(p, end);
            continue;
        }
        if (*p == '[' || *p == '{') {
            depth++;
        } else if (*p == ']' || *p == '}') {
            if (depth == 0)
                return p; /* bracket of the enclosing value */
            depth--;
        } else if (*p == ',' && depth == 0) {
            return p;
        }
        p++;
    }
    return end;
}

static const char *locate(const rheo__json_reader *r, const rheo__json_place *at);

/* Start of a value. The key of a member precedes it. */
static const char *locate_value(const rheo__json_reader *r, const rheo__json_place *at)
{
    const char *p = locate(r, at);
    if (at->up && at->key) {
        p = skip_space(skip_string(p, r->end), r->end);
        p = skip_space(p < r->end ? p + 1 : p, r->end); /* skips the colon */
    }
    return p;
}

/* Start of a list element, or of a member with its key. */
static const char *locate(const rheo__json_reader *r, const rheo__json_place *at)
{
    if (!at->up)
        return skip_space(r->text, r->end);
    const char *p = locate_value(r, at->up);
    p = skip_space(p < r->end ? p + 1 : p, r->end); /* skips the bracket */
    for (size_t i = 0; i < at->index && p < r->end; i++) {
        p = skip_value(p, r->end);
        p = skip_space(p < r->end ? p + 1 : p, r->end); /* skips the comma */
    }
    return p;
}

bool rheo__json_is_blank(const rheo__json_reader *r)
{
    return skip_space(r->text, r->end) == r->end;
}

size_t rheo__json_line(const rheo__json_reader *r, const char *character)
{
    size_t line = 1;
    for (const char *p = r->text; p < character; p++)
        line += *p == '\n';
    return line;
}

static void path_of(const rheo__json_place *at, char *path, size_t size)
{
    path[0] = 0;
    if (!at->up)
        return;
    path_of(at->up, path, size);
    size_t length = strlen(path);
    if (at->key) {
        if (length)
            snprintf(path + length, size - length, ".");
        length = strlen(path);
        snprintf(path + length, size - length, "%.40s", at->key);
    } else {
        snprintf(path + length, size - length, "[%zu]", at->index);
    }
}

rheo_result rheo__json_refuse(const rheo__json_reader *r, const rheo__json_place *at, const char *format, ...)
{
    char path[160], message[320];
    path_of(at, path, sizeof path);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    /* A message of the library about a parameter already begins with its path. */
    const bool named = path[0] == 0 || strncmp(message, path, strlen(path)) == 0;
    return rheo__json_fail(r->error, RHEO_ERROR_ARGUMENT, "%s:%zu: %s%s%s", r->file,
                           rheo__json_line(r, locate(r, at)), named ? "" : path, named ? "" : ": ", message);
}

const char *rheo__json_kind(const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object {...}";
    case JSON_ARRAY:
        return "a list [...]";
    case JSON_STRING:
        return "a string";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_TRUE:
    case JSON_FALSE:
        return "true or false";
    case JSON_NULL:
        return "null";
    }
    return "something else";
}

/* ---- Values ---- */

rheo_result rheo__json_read_number(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                   void *target, size_t size)
{
    double *number = target;
    (void)size;
    if (!json_is_number(value))
        return rheo__json_refuse(r, at, "must be a number, e.g. 0.5; got %s", rheo__json_kind(value));
    *number = json_number_value(value);
    return RHEO_OK;
}

rheo_result rheo__json_read_numbers(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                    void *target, size_t count)
{
    double *numbers = target;
    if (!json_is_array(value) || json_array_size(value) != count) {
        char got[48];
        if (json_is_array(value))
            snprintf(got, sizeof got, "a list of %zu", json_array_size(value));
        else
            snprintf(got, sizeof got, "%s", rheo__json_kind(value));
        return rheo__json_refuse(r, at, "must be a list of %zu numbers, e.g. %s; got %s", count,
                                 count == 2 ? "[0, 2.5]" : "[0, 2.5, 0]", got);
    }
    for (size_t i = 0; i < count; i++) {
        const rheo__json_place element = {at, NULL, i};
        const rheo_result result = rheo__json_read_number(r, &element, json_array_get(value, i), &numbers[i], 1);
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}

rheo_result rheo__json_read_pair(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                 void *target, size_t size)
{
    double *pair = target;
    if (json_is_number(value)) {
        pair[0] = pair[1] = json_number_value(value);
        return RHEO_OK;
    }
    if (!json_is_array(value))
        return rheo__json_refuse(r, at, "must be a number or a list of 2 numbers; got %s", rheo__json_kind(value));
    return rheo__json_read_numbers(r, at, value, target, size);
}

rheo_result rheo__json_read_text(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                 void *target, size_t size)
{
    const char *text = json_string_value(value);
    if (!text)
        return rheo__json_refuse(r, at, "must be a string; got %s", rheo__json_kind(value));
    if (strlen(text) >= size)
        return rheo__json_refuse(r, at, "must have at most %zu bytes; got %zu", size - 1, strlen(text));
    for (const char *c = text; *c; c += rheo_printable_length(c))
        if (rheo_printable_length(c) == 0)
            return rheo__json_refuse(r, at, "must be one line of text without control characters");
    memcpy(target, text, strlen(text) + 1);
    return RHEO_OK;
}

rheo_result rheo__json_read_flag(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                 void *target, size_t size)
{
    (void)size;
    *(bool *)target = json_is_true(value);
    return json_is_boolean(value) ? RHEO_OK
                                  : rheo__json_refuse(r, at, "must be true or false; got %s", rheo__json_kind(value));
}

rheo_result rheo__json_read_negated_flag(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                         void *target, size_t size)
{
    const rheo_result result = rheo__json_read_flag(r, at, value, target, size);
    *(bool *)target = !*(bool *)target;
    return result;
}

/* ---- Objects and lists ---- */

rheo_result rheo__json_unknown_key(const rheo__json_reader *r, const rheo__json_place *at, const char *key,
                                   const char *const *known, size_t count, const char *otherwise)
{
    const char *nearest = rheo_nearest_word(key, known, count);
    if (rheo_is_near_word(key, nearest))
        return rheo__json_refuse(r, at, "unknown key; did you mean \"%s\"?", nearest);
    return rheo__json_refuse(r, at, "unknown key; %s", otherwise);
}

static rheo_result unknown_member(const rheo__json_reader *r, const rheo__json_place *at,
                                  const rheo__json_member *members, size_t count)
{
    const char *names[RHEO__JSON_MAX_MEMBERS];
    char all[256] = "possible are";
    for (size_t m = 0; m < count; m++) {
        const size_t length = strlen(all);
        names[m] = members[m].name;
        snprintf(all + length, sizeof all - length, "%s \"%s\"", m ? "," : "", names[m]);
    }
    return rheo__json_unknown_key(r, at, at->key, names, count, all);
}

bool rheo__json_is_ignored(const char *key)
{
    return strcmp(key, "$schema") == 0 || strcmp(key, "comment") == 0;
}

rheo_result rheo__json_read_members(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                    rheo__json_member *members, size_t count)
{
    if (!json_is_object(value))
        return rheo__json_refuse(r, at, "must be an object {...}; got %s", rheo__json_kind(value));
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    json_object_foreach((json_t *)value, key, item) /* jansson cannot iterate over a const object */
    {
        const rheo__json_place here = {at, key, index++};
        size_t m = 0;
        if (rheo__json_is_ignored(key))
            continue;
        while (m < count && strcmp(key, members[m].name) != 0)
            m++;
        if (m == count)
            return unknown_member(r, &here, members, count);
        const rheo_result result = members[m].read(r, &here, item, members[m].target, members[m].size);
        if (result != RHEO_OK)
            return result;
        members[m].given = true;
    }
    for (size_t m = 0; m < count; m++)
        if (members[m].required && !members[m].given)
            return rheo__json_refuse(r, at, "\"%s\" is missing", members[m].name);
    return RHEO_OK;
}

rheo_result rheo__json_read_list(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                 rheo_result (*read)(const rheo__json_reader *r, const rheo__json_place *at,
                                                     const json_t *value))
{
    if (!json_is_array(value))
        return rheo__json_refuse(r, at, "must be a list [...]; got %s", rheo__json_kind(value));
    for (size_t i = 0; i < json_array_size(value); i++) {
        const rheo__json_place here = {at, NULL, i};
        const rheo_result result = read(r, &here, json_array_get(value, i));
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}
