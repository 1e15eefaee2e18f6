/*
 * Definitions in recordings: the values of all parameters by path, the points of a curve as parameters that repeat, the
 * walls, and the positions of the vibrators. A later version may have more parameters; one that a file does not have keeps
 * its default. Paths of materials and emitters have their names, materials.NAME.springs.stiffness; the order in which the
 * names appear is that of the items.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "record/head.h"
#include "world/model_list.h"

static bool has_default(const rheo_world_def *def, const rheo_parameter *parameter)
{
    const rheo_world_def defaults = rheo_default_world_def();
    double values[3] = {0, 0, 0}, usual[3] = {0, 0, 0};
    rheo__parameter_values(def, parameter, values);
    rheo__parameter_values(&defaults, parameter, usual);
    return values[0] == usual[0] && values[1] == usual[1] && values[2] == usual[2];
}

/* Parameters that came later. A file has them only where they differ from their defaults. */
static bool is_optional(const char *path)
{
    static const char *const groups[] = {"ball.push", "history.lag", "history.of", "plates.", "positions.", "space."};
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
        if (strncmp(path, groups[i], strlen(groups[i])) == 0)
            return true;
    return false;
}

/*
 * Whether a file has a parameter: those of its model that are numbers. `model` itself is omitted for the default model, and
 * optional parameters with their defaults, so that older programs read the file.
 */
static bool is_put(const rheo_world_def *def, const rheo_parameter *parameter)
{
    const rheo__parameter_row *of_obstacle = rheo__obstacle_row(parameter);
    if (of_obstacle) /* the shape says that there is one */
        return strcmp(strrchr(parameter->path, '.'), ".shape") == 0 || !rheo__row_has_default(def, of_obstacle);
    return (parameter->models >> def->model & 1) && parameter->type != RHEO_PARAMETER_NAME &&
           (def->model != RHEO__DEFAULT_MODEL || strcmp(parameter->path, "model") != 0) &&
           !(is_optional(parameter->path) && has_default(def, parameter));
}

/* The path of a parameter; that of a listed item with its name. */
static const char *named_path(const rheo_world_def *def, const rheo_parameter *parameter, char *path, size_t size)
{
    const rheo__list *list;
    const uint32_t number = rheo__item_of(parameter, &list);
    if (!number)
        return parameter->path;
    snprintf(path, size, "%s%s.%s", list->group, rheo__list_name(def, list, number), rheo__in_item(parameter->path));
    return path;
}

void rheo__parameters_put(rheo__bytes *bytes, const rheo_world_def *def)
{
    const size_t all = rheo_world_def_parameter_count(def);
    uint32_t count = 0;
    for (size_t i = 0; i < all; i++)
        count += is_put(def, rheo_world_def_parameter_at(def, i));
    rheo__put_u32(bytes, count + def->history.curve_count);
    for (uint32_t i = 0; i < def->history.curve_count; i++) {
        rheo__put_text(bytes, "history.curve");
        rheo__put_u32(bytes, 2);
        rheo__put_f64(bytes, def->history.curve[i].age);
        rheo__put_f64(bytes, def->history.curve[i].weight);
    }
    for (size_t i = 0; i < all; i++) {
        const rheo_parameter *parameter = rheo_world_def_parameter_at(def, i);
        char path[128];
        double values[3];
        if (!is_put(def, parameter))
            continue;
        uint32_t n = rheo__parameter_values(def, parameter, values);
        rheo__put_text(bytes, named_path(def, parameter, path, sizeof path));
        rheo__put_u32(bytes, n);
        for (uint32_t k = 0; k < n; k++)
            rheo__put_f64(bytes, values[k]);
    }
}

void rheo__geometry_put(rheo__bytes *bytes, const rheo_world_def *def)
{
    rheo__put_u32(bytes, def->walls.count);
    for (uint32_t i = 0; i < def->walls.count; i++) {
        for (int axis = 0; axis < 3; axis++)
            rheo__put_f64(bytes, def->walls.plane[i].point[axis]);
        for (int axis = 0; axis < 3; axis++)
            rheo__put_f64(bytes, def->walls.plane[i].normal[axis]);
    }
    rheo__put_u32(bytes, def->vibrators.count);
    for (uint32_t i = 0; i < def->vibrators.count; i++)
        for (int axis = 0; axis < 2; axis++)
            rheo__put_f64(bytes, def->vibrators.position[i][axis]);
}

/* Adds the item of a path, unless the definition has it. Files name items; they do not number them. */
static rheo_result declare_item(rheo_world_def *def, const rheo__list *list, const char *path, rheo_error *error)
{
    const char *name = path + strlen(list->group);
    char text[128];
    rheo_error why;
    snprintf(text, sizeof text, "%.*s", (int)strcspn(name, "."), name);
    for (uint32_t k = 1; k <= rheo__list_count(def, list); k++)
        if (strcmp(rheo__list_name(def, list, k), text) == 0)
            return RHEO_OK;
    if (strlen(text) >= RHEO__ITEM_NAME || list->add(def, text, &why) != RHEO_OK)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the recording cannot have a%s %s \"%.40s\"",
                          strchr("aeiou", list->item[0]) ? "n" : "", list->item, text);
    return RHEO_OK;
}

/* Adds the obstacle of a path, unless the definition has it. Its mesh, if it has one, is in the head. */
static rheo_result declare_obstacle(rheo_world_def *def, const char *path, rheo_error *error)
{
    const int number = rheo__obstacle_number(path);
    const uint32_t count = def->obstacles.count;
    if (number >= 0 && (uint32_t)number < count)
        return RHEO_OK;
    if (number < 0 || (uint32_t)number != count || count >= RHEO_MAX_OBSTACLES)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the recording cannot have a parameter \"%.60s\"", path);
    rheo_obstacle *obstacle = &def->obstacles.list[def->obstacles.count++], mesh = *obstacle;
    *obstacle = rheo_default_obstacle(RHEO_OBSTACLE_SPHERE);
    obstacle->mesh = mesh.mesh;
    return RHEO_OK;
}

/*
 * A curve never changes, so it must be that of the keyframe before, of which `known` points are known. The first
 * keyframe makes the array.
 */
static rheo_result get_curve_point(rheo_world_def *def, uint32_t known, uint32_t index, const double values[2],
                                   rheo_error *error)
{
    const rheo_curve_point point = {values[0], values[1]};
    if (!(point.age - point.age == 0 && point.weight - point.weight == 0))
        return rheo__fail(error, RHEO_ERROR_FORMAT,
                          "damaged: point %u of the recording's history.curve is not finite", index);
    if (known) {
        if (index >= known || def->history.curve[index].age != point.age ||
            def->history.curve[index].weight != point.weight)
            return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the recording has two different curves");
        return RHEO_OK;
    }
    if (index >= RHEO_MAX_CURVE_POINTS)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "the recording has a history.curve of more than %d points",
                          RHEO_MAX_CURVE_POINTS);
    rheo_curve_point *curve = (rheo_curve_point *)(uintptr_t)def->history.curve;
    if (!index)
        def->history.curve = curve = calloc(RHEO_MAX_CURVE_POINTS, sizeof *curve);
    if (!curve)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open the recording");
    curve[index] = point;
    def->history.curve_count = index + 1;
    return RHEO_OK;
}

/* points: those of a curve that have been read. */
static rheo_result get_parameter(rheo__cursor *cursor, rheo_world_def *def, uint32_t known_points, uint32_t *points,
                                 rheo_error *error)
{
    char path[128];
    double values[3] = {0}, known[3];
    rheo__get_text(cursor, path, sizeof path);
    uint32_t n = rheo__get_u32(cursor);
    if (cursor->failed || n > 3)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a parameter of the definition cannot be read");
    for (uint32_t k = 0; k < n; k++)
        values[k] = rheo__get_f64(cursor);
    if (strcmp(path, "history.curve") == 0 && n == 2)
        return get_curve_point(def, known_points, (*points)++, values, error);
    const rheo__list *list = rheo__list_of(path);
    if (list)
        RHEO__TRY(declare_item(def, list, path, error));
    if (rheo__is_of_obstacle(path))
        RHEO__TRY(declare_obstacle(def, path, error));
    const rheo_parameter *parameter = rheo_world_def_parameter_find(def, path);
    if (!parameter || n != rheo__parameter_values(def, parameter, known))
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED,
                          "the recording has a parameter \"%s\" of %u numbers, which rheolog " RHEO_VERSION
                          " does not know; a newer one does",
                          path, n);
    rheo_error why;
    if (rheo__parameter_assign(def, parameter, values, &why) != RHEO_OK)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "the recording has a bad parameter: %s", why.message);
    return RHEO_OK;
}

rheo_result rheo__parameters_get(rheo__cursor *cursor, rheo_world_def *def, rheo_error *error)
{
    const uint32_t count = rheo__get_u32(cursor), known = def->history.curve_count;
    uint32_t points = 0;
    for (uint32_t i = 0; i < count; i++)
        RHEO__TRY(get_parameter(cursor, def, known, &points, error));
    if (points < known)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the recording has two different curves");
    if (cursor->failed)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the definition in the recording ends early");
    return RHEO_OK;
}

/* Reads the number of items of `size` bytes of an array and makes the array, at least 1 item. */
static rheo_result get_array(rheo__cursor *cursor, const char *items, uint32_t most, size_t size, uint32_t *count,
                             void **array, rheo_error *error)
{
    const uint32_t given = rheo__get_u32(cursor);
    if (given > most)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "the recording has %u %s; at most %u are possible", given, items,
                          most);
    *array = calloc(given + (size_t)1, size);
    if (!*array)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open the recording");
    *count = given;
    return RHEO_OK;
}

rheo_result rheo__geometry_get(rheo__cursor *cursor, rheo_world_def *def, rheo_error *error)
{
    void *array;
    RHEO__TRY(get_array(cursor, "walls", RHEO_MAX_WALLS, sizeof *def->walls.plane, &def->walls.count, &array, error));
    rheo_wall *plane = array;
    def->walls.plane = plane;
    for (uint32_t i = 0; i < def->walls.count; i++) {
        for (int axis = 0; axis < 3; axis++)
            plane[i].point[axis] = rheo__get_f64(cursor);
        for (int axis = 0; axis < 3; axis++)
            plane[i].normal[axis] = rheo__get_f64(cursor);
    }
    RHEO__TRY(get_array(cursor, "vibrators", RHEO_MAX_VIBRATORS, sizeof *def->vibrators.position,
                        &def->vibrators.count, &array, error));
    double(*position)[2] = array;
    def->vibrators.position = array;
    for (uint32_t i = 0; i < def->vibrators.count; i++)
        for (int axis = 0; axis < 2; axis++)
            position[i][axis] = rheo__get_f64(cursor);
    if (cursor->failed)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the definition in the recording ends early");
    return RHEO_OK;
}

/* ---- Meshes of obstacles ---- */

bool rheo__has_meshes(const rheo_world_def *def)
{
    for (uint32_t k = 0; k < def->obstacles.count; k++)
        if (def->obstacles.list[k].mesh.triangle_count)
            return true;
    return false;
}

void rheo__meshes_put(rheo__bytes *bytes, const rheo_world_def *def)
{
    rheo__put_u32(bytes, def->obstacles.count);
    for (uint32_t k = 0; k < def->obstacles.count; k++) {
        const rheo_obstacle *o = &def->obstacles.list[k];
        rheo__put_u32(bytes, o->mesh.vertex_count);
        for (size_t i = 0; i < 3 * (size_t)o->mesh.vertex_count; i++)
            rheo__put_f64(bytes, o->mesh.vertex[i / 3][i % 3]);
        rheo__put_u32(bytes, o->mesh.triangle_count);
        for (size_t i = 0; i < 3 * (size_t)o->mesh.triangle_count; i++)
            rheo__put_u32(bytes, o->mesh.triangle[i / 3][i % 3]);
    }
}

rheo_result rheo__meshes_get(rheo__cursor *cursor, rheo_world_def *def, rheo_error *error)
{
    const uint32_t count = rheo__get_u32(cursor);
    if (cursor->failed || count > RHEO_MAX_OBSTACLES)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "the recording has %u obstacles; at most %d are possible", count,
                          RHEO_MAX_OBSTACLES);
    for (uint32_t k = 0; k < count; k++) {
        rheo_obstacle *o = &def->obstacles.list[k];
        void *array;
        RHEO__TRY(get_array(cursor, "vertices of a mesh", RHEO_MAX_OBSTACLE_VERTICES, sizeof *o->mesh.vertex,
                            &o->mesh.vertex_count, &array, error));
        double(*vertex)[3] = array;
        o->mesh.vertex = array;
        for (size_t i = 0; i < 3 * (size_t)o->mesh.vertex_count; i++)
            vertex[i / 3][i % 3] = rheo__get_f64(cursor);
        RHEO__TRY(get_array(cursor, "triangles of a mesh", RHEO_MAX_OBSTACLE_TRIANGLES, sizeof *o->mesh.triangle,
                            &o->mesh.triangle_count, &array, error));
        uint32_t(*triangle)[3] = array;
        o->mesh.triangle = array;
        for (size_t i = 0; i < 3 * (size_t)o->mesh.triangle_count; i++)
            triangle[i / 3][i % 3] = rheo__get_u32(cursor);
    }
    return RHEO_OK;
}

void rheo__geometry_release(rheo_world_def *def)
{
    free((void *)(uintptr_t)def->walls.plane);
    free((void *)(uintptr_t)def->vibrators.position);
    free((void *)(uintptr_t)def->history.curve);
    for (uint32_t k = 0; k < RHEO_MAX_OBSTACLES; k++) {
        free((void *)(uintptr_t)def->obstacles.list[k].mesh.vertex);
        free((void *)(uintptr_t)def->obstacles.list[k].mesh.triangle);
    }
}
