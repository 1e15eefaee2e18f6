/*
 * Reads scenes. A path in the JSON file is the path of a parameter: {"fluid": {"support": 4}} is fluid.support. The
 * other keys (names, shapes, planes, boxes, positions, grids, curves) are in the table `specials`. Shapes are read with the
 * rows of their members.
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "rheolog/scene_json.h"
#include "json/file_name.h"
#include "json/scene_json_listed.h"
#include "json/scene_json_shape.h"

/* ---- Walls ---- */

static const char *const side_names[6] = {"bottom", "top", "left", "right", "back", "front"};
static const size_t side_axes[6] = {1, 1, 0, 0, 2, 2};

static rheo_result read_sides(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                              void *target, size_t size)
{
    unsigned *sides = target;
    (void)size;
    static const char right[] =
        "must be a list of some of \"top\", \"bottom\", \"left\", \"right\", \"front\", \"back\"";
    if (!json_is_array(value))
        return rheo__json_refuse(r, at, "%s; got %s", right, rheo__json_kind(value));
    for (size_t i = 0; i < json_array_size(value); i++) {
        const rheo__json_place element = {at, NULL, i};
        const char *name = json_string_value(json_array_get(value, i));
        size_t side = 0;
        while (side < 6 && (!name || strcmp(name, side_names[side]) != 0))
            side++;
        if (side == 6)
            return rheo__json_refuse(r, &element, "%s", right);
        *sides |= 1u << side;
    }
    return RHEO_OK;
}

static rheo_result check_order(const rheo__json_reader *r, const rheo__json_place *at, const double *min,
                               const double *max, size_t count)
{
    char low[32], high[32];
    for (size_t i = 0; i < count; i++)
        if (min[i] > max[i]) {
            rheo_number_text(min[i], low);
            rheo_number_text(max[i], high);
            return rheo__json_refuse(r, at, "no number of \"min\" may be above that of \"max\"; %s and %s are", low,
                                     high);
        }
    return RHEO_OK;
}

static rheo_result add_wall(const rheo__json_reader *r, const rheo__json_place *at, const double point[3],
                            const double normal[3])
{
    const rheo_wall wall = {{point[0], point[1], point[2]}, {normal[0], normal[1], normal[2]}};
    rheo_error error;
    return rheo__scene_added(r, at, rheo_scene_add_wall(r->user, &wall, &error), &error);
}

static rheo_result read_plane(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
    rheo__json_member members[] = {{"point", rheo__json_read_numbers, point, 3, true, false},
                                   {"normal", rheo__json_read_numbers, normal, 3, true, false}};
    const rheo_result result = rheo__json_read_members(r, at, value, members, sizeof members / sizeof members[0]);
    if (result != RHEO_OK)
        return result;
    if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0)
        return rheo__json_refuse(r, at, "normal must not be [0, 0, 0]; it points to the side of the fluid");
    return add_wall(r, at, point, normal);
}

/* Reads a box: planes whose normals point inwards. */
static rheo_result read_box(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    double corner[2][3] = {{0, 0, 0}, {0, 0, 0}};
    unsigned open = 0;
    rheo__json_member members[] = {{"min", rheo__json_read_numbers, corner[0], 3, true, false},
                                   {"max", rheo__json_read_numbers, corner[1], 3, true, false},
                                   {"open", read_sides, &open, 1, false, false}};
    rheo_result result = rheo__json_read_members(r, at, value, members, sizeof members / sizeof members[0]);
    if (result == RHEO_OK)
        result = check_order(r, at, corner[0], corner[1], 3);
    for (size_t side = 0; side < 6 && result == RHEO_OK; side++) {
        if (open & 1u << side)
            continue;
        double normal[3] = {0, 0, 0};
        normal[side_axes[side]] = side % 2 ? -1 : 1;
        result = add_wall(r, at, corner[side % 2], normal);
    }
    return result;
}

/* ---- Vibrators ---- */

static rheo_result add_vibrator(const rheo__json_reader *r, const rheo__json_place *at, const double position[2])
{
    rheo_error error;
    return rheo__scene_added(r, at, rheo_scene_add_vibrator(r->user, position[0], position[1], &error), &error);
}

static rheo_result read_position(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    double position[2];
    const rheo_result result = rheo__json_read_numbers(r, at, value, position, 2);
    return result == RHEO_OK ? add_vibrator(r, at, position) : result;
}

static rheo_result read_grid(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    double min[2], max[2], spacing;
    rheo__json_member members[] = {{"min", rheo__json_read_numbers, min, 2, true, false},
                                   {"max", rheo__json_read_numbers, max, 2, true, false},
                                   {"spacing", rheo__json_read_number, &spacing, 1, true, false}};
    rheo_result result = rheo__json_read_members(r, at, value, members, sizeof members / sizeof members[0]);
    if (result == RHEO_OK)
        result = check_order(r, at, min, max, 2);
    if (result == RHEO_OK && !(spacing > 0)) {
        char number[32];
        rheo_number_text(spacing, number);
        result = rheo__json_refuse(r, at, "spacing must be more than 0; got %s", number);
    }
    if (result != RHEO_OK)
        return result;
    uint32_t count[2] = {0, 0};
    for (size_t i = 0; i < 2; i++) {
        const double exact = (max[i] - min[i]) / spacing + .5;
        if (!(exact < RHEO_MAX_VIBRATORS + 1))
            return rheo__json_refuse(r, at, "a scene has at most %d vibrators; make \"spacing\" larger",
                                     RHEO_MAX_VIBRATORS);
        count[i] = (uint32_t)exact;
    }
    for (uint32_t k = 0; k < count[1] && result == RHEO_OK; k++)
        for (uint32_t i = 0; i < count[0] && result == RHEO_OK; i++) {
            const double position[2] = {min[0] + (i + .5) * spacing, min[1] + (k + .5) * spacing};
            result = add_vibrator(r, at, position);
        }
    return result;
}

/* ---- The curve of the history ---- */

static rheo_result read_curve_point(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    double point[2] = {0, 0};
    rheo_error error;
    const rheo_result result = rheo__json_read_numbers(r, at, value, point, 2);
    return result == RHEO_OK
               ? rheo__scene_added(r, at, rheo_scene_add_curve_point(r->user, point[0], point[1], &error), &error)
               : result;
}

/* A list that is there is a curve, so it must not be empty. */
static rheo_result read_curve(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    const rheo_result result = rheo__json_read_list(r, at, value, read_curve_point);
    if (result == RHEO_OK && json_array_size(value) < 2)
        return rheo__json_refuse(r, at, "must have at least 2 points [age, weight]; got %zu", json_array_size(value));
    return result;
}

/* ---- Keys that are not parameters ---- */

static rheo_result read_scene_name(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    rheo_scene *scene = r->user;
    return rheo__json_read_text(r, at, value, scene->name, sizeof scene->name);
}

static rheo_result read_about(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    rheo_scene *scene = r->user;
    return rheo__json_read_text(r, at, value, scene->about, sizeof scene->about);
}

/* Emitters name materials, which may follow in the file: read_emitters() reads them at the end. */
static rheo_result read_emitters_later(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value)
{
    (void)r;
    (void)at;
    (void)value;
    return RHEO_OK;
}

static rheo_result read_emitters(const rheo__json_reader *r, json_t *file)
{
    const rheo__json_place top = {NULL, NULL, 0};
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    json_object_foreach(file, key, item)
    {
        const rheo__json_place here = {&top, key, index++};
        if (strcmp(key, "emitters") == 0)
            return rheo__json_read_list(r, &here, item, rheo__scene_read_emitter);
    }
    return RHEO_OK;
}

typedef rheo_result read_function(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value);

/* `read` reads the value; if `element` is set, the value is a list and `element` reads each element. */
typedef struct special {
    const char *path;
    read_function *read, *element;
    const char *parameter; /* the key exists in the models of this parameter; NULL: in all models */
} special;

static const special specials[] = {
    {"scene", read_scene_name, NULL, NULL},
    {"about", read_about, NULL, NULL},
    {"model", NULL, NULL, NULL}, /* read_model() has already read it */
    {"fluid.shapes", NULL, rheo__scene_read_shape, NULL},
    {"materials", NULL, rheo__scene_read_material, "springs.stiffness"},
    {"obstacles", NULL, rheo__scene_read_obstacle, NULL},
    {"emitters", read_emitters_later, NULL, NULL},
    {"walls.planes", NULL, read_plane, NULL},
    {"walls.boxes", NULL, read_box, NULL},
    {"vibrators.positions", NULL, read_position, "vibrators.kind"},
    {"vibrators.grid", read_grid, NULL, "vibrators.kind"},
    {"history.curve", read_curve, NULL, "history.kind"},
};

enum { SPECIALS = sizeof specials / sizeof *specials };

static const special *find_special(const char *path)
{
    for (size_t i = 0; i < SPECIALS; i++)
        if (strcmp(specials[i].path, path) == 0)
            return &specials[i];
    return NULL;
}

/* Refuses a parameter that the model does not have, even with its default value. */
static rheo_result check_model(const rheo__json_reader *r, const rheo__json_place *at, const rheo_parameter *p)
{
    rheo_scene *scene = r->user;
    rheo_error error = {""};
    if (p->models >> scene->world.model & 1)
        return RHEO_OK;
    rheo_scene_set(scene, p->path, "", &error);
    return rheo__json_refuse(r, at, "%s", error.message);
}

static rheo_result read_special(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                const special *key)
{
    if (key->parameter) {
        const rheo_result result = check_model(r, at, rheo_scene_parameter_find(key->parameter));
        if (result != RHEO_OK)
            return result;
    }
    if (key->element)
        return rheo__json_read_list(r, at, value, key->element);
    return key->read ? key->read(r, at, value) : RHEO_OK;
}

/* Reads the model before all other keys, because their defaults depend on it. */
static rheo_result read_model(const rheo__json_reader *r, json_t *file)
{
    rheo_scene *scene = r->user;
    const rheo__json_place top = {NULL, NULL, 0};
    const char *key = NULL, *name = NULL;
    json_t *item = NULL;
    char names[256] = "";
    size_t index = 0;
    json_object_foreach(file, key, item)
    {
        const rheo__json_place here = {&top, key, index++};
        if (strcmp(key, "model") != 0)
            continue;
        const char *text = json_string_value(item);
        for (uint32_t model = 0; (name = rheo_model_name((rheo_model)model)) != NULL; model++) {
            if (text && strcmp(text, name) == 0) {
                rheo_scene defaults = rheo_default_model_scene((rheo_model)model);
                memcpy(defaults.name, scene->name, sizeof defaults.name);
                *scene = defaults;
                return RHEO_OK;
            }
            const size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s\"%s\"", used ? " or " : "", name);
        }
        return rheo__json_refuse(r, &here, "must be %s", names);
    }
    return RHEO_OK;
}

/* ---- Parameters ---- */

rheo_result rheo__scene_read_parameter(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                       const rheo_parameter *p)
{
    rheo_scene *scene = r->user;
    char buffer[128], words[256], component[3][32];
    const char *text = buffer;
    double v[3] = {0, 0, 0};
    rheo_error error = {""};
    rheo_result result = check_model(r, at, p);
    if (result != RHEO_OK)
        return result;
    if (p->type == RHEO_PARAMETER_VECTOR) {
        result = rheo__json_read_numbers(r, at, value, v, 3);
        for (size_t i = 0; i < 3; i++)
            rheo_number_text(v[i], component[i]);
        snprintf(buffer, sizeof buffer, "[%s, %s, %s]", component[0], component[1], component[2]);
    } else if (p->type == RHEO_PARAMETER_CHOICE) {
        text = json_string_value(value);
        if (!text)
            result = rheo__json_refuse(r, at, "must be one of the words %s, in quotes; got %s",
                                       rheo_parameter_words(p, words, sizeof words), rheo__json_kind(value));
    } else if (p->type == RHEO_PARAMETER_WINDOW && json_is_string(value)) {
        text = json_string_value(value);
    } else if (p->type == RHEO_PARAMETER_WINDOW && !json_is_number(value)) {
        result = rheo__json_refuse(r, at, "must be a number of steps, or a time as \"2.5 s\"; got %s",
                                   rheo__json_kind(value));
    } else {
        result = rheo__json_read_number(r, at, value, v, 1);
        rheo_number_text(v[0], buffer);
    }
    if (result != RHEO_OK)
        return result;
    if (rheo_scene_set(scene, p->path, text, &error) != RHEO_OK)
        return rheo__json_refuse(r, at, "%s", error.message);
    return RHEO_OK;
}

/* ---- The file ---- */

/* A group such as "ball2", or a key in it. */
static bool is_further_ball(const char *path)
{
    return strncmp(path, "ball", 4) == 0 && path[4] >= '1' && path[4] <= '9';
}

/* Refuses a key, and names the nearest key, or the new name of an old key. */
static rheo_result unknown_key(const rheo__json_reader *r, const rheo__json_place *at, const char *path)
{
    const char *known[SPECIALS + 1] = {rheo_scene_parameter_nearest(path)}, *now = rheo_parameter_new_name(path);
    rheo_error error = {""};
    if (is_further_ball(path) && rheo_scene_set(r->user, path, "", &error) != RHEO_OK)
        return rheo__json_refuse(r, at, "%s", error.message);
    if (now)
        return rheo__json_refuse(r, at, "\"%s\" is now called \"%s\"", path, now);
    for (size_t i = 0; i < SPECIALS; i++)
        known[i + 1] = specials[i].path;
    return rheo__json_unknown_key(r, at, path, known, SPECIALS + 1, "`rheolog schema` has them all");
}

static bool is_group(const char *key)
{
    const size_t length = strlen(key);
    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)) != NULL; i++)
        if (strncmp(p->path, key, length) == 0 && p->path[length] == '.')
            return true;
    char path[96];
    snprintf(path, sizeof path, "%.64s.radius", key);
    return is_further_ball(key) && rheo_scene_parameter_find(path) != NULL;
}

/* Reads the members of a group, or of the whole file if `group` is NULL. */
static rheo_result read_group(const rheo__json_reader *r, const rheo__json_place *at, json_t *value,
                              const char *group)
{
    if (!json_is_object(value))
        return rheo__json_refuse(r, at, "%s must be an object {...}; got %s", group ? group : "a scene",
                                 rheo__json_kind(value));
    const char *key = NULL;
    json_t *item = NULL;
    size_t index = 0;
    json_object_foreach(value, key, item)
    {
        const rheo__json_place here = {at, key, index++};
        if (rheo__json_is_ignored(key))
            continue;
        char path[96];
        snprintf(path, sizeof path, "%s%s%.80s", group ? group : "", group ? "." : "", key);
        const rheo_parameter *p = rheo_scene_parameter_find(path);
        const special *other = find_special(path);
        rheo_result result = RHEO_OK;
        if (strchr(key, '.'))
            result = rheo__json_refuse(r, &here, "no key has a dot; write \"a.b\": 1 as \"a\": {\"b\": 1}");
        else if (other)
            result = read_special(r, &here, item, other);
        else if (p)
            result = rheo__scene_read_parameter(r, &here, item, p);
        else if (!group && is_group(key))
            result = read_group(r, &here, item, key);
        else
            result = unknown_key(r, &here, path);
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}

/* The default name of the scene in a/b/splash.json is splash. */
static void name_after_file(rheo_scene *scene, const char *file_name)
{
    const char *base = rheo__json_file_name(file_name);
    size_t length = strlen(base) - (rheo__json_ends_with(base, ".json") ? strlen(".json") : 0);
    length = length < sizeof scene->name ? length : sizeof scene->name - 1;
    /* Replaces all but printable ASCII characters, the only ones in a name. */
    for (size_t i = 0; i < length; i++)
        scene->name[i] = base[i] >= 0x20 && base[i] < 0x7f ? base[i] : '_';
    scene->name[length] = 0;
}

/* The message of the parser; that for \u0000 would name an option of the parser. */
static const char *syntax_message(const char *text)
{
    return strncmp(text, "\\u0000 ", 7) == 0 || strncmp(text, "NUL byte", 8) == 0
               ? "a text has the character \\u0000, which nothing in a scene can have; leave it out"
               : text;
}

static rheo_result read_scene(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                              rheo_error *error)
{
    if (size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) { /* some editors write a byte order mark */
        text += 3;
        size -= 3;
    }
    const rheo__json_reader r = {text, text + size, file_name, scene, error};
    const char *nul = size ? memchr(text, 0, size) : NULL; /* jansson accepts some NUL bytes as blanks */
    if (nul)
        return rheo__json_fail(
            error, RHEO_ERROR_ARGUMENT,
            "%s:%zu: there is a byte 0, as in a binary file or in UTF-16; a scene file is text in UTF-8", file_name,
            rheo__json_line(&r, nul));
    if (rheo__json_is_blank(&r))
        return rheo__json_fail(error, RHEO_ERROR_ARGUMENT,
                               "%s:1: there is no text; a scene file holds an object {...}", file_name);
    json_error_t syntax;
    /*
     * All numbers are read as reals. So "-0" keeps its sign, and a very long integer gets a message about its range.
     */
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &syntax);
    if (!root)
        return rheo__json_fail(error, RHEO_ERROR_ARGUMENT, "%s:%d:%d: %s", file_name, syntax.line, syntax.column,
                               syntax_message(syntax.text));
    const rheo__json_place file = {NULL, NULL, 0};
    rheo_result result = read_model(&r, root);
    if (result == RHEO_OK)
        result = read_group(&r, &file, root, NULL);
    if (result == RHEO_OK)
        result = read_emitters(&r, root);
    json_decref(root);
    return result;
}

rheo_result rheo_scene_from_json(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                                 rheo_error *error)
{
    rheo_scene made = rheo_default_scene();
    name_after_file(&made, file_name);
    const rheo_result result = read_scene(text, size, file_name, &made, error);
    if (result == RHEO_OK)
        *scene = made;
    else
        rheo_scene_release(&made);
    return result;
}
