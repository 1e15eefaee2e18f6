/* The melting model: solvers of viscosity, stiff and degenerate cases, and the choice of substeps. */
#include "melting_support.h"

/* ---- Solvers ---- */

/* A jostled fluid after substeps so short that the solver hardly matters. */
static rheo_world *short_substeps(const char *stress, const char *solver)
{
    rheo_world_def def = melt_def(0.1);
    def.melting.jump_number_max = 20;
    def.melting.tolerance = 1e-6;
    def.melting.substeps = 1;
    def.step = 1e-5;
    set(&def, "melting.stress", stress);
    set(&def, "melting.solver", solver);
    random_state = 5;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    fluid f = lattice(0.1, 5, 5, 5, 0.1);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++) {
        f.temperature[i] = (rheo_real)(0.45 + 0.1 * random_unit());
        for (int axis = 0; axis < 3; axis++)
            f.v[3 * i + axis] = (rheo_real)(random_unit() - 0.5);
    }
    rheo_world *world = melt_of(def, f);
    step(world, 20);
    return world;
}

static double difference(const rheo_world *a, const rheo_world *b)
{
    double square = 0, size = 0;
    for (uint32_t i = 0; i < 3 * a->state.particles; i++) {
        square += pow((double)a->state.velocity[i] - (double)b->state.velocity[i], 2);
        size += pow((double)b->state.velocity[i], 2);
    }
    return sqrt(square / size);
}

static void implicit_is_explicit_for_short_substeps(void **unused)
{
    (void)unused;
    static const char *const STRESS[] = {"pairwise", "nested"};
    rheo_world *world[2][2];
    for (int stress = 0; stress < 2; stress++) {
        world[stress][0] = short_substeps(STRESS[stress], "implicit");
        world[stress][1] = short_substeps(STRESS[stress], "explicit");
        const double apart = difference(world[stress][0], world[stress][1]);
        print_message("implicit against explicit, %s: velocities differ by %.2g\n", STRESS[stress], apart);
        assert_true(apart < 1e-3);
        assert_true(metric(world[stress][0], "iterations") > 0);
        assert_true(metric(world[stress][1], "iterations") == 0);
    }
    /* The two discretisations agree for smooth velocities; these velocities are not smooth. */
    const double forms = difference(world[0][0], world[1][0]);
    assert_true(forms > 1e-3 && forms < 0.2);
    for (int i = 0; i < 4; i++)
        rheo_world_destroy(world[i / 2][i % 2]);
}

/* A jostled fluid on a wall without slip, both with this velocity, which is along the wall. */
static rheo_world *on_moving_wall(const char *stress, const char *solver, const double along[3])
{
    rheo_world_def def = melt_def(0.1);
    def.melting.tolerance = 1e-6;
    def.melting.substeps = 1;
    def.step = 1e-4;
    set(&def, "melting.stress", stress);
    set(&def, "melting.solver", solver);
    random_state = 8;
    add_wall(&def, 0, 0, 0, 1, 2, 2);
    fluid all = lattice(0.1, 6, 6, 6, 0.1);
    fluid f = {.warm = true};
    for (uint32_t i = 0; i < all.count; i++) {
        const double x[3] = {(double)all.x[3 * i] - .3, (double)all.x[3 * i + 1] - .3, (double)all.x[3 * i + 2] - .3};
        if (x[0] + 2 * x[1] + 2 * x[2] < 3 * .03)
            continue;
        add_particle(&f, x[0], x[1], x[2]);
        f.temperature[f.count - 1] = (rheo_real)(0.45 + 0.1 * random_unit());
        for (int axis = 0; axis < 3; axis++)
            f.v[3 * (f.count - 1) + (uint32_t)axis] = (rheo_real)(along[axis] + random_unit() - 0.5);
    }
    release_fluid(&all);
    rheo_world *world = melt_of(def, f);
    for (int axis = 0; axis < 3; axis++)
        rheo__melting_of(world)->wall_velocity[0][axis] = (rheo_real)along[axis];
    step(world, 5);
    return world;
}

/* Fluid on a wall that moves along itself flows as on one at rest, seen from the wall. */
static void flow_does_not_depend_on_the_motion_of_the_frame(void **unused)
{
    (void)unused;
    const double none[3] = {0, 0, 0}, along[3] = {2, 1, -2};
    for (int form = 0; form < 4; form++) {
        const char *stress = form % 2 ? "nested" : "pairwise", *solver = form / 2 ? "explicit" : "implicit";
        rheo_world *rest = on_moving_wall(stress, solver, none), *moving = on_moving_wall(stress, solver, along);
        assert_true(rheo__melting_of(rest)->contacts > 10);
        for (uint32_t i = 0; i < 3 * rest->state.particles; i++)
            moving->state.velocity[i] -= (rheo_real)along[i % 3];
        const double apart = difference(moving, rest);
        print_message("moving frame, %s, %s: velocities differ by %.2g\n", stress, solver, apart);
        assert_true(apart < (IS_FLOAT ? 2e-5 : 1e-8));
        rheo_world_destroy(rest);
        rheo_world_destroy(moving);
    }
}

/* Nested dt K v of jostled velocities by a step with no other force, beside a slanted wall. Returns the number of values. */
static uint32_t viscous_change(uint64_t seed, double *v, double *Kv, uint32_t most)
{
    rheo_world_def def = newtonian_def(0.05, 1);
    set(&def, "melting.stress", "nested");
    set(&def, "melting.solver", "explicit");
    def.gravity[1] = 0;
    def.melting.substeps = 1;
    def.step = 1e-9; /* particles do not move */
    def.melting.alpha = def.melting.beta = def.melting.repulsion = def.melting.xsph = 0;
    def.melting.sound_speed = 1e-3;
    def.melting.viscosity = 0.1 * 0.05 * 0.05 / def.step;
    add_wall(&def, 0, 0, 0, 1, 2, 2);
    random_state = 3;
    fluid all = lattice(0.05, 7, 7, 7, 0.1), f = {0};
    for (uint32_t i = 0; i < all.count; i++) {
        const double x = (double)all.x[3 * i] - .15, y = (double)all.x[3 * i + 1] - .15,
                     z = (double)all.x[3 * i + 2] - .15;
        if (x + 2 * y + 2 * z > 3 * .015)
            add_particle(&f, x, y, z);
    }
    release_fluid(&all);
    random_state = seed;
    for (uint32_t i = 0; i < 3 * f.count; i++)
        f.v[i] = (rheo_real)(random_unit() - 0.5);
    rheo_world *world = melt_of(def, f);
    const uint32_t values = 3 * world->state.particles;
    assert_true(values <= most);
    for (uint32_t i = 0; i < values; i++)
        v[i] = (double)world->state.velocity[i];
    step(world, 1);
    assert_true(rheo__melting_of(world)->contacts > 10);
    for (uint32_t i = 0; i < values; i++)
        Kv[i] = v[i] - (double)world->state.velocity[i];
    rheo_world_destroy(world);
    return values;
}

static double product(const double *a, const double *b, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Walls, too, give to the divergence what they give to the gradient. (Pairwise, K depends on the velocities.) */
static void nested_viscosity_is_symmetric_and_takes_energy(void **unused)
{
    (void)unused;
    enum { MOST = 3 * 7 * 7 * 7 };
    static double a[MOST], b[MOST], Ka[MOST], Kb[MOST];
    const uint32_t count = viscous_change(11, a, Ka, MOST);
    assert_int_equal(viscous_change(12, b, Kb, MOST), count);
    const double aa = product(a, Ka, count), bb = product(b, Kb, count), ab = product(a, Kb, count),
                 ba = product(b, Ka, count), apart = fabs(ab - ba) / sqrt(aa * bb);
    print_message("<a, Ka> %.3g, <a, Kb> %.3g, asymmetry %.2g\n", aa, ab, apart);
    assert_true(aa > 0 && bb > 0 && fabs(ab) > 1e-3 * aa);
    assert_true(apart < (IS_FLOAT ? 1e-6 : 1e-10)); /* particles move by 1e-9 */
}

/* One loop sums the gradients of velocity and temperature and the pressure, each if it is needed. Heat needs its own in any case. */
static void heat_does_not_depend_on_what_else_is_summed(void **unused)
{
    (void)unused;
    enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE };
    static const char *const RHEOLOGY[] = {"newtonian", "jump"}; /* jump needs the gradient of velocity */
    static double first[COUNT];
    for (int k = 0; k < 4; k++) {
        rheo_world_def def = melt_def(0.05);
        set(&def, "melting.rheology", RHEOLOGY[k % 2]);
        def.gravity[1] = 0;
        def.melting.substeps = 1;
        def.step = 1e-9; /* particles do not move */
        def.melting.alpha = def.melting.beta = k / 2 ? 0.1 : 0;
        def.melting.sound_speed = 1e-3;
        def.melting.diffusivity = 0.5 * 0.05 * 0.05 / def.step;
        random_state = 9;
        fluid f = lattice(0.05, SIDE, SIDE, SIDE, 0.1);
        f.warm = true;
        double before[COUNT], most = 0;
        for (uint32_t i = 0; i < COUNT; i++) {
            before[i] = 0.2 + 0.6 * random_unit();
            f.temperature[i] = (rheo_real)before[i];
            for (int axis = 0; axis < 3; axis++)
                f.v[3 * i + (uint32_t)axis] = (rheo_real)(random_unit() - 0.5);
        }
        rheo_world *world = melt_of(def, f);
        step(world, 1);
        for (uint32_t i = 0; i < COUNT; i++) {
            const double now = (double)world->state.temperature[i];
            most = fmax(most, fabs(now - before[i]));
            first[i] = k ? first[i] : now;
            assert_true(fabs(now - first[i]) < (IS_FLOAT ? 1e-6 : 1e-14));
        }
        assert_true(most > 0.1);
        rheo_world_destroy(world);
    }
}

/* Whether jostled velocities grow under explicit viscosity and no other force, with a substep of `number` h^2/nu. */
static bool explicit_grows(const char *stress, double number)
{
    rheo_world_def def = newtonian_def(0.05, 1);
    set(&def, "melting.stress", stress);
    set(&def, "melting.solver", "explicit");
    def.gravity[1] = 0;
    def.melting.substeps = 1;
    def.step = 1e-9; /* particles do not move */
    def.melting.alpha = def.melting.beta = def.melting.repulsion = def.melting.xsph = 0;
    def.melting.sound_speed = 1e-3;
    def.melting.viscosity = number * 0.05 * 0.05 / def.step;
    random_state = 1;
    fluid f = lattice(0.05, 10, 10, 10, 0);
    for (uint32_t i = 0; i < 3 * f.count; i++)
        f.v[i] = (rheo_real)(random_unit() - 0.5);
    rheo_world *world = melt_of(def, f);
    const double before = metric(world, "kinetic_energy");
    bool grows = false;
    for (int s = 0; s < 150 && !grows; s++) {
        step(world, 1);
        grows = metric(world, "kinetic_energy") > 1.5 * before;
    }
    rheo_world_destroy(world);
    return grows;
}

/* The largest number that does not make them grow, by bisection. */
static double explicit_limit(const char *stress)
{
    double low = 0.05, high = 3;
    while (high / low > 1.02) {
        const double middle = sqrt(low * high);
        if (explicit_grows(stress, middle))
            high = middle;
        else
            low = middle;
    }
    print_message("explicit, %s: velocities grow at dt nu/h^2 > %.3f\n", stress, low);
    return low;
}

static void explicit_viscosity_has_its_limits(void **unused)
{
    (void)unused;
    NEAR(explicit_limit("pairwise"), 0.19, 0.02);
    NEAR(explicit_limit("nested"), 0.47, 0.07);
}

/* The Courant number keeps explicit substeps below a third of the limit. */
static void explicit_substeps_are_stable(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.jump_number_max = 20;
    set(&def, "melting.solver", "explicit");
    rheo_world *world = melting_box(def, 4, 10, 4);
    double most = 0;
    for (int s = 0; s < 50; s++) {
        step(world, 1);
        most = fmax(most, fastest(world));
    }
    assert_true(most < 1);
    assert_true(metric(world, "substeps") > 20);
    rheo_world_destroy(world);
}

/* Viscosities from 0 to overflow are solved or refused, and never ignored. */
static void viscosities_of_all_sizes_are_solved_or_refused(void **unused)
{
    (void)unused;
    static const struct {
        const char *viscosity;
        bool solved;
    } trials[] = {{"0.05", true}, {"0", true}, {"1e-45", true}, {"1e-30", true}, {"1e15", true}, {"1e30", false}};
    for (int walls = 0; walls < 2; walls++)
        for (size_t t = 0; t < sizeof trials / sizeof *trials; t++) {
            rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
            def.melting.rheology = RHEO_RHEOLOGY_NEWTONIAN;
            def.walls.plane = some_walls();
            def.walls.count = (uint32_t)walls;
            walls_of(&def)[0] = (rheo_wall){{0, -1, 0}, {0, 1, 0}};
            rheo_world *world = melt_of(def, lattice(def.fluid.spacing, 4, 4, 4, 0));
            OK(rheo_world_set(world, "melting.viscosity", trials[t].viscosity, &error));
            if (!trials[t].solved) /* uneven velocities for viscosity to act on */
                world->state.velocity[0] = 1;
            rheo_error why = {""};
            const rheo_result result = rheo_world_step(world, &why);
            if (trials[t].solved) {
                OK(result);
                NEAR((double)world->state.velocity[1], -world->def.step, 0.02 * world->def.step); /* free fall */
            } else if (!RHEO_DOUBLE) {
                assert_int_equal(result, RHEO_ERROR_STATE);
                assert_non_null(strstr(why.message, "viscosity takes the velocities beyond"));
            }
            rheo_world_destroy(world);
        }
}

/* A melting band that ends before it begins could not be loaded again. */
static void commands_do_not_contradict_other_parameters(void **unused)
{
    (void)unused;
    rheo_world *world = melting_box(rheo_default_model_def(RHEO_MODEL_MELTING), 3, 3, 3);
    REFUSED(RHEO_ERROR_ARGUMENT, "melting must end above where it begins",
            rheo_world_set(world, "melting.temperature_min", "0.6", &error));
    OK(rheo_world_set(world, "melting.temperature_max", "0.7", &error));
    OK(rheo_world_set(world, "melting.temperature_min", "0.6", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "choose another unit of length",
            rheo_world_set(world, "melting.smoothing_length", RHEO_DOUBLE ? "1e-13" : "1e-8", &error));
    rheo_world_destroy(world);
}

static void iterations_have_a_cap(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.tolerance = 1e-12;
    def.melting.max_iterations = 3;
    rheo_world *world = melting_box(def, 4, 10, 4);
    for (int s = 0; s < 20; s++) {
        step(world, 1);
        assert_true(metric(world, "iterations") == 3 * metric(world, "substeps"));
    }
    assert_true(fastest(world) < 0.5);
    rheo_world_destroy(world);
}

/* A cold beam that falls onto two blocks and bends, which is hard for the solver. */
static rheo_world *bending_beam(void)
{
    rheo_world_def def = melt_def(0.1);
    def.melting.substeps = 1;
    def.step = 2e-3;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    fluid f = {0};
    add_lattice(&f, 0.1, (double[]){0, 0.05, 0}, 2, 2, 4, 0);
    add_lattice(&f, 0.1, (double[]){1.6, 0.05, 0}, 2, 2, 4, 0);
    add_lattice(&f, 0.1, (double[]){0, 0.25, 0}, 18, 3, 4, 0);
    return melt_of(def, f);
}

static rheo_world *copy_of(const rheo_world *world)
{
    void *bytes;
    size_t size;
    rheo_recording *recording;
    rheo_world *copy;
    OK(rheo_world_save_memory(world, "copy", &bytes, &size, &error));
    OK(rheo_recording_open_memory(bytes, size, &recording, &error));
    OK(rheo_recording_world(recording, *world->state.step, NULL, &copy, &error));
    rheo_recording_close(recording);
    free(bytes);
    return copy;
}

/* The error of velocities is below the tolerance times their change, whatever the residual is. */
static void the_tolerance_limits_the_error(void **unused)
{
    (void)unused;
    rheo_world *world = bending_beam();
    double largest = 0;
    for (int s = 0; s < 60; s++) {
        rheo_world *exact = copy_of(world), *before = copy_of(world);
        OK(rheo_world_set(exact, "melting.tolerance", "1e-6", &error));
        OK(rheo_world_set(exact, "melting.max_iterations", "1000", &error));
        step(exact, 1);
        step(world, 1);
        double wrong = 0, change = 0;
        for (uint32_t i = 0; i < 3 * world->state.particles; i++) {
            wrong += pow((double)world->state.velocity[i] - (double)exact->state.velocity[i], 2);
            change += pow((double)exact->state.velocity[i] - (double)before->state.velocity[i], 2);
        }
        largest = fmax(largest, sqrt(wrong / change));
        rheo_world_destroy(exact);
        rheo_world_destroy(before);
    }
    print_message("largest error of a substep: %.2g of the change\n", largest);
    assert_true(largest < 2 * 3e-3); /* the estimate of the error is no bound */
    rheo_world_destroy(world);
}

/* A prediction that is part of the state spares the first substep of a step most of its iterations. */
static void a_prediction_outlasts_its_step(void **unused)
{
    (void)unused;
    rheo_world *world[] = {bending_beam(), bending_beam()};
    double iterations[2] = {0, 0};
    for (int s = 0; s < 60; s++)
        for (int without = 0; without < 2; without++) {
            rheo__state *state = &world[without]->state;
            if (without)
                memset(state->predicted_acceleration, 0, 3 * state->particles * sizeof(rheo_real));
            step(world[without], 1);
            iterations[without] += metric(world[without], "iterations");
        }
    print_message("%g iterations with predictions, %g without\n", iterations[0], iterations[1]);
    assert_true(iterations[0] < 0.7 * iterations[1]);
    rheo_world_destroy(world[0]);
    rheo_world_destroy(world[1]);
}

/* ---- Hard cases ---- */

static void jump_numbers_up_to_a_million(void **unused)
{
    (void)unused;
    double moved = 1;
    for (double jump = 1; jump <= 1e6; jump *= 100) {
        rheo_world_def def = melt_def(0.0625);
        def.melting.jump_number_max = jump;
        rheo_world *world = melting_box(def, 4, 16, 4);
        double iterations = 0, most = 0;
        for (int s = 0; s < 50; s++) {
            step(world, 1);
            iterations = fmax(iterations, metric(world, "iterations") / metric(world, "substeps"));
            most = fmax(most, fastest(world));
        }
        assert_true(iterations < 30);
        assert_true(most < 1.2);
        assert_true(metric(world, "cold_displacement") < moved); /* a larger J moves less */
        moved = metric(world, "cold_displacement");
        rheo_world_destroy(world);
    }
    print_message("J = 1e6: the cold part has moved by %.2g in a time of 1\n", moved);
    assert_true(moved < 2e-4);
}

/* The yield stress mu/t0 is far below the weight, so cold material flows for any J. */
static void weak_solids_flow(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.viscosity = 1e-4;
    rheo_world *world = melting_box(def, 4, 10, 4);
    step(world, 100);
    assert_true(metric(world, "cold_displacement") > 0.3);
    assert_true(fastest(world) < 3);
    assert_true(lowest(world, 1) >= 0);
    rheo_world_destroy(world);
}

static void coinciding_particles_separate(void **unused)
{
    (void)unused;
    for (int count = 2; count <= 20; count += 18) {
        rheo_world_def def = melt_def(0.05);
        def.gravity[1] = 0;
        def.melting.temperature = 1;
        fluid f = {0};
        for (int i = 0; i < count; i++)
            add_particle(&f, 0.3, 0.4, 0.5);
        rheo_world *world = melt_of(def, f);
        step(world, 3);
        double sum[3];
        momentum_of(world, sum);
        for (int axis = 0; axis < 3; axis++) {
            NEAR(sum[axis] / count, 0, 1e-5);
            assert_true(highest(world, axis) > lowest(world, axis));
        }
        for (int i = 0; i < count; i++)
            for (int j = 0; j < i; j++)
                assert_memory_not_equal(world->state.position + 3 * i, world->state.position + 3 * j,
                                        3 * sizeof(rheo_real));
        rheo_world_destroy(world);
    }
}

static void few_particles(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.05);
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    rheo_world *none = melt_of(def, (fluid){0});
    step(none, 3);
    assert_true(metric(none, "substeps") == 10); /* 0.02/(0.4 x 0.05/10) */
    rheo_world_destroy(none);
    def.melting.temperature = 1;
    fluid f = {0};
    add_particle(&f, 0, 0.4, 0);
    rheo_world *one = melt_of(def, f);
    step(one, 25);
    NEAR((double)one->state.position[1], 0.4 - 0.125, 2e-3); /* free fall */
    step(one, 100);
    assert_true(one->state.position[1] >= 0 && one->state.position[1] < 0.1);
    assert_true(fastest(one) < 0.05);
    rheo_world_destroy(one);
}

static void blobs_collide(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.05);
    def.gravity[1] = 0;
    def.melting.temperature = 1;
    fluid f = {0};
    add_lattice(&f, 0.05, (double[]){0, 0, 0}, 6, 6, 6, 0);
    add_lattice(&f, 0.05, (double[]){0.5, 0.05, 0}, 6, 6, 6, 0);
    for (uint32_t i = 0; i < f.count; i++)
        f.v[3 * i] = i < f.count / 2 ? (rheo_real)0.5 : (rheo_real)-0.5;
    rheo_world *world = melt_of(def, f);
    const double before = metric(world, "kinetic_energy");
    double error = 0, sum[3];
    for (int s = 0; s < 75; s++) {
        step(world, 1);
        error = fmax(error, metric(world, "max_density_error"));
    }
    momentum_of(world, sum);
    NEAR(sum[0] / world->state.particles, 0, 1e-6);
    assert_true(metric(world, "kinetic_energy") < 0.2 * before);
    assert_true(error < 0.1);
    assert_true(highest(world, 0) - lowest(world, 0) < 0.6); /* merged into one body */
    rheo_world_destroy(world);
}

static void keep_message(const char *message, void *user)
{
    snprintf(user, 300, "%s", message);
}

static void too_slow_sound_is_warned_of(void **unused)
{
    (void)unused;
    char said[300] = "";
    rheo_world_def def = melt_def(0.125);
    def.log.message = keep_message;
    def.log.user = said;
    rheo_world_destroy(melting_box(def, 3, 9, 3)); /* 1 deep from the first to the last particle */
    assert_string_equal(said, "");
    def.melting.sound_speed = 5;
    rheo_world_destroy(melting_box(def, 3, 9, 3));
    assert_non_null(strstr(said, "melting.sound_speed is too small for the depth of this fluid"));
    assert_non_null(strstr(said, "compresses it by 4 %"));
    said[0] = 0;
    def.melting.flow = RHEO_FLOW_FROZEN; /* a frozen fluid is not compressed */
    rheo_world_destroy(melting_box(def, 3, 9, 3));
    assert_string_equal(said, "");
}

static void too_many_substeps_are_refused(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.max_substeps = 20;
    rheo_world *world = melting_box(def, 3, 6, 3);
    step(world, 2);
    const uint64_t before = rheo_world_hash(world);
    OK(rheo_world_set(world, "melting.sound_speed", "1000", &error));
    REFUSED(RHEO_ERROR_STATE, "it would need 50", rheo_world_step(world, &error));
    REFUSED(RHEO_ERROR_STATE, "melting.max_substeps is 20;", rheo_world_step(world, &error));
    assert_true(rheo_world_hash(world) == before);
    rheo_failure failure;
    assert_true(rheo_world_failure(world, &failure));
    assert_string_equal(failure.stage, "substeps");
    OK(rheo_world_set(world, "melting.sound_speed", "10", &error));
    step(world, 1);
    rheo_world_destroy(world);
}

/* Of equally fast particles it is the first one. */
static void the_fastest_particle_needs_the_most_substeps(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.max_substeps = 1;
    rheo_world *world = melting_box(def, 3, 6, 3);
    static const uint32_t fast[] = {0, 5, 17};
    for (size_t k = 0; k <= sizeof fast / sizeof *fast; k++) {
        if (k > 0)
            world->state.velocity[3 * fast[k - 1] + k - 1] = -(rheo_real)(2 * k);
        REFUSED(RHEO_ERROR_STATE, "stage substeps", rheo_world_step(world, &error));
        rheo_failure failure;
        assert_true(rheo_world_failure(world, &failure));
        assert_string_equal(failure.field, "velocity");
        assert_int_equal(failure.id, k > 0 ? fast[k - 1] : 0);
    }
    rheo_world_destroy(world);
}

static void substeps_may_be_fixed(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.substeps = 13;
    def.melting.max_substeps = 5; /* limits chosen substeps only */
    rheo_world *world = melting_box(def, 3, 6, 3);
    for (int s = 0; s < 5; s++) {
        step(world, 1);
        assert_true(metric(world, "substeps") == 13);
    }
    rheo_world_destroy(world);
}

/* Heat that diffuses faster than sound requires its own substeps, and evens out. */
static void huge_diffusivity_is_stable(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.diffusivity = 10;
    rheo_world *world = melting_box(def, 4, 8, 4);
    const double before = heat_of(world);
    step(world, 5);
    assert_true(metric(world, "substeps") == 200);
    NEAR(heat_of(world) / before, 1, IS_FLOAT ? 1e-5 : 1e-12);
    for (uint32_t i = 0; i < world->state.particles; i++)
        NEAR((double)world->state.temperature[i], 0.5, 1e-3);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(implicit_is_explicit_for_short_substeps),
        cmocka_unit_test(flow_does_not_depend_on_the_motion_of_the_frame),
        cmocka_unit_test(nested_viscosity_is_symmetric_and_takes_energy),
        cmocka_unit_test(heat_does_not_depend_on_what_else_is_summed),
        cmocka_unit_test(explicit_viscosity_has_its_limits),
        cmocka_unit_test(explicit_substeps_are_stable),
        cmocka_unit_test(viscosities_of_all_sizes_are_solved_or_refused),
        cmocka_unit_test(commands_do_not_contradict_other_parameters),
        cmocka_unit_test(iterations_have_a_cap),
        cmocka_unit_test(the_tolerance_limits_the_error),
        cmocka_unit_test(a_prediction_outlasts_its_step),
        cmocka_unit_test(jump_numbers_up_to_a_million),
        cmocka_unit_test(weak_solids_flow),
        cmocka_unit_test(coinciding_particles_separate),
        cmocka_unit_test(few_particles),
        cmocka_unit_test(blobs_collide),
        cmocka_unit_test(too_slow_sound_is_warned_of),
        cmocka_unit_test(too_many_substeps_are_refused),
        cmocka_unit_test(the_fastest_particle_needs_the_most_substeps),
        cmocka_unit_test(substeps_may_be_fixed),
        cmocka_unit_test(huge_diffusivity_is_stable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
