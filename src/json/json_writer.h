/*
 * Writes JSON to a file, member by member. Commas, indentation and line breaks are added automatically.
 *
 *     cli_json json = {.file = stdout};
 *     cli_json_begin_object(&json, NULL);
 *     cli_json_text(&json, "file", "ball.rlog");
 *     cli_json_vector(&json, "gravity", gravity, 3);
 *     cli_json_end_object(&json);
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

typedef struct cli_json {
    FILE *file;
    /*
     * Members down to this depth have their own lines, indented by 4 blanks per level. 0: everything is on one line.
     */
    unsigned lines;
    unsigned depth;
    bool follows; /* a comma must precede the next member */
} cli_json;

void cli_json_begin_object(cli_json *json, const char *key);
/* Ends an object, and the line if it was the outermost object. */
void cli_json_end_object(cli_json *json);
void cli_json_begin_list(cli_json *json, const char *key);
void cli_json_end_list(cli_json *json);

/* Writes the fewest digits, 15 to 17, that read back to the same double; null for NaN and infinity. */
void cli_json_number(cli_json *json, const char *key, double value);
/* Writes `decimals` decimals; if negative, -decimals in exponential form. Null for NaN and infinity. */
void cli_json_decimals(cli_json *json, const char *key, int decimals, double value);
void cli_json_integer(cli_json *json, const char *key, uint64_t value);
/* Writes a string. Bytes that are not UTF-8 become U+FFFD; NULL becomes null. */
void cli_json_text(cli_json *json, const char *key, const char *text);
void cli_json_bool(cli_json *json, const char *key, bool value);
void cli_json_null(cli_json *json, const char *key);
/* Writes a list of numbers on one line. */
void cli_json_vector(cli_json *json, const char *key, const double *values, size_t count);
/* Writes a 64-bit hash as a string of 16 hexadecimal digits. */
void cli_json_hash(cli_json *json, const char *key, uint64_t hash);

/* Writes the fewest digits, 15 to 17, that read back to the same double, or inf or nan. `text` holds >= 32 bytes. */
void cli_number_text(double value, char *text, size_t size);

#endif
