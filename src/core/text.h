/* Numbers as text, the same in every locale. */
#ifndef RHEO__CORE_TEXT_H
#define RHEO__CORE_TEXT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The shortest of 15 to 17 digits that reads back to the same bits; `text` holds 32 bytes. */
void rheo__text_from_double(double value, char text[32]);
/*
 * Reads a number with a decimal point at `text`. *end is the character after it, or `text` itself if there is none.
 */
double rheo__text_to_double(const char *text, const char **end);

/*
 * Writes a number with a few significant digits, rounded to nearest or down towards 0; returns `text`. It has an
 * exponent below 0.0001, and from a million on if it is rounded to tens or more. Writes "not a number" or "infinite" for
 * values without digits.
 */
const char *rheo__text_brief(double value, int digits, bool down, char text[32]);
/* Writes two numbers with the fewest significant digits, at least 3, that show which is larger. */
void rheo__text_two(double a, double b, char text_a[32], char text_b[32]);

/* snprintf() and vsnprintf() with a decimal point. */
int rheo__text_print(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));
int rheo__text_vprint(char *text, size_t size, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));
/* Appends to a text in an array of `size` bytes, and cuts off what does not fit. */
void rheo__text_add(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Whether each character is printable (rheo_printable_length()) or one of `also`. */
bool rheo__text_is_printable(const char *text, const char *also);
/* Replaces each byte that belongs to no printable character by '?', and line ends and tabs by blanks. */
void rheo__text_make_printable(char *text);

/* The ending of a noun after a number: "%llu step%s". */
const char *rheo__plural(uint64_t count);

#endif
