/*
 * A library for test_environment.c that flushes denormals when it is loaded. The start-up code that the linker adds
 * for -ffast-math does it; built with FLUSH_BY_HAND, the library does it by itself.
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
