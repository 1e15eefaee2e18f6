/* Prints the keys of scene files that are no parameters as the tables of docs/scenes.md. */
#include "cli/schema.h"

#include <stdio.h>
#include <string.h>

#include "cli/scenes.h"
#include "json/json_writer.h"

#define UNLIMITED(x) ((x) <= -CLI_UNBOUNDED || (x) >= CLI_UNBOUNDED)

/* Prints the cells of a row: key, type, unit, range, what holds if it is left out, meaning. */
static void print_row(const char *key, const char *type, const char *unit, const char *range, const char *otherwise,
                      const char *meaning)
{
    printf("| `%s` | %s | %s | %s | %s | %s |\n", key, type, unit, range, otherwise, meaning);
}

static void begin_table(const char *meaning)
{
    printf("%c%s.\n\n", meaning[0] >= 'a' && meaning[0] <= 'z' ? meaning[0] - 'a' + 'A' : meaning[0], meaning + 1);
    puts("| key | type | unit | range | default | meaning |\n|---|---|---|---|---|---|");
}

static const char *range_text(double minimum, bool above, double maximum, char text[96])
{
    char low[32], high[32];
    rheo__number_text(minimum, low, sizeof low);
    rheo__number_text(maximum, high, sizeof high);
    if (UNLIMITED(minimum) && UNLIMITED(maximum))
        snprintf(text, 96, "any");
    else if (UNLIMITED(maximum))
        snprintf(text, 96, "x %s %s", above ? ">" : ">=", low);
    else
        snprintf(text, 96, "%s %s x <= %s", low, above ? "<" : "<=", high);
    return text;
}

/* ---- Shapes ---- */

/* The only model whose shapes have a member; NULL if there are several. */
static const char *only_model(const rheo_shape_member *member)
{
    const char *name = NULL;
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        if (rheo_shape_member_has_model(member, model)) {
            if (name)
                return NULL;
            name = rheo_model_name(model);
        }
    return name;
}

static void print_member(const rheo_shape_member *m)
{
    static const char *const types[] = {[RHEO_SHAPE_NUMBER] = "number",
                                        [RHEO_SHAPE_PAIR] = "number, or list of 2",
                                        [RHEO_SHAPE_VECTOR] = "list of 3 numbers",
                                        [RHEO_SHAPE_TEXT] = "text",
                                        [RHEO_SHAPE_FILE] = "text",
                                        [RHEO_SHAPE_NEGATED_FLAG] = "true or false"};
    static const char *const defaults[] = {[RHEO_SHAPE_NUMBER] = "0",         [RHEO_SHAPE_PAIR] = "that of the model",
                                           [RHEO_SHAPE_VECTOR] = "[0, 0, 0]", [RHEO_SHAPE_TEXT] = "none",
                                           [RHEO_SHAPE_FILE] = "none",        [RHEO_SHAPE_NEGATED_FLAG] = "true"};
    char range[96], meaning[256];
    const bool number = m->type == RHEO_SHAPE_NUMBER || m->type == RHEO_SHAPE_PAIR || m->type == RHEO_SHAPE_VECTOR;
    if (number)
        range_text(m->minimum, m->above_minimum, m->maximum, range);
    else if (m->type == RHEO_SHAPE_NEGATED_FLAG)
        range[0] = 0;
    else
        snprintf(range, sizeof range, "at most %u bytes", (unsigned)(m->size - 1));
    const char *model = only_model(m);
    snprintf(meaning, sizeof meaning, "%s%s%s", m->meaning, model ? "; only model " : "", model ? model : "");
    print_row(m->name, types[m->type], m->unit, range, m->required ? "required" : defaults[m->type], meaning);
}

/* Whether all shapes have a member of this name. */
static bool is_common(const char *name)
{
    const rheo_shape *shape;
    for (size_t i = 0; (shape = rheo_shape_at(i)); i++) {
        size_t m = 0;
        while (m < shape->member_count && strcmp(shape->member[m].name, name) != 0)
            m++;
        if (m == shape->member_count)
            return false;
    }
    return true;
}

static void print_shape(const rheo_shape *shape, bool common)
{
    begin_table(common ? "keys of every shape" : shape->meaning);
    for (size_t i = 0; i < shape->member_count; i++)
        if (is_common(shape->member[i].name) == common)
            print_member(&shape->member[i]);
}

static const rheo_shape *find_shape(const char *name)
{
    const rheo_shape *shape;
    for (size_t i = 0; (shape = rheo_shape_at(i)); i++)
        if (strcmp(shape->name, name) == 0)
            return shape;
    return NULL;
}

/* ---- Objects ---- */

static void print_key(const cli_scene_key *key)
{
    char range[96], type[48] = "number", sides[128] = "";
    if (key->numbers == 0)
        for (size_t i = 0; i < CLI_SIDES; i++)
            snprintf(sides + strlen(sides), sizeof sides - strlen(sides), "%s%s", i ? ", " : "", cli_sides[i]);
    if (key->numbers == 0)
        snprintf(type, sizeof type, "list of words");
    else if (key->numbers > 1)
        snprintf(type, sizeof type, "list of %u numbers", (unsigned)key->numbers);
    range_text(key->minimum, key->above_minimum, CLI_UNBOUNDED, range);
    print_row(key->name, type, key->unit, key->numbers ? range : sides, key->required ? "required" : "none",
              key->meaning);
}

static void print_object(const cli_scene_object *object)
{
    char count[96] = "";
    if (object->most && object->least)
        snprintf(count, sizeof count, "; %u to %u", (unsigned)object->least, (unsigned)object->most);
    else if (object->most)
        snprintf(count, sizeof count, "; at most %u", (unsigned)object->most);
    char meaning[256];
    snprintf(meaning, sizeof meaning, "%s%s%s%s", object->meaning, count, object->parts ? "; each is " : "",
             object->parts ? object->parts : "");
    if (object->key_count) {
        begin_table(meaning);
        for (size_t i = 0; i < object->key_count; i++)
            print_key(&object->key[i]);
    } else {
        printf("%c%s.\n", meaning[0] - 'a' + 'A', meaning + 1);
    }
}

static const cli_scene_object *find_object(const char *path)
{
    const cli_scene_object *object;
    char name[64];
    for (size_t i = 0; (object = cli_scene_object_at(i)); i++) {
        snprintf(name, sizeof name, "%s.%s", object->group, object->name);
        if (strcmp(name, path) == 0)
            return object;
    }
    return NULL;
}

/* ---- The file ---- */

static void print_file(void)
{
    char range[64];
    begin_table("keys of the file itself, beside the groups of parameters");
    snprintf(range, sizeof range, "at most %u bytes", (unsigned)sizeof((rheo_scene *)0)->name - 1);
    print_row("scene", "text", "", range, "name of the file", CLI_NAME_MEANING);
    snprintf(range, sizeof range, "at most %u bytes", (unsigned)sizeof((rheo_scene *)0)->about - 1);
    print_row("about", "text", "", range, "none", CLI_ABOUT_MEANING);
    char names[128] = "";
    for (rheo_model model = 0; model < rheo_model_count(); model++)
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", model ? ", " : "",
                 rheo_model_name(model));
    print_row("model", "word", "", names, rheo_model_name(0), rheo_scene_parameter_find("model")->about);
    snprintf(range, sizeof range, "at most %d", RHEO_MAX_MATERIALS);
    print_row("materials", "list", "", range, "none", CLI_MATERIALS_MEANING);
    snprintf(range, sizeof range, "at most %d", RHEO_MAX_EMITTERS);
    print_row("emitters", "list", "", range, "none", CLI_EMITTERS_MEANING);
    snprintf(range, sizeof range, "at most %d", RHEO_MAX_OBSTACLES);
    print_row("obstacles", "list", "", range, "none", CLI_OBSTACLES_MEANING);
    print_row("ball2", "object", "", "", "none", CLI_BALLS_MEANING);
    printf("| a [group](parameters.md) | object | | | | its parameters by name: `fluid.support` is "
           "`{\"fluid\": {\"support\": 4}}` |\n");
    print_row("comment", "anything", "", "", "none", "ignored; any object may have one");
    print_row("$schema", "anything", "", "", "none", "ignored; tells an editor where the schema is");
}

/* ---- All ---- */

bool cli_schema_has_table(const char *key)
{
    return strcmp(key, "file") == 0 || strcmp(key, "shapes") == 0 || find_shape(key) || find_object(key);
}

static void print_table(const char *key)
{
    if (strcmp(key, "file") == 0)
        print_file();
    else if (strcmp(key, "shapes") == 0)
        print_shape(rheo_shape_at(0), true);
    else if (find_shape(key))
        print_shape(find_shape(key), false);
    else
        print_object(find_object(key));
}

/* Prints a table after its key. */
static void print_named(const char *key)
{
    printf("\n%s:\n\n", key);
    print_table(key);
}

void cli_schema_markdown(const char *key)
{
    const rheo_shape *shape;
    const cli_scene_object *object;
    char name[64];
    if (key) {
        print_table(key);
        return;
    }
    print_named("file");
    print_named("shapes");
    for (size_t i = 0; (shape = rheo_shape_at(i)); i++)
        print_named(shape->name);
    for (size_t i = 0; (object = cli_scene_object_at(i)); i++) {
        snprintf(name, sizeof name, "%s.%s", object->group, object->name);
        print_named(name);
    }
}
