/*
 * Filling shapes with particles: points of a cubic lattice whose distance is the fluid's spacing, each displaced a
 * little at random, so that a settling fluid does not keep the symmetry of the lattice. Particles come shape by
 * shape, z slowest, x fastest.
 */
#include "scenes/fill.h"

#include "core/strict.h"

typedef struct lattice {
    int64_t low[3], high[3]; /* first and last point along each axis; empty if high < low */
    double origin[3];        /* where point 0, 0, 0 lies */
    double radius2;          /* points farther from the origin are left out; < 0: none are */
} lattice;

/* Whole numbers by conversion: the values are far below 2^52 (rheo_scene_check). */
static int64_t round_half_up(double x)
{
    int64_t whole = (int64_t)(x + 0.5);
    return whole - ((double)whole > x + 0.5);
}

static lattice lattice_of(const rheo_fill *fill, double spacing)
{
    lattice l;
    l.radius2 = -1;
    for (int axis = 0; axis < 3; axis++) {
        if (fill->kind == RHEO_FILL_BLOCK) {
            l.low[axis] = 0;
            l.high[axis] = round_half_up((fill->max[axis] - fill->min[axis]) / spacing) - 1;
            l.origin[axis] = fill->min[axis] + spacing / 2;
        } else {
            /* One more than fits, so that rounding loses none. */
            l.high[axis] = (int64_t)(fill->radius / spacing) + 1;
            l.low[axis] = -l.high[axis];
            l.origin[axis] = fill->centre[axis];
            double radius = fill->radius / spacing * (1 + 1e-9);
            l.radius2 = radius * radius;
        }
    }
    return l;
}

static bool inside(const lattice *l, int64_t x, int64_t y, int64_t z)
{
    return l->radius2 < 0 || (double)(x * x + y * y + z * z) <= l->radius2;
}

/* How many points of a sphere's lattice are inside, row by row: one by one, a large one takes seconds. */
static uint64_t count_sphere(const lattice *l)
{
    const int64_t radius2 = (int64_t)l->radius2; /* all squares are whole */
    uint64_t count = 0;
    for (int64_t z = l->low[2]; z <= l->high[2]; z++)
        for (int64_t y = l->low[1]; y <= l->high[1]; y++) {
            const int64_t left = radius2 - y * y - z * z;
            if (left < 0)
                continue;
            int64_t x = (int64_t)__builtin_sqrt((double)left);
            x += (x + 1) * (x + 1) <= left;
            x -= x * x > left;
            count += 2 * (uint64_t)x + 1;
        }
    return count;
}

/* Whether the points along each axis can be counted at all. */
static bool fits(const rheo_fill *fill, double spacing)
{
    bool all = true;
    for (int axis = 0; axis < 3; axis++) {
        double size = fill->kind == RHEO_FILL_SPHERE ? fill->radius : fill->max[axis] - fill->min[axis];
        all = all && size >= -1e9 * spacing && size <= 1e9 * spacing;
    }
    return all;
}

uint64_t rheo_scene_particle_count(const rheo_scene *scene)
{
    const uint64_t many = UINT64_C(1) << 31; /* more than a world can have */
    uint64_t count = 0;
    for (uint32_t f = 0; f < scene->fill_count && f < RHEO_MAX_FILLS; f++) {
        if (!fits(&scene->fill[f], scene->world.fluid.spacing))
            return many;
        lattice l = lattice_of(&scene->fill[f], scene->world.fluid.spacing);
        double points = 1;
        for (int axis = 0; axis < 3; axis++)
            points *= l.high[axis] < l.low[axis] ? 0 : (double)(l.high[axis] - l.low[axis] + 1);
        if (points > 4e9) /* even a sphere fills half of that */
            return many;
        if (l.radius2 < 0) {
            count += (uint64_t)points;
            continue;
        }
        count += count_sphere(&l);
        if (count > many)
            return many;
    }
    return count;
}

/* splitmix64 (Steele, Lea, Flood 2014): 53 random bits in [-1, 1). */
static double random_sign(uint64_t *random)
{
    uint64_t x = *random += UINT64_C(0x9E3779B97F4A7C15);
    x = (x ^ x >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ x >> 27) * UINT64_C(0x94D049BB133111EB);
    x ^= x >> 31;
    return (double)(x >> 11) * (2.0 / 9007199254740992.0) - 1;
}

void rheo_scene_fill(const rheo_scene *scene, rheo_real *position, rheo_real *velocity)
{
    double spacing = scene->world.fluid.spacing;
    uint64_t random = scene->seed;
    for (uint32_t f = 0; f < scene->fill_count; f++) {
        const rheo_fill *fill = &scene->fill[f];
        lattice l = lattice_of(fill, spacing);
        for (int64_t z = l.low[2]; z <= l.high[2]; z++)
            for (int64_t y = l.low[1]; y <= l.high[1]; y++)
                for (int64_t x = l.low[0]; x <= l.high[0]; x++) {
                    if (!inside(&l, x, y, z))
                        continue;
                    const int64_t point[3] = {x, y, z};
                    for (int axis = 0; axis < 3; axis++) {
                        double at = l.origin[axis] + spacing * (double)point[axis];
                        if (fill->jitter > 0)
                            at += spacing * fill->jitter * random_sign(&random);
                        *position++ = (rheo_real)at;
                        *velocity++ = (rheo_real)fill->velocity[axis];
                    }
                }
    }
}
