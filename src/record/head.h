/* The HEAD chunk: what was recorded, the build that wrote it, and the layout of the other chunks. */
#ifndef RHEO__RECORD_HEAD_H
#define RHEO__RECORD_HEAD_H

#include "record/bytes.h"
#include "world/measure.h"

/* A file is of the first version that has all that it holds. Version 6 has meshes of obstacles. */
enum { RHEO__FORMAT_VERSION = 6, RHEO__FORMAT_WITHOUT_MESHES = 5 };

/* Write a definition (record/definition.c): its parameters; its walls and vibrators, which never change. */
void rheo__parameters_put(rheo__bytes *bytes, const rheo_world_def *def);
void rheo__geometry_put(rheo__bytes *bytes, const rheo_world_def *def);
/*
 * Reads the parameters into *def. RHEO_ERROR_FORMAT, or RHEO_ERROR_UNSUPPORTED for unknown parameters. Makes the curve of
 * a definition that has none, to be released by rheo__geometry_release(), after a failure too; else compares it.
 */
rheo_result rheo__parameters_get(rheo__cursor *cursor, rheo_world_def *def, rheo_error *error);
/* Makes the arrays of walls and vibrators, which are to be released after a failure too. */
rheo_result rheo__geometry_get(rheo__cursor *cursor, rheo_world_def *def, rheo_error *error);
void rheo__geometry_release(rheo_world_def *def);
/* The same for meshes of obstacles, which end the head of a file that has some. */
bool rheo__has_meshes(const rheo_world_def *def);
void rheo__meshes_put(rheo__bytes *bytes, const rheo_world_def *def);
rheo_result rheo__meshes_get(rheo__cursor *cursor, rheo_world_def *def, rheo_error *error);

typedef struct rheo__head {
    uint32_t format, real_bytes;
    bool full;
    uint64_t keyframe_spacing;
    char *scene, *build;
    uint32_t features;  /* features of the world: rheo__world_make() */
    rheo_world_def def; /* walls, vibrators, and the curve of the first keyframe; parameters are in keyframes */
    rheo__bytes layout; /* bytes of the table of fields and the list of stages */
    uint32_t field_count;
    uint32_t trace_once, trace_repeated; /* hashes of the stages that run once in a step, and of each substep */
    rheo__metric_name *metrics;
    uint32_t metric_count;
} rheo__head;

/* Writes the chunk. Fails only if `scene` is too long. */
rheo_result rheo__head_put(rheo__bytes *bytes, const rheo_world *world, const char *scene, uint64_t keyframe_spacing,
                           bool full, rheo_error *error);
/* Reads the chunk. Nothing needs to be released after a failure. */
rheo_result rheo__head_get(rheo__cursor *cursor, rheo__head *head, rheo_error *error);
void rheo__head_release(rheo__head *head);
/* Check that this build has the recorded type of numbers, and that a world has the recorded fields and stages. */
rheo_result rheo__head_check_numbers(const rheo__head *head, rheo_error *error);
rheo_result rheo__head_check_world(const rheo__head *head, const rheo_world *world, rheo_error *error);

#endif
