/* Words that are nearly right. */
#ifndef RHEO__CORE_WORDS_H
#define RHEO__CORE_WORDS_H

#include <stddef.h>

/* Levenshtein distance: insertions, deletions and replacements; only the first 63 characters count. */
size_t rheo__word_distance(const char *a, const char *b);

#endif
