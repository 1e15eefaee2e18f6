/* Opens a filling: checks the shapes, reads their data, chooses the spacing and counts. */
#include "scenes/fill.h"

#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "world/parameters.h"

static const rheo__shape *shape_of(const rheo__filling *filling, uint32_t f)
{
    return rheo__shape_of(filling->scene->fill[f].kind);
}

/* ---- Opening ---- */

static rheo_result open_shape(rheo__filling *filling, uint32_t f, rheo_error *error)
{
    const rheo_fill *fill = filling->scene->fill;
    const rheo__shape *shape = shape_of(filling, f);
    rheo_error inner = {""};
    if (!shape->open)
        return RHEO_OK;
    for (uint32_t other = 0; other < f && !filling->data[f]; other++)
        if (fill[other].kind == fill[f].kind && strcmp(fill[other].name, fill[f].name) == 0)
            filling->data[f] = filling->data[other];
    if (filling->data[f])
        return RHEO_OK;
    const rheo_result result = shape->open(&fill[f], &filling->allocator, &filling->data[f], &inner);
    return result == RHEO_OK ? RHEO_OK : rheo__fail(error, result, "shape %u: %.490s", f, inner.message);
}

static rheo_result check_scene(const rheo_scene *scene, rheo_error *error)
{
    char names[RHEO__MATERIALS_TEXT];
    if (scene->fill_count > RHEO_MAX_FILLS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u shapes; at most %d are possible",
                          scene->fill_count, RHEO_MAX_FILLS);
    if (!(scene->world.fluid.spacing >= 1e-12 && scene->world.fluid.spacing <= 1e12))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "fluid.spacing is %g; it must be from 1e-12 to 1e12",
                          scene->world.fluid.spacing);
    if (!(scene->resolution >= 0.1 && scene->resolution <= 10))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "resolution is %g; it must be from 0.1 to 10",
                          scene->resolution);
    if (scene->particles > RHEO__MAX_PARTICLES)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "particles is %llu; it must be at most 2^30",
                          (unsigned long long)scene->particles);
    for (uint32_t f = 0; f < scene->fill_count; f++) {
        rheo_error inner = {""};
        if (rheo_fill_check(&scene->fill[f], scene->world.model, &inner) != RHEO_OK)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: %.490s", f, inner.message);
        uint32_t material;
        if (!rheo_world_def_material(&scene->world, scene->fill[f].material, &material))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: there is no material \"%s\"; %s", f,
                              scene->fill[f].material, rheo__materials_text(&scene->world, names));
    }
    return RHEO_OK;
}

static rheo_result count_at_given_spacing(rheo__filling *filling, rheo_error *error)
{
    double size[3];
    for (uint32_t f = 0; f < filling->scene->fill_count; f++)
        if (!rheo__fill_size(filling, f, filling->spacing, size))
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "shape %u has %g x %g x %g spacings; a %s has at most %g along an axis: make it smaller "
                "or the spacing larger",
                f, size[0], size[1], size[2], shape_of(filling, f)->row.name, shape_of(filling, f)->max_points);
    RHEO__TRY(rheo__fill_count(filling, filling->spacing, &filling->count, error));
    return filling->count > RHEO__MAX_PARTICLES
               ? rheo__fail(error, RHEO_ERROR_ARGUMENT,
                            "the shapes hold more than 2^30 particles at a spacing of %g; make them smaller or the "
                            "spacing larger",
                            filling->spacing)
               : RHEO_OK;
}

rheo_result rheo__filling_open(rheo__filling *filling, const rheo_scene *scene, rheo_error *error)
{
    *filling = (rheo__filling){.scene = scene,
                               .allocator = rheo__allocator_or_default(scene->world.allocator),
                               .spacing = scene->world.fluid.spacing};
    RHEO__TRY(check_scene(scene, error));
    filling->data = rheo__allocate(&filling->allocator, (size_t)scene->fill_count + 1, sizeof *filling->data);
    if (!filling->data)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for %u shapes", scene->fill_count);
    for (uint32_t f = 0; f < scene->fill_count; f++) {
        RHEO__TRY(open_shape(filling, f, error));
        filling->has_temperatures = filling->has_temperatures || scene->fill[f].has_temperature;
    }
    if (scene->particles > 0)
        RHEO__TRY(rheo__fill_choose_spacing(filling, error));
    if (scene->particles > 0 && scene->resolution == 1)
        return RHEO_OK;
    filling->spacing /= scene->resolution;
    return count_at_given_spacing(filling, error);
}

void rheo__filling_close(rheo__filling *filling)
{
    for (uint32_t f = 0; filling->data && f < filling->scene->fill_count; f++) {
        bool shared = false;
        for (uint32_t later = f + 1; later < filling->scene->fill_count; later++)
            shared = shared || filling->data[later] == filling->data[f];
        if (filling->data[f] && !shared)
            shape_of(filling, f)->close(&filling->allocator, filling->data[f]);
    }
    rheo__release(&filling->allocator, filling->data);
    filling->data = NULL;
}

/* ---- Public functions ---- */

rheo_result rheo_scene_particle_count(const rheo_scene *scene, uint64_t *count, rheo_error *error)
{
    rheo__filling filling;
    const rheo_result result = rheo__filling_open(&filling, scene, error);
    *count = result == RHEO_OK ? filling.count : 0;
    rheo__filling_close(&filling);
    return result;
}

rheo_result rheo_scene_spacing(const rheo_scene *scene, double *spacing, rheo_error *error)
{
    rheo__filling filling;
    const rheo_result result = rheo__filling_open(&filling, scene, error);
    *spacing = result == RHEO_OK ? filling.spacing : 0;
    rheo__filling_close(&filling);
    return result;
}
