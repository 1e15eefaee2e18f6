/* Neighbour lists against all pairs, and the order they promise. */
#include "support.h"

#include "space/neighbours.h"

static const rheo_allocator *allocator(void)
{
    static rheo_allocator a;
    a = rheo_allocator_or_default((rheo_allocator){NULL, NULL, NULL});
    return &a;
}

static uint64_t seed;
static double random_unit(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) / 9007199254740992.0;
}

/* Every pair closer than the support, once, at its lower rank, ascending; whole rows are ascending and end with it.
 */
static void check(uint32_t n, const rheo_real *x, double support)
{
    rheo_neighbours list = {0};
    rheo_pairs pairs = {0};
    assert_true(rheo_neighbours_build(&list, &pairs, allocator(), n, x, support, true));
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
    assert_int_equal(list.row_start[n], 2 * rheo_pairs_count(&pairs));
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = 0; b < n; b++) {
            rheo_real dx = x[3 * b] - x[3 * a], dy = x[3 * b + 1] - x[3 * a + 1], dz = x[3 * b + 2] - x[3 * a + 2];
            assert_int_equal(found[(size_t)a * n + b], a != b && rheo_length2(dx, dy, dz) < limit);
        }
    /* The lines hold every rank once. */
    uint8_t *seen = calloc((size_t)n + 1, 1);
    assert_non_null(seen);
    for (uint32_t l = 0; l < list.line_count; l++)
        for (uint32_t i = list.line[l].first; i < list.line[l].end; i++)
            seen[i]++;
    for (uint32_t i = 0; i < n; i++)
        assert_int_equal(seen[i], 1);
    free(seen);
    free(found);
    rheo_neighbours_release(&list, allocator());
    rheo_pairs_release(&pairs, allocator());
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
    /* Two close pairs a million and a billion supports out, beyond the outermost cells, and some at home. */
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

/* Two lines of one colour must share no particle: rows and their partners of different lines never meet. */
static void lines_of_a_colour_are_disjoint(void **unused)
{
    (void)unused;
    enum { N = 600 };
    rheo_real x[3 * N];
    seed = 7;
    for (int i = 0; i < 3 * N; i++)
        x[i] = (rheo_real)(8 * random_unit());
    rheo_neighbours list = {0};
    rheo_pairs pairs = {0};
    assert_true(rheo_neighbours_build(&list, &pairs, allocator(), N, x, 1, true));
    int8_t colour_of_rank[N];
    uint32_t owner[N], stamp[N];
    memset(stamp, 0xFF, sizeof stamp);
    int shared_lines = 0;
    for (uint32_t l = 0; l < list.line_count; l++) {
        const rheo_real *first = x + 3 * pairs.id_of[list.line[l].first];
        double cell = 1 + 1.0 / (1 << 20);
        int colour = (int)((double)first[0] / cell) % 3 + 3 * ((int)((double)first[2] / cell) % 3);
        for (uint32_t i = list.line[l].first; i < list.line[l].end; i++)
            colour_of_rank[i] = (int8_t)colour;
        for (uint32_t i = list.line[l].first; i < list.line[l].end; i++) {
            uint32_t touched[N], count = 0;
            touched[count++] = i;
            for (uint32_t k = list.row_start[i]; k < list.row_start[i + 1]; k++)
                touched[count++] = list.row[k];
            for (uint32_t k = 0; k < count; k++) {
                if (stamp[touched[k]] == (uint32_t)colour)
                    assert_int_equal(owner[touched[k]], l);
                stamp[touched[k]] = (uint32_t)colour;
                owner[touched[k]] = l;
            }
        }
        shared_lines += l > 0 && colour_of_rank[list.line[l - 1].first] == colour;
    }
    assert_true(shared_lines > 9); /* colours do have several lines */
    rheo_neighbours_release(&list, allocator());
    rheo_pairs_release(&pairs, allocator());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_clouds),
        cmocka_unit_test(lattice_on_cell_borders),
        cmocka_unit_test(particles_far_away),
        cmocka_unit_test(none_one_and_coinciding),
        cmocka_unit_test(lines_of_a_colour_are_disjoint),
    };
    return cmocka_run_group_tests_name("neighbours", tests, NULL, NULL);
}
