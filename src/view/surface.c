/* Makes the free surface: checks, chi on a grid (grid.h), and its isosurface (marching_cubes.h). */
#include "core/environment.h"
#include "core/error.h"
#include "core/real.h"
#include "view/marching_cubes.h"

rheo_surface_options rheo_default_surface_options(void)
{
    return (rheo_surface_options){.isovalue = .5, .resolution = 2};
}

static rheo_result check_length(double length, const char *name, rheo_error *error)
{
    if (length >= 1e-12 && length <= 1e12)
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the %s of a surface's particles must be 1e-12..1e12, but is %g",
                      name, length);
}

static rheo_result check(const rheo_surface_particles *p, const rheo_surface_options *options, rheo_error *error)
{
    if (!(options->isovalue > 0 && options->isovalue < 1))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the isovalue of a surface must be between 0 and 1, both excluded, but is %g",
                          options->isovalue);
    if (!(options->resolution >= .5 && options->resolution <= 8))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the resolution of a surface must be 0.5..8 cells in a smoothing length, but is %g",
                          options->resolution);
    RHEO__TRY(check_length(p->smoothing_length, "smoothing length", error));
    if (!p->volume)
        RHEO__TRY(check_length(p->spacing, "spacing", error));
    for (uint32_t i = 0; i < p->count; i++) {
        const rheo_real *x = p->position + 3 * (size_t)i;
        const rheo_real zero = (x[0] - x[0]) + (x[1] - x[1]) + (x[2] - x[2]); /* NaN if a coordinate is not finite */
        const rheo_real value = p->value ? p->value[i] : 0, volume = p->volume ? p->volume[i] : 0;
        if (zero != 0 || value - value != 0 || !(volume >= 0) || volume - volume != 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "particle %u has a position, volume or value that a surface cannot be made of", i);
    }
    return RHEO_OK;
}

rheo_result rheo_surface_make(const rheo_surface_particles *particles, const rheo_surface_options *options,
                              const rheo_allocator *allocator, rheo_surface *surface, rheo_error *error)
{
    *surface = (rheo_surface){0};
    RHEO__TRY(rheo__check_environment(error));
    RHEO__TRY(check(particles, options, error));
    surface->allocator = rheo__allocator_or_default(allocator ? *allocator : (rheo_allocator){NULL, NULL, NULL});
    rheo__grid grid;
    RHEO__TRY(rheo__grid_make(&grid, particles, options, &surface->allocator, error));
    const rheo_result result = rheo__march(&grid, options->isovalue, surface, error);
    surface->left_out = grid.left_out;
    rheo__grid_release(&grid, &surface->allocator);
    if (result != RHEO_OK)
        rheo_surface_release(surface);
    return result;
}

void rheo_surface_release(rheo_surface *surface)
{
    rheo__release(&surface->allocator, surface->position);
    rheo__release(&surface->allocator, surface->normal);
    rheo__release(&surface->allocator, surface->value);
    rheo__release(&surface->allocator, surface->triangle);
    *surface = (rheo_surface){0};
}
