/* Prints the parameters of scenes as text, JSON and Markdown. */
#include "cli/scenes.h"

#include <stdio.h>
#include <string.h>

#include "cli/cli.h"
#include "json/json_parameter.h"

bool cli_has_parameter(rheo_model model, const rheo_parameter *p)
{
    return (p->models >> model & 1) != 0;
}

const char *cli_parameter_default(rheo_model model, const rheo_parameter *p, char *value)
{
    const rheo_scene scene = rheo_default_model_scene(model);
    if (rheo_scene_get(&scene, p->path, value, 128) == RHEO_OK)
        return value;
    for (size_t i = 0; rheo_obstacle_parameter_at(i); i++)
        if (p == rheo_obstacle_parameter_at(i)) {
            rheo_obstacle_shape shape = RHEO_OBSTACLE_SPHERE;
            while (!rheo_obstacle_has_parameter(shape, p))
                shape++;
            return cli_obstacle_default(shape, p, value);
        }
    if (rheo_emitter_default(p, value, 128) != RHEO_OK)
        rheo__number_text(p->minimum, value, 128); /* of a material: that of the main one */
    return value;
}

const char *cli_obstacle_default(rheo_obstacle_shape shape, const rheo_parameter *p, char *value)
{
    rheo_scene scene = rheo_default_scene();
    const rheo_obstacle obstacle = rheo_default_obstacle(shape);
    rheo_error ignored;
    value[0] = 0;
    if (rheo_world_def_add_obstacle(&scene.world, &obstacle, &ignored) == RHEO_OK)
        rheo_scene_get(&scene, p->path, value, 128);
    return value;
}

rheo_model cli_first_model(const rheo_parameter *p)
{
    rheo_model model = 0;
    while (!cli_has_parameter(model, p))
        model++;
    return model;
}

/* The parameters of a scene, then those of a material, of an emitter and of an obstacle. */
static const rheo_parameter *parameter_at(size_t index)
{
    static const rheo_parameter *(*const of_items[])(size_t) = {rheo_material_parameter_at, rheo_emitter_parameter_at,
                                                                rheo_obstacle_parameter_at};
    if (index < rheo_scene_parameter_count())
        return rheo_scene_parameter_at(index);
    index -= rheo_scene_parameter_count();
    for (size_t i = 0; i < sizeof of_items / sizeof *of_items; i++) {
        size_t count = 0;
        while (of_items[i](count))
            count++;
        if (index < count)
            return of_items[i](index);
        index -= count;
    }
    return NULL;
}

/* The only model that has the parameter; NULL if there are several. */
static const char *only_model(const rheo_parameter *p)
{
    const rheo_model first = cli_first_model(p);
    return p->models == UINT32_C(1) << first && rheo_model_count() > 1 ? rheo_model_name(first) : NULL;
}

/* The model cannot be set, because a scene is made for one model. */
static bool is_listed(const rheo_parameter *p)
{
    return strcmp(p->path, "model") != 0;
}

/* Writes the range of a parameter, such as "0 < x <= 1", or the words of a choice. */
static const char *range_text(const rheo_parameter *p, char *text, size_t size)
{
    static const char *const notes[] = {[RHEO_PARAMETER_REAL] = "",
                                        [RHEO_PARAMETER_INTEGER] = ", whole",
                                        [RHEO_PARAMETER_VECTOR] = ", written [x, y, z]",
                                        [RHEO_PARAMETER_CHOICE] = "",
                                        [RHEO_PARAMETER_WINDOW] = ", or a time as \"2.5 s\""};
    const double unbounded = 1e30;
    char low[32], high[32], words[256];
    rheo__number_text(p->minimum, low, sizeof low);
    rheo__number_text(p->maximum, high, sizeof high);
    const char *after_low = p->above_minimum ? "<" : "<=", *before_high = p->below_maximum ? "<" : "<=";
    if (p->choices)
        snprintf(text, size, "one of: %s", rheo_parameter_words(p, words, sizeof words));
    else if (p->minimum > -unbounded && p->maximum < unbounded)
        snprintf(text, size, "%s %s x %s %s%s", low, after_low, before_high, high, notes[p->type]);
    else if (p->minimum > -unbounded)
        snprintf(text, size, "x %s %s%s", p->above_minimum ? ">" : ">=", low, notes[p->type]);
    else
        snprintf(text, size, "any%s", notes[p->type]);
    return text;
}

/* Whether a path begins with one of the prefixes; true if there are none. */
static bool is_wanted(const rheo_parameter *p, size_t count, char **prefix)
{
    bool wanted = count == 0;
    for (size_t i = 0; i < count && !wanted; i++)
        wanted = strncmp(p->path, prefix[i], strlen(prefix[i])) == 0;
    return wanted && is_listed(p);
}

size_t cli_parameters_wanted(size_t count, char **prefix)
{
    const rheo_parameter *p;
    size_t wanted = 0;
    for (size_t i = 0; (p = parameter_at(i)); i++)
        wanted += is_wanted(p, count, prefix);
    return wanted;
}

/* ---- Text ---- */

static void print_text(const rheo_parameter *p)
{
    char first[128], value[128], range[320];
    const bool unit = *p->unit && strcmp(p->unit, "1") != 0;
    printf("%s = %s", p->path, cli_parameter_default(cli_first_model(p), p, first));
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        if (cli_has_parameter(model, p) && strcmp(cli_parameter_default(model, p, value), first) != 0)
            printf(", of %s %s", rheo_model_name(model), value);
    printf("%s%s%s", unit ? "  " : "", unit ? p->unit : "", p->live ? "  (live)" : "");
    if (only_model(p))
        printf("  (%s)", only_model(p));
    cli_print(stdout, 4, "\n    %s\n    %s\n", p->about, range_text(p, range, sizeof range));
}

void cli_parameters_text(size_t count, char **prefix)
{
    if (count == 0)
        puts("The path of a parameter is its name for --set. In a scene file {\"fluid\": {\"support\": 4}} is\n"
             "fluid.support. Live parameters can be changed in a running world (--set together with\n"
             "--from). A parameter that names a model exists only in that model.\n"
             "Units: L length, T time, M mass, K temperature; a particle of the thickening model has mass 1.\n"
             "No number is larger than 1e+30.\n");
    const rheo_parameter *p;
    for (size_t i = 0; (p = parameter_at(i)); i++)
        if (is_wanted(p, count, prefix))
            print_text(p);
}

/* ---- JSON ---- */

static void print_json(const rheo_parameter *p)
{
    static const char *const types[] = {"real", "integer", "vector", "choice", "window"};
    char value[128], words[256];
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "path", p->path);
    rheo__json_text(&json, "type", types[p->type]);
    rheo__json_text(&json, "unit", p->unit);
    rheo__json_parameter(&json, "default", p, cli_parameter_default(cli_first_model(p), p, value));
    rheo__json_begin_object(&json, "models");
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        if (cli_has_parameter(model, p))
            rheo__json_parameter(&json, rheo_model_name(model), p, cli_parameter_default(model, p, value));
    rheo__json_end_object(&json);
    rheo__json_number(&json, "minimum", p->minimum);
    rheo__json_number(&json, "maximum", p->maximum);
    rheo__json_bool(&json, "above_minimum", p->above_minimum);
    rheo__json_bool(&json, "below_maximum", p->below_maximum);
    rheo__json_text(&json, "choices", p->choices ? rheo_parameter_words(p, words, sizeof words) : NULL);
    rheo__json_bool(&json, "live", p->live);
    rheo__json_text(&json, "about", p->about);
    rheo__json_end_object(&json);
}

void cli_parameters_json(size_t count, char **prefix)
{
    const rheo_parameter *p;
    for (size_t i = 0; (p = parameter_at(i)); i++)
        if (is_wanted(p, count, prefix))
            print_json(p);
}

/* ---- Markdown ---- */

/* Length of the group in a path; 0: no group. */
static size_t group_length(const char *path)
{
    const size_t length = strcspn(path, ".");
    return path[length] ? length : 0;
}

static bool is_in_group(const rheo_parameter *p, const char *group, size_t length)
{
    return is_listed(p) && group_length(p->path) == length && strncmp(p->path, group, length) == 0;
}

/* Whether this is the first parameter of its group. */
static bool begins_group(size_t index)
{
    const char *path = parameter_at(index)->path;
    for (size_t i = 0; i < index; i++)
        if (is_in_group(parameter_at(i), path, group_length(path)))
            return false;
    return is_listed(parameter_at(index));
}

/* Prints a cell of a table. Escapes |, which would end the cell. */
static void put_cell(const char *text)
{
    fputs(" ", stdout);
    for (; *text; text++) {
        if (*text == '|')
            putchar('\\');
        putchar(*text);
    }
    fputs(" |", stdout);
}

static void print_row(const rheo_parameter *p)
{
    char first[128], value[128], text[384];
    printf("| `%s` |", p->path);
    put_cell(p->unit);
    cli_parameter_default(cli_first_model(p), p, first);
    snprintf(text, sizeof text, "%s", first);
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        if (cli_has_parameter(model, p) && strcmp(cli_parameter_default(model, p, value), first) != 0)
            snprintf(text + strlen(text), sizeof text - strlen(text), "; %s: %s", rheo_model_name(model), value);
    put_cell(text);
    put_cell(range_text(p, text, sizeof text));
    put_cell(p->live ? "yes" : "no");
    put_cell(only_model(p) ? only_model(p) : "all");
    put_cell(p->about);
    putchar('\n');
}

static void print_group(size_t first)
{
    const char *group = parameter_at(first)->path;
    const size_t length = group_length(group);
    const rheo_parameter *p;
    printf("\n## %.*s\n\n", length ? (int)length : 7, length ? group : "general");
    puts("| parameter | unit | default | range | live | model | meaning |\n|---|---|---|---|---|---|---|");
    for (size_t i = first; (p = parameter_at(i)); i++)
        if (is_in_group(p, group, length))
            print_row(p);
}

void cli_parameters_markdown(void)
{
    puts(
        "# Parameters\n\n"
        "This page lists every parameter of a scene. Use it to look up a unit, a default or a range. `rheolog scenes\n"
        "--parameters --markdown` prints it, so it agrees with the program.\n\n"
        "A parameter has the same path everywhere:\n\n"
        "- on the command line: `rheolog run SCENE --set fluid.support=4`\n"
        "- in a scene file: `{\"fluid\": {\"support\": 4}}`; [scenes.md](scenes.md) has the keys of scene files "
        "that are no parameters\n"
        "- in C: the member `fluid.support` of `rheo_world_def`, or `rheo_scene_set(&scene, \"fluid.support\", \"4\", "
        "&error)`\n\n"
        "*live*: a command may change it in a running world, also with `--set` after `--from`. *model*: the model that "
        "has it.\n"
        "Units: L length, T time, M mass, K temperature; any consistent set. A particle of the thickening model has "
        "mass 1.\n"
        "No number is larger than 1e+30.\n"
        "[model.md](model.md) and [melting.md](melting.md) have the equations.\n\n"
        "Contents:\n");
    for (size_t i = 0; parameter_at(i); i++)
        if (begins_group(i)) {
            const char *path = parameter_at(i)->path;
            const int length = group_length(path) ? (int)group_length(path) : 7;
            const char *name = group_length(path) ? path : "general";
            printf("- [%.*s](#%.*s)\n", length, name, length, name);
        }
    for (size_t i = 0; parameter_at(i); i++)
        if (begins_group(i))
            print_group(i);
}
