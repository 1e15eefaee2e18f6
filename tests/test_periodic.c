/* Periodic space (space/period.h, docs/model.md): images, lists, springs across borders, loading. */
#include <math.h>

#include "support.h"

#include "space/neighbours.h"
#include "world/world.h"

enum { MOST = 2000 };

static uint32_t seed;

static double unit(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (double)(seed >> 8) / (1 << 24);
}

/* Fluid with a period of 20 along x and z (and y), on a lattice with displacements that are multiples of 1/256. */
static rheo_world_def noisy_def(rheo_real *position, bool closed)
{
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    def.history.window = 6;
    for (int axis = 0; axis < 3; axis++)
        def.space.period[axis] = axis == 1 && !closed ? 0 : 20;
    uint32_t n = 0;
    seed = 7;
    for (int x = 0; x < 10; x++)
        for (int y = 0; y < 10; y++)
            for (int z = 0; z < 10; z++, n++) {
                const int at[3] = {x, y, z};
                for (int axis = 0; axis < 3; axis++)
                    position[3 * n + (uint32_t)axis] =
                        (rheo_real)(2 * at[axis] - 9) + (rheo_real)floor(128 * unit()) / 256;
            }
    def.particles.count = n;
    def.particles.position = position;
    return def;
}

static rheo_world *make(const rheo_world_def *def)
{
    rheo_world *world;
    OK(rheo_world_create(def, &world, &error));
    return world;
}

static double wrapped(double x, double period)
{
    return x - period * floor(x / period + 0.5);
}

/* ---- Symmetry ---- */

/* Makes a step, or only its part up to stage viscosity, in fluid and in the same fluid shifted by whole cells. */
static void same_bits_when_shifted(rheo_world_def *def, const rheo_real *velocity, bool whole)
{
    static rheo_real there[3 * MOST];
    rheo_world *world[2];
    def->particles.velocity = velocity;
    world[0] = make(def);
    for (uint32_t i = 0; i < 3 * def->particles.count; i++)
        there[i] = (rheo_real)wrapped((double)def->particles.position[i] + (i % 3 == 0   ? 5
                                                                            : i % 3 == 1 ? -10
                                                                                         : 0),
                                      20);
    def->particles.position = there;
    world[1] = make(def);
    for (int k = 0; k < 2; k++) {
        char stage[32] = "";
        while (!whole && strcmp(stage, "viscosity") != 0) {
            uint32_t index;
            OK(rheo_world_step_stage(world[k], &index, &error));
            rheo_world_last_stage(world[k], stage);
        }
        if (whole)
            step(world[k], 1);
    }
    size_t moved = 0;
    for (uint32_t i = 0; i < 3 * def->particles.count; i++) {
        assert_true(rheo_world_velocities(world[0])[i] == rheo_world_velocities(world[1])[i]);
        moved += rheo_world_velocities(world[0])[i] != 0;
    }
    assert_true(moved > def->particles.count);
    assert_true(rheo__state_hash_field(&world[0]->state, RHEO__FIELD_spring_rest_length) ==
                rheo__state_hash_field(&world[1]->state, RHEO__FIELD_spring_rest_length));
    rheo_world_destroy(world[0]);
    rheo_world_destroy(world[1]);
}

/* Such a shift is exact in binary, and sums have the same terms in the same order. */
static void a_shift_by_whole_cells_gives_the_same_bits(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST], v[3 * MOST];
    rheo_world_def def = noisy_def(x, true);
    def.substeps = 1;
    same_bits_when_shifted(&def, NULL, true);
    def = noisy_def(x, true);
    def.fluid.linear_viscosity = 100; /* impulses reach their bound */
    for (uint32_t i = 0; i < 3 * def.particles.count; i++)
        v[i] = (rheo_real)(2 * unit() - 1);
    same_bits_when_shifted(&def, v, false);
}

static void any_shift_gives_the_same_forces(void **unused)
{
    (void)unused;
    static rheo_real here[3 * MOST], there[3 * MOST];
    rheo_world_def def = noisy_def(here, true);
    rheo_world *a = make(&def);
    for (uint32_t i = 0; i < 3 * def.particles.count; i++)
        there[i] = (rheo_real)wrapped((double)here[i] + 3.3 + i % 3, 20);
    def.particles.position = there;
    rheo_world *b = make(&def);
    step(a, 1);
    step(b, 1);
    double most = 0;
    for (uint32_t i = 0; i < 3 * def.particles.count; i++) {
        const double v = (double)rheo_world_velocities(a)[i];
        most = fmax(most, fabs(v));
        /* Positions are rounded to 1e-6, and a pressure changes by k per support; 30 neighbours. */
        NEAR((double)rheo_world_velocities(b)[i], v, 30 * def.step * 300 * 4e-6);
    }
    assert_true(most > 0.5);
    rheo_world_destroy(a);
    rheo_world_destroy(b);
}

static void momentum_is_conserved_to_rounding(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    const rheo_world_def def = noisy_def(x, true);
    rheo_world *world = make(&def);
    double fastest = 0, substeps = 0;
    for (int s = 0; s < 60; s++) {
        step(world, 1);
        fastest = fmax(fastest, metric(world, "max_speed"));
        substeps += metric(world, "substeps") + 1; /* and the viscosity */
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        double momentum = 0;
        for (uint32_t i = 0; i < def.particles.count; i++)
            momentum += (double)rheo_world_velocities(world)[3 * i + axis];
        /* Each change rounds a velocity; as many ups as downs, with ten standard deviations. */
        NEAR(momentum, 0, 10 * 0x1p-24 * fastest * sqrt(substeps * def.particles.count));
    }
    assert_true(fastest > 0.5);
    rheo_world_destroy(world);
}

static void a_crystal_has_no_force_anywhere(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    rheo_world_def def = noisy_def(x, true);
    def.fluid.support = 3.9; /* no two particles are at that distance */
    for (uint32_t i = 0; i < 3 * def.particles.count; i++)
        x[i] = (rheo_real)(2 * floor((double)x[i] / 2) + 1);
    rheo_world *world = make(&def);
    step(world, 3);
    static rheo_particle_state state[MOST];
    OK(rheo_world_particles(world, state, &error));
    for (uint32_t i = 0; i < def.particles.count; i++) {
        assert_int_equal(state[i].neighbours, 26);
        NEAR(state[i].density, state[0].density, 1e-4);
        assert_true(state[i].speed < 1e-3); /* by one neighbour less: 9 */
    }
    rheo_world_destroy(world);
}

/* ---- A pair across the border ---- */

static void a_pair_across_the_border_is_like_one_inside(void **unused)
{
    (void)unused;
    for (size_t axis = 0; axis < 3; axis++) {
        rheo_world_def def = rheo_default_world_def();
        def.history.hardening = axis == 1 ? RHEO_HARDENING_PASSIVE : RHEO_HARDENING_ACTIVE;
        memset(def.gravity, 0, sizeof def.gravity);
        def.space.period[axis] = 16;
        def.particles.count = 2;
        rheo_real x[6] = {0, 0, 0, 0.5, 0.5, 0.5}, v[6] = {0};
        x[axis] = (rheo_real)-0.75;
        x[3 + axis] = (rheo_real)0.75;
        v[axis] = 3;
        def.particles.position = x;
        def.particles.velocity = v;
        rheo_world *inside = make(&def);
        x[axis] = (rheo_real)7.25;
        x[3 + axis] = (rheo_real)-7.25;
        rheo_world *across = make(&def);
        for (int s = 0; s < 40; s++) {
            step(inside, 1);
            step(across, 1);
            assert_int_equal(rheo_world_spring_count(inside), rheo_world_spring_count(across));
            for (size_t i = 0; i < 6; i++)
                NEAR((double)rheo_world_velocities(across)[i], (double)rheo_world_velocities(inside)[i], 1e-4);
            const rheo_real *a = rheo_world_positions(inside), *b = rheo_world_positions(across);
            NEAR(wrapped((double)(b[3 + axis] - b[axis]), 16), (double)(a[3 + axis] - a[axis]), 1e-4);
        }
        rheo_spring spring;
        rheo_spring_state in, out;
        OK(rheo_world_springs(across, &spring, 1));
        OK(rheo_world_spring(inside, 0, 1, &in, &error));
        OK(rheo_world_spring(across, 0, 1, &out, &error));
        NEAR(out.length, in.length, 1e-4);
        NEAR((double)spring.rest_length, (double)in.spring.rest_length, 1e-4);
        NEAR(out.stiffness, in.stiffness, 1e-3 * in.stiffness);
        assert_true(in.stiffness > def.springs.stiffness);
        rheo_world_destroy(inside);
        rheo_world_destroy(across);
    }
}

/* Two particles in one place, at both sides of the border, are parted as elsewhere. */
static void a_coinciding_pair_across_the_border_is_parted(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    def.space.period[0] = 16;
    def.particles.count = 2;
    rheo_real x[6] = {-8, 0, 0, 8, 0, 0};
    def.particles.position = x;
    rheo_world *across = make(&def);
    def.space.period[0] = 32;
    x[0] = x[3] = 0;
    rheo_world *inside = make(&def);
    step(across, 1);
    step(inside, 1);
    for (size_t i = 0; i < 6; i++)
        NEAR((double)rheo_world_velocities(across)[i], (double)rheo_world_velocities(inside)[i], 1e-4);
    assert_true(fabs((double)rheo_world_velocities(across)[0]) > 1);
    rheo_world_destroy(across);
    rheo_world_destroy(inside);
}

/* ---- Neighbours ---- */

static void lists_have_the_nearest_images_within_reach(void **unused)
{
    (void)unused;
    enum { N = 400 };
    static rheo_real x[3 * N], margin[N];
    const rheo_allocator allocator = rheo__allocator_or_default((rheo_allocator){0});
    for (uint32_t trial = 0; trial < 8; trial++) {
        rheo_world_def def = rheo_default_world_def();
        const double length[3] = {4.5 + trial, trial & 1 ? 0 : 5, trial & 2 ? 11 : 4.6};
        memcpy(def.space.period, length, sizeof length);
        rheo__period period;
        rheo__period_make(&period, &def);
        seed = trial;
        for (uint32_t i = 0; i < 3 * N; i++)
            x[i] = (rheo_real)((unit() - 0.5) * (length[i % 3] > 0 ? length[i % 3] : 9));
        for (uint32_t i = 0; i < N; i++)
            margin[i] = (rheo_real)(0.25 * unit());
        rheo__neighbours list = {0};
        rheo__pairs pairs = {0};
        assert_true(rheo__neighbours_build_rows(&list, &pairs, &allocator, N, x, 1.75, margin, &period));
        assert_true(rheo__neighbours_lay_out(&list, &pairs, &allocator));
        rheo__neighbours_write_rows(&list, &pairs);
        size_t expected = 0, found = 0, images = 0;
        for (uint32_t i = 0; i < N; i++)
            for (uint32_t j = 0; j < N; j++) {
                const double reach = 1.75 + (double)(margin[i] + margin[j]);
                expected += i != j && (double)rheo__period_distance2(&period, x + 3 * i, x + 3 * j) < reach * reach;
            }
        for (uint32_t rank = 0; rank < N; rank++) {
            static uint32_t seen[N];
            const uint32_t i = pairs.id_of[rank];
            for (size_t k = rheo__pairs_first(&pairs, rank); k < rheo__pairs_end(&pairs, rank); k += pairs.width) {
                const uint32_t place = rheo__pairs_place(&pairs, k), idle = rheo__pairs_idle(&pairs);
                if (place == idle)
                    continue;
                const uint32_t j = pairs.id_of[rheo__pairs_partner(&pairs, k)];
                assert_true(seen[j] != rank + 1 + trial * N); /* once */
                seen[j] = rank + 1 + trial * N;
                double d2 = 0;
                for (size_t axis = 0; axis < 3; axis++) {
                    const double shift = place > idle ? pairs.image[place - idle - 1].shift[axis] : 0,
                                 d = (double)x[3 * j + axis] + shift * (double)period.length[axis] -
                                     (double)x[3 * i + axis];
                    d2 += d * d;
                }
                NEAR(d2, (double)rheo__period_distance2(&period, x + 3 * i, x + 3 * j), 1e-4);
                found++;
                images += place > idle;
            }
        }
        assert_int_equal(found, expected);
        assert_true(images > 0 && pairs.images > 0);
        rheo__pairs_forget_images(&pairs);
        for (size_t k = 0; k < rheo__pairs_entries(&pairs); k++)
            assert_true(rheo__pairs_place(&pairs, k) <= rheo__pairs_idle(&pairs));
        rheo__neighbours_release(&list, &allocator);
        rheo__pairs_release(&pairs, &allocator);
    }
}

static void queries_find_neighbours_across_borders(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    static rheo_particle_state state[MOST];
    const rheo_world_def def = noisy_def(x, false);
    rheo_world *world = make(&def);
    step(world, 5);
    OK(rheo_world_particles(world, state, &error));
    for (uint32_t i = 0; i < def.particles.count; i += 17) {
        rheo_particle_state one;
        OK(rheo_world_particle(world, i, &one, &error));
        assert_memory_equal(&one, &state[i], sizeof one);
        size_t count;
        OK(rheo_world_neighbours(world, i, NULL, NULL, 0, &count, &error));
        assert_int_equal(count, one.neighbours);
        double density = 0;
        for (uint32_t j = 0; j < def.particles.count; j++) {
            double d2 = 0;
            for (uint32_t axis = 0; axis < 3; axis++) {
                double d = (double)rheo_world_positions(world)[3 * i + axis] -
                           (double)rheo_world_positions(world)[3 * j + axis];
                d = axis == 1 ? d : wrapped(d, 20);
                d2 += d * d;
            }
            density += i != j && d2 < 16 ? (1 - sqrt(d2) / 4) * (1 - sqrt(d2) / 4) : 0;
        }
        NEAR(one.density, density, 1e-6);
    }
    rheo_world_destroy(world);
}

/* ---- Springs and lists ---- */

/* Sheared fluid that drifts, so that lists are made often and particles go round. */
static rheo_world *sheared_world(void)
{
    static rheo_real x[3 * MOST], v[3 * MOST];
    rheo_world_def def = noisy_def(x, false);
    for (uint32_t i = 0; i < def.particles.count; i++) {
        v[3 * i] = (rheo_real)(12 + 0.5 * (double)x[3 * i + 1]);
        v[3 * i + 2] = -7;
    }
    def.particles.velocity = v;
    return make(&def);
}

static void both_rows_of_a_spring_have_the_same_rest_length(void **unused)
{
    (void)unused;
    rheo_world *world = sheared_world();
    for (int s = 0; s < 80; s++) {
        step(world, 1);
        const rheo__springs *springs = &world->state.springs;
        const rheo__pairs *p = &springs->pairs;
        size_t ends = 0;
        for (uint32_t i = 0; i < p->rows; i++)
            for (size_t k = rheo__pairs_first(p, i); k < rheo__pairs_end(p, i); k += p->width) {
                if (!(springs->rest_length[k] >= 0))
                    continue;
                const uint32_t j = rheo__pairs_partner(p, k);
                size_t other = rheo__pairs_first(p, j);
                while (rheo__pairs_partner(p, other) != i)
                    other += p->width;
                assert_true(springs->rest_length[other] == springs->rest_length[k]);
                ends++;
            }
        assert_int_equal(ends, 2 * springs->count);
        assert_true(p->images > 0);
    }
    rheo_world_destroy(world);
}

/* A crystal moves three periods along; its springs stay as they are. */
static void springs_survive_lists_and_journeys(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST], v[3 * MOST];
    rheo_world_def def = noisy_def(x, true);
    def.fluid.support = 3.9;
    for (uint32_t i = 0; i < 3 * def.particles.count; i++) {
        x[i] = (rheo_real)(2 * floor((double)x[i] / 2) + 1);
        v[i] = i % 3 == 0 ? 10 : i % 3 == 2 ? -5 : 0;
    }
    def.particles.velocity = v;
    def.springs.yield_ratio = 0.02;
    rheo_world *world = make(&def);
    step(world, 2);
    const uint64_t ends = rheo__state_hash_field(&world->state, RHEO__FIELD_spring_ends);
    uint64_t lists = 0, wraps = 0;
    for (int s = 0; s < 180; s++) {
        const rheo_real before = rheo_world_positions(world)[0];
        const uint64_t exchanged = world->state.springs_exchanged;
        step(world, 1);
        lists += world->state.springs_exchanged != exchanged;
        wraps += rheo_world_positions(world)[0] < before;
        assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_spring_ends) == ends);
        for (uint32_t i = 0; i < 3 * def.particles.count; i++)
            assert_true(fabs((double)rheo_world_positions(world)[i]) < 16); /* 3/4 of a period and a margin */
    }
    assert_true(lists >= 6 && wraps >= 2);
    rheo_world_destroy(world);
}

/* ---- Determinism ---- */

static void a_world_can_be_loaded_at_every_step(void **unused)
{
    (void)unused;
    rheo_world *world = sheared_world();
    for (int s = 0; s < 40; s++) {
        void *bytes;
        size_t size;
        OK(rheo_world_save_memory(world, "sheared", &bytes, &size, &error));
        rheo_recording *recording;
        rheo_world *loaded;
        OK(rheo_recording_open_memory(bytes, size, &recording, &error));
        OK(rheo_recording_world(recording, rheo_world_step_count(world), NULL, &loaded, &error));
        rheo_recording_close(recording);
        free(bytes);
        step(world, 1);
        for (int k = 0; k < 2; k++) {
            step(loaded, 1);
            if (k == 0)
                assert_true(rheo_world_hash(loaded) == rheo_world_hash(world));
        }
        rheo_world_destroy(loaded);
    }
    rheo_world_destroy(world);
}

static void all_simd_variants_give_the_same_bits(void **unused)
{
    (void)unused;
    const char *name, *before = rheo_simd();
    uint64_t expected[30] = {0};
    for (uint32_t variant = 0; (name = rheo_simd_available(variant)); variant++) {
        OK(rheo_use_simd(name, &error));
        rheo_world *world = sheared_world();
        for (int s = 0; s < 30; s++) {
            step(world, 1);
            if (variant == 0)
                expected[s] = rheo_world_hash(world);
            assert_true(rheo_world_hash(world) == expected[s]);
        }
        rheo_world_destroy(world);
    }
    OK(rheo_use_simd(before, &error));
}

/* Who moves too far for the list fails, and is not lost. */
static void a_particle_that_leaves_within_a_step_fails_it(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    def.space.period[0] = 16;
    def.particles.count = 2;
    const rheo_real x[6] = {0, 0, 0, 1, 1, 1}, v[6] = {3000, 0, 0, 0, 0, 0};
    def.particles.position = x;
    def.particles.velocity = v;
    rheo_world *world = make(&def);
    REFUSED(RHEO_ERROR_STATE, "A smaller step may help", rheo_world_step(world, &error));
    assert_int_equal(rheo_world_step_count(world), 0);
    rheo_world_destroy(world);
}

/* ---- What is refused ---- */

static void what_has_no_period_is_refused(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    const rheo_wall floor = {{0, -20, 0}, {0, 1, 0}}, side = {{0, -20, 0}, {0.1, 1, 0}};
    rheo_world_def def = noisy_def(x, false);
    def.walls.plane = &floor;
    def.walls.count = 1;
    OK(rheo_world_def_check(&def, &error));
    def.walls.plane = &side;
    REFUSED(RHEO_ERROR_ARGUMENT, "wall 0 crosses the axis x", rheo_world_def_check(&def, &error));
    def.walls.count = 0;
    def.ball.radius = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "which a ball does not support", rheo_world_def_check(&def, &error));
    def.ball.radius = 0;
    const double vibrator[1][2] = {{0, 0}};
    def.vibrators.count = 1;
    def.vibrators.position = vibrator;
    def.vibrators.kind = RHEO_VIBRATOR_FORCE;
    REFUSED(RHEO_ERROR_ARGUMENT, "which vibrators does not support", rheo_world_def_check(&def, &error));
    def.vibrators.count = 0;
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    REFUSED(RHEO_ERROR_ARGUMENT, "which scheme sequential does not support", rheo_world_def_check(&def, &error));
    def.scheme = RHEO_SCHEME_SUMMED;
    def.space.period[2] = 9.99;
    REFUSED(RHEO_ERROR_ARGUMENT, "it must be 0 (open) or at least 10", rheo_world_def_check(&def, &error));
    def.space.period[2] = 10;
    rheo_world *world = make(&def);
    REFUSED(RHEO_ERROR_ARGUMENT, "2.5 times fluid.support", rheo_world_set(world, "fluid.support", "4.01", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "space.period", rheo_world_set(world, "space.period", "[20, 0, 20]", &error));
    OK(rheo_world_set(world, "fluid.support", "3.9", &error));
    step(world, 2);
    rheo_world_destroy(world);
    rheo_world_def melting = rheo_default_model_def(RHEO_MODEL_MELTING);
    REFUSED(RHEO_ERROR_ARGUMENT, "space.period is a parameter of the model thickening",
            rheo_world_def_set(&melting, "space.period", "[20, 0, 20]", &error));
}

/* A list with particles outside of the period, or with wide margins, would have more images than there is room for. */
static void a_damaged_list_of_periodic_space_is_refused(void **unused)
{
    (void)unused;
    static rheo_real position[3 * MOST];
    const rheo_world_def def = noisy_def(position, false);
    rheo_world *world = make(&def);
    OK(rheo__world_check_state(world, true, &error));
    step(world, 3);
    OK(rheo__world_check_state(world, true, &error));
    rheo__state *s = &world->state;
    const rheo_real x = s->list_position[3 * 17 + 2], margin = s->list_margin[5];
    s->list_position[3 * 17 + 2] = (rheo_real)1e15;
    REFUSED(RHEO_ERROR_FORMAT, "has particle 17 outside of the period", rheo__world_check_state(world, true, &error));
    s->list_position[3 * 17 + 2] = x;
    s->list_position[3 * 17 + 1] = 1000; /* space is open along y */
    OK(rheo__world_check_state(world, true, &error));
    s->list_margin[5] = (rheo_real)(0.13 * def.fluid.support);
    REFUSED(RHEO_ERROR_FORMAT, "margin of particle 5", rheo__world_check_state(world, true, &error));
    s->list_margin[5] = margin;
    OK(rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_damaged_list_of_periodic_space_is_refused),
        cmocka_unit_test(a_shift_by_whole_cells_gives_the_same_bits),
        cmocka_unit_test(any_shift_gives_the_same_forces),
        cmocka_unit_test(momentum_is_conserved_to_rounding),
        cmocka_unit_test(a_crystal_has_no_force_anywhere),
        cmocka_unit_test(a_pair_across_the_border_is_like_one_inside),
        cmocka_unit_test(a_coinciding_pair_across_the_border_is_parted),
        cmocka_unit_test(lists_have_the_nearest_images_within_reach),
        cmocka_unit_test(queries_find_neighbours_across_borders),
        cmocka_unit_test(both_rows_of_a_spring_have_the_same_rest_length),
        cmocka_unit_test(springs_survive_lists_and_journeys),
        cmocka_unit_test(a_world_can_be_loaded_at_every_step),
        cmocka_unit_test(all_simd_variants_give_the_same_bits),
        cmocka_unit_test(a_particle_that_leaves_within_a_step_fails_it),
        cmocka_unit_test(what_has_no_period_is_refused),
    };
    return cmocka_run_group_tests_name("periodic", tests, NULL, NULL);
}
