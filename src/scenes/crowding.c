/*
 * Examines whether the spacing of a scene fits the support. Pressure compares the density
 *
 *     rho = sum over the neighbours of (1 - r/h)^2,   h: the support,
 *
 * with fluid.rest_density. A spacing that was lowered alone, by fluid.spacing or by particles, leaves many neighbours
 * in the support, and the fluid flies apart in its first step. The particle nearest to the middle of each shape shows it.
 */
#include <math.h>
#include <stdio.h>

#include "core/strict.h"
#include "core/text.h"
#include "scenes/making.h"

/* Density at which the fluid is called compressed, in those at rest. As in overlap.c. */
static const double COMPRESSED = 1.5;
/* A lattice is examined up to such a support. */
static const double MOST_SPACINGS = 8;

static double weight(double distance, double support)
{
    const double w = 1 - distance / support;
    return w > 0 ? w * w : 0;
}

static double distance_of(const rheo_world_def *def, size_t id, const double x[3])
{
    double squared = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        const double d = (double)def->particles.position[3 * id + axis] - x[axis];
        squared += d * d;
    }
    return sqrt(squared);
}

/* Density of the particles [first, end) at that of them which is nearest to their middle. */
static double density_inside(const rheo_world_def *def, size_t first, size_t end)
{
    double x[3] = {0}, nearest = (double)INFINITY, density = -1; /* -1: the particle itself */
    size_t middle = first;
    for (size_t i = first; i < end; i++)
        for (size_t axis = 0; axis < 3; axis++)
            x[axis] += (double)def->particles.position[3 * i + axis] / (double)(end - first);
    for (size_t i = first; i < end; i++) {
        const double distance = distance_of(def, i, x);
        if (distance < nearest) {
            nearest = distance;
            middle = i;
        }
    }
    for (size_t axis = 0; axis < 3; axis++)
        x[axis] = (double)def->particles.position[3 * middle + axis];
    for (size_t i = first; i < end; i++)
        density += weight(distance_of(def, i, x), def->fluid.support);
    return density;
}

/* Density of a cubic lattice of spacing 1. */
static double lattice_density(double support)
{
    const int reach = (int)support;
    double density = -1;
    for (int i = -reach; i <= reach; i++)
        for (int j = -reach; j <= reach; j++)
            for (int k = -reach; k <= reach; k++)
                density += weight(sqrt(i * i + j * j + k * k), support);
    return density;
}

/* Support at which a cubic lattice of the spacing has the density at rest; no more than the present one. */
static double fitting_support(const rheo_world_def *def, double spacing)
{
    double low = 0, high = rheo__smaller(def->fluid.support / spacing, MOST_SPACINGS);
    for (int round = 0; round < 40; round++) {
        const double middle = (low + high) / 2;
        *(lattice_density(middle) < def->fluid.rest_density ? &low : &high) = middle;
    }
    return high * spacing;
}

static void warn_crowded(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings,
                         uint32_t shape, double density)
{
    const rheo_scene *scene = filling->scene;
    const double resolution = scene->world.fluid.spacing / filling->spacing;
    char times[32], support[32], spacings[32], number[32], finer[128] = "";
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_COMPRESSED);
    warning.shape = warning.other_shape = (int32_t)shape;
    warning.value = density / def->fluid.rest_density;
    warning.limit = COMPRESSED;
    if (scene->particles && resolution > 1 && resolution <= 10)
        snprintf(finer, sizeof finer,
                 "resolution=%s in place of particles=%llu, which scales the support as well, or ",
                 rheo__text_brief(resolution, 3, false, number), (unsigned long long)scene->particles);
    rheo__warn(
        warnings, warning,
        "the fluid of shape %u is compressed where it begins: its density is %s times fluid.rest_density, because "
        "fluid.support is %s spacings; expect it to fly apart; what helps: %sfluid.support=%s",
        shape, rheo__text_brief(warning.value, 3, false, times),
        rheo__text_brief(def->fluid.support / filling->spacing, 3, false, spacings), finer,
        rheo__text_brief(fitting_support(def, filling->spacing), 3, false, support));
}

void rheo__check_crowding(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings)
{
    const bool pressure = def->fluid.stiffness > 0 || def->fluid.near_stiffness > 0;
    const double most = COMPRESSED * def->fluid.rest_density, ratio = def->fluid.support / filling->spacing;
    if (def->model != RHEO_MODEL_THICKENING || !pressure || !(most > 0) ||
        !(lattice_density(rheo__smaller(ratio, MOST_SPACINGS)) > most)) /* or the shape itself has close particles */
        return;
    size_t first = 0;
    for (uint32_t shape = 0; shape < filling->scene->fill_count; shape++) {
        const size_t end = (size_t)filling->end[shape];
        const double density = end > first ? density_inside(def, first, end) : 0;
        first = end;
        if (!(density > most))
            continue;
        warn_crowded(filling, def, warnings, shape, density);
        return; /* all shapes have the same spacing */
    }
}
