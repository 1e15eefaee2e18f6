/* Letters of 5 x 7 dots. */
#ifndef RHEO__SCENES_LETTERS_H
#define RHEO__SCENES_LETTERS_H

#include "rheolog/base.h"

/* A letter is followed by a free column, which RHEO__LETTER_ADVANCE includes. */
enum { RHEO__LETTER_COLUMNS = 5, RHEO__LETTER_ROWS = 7, RHEO__LETTER_ADVANCE = 6 };

/* Checks that every character has a letter. The message lists the missing letters. */
rheo_result rheo__letters_check(const char *text, rheo_error *error);
/*
 * Writes the dots of one row of a text, left to right; 1 is set. Row 0 is at the bottom, row 6 at the top. `dots`
 * holds RHEO__LETTER_ADVANCE values per character; the last column of a character is free.
 */
void rheo__letters_row(const char *text, size_t row, uint8_t *dots);

#endif
