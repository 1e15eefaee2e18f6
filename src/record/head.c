/*
 * The HEAD chunk. Fields and stages are written by name. To check that a world of this build has the same ones, its
 * own are written and the bytes compared. Nothing here is hashed.
 */
#include "record/head.h"

#include <stdlib.h>
#include <string.h>

#include "record/chunk.h"
#include "world/stage_runs.h"

enum { MAX_FIELDS = 64, MAX_NAME = 32 };

/* The fields of a world are in the file in the order of the table, numbered from 0. */
static void put_layout(rheo__bytes *bytes, const rheo_world *world)
{
    uint32_t index[RHEO__FIELD_COUNT], fields = 0;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        index[f] = rheo__state_has(&world->state, f) ? fields++ : 0;
    rheo__put_u32(bytes, fields);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(&world->state, f))
            continue;
        const rheo__field *field = &rheo__field_table[f];
        rheo__put_text(bytes, field->name);
        rheo__put_u32(bytes, (uint32_t)field->element);
        rheo__put_u32(bytes, field->components);
        rheo__put_u32(bytes, (uint32_t)field->location);
        rheo__put_u32(bytes, (uint32_t)field->storage);
    }
    rheo__put_u32(bytes, world->stage_count);
    for (uint32_t s = 0; s < world->stage_count; s++) {
        const rheo__fields writes = world->stage[s].writes;
        rheo__put_text(bytes, world->stage[s].name);
        rheo__put_u32(bytes, (uint32_t)rheo__world_phase(world, s));
        rheo__put_u32(bytes, (uint32_t)__builtin_popcountll(writes));
        for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
            if (writes >> f & 1)
                rheo__put_u32(bytes, index[f]);
    }
}

rheo_result rheo__head_put(rheo__bytes *bytes, const rheo_world *world, const char *scene, uint64_t keyframe_spacing,
                           bool full, rheo_error *error)
{
    scene = scene ? scene : "";
    if (strlen(scene) > UINT16_MAX)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the scene's name has %zu bytes; at most %d are possible",
                          strlen(scene), UINT16_MAX);
    const bool meshes = rheo__has_meshes(&world->def);
    rheo__put_u32(bytes, meshes ? RHEO__FORMAT_VERSION : RHEO__FORMAT_WITHOUT_MESHES);
    rheo__put_u32(bytes, sizeof(rheo_real));
    rheo__put_u32(bytes, full);
    rheo__put_u64(bytes, keyframe_spacing);
    rheo__put_text(bytes, scene);
    rheo__put_text(bytes, rheo_build());
    rheo__put_u32(bytes, world->features);
    rheo__geometry_put(bytes, &world->def);
    put_layout(bytes, world);
    uint32_t metrics = rheo_world_metric_count(world);
    rheo__put_u32(bytes, metrics);
    for (uint32_t i = 0; i < metrics; i++)
        rheo__put_text(bytes, rheo_world_metric_name(world, i));
    if (meshes)
        rheo__meshes_put(bytes, &world->def);
    return RHEO_OK;
}

/* Reads fields and stages, keeps their bytes, and counts the hashes of a step. */
static rheo_result get_layout(rheo__cursor *cursor, rheo__head *head, rheo_error *error)
{
    char name[MAX_NAME];
    size_t start = cursor->offset;
    head->field_count = rheo__get_u32(cursor);
    for (uint32_t i = 0; i < head->field_count && !cursor->failed; i++) {
        rheo__get_text(cursor, name, sizeof name);
        for (int k = 0; k < 4; k++)
            rheo__get_u32(cursor);
    }
    uint32_t stages = rheo__get_u32(cursor), phase = RHEO__BEFORE_SUBSTEPS;
    for (uint32_t i = 0; i < stages && !cursor->failed; i++) {
        rheo__get_text(cursor, name, sizeof name);
        const uint32_t last_phase = phase;
        phase = rheo__get_u32(cursor);
        if (phase < last_phase || phase > RHEO__AFTER_SUBSTEPS)
            cursor->failed = true;
        uint32_t *traced = phase == RHEO__IN_SUBSTEPS ? &head->trace_repeated : &head->trace_once;
        uint32_t writes = rheo__get_u32(cursor);
        for (uint32_t k = 0; k < writes && !cursor->failed; k++, ++*traced)
            if (rheo__get_u32(cursor) >= head->field_count)
                cursor->failed = true;
    }
    if (cursor->failed || head->field_count > MAX_FIELDS)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the recording's fields and stages cannot be read");
    rheo__put_raw(&head->layout, cursor->data + start, cursor->offset - start);
    return RHEO_OK;
}

static rheo_result get_texts(rheo__cursor *cursor, rheo__head *head, rheo_error *error)
{
    size_t room = rheo__cursor_left(cursor) < UINT16_MAX ? rheo__cursor_left(cursor) : UINT16_MAX;
    char **texts[] = {&head->scene, &head->build};
    for (size_t i = 0; i < 2; i++) {
        *texts[i] = malloc(room + 1);
        if (!*texts[i])
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open the recording");
        rheo__get_text(cursor, *texts[i], room + 1);
    }
    return RHEO_OK;
}

static rheo_result get_head(rheo__cursor *cursor, rheo__head *head, rheo_error *error)
{
    head->format = rheo__get_u32(cursor);
    if (head->format > RHEO__FORMAT_VERSION)
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED,
                          "written by a newer rheolog: format %u; this version reads %d; update rheolog",
                          head->format, RHEO__FORMAT_VERSION);
    if (head->format && head->format < RHEO__FORMAT_WITHOUT_MESHES)
        return rheo__fail(
            error, RHEO_ERROR_UNSUPPORTED,
            "written by an older rheolog: format %u; this version reads %d; record it again and bless it",
            head->format, RHEO__FORMAT_VERSION);
    head->real_bytes = rheo__get_u32(cursor);
    uint32_t full = rheo__get_u32(cursor);
    head->full = full;
    head->keyframe_spacing = rheo__get_u64(cursor);
    if (head->format < 1 || full > 1 || (head->real_bytes != 4 && head->real_bytes != 8))
        cursor->failed = true;
    RHEO__TRY(get_texts(cursor, head, error));
    if (cursor->failed)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the head of the recording cannot be read");
    head->def = rheo_default_world_def();
    head->features = rheo__get_u32(cursor);
    RHEO__TRY(rheo__geometry_get(cursor, &head->def, error));
    RHEO__TRY(get_layout(cursor, head, error));
    head->metric_count = rheo__get_u32(cursor);
    if (head->metric_count > rheo__cursor_left(cursor) / 2) /* a name has at least two bytes */
        cursor->failed = true;
    else if (!(head->metrics = calloc(head->metric_count + (size_t)1, sizeof *head->metrics)) || head->layout.failed)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open the recording");
    for (uint32_t i = 0; i < head->metric_count && !cursor->failed; i++)
        rheo__get_text(cursor, head->metrics[i].text, sizeof head->metrics[i].text);
    if (!cursor->failed && head->format > RHEO__FORMAT_WITHOUT_MESHES)
        RHEO__TRY(rheo__meshes_get(cursor, &head->def, error));
    if (cursor->failed || rheo__cursor_left(cursor))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the head of the recording cannot be read");
    return RHEO_OK;
}

rheo_result rheo__head_get(rheo__cursor *cursor, rheo__head *head, rheo_error *error)
{
    memset(head, 0, sizeof *head);
    rheo_result result = get_head(cursor, head, error);
    if (result != RHEO_OK)
        rheo__head_release(head);
    return result;
}

void rheo__head_release(rheo__head *head)
{
    free(head->scene);
    free(head->build);
    free(head->metrics);
    rheo__bytes_release(&head->layout);
    rheo__geometry_release(&head->def);
    memset(head, 0, sizeof *head);
}

rheo_result rheo__head_check_numbers(const rheo__head *head, rheo_error *error)
{
    if (head->real_bytes == sizeof(rheo_real))
        return RHEO_OK;
    const bool is_double = head->real_bytes == 8;
    const char *name[] = {"float", "double"};
    return rheo__fail(error, RHEO_ERROR_UNSUPPORTED,
                      "recorded with %s, this build uses %s; the program %s can read it (a build with -Dreal=%s)",
                      name[is_double], name[!is_double], is_double ? "rheolog-double" : "rheolog", name[is_double]);
}

rheo_result rheo__head_check_world(const rheo__head *head, const rheo_world *world, rheo_error *error)
{
    rheo__bytes own = {0};
    put_layout(&own, world);
    bool failed = own.failed,
         same = !failed && own.size == head->layout.size && memcmp(own.data, head->layout.data, own.size) == 0;
    rheo__bytes_release(&own);
    if (failed)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to compare the stages of the recording");
    if (!same)
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED,
                          "recorded with other stages or fields than this version of rheolog has, by: %s",
                          head->build);
    return RHEO_OK;
}
