/* The text of a place that a search has found. */
#include "cli/found.h"

#include <string.h>

const char *cli_found_text(const rheo_found *f, char text[CLI_FOUND])
{
    char value[32];
    const char *is = strcmp(f->quantity, "exists") == 0 ? "" : " is ";
    snprintf(text, CLI_FOUND, "step %llu%s%s: %s%s%s%s%s", (unsigned long long)f->step, *f->stage ? ", after " : "",
             f->stage, f->item,
             !*f->item ? ""
             : *is     ? ": "
                       : " ",
             f->quantity, is, *is ? rheo_number_brief(f->value, 6, value) : "");
    return text;
}
