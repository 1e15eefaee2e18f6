/*
 * Helpers of tests that run the program from outside. The environment variable RHEOLOG names the program. Each test
 * program works in its own folder and removes it.
 */
#ifndef RHEO__TESTS_CLI_SUPPORT_H
#define RHEO__TESTS_CLI_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rheolog/rheolog.h"

/* A scene file that set_up() writes as tiny.json. */
extern const char tiny[];
extern const char *scene;               /* argument SCENE, with options that reduce it */
extern bool json_scenes;                /* whether the program reads scene files */
extern char out[1 << 20], err[1 << 16]; /* standard output and standard error of the last run */

void read_file(const char *path, char *text, size_t size);
/* Reads a file into one buffer that all calls share. */
char *read_bytes(const char *path, size_t *size);
void write_file(const char *path, const char *text, size_t size);
long file_size(const char *path);
/* Runs `rheolog ARGUMENTS`; returns its exit code; fills out and err. */
int run(const char *format, ...) __attribute__((format(printf, 1, 2)));
void assert_code(int expected, int code);
void assert_in(const char *part, const char *text);
/* Asserts one line on standard error that contains the part, and an empty standard output. */
void assert_one_message(const char *part);
void assert_keys(const char *text, const char *const *keys);
/* The text of a key's value up to the next comma. */
const char *value_of(const char *key);
int set_up(void **state);
int tear_down(void **state);
/* Makes a recording of 8 steps with this name. */
void record(const char *name);
/* Loads the state at a step through a checkpoint that the program writes. */
rheo_world *checkpoint_at(const char *from, int step);
/* Reads the number at *at and moves *at past it. */
double number_at(const char **at);
/* The number after "key":, or the first of a list there. */
double number_after(const char **at, const char *key);
void assert_vector(const char **at, const char *key, const double value[3]);
void assert_row(const char **at, const char *key, const rheo_real *row);
/* Records a small melting box with these options. */
void record_melting(const char *name, const char *options);
/*
 * Copies a recording with another hash in one STEP chunk and a correct CRC, which looks like a change of the code. A
 * chunk is a header of 32 bytes (type, flags, step, length of the payload), payload, CRC-32.
 */
void falsify_step(const char *from, const char *to, unsigned step);
/* Does the same with these bits of the hash changed: other bits make another hash. */
void falsify_step_by(const char *from, const char *to, unsigned step, unsigned char bits);
void assert_files_same(const char *a, const char *b);

/*
 * Interrupts `rheolog COMMAND` after longer and longer times, until it has printed `sign`. Returns its exit code; -1: the signal
 * killed it.
 */
int interrupt_until(const char *command, const char *sign);

#endif
