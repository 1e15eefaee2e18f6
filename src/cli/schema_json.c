/*
 * Prints the JSON schema (draft 2020-12) of scene files, with one alternative per model. Parameters and shapes come
 * from the tables of the library, the other keys from scene_keys.c.
 */
#include "cli/schema.h"

#include <string.h>

#include "cli/scenes.h"
#include "json/json_parameter.h"

static void put_type(rheo__json *json, const char *type)
{
    rheo__json_text(json, "type", type);
}

static void put_range(rheo__json *json, double minimum, bool above, double maximum, bool below)
{
    rheo__json_number(json, above ? "exclusiveMinimum" : "minimum", minimum);
    rheo__json_number(json, below ? "exclusiveMaximum" : "maximum", maximum);
}

/* Writes the schema of a list of `count` numbers in a range. */
static void put_numbers(rheo__json *json, double count, double minimum, double maximum)
{
    put_type(json, "array");
    rheo__json_number(json, "minItems", count);
    rheo__json_number(json, "maxItems", count);
    rheo__json_begin_object(json, "items");
    put_type(json, "number");
    put_range(json, minimum, false, maximum, false);
    rheo__json_end_object(json);
}

/* Writes the meaning and, if there is one, the unit. */
static void put_description(rheo__json *json, const char *meaning, const char *unit)
{
    char text[320];
    snprintf(text, sizeof text, "%s%s%s", meaning, *unit ? "; unit " : "", unit);
    rheo__json_text(json, "description", text);
}

/* Writes a property that may have any value. */
static void put_ignored(rheo__json *json, const char *key, const char *meaning)
{
    rheo__json_begin_object(json, key);
    put_description(json, meaning, "");
    rheo__json_end_object(json);
}

/* Begins the schema of an object without additional keys, and its properties. meaning: NULL for none. */
static void begin_closed(rheo__json *json, const char *key, const char *meaning)
{
    rheo__json_begin_object(json, key);
    put_type(json, "object");
    if (meaning)
        put_description(json, meaning, "");
    rheo__json_bool(json, "additionalProperties", false);
    rheo__json_begin_object(json, "properties");
    put_ignored(json, "$schema", "name of this schema, for editors; ignored");
    put_ignored(json, "comment", "any value; ignored");
}

/* Ends it. `required` is a list of names, separated by blanks; "": none. */
static void end_closed(rheo__json *json, const char *required)
{
    rheo__json_end_object(json);
    if (*required) {
        rheo__json_begin_list(json, "required");
        for (const char *name = required; *name; name += strspn(name, " ")) {
            char text[64];
            const size_t length = strcspn(name, " ");
            snprintf(text, sizeof text, "%.*s", (int)length, name);
            rheo__json_text(json, NULL, text);
            name += length;
        }
        rheo__json_end_list(json);
    }
    rheo__json_end_object(json);
}

/* ---- Parameters ---- */

static void put_window(rheo__json *json, const rheo_parameter *p)
{
    rheo__json_begin_list(json, "oneOf");
    rheo__json_begin_object(json, NULL);
    put_type(json, "integer");
    put_range(json, p->minimum, false, p->maximum, false);
    rheo__json_end_object(json);
    rheo__json_begin_object(json, NULL);
    put_type(json, "string");
    rheo__json_text(json, "pattern", "^[0-9.eE+-]+ *s?$");
    rheo__json_end_object(json);
    rheo__json_end_list(json);
}

/* Begins the schema of a parameter, and describes it. */
static void begin_parameter(rheo__json *json, const rheo_parameter *p)
{
    const char *dot = strrchr(p->path, '.');
    rheo__json_begin_object(json, dot ? dot + 1 : p->path);
    put_description(json, p->about, p->unit);
}

/* A parameter of a material: a number. */
static void put_material_parameter(rheo__json *json, const rheo_parameter *p)
{
    begin_parameter(json, p);
    put_type(json, "number");
    put_range(json, p->minimum, p->above_minimum, p->maximum, p->below_maximum);
    rheo__json_number(json, "default", p->minimum); /* that of the main material */
    rheo__json_end_object(json);
}

/* A parameter of an obstacle. A choice is of the words false and true. */
static void put_obstacle_parameter(rheo__json *json, const rheo_parameter *p, rheo_obstacle_shape shape)
{
    char value[128] = "";
    begin_parameter(json, p);
    cli_obstacle_default(shape, p, value);
    if (p->type == RHEO_PARAMETER_CHOICE) {
        put_type(json, "boolean");
        rheo__json_bool(json, "default", strcmp(value, "true") == 0);
    } else {
        if (p->type == RHEO_PARAMETER_VECTOR) {
            put_numbers(json, 3, p->minimum, p->maximum);
        } else {
            put_type(json, "number");
            put_range(json, p->minimum, p->above_minimum, p->maximum, p->below_maximum);
        }
        rheo__json_parameter(json, "default", p, value);
    }
    rheo__json_end_object(json);
}

static void put_parameter(rheo__json *json, const rheo_parameter *p, rheo_model model)
{
    char value[128];
    begin_parameter(json, p);
    switch (p->type) {
    case RHEO_PARAMETER_REAL:
    case RHEO_PARAMETER_INTEGER:
        put_type(json, p->type == RHEO_PARAMETER_REAL ? "number" : "integer");
        put_range(json, p->minimum, p->above_minimum, p->maximum, p->below_maximum);
        break;
    case RHEO_PARAMETER_VECTOR:
        put_numbers(json, 3, p->minimum, p->maximum);
        break;
    case RHEO_PARAMETER_CHOICE:
        rheo__json_begin_list(json, "enum");
        for (uint32_t i = 0; i < p->choice_count; i++)
            rheo__json_text(json, NULL, p->choices[i]);
        rheo__json_end_list(json);
        break;
    case RHEO_PARAMETER_WINDOW:
        put_window(json, p);
        break;
    case RHEO_PARAMETER_NAME: /* not of a scene */
        break;
    }
    rheo__json_parameter(json, "default", p, cli_parameter_default(model, p, value));
    rheo__json_end_object(json);
}

/* ---- Shapes ---- */

static void put_member(rheo__json *json, const rheo_shape_member *m)
{
    rheo__json_begin_object(json, m->name);
    put_description(json, m->meaning, m->unit);
    switch (m->type) {
    case RHEO_SHAPE_NUMBER:
        put_type(json, "number");
        put_range(json, m->minimum, m->above_minimum, m->maximum, false);
        break;
    case RHEO_SHAPE_PAIR:
        rheo__json_begin_list(json, "oneOf");
        rheo__json_begin_object(json, NULL);
        put_type(json, "number");
        rheo__json_end_object(json);
        rheo__json_begin_object(json, NULL);
        put_numbers(json, 2, m->minimum, m->maximum);
        rheo__json_end_object(json);
        rheo__json_end_list(json);
        break;
    case RHEO_SHAPE_VECTOR:
        put_numbers(json, 3, m->minimum, m->maximum);
        break;
    case RHEO_SHAPE_TEXT:
    case RHEO_SHAPE_FILE:
        put_type(json, "string");
        rheo__json_number(json, "maxLength", (double)m->size - 1);
        break;
    case RHEO_SHAPE_NEGATED_FLAG:
        put_type(json, "boolean");
        break;
    }
    rheo__json_end_object(json);
}

static void put_shape(rheo__json *json, const rheo_shape *shape, rheo_model model)
{
    char required[256] = "";
    begin_closed(json, NULL, shape->meaning);
    begin_closed(json, shape->name, shape->meaning);
    for (size_t i = 0; i < shape->member_count; i++) {
        const rheo_shape_member *m = &shape->member[i];
        if (rheo_shape_member_has_model(m, model))
            put_member(json, m);
        if (m->required)
            snprintf(required + strlen(required), sizeof required - strlen(required), "%s ", m->name);
    }
    end_closed(json, required);
    end_closed(json, shape->name);
}

static void begin_list_of(rheo__json *json, const char *key, const char *meaning, double least, double most)
{
    rheo__json_begin_object(json, key);
    put_type(json, "array");
    put_description(json, meaning, "");
    if (least > 0)
        rheo__json_number(json, "minItems", least);
    rheo__json_number(json, "maxItems", most);
}

static void put_shapes(rheo__json *json, rheo_model model)
{
    const rheo_shape *shape;
    begin_list_of(json, "shapes", CLI_SHAPES_MEANING, 0, RHEO_MAX_FILLS);
    rheo__json_begin_object(json, "items");
    rheo__json_begin_list(json, "oneOf");
    for (size_t kind = 0; (shape = rheo_shape_at(kind)); kind++)
        put_shape(json, shape, model);
    rheo__json_end_list(json);
    rheo__json_end_object(json);
    rheo__json_end_object(json);
}

/* ---- Walls, vibrators, curves ---- */

static void put_sides(rheo__json *json)
{
    put_type(json, "array");
    rheo__json_begin_object(json, "items");
    rheo__json_begin_list(json, "enum");
    for (size_t i = 0; i < CLI_SIDES; i++)
        rheo__json_text(json, NULL, cli_sides[i]);
    rheo__json_end_list(json);
    rheo__json_end_object(json);
}

static void put_key(rheo__json *json, const cli_scene_key *key)
{
    rheo__json_begin_object(json, key->name);
    put_description(json, key->meaning, key->unit);
    if (key->numbers == 0) {
        put_sides(json);
    } else if (key->numbers == 1) {
        put_type(json, "number");
        put_range(json, key->minimum, key->above_minimum, CLI_UNBOUNDED, false);
    } else {
        put_numbers(json, key->numbers, key->minimum, CLI_UNBOUNDED);
    }
    rheo__json_end_object(json);
}

/* Writes an object with its keys. */
static void put_keys(rheo__json *json, const char *name, const cli_scene_object *object)
{
    char required[256] = "";
    begin_closed(json, name, object->meaning);
    for (size_t i = 0; i < object->key_count; i++) {
        put_key(json, &object->key[i]);
        if (object->key[i].required)
            snprintf(required + strlen(required), sizeof required - strlen(required), "%s ", object->key[i].name);
    }
    end_closed(json, required);
}

static void put_object(rheo__json *json, const cli_scene_object *object)
{
    if (!object->most) {
        put_keys(json, object->name, object);
        return;
    }
    begin_list_of(json, object->name, object->meaning, object->least, object->most);
    if (object->key_count) {
        put_keys(json, "items", object);
    } else {
        rheo__json_begin_object(json, "items");
        put_numbers(json, 2, -object->bound, object->bound);
        rheo__json_end_object(json);
    }
    rheo__json_end_object(json);
}

/* ---- Materials ---- */

/* Writes the name of a material or an emitter. */
static void put_name(rheo__json *json)
{
    rheo__json_begin_object(json, "name");
    put_type(json, "string");
    put_description(json, CLI_MATERIAL_NAME_MEANING, "");
    rheo__json_text(json, "pattern", "^[A-Za-z][A-Za-z0-9_-]{0,14}$");
    rheo__json_begin_object(json, "not"); /* the name of that of shapes without a material */
    rheo__json_text(json, "const", "main");
    rheo__json_end_object(json);
    rheo__json_end_object(json);
}

static void put_text_key(rheo__json *json, const char *key, const char *meaning, size_t size)
{
    rheo__json_begin_object(json, key);
    put_type(json, "string");
    put_description(json, meaning, "");
    rheo__json_number(json, "maxLength", (double)size - 1);
    rheo__json_end_object(json);
}

/* Writes the materials: a list of objects with a name and parameters that are those of the main material by default. */
static void put_materials(rheo__json *json)
{
    static const char *const groups[] = {"springs", "history"};
    const rheo_parameter *p;
    begin_list_of(json, "materials", CLI_MATERIALS_MEANING, 0, RHEO_MAX_MATERIALS);
    begin_closed(json, "items", NULL);
    put_name(json);
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++) {
        begin_closed(json, groups[g], NULL);
        for (size_t i = 0; (p = rheo_material_parameter_at(i)); i++)
            if (strncmp(p->path + strlen("materials.NAME."), groups[g], strlen(groups[g])) == 0)
                put_material_parameter(json, p);
        end_closed(json, "");
    }
    end_closed(json, "name");
    rheo__json_end_object(json);
}

/* ---- Obstacles ---- */

/* Writes the obstacles: a list of objects with one shape, which has its parameters. */
static void put_obstacles(rheo__json *json)
{
    const rheo_parameter *shape = rheo_obstacle_parameter_at(0), *p;
    begin_list_of(json, "obstacles", CLI_OBSTACLES_MEANING, 0, RHEO_MAX_OBSTACLES);
    rheo__json_begin_object(json, "items");
    rheo__json_begin_list(json, "oneOf");
    for (uint32_t k = 0; k < shape->choice_count; k++) {
        begin_closed(json, NULL, NULL);
        begin_closed(json, shape->choices[k], NULL);
        if (k == RHEO_OBSTACLE_MESH)
            put_text_key(json, "file", CLI_OBSTACLE_FILE_MEANING, sizeof((rheo_obstacle *)0)->file);
        for (size_t i = 1; (p = rheo_obstacle_parameter_at(i)); i++)
            if (rheo_obstacle_has_parameter((rheo_obstacle_shape)k, p))
                put_obstacle_parameter(json, p, (rheo_obstacle_shape)k);
        end_closed(json, k == RHEO_OBSTACLE_MESH ? "file" : "");
        end_closed(json, shape->choices[k]);
    }
    rheo__json_end_list(json);
    rheo__json_end_object(json);
    rheo__json_end_object(json);
}

/* ---- Emitters ---- */

static void put_emitters(rheo__json *json, rheo_model model)
{
    const rheo_parameter *p;
    begin_list_of(json, "emitters", CLI_EMITTERS_MEANING, 0, RHEO_MAX_EMITTERS);
    begin_closed(json, "items", NULL);
    put_name(json);
    for (size_t i = 0; (p = rheo_emitter_parameter_at(i)); i++)
        if (strcmp(p->path, "emitters.NAME.material") == 0 && cli_has_parameter(model, p))
            put_text_key(json, "material", "name of the material of its particles; by default the main one",
                         sizeof((rheo_material *)0)->name);
        else if (cli_has_parameter(model, p))
            put_parameter(json, p, model);
    end_closed(json, "name position");
    rheo__json_end_object(json);
}

/* ---- The file ---- */

static bool is_in_group(const rheo_parameter *p, const char *group)
{
    const size_t length = strlen(group);
    return strncmp(p->path, group, length) == 0 && p->path[length] == '.';
}

static void put_group(rheo__json *json, const char *group, rheo_model model)
{
    const rheo_parameter *p;
    bool any = strcmp(group, "walls") == 0; /* all models have planes and boxes */
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)); i++)
        any = any || (is_in_group(p, group) && cli_has_parameter(model, p));
    if (!any)
        return;
    begin_closed(json, group, NULL);
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)); i++)
        if (is_in_group(p, group) && cli_has_parameter(model, p))
            put_parameter(json, p, model);
    if (strcmp(group, "fluid") == 0)
        put_shapes(json, model);
    const cli_scene_object *object;
    for (size_t i = 0; (object = cli_scene_object_at(i)); i++)
        if (strcmp(group, object->group) == 0)
            put_object(json, object);
    end_closed(json, "");
}

/* Groups ball2, ball3, ... with the keys of the group ball. */
static void put_further_balls(rheo__json *json, rheo_model model)
{
    for (unsigned number = 2; number <= RHEO_MAX_BALLS; number++) {
        char text[64];
        snprintf(text, sizeof text, "ball%u", number);
        rheo__json_begin_object(json, text);
        put_description(json, CLI_BALLS_MEANING, "");
        snprintf(text, sizeof text, "#/oneOf/%u/properties/ball", (unsigned)model);
        rheo__json_text(json, "$ref", text);
        rheo__json_end_object(json);
    }
}

static void put_model(rheo__json *json, rheo_model model)
{
    char group[64], seen[512] = " ";
    const rheo_parameter *p;
    begin_closed(json, NULL, NULL);
    put_text_key(json, "scene", CLI_NAME_MEANING, sizeof((rheo_scene *)0)->name);
    put_text_key(json, "about", CLI_ABOUT_MEANING, sizeof((rheo_scene *)0)->about);
    rheo__json_begin_object(json, "model");
    put_description(json, rheo_scene_parameter_find("model")->about, "");
    rheo__json_text(json, "const", rheo_model_name(model));
    rheo__json_end_object(json);
    if (cli_has_parameter(model, rheo_material_parameter_at(0)))
        put_materials(json);
    if (cli_has_parameter(model, rheo_obstacle_parameter_at(0)))
        put_obstacles(json);
    put_emitters(json, model);
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)); i++) {
        const size_t length = strcspn(p->path, ".");
        snprintf(group, sizeof group, " %.*s ", (int)length, p->path);
        if (strcmp(p->path, "model") == 0 || strstr(seen, group))
            continue;
        if (!p->path[length] && cli_has_parameter(model, p))
            put_parameter(json, p, model);
        if (!p->path[length])
            continue;
        snprintf(seen + strlen(seen), sizeof seen - strlen(seen), "%s", group);
        group[length + 1] = 0;
        put_group(json, group + 1, model);
        if (strcmp(group + 1, "ball") == 0 && cli_has_parameter(model, p))
            put_further_balls(json, model);
    }
    end_closed(json, model == 0 ? "" : "model"); /* the first model is the default */
}

void cli_schema_json(void)
{
    rheo__json json = {.file = stdout, .lines = 12};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "$schema", "https://json-schema.org/draft/2020-12/schema");
    rheo__json_text(&json, "title", "Scene of rheolog " RHEO_VERSION);
    rheo__json_begin_list(&json, "oneOf");
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        put_model(&json, model);
    rheo__json_end_list(&json);
    rheo__json_end_object(&json);
}
