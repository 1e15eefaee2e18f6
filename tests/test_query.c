/* Queries of a state: particles, neighbours, densities, rankings. */
#include "melting.h"

#include <math.h>

#include "melting/rheology.h"
#include "world/model_melting.h"
#include "world/model_thickening.h"

enum { SCATTERED = 300 };

/* Particles scattered over a cube of edge 8, most of them within the support of others. */
static rheo_world *scattered_world(void)
{
    rheo_real position[3 * SCATTERED], velocity[3 * SCATTERED];
    uint32_t random = 1;
    for (int i = 0; i < 3 * SCATTERED; i++) {
        random = random * UINT32_C(1664525) + UINT32_C(1013904223);
        position[i] = (rheo_real)(random >> 8) * (rheo_real)(8.0 / (1 << 24)) - 4;
        random = random * UINT32_C(1664525) + UINT32_C(1013904223);
        velocity[i] = (rheo_real)(random >> 8) * (rheo_real)(2.0 / (1 << 24)) - 1;
    }
    rheo_world_def def = inert_def();
    def.fluid.stiffness = def.fluid.near_stiffness = 1e-12;
    def.substeps = 1;
    return world_of(def, SCATTERED, position, velocity);
}

static double distance_of(const rheo_world *world, uint32_t a, uint32_t b)
{
    const rheo_real *x = rheo_world_positions(world);
    double r2 = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        double d = (double)x[3 * a + axis] - (double)x[3 * b + axis];
        r2 += d * d;
    }
    return sqrt(r2);
}

static rheo_particle_state look_at(const rheo_world *world, uint32_t id)
{
    rheo_particle_state state;
    memset(&state, 0xAA, sizeof state);
    OK(rheo_world_particle(world, id, &state, &error));
    return state;
}

/* Runs the next step up to this stage, inclusive. */
static void step_until(rheo_world *world, const char *name)
{
    rheo_stage_info info = {0};
    for (uint32_t stage; !info.name || strcmp(info.name, name) != 0;) {
        OK(rheo_world_step_stage(world, &stage, &error));
        OK(rheo_world_stage(world, stage, &info));
    }
}

/* ---- Neighbours and densities ---- */

static void densities_are_sums_over_all_pairs(void **unused)
{
    (void)unused;
    rheo_world *world = scattered_world();
    double density[SCATTERED], near_density[SCATTERED], alone[SCATTERED], near_alone[SCATTERED], most = 0;
    OK(rheo_world_densities(world, density, near_density, &error));
    OK(rheo_world_densities(world, alone, NULL, &error));
    OK(rheo_world_densities(world, NULL, near_alone, &error));
    OK(rheo_world_densities(world, NULL, NULL, &error));
    for (uint32_t i = 0; i < SCATTERED; i++) {
        double sum2 = 0, sum3 = 0;
        uint32_t neighbours = 0;
        for (uint32_t j = 0; j < SCATTERED; j++) {
            double w = 1 - distance_of(world, i, j) / 2;
            if (j == i || w <= 0)
                continue;
            sum2 += w * w;
            sum3 += w * w * w;
            neighbours++;
        }
        NEAR(density[i], sum2, 1e-13);
        NEAR(near_density[i], sum3, 1e-13);
        assert_true(alone[i] == density[i] && near_alone[i] == near_density[i]);
        rheo_particle_state state = look_at(world, i);
        assert_true(state.density == density[i] && state.near_density == near_density[i]); /* equal to the bit */
        assert_int_equal(state.neighbours, neighbours);
        most = fmax(most, sum2);
    }
    assert_true(most > 1);
    rheo_world_destroy(world);
}

static void neighbours_are_those_within_the_support(void **unused)
{
    (void)unused;
    rheo_world *world = scattered_world();
    size_t pairs = 0;
    for (uint32_t id = 0; id < SCATTERED; id++) {
        uint32_t ids[SCATTERED];
        double distances[SCATTERED];
        size_t count, again;
        OK(rheo_world_neighbours(world, id, NULL, NULL, 0, &count, &error));
        OK(rheo_world_neighbours(world, id, ids, distances, SCATTERED, &again, &error));
        assert_int_equal(count, again);
        size_t found = 0;
        for (uint32_t other = 0; other < SCATTERED; other++)
            if (other != id && distance_of(world, id, other) < 2) {
                assert_true(found < count);
                assert_int_equal(ids[found], other);
                NEAR(distances[found], distance_of(world, id, other), 1e-15);
                found++;
            }
        assert_int_equal(found, count);
        pairs += found;

        /* Writes as many as there is room for. */
        uint32_t few[2] = {UINT32_MAX, UINT32_MAX};
        double one[2] = {-1, -1};
        OK(rheo_world_neighbours(world, id, few, one, 1, &again, &error));
        assert_int_equal(count, again);
        assert_true(few[1] == UINT32_MAX && one[1] == -1);
        if (count)
            assert_true(few[0] == ids[0] && one[0] == distances[0]);
    }
    assert_true(pairs > 5 * SCATTERED);
    rheo_world_destroy(world);
}

/* Queries show the pairs that the stages use, even though particles move within the step. */
static void neighbours_are_those_of_the_step(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    step_until(world, "neighbours");
    const rheo__pairs *pairs = rheo__thickening_of(world)->pairs;
    uint32_t n = rheo_world_particle_count(world);
    size_t total = 0;
    for (uint32_t id = 0; id < n; id++) {
        const uint32_t rank = pairs->rank_of[id];
        uint32_t ids[512];
        size_t count;
        OK(rheo_world_neighbours(world, id, ids, NULL, 512, &count, &error));
        assert_true(count <= 512);
        size_t within = 0; /* the list has pairs within support and margins */
        for (size_t k = rheo__pairs_first(pairs, rank); k < rheo__pairs_end(pairs, rank); k += pairs->width) {
            const uint32_t partner = rheo__pairs_partner(pairs, k);
            if (partner == rheo__pairs_idle(pairs) ||
                !(distance_of(world, id, pairs->id_of[partner]) < rheo_world_definition(world)->fluid.support))
                continue;
            size_t at = 0;
            while (at < count && ids[at] != pairs->id_of[partner])
                at++;
            assert_true(at < count);
            within++;
        }
        assert_int_equal(count, within);
        total += count;
    }
    assert_true(total > n && total <= rheo__pairs_entries(pairs));
    rheo_world_destroy(world);
}

/* ---- A particle as the stages use it ---- */

static void a_pair_by_hand(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.fluid.stiffness = 3;
    def.fluid.near_stiffness = 8;
    def.fluid.rest_density = 1;
    const rheo_real position[] = {1, 2, 3, 1, 3, 3, 1, 2, 5}, velocity[] = {2, 3, 6, 0, 0, 0, 0, 0, 0};
    rheo_world *world = world_of(def, 3, position, velocity); /* the third is exactly at the edge of the support */
    rheo_particle_state state = look_at(world, 0);
    assert_true(state.position[1] == 2 && state.position[2] == 3 && state.velocity[0] == 2);
    assert_true(state.speed == 7);
    assert_true(state.density == 0.25 && state.near_density == 0.125);
    assert_true(state.pressure == -2.25 && state.near_pressure == 1);
    assert_int_equal(state.neighbours, 1);
    assert_int_equal(state.springs, 0);
    assert_true(state.derivative[0] == 0 && state.derivative[1] == 0 && state.derivative[2] == 0);
    state = look_at(world, 2);
    assert_true(state.neighbours == 0 && state.density == 0 && state.pressure == -3);
    rheo_world_destroy(world);
}

/* If pressure is too small to move anything, the stage computes the densities that the query showed. */
static void the_stage_computes_the_same_densities(void **unused)
{
    (void)unused;
    rheo_world *world = scattered_world();
    rheo_top_entry densest = {0};
    size_t count;
    step_until(world, "prediction");
    OK(rheo_world_top(world, RHEO_TOP_DENSEST, 1, &densest, &count, &error));
    OK(rheo_world_step(world, &error));
    assert_int_equal(densest.id, (int)metric(world, "max_density_id"));
    NEAR(densest.value / rheo_world_definition(world)->fluid.rest_density, metric(world, "max_density"), 1e-5);
    rheo_world_destroy(world);
}

static void the_derivative_is_that_of_the_stage(void **unused)
{
    (void)unused;
    for (int steps = 1; steps <= 16; steps += 5) /* a window of 10, partly and completely filled */
        for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_TEMPERED; kind++) {
            rheo_scene scene = lively_scene();
            rheo_world *world;
            scene.world.history.kind = (rheo_history_kind)kind;
            OK(rheo_scene_create_world(&scene, &world, &error));
            /* Compares with sums over the stored rows, for history kinds that store them. */
            const double tolerance = kind == RHEO_HISTORY_WINDOW ? 1e-6 : 5e-4;
            step(world, steps);
            uint32_t n = rheo_world_particle_count(world), rows = rheo_world_history_rows(world);
            rheo_particle_state *before = malloc(n * sizeof *before);
            assert_non_null(before);
            for (uint32_t id = 0; id < n; id++)
                before[id] = look_at(world, id);
            step_until(world, "fractional_derivative");
            double most = 0, weights[11];
            rheo_history_weights(0.5, 11, weights);
            if (rows < 11)
                weights[rows - 1] = rheo_history_first_weight(0.5, rows - 1);
            const double scale = rheo_history_scale(0.5, rheo_world_definition(world)->step, RHEO_WEIGHTS_PAPER);
            for (uint32_t id = 0; id < n; id++) {
                rheo_particle_state now = look_at(world, id);
                rheo_real own[3 * 11];
                OK(rheo_world_particle_history(world, id, own));
                for (uint32_t axis = 0; axis < 3; axis++) {
                    double sum = 0, sizes = 0;
                    for (uint32_t lag = 0; lag < rows; lag++) {
                        sum += weights[lag] * (double)own[3 * lag + axis];
                        sizes += fabs(weights[lag] * (double)own[3 * lag + axis]);
                    }
                    assert_true(now.derivative[axis] == (double)world->state.derivative[3 * (size_t)id + axis]);
                    assert_true(now.derivative[axis] == before[id].derivative[axis]);
                    if (kind <= RHEO_HISTORY_WINDOW_FAST)
                        NEAR(now.derivative[axis], scale * sum, tolerance * scale * sizes + (kind ? 1e-6 : 1e-12));
                    most = fmax(most, fabs(now.derivative[axis]));
                }
            }
            assert_true(most > 0.01);
            free(before);
            rheo_world_destroy(world);
        }
}

static void springs_of_a_particle_are_counted(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    for (int i = 0; i < 2; i++) { /* as loaded, and in the order of a step */
        uint32_t n = rheo_world_particle_count(world), *of = calloc(n, sizeof *of);
        size_t count = rheo_world_spring_count(world);
        rheo_spring *spring = malloc((count + 1) * sizeof *spring);
        assert_true(of && spring && count > n);
        OK(rheo_world_springs(world, spring, count));
        for (size_t k = 0; k < count; k++) {
            of[spring[k].a]++;
            of[spring[k].b]++;
        }
        for (uint32_t id = 0; id < n; id++)
            assert_int_equal(look_at(world, id).springs, of[id]);
        free(of);
        free(spring);
        step(world, 2);
    }
    /* A new particle has neighbours at once, but springs only after a step. */
    uint32_t n = rheo_world_particle_count(world);
    rheo_real position[3];
    memcpy(position, rheo_world_positions(world), sizeof position);
    position[1] += 1;
    OK(rheo_world_add_particles(world, 1, position, NULL, &error));
    rheo_particle_state state = look_at(world, n);
    assert_int_equal(state.springs, 0);
    assert_true(state.neighbours > 0 && state.derivative[0] == 0);
    size_t count;
    rheo_top_entry top[3];
    OK(rheo_world_top(world, RHEO_TOP_STIFFEST, 3, top, &count, &error));
    assert_int_equal(count, 3);
    step(world, 1);
    assert_true(look_at(world, n).springs > 0);
    rheo_world_destroy(world);
}

/* ---- Rankings ---- */

static void check_order(const rheo_top_entry *entry, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        assert_true(entry[i - 1].value >= entry[i].value);
        if (entry[i - 1].value == entry[i].value)
            assert_true(entry[i - 1].id < entry[i].id ||
                        (entry[i - 1].id == entry[i].id && entry[i - 1].other_id < entry[i].other_id));
    }
}

/* A ranking of any length is the beginning of the full one, which has every item once. */
static void short_rankings_begin_the_full_one(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 4);
    uint32_t n = rheo_world_particle_count(world);
    size_t springs = rheo_world_spring_count(world), room = n + springs;
    rheo_top_entry *all = malloc(room * sizeof *all), *some = malloc(room * sizeof *some);
    double *density = malloc(n * sizeof *density);
    assert_true(all && some && density);
    OK(rheo_world_densities(world, density, NULL, &error));
    for (rheo_top what = RHEO_TOP_FASTEST; what <= RHEO_TOP_STIFFEST; what++) {
        size_t count, expected = what == RHEO_TOP_STIFFEST ? springs : n;
        OK(rheo_world_top(world, what, room, all, &count, &error));
        assert_int_equal(count, expected);
        check_order(all, count);
        for (size_t i = 0; i < count; i++) {
            rheo_spring_state spring;
            if (what == RHEO_TOP_STIFFEST) {
                OK(rheo_world_spring(world, all[i].id, all[i].other_id, &spring, &error));
                assert_true(all[i].id == spring.spring.a && all[i].value == spring.kappa); /* equal to the bit */
                const double step2 = pow(rheo_world_definition(world)->step / (double)*world->state.substeps, 2);
                NEAR(spring.kappa, step2 * spring.stiffness, 1e-6 * spring.kappa);
                NEAR(spring.length, distance_of(world, all[i].id, all[i].other_id), 1e-6 * spring.length);
                assert_true(look_at(world, i % 2 ? all[i].id : all[i].other_id).kappa >=
                            all[i].value); /* of its springs */
            } else {
                assert_int_equal(all[i].other_id, 0);
                assert_true(all[i].value ==
                            (what == RHEO_TOP_FASTEST ? look_at(world, all[i].id).speed : density[all[i].id]));
            }
            for (size_t j = 0; what != RHEO_TOP_STIFFEST && j < i; j++)
                assert_true(all[j].id != all[i].id);
        }
        for (size_t capacity = 0; capacity <= expected; capacity += capacity < 40 ? 1 : expected / 7) {
            memset(some, 0xAA, room * sizeof *some);
            OK(rheo_world_top(world, what, capacity, capacity ? some : NULL, &count, &error));
            assert_int_equal(count, capacity);
            for (size_t i = 0; i < count; i++)
                assert_true(some[i].id == all[i].id && some[i].other_id == all[i].other_id &&
                            some[i].value == all[i].value);
            assert_true(some[count].id == UINT32_C(0xAAAAAAAA));
        }
    }
    rheo_top_entry fastest;
    size_t count;
    OK(rheo_world_top(world, RHEO_TOP_FASTEST, 1, &fastest, &count, &error));
    assert_int_equal(fastest.id, (int)metric(world, "max_speed_id"));
    NEAR(fastest.value, metric(world, "max_speed"), 1e-12);
    free(all);
    free(some);
    free(density);
    rheo_world_destroy(world);
}

/* The stiffest spring ahead of the step is the one that the step reports. */
static void the_step_reports_the_same_stiffest_spring(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 5);
    step_until(world, "substeps");
    rheo_top_entry top[2];
    size_t count;
    OK(rheo_world_top(world, RHEO_TOP_STIFFEST, 2, top, &count, &error));
    OK(rheo_world_step(world, &error));
    assert_true(top[0].value > top[1].value);
    assert_true(top[0].value == metric(world, "stiffness_number")); /* equal to the bit */
    assert_int_equal(top[0].id, (int)metric(world, "stiffness_a"));
    assert_int_equal(top[0].other_id, (int)metric(world, "stiffness_b"));
    rheo_world_destroy(world);
}

static void ties_are_ordered_by_id_and_nan_is_first(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 15;
    def.fluid.support = 2.5;
    rheo_real position[3 * 9], velocity[3 * 9] = {0};
    for (int i = 0; i < 9; i++) {
        position[3 * i] = (rheo_real)i;
        position[3 * i + 1] = position[3 * i + 2] = 0;
        velocity[3 * i + 2] = (rheo_real)(i % 3 == 1 ? -2 : 1);
    }
    rheo_world *world = world_of(def, 9, position, velocity);
    rheo_top_entry top[9];
    size_t count;
    OK(rheo_world_top(world, RHEO_TOP_FASTEST, 9, top, &count, &error));
    const uint32_t expected[] = {1, 4, 7, 0, 2, 3, 5, 6, 8};
    for (int i = 0; i < 9; i++)
        assert_int_equal(top[i].id, expected[i]);
    OK(rheo_world_top(world, RHEO_TOP_DENSEST, 2, top, &count, &error));
    assert_true(top[0].id == 2 && top[1].id == 3); /* the first with two neighbours on each side */
    NEAR(top[0].value, 2 * (0.6 * 0.6 + 0.2 * 0.2), 1e-15);
    step(world, 1);
    OK(rheo_world_top(world, RHEO_TOP_STIFFEST, 9, top, &count, &error));
    assert_int_equal(count, 9);
    for (uint32_t i = 0; i < 9; i++) /* all are equal without history: 0:1, 0:2, 1:2, 1:3, ... */
        assert_true(top[i].id == i / 2 && top[i].other_id == i / 2 + 1 + i % 2 && top[i].value == top[0].value);
    NEAR(top[0].value, 0.033 * 0.033 * 15 / 4, 1e-8); /* two substeps */

    world->state.velocity[3 * 5] = (rheo_real)NAN;
    OK(rheo_world_top(world, RHEO_TOP_FASTEST, 2, top, &count, &error));
    assert_true(top[0].id == 5 && isnan(top[0].value) && top[1].id == 1);
    rheo_world_destroy(world);
}

/* ---- Limits of arguments ---- */

static void ids_out_of_range_are_refused(void **unused)
{
    (void)unused;
    rheo_world *world = scattered_world();
    rheo_particle_state state;
    size_t count = 77;
    REFUSED(RHEO_ERROR_ARGUMENT, "no particle 300; ids go from 0 to 299",
            rheo_world_particle(world, SCATTERED, &state, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no particle 4294967295",
            rheo_world_neighbours(world, UINT32_MAX, NULL, NULL, 0, &count, &error));
    assert_int_equal(count, 77);
    REFUSED(RHEO_ERROR_ARGUMENT, "no list 5",
            rheo_world_top(world, (rheo_top)(RHEO_TOP_FURTHEST + 1), 0, NULL, &count, &error));
    assert_int_equal(rheo_world_particle(world, SCATTERED, &state, NULL), RHEO_ERROR_ARGUMENT);
    OK(rheo_world_particle(world, SCATTERED - 1, &state, &error));
    rheo_world_destroy(world);
}

static void an_empty_world_can_be_queried(void **unused)
{
    (void)unused;
    rheo_world *world = world_of(rheo_default_world_def(), 0, NULL, NULL);
    for (int i = 0; i < 2; i++) {
        rheo_particle_state state;
        size_t count = 77;
        REFUSED(RHEO_ERROR_ARGUMENT, "the world has none", rheo_world_particle(world, 0, &state, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "the world has none",
                rheo_world_neighbours(world, 0, NULL, NULL, 0, &count, &error));
        double unwritten = 5;
        OK(rheo_world_densities(world, &unwritten, &unwritten, &error));
        assert_true(unwritten == 5);
        for (rheo_top what = RHEO_TOP_FASTEST; what <= RHEO_TOP_STIFFEST; what++) {
            rheo_top_entry entry = {9, 9, 9};
            count = 77;
            OK(rheo_world_top(world, what, 1, &entry, &count, &error));
            assert_true(count == 0 && entry.id == 9);
        }
        step(world, 1);
    }
    rheo_world_destroy(world);
}

static void coinciding_particles_have_full_weight(void **unused)
{
    (void)unused;
    rheo_real position[3 * 20] = {0};
    rheo_world *world = world_of(rheo_default_world_def(), 20, position, NULL);
    for (uint32_t id = 0; id < 20; id++) {
        rheo_particle_state state = look_at(world, id);
        assert_true(state.density == 19 && state.near_density == 19 && state.neighbours == 19);
        uint32_t ids[20];
        double distances[20];
        size_t count;
        OK(rheo_world_neighbours(world, id, ids, distances, 20, &count, &error));
        assert_int_equal(count, 19);
        for (uint32_t i = 0; i < 19; i++)
            assert_true(ids[i] == i + (i >= id) && distances[i] == 0);
    }
    rheo_world_destroy(world);
}

typedef struct memory {
    int allowed, held;
} memory;
static void *allocate(size_t bytes, void *user)
{
    memory *m = user;
    if (m->allowed-- <= 0)
        return NULL;
    m->held++;
    return malloc(bytes);
}
static void release(void *block, void *user)
{
    ((memory *)user)->held--;
    free(block);
}

/* Whichever allocation fails, the call returns an error, releases everything and leaves its results unchanged. */
static void running_out_of_memory_is_an_error(void **unused)
{
    (void)unused;
    memory m = {1 << 30, 0};
    rheo_scene scene = lively_scene();
    scene.world.allocator = (rheo_allocator){allocate, release, &m};
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    step(world, 3);
    uint32_t n = rheo_world_particle_count(world);
    const uint64_t hash = rheo_world_hash(world);
    const int held = m.held;
    double *density = calloc(n, sizeof *density), *untouched = calloc(n, sizeof *untouched);
    rheo_particle_state *states = calloc(n, sizeof *states);
    assert_true(density && untouched && states);
    for (int call = 0; call < 4; call++) {
        const rheo_top what = call == 1 ? RHEO_TOP_DENSEST : RHEO_TOP_STIFFEST;
        int refused = 0;
        for (;; refused++) {
            rheo_error reason = {""};
            rheo_top_entry entry[4];
            size_t count = 77;
            m.allowed = refused;
            rheo_result result = call == 0   ? rheo_world_densities(world, density, NULL, &reason)
                                 : call == 3 ? rheo_world_particles(world, states, &reason)
                                             : rheo_world_top(world, what, 4, entry, &count, &reason);
            assert_int_equal(m.held, held);
            m.allowed = 1 << 30;
            assert_true(rheo_world_hash(world) == hash);
            if (result == RHEO_OK)
                break;
            assert_int_equal(result, RHEO_ERROR_MEMORY);
            assert_non_null(strstr(reason.message, "no memory"));
            assert_memory_equal(density, untouched, call == 0 ? n * sizeof *density : 0);
            assert_int_equal(count, call % 3 == 0 ? 77 : 0);
        }
        assert_true(call == 2 ? refused == 1 : refused > 10);
    }
    free(density), free(untouched), free(states);
    rheo_world_destroy(world);
    assert_int_equal(m.held, 0);
}

/* ---- Queries change nothing ---- */

static void look_at_everything(const rheo_world *world)
{
    const uint64_t hash = rheo_world_hash(world);
    static struct rheo_world as_it_was;
    static rheo__thickening stages;
    static rheo__melting melting;
    memcpy(&as_it_was, world, sizeof as_it_was); /* including padding */
    if (rheo__thickening_of(world))
        memcpy(&stages, rheo__thickening_of(world), sizeof stages);
    else
        memcpy(&melting, rheo__melting_of(world), sizeof melting);
    const uint32_t n = rheo_world_particle_count(world);
    double *density = malloc(2 * n * sizeof *density);
    rheo_particle_state *states = malloc(n * sizeof *states);
    rheo_top_entry top[10];
    assert_true(density && states);
    OK(rheo_world_particles(world, states, &error));
    for (uint32_t id = 0; id < n; id += 1 + n / 50) { /* all at once are the same as one by one */
        const rheo_particle_state one = look_at(world, id);
        assert_memory_equal(&one, &states[id], sizeof one);
    }
    free(states);
    size_t count;
    OK(rheo_world_neighbours(world, n / 2, NULL, density, n, &count, &error));
    OK(rheo_world_densities(world, density, density + n, &error));
    for (rheo_top what = RHEO_TOP_FASTEST; what <= RHEO_TOP_FURTHEST; what++)
        OK(rheo_world_top(world, what, 10, top, &count, &error));
    free(density);
    assert_true(rheo_world_hash(world) == hash);
    assert_memory_equal(world, &as_it_was, sizeof as_it_was);
    if (rheo__thickening_of(world))
        assert_memory_equal(rheo__thickening_of(world), &stages, sizeof stages);
    else
        assert_memory_equal(rheo__melting_of(world), &melting, sizeof melting);
}

/* Queries between steps and after every stage change neither this state nor later ones. */
static void check_queries(rheo_world *seen, rheo_world *alone)
{
    for (int i = 0; i < 12; i++) {
        look_at_everything(seen);
        if (i % 3 == 2) {
            uint32_t stage;
            do {
                OK(rheo_world_step_stage(seen, &stage, &error));
                look_at_everything(seen);
            } while (rheo_world_stages_done(seen));
        } else {
            step(seen, 1);
        }
        step(alone, 1);
        assert_true(rheo_world_hash(seen) == rheo_world_hash(alone));
    }
    rheo_world_destroy(seen);
    rheo_world_destroy(alone);
}

static void queries_change_nothing(void **unused)
{
    (void)unused;
    check_queries(lively_world(), lively_world());
    check_queries(melting_world(5, NULL), melting_world(5, NULL));
}

/* ---- Melting worlds ---- */

static double quintic(double q)
{
    return pow(fmax(3 - q, 0), 5) - 6 * pow(fmax(2 - q, 0), 5) + 15 * pow(fmax(1 - q, 0), 5);
}

static void weights_are_those_of_the_kernel(void **unused)
{
    (void)unused;
    rheo_world *world = melting_world(2, NULL);
    const double h = 0.1, scale = 1 / (120 * 3.14159265358979 * h * h * h);
    double integral = 0;
    for (int i = 0; i < 3000; i++) {
        const double r = (i + 0.5) * 1e-4;
        NEAR(rheo_world_weight(world, r), scale * quintic(r / h), 1e-6 * scale);
        integral += 4 * 3.14159265358979 * r * r * 1e-4 * rheo_world_weight(world, r);
    }
    NEAR(integral, 1, 1e-5);
    assert_true(rheo_world_weight(world, 0.3001) == 0 && rheo_world_weight(world, 7) == 0);
    rheo_world_destroy(world);
    world = scattered_world(); /* a support of 2 */
    NEAR(rheo_world_weight(world, 0.5), 0.75, 1e-15);
    assert_true(rheo_world_weight(world, 0) == 1 && rheo_world_weight(world, 2.5) == 0);
    rheo_world_destroy(world);
}

/* The sum over all pairs equals that of the neighbour list and of the stage, bit for bit. */
static void summation_densities_are_those_of_the_stage(void **unused)
{
    (void)unused;
    static const char *const SUMMATION[] = {"melting.density", "summation", NULL};
    rheo_world *world = melting_world(6, SUMMATION);
    double density[216], near_density[216];
    step(world, 2);
    step_until(world, "neighbours");
    OK(rheo_world_densities(world, density, near_density, &error));
    double walls = 0;
    for (uint32_t i = 0; i < 216; i++) {
        const rheo_particle_state state = look_at(world, i);
        double sum = rheo_world_weight(world, 0);
        for (uint32_t j = 0; j < 216; j++)
            sum += j == i ? 0 : rheo_world_weight(world, distance_of(world, i, j));
        assert_true(density[i] >= 1e-3 * sum * (1 - 1e-6) && near_density[i] == 0); /* masses of 0.1^3 */
        walls = fmax(walls, density[i] - 1e-3 * sum);
        assert_true(state.summed_density == density[i]); /* equal to the bit */
        assert_true(state.near_density == 0 && state.springs == 0 && state.near_pressure == 0);
    }
    assert_true(walls > 0.1);
    step_until(world, "summation");
    for (uint32_t i = 0; i < 216; i++) {
        const rheo_particle_state state = look_at(world, i);
        NEAR(state.density, density[i], 2e-6);
        NEAR(state.pressure, 25 * (state.density - 1), 1e-12);
    }
    rheo_world_destroy(world);
}

/* Shear rates and viscosities of the first substep are those of the query ahead of it. */
static void shear_rates_are_those_of_the_stage(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < 3; kind++) { /* no-slip walls; free-slip walls; and a ceiling with little pressure */
        rheo_real values[7 * 216];
        rheo_world_def def = melting_def(6, values);
        rheo_world *world;
        def.melting.wall = kind == 1 ? RHEO_WALL_FREE_SLIP : RHEO_WALL_NO_SLIP;
        if (kind == 2)
            walls_of(&def)[def.walls.count++] = (rheo_wall){{0, 0.6, 0}, {0, -1, 0}};
        OK(rheo_world_create(&def, &world, &error));
        static rheo_particle_state before[216];
        uint32_t neighbours = 0;
        step(world, 2);
        step_until(world, "neighbours");
        for (uint32_t i = 0; i < 216; i++) {
            before[i] = look_at(world, i);
            neighbours += before[i].neighbours;
        }
        step_until(world, "viscosity");
        NEAR(rheo__melting_of(world)->diagnostics.mean_neighbours, neighbours / 216.0, 1e-12);
        const rheo__melting *m = rheo__melting_of(world);
        double most = 0;
        uint32_t detached = 0;
        for (uint32_t k = 0; k < m->contacts; k++)
            detached += m->contact[k].detached;
        assert_true(kind == 2 ? detached > 10 : detached == 0);
        for (uint32_t i = 0; i < 216; i++) {
            const uint32_t rank = m->pairs.rank_of[i];
            NEAR(before[i].shear_rate, (double)m->shear_rate[rank], 1e-5 + 1e-5 * before[i].shear_rate);
            NEAR(before[i].viscosity, (double)m->viscosity[rank], 1e-3 * before[i].viscosity);
            most = fmax(most, before[i].shear_rate);
        }
        assert_true(most > 0.1);
        rheo_world_destroy(world);
    }
}

static void a_melting_particle_by_hand(void **unused)
{
    (void)unused;
    rheo_world *world = melting_world(5, NULL);
    const rheo_real *x = rheo_world_positions(world);
    double began[3] = {(double)x[3 * 12], (double)x[3 * 12 + 1], (double)x[3 * 12 + 2]};
    rheo_particle_state state = look_at(world, 12);
    NEAR(state.displacement, 0, 0);
    NEAR(state.temperature, 0.45, 1e-6); /* row 2 of 5 */
    NEAR(state.jump_number, world->def.melting.jump_number_max, 1);
    NEAR(state.density, 1, 0);
    NEAR(state.pressure, 0, 0);
    step(world, 5);
    state = look_at(world, 12);
    double moved = 0;
    for (int axis = 0; axis < 3; axis++) {
        NEAR(state.start_position[axis], began[axis], 0);
        moved += (state.position[axis] - began[axis]) * (state.position[axis] - began[axis]);
    }
    NEAR(state.displacement, sqrt(moved), 1e-12);
    assert_true(state.displacement > 0);
    NEAR(state.viscosity, rheo__melting_viscosity(&world->def, state.jump_number, state.shear_rate), 0);
    rheo_world_destroy(world);
    /* Alone and isothermal: its own contribution to the density, and the viscosity without shear, mu (J + 1). */
    const rheo_real alone[3] = {1, 2, 3};
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.melting.temperature = 0.5;
    world = world_of(def, 1, alone, NULL);
    state = look_at(world, 0);
    NEAR(state.temperature, 0.5, 0);
    NEAR(state.jump_number, 5e4, 1e-6);
    NEAR(state.shear_rate, 0, 0);
    NEAR(state.viscosity, 0.05 * 50001, 0.01);
    NEAR(state.summed_density, 66 / (120 * 3.14159265358979), 1e-6);
    assert_int_equal(state.neighbours, 0);
    rheo_world_destroy(world);
}

static void rankings_of_melting_worlds(void **unused)
{
    (void)unused;
    static const char *const ISOTHERMAL[] = {"melting.diffusivity", "0", NULL};
    rheo_world *world = melting_world(5, ISOTHERMAL);
    const rheo_top tops[] = {RHEO_TOP_DENSEST, RHEO_TOP_HOTTEST, RHEO_TOP_FURTHEST, RHEO_TOP_FASTEST};
    rheo_top_entry entry[126], few[3];
    size_t count;
    step(world, 4);
    for (size_t t = 0; t < sizeof tops / sizeof *tops; t++) {
        OK(rheo_world_top(world, tops[t], 126, entry, &count, &error));
        assert_int_equal(count, 125);
        for (size_t i = 0; i < count; i++) {
            const rheo_particle_state s = look_at(world, entry[i].id);
            const double value[] = {s.density, s.temperature, s.displacement, s.speed};
            assert_true(entry[i].value == value[t] && entry[i].other_id == 0);
            assert_true(i == 0 || entry[i - 1].value > entry[i].value ||
                        (entry[i - 1].value == entry[i].value && entry[i - 1].id < entry[i].id));
        }
        OK(rheo_world_top(world, tops[t], 3, few, &count, &error));
        assert_int_equal(count, 3);
        for (size_t i = 0; i < 3; i++)
            assert_true(few[i].id == entry[i].id && few[i].value == entry[i].value);
    }
    OK(rheo_world_top(world, RHEO_TOP_STIFFEST, 125, entry, &count, &error));
    assert_int_equal(count, 0);
    rheo_world_destroy(world);
    /* Rankings that a world lacks are empty. */
    const rheo_real alone[3] = {0, 0, 0};
    world = world_of(rheo_default_model_def(RHEO_MODEL_MELTING), 1, alone, NULL);
    OK(rheo_world_top(world, RHEO_TOP_HOTTEST, 125, entry, &count, &error));
    assert_int_equal(count, 0);
    rheo_world_destroy(world);
    world = scattered_world();
    for (rheo_top what = RHEO_TOP_HOTTEST; what <= RHEO_TOP_FURTHEST; what++) {
        OK(rheo_world_top(world, what, 125, entry, &count, &error));
        assert_int_equal(count, 0);
    }
    REFUSED(RHEO_ERROR_ARGUMENT, "no list",
            rheo_world_top(world, (rheo_top)(RHEO_TOP_FURTHEST + 1), 1, entry, &count, &error));
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(densities_are_sums_over_all_pairs),
        cmocka_unit_test(neighbours_are_those_within_the_support),
        cmocka_unit_test(neighbours_are_those_of_the_step),
        cmocka_unit_test(a_pair_by_hand),
        cmocka_unit_test(the_stage_computes_the_same_densities),
        cmocka_unit_test(the_derivative_is_that_of_the_stage),
        cmocka_unit_test(springs_of_a_particle_are_counted),
        cmocka_unit_test(short_rankings_begin_the_full_one),
        cmocka_unit_test(the_step_reports_the_same_stiffest_spring),
        cmocka_unit_test(ties_are_ordered_by_id_and_nan_is_first),
        cmocka_unit_test(ids_out_of_range_are_refused),
        cmocka_unit_test(an_empty_world_can_be_queried),
        cmocka_unit_test(coinciding_particles_have_full_weight),
        cmocka_unit_test(running_out_of_memory_is_an_error),
        cmocka_unit_test(queries_change_nothing),
        cmocka_unit_test(weights_are_those_of_the_kernel),
        cmocka_unit_test(summation_densities_are_those_of_the_stage),
        cmocka_unit_test(shear_rates_are_those_of_the_stage),
        cmocka_unit_test(a_melting_particle_by_hand),
        cmocka_unit_test(rankings_of_melting_worlds),
    };
    return cmocka_run_group_tests_name("look", tests, NULL, NULL);
}
