/* Neighbour lists against all pairs, and their documented order. */
#include "support.h"

#include <math.h>

#include "space/neighbours.h"

static const rheo_allocator *allocator(void)
{
    static rheo_allocator a;
    a = rheo__allocator_or_default((rheo_allocator){NULL, NULL, NULL});
    return &a;
}

static uint64_t seed;
static double random_unit(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) / 9007199254740992.0;
}

/*
 * Every pair closer than the support appears once, in the row of its lower rank. Rows are ascending and contiguous.
 */
static void check(uint32_t n, const rheo_real *x, double support)
{
    rheo__neighbours list = {0};
    rheo__pairs pairs = {0};
    assert_true(rheo__neighbours_build(&list, &pairs, allocator(), n, x, support, true));
    rheo_real limit = (rheo_real)support * (rheo_real)support;
    uint8_t *found = calloc((size_t)n * n + 1, 1);
    assert_non_null(found);
    for (uint32_t i = 0; i < n; i++) {
        assert_int_equal(pairs.rank_of[pairs.id_of[i]], i);
        for (uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; k++) {
            uint32_t j = pairs.partner[k];
            assert_true(j > i && j < n);
            assert_true(k == pairs.start[i] || pairs.partner[k - 1] < j);
            found[(size_t)pairs.id_of[i] * n + pairs.id_of[j]]++;
            found[(size_t)pairs.id_of[j] * n + pairs.id_of[i]]++;
        }
        uint32_t own = pairs.start[i + 1] - pairs.start[i], length = list.row_start[i + 1] - list.row_start[i];
        assert_true(length >= own);
        for (uint32_t k = 0; k < length; k++) {
            uint32_t j = list.row[list.row_start[i] + k];
            assert_true(k == 0 || list.row[list.row_start[i] + k - 1] < j);
            assert_true(k < length - own ? j < i : j == pairs.partner[pairs.start[i] + k - (length - own)]);
        }
    }
    assert_int_equal(list.row_start[n], 2 * rheo__pairs_count(&pairs));
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = 0; b < n; b++) {
            rheo_real dx = x[3 * b] - x[3 * a], dy = x[3 * b + 1] - x[3 * a + 1], dz = x[3 * b + 2] - x[3 * a + 2];
            assert_int_equal(found[(size_t)a * n + b], a != b && rheo__length2(dx, dy, dz) < limit);
        }
    /* The lines contain every rank once. */
    uint8_t *seen = calloc((size_t)n + 1, 1);
    assert_non_null(seen);
    for (uint32_t l = 0; l < list.line_count; l++)
        for (uint32_t i = list.line[l].first; i < list.line[l].end; i++)
            seen[i]++;
    for (uint32_t i = 0; i < n; i++)
        assert_int_equal(seen[i], 1);
    free(seen);
    free(found);
    rheo__neighbours_release(&list, allocator());
    rheo__pairs_release(&pairs, allocator());
}

static void random_clouds(void **unused)
{
    (void)unused;
    rheo_real x[3 * 400];
    for (int round = 0; round < 40; round++) {
        seed = (uint64_t)round;
        double size = 0.5 + round * 0.4, centre = (round % 5 - 2) * 1000.0;
        for (int i = 0; i < 3 * 400; i++)
            x[i] = (rheo_real)(centre + size * (2 * random_unit() - 1));
        check(400, x, 1.0 + 0.1 * (round % 7));
    }
}

static void lattice_on_cell_borders(void **unused)
{
    (void)unused;
    rheo_real x[3 * 343];
    for (int i = 0; i < 343; i++) {
        x[3 * i] = (rheo_real)(i % 7 - 3);
        x[3 * i + 1] = (rheo_real)(i / 7 % 7 - 3);
        x[3 * i + 2] = (rheo_real)(i / 49 - 3);
    }
    check(343, x, 1);
    check(343, x, 1.5);
    check(343, x, 2);
}

static void particles_far_away(void **unused)
{
    (void)unused;
    /*
     * Two close pairs at a distance of a million and a billion supports, beyond the outermost cells, and some
     * particles near the origin.
     */
    const rheo_real x[] = {0,    0,    0,    0.5F, 0,    0,    1e6F,   -1e6F, 1e6F, 1e6F, -1e6F, 1e6F,
                           1e9F, 1e9F, 1e9F, 1e9F, 1e9F, 1e9F, -1e30F, 0,     0,    0.5F, 0.5F,  0};
    check(8, x, 1);
}

static void none_one_and_coinciding(void **unused)
{
    (void)unused;
    rheo_real x[3 * 50] = {0};
    check(0, x, 1);
    check(1, x, 1);
    check(50, x, 1);
}

/* Coordinates that are not finite hide no pair of the other particles in their cell, and make none. */
static void coordinates_that_are_not_finite(void **unused)
{
    (void)unused;
    const rheo_real bad[] = {(rheo_real)NAN, (rheo_real)INFINITY, -(rheo_real)INFINITY};
    rheo_real x[3 * 200];
    for (int round = 0; round < 12; round++) {
        seed = (uint64_t)round;
        for (int i = 0; i < 3 * 200; i++)
            x[i] = (rheo_real)(4 * random_unit() - 2);
        for (int i = 0; i < 8; i++)
            x[(int)(3 * 200 * random_unit())] = bad[round % 3];
        check(200, x, 1);
    }
}

static int32_t cell(rheo_real x, double support)
{
    return (int32_t)floor((double)x / (support * (1 + 1.0 / (1 << 20))));
}

static int32_t modulo3(int32_t value)
{
    return ((value % 3) + 3) % 3;
}

/*
 * Conditions for walks over groups. Lines of one group share no particle and no partner. If two lines share one, the
 * line with the lower colour is in the earlier group. So parallel lines have the result of the loop over colours and
 * lines in docs/model.md. Returns the number of groups.
 */
static uint32_t check_groups(uint32_t n, const rheo_real *x, double support)
{
    rheo__neighbours list = {0};
    rheo__pairs pairs = {0};
    assert_true(rheo__neighbours_build(&list, &pairs, allocator(), n, x, support, true));
    uint32_t lines = list.line_count, *group = calloc(lines, sizeof *group);
    int32_t(*place)[2] = calloc(lines, sizeof *place), *colour = calloc(lines, sizeof *colour);
    assert_true(group && place && colour);
    assert_int_equal(list.group_start[0], 0);
    assert_int_equal(list.group_start[list.group_count], lines);
    for (uint32_t g = 0; g < list.group_count; g++)
        for (uint32_t l = list.group_start[g]; l < list.group_start[g + 1]; l++) {
            const rheo_real *first = x + 3 * (size_t)pairs.id_of[list.line[l].first];
            group[l] = g;
            place[l][0] = cell(first[0], support);
            place[l][1] = cell(first[2], support);
            colour[l] = modulo3(place[l][0]) + 3 * modulo3(place[l][1]);
            for (uint32_t i = list.line[l].first; i < list.line[l].end; i++) {
                assert_int_equal(cell(x[3 * (size_t)pairs.id_of[i]], support), place[l][0]);
                assert_int_equal(cell(x[3 * (size_t)pairs.id_of[i] + 2], support), place[l][1]);
            }
        }
    for (uint32_t a = 0; a < lines; a++)
        for (uint32_t b = a + 1; b < lines; b++) {
            if (abs(place[a][0] - place[b][0]) > 2 || abs(place[a][1] - place[b][1]) > 2)
                continue;
            assert_true(group[a] != group[b] && colour[a] != colour[b]);
            assert_int_equal(group[a] < group[b], colour[a] < colour[b]);
        }
    uint32_t groups = list.group_count;
    free(colour);
    free(place);
    free(group);
    rheo__neighbours_release(&list, allocator());
    rheo__pairs_release(&pairs, allocator());
    return groups;
}

static void lines_that_share_particles_keep_the_order_of_colours(void **unused)
{
    (void)unused;
    enum { MOST = 12000 };
    static rheo_real x[3 * MOST];
    for (int round = 0; round < 12; round++) {
        seed = (uint64_t)round;
        double wide = round % 3 ? 30 : 4, deep = round % 2 ? 90 : 9;
        for (int i = 0; i < MOST; i++) {
            x[3 * i] = (rheo_real)(wide * (random_unit() - 0.5));
            x[3 * i + 1] = (rheo_real)(2 * random_unit());
            x[3 * i + 2] = (rheo_real)(deep * (random_unit() - 0.5));
            if (round >= 6) /* slabs with gaps of all lengths */
                x[3 * i + 2] = (rheo_real)(floor((double)x[3 * i + 2] / 7) * (7 + round) + (double)x[3 * i + 2] / 4);
        }
        uint32_t groups = check_groups(MOST, x, 1);
        assert_true(deep < 10 || wide < 5 || round >= 6 || groups > 3 * RHEO__COLOURS); /* several blocks */
    }
    /* A few distant particles: the number of groups is at most the number of lines. */
    for (int i = 0; i < 60; i++) {
        x[3 * i] = (rheo_real)(1000 * random_unit());
        x[3 * i + 2] = (rheo_real)(9e5 * (random_unit() - 0.5));
    }
    assert_true(check_groups(60, x, 1) <= 3 * RHEO__COLOURS);
    assert_true(check_groups(1, x, 1) <= 2 * RHEO__COLOURS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_clouds),
        cmocka_unit_test(lattice_on_cell_borders),
        cmocka_unit_test(particles_far_away),
        cmocka_unit_test(none_one_and_coinciding),
        cmocka_unit_test(coordinates_that_are_not_finite),
        cmocka_unit_test(lines_that_share_particles_keep_the_order_of_colours),
    };
    return cmocka_run_group_tests_name("neighbours", tests, NULL, NULL);
}
