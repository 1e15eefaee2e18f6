/* Writes scenes without a JSON library. Numbers read back to the same bits. */
#define _POSIX_C_SOURCE 200809L
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "json/file_name.h"
#include "json/json_error.h"
#include "json/json_parameter.h"
#include "json/scene_json_write.h"
#include "rheolog/scene_json.h"

static const char *after_group(const char *path)
{
    const char *dot = strchr(path, '.');
    return dot ? dot + 1 : path;
}

static void write_member(rheo__json *json, const rheo_shape_member *member, const rheo_fill *fill)
{
    const void *value = (const char *)fill + member->offset;
    const double *numbers = value;
    const bool *flag = value;
    switch (member->type) {
    case RHEO_SHAPE_NUMBER:
        rheo__json_number(json, member->name, *numbers);
        break;
    case RHEO_SHAPE_PAIR:
    case RHEO_SHAPE_VECTOR:
        rheo__json_vector(json, member->name, numbers, member->size / sizeof *numbers);
        break;
    case RHEO_SHAPE_TEXT:
    case RHEO_SHAPE_FILE:
        if (member->required || *(const char *)value)
            rheo__json_text(json, member->name, value);
        break;
    case RHEO_SHAPE_NEGATED_FLAG:
        rheo__json_bool(json, member->name, !*flag);
        break;
    }
}

static void write_fill(rheo__json *json, const rheo_fill *fill, rheo_model model)
{
    const rheo_shape *shape = rheo_shape_at(fill->kind);
    rheo__json_begin_object(json, NULL);
    rheo__json_begin_object(json, shape->name);
    for (size_t m = 0; m < shape->member_count; m++) {
        const rheo_shape_member *member = &shape->member[m];
        const bool given = member->given == 0 || *(const bool *)((const char *)fill + member->given);
        if (given && rheo_shape_member_has_model(member, model))
            write_member(json, member, fill);
    }
    rheo__json_end_object(json);
    rheo__json_end_object(json);
}

static void write_plane(rheo__json *json, const double point[3], const double normal[3])
{
    rheo__json_begin_object(json, NULL);
    rheo__json_vector(json, "point", point, 3);
    rheo__json_vector(json, "normal", normal, 3);
    rheo__json_end_object(json);
}

/* Writes the list of a group: shapes, planes, positions, or a curve if there is one. */
static void write_list(rheo__json *json, const rheo_scene *scene, const char *group, size_t length)
{
    const rheo_world_def *def = &scene->world;
    if (strncmp(group, "fluid.", length) == 0) {
        rheo__json_begin_list(json, "shapes");
        for (size_t i = 0; i < scene->fill_count; i++)
            write_fill(json, &scene->fill[i], def->model);
    } else if (strncmp(group, "walls.", length) == 0) {
        rheo__json_begin_list(json, "planes");
        for (size_t i = 0; i < def->walls.count; i++)
            write_plane(json, def->walls.plane[i].point, def->walls.plane[i].normal);
    } else if (strncmp(group, "vibrators.", length) == 0) {
        rheo__json_begin_list(json, "positions");
        for (size_t i = 0; i < def->vibrators.count; i++)
            rheo__json_vector(json, NULL, def->vibrators.position[i], 2);
    } else if (strncmp(group, "history.", length) == 0 && def->history.curve_count) {
        rheo__json_begin_list(json, "curve");
        for (size_t i = 0; i < def->history.curve_count; i++) {
            const double point[2] = {def->history.curve[i].age, def->history.curve[i].weight};
            rheo__json_vector(json, NULL, point, 2);
        }
    } else {
        return;
    }
    rheo__json_end_list(json);
}

static void write_parameter(rheo__json *json, const rheo_scene *scene, const rheo_parameter *p)
{
    char value[128] = "";
    rheo_scene_get(scene, p->path, value, sizeof value);
    rheo__json_parameter(json, after_group(p->path), p, value);
}

/* Length of the group in a path, with its dot; 0: no group. */
static size_t group_length(const char *path)
{
    return (size_t)(after_group(path) - path);
}

static bool is_of_model(const rheo_scene *scene, const rheo_parameter *p)
{
    return (p->models >> scene->world.model & 1) != 0;
}

/* Writes a group with all parameters and lists of the scene's model. `first` is the index of its first parameter. */
static void write_group(rheo__json *json, const rheo_scene *scene, size_t first)
{
    const char *path = rheo_scene_parameter_at(first)->path;
    const size_t length = group_length(path);
    bool any = strncmp(path, "walls.", length) == 0;
    const rheo_parameter *p = NULL;
    for (size_t i = first; (p = rheo_scene_parameter_at(i)) != NULL; i++)
        any = any || (strncmp(p->path, path, length) == 0 && is_of_model(scene, p));
    if (!any)
        return;
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)length - 1, path);
    rheo__json_begin_object(json, name);
    for (size_t i = first; (p = rheo_scene_parameter_at(i)) != NULL; i++)
        if (strncmp(p->path, path, length) == 0 && is_of_model(scene, p))
            write_parameter(json, scene, p);
    write_list(json, scene, path, length);
    rheo__json_end_object(json);
}

static bool group_came_before(size_t index)
{
    const char *path = rheo_scene_parameter_at(index)->path;
    for (size_t i = 0; i < index; i++)
        if (strncmp(rheo_scene_parameter_at(i)->path, path, group_length(path)) == 0)
            return true;
    return false;
}

/* Writes the materials with their own parameters, in the order in which they are numbered. */
static void write_materials(rheo__json *json, const rheo_world_def *def)
{
    if (!def->materials.count)
        return;
    rheo__json_begin_list(json, "materials");
    for (uint32_t k = 1; k <= def->materials.count; k++) {
        const rheo_parameter *p = NULL;
        char path[64], value[128] = "", group[32] = "";
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "name", rheo_world_def_material_name(def, k));
        for (size_t i = 0; (p = rheo_material_parameter_at(i)) != NULL; i++) {
            const char *member = p->path + strlen("materials.NAME.");
            snprintf(path, sizeof path, "materials.%u.%s", (unsigned)k, member);
            rheo_world_def_get(def, path, value, sizeof value);
            if (strcmp(value, "-1") == 0)
                continue;
            const size_t length = group_length(member) - 1;
            if (strlen(group) != length || strncmp(group, member, length) != 0) {
                if (*group)
                    rheo__json_end_object(json);
                snprintf(group, sizeof group, "%.*s", (int)length, member);
                rheo__json_begin_object(json, group);
            }
            rheo__json_parameter(json, after_group(member), p, value);
        }
        if (*group)
            rheo__json_end_object(json);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

/* Writes the obstacles with all parameters that their shapes have. */
static void write_obstacles(rheo__json *json, const rheo_world_def *def)
{
    const rheo_parameter *p = NULL;
    if (!def->obstacles.count)
        return;
    rheo__json_begin_list(json, "obstacles");
    for (uint32_t k = 0; k < def->obstacles.count; k++) {
        const rheo_obstacle *o = &def->obstacles.list[k];
        rheo__json_begin_object(json, NULL);
        rheo__json_begin_object(json, rheo_obstacle_parameter_at(0)->choices[o->shape]);
        if (o->shape == RHEO_OBSTACLE_MESH)
            rheo__json_text(json, "file", o->file);
        for (size_t i = 1; (p = rheo_obstacle_parameter_at(i)) != NULL; i++) {
            char path[64], value[128] = "";
            const char *key = strrchr(p->path, '.') + 1;
            if (!rheo_obstacle_has_parameter(o->shape, p))
                continue;
            snprintf(path, sizeof path, "obstacles.%u.%s", (unsigned)k, key);
            rheo_world_def_get(def, path, value, sizeof value);
            if (p->type == RHEO_PARAMETER_CHOICE)
                rheo__json_bool(json, key, strcmp(value, "true") == 0);
            else
                rheo__json_parameter(json, key, p, value);
        }
        rheo__json_end_object(json);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

/* Writes the emitters. A material has its name, and the temperature of the fluid is left out. */
static void write_emitters(rheo__json *json, const rheo_world_def *def)
{
    if (!def->emitters.count)
        return;
    rheo__json_begin_list(json, "emitters");
    for (uint32_t k = 0; k < def->emitters.count; k++) {
        const rheo_emitter *emitter = &def->emitters.list[k];
        const rheo_parameter *p = NULL;
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "name", emitter->name);
        for (size_t i = 0; (p = rheo_emitter_parameter_at(i)) != NULL; i++) {
            const char *member = p->path + strlen("emitters.NAME.");
            char path[64], value[128] = "", usual[128] = "";
            snprintf(path, sizeof path, "emitters.%u.%s", (unsigned)k + 1, member);
            rheo_world_def_get(def, path, value, sizeof value);
            rheo_emitter_default(p, usual, sizeof usual);
            const bool optional = strcmp(member, "material") == 0 || strcmp(member, "temperature") == 0;
            if (!(p->models >> def->model & 1) || (optional && strcmp(value, usual) == 0))
                continue;
            if (strcmp(member, "material") == 0)
                rheo__json_text(json, member, rheo_world_def_material_name(def, (uint32_t)emitter->material));
            else
                rheo__json_parameter(json, member, p, value);
        }
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

/* Writes the further balls, as groups ball2, ball3, ... */
static void write_balls(rheo__json *json, const rheo_scene *scene)
{
    for (uint32_t number = 2; number <= scene->world.balls.count + 1; number++) {
        const rheo_parameter *p = NULL;
        char path[64];
        snprintf(path, sizeof path, "ball%u", (unsigned)number);
        rheo__json_begin_object(json, path);
        for (size_t i = 0; (p = rheo_ball_parameter_at(i)) != NULL; i++) {
            snprintf(path, sizeof path, "ball%u.%s", (unsigned)number, after_group(p->path));
            write_parameter(json, scene, rheo_scene_parameter_find(path));
        }
        snprintf(path, sizeof path, "ball%u.clearance", (unsigned)number);
        write_parameter(json, scene, rheo_scene_parameter_find(path));
        rheo__json_end_object(json);
    }
}

/* Every parameter, group and list item has its own line. */
enum { SCENE_LINES = 3 };

char *rheo_scene_to_json(const rheo_scene *scene)
{
    char *text = NULL;
    size_t size = 0;
    rheo__json json = {.file = open_memstream(&text, &size), .lines = SCENE_LINES};
    if (!json.file)
        return NULL;
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "scene", scene->name);
    rheo__json_text(&json, "about", scene->about);
    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)) != NULL; i++) {
        if (group_length(p->path) == 0 && is_of_model(scene, p))
            write_parameter(&json, scene, p);
        else if (group_length(p->path) > 0 && !group_came_before(i))
            write_group(&json, scene, i);
    }
    write_materials(&json, &scene->world);
    write_obstacles(&json, &scene->world);
    write_balls(&json, scene);
    write_emitters(&json, &scene->world);
    rheo__json_end_object(&json);
    const bool failed = ferror(json.file) != 0;
    if (fclose(json.file) != 0 || failed) {
        free(text);
        return NULL;
    }
    return text;
}

/* ---- Beside a file ---- */

/*
 * Lets the path of a mesh count from the folder of a file, the first `folder` bytes of `file`. A mesh elsewhere gets its
 * whole path.
 */
static rheo_result count_from(char *path, size_t size, const char *file, size_t folder, rheo_error *error)
{
    char here[4096];
    if (!folder || path[0] == '/' || !strchr(path, '.'))
        return RHEO_OK;
    if (strncmp(path, file, folder) == 0) {
        memmove(path, path + folder, strlen(path + folder) + 1);
        return RHEO_OK;
    }
    if (!getcwd(here, sizeof here) || strlen(here) + strlen(path) + 1 >= size)
        return rheo__json_fail(
            error, RHEO_ERROR_ARGUMENT,
            "cannot write %.160s: the mesh %.160s is in another folder, and its whole path has more "
            "than %zu bytes",
            file, path, size - 1);
    const size_t length = strlen(here);
    memmove(path + length + 1, path, strlen(path) + 1);
    memcpy(path, here, length);
    path[length] = '/';
    return RHEO_OK;
}

rheo_result rheo__scene_to_json_beside(const rheo_scene *scene, const char *path, char **text, rheo_error *error)
{
    rheo_scene told = *scene;
    rheo_fill *fill = malloc(scene->fill_count * sizeof *fill + 1);
    rheo_result result = RHEO_OK;
    *text = NULL;
    if (fill && scene->fill_count)
        memcpy(fill, scene->fill, scene->fill_count * sizeof *fill);
    told.fill = fill;
    const size_t folder = (size_t)(rheo__json_file_name(path) - path);
    for (size_t i = 0; fill && i < scene->fill_count; i++) {
        const rheo_shape *shape = rheo_shape_at(fill[i].kind);
        for (size_t m = 0; m < shape->member_count && result == RHEO_OK; m++)
            if (shape->member[m].type == RHEO_SHAPE_FILE)
                result = count_from((char *)&fill[i] + shape->member[m].offset, shape->member[m].size, path, folder,
                                    error);
    }
    for (uint32_t k = 0; k < told.world.obstacles.count && result == RHEO_OK; k++) {
        rheo_obstacle *o = &told.world.obstacles.list[k];
        if (o->shape == RHEO_OBSTACLE_MESH)
            result = count_from(o->file, sizeof o->file, path, folder, error);
    }
    if (result == RHEO_OK)
        *text = fill ? rheo_scene_to_json(&told) : NULL;
    free(fill);
    if (result == RHEO_OK && !*text)
        return rheo__json_fail(error, RHEO_ERROR_MEMORY, "no memory to write %s", path);
    return result;
}
