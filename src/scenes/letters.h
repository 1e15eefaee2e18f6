/* Letters of 5 x 7 dots. */
#ifndef RHEO__SCENES_LETTERS_H
#define RHEO__SCENES_LETTERS_H

#include "rheolog/base.h"

enum { RHEO__LETTER_COLUMNS = 5, RHEO__LETTER_ROWS = 7, RHEO__LETTER_ADVANCE = 6 /* a free column between two */ };

/* Whether there is a letter for every character; else a message that names those that there are none for. */
rheo_result rheo__letters_check(const char *text, rheo_error *error);
/*
 * The dots of one row (from the bottom, 0..6) over the whole text, from the left: 1 is set. `dots` holds
 * RHEO__LETTER_ADVANCE for each character; the last column of each is free.
 */
void rheo__letters_row(const char *text, size_t row, uint8_t *dots);

#endif
