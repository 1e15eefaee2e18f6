/* Pictures as PNG files. */
#ifndef CLI_PNG_H
#define CLI_PNG_H

#include "cli/cli.h"

/* Whether this program can write them: it was built with libpng. Prints why not and returns CLI_BAD, else CLI_DONE. */
int cli_check_png(void);
/* Writes width x height x 3 bytes as a file, under a temporary name that is renamed at the end. */
int cli_write_png(const char *path, const unsigned char *rgb, uint32_t width, uint32_t height, bool force);

#endif
