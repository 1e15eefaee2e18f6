/*
 * Shared by the readers of OBJ and PLY. Files are untrusted: every number, index and length is checked, and no
 * allocation depends on a count in the header. Messages name the line or byte.
 */
#ifndef RHEO__SCENES_MESH_READER_H
#define RHEO__SCENES_MESH_READER_H

#include "core/error.h"
#include "scenes/mesh.h"

typedef struct rheo__mesh_reader {
    rheo__mesh *mesh;
    const char *begin, *at, *end;
    const char *name; /* name of the file, for messages */
    size_t line;
    rheo_error *error;
} rheo__mesh_reader;

rheo_result rheo__mesh_read_obj(rheo__mesh_reader *r);
rheo_result rheo__mesh_read_ply(rheo__mesh_reader *r);

/* ---- Words ---- */

typedef struct rheo__token {
    const char *text;
    size_t length;
} rheo__token;

enum { RHEO__TOKEN = 64 }; /* longest number or name, with its NUL */

/* Next word of the line. It is empty at the end of the line and at a comment. A backslash continues a line. */
rheo__token rheo__mesh_word(rheo__mesh_reader *r);
/* Moves past the end of the line. */
void rheo__mesh_skip_line(rheo__mesh_reader *r);
bool rheo__token_is(const rheo__token *t, const char *word);
bool rheo__token_number(const rheo__token *t, double *value);
/* Copies the printable beginning of a token to `text`, for messages. */
const char *rheo__token_shown(const rheo__token *t, char text[RHEO__TOKEN]);

/* Whether a coordinate is finite and small enough for volumes not to overflow. */
static inline bool rheo__is_coordinate(double x)
{
    return x >= -RHEO__MAX_MESH_COORDINATE && x <= RHEO__MAX_MESH_COORDINATE;
}

/* ---- Polygons ---- */

/* A polygon that is cut into a fan of triangles around its first corner. */
typedef struct rheo__fan {
    uint32_t first, last;
    size_t corners;
} rheo__fan;

/* False: no memory. */
bool rheo__fan_add(rheo__fan *fan, rheo__mesh *mesh, uint32_t vertex);

/* ---- Failures ---- */

/* Fails with RHEO_ERROR_FORMAT and "file:line: message". */
rheo_result rheo__mesh_wrong(const rheo__mesh_reader *r, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
rheo_result rheo__mesh_no_memory(const rheo__mesh_reader *r);

#endif
