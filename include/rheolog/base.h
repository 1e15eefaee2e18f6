/*
 * Results, errors, callbacks and the number type. All other public headers include this one.
 */
#ifndef RHEOLOG_BASE_H
#define RHEOLOG_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * RHEO_DOUBLE: 1 if the library was built with -Dreal=double, else 0. If it is 1, config.h also makes each function name
 * below a macro that adds _double, because so the functions are called in the library.
 */
#include "rheolog/config.h"

/** Version of the headers; rheo_version() is that of the library. Its first number. */
#define RHEO_VERSION_MAJOR 0
/** Second number of the version. */
#define RHEO_VERSION_MINOR 1
/** Third number of the version. */
#define RHEO_VERSION_PATCH 0
/** The version as text. */
#define RHEO_VERSION "0.1.0"

/** Marks the functions that the library exports. */
#if defined(__GNUC__)
#define RHEO_API __attribute__((visibility("default")))
#else
#define RHEO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Number type of the state: float, or double in a library built with -Dreal=double. Recordings store its size. */
#if RHEO_DOUBLE
typedef double rheo_real;
#else
typedef float rheo_real;
#endif

/** Result of a call. Functions with a rheo_error argument explain any result other than RHEO_OK there. */
typedef enum rheo_result {
    /** Success. */
    RHEO_OK = 0,
    /** A value is out of range, a name is unknown, or an index does not exist. */
    RHEO_ERROR_ARGUMENT = 1,
    /** The step failed: a value became NaN or infinite, or a stage refused to go on. */
    RHEO_ERROR_STATE = 2,
    /** An allocation failed. Nothing was changed. */
    RHEO_ERROR_MEMORY = 3,
    /** The system could not open, read, write or rename a file. */
    RHEO_ERROR_FILE = 4,
    /** A file is not a recording, is damaged or truncated, or has a newer format. */
    RHEO_ERROR_FORMAT = 5,
    /**
     * The request is valid, but this build does not support it (for example, a file with the other number type, or a
     * pointer of git-lfs to a recording).
     */
    RHEO_ERROR_UNSUPPORTED = 6,
    /** The floating-point environment would change the bits of results. */
    RHEO_ERROR_ENVIRONMENT = 7,
    /** A replay did not reproduce a recorded hash. */
    RHEO_ERROR_DIFFERS = 8,
    /** The receiver of progress asked to stop (rheo_use_progress()). Nothing else was wrong. */
    RHEO_ERROR_STOPPED = 9,
    /** The next step does not fit into the limit of the recording (max_bytes of rheo_record_options). */
    RHEO_ERROR_LIMIT = 10,
} rheo_result;

/** Description of an error. */
typedef struct rheo_error {
    /** One line without a newline: the value that is wrong, where it is, and which values are right. */
    char message[512];
} rheo_error;

/** Name of a result, for example "bad argument". Never NULL. */
RHEO_API const char *rheo_result_name(rheo_result result);

/** Version of the library, for example "0.1.0". */
RHEO_API const char *rheo_version(void);

/** Compiler, relevant flags, number type and machine of this build, in one line. Never part of a hash. */
RHEO_API const char *rheo_build(void);

/**
 * Name of the SIMD variant in use. The hot loops are compiled for several vector widths: "scalar", "portable", and on
 * x86-64 "avx2" and "avx512". All variants compute the same bits. Default: the fastest that this machine can run.
 */
RHEO_API const char *rheo_simd(void);
/** Name of a variant that this machine can run, by index, slowest first; NULL past the end. */
RHEO_API const char *rheo_simd_available(uint32_t index);
/**
 * Chooses the SIMD variant for the whole process, including worlds that already exist. Must not be called while
 * another thread steps a world. RHEO_ERROR_ARGUMENT if this build lacks the variant or this machine cannot run it.
 */
RHEO_API rheo_result rheo_use_simd(const char *name, rheo_error *error);

/**
 * Writes a number with the fewest digits, 15 to 17, that read back to the same bits; "inf", "-inf" or "nan". The
 * separator is a point in every locale. `text` holds >= 32 bytes.
 */
RHEO_API void rheo_number_text(double value, char *text);
/**
 * Writes a number with this many significant digits, 1 to 15, for people: "0.0919", "118000", "2.46e+07"; returns
 * `text`, which holds >= 32 bytes. It has an exponent below 0.0001 and from a million on.
 */
RHEO_API const char *rheo_number_brief(double value, int digits, char *text);
/**
 * Reads the number at the beginning of a text, with a point in every locale. *end is the character after it, or
 * `text` if there is none. A number has at most 63 characters.
 */
RHEO_API double rheo_text_number(const char *text, const char **end);

/**
 * Length in bytes of the UTF-8 character at `text`; 0 if it is not UTF-8, or a control character (U+0000 to U+001F,
 * U+007F to U+009F), which could change what a terminal does or shows.
 */
RHEO_API size_t rheo_printable_length(const char *text);

/** Memory functions. Default: all members NULL, which selects malloc and free. */
typedef struct rheo_allocator {
    /** Returns memory aligned for any type, or NULL if there is none. */
    void *(*allocate)(size_t bytes, void *user);
    /** Releases memory that `allocate` returned. `memory` is never NULL. */
    void (*release)(void *memory, void *user);
    /** Passed to both functions. */
    void *user;
} rheo_allocator;

/** Receiver of messages that are not errors: warnings, which begin with "warning: ", and the progress of settling. */
typedef struct rheo_log {
    /** Called with one message. Default NULL: messages are dropped. */
    void (*message)(const char *text, void *user);
    /** Passed to `message`. */
    void *user;
} rheo_log;

/** Receiver of the progress of functions that make many steps. */
typedef struct rheo_progress {
    /**
     * Called after step `done` of `total`, from 1 on. `task` is a constant text: "settling" (rheo_scene_create_world()),
     * "verifying" (rheo_verify(), rheo_bless(), rheo_same()), "comparing" (rheo_diff(), rheo_bless(), rheo_rerecord(), rheo_same()), "recording"
     * (rheo_rerecord()), "searching" (rheo_recording_find()) or "simulating" (on the way to a step: rheo_recording_world(), rheo_player_seek() and others).
     * Returns whether to go on: if it returns false from then on, the function ends with RHEO_ERROR_STOPPED. Must not
     * call the library with the same objects. NULL: none.
     */
    bool (*report)(const char *task, uint64_t done, uint64_t total, void *user);
    /** Passed to `report`. */
    void *user;
} rheo_progress;

/**
 * Chooses the receiver for the calling thread, and returns the one before, to put it back. Default: none. It has no
 * influence on any result.
 */
RHEO_API rheo_progress rheo_use_progress(rheo_progress progress);

/** What the calling thread has done so far. The difference of two of them is what the calls between them took. */
typedef struct rheo_work {
    /** Steps of worlds that were begun, in whatever way: simulated, replayed, or looked into stage by stage. */
    uint64_t steps;
    /** Whole states that were read: of keyframes and checkpoints, also in memory, and of steps of full recordings. */
    uint64_t states;
} rheo_work;

/** Work of the calling thread since it began. */
RHEO_API rheo_work rheo_work_done(void);

/**
 * Finds the word in a list that is nearest to a misspelt one, by Levenshtein distance; the first if several are
 * equally near. Also compares the parts after a dot, so that "ball.stiffness" finds "springs.stiffness". NULL if
 * count is 0.
 */
RHEO_API const char *rheo_nearest_word(const char *word, const char *const *words, size_t count);

/**
 * Whether one word may be the other one misspelt: at most a third of the letters of the longer one differ, or one, or
 * two neighbours are swapped. As in rheo_nearest_word(), the parts after a dot may be compared, or the first word with
 * the other's part before it.
 */
RHEO_API bool rheo_is_near_word(const char *word, const char *other);

#ifdef __cplusplus
}
#endif
#endif
