/* Reads columns of particles, the surface and the extent from a world. */
#include <stdlib.h>
#include <string.h>

#include "core/real.h"
#include "view/facets.h"
#include "view/output.h"
#include "world/model.h"

/* ---- Columns ---- */

size_t rheo__column_element_size(const rheo__column *column)
{
    return column->info.element == RHEO_ELEMENT_F32 || column->info.element == RHEO_ELEMENT_U32 ? 4 : 8;
}

static bool is_named(const rheo_field_info *info, const char *name)
{
    return strcmp(info->name, name) == 0;
}

/* Makes room for the values of one more column. */
static rheo_result add_column(const rheo_field_info *info, rheo__columns *columns, rheo_error *error)
{
    if (columns->count == RHEO__MAX_COLUMNS)
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED, "particles have more than %d columns", RHEO__MAX_COLUMNS);
    rheo__column *c = &columns->column[columns->count];
    c->info = *info;
    c->values = info->bytes < SIZE_MAX ? malloc((size_t)info->bytes + 1) : NULL;
    if (!c->values)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the %s of %llu particles", info->name,
                          (unsigned long long)info->items);
    columns->count++;
    return RHEO_OK;
}

static rheo_result read_column(const rheo_world *world, uint32_t index, const rheo_field_info *info,
                               rheo__columns *columns, rheo_error *error)
{
    RHEO__TRY(add_column(info, columns, error));
    return rheo_world_field_read(world, index, columns->column[columns->count - 1].values, (size_t)info->bytes);
}

rheo_result rheo__columns_read(const rheo_world *world, rheo__columns *columns, rheo_error *error)
{
    columns->count = 0;
    rheo_result result = RHEO_OK;
    for (int first = 1; first >= 0; first--) {
        rheo_field_info info;
        for (uint32_t i = 0; result == RHEO_OK && rheo_world_field(world, i, &info) == RHEO_OK; i++)
            if (info.location == RHEO_LOCATION_PARTICLE && !info.ring && info.rows == 1 &&
                first == (is_named(&info, "position") || is_named(&info, "velocity")))
                result = read_column(world, i, &info, columns, error);
    }
    if (result != RHEO_OK)
        rheo__columns_release(columns);
    return result;
}

static bool has_column(const rheo__columns *columns, const char *name)
{
    for (uint32_t i = 0; i < columns->count; i++)
        if (is_named(&columns->column[i].info, name))
            return true;
    return false;
}

static rheo_result add_quantity(const rheo_quantity *quantity, const rheo_particle_state *states, uint32_t count,
                                rheo__columns *columns, rheo_error *error)
{
    const rheo_field_info info = {.name = quantity->name,
                                  .element = sizeof(rheo_real) == 8 ? RHEO_ELEMENT_F64 : RHEO_ELEMENT_F32,
                                  .location = RHEO_LOCATION_PARTICLE,
                                  .components = quantity->components,
                                  .rows = 1,
                                  .items = count,
                                  .bytes = (uint64_t)count * quantity->components * sizeof(rheo_real)};
    RHEO__TRY(add_column(&info, columns, error));
    rheo_real *to = columns->column[columns->count - 1].values;
    for (uint32_t id = 0; id < count; id++) {
        const double *from = (const double *)(const void *)((const char *)&states[id] + quantity->offset);
        for (uint32_t k = 0; k < quantity->components; k++)
            *to++ = (rheo_real)from[k];
    }
    return RHEO_OK;
}

rheo_result rheo__columns_read_quantities(const rheo_world *world, rheo__columns *columns, rheo_error *error)
{
    const uint32_t count = rheo_world_particle_count(world);
    const rheo_quantity *quantity;
    rheo_particle_state *states = calloc((size_t)count + 1, sizeof *states);
    rheo_result result =
        states ? rheo_world_particles(world, states, error)
               : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the states of %u particles", count);
    for (uint32_t i = 0; result == RHEO_OK && (quantity = rheo_world_quantity(world, i)) != NULL; i++)
        if (!has_column(columns, quantity->name))
            result = add_quantity(quantity, states, count, columns, error);
    free(states);
    if (result != RHEO_OK)
        rheo__columns_release(columns);
    return result;
}

void rheo__columns_release(rheo__columns *columns)
{
    for (uint32_t i = 0; i < columns->count; i++)
        free(columns->column[i].values);
    columns->count = 0;
}

const rheo_real *rheo__columns_reals(const rheo__columns *columns, const char *name)
{
    const rheo_element real = sizeof(rheo_real) == 8 ? RHEO_ELEMENT_F64 : RHEO_ELEMENT_F32;
    for (uint32_t i = 0; i < columns->count; i++)
        if (is_named(&columns->column[i].info, name) && columns->column[i].info.components == 1 &&
            columns->column[i].info.element == real)
            return columns->column[i].values;
    return NULL;
}

/* ---- The surface ---- */

/* Allocates and computes the volume of each particle, mass / density. NULL: no memory. */
static rheo_real *make_volumes(const rheo_world_def *def, const rheo_real *density, uint32_t count)
{
    const double mass = rheo__def_mass(def);
    rheo_real *volume = malloc(((size_t)count + 1) * sizeof *volume);
    for (uint32_t i = 0; volume && i < count; i++)
        volume[i] = (rheo_real)(mass / (double)density[i]);
    return volume;
}

static rheo_result make_surface(const rheo_world *world, const rheo_surface_options *options, const rheo_real *value,
                                const rheo_real *density, const rheo_allocator *allocator, rheo_surface *surface,
                                rheo_error *error)
{
    const rheo_world_def *def = rheo_world_definition(world);
    rheo_surface_particles particles = {.count = rheo_world_particle_count(world),
                                        .position = rheo_world_positions(world),
                                        .value = value,
                                        .spacing = def->fluid.spacing,
                                        .smoothing_length = def->fluid.spacing};
    if (rheo__model(def->model)->smoothing_length)
        particles.smoothing_length = rheo__model(def->model)->smoothing_length(def);
    rheo_real *volume = NULL;
    rheo_result result = RHEO_OK;
    if (density && !(particles.volume = volume = make_volumes(def, density, particles.count)))
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the surface of %u particles", particles.count);
    if (result == RHEO_OK)
        result = rheo_surface_make(&particles, options, allocator, surface, error);
    free(volume);
    return result;
}

rheo_result rheo__world_surface(const rheo_world *world, const rheo_surface_options *options, const rheo_real *value,
                                rheo_surface *surface, rheo_error *error)
{
    *surface = (rheo_surface){0};
    rheo__columns columns;
    RHEO__TRY(rheo__columns_read(world, &columns, error));
    const rheo_result result =
        make_surface(world, options, value, rheo__columns_reals(&columns, "density"), NULL, surface, error);
    rheo__columns_release(&columns);
    return result;
}

rheo_result rheo_world_surface(const rheo_world *world, const rheo_surface_options *options,
                               const rheo_allocator *allocator, rheo_surface *surface, rheo_error *error)
{
    *surface = (rheo_surface){0};
    rheo__columns columns;
    RHEO__TRY(rheo__columns_read(world, &columns, error));
    const rheo_result result = make_surface(world, options, rheo__columns_reals(&columns, "temperature"),
                                            rheo__columns_reals(&columns, "density"), allocator, surface, error);
    rheo__columns_release(&columns);
    return result;
}

/* ---- Extent ---- */

enum { AWAY = 6 }; /* standard deviations */

typedef struct crowd {
    double mean[3], limit[3]; /* largest distance from the mean along each axis */
    uint64_t count;
} crowd;

static bool counts(const crowd *c, const rheo_real *position)
{
    for (int a = 0; a < 3; a++) {
        const double away = (double)position[a] - c->mean[a];
        if (!(away <= c->limit[a] && -away <= c->limit[a]))
            return false;
    }
    return true;
}

/* Sigma clipping: repeats until no outlier is left, because every outlier increases the standard deviation. */
static crowd find_crowd(const rheo_real *position, uint32_t count)
{
    crowd c = {.limit = {1e30, 1e30, 1e30}};
    for (int pass = 0; pass < 16; pass++) {
        crowd next = {.count = 0};
        double squares[3] = {0, 0, 0};
        for (uint32_t i = 0; i < count; i++) {
            if (!counts(&c, position + 3 * (size_t)i))
                continue;
            next.count++;
            for (int a = 0; a < 3; a++)
                next.mean[a] += (double)position[3 * (size_t)i + a];
        }
        for (int a = 0; a < 3 && next.count; a++)
            next.mean[a] /= (double)next.count;
        for (uint32_t i = 0; i < count; i++) {
            for (int a = 0; a < 3 && counts(&c, position + 3 * (size_t)i); a++) {
                const double away = (double)position[3 * (size_t)i + a] - next.mean[a];
                squares[a] += away * away;
            }
        }
        /* Without the margins, rounding could drop every one of a few particles. */
        for (int a = 0; a < 3 && next.count; a++)
            next.limit[a] = AWAY * __builtin_sqrt(squares[a] / (double)next.count) * (1 + 1e-6) + 1e-12;
        if (next.count == 0 || next.count == c.count)
            return next.count ? next : c;
        c = next;
    }
    return c;
}

static void widen(rheo_extent *e, const double low[3], const double high[3])
{
    for (int a = 0; a < 3; a++) {
        e->min[a] = low[a] < e->min[a] ? low[a] : e->min[a];
        e->max[a] = high[a] > e->max[a] ? high[a] : e->max[a];
    }
}

static bool is_near(const rheo_extent *e, const rheo_body *ball)
{
    for (int a = 0; a < 3; a++) {
        const double reach = AWAY * (e->max[a] - e->min[a] + ball->radius);
        if (!(ball->position[a] >= e->min[a] - reach && ball->position[a] <= e->max[a] + reach))
            return false;
    }
    return true;
}

static void widen_by_facet(void *user, const rheo__facet *facet)
{
    for (int k = 0; k < 3; k++)
        widen(user, facet->corner[k], facet->corner[k]);
}

/* An obstacle that is near, and no larger than the fluid, is seen as a whole. */
static void widen_by_obstacle(rheo_extent *e, const rheo_world *world, uint32_t index)
{
    rheo_extent own = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}, 0, 1};
    const rheo_extent fluid = *e;
    rheo__obstacle_facets(world, index, widen_by_facet, &own);
    for (int a = 0; a < 3; a++) {
        const double size = own.max[a] - own.min[a], room = AWAY * (fluid.max[a] - fluid.min[a]);
        if (!(size <= 2 * (fluid.max[a] - fluid.min[a]) && own.min[a] >= fluid.min[a] - room - size &&
              own.max[a] <= fluid.max[a] + room + size))
            return;
    }
    widen(e, own.min, own.max);
}

static void widen_by_temperatures(rheo_extent *e, const rheo_world *world)
{
    rheo__columns columns;
    if (rheo__columns_read(world, &columns, NULL) != RHEO_OK)
        return;
    const rheo_real *temperature = rheo__columns_reals(&columns, "temperature");
    for (uint32_t i = 0; temperature && i < rheo_world_particle_count(world); i++) {
        const double t = (double)temperature[i];
        e->coldest = i == 0 || t < e->coldest ? t : e->coldest;
        e->hottest = i == 0 || t > e->hottest ? t : e->hottest;
    }
    rheo__columns_release(&columns);
}

rheo_extent rheo_world_extent(const rheo_world *world)
{
    const uint32_t count = rheo_world_particle_count(world);
    const rheo_real *position = rheo_world_positions(world);
    const double half = .5 * rheo_world_definition(world)->fluid.spacing;
    rheo_extent e = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}, 0, 1};
    const crowd c = find_crowd(position, count);
    for (uint32_t i = 0; i < count; i++) {
        const rheo_real *x = position + 3 * (size_t)i;
        if (counts(&c, x))
            widen(&e, (const double[3]){(double)x[0] - half, (double)x[1] - half, (double)x[2] - half},
                  (const double[3]){(double)x[0] + half, (double)x[1] + half, (double)x[2] + half});
    }
    for (uint32_t i = 0; i < rheo_world_body_count(world); i++) {
        rheo_body b;
        if (rheo_world_body(world, i, &b) != RHEO_OK || (e.min[0] <= e.max[0] && !is_near(&e, &b)))
            continue;
        const double *x = b.position, r = b.radius;
        widen(&e, (const double[3]){x[0] - r, x[1] - r, x[2] - r}, (const double[3]){x[0] + r, x[1] + r, x[2] + r});
    }
    const rheo_world_def *def = rheo_world_definition(world);
    for (uint32_t i = 0; i < rheo_world_obstacle_count(world); i++)
        if (!def->obstacles.list[i].inside)
            widen_by_obstacle(&e, world, i);
    if (e.min[0] > e.max[0]) /* the world is empty */
        widen(&e, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1});
    widen_by_temperatures(&e, world);
    return e;
}

rheo_extent rheo_extent_of_both(const rheo_extent *a, const rheo_extent *b)
{
    rheo_extent e = *a;
    widen(&e, b->min, b->max);
    e.coldest = b->coldest < e.coldest ? b->coldest : e.coldest;
    e.hottest = b->hottest > e.hottest ? b->hottest : e.hottest;
    return e;
}
