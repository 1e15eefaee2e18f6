/*
 * What each stage keeps, makes and loses: momentum, angular momentum, energy, heat. docs/hard-cases.md lists the figures.
 * Energies are kinetic ones, of particles and ball.
 */
#include "melting_support.h"

#include "melting.h"

/* Half of the last bit of 1. */
static const double ROUNDING = RHEO_DOUBLE ? 0x1p-53 : 0x1p-24;
/* What the totals themselves round: a sum in double of 3 products for each of up to 216 particles. */
static const double SUMMING = 6 * 216 * 0x1p-53;

/* ---- Totals of a state, and their changes by stages ---- */

/* Particles of the thickening model have mass 1; those of the melting model count as such. */
typedef struct totals {
    double momentum[3], spin[3], energy;
    double speeds, places, moments; /* sums of |v|, of |x| and of |x| |v| */
} totals;

static void add_body(totals *t, double mass, const double x[3], const double v[3])
{
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        t->momentum[a] += mass * v[a];
        t->spin[a] += mass * (x[b] * v[c] - x[c] * v[b]);
        t->energy += mass / 2 * v[a] * v[a];
    }
    const double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double away = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    t->speeds += mass * speed;
    t->places += mass * away;
    t->moments += mass * speed * away;
}

static totals totals_of(const rheo_world *world)
{
    totals t = {0};
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    for (size_t i = 0; i < rheo_world_particle_count(world); i++)
        add_body(&t, 1, (double[]){(double)x[3 * i], (double)x[3 * i + 1], (double)x[3 * i + 2]},
                 (double[]){(double)v[3 * i], (double)v[3 * i + 1], (double)v[3 * i + 2]});
    if (rheo_world_body_count(world)) {
        rheo_body ball;
        OK(rheo_world_body(world, 0, &ball));
        add_body(&t, ball.mass, ball.position, ball.velocity);
        for (int a = 0; a < 3; a++) {
            const double inertia = 0.4 * ball.mass * ball.radius * ball.radius;
            t.spin[a] += inertia * ball.spin[a];
            t.energy += inertia / 2 * ball.spin[a] * ball.spin[a];
        }
    }
    return t;
}

/* Largest changes in a run of a stage; `made` and `lost` of energy, relative to the energy at the start of the run. */
typedef struct stage_changes {
    char name[32];
    uint32_t runs;
    double momentum, spin, made, lost;
} stage_changes;

enum { MOST_STAGES = 24 };

static double largest(const double a[3], const double b[3])
{
    double most = 0;
    for (int axis = 0; axis < 3; axis++)
        most = fmax(most, fabs(a[axis] - b[axis]));
    return most;
}

/* Called before and after each run of a stage; NULL: nothing. */
typedef void hook(rheo_world *world, const char *stage, const totals *before, const totals *after);

static void follow(rheo_world *world, int steps, stage_changes changes[MOST_STAGES], hook *check)
{
    memset(changes, 0, MOST_STAGES * sizeof *changes);
    assert_true(rheo_world_stage_count(world) <= MOST_STAGES);
    const uint64_t end = rheo_world_step_count(world) + (uint64_t)steps;
    totals before = totals_of(world);
    while (rheo_world_step_count(world) < end) {
        uint32_t stage;
        rheo_stage_info info;
        OK(rheo_world_step_stage(world, &stage, &error));
        OK(rheo_world_stage(world, stage, &info));
        const totals after = totals_of(world);
        stage_changes *c = &changes[stage];
        snprintf(c->name, sizeof c->name, "%s", info.name);
        c->runs++;
        c->momentum = fmax(c->momentum, largest(after.momentum, before.momentum) / fmax(before.speeds, after.speeds));
        c->spin = fmax(c->spin, largest(after.spin, before.spin) / fmax(before.moments, after.moments));
        c->made = fmax(c->made, after.energy / before.energy - 1);
        c->lost = fmax(c->lost, 1 - after.energy / before.energy);
        if (check)
            check(world, info.name, &before, &after);
        before = after;
    }
}

static void print_changes(const char *what, const stage_changes *changes)
{
    for (int i = 0; i < MOST_STAGES; i++)
        if (changes[i].runs)
            print_message("%s, %s: momentum %.2g, angular momentum %.2g, energy +%.2g -%.2g\n", what, changes[i].name,
                          changes[i].momentum, changes[i].spin, changes[i].made, changes[i].lost);
}

/* ---- Free bodies ---- */

enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE };

/* A block of the thickening model that jostles in free space, with springs, history and viscosity. */
static rheo_world_def jostling(rheo_scheme scheme, rheo_real *x, rheo_real *v)
{
    rheo_world_def def = rheo_default_world_def();
    def.scheme = scheme;
    memset(def.gravity, 0, sizeof def.gravity);
    random_state = 3;
    for (int i = 0; i < COUNT; i++)
        for (int axis = 0; axis < 3; axis++) {
            const int place = axis == 0 ? i % SIDE : axis == 1 ? i / SIDE % SIDE : i / SIDE / SIDE;
            x[3 * i + axis] = (rheo_real)(2 * place - SIDE + 1 + 0.4 * (random_unit() - 0.5));
            v[3 * i + axis] = (rheo_real)(4 * (random_unit() - 0.5));
        }
    for (int i = 0; i < COUNT; i++) { /* turns about y */
        v[3 * i] += x[3 * i + 2] / 2;
        v[3 * i + 2] -= x[3 * i] / 2;
    }
    return def;
}

static rheo_world *jostling_world(int scheme, const rheo_world_def *changes)
{
    static rheo_real x[3 * COUNT], v[3 * COUNT];
    rheo_world_def def = jostling((rheo_scheme)scheme, x, v);
    if (changes) {
        def.step = changes->step;
        def.positions = changes->positions;
    }
    return world_of(def, COUNT, x, v);
}

/* A block of the melting model that jostles, turns and melts in free space. */
static rheo_world *jostling_melt(rheo_world_def def)
{
    def.gravity[1] = 0;
    def.melting.jump_number_max = 50;
    random_state = 3;
    fluid f = lattice(def.fluid.spacing, SIDE, SIDE, SIDE, 0.1);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++) {
        f.temperature[i] = (rheo_real)random_unit();
        for (int axis = 0; axis < 3; axis++) {
            f.x[3 * i + axis] -= (rheo_real)(SIDE / 2 * def.fluid.spacing);
            f.v[3 * i + axis] = (rheo_real)(0.4 * (random_unit() - 0.5));
        }
        f.v[3 * i] += f.x[3 * i + 2];
        f.v[3 * i + 2] -= f.x[3 * i];
    }
    return melt_of(def, f);
}

static const char *const SCHEMES[] = {"summed", "sequential", "positions"};
static const char *const MELTS[] = {"pairwise", "nested", "explicit"};

static rheo_world_def melt_variant(int variant)
{
    rheo_world_def def = melt_def(0.1);
    def.melting.stress = variant == 1 ? RHEO_STRESS_NESTED : RHEO_STRESS_PAIRWISE;
    def.melting.solver = variant == 2 ? RHEO_VISCOSITY_EXPLICIT : RHEO_VISCOSITY_IMPLICIT;
    return def;
}

static const stage_changes *changes_of(const stage_changes *changes, const char *name)
{
    for (int i = 0; i < MOST_STAGES; i++)
        if (changes[i].runs && strcmp(changes[i].name, name) == 0)
            return &changes[i];
    fail_msg("stage %s did not run", name);
    return NULL;
}

/* ---- Momentum ---- */

/*
 * Impulses of a pair are opposite, so a stage makes momentum only where it adds n of them to a velocity: at most n + 1
 * roundings. Stage velocity of scheme sequential divides differences of positions by the step. The solver of the melting
 * model adds as often as it iterates.
 */
static void no_stage_makes_momentum(void **unused)
{
    (void)unused;
    stage_changes changes[MOST_STAGES];
    for (int scheme = 0; scheme < 3; scheme++) {
        rheo_world *world = jostling_world(scheme, NULL);
        const totals start = totals_of(world);
        follow(world, 100, changes, NULL);
        const totals end = totals_of(world);
        const double pairs = rheo_world_mean_neighbours(world) + 1, step = rheo_world_definition(world)->step;
        const double of_places = scheme == 1 ? 2 * ROUNDING * end.places / (step * end.speeds) : 0;
        assert_true(pairs > 10);
        print_changes(SCHEMES[scheme], changes);
        for (int i = 0; i < MOST_STAGES; i++)
            assert_true(changes[i].momentum <= pairs * ROUNDING + 2 * of_places + SUMMING);
        const double all = largest(end.momentum, start.momentum) / start.speeds;
        print_message("%s: momentum changed by %.2g of the sum of |v| in 100 steps\n", SCHEMES[scheme], all);
        assert_true(all <= 100 * (pairs * ROUNDING + 2 * of_places));
        rheo_world_destroy(world);
    }
    for (int variant = 0; variant < 3; variant++) {
        rheo_world *world = jostling_melt(melt_variant(variant));
        const totals start = totals_of(world);
        follow(world, 20, changes, NULL);
        const double pairs = rheo_world_mean_neighbours(world) + 1, iterations = variant == 2 ? 0 : 100;
        print_changes(MELTS[variant], changes);
        for (int i = 0; i < MOST_STAGES; i++)
            assert_true(changes[i].momentum <= (pairs + iterations) * ROUNDING + SUMMING);
        const double all = largest(totals_of(world).momentum, start.momentum) / start.speeds;
        print_message("%s: momentum changed by %.2g of the sum of |v| in 20 steps\n", MELTS[variant], all);
        assert_true(all <= (pairs + iterations) * ROUNDING * changes_of(changes, "momentum")->runs);
        rheo_world_destroy(world);
    }
}

/* ---- Angular momentum ---- */

static double *velocities_before; /* of the particles, before the stage that runs next */
static double largest_difference; /* of the angular momentum to the closed form, relative to the sum of |x| |v| */
static double one_substep;

/*
 * A stage that displaces along central forces, v += dv, x += t dv, changes the angular momentum by the sum of
 * t dv x v: the forces are central where particles were, not where they go.
 */
static void check_displacement(rheo_world *world, const char *stage, const totals *before, const totals *after)
{
    const size_t count = rheo_world_particle_count(world);
    const rheo_real *now = rheo_world_velocities(world);
    if (strcmp(stage, "forces") == 0 || strcmp(stage, "density_constraint") == 0) {
        double made[3] = {0, 0, 0};
        for (size_t i = 0; i < count; i++) {
            const double *v = velocities_before + 3 * i;
            const double d[3] = {(double)now[3 * i] - v[0], (double)now[3 * i + 1] - v[1],
                                 (double)now[3 * i + 2] - v[2]};
            for (int a = 0; a < 3; a++) {
                const int b = (a + 1) % 3, c = (a + 2) % 3;
                made[a] += one_substep * (d[b] * v[c] - d[c] * v[b]);
            }
        }
        double expected[3];
        for (int a = 0; a < 3; a++)
            expected[a] = before->spin[a] + made[a];
        largest_difference = fmax(largest_difference, largest(after->spin, expected) / after->moments);
    }
    for (size_t i = 0; i < 3 * count; i++)
        velocities_before[i] = (double)now[i];
}

/*
 * Forces of the thickening model make angular momentum only by their displacements: as the closed form says, to rounding.
 * In a given time that is a sum of the first order in the step, but in scheme positions, where a shorter step makes another
 * fluid. Viscosity, gravity and prediction keep it. Viscosity of scheme positions is not central: it takes angular momentum.
 */
static void displacements_make_angular_momentum(void **unused)
{
    (void)unused;
    stage_changes changes[MOST_STAGES];
    velocities_before = calloc((size_t)3 * COUNT, sizeof *velocities_before);
    assert_non_null(velocities_before);
    for (int scheme = 0; scheme < 3; scheme++) {
        double lost[3];
        for (int fine = 0; fine < 3; fine++) {
            rheo_world_def def = rheo_default_world_def();
            def.step /= 1 << fine;
            def.positions.iterations = 1;
            def.positions.viscosity = 0;
            rheo_world *world = jostling_world(scheme, &def);
            if (scheme == 0)
                OK(rheo_world_set(world, "substeps", "4", &error));
            const totals start = totals_of(world);
            for (size_t i = 0; i < 3 * COUNT; i++)
                velocities_before[i] = (double)rheo_world_velocities(world)[i];
            largest_difference = 0;
            one_substep = scheme == 0 ? def.step / 4 : def.step;
            follow(world, 10 << fine, changes, check_displacement);
            const totals end = totals_of(world);
            lost[fine] = largest(end.spin, start.spin) / start.moments;
            const double pairs = rheo_world_mean_neighbours(world) + 1;
            /* A displacement rounds positions, so velocity times position is rounded once more. */
            if (scheme != 1)
                assert_true(largest_difference <= 2 * pairs * ROUNDING + SUMMING);
            assert_true(changes_of(changes, "prediction")->spin <= 2 * ROUNDING + SUMMING);
            if (scheme != 2)
                assert_true(changes_of(changes, "viscosity")->spin <= pairs * ROUNDING + SUMMING);
            rheo_world_destroy(world);
        }
        print_message(
            "%s: angular momentum changed by %.2g, %.2g, %.2g of the sum of |x| |v| in 10, 20, 40 steps of a time of "
            "0.33\n",
            SCHEMES[scheme], lost[0], lost[1], lost[2]);
        assert_true(lost[0] < 0.05 && (scheme == 2 ? lost[2] < 0.05 : lost[2] < lost[0] / 1.5));
    }
    double spin[2];
    for (int viscous = 0; viscous < 2; viscous++) {
        rheo_world_def def = rheo_default_world_def();
        def.positions.viscosity = viscous;
        rheo_world *world = jostling_world(2, &def);
        const double before = totals_of(world).spin[1];
        follow(world, 20, changes, NULL);
        spin[viscous] = totals_of(world).spin[1] / before;
        rheo_world_destroy(world);
    }
    print_message("positions: %.3f of the spin is left after 20 steps with viscosity 1, %.3f without\n", spin[1],
                  spin[0]);
    assert_true(fabs(spin[0] - 1) < 0.05 && spin[1] > 0.5 && spin[1] < spin[0] - 0.02);
    free(velocities_before);
}

/*
 * In the melting model no force displaces, so angular momentum changes by rounding only, and in the implicit solver by what
 * its tolerance leaves. Drift is the same for both particles of a pair, so it makes none.
 */
static void melts_keep_angular_momentum(void **unused)
{
    (void)unused;
    static const double tolerances[] = {3e-3, 1e-5};
    stage_changes changes[MOST_STAGES];
    for (int variant = 0; variant < 3; variant++)
        for (int k = 0; k < (variant == 2 ? 1 : 2); k++) {
            rheo_world_def def = melt_variant(variant);
            def.melting.tolerance = tolerances[k];
            def.melting.max_iterations = 1000;
            rheo_world *world = jostling_melt(def);
            const totals start = totals_of(world);
            follow(world, 10, changes, NULL);
            const double pairs = rheo_world_mean_neighbours(world) + 1;
            const stage_changes *viscous = changes_of(changes, "viscosity");
            const double all = largest(totals_of(world).spin, start.spin) / start.moments;
            print_message("%s, tolerance %g: viscosity changes angular momentum by %.2g at most, all by %.2g\n",
                          MELTS[variant], tolerances[k], viscous->spin, all);
            assert_true(changes_of(changes, "momentum")->spin <= pairs * ROUNDING + SUMMING);
            assert_true(changes_of(changes, "integration")->spin <= 4 * ROUNDING + SUMMING);
            if (variant == 2)
                assert_true(viscous->spin <= pairs * ROUNDING + SUMMING);
            else
                assert_true(viscous->spin <= tolerances[k] / 3 + (pairs + 1000) * ROUNDING / 10);
            rheo_world_destroy(world);
        }
}

/* ---- Energy ---- */

/* Stages that cannot make kinetic energy, at rest of what they touch; gravity, forces and vibrators can. */
static bool is_passive(const char *stage)
{
    static const char *const passive[] = {"viscosity", "ball",       "walls",     "rates",   "integration",
                                          "history",   "prediction", "densities", "springs", "spring_displacement",
                                          "density",   "multiplier", "substeps"};
    for (size_t i = 0; i < sizeof passive / sizeof *passive; i++)
        if (strcmp(stage, passive[i]) == 0)
            return true;
    return false;
}

/*
 * Passive stages never make kinetic energy: viscosity, contact and friction of the ball, walls at rest, and those that move
 * particles or flow rest lengths only. The implicit solver of the melting model may leave an error of the tolerance times
 * the velocity change, which is below the velocity.
 */
static void passive_stages_make_no_energy(void **unused)
{
    (void)unused;
    stage_changes changes[MOST_STAGES];
    for (int scene = 0; scene < 10; scene++) {
        rheo_world *world;
        const bool melts = scene >= 6;
        if (scene < 3) {
            world = jostling_world(scene, NULL);
        } else if (scene < 6) { /* a ball falls into a pool between walls */
            rheo_scene lively = lively_scene();
            lively.world.scheme = (rheo_scheme)(scene - 3);
            lively.world.vibrators.count = 0;
            lively.world.ball.spin[0] = 3;
            OK(rheo_scene_create_world(&lively, &world, &error));
        } else if (scene < 9) {
            world = jostling_melt(melt_variant(scene - 6));
        } else {
            rheo_real values[7 * 125];
            const rheo_world_def def = melting_def(5, values);
            OK(rheo_world_create(&def, &world, &error));
        }
        follow(world, 20, changes, NULL);
        const double pairs = rheo_world_mean_neighbours(world) + 1;
        double lost = 0;
        for (int i = 0; i < MOST_STAGES; i++) {
            if (!changes[i].runs || !is_passive(changes[i].name))
                continue;
            lost = fmax(lost, changes[i].lost);
            assert_true(changes[i].made <= (melts ? 3e-3 : 0) + 2 * pairs * ROUNDING);
        }
        assert_true(lost > 0.01);
        if (scene == 0) /* what a stage makes is found */
            assert_true(changes_of(changes, "forces")->made > 0.01);
        if (scene >= 3 && scene < 6)
            assert_true(changes_of(changes, "gravity")->momentum > 0.01);
        rheo_world_destroy(world);
    }
}

/* Square of the difference of the length of each spring to its rest length. */
static size_t stretches(const rheo_world *world, rheo_spring *spring, double *square)
{
    const size_t count = rheo_world_spring_count(world);
    const rheo_real *x = rheo_world_positions(world);
    OK(rheo_world_springs(world, spring, count));
    for (size_t k = 0; k < count; k++) {
        double r2 = 0;
        for (int axis = 0; axis < 3; axis++)
            r2 += pow((double)x[3 * spring[k].a + axis] - (double)x[3 * spring[k].b + axis], 2);
        square[k] = pow(sqrt(r2) - (double)spring[k].rest_length, 2);
    }
    return count;
}

/* Rest lengths flow towards lengths, so plasticity takes energy from every spring and gives none to any. */
static void plasticity_makes_no_energy(void **unused)
{
    (void)unused;
    enum { MOST = COUNT * 40 };
    rheo_spring *spring[2];
    double *square[2];
    for (int k = 0; k < 2; k++) {
        spring[k] = malloc(MOST * sizeof **spring);
        square[k] = malloc(MOST * sizeof **square);
        assert_true(spring[k] && square[k]);
    }
    for (int scheme = 0; scheme < 2; scheme++) {
        rheo_world *world = jostling_world(scheme, NULL);
        step(world, 5);
        double taken = 0, all = 0;
        size_t flowed = 0;
        while (rheo_world_step_count(world) < 15) {
            assert_true(rheo_world_spring_count(world) < MOST);
            const size_t before = stretches(world, spring[0], square[0]);
            uint32_t stage;
            rheo_stage_info info;
            OK(rheo_world_step_stage(world, &stage, &error));
            OK(rheo_world_stage(world, stage, &info));
            if (strcmp(info.name, scheme == 0 ? "densities" : "springs") != 0)
                continue;
            assert_true(rheo_world_spring_count(world) < MOST);
            const size_t after = stretches(world, spring[1], square[1]);
            for (size_t i = 0, j = 0; i < before && j < after;) { /* springs that are there before and after */
                const rheo_spring a = spring[0][i], b = spring[1][j];
                const int order = a.a != b.a ? (a.a < b.a ? -1 : 1) : a.b != b.b ? (a.b < b.b ? -1 : 1) : 0;
                if (order == 0) {
                    assert_true(sqrt(square[1][j]) <= sqrt(square[0][i]) + 8 * ROUNDING * (double)a.rest_length);
                    flowed += square[1][j] < square[0][i];
                    taken += square[0][i] - square[1][j];
                    all += square[0][i];
                }
                i += order <= 0;
                j += order >= 0;
            }
        }
        print_message("%s: plasticity took %.2g of the energy of springs a run, from %zu\n", SCHEMES[scheme],
                      taken / all, flowed);
        assert_true(flowed > 1000 && taken > 0);
        rheo_world_destroy(world);
    }
    for (int k = 0; k < 2; k++) {
        free(spring[k]);
        free(square[k]);
    }
}

/* Artificial viscosity is the difference of two runs of stage momentum from one state. It acts against velocities. */
static void artificial_viscosity_makes_no_energy(void **unused)
{
    (void)unused;
    rheo_world *world[2];
    for (int without = 0; without < 2; without++) {
        rheo_world_def def = melt_variant(0);
        if (without)
            def.melting.alpha = def.melting.beta = 0;
        world[without] = jostling_melt(def);
    }
    double power = 0, size = 0;
    const uint32_t count = rheo_world_particle_count(world[0]);
    rheo_real *v = malloc(3 * (size_t)count * sizeof *v);
    assert_non_null(v);
    memcpy(v, rheo_world_velocities(world[0]), 3 * (size_t)count * sizeof *v);
    for (int without = 0; without < 2; without++) {
        char name[32] = "";
        while (strcmp(name, "momentum@1") != 0) {
            uint32_t stage;
            OK(rheo_world_step_stage(world[without], &stage, &error));
            rheo_world_last_stage(world[without], name);
        }
    }
    for (size_t i = 0; i < 3 * (size_t)count; i++) {
        const double by = (double)rheo_world_velocities(world[0])[i] - (double)rheo_world_velocities(world[1])[i];
        power += by * (double)v[i];
        size += fabs(by * (double)v[i]);
    }
    print_message("artificial viscosity: %.3f of its largest power\n", power / size);
    assert_true(power < -0.1 * size);
    free(v);
    rheo_world_destroy(world[0]);
    rheo_world_destroy(world[1]);
}

/* ---- Heat and volume ---- */

/*
 * An insulated body, at rest and in motion: heat is conserved to the rounding of each temperature in each substep, its spread
 * never grows, and no temperature leaves the range of the others.
 */
static void heat_is_kept_and_evens_out(void **unused)
{
    (void)unused;
    for (int frozen = 0; frozen < 2; frozen++) {
        rheo_world_def def = melt_variant(0);
        def.melting.diffusivity = 0.05;
        def.melting.flow = frozen ? RHEO_FLOW_FROZEN : RHEO_FLOW_ON;
        rheo_world *world = jostling_melt(def);
        const uint32_t count = world->state.particles;
        const double heat = heat_of(world);
        double substeps = 0, squares = INFINITY, low = 0, high = 1, first = 0;
        for (int s = 0; s <= 50; s++) {
            double sum = 0, least = INFINITY, most = -INFINITY;
            for (uint32_t i = 0; i < count; i++) {
                const double t = (double)world->state.temperature[i];
                sum += t * t;
                least = fmin(least, t);
                most = fmax(most, t);
            }
            first = s == 0 ? sum : first;
            assert_true(least >= low && most <= high && sum <= squares * (1 + 4 * ROUNDING * 10));
            squares = sum;
            low = least;
            high = most;
            step(world, 1);
            substeps += metric(world, "substeps");
        }
        print_message("heat, %s: changed by %.2g in %.0f substeps; temperatures from %.3f to %.3f\n",
                      frozen ? "frozen" : "moving", heat_of(world) / heat - 1, substeps, low, high);
        NEAR(heat_of(world) / heat, 1, 2 * ROUNDING * substeps);
        assert_true(high - low < 0.3 && squares < first);
        rheo_world_destroy(world);
    }
}

/* Twice the mean height of a pool in a box, in 200 steps after it has settled: its volume. */
static void a_pool_keeps_its_volume(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < 3; scheme++) {
        rheo_scene scene = lively_scene();
        scene.world.scheme = (rheo_scheme)scheme;
        scene.world.vibrators.count = 0;
        scene.world.ball.radius = 0;
        scene.settle.time = 4;
        rheo_world *world;
        OK(rheo_scene_create_world(&scene, &world, &error));
        double height[2] = {0, 0};
        const uint32_t count = rheo_world_particle_count(world);
        for (int later = 0; later < 2; later++) {
            step(world, 200 * later);
            for (uint32_t i = 0; i < count; i++)
                height[later] += 2 * (double)rheo_world_positions(world)[3 * i + 1] / count;
        }
        print_message("volume, %s: changed by %.2g in 200 steps\n", SCHEMES[scheme], height[1] / height[0] - 1);
        NEAR(height[1] / height[0], 1, 0.02);
        rheo_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_stage_makes_momentum),     cmocka_unit_test(displacements_make_angular_momentum),
        cmocka_unit_test(melts_keep_angular_momentum), cmocka_unit_test(passive_stages_make_no_energy),
        cmocka_unit_test(plasticity_makes_no_energy),  cmocka_unit_test(artificial_viscosity_makes_no_energy),
        cmocka_unit_test(heat_is_kept_and_evens_out),  cmocka_unit_test(a_pool_keeps_its_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
