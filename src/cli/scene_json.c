/*
 * Scenes as JSON. Two parts:
 *
 * 1. A reader. A JSON path is a parameter's path: {"fluid": {"support": 4}} is fluid.support. Keys that are no
 * parameters (names, shapes, planes, boxes, positions, grids) are read by read_special(). jansson parses but keeps no
 * lines, so a bad value is found again by its index in each enclosing object. The text is known to be valid JSON by
 * then, and a walk over it that counts members finds the line.
 * 2. A writer, which needs no JSON library and writes numbers so that they read back to the same bits.
 */
#define _POSIX_C_SOURCE 200809L
#include "cli/scene_json.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static rheo_result fail(rheo_error *error, rheo_result result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static rheo_result fail(rheo_error *error, rheo_result result, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
    }
    return result;
}

static const char *const special_paths[] = {
    "scene",         "about", "model", "fluid.shapes", "walls.planes", "walls.boxes", "vibrators.positions",
    "vibrators.grid"};

enum { SPECIALS = sizeof special_paths / sizeof special_paths[0] };

static const char *after_group(const char *path)
{
    const char *dot = strchr(path, '.');
    return dot ? dot + 1 : path;
}

/* ---- Reading ---- */

#if defined(CLI_HAVE_JANSSON) && CLI_HAVE_JANSSON

#include <jansson.h>

typedef struct reader {
    const char *text, *end, *file;
    rheo_scene *scene;
    rheo_error *error;
} reader;

/* Where a value stands: in which object or list, and the how-manieth it is there. A list's elements have no
 * key. */
typedef struct place {
    const struct place *up; /* NULL: the whole file */
    const char *key;
    size_t ordinal;
} place;

/* The walk: `text` is valid JSON, `p` never passes its end. */

static const char *skip_space(const char *p, const char *end)
{
    while (p < end && (*p == ' ' || *p == '\t' || *p == '\n' || *p == '\r'))
        p++;
    return p;
}

static const char *skip_string(const char *p, const char *end)
{
    for (p++; p < end && *p != '"'; p++)
        if (*p == '\\')
            p++;
    return p < end ? p + 1 : end;
}

/* Past a value of any depth: brackets are counted, not followed, so that deep nesting costs no stack. */
static const char *skip_value(const char *p, const char *end)
{
    size_t depth = 0;
    while (p < end) {
        if (*p == '"') {
            p = skip_string(p, end);
            continue;
        }
        if (*p == '[' || *p == '{') {
            depth++;
        } else if (*p == ']' || *p == '}') {
            if (depth == 0)
                return p; /* of what holds this value */
            depth--;
        } else if (*p == ',' && depth == 0) {
            return p;
        }
        p++;
    }
    return end;
}

static const char *locate(const reader *r, const place *at);

/* Start of the value itself: past the key. */
static const char *locate_value(const reader *r, const place *at)
{
    const char *p = locate(r, at);
    if (at->up && at->key) {
        p = skip_space(skip_string(p, r->end), r->end);
        p = skip_space(p < r->end ? p + 1 : p, r->end); /* the colon */
    }
    return p;
}

/* Start of a member (its key) or of an element. */
static const char *locate(const reader *r, const place *at)
{
    if (!at->up)
        return skip_space(r->text, r->end);
    const char *p = locate_value(r, at->up);
    p = skip_space(p < r->end ? p + 1 : p, r->end); /* the bracket */
    for (size_t i = 0; i < at->ordinal && p < r->end; i++) {
        p = skip_value(p, r->end);
        p = skip_space(p < r->end ? p + 1 : p, r->end); /* the comma */
    }
    return p;
}

static size_t line_of(const reader *r, const char *found)
{
    size_t line = 1;
    for (const char *p = r->text; p < found; p++)
        line += *p == '\n';
    return line;
}

/* Keys come from the file: what a terminal would take for a command is not repeated. */
static void append_key(char *path, size_t size, const char *key)
{
    size_t length = strlen(path), limit = length + 40;
    for (; *key && length + 1 < size && length < limit; key++)
        path[length++] = (unsigned char)*key < 0x20 || *key == 0x7f ? '?' : *key;
    path[length] = 0;
}

static void path_of(const place *at, char *path, size_t size)
{
    path[0] = 0;
    if (!at->up)
        return;
    path_of(at->up, path, size);
    size_t length = strlen(path);
    if (at->key) {
        if (length)
            snprintf(path + length, size - length, ".");
        append_key(path, size, at->key);
    } else {
        snprintf(path + length, size - length, "[%zu]", at->ordinal);
    }
}

static rheo_result refuse(const reader *r, const place *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* `file:line: path: what is wrong`. */
static rheo_result refuse(const reader *r, const place *at, const char *format, ...)
{
    char path[160], message[320];
    path_of(at, path, sizeof path);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    /* What the library says about a parameter mostly begins with its path already. */
    const bool named = path[0] == 0 || strncmp(message, path, strlen(path)) == 0;
    return fail(r->error, RHEO_ERROR_ARGUMENT, "%s:%zu: %s%s%s", r->file, line_of(r, locate(r, at)),
                named ? "" : path, named ? "" : ": ", message);
}

static const char *kind_of(const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object {...}";
    case JSON_ARRAY:
        return "a list [...]";
    case JSON_STRING:
        return "a string";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_TRUE:
    case JSON_FALSE:
        return "true or false";
    case JSON_NULL:
        return "null";
    }
    return "something else";
}

static rheo_result read_number(const reader *r, const place *at, const json_t *value, double *number)
{
    if (!json_is_number(value))
        return refuse(r, at, "must be a number, e.g. 0.5; got %s", kind_of(value));
    *number = json_number_value(value);
    return RHEO_OK;
}

static rheo_result read_numbers(const reader *r, const place *at, const json_t *value, size_t count, double *numbers)
{
    if (!json_is_array(value) || json_array_size(value) != count) {
        char got[48];
        if (json_is_array(value))
            snprintf(got, sizeof got, "a list of %zu", json_array_size(value));
        else
            snprintf(got, sizeof got, "%s", kind_of(value));
        return refuse(r, at, "must be a list of %zu numbers, e.g. %s; got %s", count,
                      count == 2 ? "[0, 2.5]" : "[0, 2.5, 0]", got);
    }
    for (size_t i = 0; i < count; i++) {
        const place element = {at, NULL, i};
        const rheo_result result = read_number(r, &element, json_array_get(value, i), &numbers[i]);
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}

static rheo_result read_parameter(const reader *r, const place *at, const json_t *value, const rheo_parameter *p)
{
    char buffer[128], words[256];
    const char *text = buffer;
    double v[3] = {0, 0, 0};
    rheo_error error = {""};
    rheo_result result = RHEO_OK;
    if (!(p->models >> r->scene->world.model & 1)) {
        rheo_scene_set(r->scene, p->path, "", &error); /* says so, whatever the value is */
        result = refuse(r, at, "%s", error.message);
    } else if (p->type == RHEO_PARAMETER_VECTOR) {
        result = read_numbers(r, at, value, 3, v);
        snprintf(buffer, sizeof buffer, "[%.17g, %.17g, %.17g]", v[0], v[1], v[2]);
    } else if (p->type == RHEO_PARAMETER_CHOICE) {
        text = json_string_value(value);
        if (!text)
            result = refuse(r, at, "must be one of the words %s, in quotes; got %s",
                            rheo_parameter_words(p, words, sizeof words), kind_of(value));
    } else if (p->type == RHEO_PARAMETER_WINDOW && json_is_string(value)) {
        text = json_string_value(value);
    } else if (p->type == RHEO_PARAMETER_WINDOW && !json_is_number(value)) {
        result = refuse(r, at, "must be a number of steps, or a time as \"2.5 s\"; got %s", kind_of(value));
    } else {
        result = read_number(r, at, value, v);
        snprintf(buffer, sizeof buffer, "%.17g", v[0]);
    }
    if (result != RHEO_OK)
        return result;
    if (rheo_scene_set(r->scene, p->path, text, &error) != RHEO_OK)
        return refuse(r, at, "%s", error.message);
    return RHEO_OK;
}

/* ---- Objects with members of fixed names: shapes, planes, boxes, grids ---- */

typedef struct member {
    const char *name;
    size_t count; /* 0: a number, which counts twice, or a list of two; 1: a number; 2, 3: a list of so many */
    double *target;
    bool required;
    unsigned *sides; /* not NULL: a list of the names of sides, as bits */
    bool *flag;      /* not NULL: true or false */
    char *text;      /* not NULL: a string of fewer bytes than `size` */
    size_t size;
    bool given;
} member;

enum { MOST_MEMBERS = 12 };

static const char *const side_names[6] = {"bottom", "top", "left", "right", "back", "front"};
static const size_t side_axes[6] = {1, 1, 0, 0, 2, 2};

static rheo_result read_sides(const reader *r, const place *at, const json_t *value, unsigned *sides)
{
    static const char right[] =
        "must be a list of some of \"top\", \"bottom\", \"left\", \"right\", \"front\", \"back\"";
    if (!json_is_array(value))
        return refuse(r, at, "%s; got %s", right, kind_of(value));
    for (size_t i = 0; i < json_array_size(value); i++) {
        const place element = {at, NULL, i};
        const char *name = json_string_value(json_array_get(value, i));
        size_t side = 0;
        while (side < 6 && (!name || strcmp(name, side_names[side]) != 0))
            side++;
        if (side == 6)
            return refuse(r, &element, "%s", right);
        *sides |= 1u << side;
    }
    return RHEO_OK;
}

static rheo_result read_name(const reader *r, const place *at, const json_t *value, char *target, size_t size)
{
    const char *text = json_string_value(value);
    if (!text)
        return refuse(r, at, "must be a string; got %s", kind_of(value));
    if (strlen(text) >= size)
        return refuse(r, at, "must have at most %zu bytes; got %zu", size - 1, strlen(text));
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            return refuse(r, at, "must be one line of text without control characters");
    memcpy(target, text, strlen(text) + 1);
    return RHEO_OK;
}

static rheo_result read_member(const reader *r, const place *at, const json_t *value, const member *m)
{
    if (m->sides)
        return read_sides(r, at, value, m->sides);
    if (m->text)
        return read_name(r, at, value, m->text, m->size);
    if (m->flag) {
        *m->flag = json_is_true(value);
        return json_is_boolean(value) ? RHEO_OK : refuse(r, at, "must be true or false; got %s", kind_of(value));
    }
    if (m->count == 0 && json_is_number(value)) {
        m->target[0] = m->target[1] = json_number_value(value);
        return RHEO_OK;
    }
    if (m->count == 0 && !json_is_array(value))
        return refuse(r, at, "must be a number or a list of 2 numbers; got %s", kind_of(value));
    return m->count == 1 ? read_number(r, at, value, m->target)
                         : read_numbers(r, at, value, m->count ? m->count : 2, m->target);
}

static rheo_result unknown_member(const reader *r, const place *at, const member *members, size_t count)
{
    const char *names[MOST_MEMBERS];
    for (size_t m = 0; m < count; m++)
        names[m] = members[m].name;
    return refuse(r, at, "unknown key; did you mean \"%s\"?", rheo_nearest_word(at->key, names, count));
}

static rheo_result read_members(const reader *r, const place *at, json_t *value, member *members, size_t count)
{
    if (!json_is_object(value))
        return refuse(r, at, "must be an object {...}; got %s", kind_of(value));
    const char *key = NULL;
    json_t *item = NULL;
    size_t ordinal = 0;
    json_object_foreach(value, key, item)
    {
        const place here = {at, key, ordinal++};
        size_t m = 0;
        while (m < count && strcmp(key, members[m].name) != 0)
            m++;
        if (m == count)
            return unknown_member(r, &here, members, count);
        const rheo_result result = read_member(r, &here, item, &members[m]);
        if (result != RHEO_OK)
            return result;
        members[m].given = true;
    }
    for (size_t m = 0; m < count; m++)
        if (members[m].required && !members[m].given)
            return refuse(r, at, "\"%s\" is missing", members[m].name);
    return RHEO_OK;
}

static rheo_result check_order(const reader *r, const place *at, const double *min, const double *max, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (min[i] > max[i])
            return refuse(r, at, "no number of \"min\" may be above that of \"max\"; %g and %g are", min[i], max[i]);
    return RHEO_OK;
}

/* A function for each element of a list. */
typedef rheo_result element_reader(const reader *r, const place *at, json_t *value);

static rheo_result read_list(const reader *r, const place *at, json_t *value, element_reader *element)
{
    if (!json_is_array(value))
        return refuse(r, at, "must be a list [...]; got %s", kind_of(value));
    for (size_t i = 0; i < json_array_size(value); i++) {
        const place here = {at, NULL, i};
        const rheo_result result = element(r, &here, json_array_get(value, i));
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}

/* ---- Shapes ---- */

/* The members of one kind of shape, and those that all have. */
static rheo_result read_fill(const reader *r, const place *at, json_t *value, rheo_fill *fill, const member *own,
                             size_t count)
{
    bool hydrostatic = true;
    const member common[] = {{.name = "velocity", .count = 3, .target = fill->velocity},
                             {.name = "jitter", .count = 1, .target = &fill->jitter},
                             {.name = "temperature", .count = 0, .target = fill->temperature},
                             {.name = "hydrostatic", .flag = &hydrostatic}};
    enum { COMMON = sizeof common / sizeof *common };
    member members[MOST_MEMBERS];
    memcpy(members, own, count * sizeof *own);
    memcpy(members + count, common, sizeof common);
    const rheo_result result = read_members(r, at, value, members, count + COMMON);
    if (result != RHEO_OK)
        return result;
    fill->not_hydrostatic = !hydrostatic;
    fill->has_temperature = members[count + 2].given;
    for (size_t m = count + 2; m < count + COMMON; m++)
        if (members[m].given && r->scene->world.model != RHEO_MODEL_MELTING)
            return refuse(r, at, "%s is of the model %s; the scene's is %s", members[m].name,
                          rheo_model_name(RHEO_MODEL_MELTING), rheo_model_name(r->scene->world.model));
    return fill->jitter >= 0 && fill->jitter <= .5
               ? RHEO_OK
               : refuse(r, at, "jitter must be a number from 0 to 0.5 (of the spacing); got %g", fill->jitter);
}

#define READ_FILL(members) read_fill(r, at, value, fill, members, sizeof(members) / sizeof *(members))

static rheo_result read_block(const reader *r, const place *at, json_t *value, rheo_fill *fill)
{
    fill->kind = RHEO_FILL_BLOCK;
    const member own[] = {{.name = "min", .count = 3, .target = fill->min, .required = true},
                          {.name = "max", .count = 3, .target = fill->max, .required = true}};
    const rheo_result result = READ_FILL(own);
    return result == RHEO_OK ? check_order(r, at, fill->min, fill->max, 3) : result;
}

static rheo_result read_sphere(const reader *r, const place *at, json_t *value, rheo_fill *fill)
{
    fill->kind = RHEO_FILL_SPHERE;
    const member own[] = {{.name = "centre", .count = 3, .target = fill->centre, .required = true},
                          {.name = "radius", .count = 1, .target = &fill->radius, .required = true}};
    const rheo_result result = READ_FILL(own);
    return result == RHEO_OK && fill->radius < 0 ? refuse(r, at, "radius must be 0 or more; got %g", fill->radius)
                                                 : result;
}

/* A relative path is meant from the folder of the scene file. */
static rheo_result read_mesh(const reader *r, const place *at, json_t *value, rheo_fill *fill)
{
    fill->kind = RHEO_FILL_MESH;
    const member own[] = {{.name = "file", .text = fill->name, .size = sizeof fill->name, .required = true},
                          {.name = "height", .count = 1, .target = &fill->height},
                          {.name = "position", .count = 3, .target = fill->position}};
    const rheo_result result = READ_FILL(own);
    const char *slash = strrchr(r->file, '/');
    if (result != RHEO_OK || !slash || fill->name[0] == '/' || strcmp(fill->name, "bunny") == 0)
        return result;
    const size_t folder = (size_t)(slash - r->file) + 1, length = strlen(fill->name);
    if (folder + length >= sizeof fill->name)
        return refuse(r, at, "the path of the mesh, with the folder of the scene, must have at most %zu bytes",
                      sizeof fill->name - 1);
    memmove(fill->name + folder, fill->name, length + 1);
    memcpy(fill->name, r->file, folder);
    return RHEO_OK;
}

static rheo_result read_letters(const reader *r, const place *at, json_t *value, rheo_fill *fill)
{
    fill->kind = RHEO_FILL_LETTERS;
    const member own[] = {{.name = "text", .text = fill->name, .size = sizeof fill->name, .required = true},
                          {.name = "height", .count = 1, .target = &fill->height, .required = true},
                          {.name = "depth", .count = 1, .target = &fill->depth, .required = true},
                          {.name = "position", .count = 3, .target = fill->position}};
    return READ_FILL(own);
}

static rheo_result read_shape(const reader *r, const place *at, json_t *value)
{
    static const char right[] =
        "must be {\"block\": {...}}, {\"sphere\": {...}}, {\"mesh\": {...}} or {\"letters\": {...}}";
    static const struct {
        const char *name;
        rheo_result (*read)(const reader *r, const place *at, json_t *value, rheo_fill *fill);
    } kinds[] = {{"block", read_block}, {"sphere", read_sphere}, {"mesh", read_mesh}, {"letters", read_letters}};
    if (!json_is_object(value) || json_object_size(value) != 1)
        return refuse(r, at, "%s", right);
    if (r->scene->fill_count == RHEO_MAX_FILLS)
        return refuse(r, at, "a scene has at most %d shapes", RHEO_MAX_FILLS);
    rheo_fill *fill = &r->scene->fill[r->scene->fill_count];
    memset(fill, 0, sizeof *fill);
    const char *key = json_object_iter_key(json_object_iter(value));
    const place inside = {at, key, 0};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (strcmp(key, kinds[k].name) == 0) {
            const rheo_result result = kinds[k].read(r, &inside, json_object_get(value, key), fill);
            r->scene->fill_count += result == RHEO_OK;
            return result;
        }
    return refuse(r, &inside, "unknown shape; a shape %s", right);
}

/* ---- Walls ---- */

static rheo_result add_wall(const reader *r, const place *at, const double point[3], const double normal[3])
{
    if (r->scene->world.walls.count == RHEO_MAX_WALLS)
        return refuse(r, at, "a scene has at most %d walls; a box has up to six", RHEO_MAX_WALLS);
    rheo_wall *wall = &r->scene->world.walls.plane[r->scene->world.walls.count++];
    memcpy(wall->point, point, sizeof wall->point);
    memcpy(wall->normal, normal, sizeof wall->normal);
    return RHEO_OK;
}

static rheo_result read_plane(const reader *r, const place *at, json_t *value)
{
    double point[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
    member members[] = {{.name = "point", .count = 3, .target = point, .required = true},
                        {.name = "normal", .count = 3, .target = normal, .required = true}};
    const rheo_result result = read_members(r, at, value, members, sizeof members / sizeof members[0]);
    if (result != RHEO_OK)
        return result;
    if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0)
        return refuse(r, at, "normal must not be [0, 0, 0]; it points to the side of the fluid");
    return add_wall(r, at, point, normal);
}

/* A container: planes that face inwards. */
static rheo_result read_box(const reader *r, const place *at, json_t *value)
{
    double corner[2][3] = {{0, 0, 0}, {0, 0, 0}};
    unsigned open = 0;
    member members[] = {{.name = "min", .count = 3, .target = corner[0], .required = true},
                        {.name = "max", .count = 3, .target = corner[1], .required = true},
                        {.name = "open", .sides = &open}};
    rheo_result result = read_members(r, at, value, members, sizeof members / sizeof members[0]);
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

static rheo_result add_source(const reader *r, const place *at, const double position[2])
{
    if (r->scene->world.vibrators.count == RHEO_MAX_VIBRATORS)
        return refuse(r, at, "a scene has at most %d vibrators", RHEO_MAX_VIBRATORS);
    memcpy(r->scene->world.vibrators.position[r->scene->world.vibrators.count++], position, 2 * sizeof(double));
    return RHEO_OK;
}

static rheo_result read_position(const reader *r, const place *at, json_t *value)
{
    double position[2] = {0, 0};
    const rheo_result result = read_numbers(r, at, value, 2, position);
    return result == RHEO_OK ? add_source(r, at, position) : result;
}

static rheo_result read_grid(const reader *r, const place *at, json_t *value)
{
    double min[2] = {0, 0}, max[2] = {0, 0}, spacing = 0;
    member members[] = {{.name = "min", .count = 2, .target = min, .required = true},
                        {.name = "max", .count = 2, .target = max, .required = true},
                        {.name = "spacing", .count = 1, .target = &spacing, .required = true}};
    rheo_result result = read_members(r, at, value, members, sizeof members / sizeof members[0]);
    if (result == RHEO_OK)
        result = check_order(r, at, min, max, 2);
    if (result == RHEO_OK && !(spacing > 0))
        result = refuse(r, at, "spacing must be more than 0; got %g", spacing);
    if (result != RHEO_OK)
        return result;
    uint32_t count[2] = {0, 0};
    for (size_t i = 0; i < 2; i++) {
        const double exact = (max[i] - min[i]) / spacing + .5;
        if (!(exact < RHEO_MAX_VIBRATORS + 1))
            return refuse(r, at, "a scene has at most %d vibrators; make \"spacing\" larger", RHEO_MAX_VIBRATORS);
        count[i] = (uint32_t)exact;
    }
    for (uint32_t k = 0; k < count[1] && result == RHEO_OK; k++)
        for (uint32_t i = 0; i < count[0] && result == RHEO_OK; i++) {
            const double position[2] = {min[0] + (i + .5) * spacing, min[1] + (k + .5) * spacing};
            result = add_source(r, at, position);
        }
    return result;
}

static rheo_result read_special(const reader *r, const place *at, json_t *value, const char *path)
{
    rheo_scene *scene = r->scene;
    if (strcmp(path, "scene") == 0)
        return read_name(r, at, value, scene->name, sizeof scene->name);
    if (strcmp(path, "about") == 0)
        return read_name(r, at, value, scene->about, sizeof scene->about);
    if (strcmp(path, "fluid.shapes") == 0)
        return read_list(r, at, value, read_shape);
    if (strcmp(path, "walls.planes") == 0)
        return read_list(r, at, value, read_plane);
    if (strcmp(path, "walls.boxes") == 0)
        return read_list(r, at, value, read_box);
    if (strcmp(path, "model") == 0)
        return RHEO_OK; /* read before everything else */
    if (scene->world.model != RHEO_MODEL_THICKENING)
        return refuse(r, at, "vibrators are of the model %s; the scene's is %s",
                      rheo_model_name(RHEO_MODEL_THICKENING), rheo_model_name(scene->world.model));
    return strcmp(path, "vibrators.positions") == 0 ? read_list(r, at, value, read_position)
                                                    : read_grid(r, at, value);
}

/* Wherever it stands, since everything else has the model's defaults. */
static rheo_result read_model(const reader *r, json_t *file)
{
    const place top = {NULL, NULL, 0};
    const char *key = NULL;
    json_t *item = NULL;
    size_t ordinal = 0;
    json_object_foreach(file, key, item)
    {
        const place here = {&top, key, ordinal++};
        if (strcmp(key, "model") != 0)
            continue;
        const char *text = json_string_value(item);
        if (text && strcmp(text, "thickening") == 0)
            return RHEO_OK;
        if (!text || strcmp(text, "melting") != 0)
            return refuse(r, &here, "must be \"thickening\" or \"melting\"");
        rheo_scene scene = rheo_default_model_scene(RHEO_MODEL_MELTING);
        memcpy(scene.name, r->scene->name, sizeof scene.name);
        *r->scene = scene;
    }
    return RHEO_OK;
}

/* ---- The file ---- */

/* Nearest of the parameters and of the other keys; or the present name of an old one. */
static rheo_result unknown_key(const reader *r, const place *at, const char *path)
{
    const char *known[SPECIALS + 1] = {rheo_scene_parameter_nearest(path)}, *now = rheo_parameter_new_name(path);
    if (now)
        return refuse(r, at, "\"%s\" is now called \"%s\"", path, now);
    memcpy(known + 1, special_paths, sizeof special_paths);
    return refuse(r, at, "unknown key; did you mean \"%s\"?", rheo_nearest_word(path, known, SPECIALS + 1));
}

static bool is_special(const char *path)
{
    for (size_t i = 0; i < SPECIALS; i++)
        if (strcmp(special_paths[i], path) == 0)
            return true;
    return false;
}

static bool is_group(const char *key)
{
    const size_t length = strlen(key);
    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)) != NULL; i++)
        if (strncmp(p->path, key, length) == 0 && p->path[length] == '.')
            return true;
    return false;
}

/* The members of the file (group NULL) or of a group. */
static rheo_result read_group(const reader *r, const place *at, json_t *value, const char *group)
{
    if (!json_is_object(value))
        return refuse(r, at, "%s must be an object {...}; got %s", group ? group : "a scene", kind_of(value));
    const char *key = NULL;
    json_t *item = NULL;
    size_t ordinal = 0;
    json_object_foreach(value, key, item)
    {
        const place here = {at, key, ordinal++};
        char path[96];
        snprintf(path, sizeof path, "%s%s%.80s", group ? group : "", group ? "." : "", key);
        const rheo_parameter *p = rheo_scene_parameter_find(path);
        rheo_result result = RHEO_OK;
        if (strchr(key, '.'))
            result = refuse(r, &here, "no key has a dot; write \"a.b\": 1 as \"a\": {\"b\": 1}");
        else if (is_special(path))
            result = read_special(r, &here, item, path);
        else if (p)
            result = read_parameter(r, &here, item, p);
        else if (!group && is_group(key))
            result = read_group(r, &here, item, key);
        else
            result = unknown_key(r, &here, path);
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}

/* a/b/splash.json is the scene "splash" if it does not say otherwise. */
static void name_after_file(rheo_scene *scene, const char *file_name)
{
    const char *slash = strrchr(file_name, '/');
    const char *base = slash ? slash + 1 : file_name;
    size_t length = strlen(base);
    if (length > 5 && strcmp(base + length - 5, ".json") == 0)
        length -= 5;
    length = length < sizeof scene->name ? length : sizeof scene->name - 1;
    /* What is no plain character, or only a part of one, would be no name in a scene or recording. */
    for (size_t i = 0; i < length; i++)
        scene->name[i] = base[i] >= 0x20 && base[i] < 0x7f ? base[i] : '_';
    scene->name[length] = 0;
}

static rheo_result read_scene(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                              rheo_error *error)
{
    if (size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) { /* the byte order mark of some editors */
        text += 3;
        size -= 3;
    }
    const reader r = {text, text + size, file_name, scene, error};
    const char *nul = size ? memchr(text, 0, size) : NULL; /* jansson takes some for blanks */
    if (nul)
        return fail(error, RHEO_ERROR_ARGUMENT, "%s:%zu: a NUL byte; a scene file is plain text", file_name,
                    line_of(&r, nul));
    json_error_t syntax;
    /* All numbers as reals: "-0" keeps its sign, and no integer is too long to be told what would be right.
     */
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &syntax);
    if (!root) {
        for (char *c = syntax.text; *c; c++)
            if ((unsigned char)*c < 0x20 || *c == 0x7f)
                *c = ' ';
        return fail(error, RHEO_ERROR_ARGUMENT, "%s:%d:%d: %s", file_name, syntax.line, syntax.column, syntax.text);
    }
    const place file = {NULL, NULL, 0};
    rheo_result result = read_model(&r, root);
    if (result == RHEO_OK)
        result = read_group(&r, &file, root, NULL);
    json_decref(root);
    return result;
}

#else

static void name_after_file(rheo_scene *scene, const char *file_name)
{
    (void)scene, (void)file_name;
}

static rheo_result read_scene(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                              rheo_error *error)
{
    (void)text, (void)size, (void)scene;
    return fail(error, RHEO_ERROR_UNSUPPORTED,
                "%s: this program was built without JSON scenes; build it with jansson, or run a built-in scene",
                file_name);
}

#endif

rheo_result cli_scene_from_json(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                                rheo_error *error)
{
    rheo_scene made = rheo_default_scene();
    name_after_file(&made, file_name);
    const rheo_result result = read_scene(text, size, file_name, &made, error);
    if (result == RHEO_OK)
        *scene = made;
    return result;
}

/* ---- Writing ---- */

void cli_json_parameter(cli_json *json, const char *key, const rheo_parameter *parameter, const char *value)
{
    char *end = NULL;
    const double number = strtod(value, &end);
    double v[3] = {0, 0, 0};
    if (parameter->type == RHEO_PARAMETER_VECTOR && sscanf(value, "[%lf, %lf, %lf]", &v[0], &v[1], &v[2]) == 3)
        cli_json_vector(json, key, v, 3);
    else if (parameter->type != RHEO_PARAMETER_CHOICE && end != value && *end == 0)
        cli_json_number(json, key, number);
    else
        cli_json_text(json, key, value);
}

static void write_fill(cli_json *json, const rheo_fill *fill, rheo_model model)
{
    static const char *const KINDS[] = {"block", "sphere", "mesh", "letters"};
    cli_json_begin_object(json, NULL);
    cli_json_begin_object(json, KINDS[fill->kind]);
    switch (fill->kind) {
    case RHEO_FILL_BLOCK:
        cli_json_vector(json, "min", fill->min, 3);
        cli_json_vector(json, "max", fill->max, 3);
        break;
    case RHEO_FILL_SPHERE:
        cli_json_vector(json, "centre", fill->centre, 3);
        cli_json_number(json, "radius", fill->radius);
        break;
    case RHEO_FILL_MESH:
    case RHEO_FILL_LETTERS:
        cli_json_text(json, fill->kind == RHEO_FILL_MESH ? "file" : "text", fill->name);
        cli_json_number(json, "height", fill->height);
        if (fill->kind == RHEO_FILL_LETTERS)
            cli_json_number(json, "depth", fill->depth);
        cli_json_vector(json, "position", fill->position, 3);
        break;
    }
    cli_json_vector(json, "velocity", fill->velocity, 3);
    cli_json_number(json, "jitter", fill->jitter);
    if (fill->has_temperature)
        cli_json_vector(json, "temperature", fill->temperature, 2);
    if (model == RHEO_MODEL_MELTING)
        cli_json_bool(json, "hydrostatic", !fill->not_hydrostatic);
    cli_json_end_object(json);
    cli_json_end_object(json);
}

static void write_plane(cli_json *json, const double point[3], const double normal[3])
{
    cli_json_begin_object(json, NULL);
    cli_json_vector(json, "point", point, 3);
    cli_json_vector(json, "normal", normal, 3);
    cli_json_end_object(json);
}

/* The list that a group has besides its parameters. */
static void write_list(cli_json *json, const rheo_scene *scene, const char *group, size_t length)
{
    const rheo_world_def *def = &scene->world;
    if (strncmp(group, "fluid.", length) == 0) {
        cli_json_begin_list(json, "shapes");
        for (size_t i = 0; i < scene->fill_count; i++)
            write_fill(json, &scene->fill[i], def->model);
    } else if (strncmp(group, "walls.", length) == 0) {
        cli_json_begin_list(json, "planes");
        for (size_t i = 0; i < def->walls.count; i++)
            write_plane(json, def->walls.plane[i].point, def->walls.plane[i].normal);
    } else if (strncmp(group, "vibrators.", length) == 0) {
        cli_json_begin_list(json, "positions");
        for (size_t i = 0; i < def->vibrators.count; i++)
            cli_json_vector(json, NULL, def->vibrators.position[i], 2);
    } else {
        return;
    }
    cli_json_end_list(json);
}

static void write_parameter(cli_json *json, const rheo_scene *scene, const rheo_parameter *p)
{
    char value[128] = "";
    rheo_scene_get(scene, p->path, value, sizeof value);
    cli_json_parameter(json, after_group(p->path), p, value);
}

/* The length of a path's group, its dot included; 0 for one without a group. */
static size_t group_length(const char *path)
{
    return (size_t)(after_group(path) - path);
}

static bool is_of_model(const rheo_scene *scene, const rheo_parameter *p)
{
    return (p->models >> scene->world.model & 1) != 0;
}

/* One group with its parameters and lists, as far as the scene's model has them; `first` is the first parameter that
 * is in it. */
static void write_group(cli_json *json, const rheo_scene *scene, size_t first)
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
    cli_json_begin_object(json, name);
    for (size_t i = first; (p = rheo_scene_parameter_at(i)) != NULL; i++)
        if (strncmp(p->path, path, length) == 0 && is_of_model(scene, p))
            write_parameter(json, scene, p);
    write_list(json, scene, path, length);
    cli_json_end_object(json);
}

static bool group_came_before(size_t index)
{
    const char *path = rheo_scene_parameter_at(index)->path;
    for (size_t i = 0; i < index; i++)
        if (strncmp(rheo_scene_parameter_at(i)->path, path, group_length(path)) == 0)
            return true;
    return false;
}

/* Parameters, groups and the items of their lists have a line each. */
enum { SCENE_LINES = 3 };

char *cli_scene_to_json(const rheo_scene *scene)
{
    char *text = NULL;
    size_t size = 0;
    cli_json json = {.file = open_memstream(&text, &size), .lines = SCENE_LINES};
    if (!json.file)
        return NULL;
    cli_json_begin_object(&json, NULL);
    cli_json_text(&json, "scene", scene->name);
    cli_json_text(&json, "about", scene->about);
    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)) != NULL; i++) {
        if (group_length(p->path) == 0 && is_of_model(scene, p))
            write_parameter(&json, scene, p);
        else if (group_length(p->path) > 0 && !group_came_before(i))
            write_group(&json, scene, i);
    }
    cli_json_end_object(&json);
    const bool failed = ferror(json.file) != 0;
    if (fclose(json.file) != 0 || failed) {
        free(text);
        return NULL;
    }
    return text;
}
