/*
 * A library that flushes denormals when it is loaded, for test_environment.c: by what -ffast-math makes the linker
 * add; with FLUSH_BY_HAND by itself.
 */
#include "control_word.h"

int rheo__test_library(void);

int rheo__test_library(void)
{
    return 1;
}

#if defined(FLUSH_BY_HAND) && defined(CONTROL_WORD)
__attribute__((constructor)) static void flush(void)
{
    control_set(control_get() | CONTROL_FLUSH_RESULTS | CONTROL_FLUSH_OPERANDS);
}
#endif
