/* Reads obstacles: {"box": {"size": [8, 2, 1], "spin": [0, 3, 0]}}. Their keys are the parameters that a shape has. */
#include <stdio.h>
#include <string.h>

#include "json/scene_json_shape.h"

enum { VALUE = 128, MOST_KEYS = 24 };

/* Reads the value of a parameter as text. */
static rheo_result read_value(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                              const rheo_parameter *p, char text[VALUE])
{
    char number[3][32];
    double v[3] = {0, 0, 0};
    rheo_result result = RHEO_OK;
    if (p->type == RHEO_PARAMETER_CHOICE) { /* of the words false and true */
        if (!json_is_boolean(value))
            return rheo__json_refuse(r, at, "must be true or false; got %s", rheo__json_kind(value));
        snprintf(text, VALUE, "%s", json_is_true(value) ? "true" : "false");
        return RHEO_OK;
    }
    result = p->type == RHEO_PARAMETER_VECTOR ? rheo__json_read_numbers(r, at, value, v, 3)
                                              : rheo__json_read_number(r, at, value, v, 1);
    for (int i = 0; i < 3; i++)
        rheo_number_text(v[i], number[i]);
    if (p->type == RHEO_PARAMETER_VECTOR)
        snprintf(text, VALUE, "[%s, %s, %s]", number[0], number[1], number[2]);
    else
        snprintf(text, VALUE, "%s", number[0]);
    return result;
}

static rheo_result unknown_key(const rheo__json_reader *r, const rheo__json_place *at, const char *key,
                               rheo_obstacle_shape shape)
{
    const char *known[MOST_KEYS] = {"position"};
    size_t count = 1;
    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_obstacle_parameter_at(i)) != NULL && count < MOST_KEYS - 1; i++)
        if (p->type != RHEO_PARAMETER_NAME && rheo_obstacle_has_parameter(shape, p) && !strstr(p->path, ".shape"))
            known[count++] = strrchr(p->path, '.') + 1;
    if (shape == RHEO_OBSTACLE_MESH)
        known[count++] = "file";
    return rheo__json_unknown_key(r, at, key, known, count, "`rheolog scenes --schema` has them all");
}

static rheo_result read_key(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                            uint32_t index)
{
    rheo_scene *scene = r->user;
    rheo_obstacle *obstacle = &scene->world.obstacles.list[index];
    char path[96], text[VALUE] = "";
    rheo_error error = {""};
    if (obstacle->shape == RHEO_OBSTACLE_MESH && strcmp(at->key, "file") == 0) {
        const rheo_result result = rheo__json_read_text(r, at, value, obstacle->file, sizeof obstacle->file);
        return result == RHEO_OK ? rheo__scene_complete_path(r, at, obstacle->file, sizeof obstacle->file) : result;
    }
    snprintf(path, sizeof path, "obstacles.%u.%.40s", (unsigned)index, at->key);
    const rheo_parameter *p = rheo_world_def_parameter_find(&scene->world, path);
    if (!p || strcmp(at->key, "shape") == 0)
        return unknown_key(r, at, at->key, obstacle->shape);
    const rheo_result result = read_value(r, at, value, p, text);
    if (result != RHEO_OK)
        return result;
    if (rheo_scene_set(scene, path, text, &error) != RHEO_OK)
        return rheo__json_refuse(r, at, "%s", error.message);
    return RHEO_OK;
}

static rheo_result read_members(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                rheo_obstacle_shape shape)
{
    rheo_scene *scene = r->user;
    const rheo_obstacle obstacle = rheo_default_obstacle(shape);
    const uint32_t number = scene->world.obstacles.count;
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    rheo_error error;
    rheo_result result =
        rheo__scene_added(r, at, rheo_world_def_add_obstacle(&scene->world, &obstacle, &error), &error);
    if (result == RHEO_OK && !json_is_object(value))
        return rheo__json_refuse(r, at, "must be an object {...}; got %s", rheo__json_kind(value));
    json_object_foreach((json_t *)value, key, item)
    {
        const rheo__json_place here = {at, key, index++};
        if (result == RHEO_OK && !rheo__json_is_ignored(key))
            result = read_key(r, &here, item, number);
    }
    if (result == RHEO_OK && shape == RHEO_OBSTACLE_MESH && !scene->world.obstacles.list[number].file[0])
        return rheo__json_refuse(r, at, "must have a \"file\": \"bunny\", or an .obj or .ply file");
    return result;
}

rheo_result rheo__scene_read_obstacle(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    const rheo_scene *scene = r->user;
    const rheo_parameter *shape = rheo_obstacle_parameter_at(0);
    rheo__json_place inside = {at, NULL, 0};
    if (!(shape->models >> scene->world.model & 1))
        return rheo__json_refuse(r, at, "the model %s has no obstacles", rheo_model_name(scene->world.model));
    const json_t *members = rheo__scene_only_member(value, &inside);
    for (uint32_t i = 0; members && i < shape->choice_count; i++)
        if (strcmp(inside.key, shape->choices[i]) == 0)
            return read_members(r, &inside, members, (rheo_obstacle_shape)i);
    return rheo__json_refuse(
        r, at, "must be {\"sphere\": {...}}, {\"box\": {...}}, {\"cylinder\": {...}} or {\"mesh\": {...}}");
}
