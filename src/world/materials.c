/* The materials of a definition, a list of named items (world/listed.c). */
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

#define MODELS (UINT32_C(1) << RHEO_MODEL_THICKENING)
#define REAL(path_, unit_, meaning)                                                                               \
    {                                                                                                             \
        .path = path_, .type = RHEO_PARAMETER_REAL, .unit = unit_, .about = meaning, .live = true, .minimum = -1, \
        .maximum = RHEO__UNBOUNDED, .models = MODELS                                                              \
    }
#define OF_ANY(number, member, unit_, meaning) REAL("materials.NAME." #member, unit_, meaning),
#define ROW(number, member, unit_, meaning)                       \
    {REAL("materials." #number "." #member, unit_, meaning),      \
     offsetof(rheo_world_def, materials.list[(number)-1].member), \
     0,                                                           \
     {-1}},
#define ROWS(number)                                                                    \
    RHEO__NAME_ROW("materials", number, materials.list, "name of the material", MODELS) \
    PARAMETERS(ROW, number)

static const rheo_parameter of_any[] = {PARAMETERS(OF_ANY, 0)};
static const rheo__parameter_row rows[] = {ROWS(1) ROWS(2) ROWS(3) ROWS(4) ROWS(5) ROWS(6) ROWS(7) ROWS(8) ROWS(9)
                                               ROWS(10) ROWS(11) ROWS(12) ROWS(13) ROWS(14) ROWS(15) ROWS(16)};

enum { LENGTH_OF_ANY = sizeof of_any / sizeof *of_any, ROWS_OF_ONE = LENGTH_OF_ANY + 1 };
_Static_assert(sizeof rows / sizeof *rows == RHEO_MAX_MATERIALS * ROWS_OF_ONE, "every material has its rows");

const rheo_parameter *rheo_material_parameter_at(size_t index)
{
    return index < LENGTH_OF_ANY ? &of_any[index] : NULL;
}

/* ---- Materials ---- */

rheo_material rheo_default_material(const char *name)
{
    rheo_material material = {.springs = {-1, -1, -1}, .history = {-1, -1}};
    snprintf(material.name, sizeof material.name, "%s", name);
    return material;
}

rheo_result rheo_world_def_add_material(rheo_world_def *def, const rheo_material *material, rheo_error *error)
{
    return rheo__list_add(def, &rheo__materials, material, error);
}

static rheo_result add(rheo_world_def *def, const char *name, rheo_error *error)
{
    const rheo_material material = rheo_default_material(name);
    return rheo_world_def_add_material(def, &material, error);
}

const rheo__list rheo__materials = {
    .group = "materials.",
    .item = "material",
    .most = RHEO_MAX_MATERIALS,
    .row = rows,
    .rows_of_one = ROWS_OF_ONE,
    .count_offset = offsetof(rheo_world_def, materials.count),
    .items_offset = offsetof(rheo_world_def, materials.list),
    .item_size = sizeof(rheo_material),
    .add = add,
};

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

rheo_result rheo__materials_check(const rheo_world_def *def, rheo_error *error)
{
    RHEO__TRY(rheo__list_check(def, &rheo__materials, error));
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
