/*
 * Texts that a test program has met, in their order, against those of the file tests/STORED, which the program defines: every
 * word and digit counts. After an intended change:
 *
 *   RHEOLOG_WRITE=1 meson test -C build NAME
 *
 * The numbers are those of float, so programs for double only print them.
 */
#ifndef RHEO__TESTS_STORED_H
#define RHEO__TESTS_STORED_H

#include "support.h"

#include "core/text.h"

static char stored_text[1 << 18];
static size_t stored_length;

__attribute__((format(printf, 1, 2))) static inline void stored_keep(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    const size_t room = sizeof stored_text - stored_length;
    stored_length += (size_t)vsnprintf(stored_text + stored_length, room, format, list);
    va_end(list);
    assert_true(stored_length < sizeof stored_text);
}

/* The last test of a program. */
static inline void texts_are_the_stored_ones(void **state)
{
    (void)state;
    const char *headers =
        getenv("HEADERS"); /* include/rheolog of the sources; not set: the program was run by hand */
    char path[4096];
    size_t size;
    if (!headers)
        skip();
    snprintf(path, sizeof path, "%s/../../tests/" STORED, headers);
    if (getenv("RHEOLOG_WRITE") && sizeof(rheo_real) == 4)
        write_file(path, stored_text, stored_length);
    char *stored = (char *)read_file(path, &size);
    const char *a = stored_text, *b = stored;
    for (size_t line; *a && (line = strcspn(a, "\n") + 1) == strcspn(b, "\n") + 1 && strncmp(a, b, line) == 0;) {
        a += line;
        b += line;
    }
    if (sizeof(rheo_real) == 4 && (*a || *b))
        fail_msg("\"%.*s\"\nis not the line of " STORED "\n\"%.*s\"", (int)strcspn(a, "\n"), a, (int)strcspn(b, "\n"),
                 b);
    free(stored);
}

#endif
