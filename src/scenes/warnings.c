/* Takes warnings about a scene. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "scenes/making.h"

const char *rheo_warning_name(rheo_warning_kind kind)
{
    static const char *const NAMES[] = {
#define NAME(KIND, name) name,
        RHEO__WARNINGS(NAME)
#undef NAME
    };
    return (size_t)kind < sizeof NAMES / sizeof *NAMES ? NAMES[kind] : "unknown";
}

rheo_warning rheo__warning_of(rheo_warning_kind kind)
{
    return (rheo_warning){.kind = kind,
                          .shape = -1,
                          .other_shape = -1,
                          .wall = -1,
                          .obstacle = -1,
                          .value = (double)NAN,
                          .limit = (double)NAN};
}

void rheo__warn(rheo__warnings *w, rheo_warning warning, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    rheo__text_vprint(warning.text, sizeof warning.text, format, arguments);
    va_end(arguments);
    if (w->count++ < w->capacity)
        w->list[w->count - 1] = warning;
    if (warning.refused && !w->refusal[0])
        memcpy(w->refusal, warning.text, sizeof w->refusal);
    if (warning.refused || !w->log.message)
        return;
    char text[sizeof warning.text + 16];
    snprintf(text, sizeof text, "warning: %s", warning.text);
    w->log.message(text, w->log.user);
}

rheo_result rheo__refuse(const rheo__warnings *w, rheo_error *error)
{
    return w->refusal[0] ? rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s", w->refusal) : RHEO_OK;
}
