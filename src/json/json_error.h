/* Error messages of the library for scene files. */
#ifndef RHEOLOG_JSON_ERROR_H
#define RHEOLOG_JSON_ERROR_H

#include "rheolog/base.h"

/* Writes a message and returns `result`. */
rheo_result rheo__json_fail(rheo_error *error, rheo_result result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
