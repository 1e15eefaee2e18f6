/*
 * A program linked with -ffast-math, which flushes denormals from its start. The library refuses to create worlds
 * until the program clears the flags. Exit code 77 (skipped) if this compiler's start-up code changes no flags.
 */
#include <stdio.h>
#include <string.h>

#include "control_word.h"
#include "rheolog/rheolog.h"

int main(void)
{
#ifndef CONTROL_WORD
    puts("the control word of this machine is unknown");
    return 77;
#else
    const uint64_t flush = CONTROL_FLUSH_RESULTS | CONTROL_FLUSH_OPERANDS;
    rheo_world_def def = rheo_default_world_def();
    rheo_world *world;
    rheo_error error = {""};
    const bool flushed = control_get() & flush;
    rheo_result result = rheo_world_create(&def, &world, &error);
    if (!flushed) {
        rheo_world_destroy(world);
        puts("this compiler's start-up code for -ffast-math changes no flags");
        return result == RHEO_OK ? 77 : 1;
    }
    if (result != RHEO_ERROR_ENVIRONMENT || !strstr(error.message, "denormal numbers are flushed")) {
        printf("not refused: %s\n", error.message);
        return 1;
    }
    printf("refused: %s\n", error.message);
    control_set(control_get() & ~flush);
    if (rheo_world_create(&def, &world, &error) != RHEO_OK || rheo_world_step(world, &error) != RHEO_OK) {
        printf("still refused: %s\n", error.message);
        return 1;
    }
    rheo_world_destroy(world);
    return 0;
#endif
}
