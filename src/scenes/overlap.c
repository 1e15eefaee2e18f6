/*
 * Examines the distances of the particles of a scene. Particles closer than half the spacing are thrown apart. Two
 * shapes in the same place, whose lattices are shifted, need not have such pairs: there the density shows it,
 *
 *     density = sum over the particles, with itself, of (1 - r/R)^2,   r < R = 1.5 spacings,
 *
 * compared with that of the lattice of one shape, which is fluid at rest.
 */
#include <math.h>
#include <stdio.h>

#include "core/strict.h"
#include "core/text.h"
#include "scenes/making.h"

/* R in spacings, and the density at which the fluid is called compressed, in those at rest. Blocks that touch, half a
 * spacing apart, have up to 1.35; nested ones 1.8. */
static const double REACH = 1.5, COMPRESSED = 1.5;

/* Pairs of particles closer than the least distance. */
typedef struct closeness {
    uint64_t count;
    double nearest;
} closeness;

typedef struct inspection {
    const rheo__filling *filling;
    const rheo_world_def *def;
    rheo__warnings *warnings;
    uint32_t shapes;
    double least; /* distance of particles, L: closer ones are thrown apart (docs/model.md, Stability) */
    double reach; /* distance up to which pairs are examined */

    /* Particles by cells, which are twice as wide as the reach. */
    uint32_t *first, *next; /* 1 + id; 0: none */
    uint64_t mask;

    closeness *close; /* by pairs of shapes */
    float *density;   /* of each particle; NULL: there is one shape */
} inspection;

static void position_of(const inspection *c, size_t id, double x[3])
{
    for (size_t axis = 0; axis < 3; axis++)
        x[axis] = (double)c->def->particles.position[3 * id + axis];
}

static uint32_t shape_of(const inspection *c, size_t id)
{
    uint32_t shape = 0;
    while (c->filling->end[shape] <= id)
        shape++;
    return shape;
}

static closeness *close_of(const inspection *c, uint32_t shape, uint32_t other)
{
    return &c->close[(size_t)shape * c->shapes + other];
}

static double weight(double distance, double reach)
{
    const double w = 1 - distance / reach;
    return w > 0 ? w * w : 0;
}

static double distance2(const double a[3], const double b[3])
{
    const double between[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return between[0] * between[0] + between[1] * between[1] + between[2] * between[2];
}

/* ---- Pairs ---- */

static uint64_t cell_hash(const int64_t cell[3])
{
    uint64_t hash = (uint64_t)cell[0] * UINT64_C(0x9E3779B97F4A7C15) ^
                    (uint64_t)cell[1] * UINT64_C(0xC2B2AE3D27D4EB4F) ^
                    (uint64_t)cell[2] * UINT64_C(0x165667B19E3779F9);
    return hash ^ hash >> 29;
}

/* Cell of a position, and to which side of its middle the position is. False: too far away for a number. */
static bool cell_of(const inspection *c, const double x[3], int64_t cell[3], int side[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const double at = x[axis] / (2 * c->reach);
        if (!(at > -1e15 && at < 1e15))
            return false;
        cell[axis] = (int64_t)at - (at < 0);
        side[axis] = at - (double)cell[axis] < 0.5 ? -1 : 1;
    }
    return true;
}

/* Compares a particle with those before it in one cell; others that share its hash are as good, or too far away. */
static void compare(const inspection *c, uint64_t slot, size_t id, uint32_t shape, const double x[3])
{
    for (uint32_t k = c->first[slot]; k; k = c->next[k - 1]) {
        double other[3];
        position_of(c, k - 1, other);
        const double squared = distance2(x, other);
        if (!(squared < c->reach * c->reach))
            continue;
        const double distance = sqrt(squared);
        if (c->density) {
            c->density[id] += (float)weight(distance, c->reach);
            c->density[k - 1] += (float)weight(distance, c->reach);
        }
        if (!(squared < c->least * c->least))
            continue;
        closeness *close = close_of(c, shape, shape_of(c, k - 1));
        close->nearest = close->count == 0 || distance < close->nearest ? distance : close->nearest;
        close->count++;
    }
}

/* Finds the pairs within the reach. Particles within half a width are in the cells to the nearer sides. */
static void find_pairs(inspection *c)
{
    uint32_t shape = 0;
    for (size_t i = 0; i < c->def->particles.count; i++) {
        double x[3];
        int64_t cell[3];
        int side[3];
        uint64_t seen[8];
        while (c->filling->end[shape] <= i)
            shape++;
        position_of(c, i, x);
        if (!cell_of(c, x, cell, side))
            continue;
        for (uint32_t corner = 0; corner < 8; corner++) {
            const int64_t near[3] = {cell[0] + (corner & 1 ? side[0] : 0), cell[1] + (corner & 2 ? side[1] : 0),
                                     cell[2] + (corner & 4 ? side[2] : 0)};
            seen[corner] = cell_hash(near) & c->mask;
            bool again = false;
            for (uint32_t before = 0; before < corner; before++)
                again = again || seen[before] == seen[corner];
            if (!again)
                compare(c, seen[corner], i, shape, x);
        }
        c->next[i] = c->first[seen[0]];
        c->first[seen[0]] = (uint32_t)i + 1;
    }
}

/* ---- Warnings ---- */

static void warn_overlap(const inspection *c, uint32_t shape, uint32_t other, const closeness *close)
{
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_OVERLAP);
    warning.shape = (int32_t)other;
    warning.other_shape = (int32_t)shape;
    warning.count = close->count;
    warning.value = close->nearest;
    warning.limit = c->least;
    const double jitter = c->filling->scene->fill[shape].jitter;
    char cure[96], number[32], which[64];
    if (shape == other && jitter > 0)
        rheo__text_print(cure, sizeof cure, "give shape %u less jitter than %s", shape,
                         rheo__text_brief(jitter, 6, false, number));
    else if (shape == other) /* positions were rounded to the same numbers */
        rheo__text_print(cure, sizeof cure, "move the scene to the origin, where positions are exact enough");
    else
        rheo__text_print(cure, sizeof cure, "leave a spacing, %s, between the particles of the two",
                         rheo__text_brief(c->filling->spacing, 3, false, number));
    if (shape == other)
        rheo__text_print(which, sizeof which, "particles of shape %u", shape);
    else
        rheo__text_print(which, sizeof which, "shapes overlap, %u and %u", other, shape);
    rheo__warn(c->warnings, warning,
               "%s: %llu pair%s of particles %s closer than half the spacing, the nearest at %s; they will "
               "be thrown apart; %s",
               which, (unsigned long long)close->count, close->count == 1 ? "" : "s",
               close->count == 1 ? "is" : "are", rheo__text_brief(close->nearest, 3, false, number), cure);
}

/* Density of a lattice of one shape. */
static double density_at_rest(void)
{
    double sum = 0;
    for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++)
            for (int z = -1; z <= 1; z++)
                sum += weight(sqrt((double)(x * x + y * y + z * z)), REACH);
    return sum;
}

/*
 * The shape, other than its own, that adds most to the density of a particle; its own if none adds a quarter of the
 * density at rest: then jitter makes it dense.
 */
static uint32_t second_shape(const inspection *c, size_t id)
{
    const uint32_t own = shape_of(c, id);
    uint32_t most = own;
    double x[3], share[RHEO_MAX_FILLS] = {0};
    position_of(c, id, x);
    uint32_t shape = 0;
    for (size_t i = 0; i < c->def->particles.count; i++) {
        double other[3];
        while (c->filling->end[shape] <= i)
            shape++;
        position_of(c, i, other);
        const double squared = distance2(x, other);
        if (squared < c->reach * c->reach)
            share[shape] += weight(sqrt(squared), c->reach);
    }
    share[own] = density_at_rest() / 4;
    for (uint32_t s = 0; s < c->shapes; s++)
        most = share[s] > share[most] ? s : most;
    return most;
}

static void warn_compressed(const inspection *c, uint32_t shape, uint32_t other, size_t densest, uint64_t count)
{
    double x[3];
    char value[32], at[3][32];
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_COMPRESSED);
    warning.shape = (int32_t)shape;
    warning.other_shape = (int32_t)other;
    warning.count = count;
    warning.value = ((double)c->density[densest] + 1) / density_at_rest();
    warning.limit = COMPRESSED;
    position_of(c, densest, x);
    for (int axis = 0; axis < 3; axis++)
        rheo__text_brief(x[axis], 4, false, at[axis]);
    rheo__warn(
        c->warnings, warning,
        "the fluid is compressed where it begins: its density is %s times that at rest at [%s, %s, %s]; shapes "
        "%u and %u are in the same place there: move one of them, or leave it out",
        rheo__text_brief(warning.value, 3, false, value), at[0], at[1], at[2], shape, other);
}

static void check_density(const inspection *c)
{
    const double most = COMPRESSED * density_at_rest() - 1; /* the particle itself has a weight of 1 */
    size_t densest[RHEO_MAX_FILLS] = {0};                   /* of each shape */
    uint64_t above[RHEO_MAX_FILLS] = {0};
    bool told[RHEO_MAX_FILLS][RHEO_MAX_FILLS] = {{false}};
    for (size_t i = 0; i < c->def->particles.count; i++) {
        const uint32_t s = shape_of(c, i);
        if (!((double)c->density[i] > most))
            continue;
        if (above[s]++ == 0 || c->density[i] > c->density[densest[s]])
            densest[s] = i;
    }
    for (uint32_t s = 0; s < c->shapes; s++) {
        const uint32_t other = above[s] ? second_shape(c, densest[s]) : s, low = s < other ? s : other,
                       high = s < other ? other : s;
        if (other == s || told[low][high] || close_of(c, high, low)->count) /* or what overlaps is told already */
            continue;
        told[low][high] = true;
        warn_compressed(c, low, high, densest[s], above[low] + above[high]);
    }
}

rheo_result rheo__check_overlaps(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings,
                                 rheo_error *error)
{
    const rheo_allocator *allocator = &filling->allocator;
    const uint32_t count = def->particles.count, shapes = filling->scene->fill_count;
    inspection c = {.filling = filling,
                    .def = def,
                    .warnings = warnings,
                    .shapes = shapes,
                    .least = 0.5 * filling->spacing * (1 - 1e-3),
                    .mask = 1};
    c.reach = shapes > 1 ? REACH * filling->spacing : c.least;
    while (c.mask < count)
        c.mask = 2 * c.mask + 1;
    c.first = rheo__allocate(allocator, (size_t)c.mask + 1, sizeof *c.first);
    c.next = rheo__allocate(allocator, (size_t)count + 1, sizeof *c.next);
    c.close = rheo__allocate(allocator, (size_t)shapes * shapes + 1, sizeof *c.close);
    c.density = shapes > 1 ? rheo__allocate(allocator, (size_t)count + 1, sizeof *c.density) : NULL;
    const bool enough = c.first && c.next && c.close && (c.density || shapes <= 1);
    if (enough)
        find_pairs(&c);
    for (uint32_t s = 0; enough && s < shapes; s++)
        for (uint32_t other = 0; other <= s; other++)
            if (close_of(&c, s, other)->count)
                warn_overlap(&c, s, other, close_of(&c, s, other));
    if (enough && c.density)
        check_density(&c);
    rheo__release(allocator, c.first);
    rheo__release(allocator, c.next);
    rheo__release(allocator, c.close);
    rheo__release(allocator, c.density);
    return enough ? RHEO_OK
                  : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine the distances of %u particles", count);
}
