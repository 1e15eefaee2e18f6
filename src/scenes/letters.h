/* Letters of 5 x 7 dots. */
#ifndef RHEO_SCENES_LETTERS_H
#define RHEO_SCENES_LETTERS_H

#include "rheolog/base.h"

enum { RHEO_LETTER_COLUMNS = 5, RHEO_LETTER_ROWS = 7, RHEO_LETTER_ADVANCE = 6 /* a free column between two */ };

/* Whether there is a letter for every character; else a message that names those that there are none for. */
rheo_result rheo_letters_check(const char *text, rheo_error *error);
/*
 * The dots of one row (from the bottom, 0..6) over the whole text, from the left: 1 is set. `dots` holds
 * RHEO_LETTER_ADVANCE for each character; the last column of each is free.
 */
void rheo_letters_row(const char *text, size_t row, uint8_t *dots);

#endif
