/* Letters of 5 x 7 dots. */
#ifndef RHEO__SCENES_LETTERS_H
#define RHEO__SCENES_LETTERS_H

#include "rheolog/base.h"

/* The advance of a letter has a free column. */
enum { RHEO__LETTER_COLUMNS = 5, RHEO__LETTER_ROWS = 7, RHEO__LETTER_ADVANCE = 6 };

/* Checks that every character has a letter. The message names the characters without one. */
rheo_result rheo__letters_check(const char *text, rheo_error *error);
/*
 * Writes the dots of one row (0 to 6 from the bottom) of a text, from the left; 1 is set. `dots` holds
 * RHEO__LETTER_ADVANCE per character; the last column of a character is free.
 */
void rheo__letters_row(const char *text, size_t row, uint8_t *dots);

#endif
