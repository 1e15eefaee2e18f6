/* The text of a place that a search has found: `when` and `debug`. */
#ifndef CLI_FOUND_H
#define CLI_FOUND_H

#include "cli/cli.h"

enum { CLI_FOUND = 256 };
/* Writes "step 18, after forces@2: particle 17: speed is 21.3"; returns `text`. */
const char *cli_found_text(const rheo_found *found, char text[CLI_FOUND]);

#endif
