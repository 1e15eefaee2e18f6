/* The HEAD chunk: what was recorded, by whom, and how the rest is to be read. */
#ifndef RHEO_RECORD_HEAD_H
#define RHEO_RECORD_HEAD_H

#include "record/bytes.h"
#include "world/world.h"

enum { RHEO_FORMAT_VERSION = 2 };

/* Definitions (record/definition.c): all parameters; and the walls and sources, which never change. */
void rheo_parameters_put(rheo_bytes *bytes, const rheo_world_def *def);
void rheo_geometry_put(rheo_bytes *bytes, const rheo_world_def *def);
/* Into *def. RHEO_ERROR_FORMAT, or RHEO_ERROR_UNSUPPORTED for parameters that this version does not know. */
rheo_result rheo_parameters_get(rheo_cursor *cursor, rheo_world_def *def, rheo_error *error);
rheo_result rheo_geometry_get(rheo_cursor *cursor, rheo_world_def *def, rheo_error *error);

typedef char rheo_metric_name[48];

typedef struct rheo_head {
    uint32_t format, real_bytes;
    bool full;
    uint64_t keyframe_spacing;
    char *scene, *build;
    uint32_t parts;     /* of the world: rheo_world_make() */
    rheo_world_def def; /* walls and sources; the parameters stand in keyframes */
    rheo_bytes layout;  /* the table of fields and the list of stages, as they stand in the file */
    uint32_t field_count;
    uint32_t trace_once, trace_repeated; /* hashes of a step, and of each of its substeps: see get_layout() */
    rheo_metric_name *metrics;
    uint32_t metric_count;
} rheo_head;

/* Fails if scene is too long, and never else. */
rheo_result rheo_head_put(rheo_bytes *bytes, const rheo_world *world, const char *scene, uint64_t keyframe_spacing,
                          bool full, rheo_error *error);
/* On failure nothing needs to be released. */
rheo_result rheo_head_get(rheo_cursor *cursor, rheo_head *head, rheo_error *error);
void rheo_head_release(rheo_head *head);
/* Whether this build can make worlds of such numbers, and whether this world has the recorded fields and
 * stages. */
rheo_result rheo_head_check_numbers(const rheo_head *head, rheo_error *error);
rheo_result rheo_head_check_world(const rheo_head *head, const rheo_world *world, rheo_error *error);

#endif
