/* The free surface: closed for any particles, of the right shape, the same to the byte. */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "view_support.h"

#include "view/grid.h"

static uint64_t hash_of(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ b[i]) * UINT64_C(1099511628211);
    return hash;
}

/* Hashes the numbers, independent of the byte order. */
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

static void a_ball_has_its_shape(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 8, .3, -.2, .1);
    for (double resolution = 1; resolution <= 4; resolution *= 2) {
        rheo_surface s = surface_of(c, (rheo_surface_options){.5, resolution});
        assert_closed(&s);
        assert_int_equal(euler(&s), 2);
        NEAR(volume_of(&s) / c->count, .97, .03); /* chi is smaller outside a convex surface */
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

/* A hollow ball has two surfaces; the inner one faces the hollow. */
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
    rheo_surface s = surface_of(c, rheo_default_surface_options()); /* no surface */
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

/* The largest possible chi of a particle is at the particle, if that is at a corner of the grid. */
static void a_surface_just_below_the_largest_value_is_found(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add(c, 0, 0, 0);
    const double largest = 66 / (120 * 3.14159265358979323846);
    rheo_surface s = surface_of(c, (rheo_surface_options){largest * (1 - 5e-7), 2});
    assert_int_equal(s.triangles, 8); /* an octahedron around the corner */
    assert_closed(&s);
    rheo_surface_release(&s);
    s = surface_of(c, (rheo_surface_options){largest * (1 + 5e-7), 2});
    assert_int_equal(s.triangles, 0);
    rheo_surface_release(&s);
    free(c);
}

/* Wherever a particle is among the blocks of the grid, its surface is the same. */
static void surfaces_move_with_their_particles(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    uint32_t vertices = 0;
    c->count = 1;
    for (int along = 0; along < 3; along++)
        for (int cells = 0; cells < 2 * RHEO__BLOCK; cells++) {
            memset(c->position, 0, 3 * sizeof *c->position);
            c->position[along] = (rheo_real)(.5 * cells); /* cells are half as wide as the smoothing length */
            rheo_surface s = surface_of(c, (rheo_surface_options){1e-9, 2});
            double least = 1e9, most = -1e9;
            for (size_t v = 0; v < s.vertices; v++) {
                const double x = (double)s.position[3 * v + (size_t)along];
                least = fmin(least, x);
                most = fmax(most, x);
            }
            vertices = vertices ? vertices : s.vertices;
            assert_int_equal(s.vertices, vertices);
            NEAR(least + most, 2 * (double)c->position[along], 1e-4);
            NEAR(most - least, 6, .2); /* chi ends at three smoothing lengths */
            rheo_surface_release(&s);
        }
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

/* Splashes, sheets, clumps: many cells with alternating corners. */
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

/*
 * Vertices inside a cell are the means of the loop around them, and so are their values; all others lie on edges of
 * cells, where two coordinates are multiples of the width. Returns their number.
 */
static uint32_t middles_of(const rheo_surface *s, double width)
{
    uint32_t middles = 0;
    double(*sum)[5] = calloc(s->vertices, sizeof *sum); /* of positions, of values, and their number */
    assert_non_null(sum);
    for (size_t i = 0; i < 3 * (size_t)s->triangles; i++) {
        const uint32_t next = s->triangle[i % 3 < 2 ? i + 1 : i - 2];
        double *of = sum[s->triangle[i]];
        for (uint32_t k = 0; k < 3; k++)
            of[k] += (double)s->position[3 * (size_t)next + k];
        of[3] += (double)s->value[next];
        of[4]++;
    }
    for (size_t v = 0; v < s->vertices; v++) {
        int on_grid = 0;
        for (size_t k = 0; k < 3; k++) {
            const double cells = (double)s->position[3 * v + k] / width;
            on_grid += fabs(cells - nearbyint(cells)) < 1e-5;
        }
        if (on_grid > 1)
            continue;
        middles++;
        for (size_t k = 0; k < 3; k++)
            NEAR((double)s->position[3 * v + k], sum[v][k] / sum[v][4], 1e-5);
        NEAR((double)s->value[v], sum[v][3] / sum[v][4], 1e-5);
    }
    free(sum);
    return middles;
}

/* Noise on a coarse grid covers all 256 cases of a cell, including loops that cross a face twice. */
static void noise_is_closed(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    uint64_t seed = 3;
    uint32_t middles = 0;
    for (int round = 0; round < 20; round++) {
        c->count = 0;
        for (int i = 0; i < 2000; i++) {
            add(c, 5 * random_number(&seed), 5 * random_number(&seed), 5 * random_number(&seed));
            c->volume[i] = (rheo_real)(.2 * random_number(&seed));
            c->value[i] = c->position[3 * i];
        }
        const rheo_surface_particles p = {.count = c->count,
                                          .position = c->position,
                                          .volume = c->volume,
                                          .value = c->value,
                                          .smoothing_length = .2};
        rheo_surface s;
        OK(rheo_surface_make(&p, &(rheo_surface_options){.02 + .5 * random_number(&seed), .5}, NULL, &s, &error));
        assert_true(s.triangles > 100);
        assert_closed(&s);
        middles += middles_of(&s, .4);
        rheo_surface_release(&s);
    }
    assert_true(middles > 0);
    free(c);
}

/* The isovalue equals the value of a corner close to the surface. */
static void corners_at_the_isovalue_are_closed(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 3, 0, 0, 0); /* by symmetry, 6 to 48 corners have that value */
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
    t[0] = t[2]; /* opposite orientation */
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

/* ---- Reproducibility ---- */

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
    assert_int_equal(hash[0], UINT64_C(0x2979db83d60f0bba)); /* the same on every machine */
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
    for (size_t v = 0; v < s.vertices; v++) /* only particles of the inner side: a smaller gradient */
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

/* Bytes before a block for its size, and bytes behind it that nobody may write. */
enum { BEFORE = 64, BEHIND = 64, GUARDED = 0x6b };

static void *counting_allocate(size_t bytes, void *user)
{
    counted *count = user;
    if (++count->calls == count->fail_at)
        return NULL;
    size_t *memory = malloc(BEFORE + bytes + BEHIND);
    if (!memory)
        return NULL;
    *memory = bytes;
    memset((char *)memory + BEFORE + bytes, GUARDED, BEHIND);
    count->bytes += bytes;
    count->most = count->bytes > count->most ? count->bytes : count->most;
    count->held++;
    return (char *)memory + BEFORE;
}

static void counting_release(void *memory, void *user)
{
    counted *count = user;
    size_t *start = (size_t *)(void *)((char *)memory - BEFORE);
    for (int i = 0; i < BEHIND; i++)
        assert_int_equal(((const char *)memory)[*start + (size_t)i], GUARDED);
    count->bytes -= *start;
    count->held--;
    free(start);
}

/* A particle a million supports away costs neither memory nor triangles. One beyond all cells is omitted. */
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
    /* A clump at that distance has a surface. */
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

static void a_failed_allocation_leaves_nothing(void **unused)
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
    const rheo_surface_options bad[] = {{0, 2},   {1, 2}, {NAN, 2}, {.5, nextafter(.5, 0)}, {.5, nextafter(8, 9)},
                                        {.5, NAN}};
    for (int i = 0; i < 6; i++)
        REFUSED(RHEO_ERROR_ARGUMENT, i < 3 ? "isovalue" : "resolution",
                rheo_surface_make(&p, &bad[i], NULL, &s, &error));
    const rheo_surface_options least = {nextafter(0, 1), .5}, most = {nextafter(1, 0), 8};
    OK(rheo_surface_make(&p, &least, NULL, &s, &error));
    rheo_surface_release(&s);
    OK(rheo_surface_make(&p, &most, NULL, &s, &error));
    rheo_surface_release(&s);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_has_its_shape),
        cmocka_unit_test(a_torus_has_a_hole),
        cmocka_unit_test(a_hollow_faces_inwards),
        cmocka_unit_test(few_particles_have_surfaces_too),
        cmocka_unit_test(a_surface_just_below_the_largest_value_is_found),
        cmocka_unit_test(surfaces_move_with_their_particles),
        cmocka_unit_test(isovalues_may_be_extreme),
        cmocka_unit_test(random_clouds_are_closed),
        cmocka_unit_test(noise_is_closed),
        cmocka_unit_test(corners_at_the_isovalue_are_closed),
        cmocka_unit_test(faults_are_found),
        cmocka_unit_test(surfaces_are_the_same_to_the_byte),
        cmocka_unit_test(values_are_means_of_particles),
        cmocka_unit_test(particles_far_out_cost_nothing),
        cmocka_unit_test(a_failed_allocation_leaves_nothing),
        cmocka_unit_test(bad_particles_and_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
