/* Numbers as text, the same in every locale. */
#ifndef RHEO__CORE_TEXT_H
#define RHEO__CORE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* The shortest of 15 to 17 digits that reads back to the same bits; `text` holds 32 bytes. */
void rheo__text_from_double(double value, char text[32]);
/*
 * Reads a number at `text`; *end is the character after it, or `text` itself if there is none. A point is the decimal
 * separator.
 */
double rheo__text_to_double(const char *text, const char **end);

/*
 * Rounds to a few significant digits, or rounds down towards 0; `text` itself, the same in every locale. "not a
 * number" and "infinite" for values without digits.
 */
const char *rheo__text_brief(double value, int digits, bool down, char text[32]);

#endif
