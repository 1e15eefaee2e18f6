/* Reads the materials of scenes (json/scene_json_material.h). */
#include "json/scene_json_material.h"

#include <stdio.h>
#include <string.h>

#include "json/scene_json_shape.h"

/* Reads "springs" or "history" of the last material: its parameters. */
static rheo_result read_material_group(const rheo__json_reader *r, const rheo__json_place *at, json_t *value)
{
    rheo_scene *scene = r->user;
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    if (!json_is_object(value))
        return rheo__json_refuse(r, at, "must be an object {...}; got %s", rheo__json_kind(value));
    json_object_foreach(value, key, item)
    {
        const rheo__json_place here = {at, key, index++};
        char path[96], text[32];
        double number = 0;
        rheo_error error = {""};
        if (rheo__json_is_ignored(key))
            continue;
        snprintf(path, sizeof path, "materials.%u.%s.%.40s", scene->world.materials.count, at->key, key);
        rheo_result result = RHEO_OK;
        if (rheo_world_def_parameter_find(&scene->world, path))
            result = rheo__json_read_number(r, &here, item, &number, 1);
        if (result != RHEO_OK)
            return result;
        rheo_number_text(number, text);
        if (rheo_scene_set(scene, path, text, &error) != RHEO_OK)
            return rheo__json_refuse(r, &here, "%s", error.message);
    }
    return RHEO_OK;
}

rheo_result rheo__scene_read_material(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    rheo_scene *scene = r->user;
    rheo_material material = rheo_default_material("");
    rheo_error error = {""};
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    if (!json_is_object(value) || !json_object_get(value, "name"))
        return rheo__json_refuse(r, at, "must be an object with a name, {\"name\": \"cornstarch\", ...}; got %s",
                                 json_is_object(value) ? "one without" : rheo__json_kind(value));
    json_object_foreach((json_t *)value, key, item)
    {
        const rheo__json_place here = {at, key, index++};
        if (strcmp(key, "name") != 0)
            continue;
        rheo_result result = rheo__json_read_text(r, &here, item, material.name, sizeof material.name);
        if (result == RHEO_OK)
            result =
                rheo__scene_added(r, &here, rheo_world_def_add_material(&scene->world, &material, &error), &error);
        if (result != RHEO_OK)
            return result;
    }
    index = 0;
    json_object_foreach((json_t *)value, key, item)
    {
        static const char *const known[] = {"name", "springs", "history"};
        const rheo__json_place here = {at, key, index++};
        rheo_result result = RHEO_OK;
        if (strcmp(key, "springs") == 0 || strcmp(key, "history") == 0)
            result = read_material_group(r, &here, item);
        else if (strcmp(key, "name") != 0 && !rheo__json_is_ignored(key))
            result = rheo__json_unknown_key(r, &here, key, known, sizeof known / sizeof *known,
                                            "a material has a name, springs and history");
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}
