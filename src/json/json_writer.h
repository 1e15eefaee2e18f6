/*
 * Writes JSON to a file, member by member. Commas, indentation and line breaks are added automatically.
 *
 *     rheo__json json = {.file = stdout};
 *     rheo__json_begin_object(&json, NULL);
 *     rheo__json_text(&json, "file", "ball.rlog");
 *     rheo__json_vector(&json, "gravity", gravity, 3);
 *     rheo__json_end_object(&json);
 *
 * The key is NULL for the outermost value and in lists. Nothing is allocated, and every value is written at once.
 *
 * jansson, which reads scene files, is not used for writing. It prints doubles with %.17g (0.1 becomes
 * 0.10000000000000001), and a program built without it (-Djson=disabled) must also print JSON.
 */
#ifndef RHEOLOG_JSON_WRITER_H
#define RHEOLOG_JSON_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct rheo__json {
    FILE *file;
    /*
     * Members down to this depth have their own lines, indented by 4 blanks per level. 0: everything is on one line.
     */
    unsigned lines;
    unsigned depth;
    bool follows; /* a comma must precede the next member */
} rheo__json;

void rheo__json_begin_object(rheo__json *json, const char *key);
/* Ends an object, and the line if it was the outermost object. */
void rheo__json_end_object(rheo__json *json);
void rheo__json_begin_list(rheo__json *json, const char *key);
void rheo__json_end_list(rheo__json *json);

/* Writes the fewest digits, 15 to 17, that read back to the same double; null for NaN and infinity. */
void rheo__json_number(rheo__json *json, const char *key, double value);
/* Writes `decimals` decimals; if negative, -decimals in exponential form. Null for NaN and infinity. */
void rheo__json_decimals(rheo__json *json, const char *key, int decimals, double value);
void rheo__json_integer(rheo__json *json, const char *key, uint64_t value);
/* Does the same; null if it is not known. */
void rheo__json_known_integer(rheo__json *json, const char *key, bool known, uint64_t value);
/* Writes an id or an index; null if it is negative. */
void rheo__json_index(rheo__json *json, const char *key, int64_t index);
/* Writes a string. Bytes that are not UTF-8 become U+FFFD; NULL becomes null. */
void rheo__json_text(rheo__json *json, const char *key, const char *text);
void rheo__json_bool(rheo__json *json, const char *key, bool value);
void rheo__json_null(rheo__json *json, const char *key);
/* Writes a list of numbers on one line. */
void rheo__json_vector(rheo__json *json, const char *key, const double *values, size_t count);
/* Writes a 64-bit hash as a string of 16 hexadecimal digits. */
void rheo__json_hash(rheo__json *json, const char *key, uint64_t hash);

/* Writes the fewest digits, 15 to 17, that read back to the same double, or inf or nan. `text` holds >= 32 bytes. */
void rheo__number_text(double value, char *text, size_t size);

#endif
