/*
 * Writes JSON to a file, member by member; commas and brackets follow by themselves.
 *
 *     cli_json json = {.file = stdout};
 *     cli_json_begin_object(&json, NULL);
 *     cli_json_text(&json, "file", "ball.rlog");
 *     cli_json_vector(&json, "gravity", gravity, 3);
 *     cli_json_end_object(&json);
 *
 * The key is NULL for the outermost value and in lists. Nothing is allocated, and every value is written at once.
 *
 * jansson, which reads scene files, does not write: it prints doubles with %.17g (0.1 as 0.10000000000000001), and a
 * program built without it (-Djson=disabled) must print JSON too.
 */
#ifndef CLI_JSON_WRITER_H
#define CLI_JSON_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct cli_json {
    FILE *file;
    unsigned
        lines; /* members down to this depth have a line each, indented by 4 blanks a level; 0: one line in all */
    unsigned depth;
    bool follows; /* the next member needs a comma in front */
} cli_json;

void cli_json_begin_object(cli_json *json, const char *key);
/* Ends the line too if it was the outermost. */
void cli_json_end_object(cli_json *json);
void cli_json_begin_list(cli_json *json, const char *key);
void cli_json_end_list(cli_json *json);

/* The shortest of 15 to 17 digits that read back to the same double; null for NaN and infinity. */
void cli_json_number(cli_json *json, const char *key, double value);
/* So many decimals; if negative, so many with a power of ten. Null for NaN and infinity. */
void cli_json_decimals(cli_json *json, const char *key, int decimals, double value);
void cli_json_integer(cli_json *json, const char *key, uint64_t value);
/* In quotes; bytes that are not UTF-8 become U+FFFD. NULL: null. */
void cli_json_text(cli_json *json, const char *key, const char *text);
void cli_json_bool(cli_json *json, const char *key, bool value);
void cli_json_null(cli_json *json, const char *key);
/* A list of numbers, on one line. */
void cli_json_vector(cli_json *json, const char *key, const double *values, size_t count);
/* A 64-bit hash as 16 hexadecimal digits in quotes. */
void cli_json_hash(cli_json *json, const char *key, uint64_t hash);

/* The shortest of 15 to 17 digits that read back to the same double, inf or nan; `text` holds >= 32 bytes. */
void cli_number_text(double value, char *text, size_t size);

#endif
