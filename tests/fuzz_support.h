/*
 * Frame of the fuzz targets. With RHEO__LIBFUZZER, libFuzzer runs a target. Otherwise it is a program that reads the
 * files and folders of its arguments. A target defines drive(), which aborts if a property is violated.
 */
#ifndef RHEO__TESTS_FUZZ_SUPPORT_H
#define RHEO__TESTS_FUZZ_SUPPORT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define HOLDS(condition)                                                    \
    do {                                                                    \
        if (!(condition)) {                                                 \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            abort();                                                        \
        }                                                                   \
    } while (0)

/* Reads one input. */
void drive(const uint8_t *bytes, size_t size);

/* Returns a file's bytes, from malloc. */
uint8_t *read_file(const char *path, size_t *size);

/* Drives and counts all files of the arguments. Returns an exit code; `inputs` is the plural name of the inputs. */
int read_arguments(int argc, char **argv, const char *inputs);

#endif
