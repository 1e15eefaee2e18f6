/*
 * The materials of a definition: their names, and their parameters. The latter have rows for each number that a
 * material may have, so that loops over rows treat them like any other parameter.
 */
#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "world/parameters.h"

/* ---- Rows ---- */

/* X(number of the material, member of rheo_material, unit, meaning) */
#define PARAMETERS(X, number)                                                                          \
    X(number, springs.stiffness, "1/T^2", "k_min of the material; below 0: that of the main one")      \
    X(number, springs.plasticity, "1/T", "alpha of the material; below 0: that of the main one")       \
    X(number, springs.yield_ratio, "1", "gamma of the material; below 0: that of the main one")        \
    X(number, history.stiffness, "T^(q-2)/L", "k_hist of the material; below 0: that of the main one") \
    X(number, history.onset, "L/T^q", "n0 of the material; below 0: that of the main one")

#define MODELS .models = UINT32_C(1) << RHEO_MODEL_THICKENING
#define REAL(path_, unit_, meaning)                                                                               \
    {                                                                                                             \
        .path = path_, .type = RHEO_PARAMETER_REAL, .unit = unit_, .about = meaning, .live = true, .minimum = -1, \
        .maximum = RHEO__UNBOUNDED, MODELS                                                                        \
    }
#define OF_ANY(number, member, unit_, meaning) REAL("materials.NAME." #member, unit_, meaning),
#define ROW(number, member, unit_, meaning)                       \
    {REAL("materials." #number "." #member, unit_, meaning),      \
     offsetof(rheo_world_def, materials.list[(number)-1].member), \
     0,                                                           \
     {-1}},
#define ROWS(number)                                            \
    {{.path = "materials." #number ".name",                     \
      .type = RHEO_PARAMETER_NAME,                              \
      .unit = "",                                               \
      .about = "name of the material",                          \
      MODELS},                                                  \
     offsetof(rheo_world_def, materials.list[(number)-1].name), \
     0,                                                         \
     {0}},                                                      \
        PARAMETERS(ROW, number)

static const rheo_parameter of_any[] = {PARAMETERS(OF_ANY, 0)};
static const rheo__parameter_row rows[] = {ROWS(1) ROWS(2) ROWS(3) ROWS(4) ROWS(5) ROWS(6) ROWS(7) ROWS(8) ROWS(9)
                                               ROWS(10) ROWS(11) ROWS(12) ROWS(13) ROWS(14) ROWS(15) ROWS(16)};

enum { LENGTH_OF_ANY = sizeof of_any / sizeof *of_any, ROWS_OF_ONE = LENGTH_OF_ANY + 1 };
_Static_assert(sizeof rows / sizeof *rows == RHEO_MAX_MATERIALS * ROWS_OF_ONE, "every material has its rows");

static const char GROUP[] = "materials.";

const rheo_parameter *rheo_material_parameter_at(size_t index)
{
    return index < LENGTH_OF_ANY ? &of_any[index] : NULL;
}

bool rheo__is_of_material(const char *path)
{
    return strncmp(path, GROUP, strlen(GROUP)) == 0;
}

const char *rheo__in_material(const char *path)
{
    const char *rest = rheo__is_of_material(path) ? strchr(path + strlen(GROUP), '.') : NULL;
    return rest ? rest + 1 : path;
}

uint32_t rheo__material_number(const char *path)
{
    for (uint32_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].parameter.path == path)
            return 1 + i / ROWS_OF_ONE;
    return 0;
}

size_t rheo_world_def_parameter_count(const rheo_world_def *def)
{
    return rheo_parameter_count() + (size_t)def->materials.count * ROWS_OF_ONE + rheo__ball_parameter_count(def) +
           rheo__obstacle_parameter_count(def);
}

const rheo_parameter *rheo_world_def_parameter_at(const rheo_world_def *def, size_t index)
{
    const size_t main = rheo_parameter_count(), of_materials = (size_t)def->materials.count * ROWS_OF_ONE;
    if (index < main)
        return rheo_parameter_at(index);
    const size_t of_balls = rheo__ball_parameter_count(def);
    if (index < main + of_materials)
        return &rows[index - main].parameter;
    return index < main + of_materials + of_balls
               ? rheo__ball_parameter_at(index - main - of_materials)
               : rheo__obstacle_parameter(def, index - main - of_materials - of_balls);
}

/* The number that a path has for a material: "1" or its name. 0: there is none. */
static uint32_t number_in(const rheo_world_def *def, const char *text, size_t length)
{
    char name[sizeof def->materials.list->name], number[4];
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    for (uint32_t k = 1; k <= def->materials.count && length < sizeof name; k++) {
        snprintf(number, sizeof number, "%u", (unsigned)(k % 1000));
        if (strcmp(name, def->materials.list[k - 1].name) == 0 || strcmp(name, number) == 0)
            return k;
    }
    return 0;
}

const rheo_parameter *rheo_world_def_parameter_find(const rheo_world_def *def, const char *path)
{
    if (rheo__is_of_obstacle(path))
        return rheo__obstacle_parameter_find(def, path);
    if (!rheo__is_of_material(path)) {
        const rheo_parameter *of_ball = rheo__ball_parameter_find(path);
        return of_ball ? of_ball : rheo__parameter_find(path);
    }
    const char *text = path + strlen(GROUP);
    const uint32_t number = number_in(def, text, strcspn(text, "."));
    for (size_t i = 0; number && i < ROWS_OF_ONE; i++) {
        const rheo_parameter *p = &rows[(number - 1) * ROWS_OF_ONE + i].parameter;
        if (strcmp(rheo__in_material(p->path), rheo__in_material(path)) == 0)
            return p;
    }
    return NULL;
}

const char *rheo__materials_text(const rheo_world_def *def, char text[RHEO__MATERIALS_TEXT])
{
    const size_t size = RHEO__MATERIALS_TEXT;
    snprintf(text, size, "%s", def->materials.count ? "the materials are: " : "no materials are given");
    for (uint32_t k = 0; k < def->materials.count; k++) {
        const size_t used = strlen(text);
        snprintf(text + used, size - used, "%s\"%s\"", k ? ", " : "", def->materials.list[k].name);
    }
    return text;
}

rheo_result rheo__material_unknown(const rheo_world_def *def, const char *path, rheo_error *error)
{
    char names[RHEO__MATERIALS_TEXT];
    const char *text = path + strlen(GROUP);
    const size_t length = strcspn(text, ".");
    if (!number_in(def, text, length))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.64s: there is no material \"%.*s\"; %s", path,
                          (int)(length < 32 ? length : 32), text, rheo__materials_text(def, names));
    char known[256] = "";
    for (size_t i = 0; i < LENGTH_OF_ANY; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "",
                 rheo__in_material(of_any[i].path));
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.64s: a material has no such parameter of its own; it has: %s",
                      path, known);
}

/* ---- Materials ---- */

rheo_material rheo_default_material(const char *name)
{
    rheo_material material = {.springs = {-1, -1, -1}, .history = {-1, -1}};
    snprintf(material.name, sizeof material.name, "%s", name);
    return material;
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_name(const rheo_material *material)
{
    const char *name = material->name;
    size_t length = 0;
    while (length < sizeof material->name &&
           (is_letter(name[length]) || (name[length] >= '0' && name[length] <= '9') || name[length] == '-' ||
            name[length] == '_'))
        length++;
    return length < sizeof material->name && name[length] == 0 && is_letter(name[0]) && strcmp(name, "main") != 0;
}

static rheo_result check_name(const rheo_material *materials, uint32_t index, rheo_error *error)
{
    const rheo_material *material = &materials[index];
    if (!is_name(material))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "material %u has the name \"%.15s\"; a name is a letter, then at most 14 letters, digits, - "
            "and _, and not \"main\"",
            index + 1, material->name);
    for (uint32_t other = 0; other < index; other++)
        if (strcmp(materials[other].name, material->name) == 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "two materials have the name \"%s\"", material->name);
    return RHEO_OK;
}

rheo_result rheo_world_def_add_material(rheo_world_def *def, const rheo_material *material, rheo_error *error)
{
    const uint32_t count = def->materials.count;
    if (count >= RHEO_MAX_MATERIALS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a world has at most %d materials", RHEO_MAX_MATERIALS);
    def->materials.list[count] = *material;
    RHEO__TRY(check_name(def->materials.list, count, error));
    def->materials.count++;
    return RHEO_OK;
}

bool rheo_world_def_material(const rheo_world_def *def, const char *name, uint32_t *number)
{
    *number = 0;
    if (name[0] == 0 || strcmp(name, "main") == 0)
        return true;
    for (uint32_t k = 1; k <= def->materials.count; k++)
        if (strcmp(def->materials.list[k - 1].name, name) == 0)
            *number = k;
    return *number > 0;
}

const char *rheo_world_def_material_name(const rheo_world_def *def, uint32_t number)
{
    return number == 0 ? "main" : number <= def->materials.count ? def->materials.list[number - 1].name : "";
}

rheo_result rheo__materials_check(const rheo_world_def *def, rheo_error *error)
{
    if (def->materials.count > RHEO_MAX_MATERIALS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u materials; at most %d are possible",
                          def->materials.count, RHEO_MAX_MATERIALS);
    for (uint32_t k = 0; k < def->materials.count; k++)
        RHEO__TRY(check_name(def->materials.list, k, error));
    for (size_t i = 0; i < (size_t)def->materials.count * ROWS_OF_ONE; i++)
        RHEO__TRY(rheo__row_check(def, &rows[i], error));
    if (def->materials.count && def->scheme != RHEO_SCHEME_SUMMED)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "scheme %s knows one material; %u more are given: use scheme summed",
                          def->scheme == RHEO_SCHEME_SEQUENTIAL ? "sequential" : "positions", def->materials.count);
    return RHEO_OK;
}

rheo_result rheo__materials_check_particles(const rheo_world_def *def, rheo_error *error)
{
    const uint32_t *material = def->particles.material;
    for (uint32_t i = 0; material && i < def->particles.count; i++)
        if (material[i] > def->materials.count)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "particle %u is of material %u; the last material is %u", i,
                              material[i], def->materials.count);
    return RHEO_OK;
}
