/* The melting model: conservation, stages and fields, SIMD variants, and the equations as printed in the paper. */
#include "melting_support.h"

#include "core/math.h"
#include "melting.h"

static rheo_world *lively_blob(rheo_world_def def, int n)
{
    def.gravity[1] = 0;
    fluid f = lattice(def.fluid.spacing, n, n, n, 0.1);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++) {
        f.temperature[i] = (rheo_real)(0.3 + 0.4 * random_unit());
        for (int axis = 0; axis < 3; axis++)
            f.v[3 * i + axis] = (rheo_real)(0.4 * (random_unit() - 0.5) + (axis == 0 ? 0.1 : 0));
    }
    return melt_of(def, f);
}

/* Momentum is conserved to rounding if there are no external forces, for any tolerance of the solver. */
static void momentum_is_kept(void **unused)
{
    (void)unused;
    static const char *const CHOICES[][2] = {{"melting.solver", "implicit"},
                                             {"melting.tolerance", "0.5"},
                                             {"melting.solver", "explicit"},
                                             {"melting.stress", "nested"}};
    for (int choice = 0; choice < 4; choice++) {
        rheo_world_def def = melt_def(0.05);
        def.melting.jump_number_max = 200;
        set(&def, CHOICES[choice][0], CHOICES[choice][1]);
        if (def.melting.solver == RHEO_VISCOSITY_EXPLICIT)
            def.melting.jump_number_max = 2; /* limits the number of substeps */
        rheo_world *world = lively_blob(def, 6);
        const uint32_t count = world->state.particles;
        double before[3], after[3], substeps = 0;
        momentum_of(world, before);
        for (int s = 0; s < 100; s++) {
            step(world, 1);
            substeps += metric(world, "substeps");
        }
        momentum_of(world, after);
        double worst = 0;
        for (int axis = 0; axis < 3; axis++)
            worst = fmax(worst, fabs(after[axis] - before[axis]) / count);
        print_message("momentum, %s: %.0f substeps, changed by %.2g a particle\n", CHOICES[choice][1], substeps,
                      worst);
        assert_true(substeps >= 1000);
        assert_true(worst < (IS_FLOAT ? 1e-6 : 1e-14));
        rheo_world_destroy(world);
    }
}

/* Heights and distances of the hot and the cold part, from the positions as they began and as they are. */
static void metrics_of_progress_are_those_of_the_particles(void **unused)
{
    (void)unused;
    rheo_world *world = lively_blob(melt_def(0.05), 5);
    const rheo__state *s = &world->state;
    step(world, 20);
    const double spacing = world->def.fluid.spacing;
    double low = INFINITY, high = -INFINITY, hot = 0, cold = 0, centre[3] = {0}, cold_y = 0, moved = 0, spread = 0;
    for (size_t i = 0; i < s->particles; i++) {
        low = fmin(low, (double)s->start_position[3 * i + 1] - spacing / 2);
        high = fmax(high, (double)s->start_position[3 * i + 1] + spacing / 2);
    }
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < s->particles; i++) {
            const rheo_real *x = s->position + 3 * i, *from = s->start_position + 3 * i;
            const double began = ((double)from[1] - low) / (high - low);
            if (began > 0.7 && pass == 0) {
                hot++;
                for (int axis = 0; axis < 3; axis++)
                    centre[axis] += (double)x[axis];
            } else if (began > 0.7) {
                spread += pow((double)x[0] - centre[0] / hot, 2) + pow((double)x[2] - centre[2] / hot, 2);
            } else if (began < 0.35 && pass == 0) {
                cold++;
                cold_y += (double)x[1] - low;
                double square = 0;
                for (int axis = 0; axis < 3; axis++)
                    square += pow((double)x[axis] - (double)from[axis], 2);
                moved += sqrt(square);
            }
        }
    assert_true(hot > 10 && cold > 10 && moved / cold > 0.01 * spacing);
    NEAR(metric(world, "hot_height"), (centre[1] / hot - low) / (high - low), 1e-12);
    NEAR(metric(world, "cold_height"), cold_y / cold / (high - low), 1e-12);
    NEAR(metric(world, "hot_spread"), sqrt(spread / hot) / (high - low), 1e-12);
    NEAR(metric(world, "cold_displacement"), moved / cold / (high - low), 1e-12);
    rheo_world_destroy(world);
}

/* Particles at one place have no direction between them. They are parted along one of their own, with no momentum. */
static void coinciding_particles_are_parted(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.05);
    def.gravity[1] = 0;
    fluid f = lattice(def.fluid.spacing, 3, 3, 3, 0);
    memcpy(f.x + 3 * 14, f.x + 3 * 13, 3 * sizeof *f.x);
    rheo_world *world = melt_of(def, f);
    step(world, 1);
    const rheo_real *x = rheo_world_positions(world);
    double apart = 0, momentum[3];
    for (size_t axis = 0; axis < 3; axis++)
        apart = fmax(apart, fabs((double)x[3 * 13 + axis] - (double)x[3 * 14 + axis]));
    assert_true(apart > 0);
    momentum_of(world, momentum);
    for (int axis = 0; axis < 3; axis++)
        NEAR(momentum[axis] / world->state.particles, 0, IS_FLOAT ? 1e-6 : 1e-14);
    rheo_world_destroy(world);
}

/* Heat is conserved in a moving scene over thousands of substeps. */
static void heat_is_kept(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    rheo_world *world = melting_box(def, 5, 10, 5);
    const double before = heat_of(world);
    double substeps = 0;
    while (substeps < 3000) {
        step(world, 1);
        substeps += metric(world, "substeps");
    }
    const double drift = heat_of(world) / before - 1;
    print_message("heat: %.2g of it after %.0f substeps\n", drift, substeps);
    assert_true(fabs(drift) < (IS_FLOAT ? 1e-5 : 1e-12));
    NEAR(metric(world, "heat"), rheo__def_mass(&def) * heat_of(world), 1e-6);
    rheo_world_destroy(world);
}

/* ---- Stages and fields ---- */

static void assert_stages(const rheo_world *world, const char *expected)
{
    char list[400] = "";
    for (uint32_t i = 0; i < rheo_world_stage_count(world); i++) {
        rheo_stage_info info;
        rheo_world_stage(world, i, &info);
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", i ? " " : "", info.name);
    }
    assert_string_equal(list, expected);
    /* No stage claims an array that none before it derives; that of the walls needs none. */
    assert_int_equal(rheo__stages_first_premature(world->stage, world->stage_count), world->stage_count);
    for (uint32_t i = 0; i < world->stage_count; i++)
        if (strcmp(world->stage[i].name, "walls") == 0)
            assert_true(world->stage[i].reads == 0 && world->stage[i].derives == 0);
}

static rheo_world *small_world(rheo_world_def def, bool warm)
{
    fluid f = lattice(0.1, 3, 3, 3, 0);
    f.warm = warm;
    return melt_of(def, f);
}

static void scenes_have_their_stages_and_fields(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    rheo_world *isothermal = small_world(def, false);
    assert_stages(isothermal, "substeps neighbours momentum viscosity rates integration");
    assert_null(isothermal->state.temperature);
    assert_false(rheo__state_has(&isothermal->state, RHEO__FIELD_temperature));
    def.melting.viscosity = 0;
    rheo_world *ideal = small_world(def, false);
    assert_stages(ideal, "substeps neighbours momentum rates integration");
    def = melt_def(0.1);
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    rheo_world *warm = small_world(def, true);
    assert_stages(warm, "substeps neighbours momentum viscosity rates integration walls");
    assert_non_null(warm->state.temperature);
    def.melting.diffusivity = 0; /* temperatures without heat flow */
    rheo_world *still = small_world(def, true);
    assert_stages(still, "substeps neighbours momentum viscosity rates integration walls");
    assert_true(still->features == (warm->features & ~(uint32_t)RHEO__FEATURE_HEAT));
    def = melt_def(0.1);
    def.melting.flow = RHEO_FLOW_FROZEN;
    rheo_world *frozen = small_world(def, true);
    assert_stages(frozen, "neighbours substeps gradients rates integration");
    def.melting.flow = RHEO_FLOW_ON;
    def.melting.density = RHEO_DENSITY_SUMMATION;
    rheo_world *summed = small_world(def, true);
    assert_stages(summed, "substeps neighbours summation momentum viscosity rates integration");
    def.melting.density = RHEO_DENSITY_CONTINUITY;
    def.paper.leapfrog = RHEO_AS_PRINTED_ON;
    rheo_world *leapfrog = small_world(def, true);
    assert_stages(leapfrog, "substeps neighbours gradients rates momentum viscosity integration");
    rheo_world *const all[] = {isothermal, ideal, warm, still, frozen, summed, leapfrog};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        step(all[i], 2);
        assert_false(rheo__state_has(&all[i]->state, RHEO__FIELD_spring_ends));
        assert_false(rheo__state_has(&all[i]->state, RHEO__FIELD_history_velocity));
        rheo_world_destroy(all[i]);
    }
}

static void frozen_worlds_do_not_move(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.flow = RHEO_FLOW_FROZEN;
    rheo_world *world = melting_box(def, 4, 8, 4);
    const uint64_t position = rheo__state_hash_field(&world->state, RHEO__FIELD_position),
                   temperature = rheo__state_hash_field(&world->state, RHEO__FIELD_temperature);
    step(world, 20);
    assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_position) == position);
    assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_temperature) != temperature);
    rheo_world_destroy(world);
}

/* Partners within the support at the present positions, as the kept rows should have them; *edge: pairs near it. */
static uint64_t count_partners(const rheo_world *world, uint64_t *edge)
{
    const rheo__state *s = &world->state;
    const double support = rheo__melting_of(world)->support;
    uint64_t partners = 0;
    *edge = 0;
    for (uint32_t i = 0; i < s->particles; i++)
        for (uint32_t j = 0; j < s->particles; j++) {
            double r2 = 0;
            for (size_t axis = 0; axis < 3; axis++) {
                const double x = (double)s->position[3 * i + axis] - (double)s->position[3 * j + axis];
                r2 += x * x;
            }
            partners += i != j && r2 < support * support;
            *edge += fabs(sqrt(r2) - support) < 1e-5 * support;
        }
    return partners;
}

/* Between searches, rows serve several substeps and have every neighbour in each. */
static void kept_rows_miss_no_neighbour(void **unused)
{
    (void)unused;
    rheo_world *world = melting_world(7, (const char *const[]){"step", "0.2", NULL});
    const rheo__melting *m = rheo__melting_of(world);
    uint64_t substeps = 0, searches = 0;
    for (int step = 0; step < 3; step++) {
        rheo__point before = {0, 0, 0, 0};
        for (bool begun = false; !begun || world->stage_runs_done; begun = true) {
            uint32_t stage;
            OK(rheo_world_step_stage(world, &stage, &error));
            if (strcmp(world->stage[stage].name, "momentum")) /* it counts the neighbours */
                continue;
            uint64_t edge;
            const uint64_t partners = count_partners(world, &edge);
            assert_in_range(m->rows.partners, partners - edge, partners + edge);
            const rheo__point now = m->searched_at[m->pairs.rank_of[0]];
            searches += memcmp(&now, &before, sizeof now) != 0;
            before = now;
            substeps++;
        }
    }
    print_message("%llu searches in %llu substeps\n", (unsigned long long)searches, (unsigned long long)substeps);
    assert_true(searches > 3); /* a first one in each step, and more where margins are used up */
    assert_true(searches < substeps / 2);
    rheo_world_destroy(world);
}

/* ---- SIMD variants ---- */

static const char *const VARIANTS[][2] = {
    {"melting.stress", "pairwise"},
    {"melting.stress", "nested"},
    {"melting.solver", "explicit"},
    {"melting.density", "summation"},
    {"melting.laplacian", "second"},
    {"melting.flow", "frozen"},
    {"melting.wall", "free-slip"},
    {"melting.power_law_index", "0.4"},
    {"melting.rheology", "newtonian"},
    {"melting.viscosity", "0"},
    {"melting.alpha", "0"},
    {"melting.repulsion", "0"},
    {"paper.kernel", "on"},
    {"paper.jump", "on"},
    {"paper.artificial_viscosity", "on"},
    {"paper.xsph", "on"},
    {"paper.heat", "on"},
    {"paper.leapfrog", "on"},
    {"melting.smoothing_length", "0.12"},
};

/* Falling, melting, walls, coinciding particles, and a particle count that is no multiple of a block. */
static rheo_world *full_scene(size_t variant)
{
    rheo_world_def def = melt_def(0.1);
    def.melting.jump_number_max = 50;
    set(&def, VARIANTS[variant][0], VARIANTS[variant][1]);
    if (def.melting.viscosity == 0)
        def.melting.beta = 0;
    add_box(&def, 0.6, 0.6);
    random_state = variant + 1;
    fluid f = lattice(0.1, 5, 6, 5, 0.2);
    add_lattice(&f, 0.1, (double[]){0.1, 0.8, 0.1}, 3, 2, 3, 0.1);
    add_particle(&f, (double)f.x[30], (double)f.x[31], (double)f.x[32]);
    add_particle(&f, 5, 7, -3);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++) {
        f.temperature[i] = (rheo_real)(0.3 + 0.4 * random_unit());
        for (int axis = 0; axis < 3; axis++)
            f.v[3 * i + axis] = (rheo_real)(random_unit() - 0.5);
    }
    return melt_of(def, f);
}

static void all_simd_variants_give_the_same_bits(void **unused)
{
    (void)unused;
    if (!rheo_simd_available(1))
        print_message("this build has only the scalar variant: nothing to compare\n");
    const char *const before = rheo_simd(), *kernels;
    for (size_t variant = 0; variant < sizeof VARIANTS / sizeof *VARIANTS; variant++) {
        OK(rheo_use_simd("scalar", &error));
        rheo_world *reference = full_scene(variant);
        const int steps = variant == 0 ? 20 : 6;
        uint64_t hash[20];
        double metrics[20][3];
        for (int s = 0; s < steps; s++) {
            step(reference, 1);
            hash[s] = rheo_world_hash(reference);
            metrics[s][0] = metric(reference, "iterations");
            metrics[s][1] = metric(reference, "density_error");
            metrics[s][2] = metric(reference, "max_speed");
        }
        rheo_world_destroy(reference);
        for (uint32_t i = 1; (kernels = rheo_simd_available(i)); i++) {
            OK(rheo_use_simd(kernels, &error));
            rheo_world *world = full_scene(variant);
            for (int s = 0; s < steps; s++) {
                step(world, 1);
                if (rheo_world_hash(world) != hash[s])
                    fail_msg("%s %s, step %d: SIMD variant %s has another state than the scalar one",
                             VARIANTS[variant][0], VARIANTS[variant][1], s + 1, kernels);
                assert_true(metric(world, "iterations") == metrics[s][0]);
                assert_true(metric(world, "density_error") == metrics[s][1]);
                assert_true(metric(world, "max_speed") == metrics[s][2]);
            }
            rheo_world_destroy(world);
        }
    }
    OK(rheo_use_simd(before, &error));
}

/* ---- As printed ---- */

/* Eq. 10 with c^2 and the explicit viscosity of solid material leaves no usable substep. */
static void printed_courant_number_asks_for_absurd_substeps(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.05);
    def.paper.courant = RHEO_AS_PRINTED_ON;
    def.melting.jump_number_max = 2000; /* of the paper */
    rheo_world *world = melting_box(def, 4, 8, 4);
    rheo_error said;
    assert_int_equal(rheo_world_step(world, &said), RHEO_ERROR_STATE);
    const char *number = strstr(said.message, "it would need ");
    assert_non_null(number);
    const double substeps = strtod(number + strlen("it would need "), NULL);
    print_message("paper.courant: %.0f substeps a step, by default 10\n", substeps);
    NEAR(substeps, 0.02 / (0.1 * 0.05 * 0.05 / (6 * 1.35 * 0.05 * 2001)), 1000);
    rheo_world_destroy(world);
}

static double heat_drift(rheo_world_def def)
{
    def.melting.diffusivity = 0.01;
    random_state = 3;
    fluid f = lattice(0.1, 6, 8, 6, 0);
    start_hydrostatically(&f, &def, 3); /* unequal densities */
    warm_by_height(&f, 0.8);
    def.melting.flow = RHEO_FLOW_FROZEN;
    rheo_world *world = melt_of(def, f);
    const double before = heat_of(world);
    step(world, 200);
    const double drift = heat_of(world) / before - 1;
    rheo_world_destroy(world);
    return drift;
}

static void the_printed_equation_loses_heat(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    const double meant = heat_drift(def);
    def.paper.heat = RHEO_AS_PRINTED_ON;
    const double printed = heat_drift(def);
    print_message("heat of a slab of uneven density: %+.2g; with the printed weight %+.2g\n", meant, printed);
    assert_true(fabs(meant) < (IS_FLOAT ? 1e-6 : 1e-13));
    assert_true(fabs(printed) > 1e-4);
}

/* Summed densities are too low at a free surface, where neighbours are missing. */
static void summed_density_is_wrong_at_surfaces(void **unused)
{
    (void)unused;
    double error[2];
    for (int scheme = 0; scheme < 2; scheme++) {
        rheo_world_def def = melt_def(0.1);
        def.melting.density = (rheo_density_scheme)scheme;
        rheo_world *world = melting_box(def, 5, 10, 5);
        step(world, 1);
        error[scheme] = metric(world, "max_density_error");
        rheo_world_destroy(world);
    }
    print_message("largest density error after a step: %.3g, by summation %.3g\n", error[0], error[1]);
    assert_true(error[0] < 0.02);
    assert_true(error[1] > 0.2);
}

/* max_density_id is the particle whose density differs most, whichever it is, and -1 if all are at rest density. */
static void the_density_that_differs_most_has_a_name_or_none(void **unused)
{
    (void)unused;
    for (int named = -1; named < 5; named++) {
        rheo_world_def def = melt_def(0.1);
        def.gravity[1] = 0;
        fluid f = lattice(10, 5, 1, 1, 0); /* no neighbours: densities stay */
        for (uint32_t i = 0; i < f.count; i++)
            f.density[i] = (rheo_real)(def.melting.rest_density * ((int)i == named ? 0.9 : named < 0 ? 1 : 1.05));
        rheo_world *world = melt_of(def, f);
        step(world, 1);
        assert_true(metric(world, "max_density_id") == named);
        NEAR(metric(world, "max_density_error"), named < 0 ? 0 : 0.1, 1e-6);
        rheo_world_destroy(world);
    }
}

/* The printed artificial viscosity is weaker by a factor rho. */
static void printed_artificial_viscosity_depends_on_units(void **unused)
{
    (void)unused;
    double kept[2][2];
    for (int printed = 0; printed < 2; printed++)
        for (int dense = 0; dense < 2; dense++) {
            rheo_world_def def = newtonian_def(0.1, 0);
            def.paper.artificial_viscosity = (rheo_as_printed)printed;
            def.melting.rest_density = dense ? 1000 : 1;
            random_state = 9;
            fluid f = lattice(0.1, 6, 6, 6, 0);
            for (uint32_t i = 0; i < f.count; i++) {
                f.density[i] = (rheo_real)def.melting.rest_density;
                for (int axis = 0; axis < 3; axis++)
                    f.v[3 * i + axis] = (rheo_real)(random_unit() - 0.5);
            }
            def.gravity[1] = 0;
            def.melting.alpha = 1;
            rheo_world *world = melt_of(def, f);
            const double before = metric(world, "kinetic_energy");
            step(world, 1);
            kept[printed][dense] = metric(world, "kinetic_energy") / before;
            rheo_world_destroy(world);
        }
    print_message("artificial viscosity: energy kept at density 1 and 1000: %.3f %.3f; as printed %.3f %.3f\n",
                  kept[0][0], kept[0][1], kept[1][0], kept[1][1]);
    NEAR(kept[0][0], kept[0][1], 0.01);
    NEAR(kept[1][0], kept[0][0], 0.02);
    assert_true(kept[1][1] > kept[1][0] + 0.05);
}

/* Stage momentum finds the kernels of pairs while it sums; worlds that need them earlier have a loop for them. */
static void kernels_of_momentum_are_those_of_their_own_loop(void **unused)
{
    (void)unused;
    rheo_world *world = melting_box(melt_def(0.1), 4, 10, 4);
    step(world, 3);
    rheo__melting *m = world->model;
    assert_false(rheo__needs_kernels_early(m->def));
    const size_t bytes = (size_t)m->rows.start[m->rows.blocks] * RHEO__BLOCK_ROWS * sizeof(rheo_real);
    const uint64_t partners = m->rows.partners;
    rheo_real *slope = malloc(bytes), *weight = malloc(bytes);
    memcpy(slope, m->rows.slope, bytes);
    memcpy(weight, m->rows.weight, bytes);
    memset(m->rows.slope, 0xff, bytes);
    memset(m->rows.weight, 0xff, bytes);
    m->rows.partners = 0;
    rheo__find_kernels(m);
    assert_memory_equal(slope, m->rows.slope, bytes);
    assert_memory_equal(weight, m->rows.weight, bytes);
    assert_true(partners > 0 && m->rows.partners == partners);
    free(slope);
    free(weight);
    rheo_world_destroy(world);
}

/* The message about a failed step names the particle with the largest error of density, also the first one. */
static void a_failure_names_the_largest_error_of_density(void **unused)
{
    (void)unused;
    if (sizeof(rheo_real) > sizeof(float))
        skip();                                       /* it fails because a position leaves the range of float */
    for (uint32_t lonely = 0; lonely < 2; lonely++) { /* particles ahead that have no neighbours */
        const rheo_real fall = (rheo_real)-3e38;
        const rheo_real x[9] = {lonely ? 50 : 0, 0, 0, (rheo_real)(lonely ? 0 : .1), 0, 0, (rheo_real).1, 0, 0},
                        v[9] = {0, fall, 0, (rheo_real)(lonely ? 0 : -.01), fall, 0, (rheo_real)-.01, fall, 0};
        rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
        memset(def.gravity, 0, sizeof def.gravity);
        def.fluid.spacing = 0.1;
        def.melting.viscosity = 0;
        def.melting.substeps = 1;
        def.step = 0.1;
        rheo_world *world = world_of(def, 2 + lonely, x, v);
        rheo_error why;
        rheo_result result = RHEO_OK;
        for (int i = 0; i < 30 && result == RHEO_OK; i++)
            result = rheo_world_step(world, &why);
        assert_int_equal(result, RHEO_ERROR_STATE);
        if (!says(why.message, " The largest error of density was 0.") ||
            !says(why.message, lonely ? "(particle 1). More melting.substeps may help"
                                      : "(particle 0). More melting.substeps may help"))
            fail_msg("%s", why.message);
        rheo_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_of_momentum_are_those_of_their_own_loop),
        cmocka_unit_test(momentum_is_kept),
        cmocka_unit_test(metrics_of_progress_are_those_of_the_particles),
        cmocka_unit_test(coinciding_particles_are_parted),
        cmocka_unit_test(heat_is_kept),
        cmocka_unit_test(scenes_have_their_stages_and_fields),
        cmocka_unit_test(frozen_worlds_do_not_move),
        cmocka_unit_test(kept_rows_miss_no_neighbour),
        cmocka_unit_test(all_simd_variants_give_the_same_bits),
        cmocka_unit_test(printed_courant_number_asks_for_absurd_substeps),
        cmocka_unit_test(the_printed_equation_loses_heat),
        cmocka_unit_test(summed_density_is_wrong_at_surfaces),
        cmocka_unit_test(printed_artificial_viscosity_depends_on_units),
        cmocka_unit_test(the_density_that_differs_most_has_a_name_or_none),
        cmocka_unit_test(a_failure_names_the_largest_error_of_density),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
