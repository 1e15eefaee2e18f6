/* Reads the lists of named items: materials and emitters. */
#include "json/scene_json_listed.h"

#include <stdio.h>
#include <string.h>

#include "json/scene_json_shape.h"

/* ---- Materials ---- */

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

/* ---- Emitters ---- */

/* Reads the name of a material as its number. */
static rheo_result read_material_name(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                      rheo_emitter *emitter)
{
    rheo_scene *scene = r->user;
    char name[64];
    uint32_t number;
    rheo_result result = rheo__json_read_text(r, at, value, name, sizeof name);
    if (result == RHEO_OK && !rheo_world_def_material(&scene->world, name, &number))
        result = rheo__json_refuse(r, at, "there is no material \"%s\"; list it under \"materials\"", name);
    if (result == RHEO_OK)
        emitter->material = number;
    return result;
}

/* Reads a key of the emitter whose number is the count of emitters. */
static rheo_result read_emitter_key(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    rheo_scene *scene = r->user;
    const uint32_t number = scene->world.emitters.count;
    const char *known[RHEO__JSON_MAX_MEMBERS] = {"name"}, *name;
    const rheo_parameter *p = NULL;
    char path[96], all[320] = "an emitter has name";
    size_t count = 1;
    snprintf(path, sizeof path, "emitters.%u.%.40s", number, at->key);
    if (strcmp(at->key, "material") == 0 && scene->world.model == RHEO_MODEL_THICKENING)
        return read_material_name(r, at, value, &scene->world.emitters.list[number - 1]);
    if ((p = rheo_world_def_parameter_find(&scene->world, path)) != NULL)
        return rheo__scene_read_parameter(r, at, value, p);
    for (size_t i = 0; (p = rheo_emitter_parameter_at(i)) != NULL; i++) {
        known[count++] = name = p->path + strlen("emitters.NAME.");
        snprintf(all + strlen(all), sizeof all - strlen(all), ", %s", name);
    }
    return rheo__json_unknown_key(r, at, at->key, known, count, all);
}

rheo_result rheo__scene_read_emitter(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    rheo_scene *scene = r->user;
    rheo_emitter emitter = rheo_default_emitter("");
    rheo_error error = {""};
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    if (!json_is_object(value))
        return rheo__json_refuse(r, at, "must be an object {...}; got %s", rheo__json_kind(value));
    if (!json_object_get(value, "name") || !json_object_get(value, "position"))
        return rheo__json_refuse(r, at, "\"%s\" is missing", json_object_get(value, "name") ? "position" : "name");
    json_object_foreach((json_t *)value, key, item)
    {
        const rheo__json_place here = {at, key, index++};
        if (strcmp(key, "name") != 0)
            continue;
        rheo_result result = rheo__json_read_text(r, &here, item, emitter.name, sizeof emitter.name);
        if (result == RHEO_OK)
            result = rheo__scene_added(r, &here, rheo_world_def_add_emitter(&scene->world, &emitter, &error), &error);
        if (result != RHEO_OK)
            return result;
    }
    index = 0;
    json_object_foreach((json_t *)value, key, item)
    {
        const rheo__json_place here = {at, key, index++};
        if (strcmp(key, "name") == 0 || rheo__json_is_ignored(key))
            continue;
        const rheo_result result = read_emitter_key(r, &here, item);
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}
