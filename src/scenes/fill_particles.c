/* The particles of a filling: positions, velocities, densities and temperatures. */
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "scenes/fill.h"
#include "world/model.h"

/* Random number in [-1, 1) with 53 bits: splitmix64 (Steele, Lea, Flood 2014). */
static double random_sign(uint64_t *random)
{
    uint64_t x = *random += UINT64_C(0x9E3779B97F4A7C15);
    x = (x ^ x >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ x >> 27) * UINT64_C(0x94D049BB133111EB);
    x ^= x >> 31;
    return (double)(x >> 11) * (2.0 / 9007199254740992.0) - 1;
}

typedef struct writer {
    const rheo_fill *fill;
    double spacing, origin[3];
    uint64_t random;
    size_t used, room;
    rheo_real *position, *velocity;
} writer;

static bool write_run(void *user, int64_t from, int64_t end, int64_t y, int64_t z)
{
    writer *w = user;
    for (int64_t x = from; x < end && w->used < w->room; x++, w->used++) {
        const int64_t point[3] = {x, y, z};
        for (size_t axis = 0; axis < 3; axis++) {
            double at = w->origin[axis] + w->spacing * (double)point[axis];
            if (w->fill->jitter > 0)
                at += w->spacing * w->fill->jitter * random_sign(&w->random);
            w->position[3 * w->used + axis] = (rheo_real)at;
            w->velocity[3 * w->used + axis] = (rheo_real)w->fill->velocity[axis];
        }
    }
    return true;
}

/* Sets the densities of a fluid at rest under gravity. The highest particle against gravity has the rest density. */
static void write_densities(const rheo_world_def *def, const rheo_fill *fill, const rheo_real *position,
                            rheo_real *density, size_t count)
{
    const rheo__model_type *type = rheo__model(def->model);
    const double *g = def->gravity;
    double top = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < count; i++) {
            const rheo_real *x = position + 3 * i;
            double along = g[0] * (double)x[0] + g[1] * (double)x[1] + g[2] * (double)x[2];
            if (pass == 1)
                density[i] = (rheo_real)type->density(def, fill->not_hydrostatic ? 0 : along - top);
            else if (i == 0 || along < top)
                top = along;
        }
}

static void write_temperatures(const rheo_world_def *def, const rheo_fill *fill, const rheo_real *position,
                               rheo_real *temperature, size_t count)
{
    const double own = rheo__model(def->model)->temperature(def);
    rheo_real low = count ? position[1] : 0, high = low;
    for (size_t i = 0; i < count; i++) {
        rheo_real y = position[3 * i + 1];
        low = y < low ? y : low;
        high = y > high ? y : high;
    }
    for (size_t i = 0; i < count; i++) {
        rheo_real y = position[3 * i + 1];
        double bottom = fill->temperature[0], top = fill->temperature[1], value = own;
        if (fill->has_temperature)
            value = y == low ? bottom
                    : y == high
                        ? top
                        : bottom + (top - bottom) * (((double)y - (double)low) / ((double)high - (double)low));
        temperature[i] = (rheo_real)value;
    }
}

rheo_result rheo__filling_make(rheo__filling *filling, rheo_real *position, rheo_real *velocity, rheo_real *density,
                               rheo_real *temperature, uint32_t *material, rheo_error *error)
{
    const rheo_scene *scene = filling->scene;
    writer w = {.spacing = filling->spacing,
                .random = scene->seed,
                .room = (size_t)filling->count,
                .position = position,
                .velocity = velocity};
    for (uint32_t f = 0; f < scene->fill_count; f++) {
        const size_t begin = w.used;
        rheo__lattice l;
        filling->end[f] = begin;
        if (!rheo__fill_lattice(filling, f, filling->spacing, &l))
            continue; /* cannot happen: opening refuses it */
        w.fill = &scene->fill[f];
        memcpy(w.origin, l.origin, sizeof w.origin);
        RHEO__TRY(rheo__fill_run(filling, f, filling->spacing, &l, write_run, &w, error));
        const size_t count = w.used - begin;
        filling->end[f] = w.used;
        uint32_t number = 0;
        rheo_world_def_material(&scene->world, w.fill->material, &number);
        for (size_t i = begin; material && i < w.used; i++)
            material[i] = number;
        if (density)
            write_densities(&scene->world, w.fill, position + 3 * begin, density + begin, count);
        if (temperature)
            write_temperatures(&scene->world, w.fill, position + 3 * begin, temperature + begin, count);
    }
    return RHEO_OK;
}
