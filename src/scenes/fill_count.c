/* Counts the particles at a spacing, and finds the spacing for a number of particles. */
#include "core/error.h"
#include "core/strict.h"
#include "scenes/fill.h"

#define MAX_POINTS 4e9 /* largest lattice around a shape, because rows are counted one by one */

/* ---- Counting ---- */

static bool count_run(void *user, int64_t x, int64_t end, int64_t y, int64_t z)
{
    uint64_t *count = user;
    (void)y, (void)z;
    *count += (uint64_t)(end - x);
    return *count <= RHEO__MAX_PARTICLES;
}

rheo_result rheo__fill_count(const rheo__filling *filling, double spacing, uint64_t *count, rheo_error *error)
{
    *count = 0;
    for (uint32_t f = 0; f < filling->scene->fill_count && *count <= RHEO__MAX_PARTICLES; f++) {
        double points = 1;
        rheo__lattice l;
        if (rheo__fill_lattice(filling, f, spacing, &l)) {
            for (int axis = 0; axis < 3; axis++)
                points *= l.high[axis] < l.low[axis] ? 0 : (double)(l.high[axis] - l.low[axis] + 1);
        } else {
            points = 2 * MAX_POINTS;
        }
        if (points > MAX_POINTS) /* a sphere fills about half of its lattice */
            *count = RHEO__MAX_PARTICLES + 1;
        else if (!rheo__shape_of(filling->scene->fill[f].kind)->run) /* every point is inside */
            *count += (uint64_t)points;
        else
            RHEO__TRY(rheo__fill_run(filling, f, spacing, &l, count_run, count, error));
    }
    return RHEO_OK;
}

/* ---- The spacing for a number of particles ---- */

typedef struct search {
    const rheo__filling *filling;
    double best; /* spacing with the nearest count; 0: none yet */
    uint64_t best_count, miss;
} search;

static bool is_exact(const search *s)
{
    return s->best > 0 && s->miss == 0;
}

/* Counts at a spacing and keeps it if it is nearer than all earlier ones. */
static rheo_result try_spacing(search *s, double spacing, uint64_t *count, rheo_error *error)
{
    const uint64_t wanted = s->filling->scene->particles;
    RHEO__TRY(rheo__fill_count(s->filling, spacing, count, error));
    const uint64_t miss = *count > wanted ? *count - wanted : wanted - *count;
    if (*count > 0 && *count <= RHEO__MAX_PARTICLES && (s->best == 0 || miss < s->miss)) {
        s->best = spacing;
        s->best_count = *count;
        s->miss = miss;
    }
    return RHEO_OK;
}

/*
 * Bisection. The number of particles falls with the spacing, but not monotonically, so the best of all tried spacings
 * is used. The search doubles or halves the scene's spacing first, so the result depends on the scene only.
 */
rheo_result rheo__fill_choose_spacing(rheo__filling *filling, rheo_error *error)
{
    enum { HALVINGS = 40 };
    const double finest = 1e-12, coarsest = 1e12;
    const uint64_t wanted = filling->scene->particles;
    search s = {.filling = filling};
    double low = filling->scene->world.fluid.spacing, high = low; /* low has too many particles, high has too few */
    uint64_t count;
    RHEO__TRY(try_spacing(&s, low, &count, error));
    if (count >= wanted) {
        while (count >= wanted && !is_exact(&s) && 2 * high <= coarsest) {
            low = high;
            high *= 2;
            RHEO__TRY(try_spacing(&s, high, &count, error));
        }
    } else {
        while (count < wanted && low / 2 >= finest) {
            high = low;
            low /= 2;
            RHEO__TRY(try_spacing(&s, low, &count, error));
        }
    }
    for (int i = 0; i < HALVINGS && !is_exact(&s); i++) {
        const double middle = low + (high - low) / 2;
        RHEO__TRY(try_spacing(&s, middle, &count, error));
        if (count >= wanted)
            low = middle;
        else
            high = middle;
    }
    if (s.best == 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "particles is %llu, but no spacing fills the shapes with that many: they are empty, or too "
                          "large",
                          (unsigned long long)wanted);
    filling->spacing = s.best;
    filling->count = s.best_count;
    return RHEO_OK;
}
