/*
 * Materials: worlds of one material have the same bits with and without a list of materials; particles of several have
 * the parameters of their own, and springs between them the means.
 */
#define PATH "test_materials.rlog"

#include "record_support.h"

#include <math.h>

#include "record/head.h"
#include "thickening/continuum.h"
#include "world/model_thickening.h"

static rheo_material material(const char *name)
{
    return rheo_default_material(name);
}

/* ---- Definitions ---- */

static void names_and_numbers_find_materials(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    const rheo_material a = material("oobleck"), b = material("b-2_x");
    uint32_t number;
    char text[96];
    OK(rheo_world_def_add_material(&def, &a, &error));
    OK(rheo_world_def_add_material(&def, &b, &error));
    assert_true(rheo_world_def_material(&def, "b-2_x", &number) && number == 2);
    assert_true(rheo_world_def_material(&def, "", &number) && number == 0);
    assert_true(rheo_world_def_material(&def, "main", &number) && number == 0);
    assert_false(rheo_world_def_material(&def, "c", &number));
    assert_string_equal(rheo_world_def_material_name(&def, 0), "main");
    assert_string_equal(rheo_world_def_material_name(&def, 1), "oobleck");
    assert_string_equal(rheo_world_def_material_name(&def, 3), "");
    OK(rheo_world_def_set(&def, "materials.oobleck.history.stiffness", "7.5", &error));
    OK(rheo_world_def_get(&def, "materials.1.history.stiffness", text, sizeof text));
    assert_string_equal(text, "7.5");
    OK(rheo_world_def_set(&def, "materials.2.springs.yield_ratio", "0.25", &error));
    assert_true(def.materials.list[1].springs.yield_ratio == 0.25);
    OK(rheo_world_def_get(&def, "materials.2.name", text, sizeof text));
    assert_string_equal(text, "b-2_x");
    assert_int_equal(rheo_world_def_parameter_count(&def), rheo_parameter_count() + 12);
    assert_null(rheo_world_def_parameter_at(&def, rheo_parameter_count() + 12));
    for (size_t i = 0; i < rheo_world_def_parameter_count(&def); i++) {
        const rheo_parameter *p = rheo_world_def_parameter_at(&def, i);
        assert_ptr_equal(rheo_world_def_parameter_find(&def, p->path), p);
    }
    REFUSED(RHEO_ERROR_ARGUMENT, "no material \"3\"; the materials are: \"oobleck\", \"b-2_x\"",
            rheo_world_def_set(&def, "materials.3.springs.stiffness", "1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "a material has no such parameter",
            rheo_world_def_set(&def, "materials.1.history.order", "0.5", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "keeps its name", rheo_world_def_set(&def, "materials.1.name", "x", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at least -1",
            rheo_world_def_set(&def, "materials.1.springs.stiffness", "-2", &error));
}

static void bad_materials_are_refused(void **unused)
{
    (void)unused;
    static const char *const bad[] = {"", "main", "1st", "a b", "a.b", "-a", "\xc3\xa4"};
    rheo_world_def def = inert_def();
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const rheo_material m = material(bad[i]);
        REFUSED(RHEO_ERROR_ARGUMENT, "a name is a letter", rheo_world_def_add_material(&def, &m, &error));
    }
    rheo_material endless = material("a");
    memset(endless.name, 'a', sizeof endless.name);
    REFUSED(RHEO_ERROR_ARGUMENT, "a name is a letter", rheo_world_def_add_material(&def, &endless, &error));
    for (uint32_t i = 0; i < RHEO_MAX_MATERIALS; i++) {
        const rheo_material m = material((char[]){(char)('a' + i), 0});
        OK(rheo_world_def_add_material(&def, &m, &error));
    }
    const rheo_material more = material("more"), a = material("a");
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 16", rheo_world_def_add_material(&def, &more, &error));
    OK(rheo_world_def_check(&def, &error));
    OK(rheo_world_def_set(&def, "materials.16.history.onset", "3", &error));
    assert_true(def.materials.list[15].history.onset == 3);
    def.materials.count = 17;
    REFUSED(RHEO_ERROR_ARGUMENT, "17 materials", rheo_world_def_check(&def, &error));
    def.materials.count = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "two materials", rheo_world_def_add_material(&def, &a, &error));
    def.materials.list[0].springs.plasticity = NAN;
    REFUSED(RHEO_ERROR_ARGUMENT, "materials.1.springs.plasticity", rheo_world_def_check(&def, &error));
    def.materials.list[0].springs.plasticity = -1;
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    REFUSED(RHEO_ERROR_ARGUMENT, "scheme sequential knows one material", rheo_world_def_check(&def, &error));
    def.scheme = RHEO_SCHEME_SUMMED;
    const rheo_real position[6] = {0, 0, 0, 1, 0, 0};
    uint32_t of[2] = {1, 2};
    def.particles.count = 2;
    def.particles.position = position;
    def.particles.material = of;
    REFUSED(RHEO_ERROR_ARGUMENT, "particle 1 is of material 2; the last material is 1",
            rheo_world_def_check(&def, &error));
    rheo_world_def melting = rheo_default_model_def(RHEO_MODEL_MELTING);
    OK(rheo_world_def_add_material(&melting, &a, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "the model melting has no materials", rheo_world_def_check(&melting, &error));
}

static void a_number_changes_with_the_main_one_until_it_is_set(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    rheo_material m = material("a");
    OK(rheo_world_def_add_material(&def, &m, &error));
    def.springs.stiffness = 3;
    def.history.onset = 0.5;
    assert_true(rheo__material_of(&def, 1).springs.stiffness == 3);
    def.springs.stiffness = 4;
    def.materials.list[0].history.onset = 0;
    m = rheo__material_of(&def, 1);
    assert_true(m.springs.stiffness == 4 && m.history.onset == 0);
}

/* ---- Bits ---- */

/* The scene of record_support.h, without its commands. `several`: the particles are of materials that are all alike. */
static rheo_world *alike_world(rheo_history_kind history, rheo_hardening hardening, bool several)
{
    rheo_real position[3 * MOST];
    uint32_t of[MOST];
    rheo_world_def def = scene_def(5, position);
    def.history.kind = history;
    def.history.hardening = hardening;
    def.history.stiffness = 900;
    rheo_material same = {"same",
                          {def.springs.stiffness, def.springs.plasticity, def.springs.yield_ratio},
                          {def.history.stiffness, def.history.onset}};
    if (several) {
        const rheo_material inherits = material("inherits");
        OK(rheo_world_def_add_material(&def, &same, &error));
        OK(rheo_world_def_add_material(&def, &inherits, &error));
        for (uint32_t i = 0; i < def.particles.count; i++)
            of[i] = i % 3;
        def.particles.material = of;
    }
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

/* Asserts that two worlds have the same bits in all fields but `material`, and the same metrics. */
static void assert_same(const rheo_world *a, const rheo_world *b)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(&a->state, f) &&
            rheo__state_hash_field(&a->state, f) != rheo__state_hash_field(&b->state, f))
            fail_msg("%s differs in step %d", rheo__field_table[f].name, (int)*a->state.step);
    for (uint32_t i = 0; i < rheo_world_metric_count(a); i++) {
        const char *name = rheo_world_metric_name(a, i);
        /* Of springs with the same K either is the stiffest. */
        if (strncmp(name, "stiffness_", 10) != 0 && rheo_world_metric(a, i) != rheo_world_metric(b, i))
            fail_msg("%s differs in step %d", name, (int)*a->state.step);
    }
}

static void materials_that_are_alike_change_no_bit(void **unused)
{
    (void)unused;
    static const rheo_history_kind kinds[] = {RHEO_HISTORY_WINDOW, RHEO_HISTORY_WINDOW_FAST, RHEO_HISTORY_FULL,
                                              RHEO_HISTORY_TEMPERED};
    for (size_t i = 0; i < 2 * sizeof kinds / sizeof *kinds; i++) {
        const rheo_hardening hardening = i % 2 ? RHEO_HARDENING_PASSIVE : RHEO_HARDENING_ACTIVE;
        rheo_world *one = alike_world(kinds[i / 2], hardening, false),
                   *several = alike_world(kinds[i / 2], hardening, true);
        assert_false(rheo__state_has(&one->state, RHEO__FIELD_material));
        assert_true(rheo__state_has(&several->state, RHEO__FIELD_material));
        for (int n = 0; n < 25; n++) {
            step(one, 1);
            step(several, 1);
            assert_same(one, several);
        }
        assert_true(metric(one, "stiffness_number") > 0 && rheo_world_spring_count(one) > 0);
        rheo_world_destroy(one);
        rheo_world_destroy(several);
    }
}

/* A lattice of 4 x 4 x 4 particles, pressed together along x, with its lowest corner at x. */
static void put_block(rheo_real x, rheo_real *position, rheo_real *velocity)
{
    for (uint32_t i = 0; i < 64; i++) {
        position[3 * i] = x + (rheo_real)(i % 4);
        position[3 * i + 1] = (rheo_real)(i / 4 % 4) + (rheo_real)0.125 * (rheo_real)(i % 3);
        position[3 * i + 2] = (rheo_real)(i / 16);
        velocity[3 * i] = (rheo_real)-2 * (rheo_real)((int)(i % 4) - 1);
        velocity[3 * i + 1] = velocity[3 * i + 2] = 0;
    }
}

static rheo_world_def block_def(void)
{
    rheo_world_def def = inert_def();
    def.substeps = 2;
    def.fluid.stiffness = 40;
    def.fluid.near_stiffness = 60;
    def.fluid.linear_viscosity = 1;
    def.springs.stiffness = 10;
    def.springs.plasticity = 2;
    def.history.window = 20;
    return def;
}

/* Two fluids in one world, too far apart to meet, move as each does in a world of its own. */
static void fluids_apart_move_as_in_worlds_of_their_own(void **unused)
{
    (void)unused;
    rheo_real position[2 * 3 * 64], velocity[2 * 3 * 64];
    rheo_world_def soft = block_def(), stiff = block_def(), both = block_def();
    rheo_material m = {"stiff", {25, 1, 0.1}, {300, 0.25}};
    soft.history.stiffness = both.history.stiffness = 0;
    stiff.springs.stiffness = m.springs.stiffness;
    stiff.springs.plasticity = m.springs.plasticity;
    stiff.springs.yield_ratio = m.springs.yield_ratio;
    stiff.history.stiffness = m.history.stiffness;
    stiff.history.onset = m.history.onset;
    OK(rheo_world_def_add_material(&both, &m, &error));
    uint32_t of[2 * 64] = {0};
    for (size_t i = 64; i < 128; i++)
        of[i] = 1;
    both.particles.material = of;
    put_block(0, position, velocity);
    put_block(64, position + 192, velocity + 192);
    rheo_world *alone[2] = {world_of(soft, 64, position, velocity),
                            world_of(stiff, 64, position + 192, velocity + 192)},
               *together = world_of(both, 128, position, velocity);
    double apart = 0, most = 0;
    for (int n = 0; n < 40; n++) {
        step(together, 1);
        step(alone[0], 1);
        step(alone[1], 1);
        for (size_t i = 0; i < 2 * 192; i++) {
            const double x = (double)rheo_world_positions(together)[i],
                         own = (double)rheo_world_positions(alone[i / 192])[i % 192];
            most = fmax(most, fabs(x - own));
            if (i < 192)
                apart = fmax(apart, fabs(x - ((double)rheo_world_positions(together)[i + 192] - (i % 3 ? 0 : 64))));
        }
    }
    /* The order of the sums differs, so the last digits do: 64 has eps 2^-17 in float. */
    assert_true(most < (RHEO_DOUBLE ? 1e-12 : 1e-4));
    assert_true(apart > 0.2); /* and the two fluids move differently */
    rheo_world_destroy(together);
    rheo_world_destroy(alone[0]);
    rheo_world_destroy(alone[1]);
}

/* ---- The interface ---- */

/* Two particles at distance r, of the materials 0 and 1, with a spring of length 1. */
static rheo_world *pair(rheo_world_def def, double r, const rheo_real *velocity)
{
    static const uint32_t ends[] = {0, 1}, of[] = {0, 1};
    static const rheo_real length[] = {1};
    const rheo_real position[] = {0, 0, 0, (rheo_real)r, 0, 0};
    def.substeps = 1;
    def.particles.spring_count = 1;
    def.particles.spring_ends = ends;
    def.particles.spring_rest_length = length;
    def.particles.material = of;
    return world_of(def, 2, position, velocity);
}

/* x(n+1) = (1 - kappa)(2 x(n) - x(n-1)) with kappa of the mean stiffness. */
static void a_spring_between_materials_has_the_mean_stiffness(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    const double kappa = 0.2, stretch = 0.25, all = kappa / (def.step * def.step);
    def.springs.stiffness = 0.25 * all;
    rheo_material m = material("stiff");
    m.springs.stiffness = 1.75 * all;
    OK(rheo_world_def_add_material(&def, &m, &error));
    rheo_world *world = pair(def, 1 + stretch, NULL);
    double before = stretch, now = stretch * (1 - kappa);
    for (int n = 0; n < 30; n++) {
        step(world, 1);
        rheo_spring_state spring;
        OK(rheo_world_spring(world, 0, 1, &spring, &error));
        NEAR(spring.length - 1, now, 2e-5);
        NEAR(spring.stiffness, all, 1e-5 * all);
        const double next = (1 - kappa) * (2 * now - before);
        before = now;
        now = next;
    }
    rheo_world_destroy(world);
}

/* At a fixed stretch, L(n) = L_end + (1 - L_end)(1 - step alpha (1 + gamma))^n, L_end = r/(1 + gamma). */
static void a_spring_between_materials_flows_at_the_mean_rate(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 1e-9; /* too weak to move anything */
    def.springs.plasticity = 0.5;
    def.springs.yield_ratio = 0.05;
    rheo_material m = material("flows");
    m.springs.plasticity = 2.5;
    m.springs.yield_ratio = 0.15;
    OK(rheo_world_def_add_material(&def, &m, &error));
    const double r = 1.5, alpha = 1.5, gamma = 0.1, end = r / (1 + gamma);
    rheo_world *world = pair(def, r, NULL);
    for (int n = 1; n <= 40; n++) {
        step(world, 1);
        rheo_spring_state spring;
        OK(rheo_world_spring(world, 0, 1, &spring, &error));
        NEAR((double)spring.spring.rest_length, end + (1 - end) * pow(1 - def.step * alpha * (1 + gamma), n), 2e-6);
    }
    rheo_world_destroy(world);
}

/* K = k_min + k_hist n^2/(n + n0) with means, in the query and in the step, whose metric is step^2 K. */
static void a_spring_between_materials_hardens_by_the_mean(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 2;
    def.history.stiffness = 0; /* the main material does not thicken */
    def.history.onset = 1;
    rheo_material m = {"thickens", {4, -1, -1}, {30, 3}};
    OK(rheo_world_def_add_material(&def, &m, &error));
    const rheo_real velocity[] = {0, 1, 0, 0, -1, 0};
    rheo_world *world = pair(def, 1, velocity);
    step(world, 3);
    rheo_spring_state spring;
    OK(rheo_world_spring(world, 0, 1, &spring, &error));
    const double n = spring.history_rate, k = 3 + 15 * n * n / (n + 2);
    assert_true(n > 0.1);
    NEAR(spring.stiffness, k, 1e-5 * k);
    step(world, 1);
    NEAR(metric(world, "stiffness_number"), def.step * def.step * k, 1e-5 * def.step * def.step * k);
    rheo_particle_state state[2];
    OK(rheo_world_particles(world, state, &error));
    assert_int_equal(state[0].material, 0);
    assert_int_equal(state[1].material, 1);
    rheo_world_destroy(world);
}

/* F of a particle at a wall is over 10 k_min of its own material. */
static void a_wall_holds_each_end_by_its_own_stiffness(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    const rheo_wall floor = {{0, -0.25, 0}, {0, 1, 0}};
    def.walls.count = 1;
    def.walls.plane = &floor;
    def.springs.stiffness = 2;
    def.history.stiffness = 50;
    rheo_material m = material("stiff");
    m.springs.stiffness = 8;
    OK(rheo_world_def_add_material(&def, &m, &error));
    const rheo_real velocity[] = {0, 0, 1, 0, 0, -1};
    rheo_world *world = pair(def, 1, velocity);
    step(world, 3);
    const rheo_real *friction = rheo__thickening_of(world)->wall_friction;
    assert_true(friction[1] > 0);
    NEAR((double)friction[0], 4 * (double)friction[1], 1e-5);
    rheo_world_destroy(world);
}

/* ---- Commands, and what follows from a definition ---- */

static void commands_change_materials(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 2;
    rheo_material m = material("a");
    m.history.stiffness = 5;
    OK(rheo_world_def_add_material(&def, &m, &error));
    rheo_world *world = pair(def, 1, NULL);
    OK(rheo_world_set(world, "materials.a.springs.stiffness", "6", &error));
    rheo_spring_state spring;
    OK(rheo_world_spring(world, 0, 1, &spring, &error));
    NEAR(spring.stiffness, 4, 1e-6);
    OK(rheo_world_set(world, "springs.stiffness", "4", &error));
    OK(rheo_world_set(world, "materials.1.springs.stiffness", "-1", &error)); /* as the main one again */
    OK(rheo_world_spring(world, 0, 1, &spring, &error));
    NEAR(spring.stiffness, 4, 1e-6);
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no material \"b\"",
            rheo_world_set(world, "materials.b.springs.stiffness", "1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "keeps its name", rheo_world_set(world, "materials.a.name", "b", &error));
    const rheo_real at[] = {5, 0, 0, 7, 0, 0};
    OK(rheo_world_add_particles_of(world, 1, 2, at, NULL, &error));
    OK(rheo_world_add_particles(world, 1, at, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no material 2",
            rheo_world_add_particles_of(world, 2, 1, at, NULL, &error));
    static const uint32_t of[] = {0, 1, 1, 1, 0};
    for (uint32_t i = 0; i < 5; i++)
        assert_int_equal(world->state.material[i], of[i]);
    step(world, 1);
    rheo_world_destroy(world);

    /* A world without materials, and one without history, have no place for them. */
    rheo_world *one = world_of(inert_def(), 0, NULL, NULL);
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no material 1",
            rheo_world_add_particles_of(one, 1, 0, NULL, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no materials are given",
            rheo_world_set(one, "materials.a.springs.stiffness", "1", &error));
    rheo_world_destroy(one);
    def.materials.list[0].history.stiffness = def.history.stiffness = 0;
    world = pair(def, 1, NULL);
    REFUSED(RHEO_ERROR_ARGUMENT, "made without history",
            rheo_world_set(world, "materials.a.history.stiffness", "5", &error));
    rheo_world_destroy(world);
}

/* One material with history is enough to need it; the largest stiffness counts for substeps and warnings. */
static void the_stiffest_material_counts(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    def.springs.stiffness = def.history.stiffness = 0;
    rheo_material m = material("a");
    m.springs.stiffness = 2e4;
    m.springs.plasticity = 100;
    OK(rheo_world_def_add_material(&def, &m, &error));
    assert_true(rheo__world_features(&def) & RHEO__FEATURE_SPRINGS);
    assert_false(rheo__world_features(&def) & RHEO__FEATURE_HISTORY);
    def.materials.list[0].history.stiffness = 1;
    assert_true(rheo__world_features(&def) & RHEO__FEATURE_HISTORY);
    rheo_world_def main = rheo_default_world_def();
    main.springs.stiffness = 2e4;
    rheo_derived of_main, of_material;
    for (uint32_t i = 0; rheo_world_def_derived(&main, i, &of_main); i++) {
        assert_true(rheo_world_def_derived(&def, i, &of_material));
        if (strcmp(of_main.name, "kappa") == 0 || strcmp(of_main.name, "substeps") == 0)
            assert_true(of_main.value == of_material.value);
    }
}

/* A finer scene of the same materials: their own parameters follow the rule of the main ones. */
static void resolution_refines_materials(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def(), main = def;
    rheo_material m = {"a", {def.springs.stiffness, -1, -1}, {def.history.stiffness, def.history.onset}};
    OK(rheo_world_def_add_material(&def, &m, &error));
    def.springs.stiffness = 1;
    rheo__thickening_refine(&def, 2);
    rheo__thickening_refine(&main, 2);
    m = def.materials.list[0];
    assert_true(m.springs.stiffness == main.springs.stiffness && m.springs.plasticity == -1 &&
                m.history.stiffness == main.history.stiffness && m.history.onset == main.history.onset);
}

/* ---- Scenes ---- */

static rheo_scene two_blocks(void)
{
    rheo_scene scene = rheo_default_scene();
    const rheo_material m = {"thick", {-1, -1, -1}, {500, -1}};
    rheo_fill fill = {.kind = RHEO_FILL_BLOCK, .max = {8, 4, 8}};
    const rheo_wall floor = {{0, 0, 0}, {0, 1, 0}};
    scene.world.history.stiffness = 0;
    OK(rheo_world_def_add_material(&scene.world, &m, &error));
    OK(rheo_scene_add_wall(&scene, &floor, &error));
    OK(rheo_scene_add_fill(&scene, &fill, &error));
    snprintf(fill.material, sizeof fill.material, "thick");
    fill.min[0] = 8;
    fill.max[0] = 14;
    OK(rheo_scene_add_fill(&scene, &fill, &error));
    scene.settle.time = 0.5;
    return scene;
}

static void shapes_have_materials(void **unused)
{
    (void)unused;
    rheo_scene scene = two_blocks();
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_int_equal(rheo_world_particle_count(world), 4 * 2 * 4 + 3 * 2 * 4);
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
        assert_int_equal(world->state.material[i], i >= 32);
    /* Settling is without history, so none has gathered; the materials are those of the scene again. */
    assert_int_equal(rheo_world_history_rows(world), 0);
    assert_true(rheo_world_definition(world)->materials.list[0].history.stiffness == 500);
    scene.world.materials.list[0].history.stiffness = 90000;
    scene.world.materials.list[0].springs.yield_ratio = 0.9;
    rheo_world *other;
    OK(rheo_scene_create_world(&scene, &other, &error));
    assert_true(rheo_world_spring_count(world) > 0);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) /* settling had neither history nor yield strain */
        if (rheo__state_has(&world->state, f))
            assert_true(rheo__state_hash_field(&world->state, f) == rheo__state_hash_field(&other->state, f));
    rheo_world_destroy(other);
    rheo_world_destroy(world);
    snprintf(((rheo_fill *)(uintptr_t)scene.fill)[1].material, 16, "thin");
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 1: there is no material \"thin\"; the materials are: \"thick\"",
            rheo_scene_check(&scene, &error));
    OK(rheo_scene_set(&scene, "materials.thick.springs.plasticity", "3", &error));
    char text[96];
    OK(rheo_scene_get(&scene, "materials.1.springs.plasticity", text, sizeof text));
    assert_string_equal(text, "3");
    rheo_scene_release(&scene);
}

/* Mean height of the particles of a material. */
static double height_of(const rheo_world *world, uint32_t number)
{
    double sum = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
        if (world->state.material[i] == number) {
            sum += (double)rheo_world_positions(world)[3 * i + 1];
            count++;
        }
    return sum / count;
}

/* Two drops fall on a floor; only that of cornstarch bounces. A smaller one does so, too: here the radius is 3 h. */
static void only_the_drop_of_cornstarch_bounces(void **unused)
{
    (void)unused;
    for (uint64_t seed = 1; seed <= (SANITIZED ? 1 : 3); seed++) {
        rheo_scene scene;
        OK(rheo_scene_builtin("drop-pair", &scene, &error));
        scene.seed = seed;
        for (uint32_t f = 0; f < 2; f++) {
            scene.owned.fill[f].radius = 3;
            scene.owned.fill[f].centre[1] = 7;
        }
        rheo_world *world;
        OK(rheo_scene_create_world(&scene, &world, &error));
        rheo_scene_release(&scene);
        double lowest[2] = {1e9, 1e9}, rise[2] = {0, 0};
        for (int n = 0; n < 150; n++) {
            step(world, 1);
            for (uint32_t m = 0; m < 2; m++) {
                const double y = height_of(world, m);
                lowest[m] = fmin(lowest[m], y);
                rise[m] = fmax(rise[m], y - lowest[m]);
            }
        }
        assert_true(rise[0] < 0.1 && rise[1] > 0.5);
        rheo_world_destroy(world);
    }
}

/* ---- Recordings ---- */

static rheo_world *two_blocks_world(void)
{
    rheo_scene scene = two_blocks();
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    rheo_scene_release(&scene);
    return world;
}

/* Records 12 steps, `full` with the state of each, and commands; returns the last hash. */
static uint64_t record_blocks(bool full)
{
    rheo_world *world = two_blocks_world();
    const rheo_record_options options = {.scene = "blocks", .keyframe_spacing = 5, .full = full, .force = true};
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (int i = 0; i < 12; i++) {
        const rheo_real at[] = {4, 9, 4};
        if (i == 6)
            OK(rheo_world_set(world, "materials.thick.history.stiffness", "700", &error));
        if (i == 8)
            OK(rheo_world_add_particles_of(world, 1, 1, at, NULL, &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    const uint64_t hash = rheo_world_hash(world);
    rheo_world_destroy(world);
    return hash;
}

/* Loads states, at keyframes and between them, and makes the rest of the run again. */
static void assert_continues(rheo_recording *r, uint64_t hash)
{
    for (uint64_t from = 5; from <= 11; from += 3) {
        rheo_world *world;
        OK(rheo_recording_world(r, from, NULL, &world, &error));
        for (uint64_t at = from; at < 12; at++) {
            const rheo_real place[] = {4, 9, 4};
            if (at == 6)
                OK(rheo_world_set(world, "materials.thick.history.stiffness", "700", &error));
            if (at == 8)
                OK(rheo_world_add_particles_of(world, 1, 1, place, NULL, &error));
            step(world, 1);
        }
        assert_true(rheo_world_hash(world) == hash);
        rheo_world_destroy(world);
    }
}

static void recordings_hold_materials(void **unused)
{
    (void)unused;
    for (int full = 0; full <= 1; full++) {
        const uint64_t hash = record_blocks(full);
        rheo_verification v;
        OK(rheo_verify(PATH, &v, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
        rheo_recording *r;
        OK(rheo_recording_open(PATH, &r, &error));
        const rheo_world_def *def = rheo_recording_definition(r);
        assert_int_equal(def->materials.count, 1);
        assert_string_equal(rheo_world_def_material_name(def, 1), "thick");
        assert_true(def->materials.list[0].history.stiffness == 500 &&
                    def->materials.list[0].springs.plasticity == -1);
        assert_continues(r, hash);
        rheo_command c;
        OK(rheo_recording_command(r, 0, &c, &error));
        assert_string_equal(c.path, "materials.thick.history.stiffness");
        OK(rheo_recording_command(r, 1, &c, &error));
        assert_int_equal(c.index, 1);
        assert_string_equal(c.text, "1 particle of material 1 was added at [4, 9, 4]");
        rheo_recording_close(r);
    }
    remove(PATH);
}

/* Another number of materials, another name and another value are differences of the definitions. */
static void differences_of_materials_are_named(void **unused)
{
    (void)unused;
    (void)why; /* of record_support.h */
    rheo_world_def a = inert_def(), b = a;
    const rheo_material m = material("a"), n = material("n");
    size_t index = 0;
    char of_a[96], of_b[96];
    assert_null(rheo_world_def_differing(&a, &b, &index, of_a, of_b));
    OK(rheo_world_def_add_material(&b, &m, &error));
    index = 0;
    const rheo_parameter *p = rheo_world_def_differing(&a, &b, &index, of_a, of_b);
    assert_string_equal(p->path, "materials.1.name");
    assert_string_equal(of_a, "");
    assert_string_equal(of_b, "a");
    OK(rheo_world_def_add_material(&a, &n, &error));
    a.materials.list[0].history.onset = 4;
    index = 0;
    p = rheo_world_def_differing(&a, &b, &index, of_a, of_b);
    assert_string_equal(p->path, "materials.1.name");
    assert_string_equal(of_a, "n");
    p = rheo_world_def_differing(&a, &b, &index, of_a, of_b);
    assert_string_equal(p->path, "materials.1.history.onset");
    assert_string_equal(of_a, "4");
    assert_string_equal(of_b, "-1");
    assert_null(rheo_world_def_differing(&a, &b, &index, of_a, of_b));
}

/* Reads a parameter list of `count` entries: the same path, with this text for each %u, and this value. */
static rheo_result read_entries(uint32_t count, const char *path, double value, uint32_t numbers, rheo_world_def *def,
                                rheo_error *error)
{
    rheo__bytes bytes = {0};
    rheo__put_u32(&bytes, count);
    for (uint32_t i = 0; i < count; i++) {
        char text[128], *mark;
        snprintf(text, sizeof text, "%s", path);
        if ((mark = strchr(text, '#')))
            *mark = (char)('a' + i);
        rheo__put_text(&bytes, text);
        rheo__put_u32(&bytes, numbers);
        for (uint32_t k = 0; k < numbers; k++)
            rheo__put_f64(&bytes, value);
    }
    rheo__cursor cursor = {bytes.data, bytes.size, 0, false};
    *def = rheo_default_world_def();
    const rheo_result result = rheo__parameters_get(&cursor, def, error);
    rheo__bytes_release(&bytes);
    return result;
}

static void damaged_materials_are_refused(void **unused)
{
    (void)unused;
    rheo_world_def def;
    OK(read_entries(16, "materials.m#.history.onset", 2, 1, &def, &error));
    assert_int_equal(def.materials.count, 16);
    assert_string_equal(rheo_world_def_material_name(&def, 16), "mp");
    assert_true(def.materials.list[15].history.onset == 2 && def.materials.list[15].springs.stiffness == -1);
    static const char *const bad[] = {"materials..history.onset",
                                      "materials.a b.history.onset",
                                      "materials.1.history.onset",
                                      "materials.main.history.onset",
                                      "materials.aaaaaaaaaaaaaaaa.history.onset",
                                      "materials.",
                                      "materials.\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        REFUSED(RHEO_ERROR_FORMAT, "cannot have a material", read_entries(1, bad[i], 2, 1, &def, &error));
    REFUSED(RHEO_ERROR_FORMAT, "cannot have a material",
            read_entries(17, "materials.m#.history.onset", 2, 1, &def, &error));
    REFUSED(RHEO_ERROR_FORMAT, "bad parameter", read_entries(1, "materials.a.history.onset", NAN, 1, &def, &error));
    REFUSED(RHEO_ERROR_FORMAT, "bad parameter", read_entries(1, "materials.a.history.onset", -1.5, 1, &def, &error));
    REFUSED(RHEO_ERROR_UNSUPPORTED, "does not know",
            read_entries(1, "materials.a.history.order", 0.5, 1, &def, &error));
    REFUSED(RHEO_ERROR_UNSUPPORTED, "does not know",
            read_entries(1, "materials.a.history.onset", 2, 2, &def, &error));
    REFUSED(RHEO_ERROR_UNSUPPORTED, "does not know", read_entries(1, "materials.a", 0, 0, &def, &error));

    rheo_world *world = two_blocks_world();
    OK(rheo__world_check_state(world, true, &error));
    world->state.material[5] = 2;
    REFUSED(RHEO_ERROR_FORMAT, "particle 5 is of material 2; the last material is 1",
            rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
}

/* Every SIMD variant has the bits of the scalar one. */
static void all_variants_compute_the_same_bits(void **unused)
{
    (void)unused;
    const char *best = rheo_simd(), *variant;
    uint64_t expected = 0;
    for (uint32_t i = 0; (variant = rheo_simd_available(i)); i++) {
        OK(rheo_use_simd(variant, &error));
        const uint64_t hash = record_blocks(false);
        expected = i ? expected : hash;
        assert_true(hash == expected);
    }
    OK(rheo_use_simd(best, &error));
    remove(PATH);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_numbers_find_materials),
        cmocka_unit_test(bad_materials_are_refused),
        cmocka_unit_test(a_number_changes_with_the_main_one_until_it_is_set),
        cmocka_unit_test(materials_that_are_alike_change_no_bit),
        cmocka_unit_test(fluids_apart_move_as_in_worlds_of_their_own),
        cmocka_unit_test(a_spring_between_materials_has_the_mean_stiffness),
        cmocka_unit_test(a_spring_between_materials_flows_at_the_mean_rate),
        cmocka_unit_test(a_spring_between_materials_hardens_by_the_mean),
        cmocka_unit_test(a_wall_holds_each_end_by_its_own_stiffness),
        cmocka_unit_test(commands_change_materials),
        cmocka_unit_test(the_stiffest_material_counts),
        cmocka_unit_test(resolution_refines_materials),
        cmocka_unit_test(shapes_have_materials),
        cmocka_unit_test(only_the_drop_of_cornstarch_bounces),
        cmocka_unit_test(recordings_hold_materials),
        cmocka_unit_test(differences_of_materials_are_named),
        cmocka_unit_test(damaged_materials_are_refused),
        cmocka_unit_test(all_variants_compute_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
