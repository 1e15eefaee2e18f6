/* Writes JSON (json_writer.h). */
#include "json/json_writer.h"

#include <math.h>
#include <stdlib.h>

#include "rheolog/base.h"

void rheo__number_text(double value, char *text, size_t size)
{
    char number[32];
    rheo_number_text(value, number);
    snprintf(text, size, "%s", number);
}

static void put_text(FILE *file, const char *text)
{
    fputc('"', file);
    for (const unsigned char *c = (const unsigned char *)text; *c;) {
        size_t length = rheo_printable_length((const char *)c);
        if (*c == '"' || *c == '\\') {
            fprintf(file, "\\%c", *c);
        } else if (length) {
            fwrite(c, 1, length, file);
        } else if (*c < 0x20 || *c == 0x7f) {
            fprintf(file, "\\u%04x", (unsigned)*c);
        } else if (c[0] == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0) { /* a terminal obeys U+0080 to U+009F, too */
            fprintf(file, "\\u%04x", (unsigned)c[1]);
            length = 2;
        } else {
            fputs("\\ufffd", file);
        }
        c += length ? length : 1;
    }
    fputc('"', file);
}

static void put_number(FILE *file, double value)
{
    char text[32];
    rheo__number_text(value, text, sizeof text);
    /* A bare -0 would be an integer, and integers have no negative zero. */
    fputs(!isfinite(value) ? "null" : value == 0 && signbit(value) ? "-0.0" : text, file);
}

/* ---- Structure ---- */

static void new_line(const rheo__json *json)
{
    fprintf(json->file, "\n%*s", 4 * (int)json->depth, "");
}

/* Writes the comma, line break and key in front of a value. */
static FILE *begin_value(rheo__json *json, const char *key)
{
    const bool own_line = json->depth > 0 && json->depth <= json->lines;
    if (json->follows)
        fputs(own_line ? "," : ", ", json->file);
    if (own_line)
        new_line(json);
    json->follows = true;
    if (key) {
        put_text(json->file, key);
        fputs(": ", json->file);
    }
    return json->file;
}

static void begin(rheo__json *json, const char *key, char bracket)
{
    fputc(bracket, begin_value(json, key));
    json->depth++;
    json->follows = false;
}

static void end(rheo__json *json, char bracket)
{
    const bool own_line = json->depth <= json->lines && json->follows;
    json->depth--;
    if (own_line)
        new_line(json);
    fputc(bracket, json->file);
    json->follows = json->depth > 0;
    if (json->depth == 0)
        fputc('\n', json->file);
}

void rheo__json_begin_object(rheo__json *json, const char *key)
{
    begin(json, key, '{');
}

void rheo__json_end_object(rheo__json *json)
{
    end(json, '}');
}

void rheo__json_begin_list(rheo__json *json, const char *key)
{
    begin(json, key, '[');
}

void rheo__json_end_list(rheo__json *json)
{
    end(json, ']');
}

/* ---- Values ---- */

void rheo__json_number(rheo__json *json, const char *key, double value)
{
    put_number(begin_value(json, key), value);
}

void rheo__json_decimals(rheo__json *json, const char *key, int decimals, double value)
{
    FILE *file = begin_value(json, key);
    if (isfinite(value))
        fprintf(file, decimals < 0 ? "%.*e" : "%.*f", abs(decimals), value);
    else
        fputs("null", file);
}

void rheo__json_integer(rheo__json *json, const char *key, uint64_t value)
{
    fprintf(begin_value(json, key), "%llu", (unsigned long long)value);
}

void rheo__json_known_integer(rheo__json *json, const char *key, bool known, uint64_t value)
{
    if (known)
        rheo__json_integer(json, key, value);
    else
        rheo__json_null(json, key);
}

void rheo__json_index(rheo__json *json, const char *key, int64_t index)
{
    rheo__json_known_integer(json, key, index >= 0, (uint64_t)index);
}

void rheo__json_text(rheo__json *json, const char *key, const char *text)
{
    FILE *file = begin_value(json, key);
    if (text)
        put_text(file, text);
    else
        fputs("null", file);
}

void rheo__json_bool(rheo__json *json, const char *key, bool value)
{
    fputs(value ? "true" : "false", begin_value(json, key));
}

void rheo__json_null(rheo__json *json, const char *key)
{
    fputs("null", begin_value(json, key));
}

void rheo__json_vector(rheo__json *json, const char *key, const double *values, size_t count)
{
    FILE *file = begin_value(json, key);
    fputc('[', file);
    for (size_t i = 0; i < count; i++) {
        fputs(i ? ", " : "", file);
        put_number(file, values[i]);
    }
    fputc(']', file);
}

void rheo__json_hash(rheo__json *json, const char *key, uint64_t hash)
{
    fprintf(begin_value(json, key), "\"%016llx\"", (unsigned long long)hash);
}
