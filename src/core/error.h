/* Errors: one line with the fault and its correction. */
#ifndef RHEO__CORE_ERROR_H
#define RHEO__CORE_ERROR_H

#include "rheolog/base.h"

/* Writes the message (error may be NULL) and returns `result`, so that a caller can `return rheo__fail(...)`. */
rheo_result rheo__fail(rheo_error *error, rheo_result result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/*
 * Nothing may depend on the words of a message. In the library of the tests doctor_reworded and
 * doctor_melting_reworded every message is in capitals.
 */
#ifdef RHEO__REWORDED
void rheo__reword(char *text);
#else
static inline void rheo__reword(char *text)
{
    (void)text;
}
#endif

#define RHEO__TRY(call)                        \
    do {                                       \
        rheo_result rheo__try_result = (call); \
        if (rheo__try_result != RHEO_OK)       \
            return rheo__try_result;           \
    } while (0)

#endif
