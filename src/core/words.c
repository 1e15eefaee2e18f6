/* The nearest of a list of words, for messages that ask "did you mean ...?". */
#include "core/words.h"

#include <stdint.h>
#include <string.h>

#include "rheolog/base.h"

enum { LONGEST = 63 };

static size_t length_of(const char *word)
{
    const size_t length = strlen(word);
    return length < LONGEST ? length : LONGEST;
}

size_t rheo__word_distance(const char *a, const char *b)
{
    size_t row[LONGEST + 1]; /* row[j]: distance of the part of a read so far from the first j characters of b */
    const size_t rows = length_of(a), columns = length_of(b);
    for (size_t j = 0; j <= columns; j++)
        row[j] = j;
    for (size_t i = 0; i < rows; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < columns; j++) {
            size_t best = diagonal + (a[i] != b[j]);
            best = row[j] + 1 < best ? row[j] + 1 : best;
            best = row[j + 1] + 1 < best ? row[j + 1] + 1 : best;
            diagonal = row[j + 1];
            row[j + 1] = best;
        }
    }
    return row[columns];
}

static const char *after_group(const char *path)
{
    const char *dot = strchr(path, '.');
    return dot ? dot + 1 : path;
}

/* Whether two neighbouring letters of a word are swapped in the other one. */
static bool is_swapped(const char *word, const char *other)
{
    while (*word && *word == *other) {
        word++;
        other++;
    }
    /* In this order, nothing behind the end of a word is read. */
    return word[0] && word[1] && word[1] == other[0] && word[0] == other[1] && strcmp(word + 2, other + 2) == 0;
}

static bool is_near(const char *word, const char *other)
{
    const size_t a = length_of(word), b = length_of(other), third = (a > b ? a : b) / 3;
    return rheo__word_distance(word, other) <= (third > 1 ? third : 1) || is_swapped(word, other);
}

/* Copies the part before the dot; "" if there is none, or too much. */
static void group_of(const char *path, char group[LONGEST + 1])
{
    const size_t length = strcspn(path, ".");
    group[0] = 0;
    if (path[length] && length <= LONGEST) {
        memcpy(group, path, length);
        group[length] = 0;
    }
}

bool rheo_is_near_word(const char *word, const char *other)
{
    char group[LONGEST + 1];
    group_of(other, group);
    return is_near(word, other) || is_near(after_group(word), after_group(other)) ||
           (!strchr(word, '.') && group[0] && is_near(word, group));
}

const char *rheo_nearest_word(const char *word, const char *const *words, size_t count)
{
    const char *nearest = NULL;
    size_t least = SIZE_MAX;
    for (size_t i = 0; i < count; i++) {
        const size_t whole = 2 * rheo__word_distance(word, words[i]);
        /* The right name in a wrong group is nearer than another name. */
        const size_t misplaced = 2 * rheo__word_distance(after_group(word), after_group(words[i])) + 1;
        size_t distance = misplaced < whole ? misplaced : whole;
        /* "balls" may mean a name in the group "ball". */
        char group[LONGEST + 1];
        group_of(words[i], group);
        if (!strchr(word, '.') && group[0]) {
            const size_t grouped = 2 * rheo__word_distance(word, group) + 2 + (*word != *group);
            distance = grouped < distance ? grouped : distance;
        }
        if (distance < least) {
            least = distance;
            nearest = words[i];
        }
    }
    return nearest;
}
