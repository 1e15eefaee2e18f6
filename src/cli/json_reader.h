/*
 * Values of a JSON file, with messages that name line and path: "file:line: path: what is wrong". jansson parses but
 * keeps no lines. So a value carries its place, the index in each enclosing object or list, and a walk over the text
 * finds the line when it is needed.
 */
#ifndef CLI_JSON_READER_H
#define CLI_JSON_READER_H

#include <jansson.h>

#include "rheolog/base.h"

typedef struct cli_json_reader {
    const char *text, *end; /* valid JSON */
    const char *file;       /* name for messages */
    void *user;
    rheo_error *error;
} cli_json_reader;

typedef struct cli_json_place {
    const struct cli_json_place *up; /* NULL: the whole file */
    const char *key;                 /* NULL: an element of a list */
    size_t index;                    /* in the enclosing object or list */
} cli_json_place;

/* Writes a message and returns `result`. */
rheo_result cli_json_fail(rheo_error *error, rheo_result result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Writes a message with line and path, and returns RHEO_ERROR_ARGUMENT. */
rheo_result cli_json_refuse(const cli_json_reader *r, const cli_json_place *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Line of a character of the text, from 1. */
size_t cli_json_line(const cli_json_reader *r, const char *character);
/* "an object {...}", "a number", ... */
const char *cli_json_kind(const json_t *value);

/*
 * Reads a value into `target`. `size` depends on the function: count of numbers, bytes of a text.
 */
typedef rheo_result cli_json_read(const cli_json_reader *r, const cli_json_place *at, const json_t *value,
                                  void *target, size_t size);
/* double */
cli_json_read cli_json_read_number;
/* double[2], from one number for both or a list of two */
cli_json_read cli_json_read_pair;
/* double[size] */
cli_json_read cli_json_read_numbers;
/* char[size], one line without control characters */
cli_json_read cli_json_read_text;
/* bool */
cli_json_read cli_json_read_flag;
/* bool, negated */
cli_json_read cli_json_read_negated_flag;

/* ---- Objects with members of fixed names ---- */

enum { CLI_JSON_MAX_MEMBERS = 24 };

typedef struct cli_json_member {
    const char *name;
    cli_json_read *read;
    void *target;
    size_t size;
    bool required;
    bool given; /* set by cli_json_read_members() */
} cli_json_member;

/* Reads an object. Refuses unknown keys and missing members. */
rheo_result cli_json_read_members(const cli_json_reader *r, const cli_json_place *at, const json_t *value,
                                  cli_json_member *members, size_t count);
/* Reads the elements of a list, each by the same function. */
rheo_result cli_json_read_list(const cli_json_reader *r, const cli_json_place *at, const json_t *value,
                               rheo_result (*read)(const cli_json_reader *r, const cli_json_place *at,
                                                   const json_t *value));

#endif
