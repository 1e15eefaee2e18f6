/* The MADE chunk: how a recording was made, for people. */
#ifndef RHEO__RECORD_MADE_H
#define RHEO__RECORD_MADE_H

#include "record/chunk.h"

typedef struct rheo__made {
    char *by, *scene; /* from malloc; NULL: the recording has no such chunk */
    bool refused;     /* a text was too long or not printable; both are empty */
} rheo__made;

/* Writes the chunk; nothing if both texts are empty or NULL. RHEO_ERROR_ARGUMENT if one is too long or not printable. */
rheo_result rheo__made_write(rheo__writer *writer, const char *made_by, const char *scene_text, rheo_error *error);
/* Reads the chunk. Nothing needs to be released after a failure. */
rheo_result rheo__made_get(rheo__cursor *cursor, rheo__made *made, rheo_error *error);
void rheo__made_release(rheo__made *made);

#endif
