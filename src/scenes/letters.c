/*
 * Letters of 5 x 7 dots, listed row by row from the top. Neighbouring dots share a side, not only a corner, so that a
 * solid letter holds together.
 */
#include "scenes/letters.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"

typedef struct letter {
    char character;
    char row[RHEO__LETTER_ROWS][RHEO__LETTER_COLUMNS + 1];
} letter;

/* clang-format off */
static const letter letters[] = {
    {' ', {"", "", "", "", "", "", ""}},
    {'A', {"#####", "#   #", "#   #", "#####", "#   #", "#   #", "#   #"}},
    {'B', {"#### ", "#  # ", "#  # ", "#####", "#   #", "#   #", "#####"}},
    {'C', {" ####", "##   ", "#    ", "#    ", "#    ", "##   ", " ####"}},
    {'D', {"#### ", "#  ##", "#   #", "#   #", "#   #", "#  ##", "#### "}},
    {'E', {"#####", "#    ", "#    ", "#### ", "#    ", "#    ", "#####"}},
    {'F', {"#####", "#    ", "#    ", "#### ", "#    ", "#    ", "#    "}},
    {'G', {" ####", "##   ", "#    ", "#  ##", "#   #", "##  #", " ####"}},
    {'H', {"#   #", "#   #", "#   #", "#####", "#   #", "#   #", "#   #"}},
    {'I', {" ### ", "  #  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "}},
    {'J', {"  ###", "   # ", "   # ", "   # ", "   # ", "#  # ", "#### "}},
    {'K', {"#   #", "#  ##", "# ## ", "###  ", "# ## ", "#  ##", "#   #"}},
    {'L', {"#    ", "#    ", "#    ", "#    ", "#    ", "#    ", "#####"}},
    {'M', {"#   #", "## ##", "#####", "# # #", "#   #", "#   #", "#   #"}},
    {'N', {"#   #", "##  #", "### #", "# ###", "#  ##", "#   #", "#   #"}},
    {'O', {" ### ", "## ##", "#   #", "#   #", "#   #", "## ##", " ### "}},
    {'P', {"#####", "#   #", "#   #", "#####", "#    ", "#    ", "#    "}},
    {'Q', {"#####", "#   #", "#   #", "#   #", "# ###", "#  ##", "#####"}},
    {'R', {"#####", "#   #", "#   #", "#####", "# ## ", "#  ##", "#   #"}},
    {'S', {" ####", "##   ", "##   ", " ### ", "   ##", "   ##", "#### "}},
    {'T', {"#####", "  #  ", "  #  ", "  #  ", "  #  ", "  #  ", "  #  "}},
    {'U', {"#   #", "#   #", "#   #", "#   #", "#   #", "## ##", " ### "}},
    {'V', {"#   #", "#   #", "#   #", "#   #", "## ##", " ### ", "  #  "}},
    {'W', {"#   #", "#   #", "#   #", "# # #", "#####", "## ##", "#   #"}},
    {'X', {"#   #", "## ##", " ### ", "  #  ", " ### ", "## ##", "#   #"}},
    {'Y', {"#   #", "#   #", "## ##", " ### ", "  #  ", "  #  ", "  #  "}},
    {'Z', {"#####", "   ##", "  ## ", " ##  ", "##   ", "#    ", "#####"}},
    {'0', {"#####", "#   #", "#   #", "#   #", "#   #", "#   #", "#####"}},
    {'1', {"  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "}},
    {'2', {"#### ", "   ##", "   ##", "  ## ", " ##  ", "##   ", "#####"}},
    {'3', {"#####", "   ##", "  ## ", "  ###", "    #", "    #", "#####"}},
    {'4', {"  ## ", " ### ", "## # ", "#  # ", "#####", "   # ", "   # "}},
    {'5', {"#####", "#    ", "#####", "    #", "    #", "    #", "#####"}},
    {'6', {"#####", "#    ", "#    ", "#####", "#   #", "#   #", "#####"}},
    {'7', {"#####", "   ##", "  ## ", "  #  ", "  #  ", "  #  ", "  #  "}},
    {'8', {"#####", "#   #", "#   #", "#####", "#   #", "#   #", "#####"}},
    {'9', {"#####", "#   #", "#   #", "#####", "    #", "    #", "#####"}},
    {'.', {"     ", "     ", "     ", "     ", "     ", " ##  ", " ##  "}},
    {',', {"     ", "     ", "     ", "     ", " ##  ", "  #  ", " ##  "}},
    {'!', {"  #  ", "  #  ", "  #  ", "  #  ", "  #  ", "     ", "  #  "}},
    {'?', {"#####", "    #", "  ###", "  #  ", "  #  ", "     ", "  #  "}},
    {'-', {"     ", "     ", "     ", "#####", "     ", "     ", "     "}},
    {'+', {"     ", "  #  ", "  #  ", "#####", "  #  ", "  #  ", "     "}},
    {'=', {"     ", "     ", "#####", "     ", "#####", "     ", "     "}},
    {':', {"     ", " ##  ", " ##  ", "     ", " ##  ", " ##  ", "     "}},
    {'/', {"    #", "   ##", "  ## ", " ##  ", "##   ", "#    ", "     "}},
};
/* clang-format on */

enum { LETTERS = sizeof letters / sizeof *letters };

static const letter *find(char character)
{
    for (size_t i = 0; i < LETTERS; i++)
        if (letters[i].character == character)
            return &letters[i];
    return NULL;
}

/* Lists each missing letter once, as far as there is room for whole ones; rheo__fail() makes them printable. */
rheo_result rheo__letters_check(const char *text, rheo_error *error)
{
    char without[24] = "", with[LETTERS + 1] = "";
    size_t used = 0;
    bool missing = false;
    for (const char *c = text, *next; *c; c = next) {
        for (next = c + 1; ((unsigned char)*next & 0xc0) == 0x80; next++) /* further bytes of a UTF-8 character */
            ;
        char one[sizeof without];
        const size_t length = (size_t)(next - c);
        if (find(*c))
            continue;
        missing = true;
        if (used + length >= sizeof without)
            continue;
        memcpy(one, c, length);
        one[length] = 0;
        if (strstr(without, one))
            continue;
        memcpy(without + used, one, length + 1);
        used += length;
    }
    if (!missing)
        return RHEO_OK;
    for (size_t i = 0; i < LETTERS; i++)
        with[i] = letters[i].character;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no letter for: %s; there are (with a blank):%s", without,
                      with);
}

void rheo__letters_row(const char *text, size_t row, uint8_t *dots)
{
    for (const char *c = text; *c; c++, dots += RHEO__LETTER_ADVANCE) {
        const letter *l = find(*c);
        for (size_t column = 0; column < RHEO__LETTER_ADVANCE; column++)
            dots[column] = l && column < RHEO__LETTER_COLUMNS && l->row[RHEO__LETTER_ROWS - 1 - row][column] == '#';
    }
}
