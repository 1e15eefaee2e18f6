/* Error messages (json_error.h). */
#include "json/json_error.h"

#include <stdarg.h>
#include <stdio.h>

rheo_result rheo__json_fail(rheo_error *error, rheo_result result, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
        for (char *c = error->message; *c;) { /* names and words in a file may hold anything */
            const size_t length = rheo_printable_length(c);
            if (length == 0)
                *c = *c == '\n' || *c == '\t' ? ' ' : '?';
            c += length ? length : 1;
        }
    }
    return result;
}
