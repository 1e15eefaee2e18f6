/*
 * Filling shapes with particles: points of a cubic lattice whose distance is the fluid's spacing, each displaced a
 * little at random, so that a settling fluid does not keep the symmetry of the lattice. Particles come shape by
 * shape, z slowest, x fastest.
 *
 * Where the lattice of a shape lies:
 *   block          half a spacing inside its corner `min`, round(size/spacing) points along each axis
 *   sphere         a point in its centre
 *   mesh, letters  half a spacing above its underside; along x and z as if a block of its size were filled, with the
 *                  middle of the lattice in its middle
 * Points in a mesh: mesh.c. A point in a text: in a dot that is set.
 */
#include "scenes/fill.h"

#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "scenes/letters.h"

#define MOST_PARTICLES (UINT64_C(1) << 30)
/* A lattice has at most so many points around a shape, and a mesh or text so many along an axis: rows are counted. */
#define MOST_POINTS 4e9
#define MOST_ALONG_AXIS 65536

typedef struct lattice {
    int64_t low[3], high[3]; /* first and last point along each axis; empty if high < low */
    double origin[3];        /* where point 0, 0, 0 lies */
    double size[3];          /* mesh, letters: of the shape, in spacings */
    double scale;            /* mesh: spacings per unit of its file */
} lattice;

/* Whole numbers by conversion: the values are far below 2^52 (fits()). */
static int64_t round_half_up(double x)
{
    int64_t whole = (int64_t)(x + 0.5);
    return whole - ((double)whole > x + 0.5);
}

static int64_t round_up(double x)
{
    int64_t whole = (int64_t)x;
    return whole + ((double)whole < x);
}

static const rheo__mesh *mesh_of(const rheo__filling *filling, uint32_t f)
{
    return &filling->mesh[filling->mesh_of[f]];
}

/* Size of what bounds a shape, L. */
static void size_of(const rheo__filling *filling, uint32_t f, double size[3])
{
    const rheo_fill *fill = &filling->scene->fill[f];
    const rheo__mesh *mesh = mesh_of(filling, f);
    for (int axis = 0; axis < 3; axis++)
        switch (fill->kind) {
        case RHEO_FILL_BLOCK:
            size[axis] = fill->max[axis] - fill->min[axis];
            break;
        case RHEO_FILL_SPHERE:
            size[axis] = fill->radius;
            break;
        case RHEO_FILL_MESH:
            size[axis] = mesh->high[axis] - mesh->low[axis];
            if (fill->height > 0)
                size[axis] *= fill->height / (mesh->high[1] - mesh->low[1]);
            break;
        case RHEO_FILL_LETTERS:
            size[axis] = axis == 1 ? fill->height : fill->depth;
            if (axis == 0)
                size[axis] =
                    fill->height / RHEO__LETTER_ROWS * (RHEO__LETTER_ADVANCE * (double)strlen(fill->name) - 1);
            break;
        }
}

/* Whether the points along each axis can be counted at all. */
static bool fits(const rheo__filling *filling, uint32_t f, double spacing)
{
    double size[3];
    rheo_fill_kind kind = filling->scene->fill[f].kind;
    bool all = true;
    size_of(filling, f, size);
    for (int axis = 0; axis < 3; axis++) {
        double most = (kind == RHEO_FILL_BLOCK || kind == RHEO_FILL_SPHERE ? 1e9 : MOST_ALONG_AXIS) * spacing;
        all = all && size[axis] >= -most && size[axis] <= most;
    }
    return all;
}

static lattice lattice_of(const rheo__filling *filling, uint32_t f, double spacing)
{
    const rheo_fill *fill = &filling->scene->fill[f];
    lattice l = {.scale = 1 / spacing};
    size_of(filling, f, l.size);
    if (fill->kind == RHEO_FILL_MESH && fill->height > 0)
        l.scale = fill->height / (mesh_of(filling, f)->high[1] - mesh_of(filling, f)->low[1]) / spacing;
    for (int axis = 0; axis < 3; axis++) {
        if (fill->kind == RHEO_FILL_SPHERE) {
            /* One more than fits, so that rounding loses none. */
            l.high[axis] = (int64_t)(fill->radius / spacing) + 1;
            l.low[axis] = -l.high[axis];
            l.origin[axis] = fill->centre[axis];
            continue;
        }
        l.size[axis] /= spacing;
        l.high[axis] = round_half_up(l.size[axis]) - 1;
        if (fill->kind == RHEO_FILL_BLOCK)
            l.origin[axis] = fill->min[axis] + spacing / 2;
        else
            l.origin[axis] = fill->position[axis] + spacing * (axis == 1 ? 0.5 : -0.5 * (double)l.high[axis]);
    }
    return l;
}

/* ---- Rows of points ---- */

static void run_block(const lattice *l, rheo__run *run, void *user)
{
    for (int64_t z = 0; z <= l->high[2]; z++)
        for (int64_t y = 0; y <= l->high[1]; y++)
            if (l->high[0] >= 0 && !run(user, 0, l->high[0] + 1, y, z))
                return;
}

static void run_sphere(const lattice *l, double radius, rheo__run *run, void *user)
{
    const int64_t radius2 = (int64_t)(radius * (1 + 1e-9) * (radius * (1 + 1e-9))); /* all squares are whole */
    for (int64_t z = l->low[2]; z <= l->high[2]; z++)
        for (int64_t y = l->low[1]; y <= l->high[1]; y++) {
            const int64_t left = radius2 - y * y - z * z;
            if (left < 0)
                continue;
            int64_t x = (int64_t)__builtin_sqrt((double)left);
            x += (x + 1) * (x + 1) <= left;
            x -= x * x > left;
            if (!run(user, -x, x + 1, y, z))
                return;
        }
}

static rheo_result run_mesh(const rheo__mesh *mesh, const lattice *l, rheo__run *run, void *user, rheo_error *error)
{
    rheo__mesh_frame frame = {.scale = l->scale};
    for (int axis = 0; axis < 3; axis++) {
        frame.base[axis] = axis == 1 ? mesh->low[1] : mesh->low[axis] + (mesh->high[axis] - mesh->low[axis]) / 2;
        frame.shift[axis] = axis == 1 ? -0.5 : 0.5 * (double)l->high[axis];
    }
    return rheo__mesh_scan(mesh, &frame, run, user, error);
}

/* The first of the points that lies in the dot of this number or behind it; dot 0 begins at `edge`, in points. */
static int64_t first_in_dot(int64_t dot, double width, double edge, int64_t points)
{
    int64_t first = round_up((double)dot * width + edge);
    return first < 0 ? 0 : first > points ? points : first;
}

static void run_letters(const char *text, const lattice *l, rheo__run *run, void *user)
{
    const double dot = l->size[1] / RHEO__LETTER_ROWS, left = 0.5 * ((double)l->high[0] - l->size[0]);
    const int64_t columns = RHEO__LETTER_ADVANCE * (int64_t)strlen(text);
    uint8_t dots[RHEO__LETTER_ROWS][RHEO__LETTER_ADVANCE * sizeof((rheo_fill *)0)->name];
    for (size_t row = 0; row < RHEO__LETTER_ROWS; row++)
        rheo__letters_row(text, row, dots[row]);
    for (int64_t z = 0; z <= l->high[2]; z++)
        for (int64_t row = 0, y = 0; row < RHEO__LETTER_ROWS; row++)
            for (int64_t end = first_in_dot(row + 1, dot, -0.5, l->high[1] + 1); y < end; y++)
                for (int64_t column = 0, last; column < columns; column = last + 1) {
                    for (last = column; dots[row][last]; last++) /* the last column of a letter is free */
                        ;
                    if (last == column)
                        continue;
                    int64_t x = first_in_dot(column, dot, left, l->high[0] + 1);
                    int64_t behind = first_in_dot(last, dot, left, l->high[0] + 1);
                    if (x < behind && !run(user, x, behind, y, z))
                        return;
                }
}

static rheo_result run_fill(const rheo__filling *filling, uint32_t f, double spacing, const lattice *l,
                            rheo__run *run, void *user, rheo_error *error)
{
    const rheo_fill *fill = &filling->scene->fill[f];
    switch (fill->kind) {
    case RHEO_FILL_BLOCK:
        run_block(l, run, user);
        break;
    case RHEO_FILL_SPHERE:
        run_sphere(l, fill->radius / spacing, run, user);
        break;
    case RHEO_FILL_MESH:
        return run_mesh(mesh_of(filling, f), l, run, user, error);
    case RHEO_FILL_LETTERS:
        run_letters(fill->name, l, run, user);
        break;
    }
    return RHEO_OK;
}

/* ---- Counting ---- */

static bool count_run(void *user, int64_t x, int64_t end, int64_t y, int64_t z)
{
    uint64_t *count = user;
    (void)y, (void)z;
    *count += (uint64_t)(end - x);
    return *count <= MOST_PARTICLES;
}

/* More than MOST_PARTICLES: more than a world can have, not exactly how many. */
static rheo_result count_fills(const rheo__filling *filling, double spacing, uint64_t *count, rheo_error *error)
{
    *count = 0;
    for (uint32_t f = 0; f < filling->scene->fill_count && *count <= MOST_PARTICLES; f++) {
        double points = 1;
        lattice l;
        if (fits(filling, f, spacing)) {
            l = lattice_of(filling, f, spacing);
            for (int axis = 0; axis < 3; axis++)
                points *= l.high[axis] < l.low[axis] ? 0 : (double)(l.high[axis] - l.low[axis] + 1);
        } else {
            points = 2 * MOST_POINTS;
        }
        if (points > MOST_POINTS) /* even a sphere fills half of that */
            *count = MOST_PARTICLES + 1;
        else if (filling->scene->fill[f].kind == RHEO_FILL_BLOCK)
            *count += (uint64_t)points;
        else
            RHEO__TRY(run_fill(filling, f, spacing, &l, count_run, count, error));
    }
    return RHEO_OK;
}

/* ---- The spacing for a number of particles ---- */

typedef struct search {
    const rheo__filling *filling;
    double best; /* the spacing that came nearest */
    uint64_t best_count, miss;
} search;

static bool is_exact(const search *s)
{
    return s->best > 0 && s->miss == 0;
}

/* Counts, and keeps what came nearest; the first of those that are equally near. */
static rheo_result try_spacing(search *s, double spacing, uint64_t *count, rheo_error *error)
{
    const uint64_t wanted = s->filling->scene->particles;
    RHEO__TRY(count_fills(s->filling, spacing, count, error));
    uint64_t miss = *count > wanted ? *count - wanted : wanted - *count;
    if (*count > 0 && *count <= MOST_PARTICLES && (s->best == 0 || miss < s->miss)) {
        s->best = spacing;
        s->best_count = *count;
        s->miss = miss;
    }
    return RHEO_OK;
}

/*
 * Bisection. The number of particles falls with the spacing, but not with every small step of it: hence the best of
 * all that were tried. Spacings are doubled and halved from the scene's on, so that the same scene always has the
 * same.
 */
static rheo_result choose_spacing(rheo__filling *filling, rheo_error *error)
{
    enum { HALVINGS = 40 };
    const double finest = 1e-12, coarsest = 1e12;
    const uint64_t wanted = filling->scene->particles;
    search s = {.filling = filling};
    double low = filling->scene->world.fluid.spacing, high = low; /* too many particles at low, too few at high */
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
        double middle = low + (high - low) / 2;
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

/* ---- Opening ---- */

static bool between(double x, double low, double high)
{
    return x >= low && x <= high;
}

static rheo_result check_place(const rheo_fill *fill, uint32_t f, rheo_error *error)
{
    const bool letters = fill->kind == RHEO_FILL_LETTERS;
    if (!memchr(fill->name, 0, sizeof fill->name) || !fill->name[0])
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: %s", f,
                          letters ? "the text is empty"
                                  : "no mesh is named; it is \"bunny\" or an .obj or .ply file");
    for (int axis = 0; axis < 3; axis++)
        if (!between(fill->position[axis], -1e30, 1e30))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: position is not finite", f);
    if (!between(fill->height, 0, 1e30) || (letters && !(fill->height > 0)))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: height is %g; it must be %s", f, fill->height,
                          letters ? "more than 0" : "more than 0, or 0 for a mesh as it is");
    if (letters && !(fill->depth > 0 && fill->depth <= 1e30))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: depth is %g; it must be more than 0", f,
                          fill->depth);
    rheo_error inner;
    return letters && rheo__letters_check(fill->name, &inner) != RHEO_OK
               ? rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: %.400s", f, inner.message)
               : RHEO_OK;
}

static rheo_result check_fill(const rheo_scene *scene, uint32_t f, rheo_error *error)
{
    const rheo_fill *fill = &scene->fill[f];
    const double largest = scene->particles ? 1e30 : 1e9 * scene->world.fluid.spacing;
    if (!between(fill->jitter, 0, 0.5))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: jitter is %g; it must be from 0 to 0.5 spacings", f,
                          fill->jitter);
    if (scene->world.model != RHEO_MODEL_MELTING && (fill->has_temperature || fill->not_hydrostatic))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: %s is of the model %s; this scene's is %s", f,
                          fill->has_temperature ? "a temperature" : "hydrostatic",
                          rheo_model_name(RHEO_MODEL_MELTING), rheo_model_name(scene->world.model));
    if (fill->has_temperature &&
        !(between(fill->temperature[0], -1e30, 1e30) && between(fill->temperature[1], -1e30, 1e30)))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: temperature is not finite", f);
    for (int axis = 0; axis < 3; axis++) {
        if (!between(fill->velocity[axis], -1e30, 1e30))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: velocity is not finite", f);
        double low = fill->min[axis], high = fill->max[axis];
        if (fill->kind == RHEO_FILL_BLOCK && (!between(low, -1e30, 1e30) || !between(high - low, 0, largest)))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "shape %u: a block from %g to %g along %c; max must not be below min, and both finite "
                              "and at most 1e9 spacings apart",
                              f, low, high, "xyz"[axis]);
        if (fill->kind == RHEO_FILL_SPHERE &&
            (!between(fill->centre[axis], -1e30, 1e30) || !between(fill->radius, 0, largest)))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "shape %u: a sphere needs a finite centre and a radius from 0 to 1e9 spacings", f);
    }
    if (fill->kind == RHEO_FILL_MESH || fill->kind == RHEO_FILL_LETTERS)
        return check_place(fill, f, error);
    return fill->kind == RHEO_FILL_BLOCK || fill->kind == RHEO_FILL_SPHERE
               ? RHEO_OK
               : rheo__fail(error, RHEO_ERROR_ARGUMENT, "shape %u: there is no kind %d", f, (int)fill->kind);
}

/* Each file once, however many shapes it makes. */
static rheo_result read_mesh(rheo__filling *filling, uint32_t f, rheo_error *error)
{
    const rheo_fill *fill = filling->scene->fill;
    for (uint32_t other = 0; other < f; other++)
        if (fill[other].kind == RHEO_FILL_MESH && strcmp(fill[other].name, fill[f].name) == 0) {
            filling->mesh_of[f] = filling->mesh_of[other];
            return RHEO_OK;
        }
    rheo_error inner = {""};
    rheo_result result = rheo__mesh_open(&filling->mesh[f], &filling->allocator, fill[f].name, &inner);
    filling->mesh_of[f] = f;
    return result == RHEO_OK ? RHEO_OK : rheo__fail(error, result, "shape %u: %.490s", f, inner.message);
}

rheo_result rheo__filling_open(rheo__filling *filling, const rheo_scene *scene, rheo_error *error)
{
    memset(filling, 0, sizeof *filling);
    filling->scene = scene;
    filling->allocator = rheo__allocator_or_default(scene->world.allocator);
    filling->spacing = scene->world.fluid.spacing;
    if (scene->fill_count > RHEO_MAX_FILLS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u shapes; at most %d are possible",
                          scene->fill_count, RHEO_MAX_FILLS);
    if (!(filling->spacing >= 1e-12 && filling->spacing <= 1e12))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "fluid.spacing is %g; it must be from 1e-12 to 1e12",
                          filling->spacing);
    if (scene->particles > MOST_PARTICLES)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "particles is %llu; it must be at most 2^30",
                          (unsigned long long)scene->particles);
    for (uint32_t f = 0; f < scene->fill_count; f++) {
        RHEO__TRY(check_fill(scene, f, error));
        filling->has_temperatures = filling->has_temperatures || scene->fill[f].has_temperature;
    }
    for (uint32_t f = 0; f < scene->fill_count; f++)
        if (scene->fill[f].kind == RHEO_FILL_MESH)
            RHEO__TRY(read_mesh(filling, f, error));
    if (scene->particles > 0)
        return choose_spacing(filling, error);
    RHEO__TRY(count_fills(filling, filling->spacing, &filling->count, error));
    return filling->count > MOST_PARTICLES
               ? rheo__fail(error, RHEO_ERROR_ARGUMENT,
                            "the shapes hold more than 2^30 particles at a spacing of %g; make them smaller or the "
                            "spacing larger",
                            filling->spacing)
               : RHEO_OK;
}

void rheo__filling_close(rheo__filling *filling)
{
    for (uint32_t f = 0; f < RHEO_MAX_FILLS; f++)
        rheo__mesh_release(&filling->mesh[f]);
}

/* ---- Particles ---- */

/* splitmix64 (Steele, Lea, Flood 2014): 53 random bits in [-1, 1). */
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

/* Of a fluid at rest under gravity, p = c^2 (rho - rho0): rho0 at the particle that lies highest against gravity. */
static void write_densities(const rheo_world_def *def, const rheo_fill *fill, const rheo_real *position,
                            rheo_real *density, size_t count)
{
    const double *g = def->gravity, c = def->melting.sound_speed, rest = def->melting.rest_density;
    double top = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < count; i++) {
            const rheo_real *x = position + 3 * i;
            double along = g[0] * (double)x[0] + g[1] * (double)x[1] + g[2] * (double)x[2];
            if (pass == 1)
                density[i] = (rheo_real)(fill->not_hydrostatic ? rest : rest + rest * (along - top) / (c * c));
            else if (i == 0 || along < top)
                top = along;
        }
}

static void write_temperatures(const rheo_world_def *def, const rheo_fill *fill, const rheo_real *position,
                               rheo_real *temperature, size_t count)
{
    rheo_real low = count ? position[1] : 0, high = low;
    for (size_t i = 0; i < count; i++) {
        rheo_real y = position[3 * i + 1];
        low = y < low ? y : low;
        high = y > high ? y : high;
    }
    for (size_t i = 0; i < count; i++) {
        rheo_real y = position[3 * i + 1];
        double bottom = fill->temperature[0], top = fill->temperature[1], value = def->melting.temperature;
        if (fill->has_temperature)
            value = y == low ? bottom
                    : y == high
                        ? top
                        : bottom + (top - bottom) * (((double)y - (double)low) / ((double)high - (double)low));
        temperature[i] = (rheo_real)value;
    }
}

rheo_result rheo__filling_make(const rheo__filling *filling, rheo_real *position, rheo_real *velocity,
                               rheo_real *density, rheo_real *temperature, rheo_error *error)
{
    const rheo_scene *scene = filling->scene;
    writer w = {.spacing = filling->spacing,
                .random = scene->seed,
                .room = (size_t)filling->count,
                .position = position,
                .velocity = velocity};
    for (uint32_t f = 0; f < scene->fill_count; f++) {
        const size_t begin = w.used;
        lattice l = lattice_of(filling, f, filling->spacing);
        w.fill = &scene->fill[f];
        memcpy(w.origin, l.origin, sizeof w.origin);
        RHEO__TRY(run_fill(filling, f, filling->spacing, &l, write_run, &w, error));
        const size_t count = w.used - begin;
        if (density)
            write_densities(&scene->world, w.fill, position + 3 * begin, density + begin, count);
        if (temperature)
            write_temperatures(&scene->world, w.fill, position + 3 * begin, temperature + begin, count);
    }
    return RHEO_OK;
}

/* ---- For users ---- */

rheo_result rheo_scene_particle_count(const rheo_scene *scene, uint64_t *count, rheo_error *error)
{
    rheo__filling filling;
    rheo_result result = rheo__filling_open(&filling, scene, error);
    *count = result == RHEO_OK ? filling.count : 0;
    rheo__filling_close(&filling);
    return result;
}

rheo_result rheo_scene_spacing(const rheo_scene *scene, double *spacing, rheo_error *error)
{
    rheo__filling filling;
    rheo_result result = rheo__filling_open(&filling, scene, error);
    *spacing = result == RHEO_OK ? filling.spacing : 0;
    rheo__filling_close(&filling);
    return result;
}
