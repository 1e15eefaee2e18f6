/*
 * Reads values of a JSON file. Messages name line and path: "file:line: path: message". jansson parses the file but
 * does not keep lines. So every value has a place, its index in each enclosing object or list. A message finds the
 * line by walking over the text to that place.
 */
#ifndef RHEOLOG_JSON_READER_H
#define RHEOLOG_JSON_READER_H

#include <jansson.h>

#include "json/json_error.h"

typedef struct rheo__json_reader {
    const char *text, *end; /* valid JSON */
    const char *file;       /* file name in messages */
    void *user;
    rheo_error *error;
} rheo__json_reader;

typedef struct rheo__json_place {
    const struct rheo__json_place *up; /* NULL: this is the whole file */
    const char *key;                   /* NULL: this is an element of a list */
    size_t index;                      /* index in the enclosing object or list */
} rheo__json_place;

/* Writes a message with line and path, and returns RHEO_ERROR_ARGUMENT. */
/* Refuses a key that is none of those known: names the nearest one if it is near, or else says `otherwise`. */
rheo_result rheo__json_unknown_key(const rheo__json_reader *r, const rheo__json_place *at, const char *key,
                                   const char *const *known, size_t count, const char *otherwise);
rheo_result rheo__json_refuse(const rheo__json_reader *r, const rheo__json_place *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Whether the text has nothing but blanks and line ends. */
bool rheo__json_is_blank(const rheo__json_reader *r);
/* Line number of a character in the text, counted from 1. */
size_t rheo__json_line(const rheo__json_reader *r, const char *character);
/* Describes the type of a value for messages: "an object {...}", "a number", ... */
const char *rheo__json_kind(const json_t *value);

/* Reads a value into `target`. `size` is the count of numbers or the bytes of a text; other functions ignore it. */
typedef rheo_result rheo__json_read(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                    void *target, size_t size);
/* Target: double. */
rheo__json_read rheo__json_read_number;
/* Target: double[2]. The value is one number for both, or a list of two numbers. */
rheo__json_read rheo__json_read_pair;
/* Target: double[size]. */
rheo__json_read rheo__json_read_numbers;
/* Target: char[size]. The text must be one line without control characters. */
rheo__json_read rheo__json_read_text;
/* Target: bool. */
rheo__json_read rheo__json_read_flag;
/* Target: bool, set to the negated value. */
rheo__json_read rheo__json_read_negated_flag;

/* ---- Objects with fixed member names ---- */

enum { RHEO__JSON_MAX_MEMBERS = 24 };

typedef struct rheo__json_member {
    const char *name;
    rheo__json_read *read;
    void *target;
    size_t size;
    bool required;
    bool given; /* set by rheo__json_read_members() */
} rheo__json_member;

/* "$schema" and "comment" may stand in every object and are ignored: editors and people use them. */
bool rheo__json_is_ignored(const char *key);
/* Reads an object. Refuses unknown keys and missing members. */
rheo_result rheo__json_read_members(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                    rheo__json_member *members, size_t count);
/* Reads every element of a list with the same function. */
rheo_result rheo__json_read_list(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                 rheo_result (*read)(const rheo__json_reader *r, const rheo__json_place *at,
                                                     const json_t *value));

#endif
