/* Results, errors, callbacks and the number type: what every other public header needs. */
#ifndef RHEOLOG_BASE_H
#define RHEOLOG_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "rheolog/config.h" /* RHEO_DOUBLE: set when the library was built with -Dreal=double */

#define RHEO_VERSION_MAJOR 0
#define RHEO_VERSION_MINOR 1
#define RHEO_VERSION_PATCH 0
#define RHEO_VERSION "0.1.0"

#if defined(__GNUC__)
#define RHEO_API __attribute__((visibility("default")))
#else
#define RHEO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** The number type of the state: float, or double when the library was built so. A recording says which. */
#if RHEO_DOUBLE
typedef double rheo_real;
#else
typedef float rheo_real;
#endif

/** What a call came to. RHEO_OK is 0; everything else says in a rheo_error what was wrong. */
typedef enum rheo_result {
    RHEO_OK = 0,
    RHEO_ERROR_ARGUMENT = 1,    /**< a value out of its range, an unknown name, an index that does not exist */
    RHEO_ERROR_STATE = 2,       /**< the world went bad (NaN, infinity), or has failed before */
    RHEO_ERROR_MEMORY = 3,      /**< an allocation failed; nothing was changed */
    RHEO_ERROR_FILE = 4,        /**< the system could not open, read, write or rename a file */
    RHEO_ERROR_FORMAT = 5,      /**< not a recording, damaged, truncated, or of a newer format */
    RHEO_ERROR_UNSUPPORTED = 6, /**< a valid request that this build cannot serve (other number type, ...) */
    RHEO_ERROR_ENVIRONMENT = 7, /**< the floating-point environment would change the bits */
    RHEO_ERROR_DIFFERS = 8,     /**< a replay did not give the recorded hash */
} rheo_result;

/** What went wrong and what would be right: one line, no newline at its end. */
typedef struct rheo_error {
    char message[512];
} rheo_error;

/** The name of a result, e.g. "bad argument"; never NULL. */
RHEO_API const char *rheo_result_name(rheo_result result);

/** The library's version, e.g. "0.1.0". */
RHEO_API const char *rheo_version(void);

/** Compiler, flags that matter, number type and machine of this build, one line. Never part of a hash. */
RHEO_API const char *rheo_build(void);

/**
 * The loops that a step spends its time in are there several times, for machines of different vectors: "scalar",
 * "portable", and on x86-64 "avx2" and "avx512". All give the same bits. The best that this machine runs is in use
 * until another is chosen, for the whole process and for worlds that exist already; not while another thread steps
 * one.
 */
RHEO_API const char *rheo_simd(void);
/** The names that can be chosen here, the best last; NULL from the number of them on. */
RHEO_API const char *rheo_simd_available(uint32_t index);
/** RHEO_ERROR_ARGUMENT: this build has no such kernels, or this machine cannot run them. */
RHEO_API rheo_result rheo_use_simd(const char *name, rheo_error *error);

/**
 * Memory comes from here. `allocate` returns memory aligned for any type, or NULL; `release` takes what
 * allocate returned (never NULL). Left NULL in a definition, malloc and free serve.
 */
typedef struct rheo_allocator {
    void *(*allocate)(size_t bytes, void *user);
    void (*release)(void *memory, void *user);
    void *user;
} rheo_allocator;

/** Messages that are not errors (for example how far settling has come); left NULL nothing is said. */
typedef struct rheo_log {
    void (*message)(const char *text, void *user);
    void *user;
} rheo_log;

/**
 * The word of the list that is nearest to a misspelt one (Levenshtein distance; the first of equals). In words with a
 * dot the part after it counts as well, so that "ball.stiffness" finds "springs.stiffness". NULL if count is 0.
 */
RHEO_API const char *rheo_nearest_word(const char *word, const char *const *words, size_t count);

#ifdef __cplusplus
}
#endif
#endif
