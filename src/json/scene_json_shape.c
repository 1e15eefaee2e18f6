/* Reads shapes with the rows of their members. */
#include "json/scene_json_shape.h"

#include <stdio.h>
#include <string.h>

#include "json/file_name.h"

/* Function and size for reading a member of a shape. */
static rheo__json_member member_of(const rheo_shape_member *row, rheo_fill *fill)
{
    static rheo__json_read *const read[] = {
        [RHEO_SHAPE_NUMBER] = rheo__json_read_number,  [RHEO_SHAPE_PAIR] = rheo__json_read_pair,
        [RHEO_SHAPE_VECTOR] = rheo__json_read_numbers, [RHEO_SHAPE_TEXT] = rheo__json_read_text,
        [RHEO_SHAPE_FILE] = rheo__json_read_text,      [RHEO_SHAPE_NEGATED_FLAG] = rheo__json_read_negated_flag};
    const bool text = row->type == RHEO_SHAPE_TEXT || row->type == RHEO_SHAPE_FILE;
    return (rheo__json_member){.name = row->name,
                               .read = read[row->type],
                               .target = (char *)fill + row->offset,
                               .size = text ? row->size : row->size / sizeof(double),
                               .required = row->required};
}

rheo_result rheo__scene_complete_path(const rheo__json_reader *r, const rheo__json_place *at, char *path, size_t size)
{
    const size_t folder = (size_t)(rheo__json_file_name(r->file) - r->file), length = strlen(path);
    if (!folder || path[0] == '/' || !strchr(path, '.'))
        return RHEO_OK;
    if (folder + length >= size)
        return rheo__json_refuse(
            r, at, "the path \"%.40s\", after the folder of the scene, must have at most %zu bytes", path, size - 1);
    memmove(path + folder, path, length + 1);
    memcpy(path, r->file, folder);
    return RHEO_OK;
}

static rheo_result finish_member(const rheo__json_reader *r, const rheo__json_place *at, const rheo_shape_member *row,
                                 rheo_fill *fill)
{
    const rheo_scene *scene = r->user;
    if (!rheo_shape_member_has_model(row, scene->world.model))
        return rheo__json_refuse(r, at, "%s is no member of shapes in the model %s", row->name,
                                 rheo_model_name(scene->world.model));
    if (row->given)
        *(bool *)((char *)fill + row->given) = true;
    return row->type == RHEO_SHAPE_FILE ? rheo__scene_complete_path(r, at, (char *)fill + row->offset, row->size)
                                        : RHEO_OK;
}

static rheo_result read_shape_members(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                      const rheo_shape *shape, rheo_fill *fill)
{
    const rheo_scene *scene = r->user;
    rheo__json_member members[RHEO__JSON_MAX_MEMBERS];
    for (size_t m = 0; m < shape->member_count; m++)
        members[m] = member_of(&shape->member[m], fill);
    rheo_result result = rheo__json_read_members(r, at, value, members, shape->member_count);
    for (size_t m = 0; m < shape->member_count && result == RHEO_OK; m++)
        if (members[m].given)
            result = finish_member(r, at, &shape->member[m], fill);
    rheo_error error = {""};
    if (result == RHEO_OK && rheo_fill_check(fill, scene->world.model, &error) != RHEO_OK)
        result = rheo__json_refuse(r, at, "%s", error.message);
    return result;
}

/* Lists the forms of a shape: {"block": {...}}, {"sphere": {...}}, ... */
static const char *shape_forms(char *text, size_t size)
{
    const rheo_shape *shape = NULL;
    text[0] = 0;
    for (size_t i = 0; (shape = rheo_shape_at(i)) != NULL; i++) {
        const size_t used = strlen(text);
        const char *between = i == 0 ? "" : rheo_shape_at(i + 1) ? ", " : " or ";
        snprintf(text + used, size - used, "%s{\"%s\": {...}}", between, shape->name);
    }
    return text;
}

rheo_result rheo__scene_added(const rheo__json_reader *r, const rheo__json_place *at, rheo_result result,
                              const rheo_error *error)
{
    if (result == RHEO_ERROR_ARGUMENT)
        return rheo__json_refuse(r, at, "%s", error->message);
    return result == RHEO_OK ? RHEO_OK : rheo__json_fail(r->error, result, "%s", error->message);
}

const json_t *rheo__scene_only_member(const json_t *value, rheo__json_place *place)
{
    const json_t *found = NULL;
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    json_object_foreach((json_t *)value, key, item) /* a value of another kind has no members */
    {
        if (!rheo__json_is_ignored(key)) {
            if (found)
                return NULL;
            found = item;
            place->key = key;
            place->index = index;
        }
        index++;
    }
    return found;
}

rheo_result rheo__scene_read_shape(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    rheo_scene *scene = r->user;
    char forms[512];
    rheo__json_place inside = {at, NULL, 0};
    const json_t *members = rheo__scene_only_member(value, &inside);
    if (!members)
        return rheo__json_refuse(r, at, "must be %s", shape_forms(forms, sizeof forms));
    rheo_fill fill;
    rheo_error error;
    memset(&fill, 0, sizeof fill);
    const rheo_shape *shape = NULL;
    for (size_t kind = 0; (shape = rheo_shape_at(kind)) != NULL; kind++)
        if (strcmp(inside.key, shape->name) == 0) {
            fill.kind = (rheo_fill_kind)kind;
            const rheo_result result = read_shape_members(r, &inside, members, shape, &fill);
            return result == RHEO_OK ? rheo__scene_added(r, at, rheo_scene_add_fill(scene, &fill, &error), &error)
                                     : result;
        }
    return rheo__json_refuse(r, &inside, "unknown shape; a shape must be %s", shape_forms(forms, sizeof forms));
}
