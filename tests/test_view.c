/*
 * The free surface: closed whatever the particles are, of the right shape, the same to the byte; and the files that
 * worlds are written to. Pictures are rendered where there is a povray.
 */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "support.h"

#include <locale.h>
#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include "view/grid.h"
#include "view/output.h"

static char folder[] = "/tmp/rheolog-view-XXXXXX";

static int set_up(void **state)
{
    (void)state;
    return !mkdtemp(folder) || chdir(folder) != 0;
}

static int tear_down(void **state)
{
    (void)state;
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return chdir("/") != 0 || system(command) != 0;
}

/* ---- Clouds of particles ---- */

enum { MOST = 20000 };

typedef struct cloud {
    uint32_t count;
    rheo_real position[3 * MOST], volume[MOST], value[MOST];
} cloud;

static void add(cloud *c, double x, double y, double z)
{
    assert_true(c->count < MOST);
    rheo_real *at = c->position + 3 * (size_t)c->count;
    at[0] = (rheo_real)x;
    at[1] = (rheo_real)y;
    at[2] = (rheo_real)z;
    c->count++;
}

static cloud *new_cloud(void)
{
    cloud *c = calloc(1, sizeof *c);
    assert_non_null(c);
    return c;
}

static void add_ball(cloud *c, double radius, double x0, double y0, double z0)
{
    const int n = (int)radius + 1;
    for (int z = -n; z <= n; z++)
        for (int y = -n; y <= n; y++)
            for (int x = -n; x <= n; x++)
                if (x * x + y * y + z * z <= radius * radius)
                    add(c, x0 + x, y0 + y, z0 + z);
}

static void add_torus(cloud *c, double large, double small)
{
    const int n = (int)(large + small) + 1;
    for (int z = -n; z <= n; z++)
        for (int y = -n; y <= n; y++)
            for (int x = -n; x <= n; x++) {
                const double ring = sqrt((double)(x * x + z * z)) - large;
                if (ring * ring + y * y <= small * small)
                    add(c, x, y, z);
            }
}

static double random_number(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 40) / (1 << 24);
}

static rheo_surface surface_of(const cloud *c, rheo_surface_options options)
{
    const rheo_surface_particles p = {
        .count = c->count, .position = c->position, .spacing = 1, .smoothing_length = 1};
    rheo_surface s;
    OK(rheo_surface_make(&p, &options, NULL, &s, &error));
    return s;
}

/* ---- What must hold of a surface ---- */

static int by_value(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* NULL if every edge is run through once in each direction, every vertex is used and all numbers are finite. */
static const char *fault_of(const rheo_surface *s)
{
    const size_t edges = 3 * (size_t)s->triangles;
    uint64_t *edge = malloc((2 * edges + 1) * sizeof *edge), *back = edge + edges;
    bool *used = calloc((size_t)s->vertices + 1, sizeof *used);
    assert_non_null(edge);
    assert_non_null(used);
    const char *fault = NULL;
    for (size_t k = 0; k < edges && !fault; k++) {
        const uint32_t a = s->triangle[k], b = s->triangle[k % 3 == 2 ? k - 2 : k + 1];
        if (a >= s->vertices || b >= s->vertices || a == b)
            fault = "a triangle names a vertex that is none, or one twice";
        else
            used[a] = true;
        edge[k] = (uint64_t)a << 32 | b;
        back[k] = (uint64_t)b << 32 | a;
    }
    qsort(edge, edges, sizeof *edge, by_value);
    qsort(back, edges, sizeof *back, by_value);
    for (size_t k = 0; k < edges && !fault; k++) {
        if (k && edge[k] == edge[k - 1])
            fault = "an edge is run through twice in one direction";
        else if (edge[k] != back[k])
            fault = "an edge is run through in one direction only";
    }
    for (size_t v = 0; v < s->vertices && !fault; v++) {
        const float *n = s->normal + 3 * v, *x = s->position + 3 * v;
        const double length2 =
            (double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] + (double)n[2] * (double)n[2];
        if (!used[v])
            fault = "a vertex is of no triangle";
        else if (!(fabs(length2 - 1) < 1e-5))
            fault = "a normal is no unit vector";
        else if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
            fault = "a vertex is not finite";
    }
    free(edge);
    free(used);
    return fault;
}

static void assert_closed(const rheo_surface *s)
{
    const char *fault = fault_of(s);
    if (fault)
        fail_msg("%u vertices, %u triangles: %s", s->vertices, s->triangles, fault);
}

/* Vertices - edges + faces of a closed surface. */
static int euler(const rheo_surface *s)
{
    return (int)((long)s->vertices - (long)s->triangles / 2);
}

static double volume_of(const rheo_surface *s)
{
    double sum = 0;
    for (size_t t = 0; t < s->triangles; t++) {
        double x[3][3];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                x[k][a] = (double)s->position[3 * (size_t)s->triangle[3 * t + k] + a];
        sum += x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) + x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
               x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
    }
    return sum / 6;
}

static uint64_t hash_of(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ b[i]) * UINT64_C(1099511628211);
    return hash;
}

/* Of the numbers, not of how a machine lays out bytes. */
static uint64_t hash_of_surface(const rheo_surface *s)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < 3 * (size_t)s->vertices; i++) {
        uint32_t bits[2];
        memcpy(&bits[0], &s->position[i], 4);
        memcpy(&bits[1], &s->normal[i], 4);
        for (int k = 0; k < 8; k++)
            hash = hash_of(hash, &(unsigned char){(unsigned char)(bits[k / 4] >> 8 * (k % 4))}, 1);
    }
    for (size_t i = 0; i < 3 * (size_t)s->triangles; i++)
        for (int k = 0; k < 4; k++)
            hash = hash_of(hash, &(unsigned char){(unsigned char)(s->triangle[i] >> 8 * k)}, 1);
    return hash;
}

/* ---- Shapes ---- */

static void a_ball_is_a_ball(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 8, .3, -.2, .1);
    for (double resolution = 1; resolution <= 4; resolution *= 2) {
        rheo_surface s = surface_of(c, (rheo_surface_options){.5, resolution});
        assert_closed(&s);
        assert_int_equal(euler(&s), 2);
        NEAR(volume_of(&s) / c->count, .97, .03); /* chi is less outside of what is bent */
        for (size_t v = 0; v < s.vertices; v++) {
            double r[3], r2 = 0, along = 0;
            for (int a = 0; a < 3; a++) {
                r[a] = (double)s.position[3 * v + a] - (a == 0 ? .3 : a == 1 ? -.2 : .1);
                r2 += r[a] * r[a];
                along += r[a] * (double)s.normal[3 * v + a];
            }
            NEAR(sqrt(r2), 8.1, .6);
            assert_true(along / sqrt(r2) > .9);
        }
        rheo_surface_release(&s);
        assert_null(s.position);
    }
    free(c);
}

static void a_torus_has_a_hole(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_torus(c, 10, 3.5);
    rheo_surface s = surface_of(c, rheo_default_surface_options());
    assert_closed(&s);
    assert_int_equal(euler(&s), 0);
    NEAR(volume_of(&s) / c->count, .97, .03);
    rheo_surface_release(&s);
    free(c);
}

/* A ball with a hollow has two surfaces; the inner one faces the hollow. */
static void a_hollow_faces_inwards(void **unused)
{
    (void)unused;
    cloud *c = new_cloud(), *hollow = new_cloud();
    add_ball(c, 9, 0, 0, 0);
    for (uint32_t i = 0; i < c->count; i++) {
        const double x = (double)c->position[3 * i], y = (double)c->position[3 * i + 1],
                     z = (double)c->position[3 * i + 2];
        if (x * x + y * y + z * z > 16)
            add(hollow, x, y, z);
    }
    rheo_surface s = surface_of(hollow, rheo_default_surface_options());
    assert_closed(&s);
    assert_int_equal(euler(&s), 4);
    NEAR(volume_of(&s) / hollow->count, 1, .04);
    rheo_surface_release(&s);
    free(c);
    free(hollow);
}

static void few_particles_have_surfaces_too(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    rheo_surface s = surface_of(c, rheo_default_surface_options()); /* none */
    assert_int_equal(s.vertices + s.triangles + s.left_out, 0);
    rheo_surface_release(&s);
    add(c, 1e-3, 2, -3);
    s = surface_of(c, rheo_default_surface_options()); /* chi is at most 66/(120 pi) there */
    assert_int_equal(s.triangles, 0);
    rheo_surface_release(&s);
    s = surface_of(c, (rheo_surface_options){.1, 4});
    assert_closed(&s);
    assert_int_equal(euler(&s), 2);
    rheo_surface_release(&s);
    for (int i = 0; i < 49; i++)
        add(c, 1e-3, 2, -3);
    s = surface_of(c, rheo_default_surface_options());
    assert_closed(&s);
    assert_int_equal(euler(&s), 2);
    rheo_surface_release(&s);
    free(c);
}

static void isovalues_may_be_extreme(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 4, 0, 0, 0);
    static const double isovalue[] = {1e-300, 1e-12, .01, .99, .999999999};
    double before = 1e9;
    for (size_t i = 0; i < sizeof isovalue / sizeof *isovalue; i++) {
        rheo_surface s = surface_of(c, (rheo_surface_options){isovalue[i], 2});
        assert_closed(&s);
        assert_true(volume_of(&s) <= before && (i > 2 || s.triangles > 0));
        before = volume_of(&s);
        rheo_surface_release(&s);
    }
    free(c);
}

/* Splashes, sheets, clumps: many cells whose corners alternate. */
static void random_clouds_are_closed(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    uint64_t seed = 7;
    uint32_t with_surface = 0;
    for (int round = 0; round < 250; round++) {
        const double width[3] = {12 * random_number(&seed), 12 * random_number(&seed), 12 * random_number(&seed)};
        const bool on_lattice = round % 3 == 0;
        c->count = 0;
        for (int i = (int)(300 * random_number(&seed)); i >= 0; i--) {
            double x[3];
            for (int a = 0; a < 3; a++) {
                x[a] = width[a] * (random_number(&seed) - .5);
                x[a] = on_lattice ? floor(x[a]) : x[a];
            }
            add(c, x[0], x[1], x[2]);
        }
        const rheo_surface_options options = {.02 + .96 * random_number(&seed), .5 + 2.5 * random_number(&seed)};
        rheo_surface s = surface_of(c, options);
        assert_closed(&s);
        assert_true(s.triangles == 0 || volume_of(&s) > 0);
        with_surface += s.triangles > 0;
        rheo_surface_release(&s);
    }
    assert_true(with_surface > 200);
    free(c);
}

/* Noise on a coarse grid: all 256 cases of a cell come about, and those of which a loop comes twice to a face. */
static void noise_is_closed(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    uint64_t seed = 3;
    for (int round = 0; round < 20; round++) {
        c->count = 0;
        for (int i = 0; i < 2000; i++) {
            add(c, 5 * random_number(&seed), 5 * random_number(&seed), 5 * random_number(&seed));
            c->volume[i] = (rheo_real)(.2 * random_number(&seed));
        }
        const rheo_surface_particles p = {
            .count = c->count, .position = c->position, .volume = c->volume, .smoothing_length = .2};
        rheo_surface s;
        OK(rheo_surface_make(&p, &(rheo_surface_options){.02 + .5 * random_number(&seed), .5}, NULL, &s, &error));
        assert_true(s.triangles > 100);
        assert_closed(&s);
        rheo_surface_release(&s);
    }
    free(c);
}

/* The isovalue is the very value of a corner that the surface comes near. */
static void corners_at_the_isovalue_are_closed(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 3, 0, 0, 0); /* by symmetry 6 to 48 corners have that value */
    const rheo_surface_particles p = {
        .count = c->count, .position = c->position, .spacing = 1, .smoothing_length = 1};
    const rheo_allocator allocator = rheo__allocator_or_default((rheo_allocator){NULL, NULL, NULL});
    rheo__grid grid;
    OK(rheo__grid_make(&grid, &p, &(rheo_surface_options){.05, 2}, &allocator, &error));
    int tried = 0;
    for (size_t i = 0; i < (size_t)grid.count * RHEO__BLOCK_CORNERS; i++) {
        if (!(grid.chi[i] > .05 && grid.chi[i] < .95) || tried == 60)
            continue;
        rheo_surface s = surface_of(c, (rheo_surface_options){grid.chi[i], 2});
        assert_closed(&s);
        assert_int_equal(euler(&s), 2);
        rheo_surface_release(&s);
        tried++;
    }
    assert_int_equal(tried, 60);
    rheo__grid_release(&grid, &allocator);
    free(c);
}

static void faults_are_found(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 3, 0, 0, 0);
    rheo_surface s = surface_of(c, rheo_default_surface_options());
    assert_null(fault_of(&s));
    s.triangles--;
    assert_non_null(fault_of(&s));
    s.triangles++;
    uint32_t *t = s.triangle, first = t[0];
    t[0] = t[1];
    assert_non_null(fault_of(&s));
    t[0] = t[2]; /* round the other way */
    t[2] = first;
    assert_non_null(fault_of(&s));
    t[2] = t[0];
    t[0] = first;
    assert_null(fault_of(&s));
    s.normal[4] += .1F;
    assert_non_null(fault_of(&s));
    rheo_surface_release(&s);
    free(c);
}

/* ---- The same everywhere ---- */

static void surfaces_are_the_same_to_the_byte(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    uint64_t seed = 5;
    add_ball(c, 6, .25, .5, 0);
    for (uint32_t i = 0; i < 3 * c->count; i++)
        c->position[i] += (rheo_real)(.3 * random_number(&seed));
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        rheo_surface s = surface_of(c, (rheo_surface_options){.45, 2.5});
        hash[k] = hash_of_surface(&s);
        rheo_surface_release(&s);
    }
    assert_int_equal(hash[0], hash[1]);
#if !RHEO_DOUBLE
    assert_int_equal(hash[0], UINT64_C(0x2979db83d60f0bba)); /* on any machine */
#endif
    c->position[0] += (rheo_real).01;
    rheo_surface s = surface_of(c, (rheo_surface_options){.45, 2.5});
    assert_int_not_equal(hash_of_surface(&s), hash[0]);
    rheo_surface_release(&s);
    free(c);
}

/* ---- Values ---- */

static void values_are_means_of_particles(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 5, 0, 0, 0);
    for (uint32_t i = 0; i < c->count; i++)
        c->value[i] = 3 * c->position[3 * i] + 20;
    const rheo_surface_particles p = {
        .count = c->count, .position = c->position, .value = c->value, .spacing = 1, .smoothing_length = 1};
    const rheo_surface_options options = rheo_default_surface_options();
    rheo_surface s;
    OK(rheo_surface_make(&p, &options, NULL, &s, &error));
    assert_closed(&s);
    assert_non_null(s.value);
    for (size_t v = 0; v < s.vertices; v++) /* those of the inner side, as there are no others: less steep */
        NEAR((double)s.value[v], 20 + 3 * .89 * (double)s.position[3 * v], .6);
    rheo_surface_release(&s);
    for (uint32_t i = 0; i < c->count; i++)
        c->value[i] = -7;
    OK(rheo_surface_make(&p, &options, NULL, &s, &error));
    for (size_t v = 0; v < s.vertices; v++)
        NEAR((double)s.value[v], -7, 1e-5);
    rheo_surface_release(&s);
    free(c);
}

/* ---- Memory ---- */

typedef struct counted {
    size_t bytes, most, calls, fail_at; /* 0: never */
    uint32_t held;
} counted;

static void *counting_allocate(size_t bytes, void *user)
{
    counted *count = user;
    if (++count->calls == count->fail_at)
        return NULL;
    size_t *memory = malloc(bytes + 64);
    if (!memory)
        return NULL;
    *memory = bytes;
    count->bytes += bytes;
    count->most = count->bytes > count->most ? count->bytes : count->most;
    count->held++;
    return (char *)memory + 64;
}

static void counting_release(void *memory, void *user)
{
    counted *count = user;
    size_t *start = (size_t *)(void *)((char *)memory - 64);
    count->bytes -= *start;
    count->held--;
    free(start);
}

/* One particle a million supports away costs neither memory nor triangles; one beyond all cells is left out. */
static void particles_far_out_cost_nothing(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 8, 0, 0, 0);
    counted near = {0}, far = {0};
    rheo_surface s;
    rheo_surface_particles p = {.position = c->position, .spacing = 1, .smoothing_length = 1};
    const rheo_surface_options options = rheo_default_surface_options();
    p.count = c->count;
    OK(rheo_surface_make(&p, &options, &(rheo_allocator){counting_allocate, counting_release, &near}, &s, &error));
    const uint32_t vertices = s.vertices;
    rheo_surface_release(&s);
    add(c, 3e6, -3e6, 3e6);
    add(c, 0, 1e30, 0);
    p.count = c->count;
    OK(rheo_surface_make(&p, &options, &(rheo_allocator){counting_allocate, counting_release, &far}, &s, &error));
    assert_int_equal(s.vertices, vertices);
    assert_int_equal(s.left_out, 1);
    rheo_surface_release(&s);
    assert_true(far.most < near.most + near.most / 20);
    /* A clump there has a surface. */
    for (int i = 0; i < 20; i++)
        add(c, 3e6, -3e6, 3e6);
    p.count = c->count;
    OK(rheo_surface_make(&p, &options, &(rheo_allocator){counting_allocate, counting_release, &far}, &s, &error));
    assert_closed(&s);
    assert_int_equal(euler(&s), 4);
    rheo_surface_release(&s);
    assert_true(far.most < 2 * near.most);
    assert_int_equal(near.held + far.held, 0);
    free(c);
}

static void no_memory_leaves_nothing(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 3, 0, 0, 0);
    for (uint32_t i = 0; i < c->count; i++)
        c->value[i] = 1;
    const rheo_surface_particles p = {
        .count = c->count, .position = c->position, .value = c->value, .spacing = 1, .smoothing_length = 1};
    const rheo_surface_options options = rheo_default_surface_options();
    for (size_t fail_at = 1;; fail_at++) {
        counted count = {.fail_at = fail_at};
        rheo_surface s;
        rheo_error error = {""};
        const rheo_result result = rheo_surface_make(
            &p, &options, &(rheo_allocator){counting_allocate, counting_release, &count}, &s, &error);
        if (result == RHEO_OK) {
            assert_true(fail_at > 20);
            rheo_surface_release(&s);
            assert_int_equal(count.held, 0);
            break;
        }
        assert_int_equal(result, RHEO_ERROR_MEMORY);
        assert_non_null(strstr(error.message, "no memory"));
        assert_int_equal(count.held, 0);
        assert_null(s.position);
        assert_int_equal(s.vertices + s.triangles, 0);
    }
    free(c);
}

static void bad_particles_and_options_are_refused(void **unused)
{
    (void)unused;
    rheo_real position[6] = {0, 0, 0, 1, 1, 1}, volume[2] = {1, 1}, value[2] = {1, 1};
    rheo_surface_particles p = {2, position, volume, value, 1, 1};
    rheo_surface s;
    const rheo_surface_options good = rheo_default_surface_options();
    OK(rheo_surface_make(&p, &good, NULL, &s, &error));
    rheo_surface_release(&s);
    static const rheo_surface_options bad[] = {{0, 2}, {1, 2}, {NAN, 2}, {.5, .4}, {.5, 8.1}, {.5, NAN}};
    for (int i = 0; i < 6; i++)
        REFUSED(RHEO_ERROR_ARGUMENT, i < 3 ? "isovalue" : "resolution",
                rheo_surface_make(&p, &bad[i], NULL, &s, &error));
    position[4] = (rheo_real)NAN;
    REFUSED(RHEO_ERROR_ARGUMENT, "particle 1", rheo_surface_make(&p, &good, NULL, &s, &error));
    position[4] = (rheo_real)-INFINITY;
    REFUSED(RHEO_ERROR_ARGUMENT, "particle 1", rheo_surface_make(&p, &good, NULL, &s, &error));
    position[4] = 0;
    volume[0] = -1;
    REFUSED(RHEO_ERROR_ARGUMENT, "particle 0", rheo_surface_make(&p, &good, NULL, &s, &error));
    volume[0] = (rheo_real)INFINITY;
    REFUSED(RHEO_ERROR_ARGUMENT, "particle 0", rheo_surface_make(&p, &good, NULL, &s, &error));
    volume[0] = 0;
    value[1] = (rheo_real)NAN;
    REFUSED(RHEO_ERROR_ARGUMENT, "particle 1", rheo_surface_make(&p, &good, NULL, &s, &error));
    p.smoothing_length = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "smoothing length", rheo_surface_make(&p, &good, NULL, &s, &error));
    assert_int_equal(s.vertices, 0);
    p.smoothing_length = 1;
    p.volume = NULL;
    p.spacing = -1;
    REFUSED(RHEO_ERROR_ARGUMENT, "spacing", rheo_surface_make(&p, &good, NULL, &s, &error));
}

/* ---- Files ---- */

static char *read_whole(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *text = malloc(*size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, *size, file), *size);
    text[*size] = 0;
    fclose(file);
    return text;
}

static rheo_exported export_to(const rheo_world *world, rheo_export_format format, const char *path)
{
    rheo_exported exported;
    const rheo_export_options options = {rheo_default_surface_options(), NULL, true};
    OK(rheo_world_export(world, format, path, &options, &exported, &error));
    return exported;
}

/* The next number, behind what stands before it. */
static double next_number(char **text)
{
    *text += strcspn(*text, "+-0123456789");
    return strtod(*text, text);
}

static void csv_reads_back_to_the_same_bits(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    const uint32_t count = rheo_world_particle_count(world);
    assert_int_equal(export_to(world, RHEO_EXPORT_CSV, "a.csv").particles, count);
    size_t size;
    char *text = read_whole("a.csv", &size), *at = text;
    assert_int_equal(strncmp(at, "id,x,y,z,vx,vy,vz", 17), 0);
    at = strchr(at, '\n');
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    for (uint32_t i = 0; i < count; i++) {
        assert_true(next_number(&at) == i);
        for (int a = 0; a < 6; a++) {
            const rheo_real *expected = (a < 3 ? x : v) + 3 * i + a % 3, read = (rheo_real)next_number(&at);
            assert_memory_equal(&read, expected, sizeof read);
        }
        assert_int_equal(*at, '\n');
    }
    assert_string_equal(at, "\n");
    free(text);
    rheo_world_destroy(world);
}

static uint64_t little(const char *bytes, size_t count)
{
    uint64_t value = 0;
    for (size_t i = count; i-- > 0;)
        value = value << 8 | (unsigned char)bytes[i];
    return value;
}

/* Where an array of a VTP file begins, and how many bytes it says that it has. */
static const char *array_of(const char *text, const char *name, uint64_t *bytes)
{
    char head[64];
    snprintf(head, sizeof head, "Name=\"%s\"", name);
    const char *at = strstr(text, head), *data = strstr(text, "encoding=\"raw\">\n_");
    assert_non_null(at);
    assert_non_null(data);
    at = strstr(at, "offset=\"");
    data += strlen("encoding=\"raw\">\n_") + strtoul(at + 8, NULL, 10);
    *bytes = little(data, 8);
    return data + 8;
}

static void vtp_has_its_arrays(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    const uint32_t count = rheo_world_particle_count(world);
    export_to(world, RHEO_EXPORT_VTP, "a.vtp");
    size_t size;
    char *text = read_whole("a.vtp", &size);
    char points[64];
    snprintf(points, sizeof points, "NumberOfPoints=\"%u\" NumberOfVerts=\"%u\"", count, count);
    assert_non_null(strstr(text, points));
    assert_non_null(strstr(text, "Name=\"TimeValue\""));
    uint64_t bytes;
    const char *id = array_of(text, "id", &bytes);
    assert_int_equal(bytes, 4 * (uint64_t)count);
    assert_int_equal(little(id + 4 * (count - 1), 4), count - 1);
    for (int k = 0; k < 2; k++) {
        const char *values = array_of(text, k ? "velocity" : "position", &bytes);
        const rheo_real *expected = k ? rheo_world_velocities(world) : rheo_world_positions(world);
        assert_int_equal(bytes, 3 * sizeof(rheo_real) * count);
        for (size_t i = 0; i < 3 * (size_t)count; i++) {
            const uint64_t bits = little(values + i * sizeof(rheo_real), sizeof(rheo_real));
            uint64_t wanted = 0;
#if RHEO_DOUBLE
            memcpy(&wanted, &expected[i], 8);
#else
            uint32_t half;
            memcpy(&half, &expected[i], 4);
            wanted = half;
#endif
            assert_int_equal(bits, wanted);
        }
    }
    const char *end = array_of(text, "offsets", &bytes);
    assert_int_equal(bytes, 8 * (uint64_t)count);
    assert_int_equal(little(end + 8 * (count - 1), 8), count);
    assert_string_equal(end + bytes, "\n</AppendedData>\n</VTKFile>\n");
    assert_int_equal((size_t)(end + bytes - text) + strlen("\n</AppendedData>\n</VTKFile>\n"), size);
    free(text);
    rheo_world_destroy(world);
}

static void meshes_are_the_surface(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo_surface s;
    const rheo_surface_options options = rheo_default_surface_options();
    OK(rheo_world_surface(world, &options, NULL, &s, &error));
    assert_closed(&s);
    NEAR(volume_of(&s) / (rheo_world_particle_count(world) * 8), 1, .25); /* it was pressed together */
    assert_int_equal(export_to(world, RHEO_EXPORT_PLY, "a.ply").triangles, s.triangles);
    size_t size;
    char *text = read_whole("a.ply", &size);
    const char *at = strstr(text, "end_header\n") + 11;
    assert_int_equal(size - (size_t)(at - text), 24 * (size_t)s.vertices + 13 * (size_t)s.triangles);
    for (size_t i = 0; i < s.vertices; i++, at += 24)
        for (int a = 0; a < 3; a++) {
            uint32_t bits[2];
            memcpy(&bits[0], &s.position[3 * i + a], 4);
            memcpy(&bits[1], &s.normal[3 * i + a], 4);
            assert_int_equal(little(at + 4 * a, 4), bits[0]);
            assert_int_equal(little(at + 12 + 4 * a, 4), bits[1]);
        }
    for (size_t t = 0; t < s.triangles; t++, at += 13) {
        assert_int_equal(at[0], 3);
        assert_int_equal(little(at + 5, 4), s.triangle[3 * t + 1]);
    }
    free(text);
    assert_int_equal(export_to(world, RHEO_EXPORT_OBJ, "a.obj").vertices, s.vertices);
    char *obj = read_whole("a.obj", &size), *o = strchr(obj, '\n');
    for (int part = 0; part < 2; part++)
        for (size_t i = 0; i < 3 * (size_t)s.vertices; i++) {
            const float read = (float)next_number(&o);
            assert_memory_equal(&read, &(part ? s.normal : s.position)[i], sizeof read);
        }
    for (size_t i = 0; i < 3 * (size_t)s.triangles; i++) {
        assert_true(next_number(&o) == s.triangle[i] + 1);
        assert_true(next_number(&o) == s.triangle[i] + 1);
    }
    assert_string_equal(o, "\n");
    free(obj);
    rheo_surface_release(&s);
    rheo_world_destroy(world);
}

static void numbers_are_the_same_in_every_locale(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    for (uint32_t f = 0; rheo_export_format_name(f); f++)
        export_to(world, (rheo_export_format)f, rheo_export_format_name(f));
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
        rheo_world_destroy(world);
        print_message("no German locale here: nothing to compare with\n");
        skip();
    }
    for (uint32_t f = 0; rheo_export_format_name(f); f++) {
        size_t size[2];
        export_to(world, (rheo_export_format)f, "german");
        char *plain = read_whole(rheo_export_format_name(f), &size[0]), *german = read_whole("german", &size[1]);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(plain, german, size[0]);
        free(plain);
        free(german);
    }
    setlocale(LC_ALL, "C");
    rheo_world_destroy(world);
}

static void files_are_kept_without_force(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    rheo_world *world = world_of(def, 0, NULL, NULL);
    const rheo_export_options options = {rheo_default_surface_options(), NULL, false};
    for (uint32_t f = 0; rheo_export_format_name(f); f++) { /* of a world without particles, valid all the same */
        char path[16];
        snprintf(path, sizeof path, "none.%s", rheo_export_format_name(f));
        OK(rheo_world_export(world, (rheo_export_format)f, path, &options, NULL, &error));
        REFUSED(RHEO_ERROR_FILE, path, rheo_world_export(world, (rheo_export_format)f, path, &options, NULL, &error));
    }
    size_t size;
    char *text = read_whole("none.csv", &size);
    assert_string_equal(text, "id,x,y,z,vx,vy,vz\n");
    free(text);
    text = read_whole("none.ply", &size);
    assert_non_null(strstr(text, "element vertex 0\n"));
    free(text);
    REFUSED(RHEO_ERROR_FILE, "no/such", rheo_world_export(world, 0, "no/such/file", &options, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "format", rheo_world_export(world, 9, "x", &options, NULL, &error));
    assert_null(rheo_export_format_name(9));
    rheo_world_destroy(world);
}

static void one_far_out_does_not_widen_pictures(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 5, 2, 3, 4);
    add(c, 1e6, 0, 0);
    add(c, 0, 1e20, 0);
    rheo_world *world = world_of(inert_def(), c->count, c->position, NULL);
    const rheo_extent e = rheo_world_extent(world);
    for (int a = 0; a < 3; a++) {
        NEAR(e.min[a], a - 3 - .5, 1e-6);
        NEAR(e.max[a], a + 7 + .5, 1e-6);
    }
    rheo_world_destroy(world);
    /* Of two particles none is far out. */
    world = world_of(inert_def(), 2, (const rheo_real[6]){0, 0, 0, 1000, 0, 0}, NULL);
    NEAR(rheo_world_extent(world).max[0], 1000.5, 1e-6);
    rheo_world_destroy(world);
    free(c);
}

static void collections_name_files(void **unused)
{
    (void)unused;
    static const char *const files[] = {"a_000000.vtp", "b&\"<.vtp"};
    OK(rheo_export_collection("c.pvd", 2, files, (const double[2]){0, .1}, false, &error));
    size_t size;
    char *text = read_whole("c.pvd", &size);
    assert_non_null(strstr(text, "<DataSet timestep=\"0.1\" part=\"0\" file=\"b&amp;&quot;&lt;.vtp\"/>"));
    free(text);
    REFUSED(RHEO_ERROR_FILE, "c.pvd", rheo_export_collection("c.pvd", 0, NULL, NULL, false, &error));
}

/* ---- Pictures ---- */

static bool can_render(void)
{
    return system("povray --version >povray.txt 2>&1") == 0;
}

/* How many different colours a picture of 80 x 60 has; every part of a colour in 8 steps. */
static int render(const char *scene, bool colours[512])
{
    enum { WIDTH = 80, HEIGHT = 60 };
    char command[256];
    snprintf(command, sizeof command, "povray +I%s +Opicture.ppm +FP +W%d +H%d -D >povray.txt 2>&1", scene, WIDTH,
             HEIGHT);
    size_t size;
    remove("picture.ppm");
    const int status = system(command);
    if (status != 0) {
        char *text = read_whole("povray.txt", &size);
        fail_msg("povray ended with %d:\n%s", status, text);
    }
    char *text = read_whole("picture.ppm", &size);
    assert_int_equal(strncmp(text, "P6", 2), 0);
    const unsigned char *pixel = (const unsigned char *)text + size - 3 * WIDTH * HEIGHT;
    memset(colours, 0, 512 * sizeof *colours);
    int different = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++, pixel += 3) {
        bool *colour = &colours[pixel[0] / 32 * 64 + pixel[1] / 32 * 8 + pixel[2] / 32];
        different += !*colour;
        *colour = true;
    }
    free(text);
    return different;
}

static void pictures_show_something(void **unused)
{
    (void)unused;
    if (!can_render()) {
        print_message("no povray here: nothing is rendered\n");
        skip();
    }
    bool colours[512];
    rheo_world *world = lively_world();
    export_to(world, RHEO_EXPORT_POV, "world.pov");
    const int whole = render("world.pov", colours);
    rheo_world_destroy(world);
    rheo_world *empty = world_of(inert_def(), 0, NULL, NULL);
    export_to(empty, RHEO_EXPORT_POV, "empty.pov");
    assert_true(render("empty.pov", colours) < whole && whole >= 8);
    assert_int_equal(render("empty.pov", colours), 1);
    rheo_world_destroy(empty);
}

/* Cold and hot halves of a ball, as files: both their colours are there. */
static void temperatures_are_painted(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 4, 0, 0, 0);
    for (uint32_t i = 0; i < c->count; i++)
        c->value[i] = (rheo_real)(c->position[3 * i] < 0 ? 10 : 30);
    const rheo_surface_particles p = {
        .count = c->count, .position = c->position, .value = c->value, .spacing = 1, .smoothing_length = 1};
    const rheo_surface_options options = rheo_default_surface_options();
    rheo_surface s;
    OK(rheo_surface_make(&p, &options, NULL, &s, &error));
    const rheo_extent extent = {{-4.5, -4.5, -4.5}, {4.5, 4.5, 4.5}, 10, 30};
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    static rheo__output out;
    OK(rheo__output_open(&out, "heat.ply", true, &error));
    rheo__write_ply(&out, &s, &extent);
    OK(rheo__output_close(&out, RHEO_OK, &error));
    size_t size;
    char *text = read_whole("heat.ply", &size);
    const char *at = strstr(text, "end_header\n") + 11;
    assert_non_null(strstr(text, "property uchar blue\n"));
    assert_int_equal(size - (size_t)(at - text), 31 * (size_t)s.vertices + 13 * (size_t)s.triangles);
    int blue = 0, red = 0;
    for (size_t i = 0; i < s.vertices; i++, at += 31) {
        const unsigned char *colour = (const unsigned char *)at + 28;
        if (s.position[3 * i] < -2)
            blue += colour[2] > colour[0] + 80;
        if (s.position[3 * i] > 2)
            red += colour[0] > colour[2] + 80;
    }
    assert_true(blue > 20 && red > 20);
    free(text);
    OK(rheo__output_open(&out, "heat.pov", true, &error));
    rheo__write_pov(&out, world, &s, &extent);
    OK(rheo__output_close(&out, RHEO_OK, &error));
    if (can_render()) {
        bool colours[512], cold = false, hot = false;
        render("heat.pov", colours);
        for (int k = 0; k < 512; k++) {
            cold |= colours[k] && k % 8 >= k / 64 + 2;
            hot |= colours[k] && k / 64 >= k % 8 + 2;
        }
        assert_true(cold && hot);
    }
    rheo_surface_release(&s);
    rheo_world_destroy(world);
    free(c);
}

/* Volumes are mass/density there, values temperatures, and tables have both. */
static void melting_worlds_have_density_and_temperature(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 6, 0, 0, 0);
    rheo_real *density = c->volume; /* half as much as it should be: twice the volume each, chi twice as large */
    for (uint32_t i = 0; i < c->count; i++) {
        density[i] = (rheo_real)1.5;
        c->value[i] = (rheo_real)(c->position[3 * i] < 0 ? .25 : .75);
    }
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.fluid.spacing = 1;
    def.melting.rest_density = 3;
    def.particles.count = c->count;
    def.particles.position = c->position;
    def.particles.density = density;
    def.particles.temperature = c->value;
    rheo_world *world;
    rheo_surface s, plain;
    OK(rheo_world_create(&def, &world, &error));
    const rheo_surface_options options = rheo_default_surface_options();
    OK(rheo_world_surface(world, &options, NULL, &s, &error));
    plain = surface_of(c, (rheo_surface_options){.25, 2});
    assert_int_equal(s.vertices, plain.vertices);
    assert_memory_equal(s.triangle, plain.triangle, 3 * sizeof *s.triangle * s.triangles);
    for (size_t i = 0; i < s.vertices; i++) {
        NEAR((double)s.position[3 * i], (double)plain.position[3 * i], 1e-5);
        if (s.position[3 * i] < -3 || s.position[3 * i] > 3)
            NEAR((double)s.value[i], s.position[3 * i] < 0 ? .25 : .75, 1e-3);
    }
    const rheo_extent e = rheo_world_extent(world);
    assert_true(e.coldest == .25 && e.hottest == .75);
    export_to(world, RHEO_EXPORT_CSV, "melting.csv");
    export_to(world, RHEO_EXPORT_PLY, "melting.ply");
    export_to(world, RHEO_EXPORT_VTP, "melting.vtp");
    size_t size;
    char *text = read_whole("melting.csv", &size);
    assert_int_equal(strncmp(text, "id,x,y,z,vx,vy,vz,density,temperature", 37), 0);
    assert_int_equal(strncmp(strchr(text, '\n') + 1, "0,0,0,-6,0,0,0,1.5,0.75", 23), 0);
    free(text);
    text = read_whole("melting.ply", &size);
    assert_non_null(strstr(text, "property float temperature\n"));
    free(text);
    text = read_whole("melting.vtp", &size);
    uint64_t bytes;
    array_of(text, "temperature", &bytes);
    assert_int_equal(bytes, sizeof(rheo_real) * c->count);
    free(text);
    rheo_surface_release(&s);
    rheo_surface_release(&plain);
    rheo_world_destroy(world);
    free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_is_a_ball),
        cmocka_unit_test(a_torus_has_a_hole),
        cmocka_unit_test(a_hollow_faces_inwards),
        cmocka_unit_test(few_particles_have_surfaces_too),
        cmocka_unit_test(isovalues_may_be_extreme),
        cmocka_unit_test(random_clouds_are_closed),
        cmocka_unit_test(noise_is_closed),
        cmocka_unit_test(corners_at_the_isovalue_are_closed),
        cmocka_unit_test(faults_are_found),
        cmocka_unit_test(surfaces_are_the_same_to_the_byte),
        cmocka_unit_test(values_are_means_of_particles),
        cmocka_unit_test(particles_far_out_cost_nothing),
        cmocka_unit_test(no_memory_leaves_nothing),
        cmocka_unit_test(bad_particles_and_options_are_refused),
        cmocka_unit_test(csv_reads_back_to_the_same_bits),
        cmocka_unit_test(vtp_has_its_arrays),
        cmocka_unit_test(meshes_are_the_surface),
        cmocka_unit_test(numbers_are_the_same_in_every_locale),
        cmocka_unit_test(files_are_kept_without_force),
        cmocka_unit_test(one_far_out_does_not_widen_pictures),
        cmocka_unit_test(collections_name_files),
        cmocka_unit_test(pictures_show_something),
        cmocka_unit_test(temperatures_are_painted),
        cmocka_unit_test(melting_worlds_have_density_and_temperature),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
