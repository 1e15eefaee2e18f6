/* Refuses pictures in a program that was built without libpng. */
#include "cli/png.h"

int cli_check_png(void)
{
    return cli_fail(CLI_BAD, "this program was built without pictures; build it with libpng (package libpng-dev)");
}

int cli_write_png(const char *path, const unsigned char *rgb, uint32_t width, uint32_t height, bool force)
{
    (void)path, (void)rgb, (void)width, (void)height, (void)force;
    return cli_check_png();
}
