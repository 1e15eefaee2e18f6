/* Scheme summed of the thickening model against plain sums, conservation laws and symmetries. */
#include "support.h"

#include <math.h>

#include "record/recording.h"
#include "world/model_thickening.h"
#include "world/stage_runs.h"

enum { MOST = 400 };
static const double ROUNDING = sizeof(rheo_real) == 4 ? 1e-5 : 1e-12;

static uint64_t seed;
static double random_unit(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) / 9007199254740992.0;
}

/* Positions of n particles in a cube of this width, and velocities up to `speed` on each axis. */
static void cloud(uint32_t n, double width, double speed, rheo_real *x, rheo_real *v)
{
    for (uint32_t i = 0; i < 3 * n; i++) {
        x[i] = (rheo_real)(width * random_unit());
        v[i] = (rheo_real)(speed * (2 * random_unit() - 1));
    }
}

static double distance_of(const rheo_real *x, uint32_t a, uint32_t b, double d[3])
{
    double sum = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        d[axis] = (double)x[3 * b + axis] - (double)x[3 * a + axis];
        sum += d[axis] * d[axis];
    }
    return sqrt(sum);
}

/* Runs the stages of the next step up to this one; in a substep, the first. */
static void run_to(rheo_world *world, const char *name)
{
    uint32_t stage;
    rheo_stage_info info;
    do {
        OK(rheo_world_step_stage(world, &stage, &error));
        OK(rheo_world_stage(world, stage, &info));
    } while (strcmp(info.name, name) != 0);
}

/* ---- Sums over neighbours ---- */

/* Pressures and springs of a cloud at rest, in blocks that are full, partly filled and many. */
static void forces_are_the_plain_sums(void **unused)
{
    (void)unused;
    static const uint32_t numbers[] = {1, 2, 15, 16, 17, 33, 100, 161};
    static rheo_real x[3 * MOST], v[3 * MOST], length[MOST * MOST / 2];
    static uint32_t ends[MOST * MOST];
    static double a[3 * MOST], rho[MOST], near[MOST];
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        const uint32_t n = numbers[k];
        seed = n;
        cloud(n, 1.1 * cbrt(n), 0, x, v); /* pressures below and above the largest tension */
        rheo_world_def def = inert_def();
        def.substeps = 1;
        def.fluid.stiffness = 300;
        def.fluid.near_stiffness = 500;
        def.fluid.rest_density = 2.6;
        def.springs.stiffness = 15;
        def.springs.plasticity = 0;
        memset(a, 0, sizeof a);
        size_t springs = 0;
        for (uint32_t i = 0; i < n; i++) {
            rho[i] = near[i] = 0;
            for (uint32_t j = 0; j < n; j++) {
                double d[3], w = 1 - distance_of(x, i, j, d) / 2;
                if (j != i && w > 0) {
                    rho[i] += w * w;
                    near[i] += w * w * w;
                }
            }
        }
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = i + 1; j < n; j++) {
                double d[3], r = distance_of(x, i, j, d), w = 1 - r / 2;
                if (!(w > 0))
                    continue;
                ends[2 * springs] = i;
                ends[2 * springs + 1] = j;
                length[springs] = (rheo_real)(2 * random_unit());
                const double pressure =
                    fmax(300 * (rho[i] - 2.6), -0.45 * 300) + fmax(300 * (rho[j] - 2.6), -0.45 * 300);
                const double push = -w / 2 * (pressure + w * 500 * (near[i] + near[j]));
                const double f = (push + 7.5 * (r - (double)length[springs++])) / r;
                for (uint32_t axis = 0; axis < 3; axis++) {
                    a[3 * i + axis] += f * d[axis];
                    a[3 * j + axis] -= f * d[axis];
                }
            }
        def.particles.spring_count = (uint32_t)springs;
        def.particles.spring_ends = ends;
        def.particles.spring_rest_length = length;
        rheo_world *world = world_of(def, n, x, v);
        step(world, 1);
        double largest = 1e-30, sum[3] = {0};
        for (uint32_t i = 0; i < 3 * n; i++)
            largest = fmax(largest, fabs(a[i]));
        for (uint32_t i = 0; i < 3 * n; i++) {
            NEAR((double)rheo_world_velocities(world)[i] / def.step / largest, a[i] / largest, ROUNDING);
            NEAR((double)rheo_world_positions(world)[i], (double)x[i] + def.step * def.step * a[i],
                 4 * ROUNDING + def.step * def.step * largest * ROUNDING);
            sum[i % 3] += (double)rheo_world_velocities(world)[i];
        }
        for (int axis = 0; axis < 3; axis++)
            NEAR(sum[axis] / largest / def.step, 0, n * ROUNDING / 10);
        for (size_t s = 0; s < springs; s++)
            assert_true(rheo__springs_find(&world->state.springs, ends[2 * s], ends[2 * s + 1]) != SIZE_MAX);
        assert_int_equal(rheo_world_spring_count(world), springs);
        rheo_world_destroy(world);
    }
}

/* The forces of a pair are opposite to the last bit, for any stiffness, distance and rank. */
static void forces_of_a_pair_are_opposite(void **unused)
{
    (void)unused;
    seed = 1;
    for (int k = 0; k < 200; k++) {
        rheo_world_def def = inert_def();
        def.fluid.stiffness = 300 * random_unit();
        def.fluid.near_stiffness = 500 * random_unit();
        def.springs.stiffness = 100 * random_unit();
        def.springs.plasticity = 4;
        def.fluid.linear_viscosity = 3;
        const rheo_real x[6] = {0, 0, 0, (rheo_real)(random_unit() - 0.5), (rheo_real)random_unit(), (rheo_real)1},
                        v[6] = {1, 0, 2, -1, 0, -2};
        rheo_world *world = world_of(def, 2, x, v);
        for (int n = 0; n < 5; n++) {
            step(world, 1);
            for (int axis = 0; axis < 3; axis++)
                assert_true(rheo_world_velocities(world)[axis] == -rheo_world_velocities(world)[3 + axis]);
        }
        rheo_world_destroy(world);
    }
}

/* ---- Viscosity ---- */

/*
 * Impulses of clouds against plain sums. With sigma 50, beta 10 and speeds of 30, the bound acts: momentum is
 * conserved, and kinetic energy never grows.
 */
static void viscosity_is_bounded(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST], v[3 * MOST];
    static double share[MOST], expected[3 * MOST];
    static const double factor[][3] = {{0.5, 0.1, 3}, {50, 10, 30}, {1e6, 0, 30}, {0, 1e6, 30}};
    for (size_t k = 0; k < sizeof factor / sizeof *factor; k++)
        for (uint32_t n = 2; n < MOST; n = 3 * n + 11) {
            seed = n;
            cloud(n, 1.2 * cbrt(n), factor[k][2], x, v);
            rheo_world_def def = inert_def();
            def.fluid.linear_viscosity = factor[k][0];
            def.fluid.quadratic_viscosity = factor[k][1];
            memset(share, 0, sizeof share);
            for (int apply = 0; apply < 2; apply++)
                for (uint32_t i = 0; i < n; i++) {
                    for (uint32_t axis = 0; apply && axis < 3; axis++)
                        expected[3 * i + axis] = (double)v[3 * i + axis];
                    for (uint32_t j = 0; j < n; j++) {
                        double d[3], r = distance_of(x, i, j, d), u = 0;
                        for (uint32_t axis = 0; j != i && axis < 3; axis++)
                            u += ((double)v[3 * i + axis] - (double)v[3 * j + axis]) * d[axis] / r;
                        if (j == i || !(r < 2 && u > 0))
                            continue;
                        const double f = def.step * (1 - r / 2) * (factor[k][0] + factor[k][1] * u);
                        const double bound = fmax(1, fmax(share[i], share[j]));
                        for (uint32_t axis = 0; apply && axis < 3; axis++)
                            expected[3 * i + axis] -= f * u / bound / 2 * d[axis] / r;
                        share[i] += apply ? 0 : f;
                    }
                }
            rheo_world *world = world_of(def, n, x, v);
            run_to(world, "viscosity");
            double energy[2] = {0}, momentum[3] = {0};
            for (uint32_t i = 0; i < 3 * n; i++) {
                const double now = (double)rheo_world_velocities(world)[i], before = (double)v[i];
                NEAR(now, expected[i], 30 * ROUNDING);
                momentum[i % 3] += now - before;
                energy[0] += before * before;
                energy[1] += now * now;
            }
            assert_true(energy[1] < energy[0] * (1 + ROUNDING));
            for (int axis = 0; axis < 3; axis++)
                NEAR(momentum[axis], 0, 30 * n * ROUNDING / 10);
            rheo_world_destroy(world);
        }
}

/* A pair keeps at most its common velocity: no viscosity turns a particle back beyond it. */
static void viscosity_never_turns_a_pair_back(void **unused)
{
    (void)unused;
    for (double sigma = 0.5; sigma < 1e5; sigma *= 7) {
        rheo_world_def def = inert_def();
        def.fluid.linear_viscosity = sigma;
        def.fluid.quadratic_viscosity = 10;
        const rheo_real x[6] = {0, 0, 0, 1, 0, 0}, v[6] = {30, 0, 0, -10, 0, 0};
        rheo_world *world = world_of(def, 2, x, v);
        run_to(world, "viscosity");
        const double f = def.step * 0.5 * (sigma + 10 * 40), kept = f < 1 ? 1 - f : 0;
        NEAR((double)rheo_world_velocities(world)[0], 10 + 20 * kept, 40 * ROUNDING);
        NEAR((double)rheo_world_velocities(world)[3], 10 - 20 * kept, 40 * ROUNDING);
        rheo_world_destroy(world);
    }
}

/* ---- Stiffness ---- */

/* Whether an entry of row i is a spring, or a pair within the support, which will get one. */
static bool counts(const rheo_world *world, uint32_t i, size_t k)
{
    const rheo__springs *s = &world->state.springs;
    const rheo__pairs *p = &s->pairs;
    const uint32_t j = rheo__pairs_partner(p, k);
    double d[3], r = j < p->rows ? distance_of(world->state.position, p->id_of[i], p->id_of[j], d) : 0;
    return s->rest_length[k] >= 0 || (r > 0 && r < rheo_world_definition(world)->fluid.support);
}

/* Springs are softened, equally for both ends, until no sum of kappa is above 2; those of softer particles stay. */
static void sums_of_kappa_are_bounded(void **unused)
{
    (void)unused;
    int softened = 0;
    for (int stiff = 0; stiff < 3; stiff++) {
        rheo_scene scene = lively_scene();
        scene.world.springs.stiffness = stiff ? 4000 : 15;
        scene.world.history.stiffness = stiff == 2 ? 1e6 : 150;
        scene.world.max_substeps = 3;
        rheo_world *world;
        OK(rheo_scene_create_world(&scene, &world, &error));
        for (int n = 0; n < 12; n++) {
            run_to(world, "viscosity");
            const rheo__thickening *t = rheo__thickening_of(world);
            const rheo__springs *s = &world->state.springs;
            const rheo__pairs *p = &s->pairs;
            const size_t entries = rheo__pairs_entries(p);
            rheo_real *before = malloc((entries + 1) * sizeof *before);
            double *sum = calloc(p->rows, sizeof *sum);
            assert_true(before && sum);
            memcpy(before, t->pair_stiffness, entries * sizeof *before);
            run_to(world, "substeps");
            const double tau = scene.world.step / (double)*world->state.substeps;
            for (uint32_t i = 0; i < p->rows; i++)
                for (size_t k = rheo__pairs_first(p, i); k < rheo__pairs_end(p, i); k += p->width)
                    if (counts(world, i, k))
                        sum[i] += tau * tau * (double)before[k];
            for (uint32_t i = 0; i < p->rows; i++) {
                double after = 0;
                for (size_t k = rheo__pairs_first(p, i); k < rheo__pairs_end(p, i); k += p->width) {
                    if (!(s->rest_length[k] >= 0))
                        continue;
                    const uint32_t j = rheo__pairs_partner(p, k);
                    const double most = fmax(sum[i], sum[j]), expected = most > 2 ? 2 / most : 1;
                    NEAR((double)(t->pair_stiffness[k] / before[k]), expected, 1e-5);
                    softened += expected < 0.9;
                    after += tau * tau * (double)t->pair_stiffness[k];
                    size_t back = rheo__pairs_first(p, j);
                    while (rheo__pairs_partner(p, back) != i)
                        back += p->width;
                    assert_memory_equal(&t->pair_stiffness[back], &t->pair_stiffness[k], sizeof *before);
                }
                assert_true(after <= 2 * (1 + 1e-5));
            }
            free(before);
            free(sum);
            step(world, 1); /* the rest of it */
        }
        rheo_world_destroy(world);
        assert_true(stiff || softened == 0);
    }
    assert_true(softened > 1000);
}

/*
 * Passive: a spring whose K has grown keeps its force, and one whose K has fallen its rest length. Active: rest lengths
 * never change here.
 */
static void hardening_keeps_forces_or_rest_lengths(void **unused)
{
    (void)unused;
    for (int active = 0; active < 2; active++) {
        rheo_world_def def = inert_def();
        def.springs.stiffness = 40;
        def.history.stiffness = 60;
        def.history.hardening = active ? RHEO_HARDENING_ACTIVE : RHEO_HARDENING_PASSIVE;
        const uint32_t ends[] = {0, 1};
        const rheo_real length = 1, x[6] = {0, 0, 0, 1.25F, 0, 0}, v[6] = {0, 0.5F, 0, 0, -0.5F, 0.25F};
        def.particles.spring_count = 1;
        def.particles.spring_ends = ends;
        def.particles.spring_rest_length = &length;
        rheo_world *world = world_of(def, 2, x, v);
        double before = 40;
        int grown = 0, fallen = 0;
        for (int n = 0; n < 60; n++) {
            run_to(world, "fractional_derivative");
            const rheo__springs *s = &world->state.springs;
            const size_t k = rheo__springs_find(s, 0, 1);
            const double l = (double)s->rest_length[k];
            double d[3];
            const double r = distance_of(world->state.position, 0, 1, d);
            run_to(world, "stiffness");
            const double stiffness = (double)rheo__thickening_of(world)->pair_stiffness[k];
            const double now = (double)s->rest_length[k];
            if (!active && stiffness > before) {
                NEAR(stiffness * (r - now), before * (r - l), 1e-3);
                assert_true(fabs(now - l) > 0);
                grown++;
            } else {
                assert_true(now == l);
                fallen += stiffness < before;
            }
            before = stiffness;
            step(world, 1);
        }
        assert_true(fallen > 5 && (active || grown > 5));
        rheo_world_destroy(world);
    }
}

/* ---- Substeps ---- */

/* The number of substeps of the next step of a pair. */
static uint64_t substeps_of(const rheo_world_def *def, double speed)
{
    const bool springs = def->springs.stiffness > 0;
    const rheo_real x[6] = {0, 0, 0, 1, 0, 0}, v[6] = {0, 0, 0, 0, (rheo_real)speed, 0};
    rheo_world *world = world_of(*def, 2, x, v);
    if (springs) {
        step(world, 1); /* gets its spring */
        memcpy(world->state.velocity, v, sizeof v);
    }
    run_to(world, "substeps");
    const uint64_t count = *world->state.substeps;
    rheo_world_destroy(world);
    return count;
}

/* Two at rest, and as many as pressure, springs and speed need: at most max_substeps, unless their number is given. */
static void substeps_follow_from_the_state(void **unused)
{
    (void)unused;
    rheo_world_def rest = inert_def(), def;
    rest.step = 0.5;
    rest.fluid.linear_viscosity = 0.1;
    assert_int_equal(substeps_of(&rest, 0), 2);
    def = rest;
    def.fluid.stiffness = 3.5; /* 0.875/(2 x 0.045) = 9.7 */
    assert_int_equal(substeps_of(&def, 0), 4);
    def.fluid.stiffness = 1.4; /* 3.9 */
    assert_int_equal(substeps_of(&def, 0), 2);
    assert_int_equal(substeps_of(&rest, 6), 6); /* 0.5 x 6/(2/4) */
    assert_int_equal(substeps_of(&rest, 6.125), 7);
    assert_int_equal(substeps_of(&rest, 100), 16);
    def = rest;
    def.springs.stiffness = 190; /* 190/4/2 = 23.75 */
    assert_int_equal(substeps_of(&def, 0), 5);
    def.springs.stiffness = 201;
    assert_int_equal(substeps_of(&def, 0), 6);
    def.max_substeps = 3;
    assert_int_equal(substeps_of(&def, 0), 3);
    def.substeps = 7;
    assert_int_equal(substeps_of(&def, 0), 7);
    def.substeps = 1;
    assert_int_equal(substeps_of(&def, 100), 1);
}

/* A recording in which the number of substeps changes verifies, and shows the number of each step. */
static void changing_substeps_are_recorded(void **unused)
{
    (void)unused;
    enum { STEPS = 30 };
    static const char *const PATH = "test_summed.rlog";
    rheo_scene scene = lively_scene();
    scene.world.ball.velocity[1] = -60;
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_verification v;
    uint64_t count[STEPS + 1], least = 1000, most = 0;
    OK(rheo_scene_create_world(&scene, &world, &error));
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true, .keyframe_spacing = 9}, &recorder,
                          &error));
    for (int n = 1; n <= STEPS; n++) {
        OK(rheo_recorder_step(recorder, &error));
        count[n] = *world->state.substeps;
        least = count[n] < least ? count[n] : least;
        most = count[n] > most ? count[n] : most;
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    assert_true(least == 2 && most > 3);
    OK(rheo_verify(PATH, &v, &error));
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    assert_int_equal(v.steps, STEPS);
    rheo_recording *r;
    rheo_player *player;
    OK(rheo_recording_open(PATH, &r, &error));
    OK(rheo_player_open(r, NULL, &player, &error));
    for (uint64_t n = STEPS; n > 0; n -= 3) {
        char last[32];
        snprintf(last, sizeof last, "densities@%u", (unsigned)count[n]);
        OK(rheo_player_seek_stage(player, n, last, &error));
        const rheo_world *there = rheo_player_world(player);
        assert_true(*there->state.substeps == count[n]);
        assert_int_equal(there->stage_runs_done, rheo__world_stage_runs(there, count[n]) - 4); /* forces to history */
    }
    rheo_player_close(player);
    rheo_recording_close(r);
    remove(PATH);
}

/* ---- Wetting ---- */

/* The shares of the ball in the sums of particles are integrals over its volume, here sums over a fine lattice. */
static void the_ball_counts_as_fluid(void **unused)
{
    (void)unused;
    enum { CELLS = 160 };
    rheo_world_def def = inert_def();
    def.fluid.stiffness = 1;
    def.fluid.number_density = 0.125;
    def.ball.radius = 3;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    const rheo__wetting_integrals *table = rheo__thickening_of(world)->wetting[0];
    const double h = 2, side = 2 * 3.0 / CELLS;
    for (int node = 0; node < RHEO__WETTING_NODES; node += 16) {
        const double distance = 3 + node * h / (RHEO__WETTING_NODES - 1); /* of the particle, from the centre */
        double sum[4] = {0};
        for (int i = 0; i < CELLS * CELLS * CELLS; i++) {
            const double x = (i % CELLS + 0.5) * side - 3, y = (i / CELLS % CELLS + 0.5) * side - 3,
                         z = (i / CELLS / CELLS + 0.5) * side - 3;
            const double r = sqrt((x - distance) * (x - distance) + y * y + z * z), w = 1 - r / h;
            if (x * x + y * y + z * z > 9 || !(w > 0))
                continue;
            const double along = (distance - x) / r;
            sum[0] += w * w;
            sum[1] += w * w * w;
            sum[2] += w * along;
            sum[3] += w * w * along;
        }
        const double expected[4] = {(double)table[node].density, (double)table[node].near_density,
                                    (double)table[node].push, (double)table[node].near_push};
        for (int k = 0; k < 4; k++)
            NEAR(0.125 * side * side * side * sum[k], expected[k], 0.01 * (double)table[0].density);
    }
    assert_true(table[RHEO__WETTING_NODES - 1].density == 0 && (double)table[0].density > 0.1);
    /* A flat surface would take half of the sum inside fluid, n 4 pi h^3/30; this one is convex. */
    const double half = 0.125 * 2 * 3.14159265358979 * 8 / 30;
    assert_true((double)table[0].density < half && (double)table[0].density > 0.6 * half);
    rheo_world_destroy(world);
}

/* ---- Conservation and symmetry ---- */

enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE };

/* A jittered block in free space, which a ball hits. */
static rheo_world_def hit(double ratio, rheo_real *x)
{
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    def.ball.radius = 3;
    def.ball.density_ratio = ratio;
    def.ball.position[0] = 0.5;
    def.ball.position[1] = 9.5;
    def.ball.velocity[0] = 4;
    def.ball.velocity[1] = -30;
    def.ball.spin[2] = 3;
    seed = 5;
    for (int i = 0; i < COUNT; i++) {
        x[3 * i] = (rheo_real)(2 * (i % SIDE) - 5 + 0.3 * random_unit());
        x[3 * i + 1] = (rheo_real)(2 * (i / SIDE % SIDE) - 5 + 0.3 * random_unit());
        x[3 * i + 2] = (rheo_real)(2 * (i / SIDE / SIDE) - 5 + 0.3 * random_unit());
    }
    return def;
}

static void momenta(const rheo_world *world, double linear[3], double angular[3])
{
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    const double *X = ball.position, *V = ball.velocity;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        linear[a] = ball.mass * V[a];
        angular[a] = ball.mass * (X[b] * V[c] - X[c] * V[b]) + 0.4 * ball.mass * 9 * ball.spin[a];
        for (uint32_t i = 0; i < rheo_world_particle_count(world); i++) {
            const rheo_real *x = rheo_world_positions(world) + 3 * i, *v = rheo_world_velocities(world) + 3 * i;
            linear[a] += (double)v[a];
            angular[a] += (double)x[b] * (double)v[c] - (double)x[c] * (double)v[b];
        }
    }
}

/*
 * A violent hit, with all forces and friction: momentum is conserved to rounding. Angular momentum is conserved by the
 * impulses, but the displacements change it to first order in the substep.
 */
static void a_hit_conserves_momentum(void **unused)
{
    (void)unused;
    static const double ratio[] = {0.05, 0.5, 2, 50};
    for (size_t k = 0; k < sizeof ratio / sizeof *ratio; k++) {
        double off[3];
        for (int fine = 0; fine < 3; fine++) {
            static rheo_real x[3 * COUNT];
            rheo_world_def def = hit(ratio[k], x);
            def.substeps = fine == 0 ? 2 : fine == 1 ? 8 : 32;
            rheo_world *world = world_of(def, COUNT, x, NULL);
            double linear[2][3], angular[2][3];
            rheo_body ball;
            momenta(world, linear[0], angular[0]);
            step(world, 30);
            OK(rheo_world_body(world, 0, &ball));
            momenta(world, linear[1], angular[1]);
            const double size = ball.mass * 30;
            off[fine] = 0;
            for (int axis = 0; axis < 3; axis++) {
                NEAR((linear[1][axis] - linear[0][axis]) / size, 0, COUNT * ROUNDING / 20);
                off[fine] = fmax(off[fine], fabs(angular[1][axis] - angular[0][axis]) / size / 3);
            }
            rheo_world_destroy(world);
        }
        assert_true(off[0] < 0.03 && off[1] < 0.4 * off[0] && off[2] < 0.4 * off[1]);
    }
}

/* Renumbered, mirrored and rotated scenes move in the same way: to rounding in a step, closely after many. */
static void motion_does_not_depend_on_numbers_and_axes(void **unused)
{
    (void)unused;
    static rheo_real x[3 * COUNT], to[3 * COUNT], plain[2][3 * COUNT];
    for (int turned = 0; turned < 4; turned++) { /* as it is; renumbered; mirrored in x; rotated about y */
        rheo_world_def def = hit(2, x);
        for (int i = 0; i < COUNT; i++) {
            const int number = turned == 1 ? (i * 125 + 7) % COUNT : i;
            to[3 * number] = turned == 2 ? -x[3 * i] : turned == 3 ? x[3 * i + 2] : x[3 * i];
            to[3 * number + 1] = x[3 * i + 1];
            to[3 * number + 2] = turned == 3 ? -x[3 * i] : x[3 * i + 2];
        }
        def.ball.position[2] = turned == 3 ? -def.ball.position[0] : 0;
        def.ball.velocity[2] = turned == 3 ? -def.ball.velocity[0] : 0;
        def.ball.position[0] *= turned == 2 ? -1 : turned != 3;
        def.ball.velocity[0] *= turned == 2 ? -1 : turned != 3;
        def.ball.spin[0] = turned == 3 ? 0 : 0;
        def.ball.spin[2] = 0;
        rheo_world *world = world_of(def, COUNT, to, NULL);
        for (int later = 0; later < 2; later++) {
            step(world, later ? 19 : 1);
            double most = 0;
            for (int i = 0; i < COUNT; i++) {
                const rheo_real *now = rheo_world_positions(world) + 3 * (turned == 1 ? (i * 125 + 7) % COUNT : i);
                const rheo_real back[3] = {turned == 2   ? -now[0]
                                           : turned == 3 ? -now[2]
                                                         : now[0],
                                           now[1], turned == 3 ? now[0] : now[2]};
                for (int axis = 0; axis < 3; axis++) {
                    if (turned == 0)
                        plain[later][3 * i + axis] = back[axis];
                    most = fmax(most, fabs((double)(back[axis] - plain[later][3 * i + axis])));
                }
            }
            NEAR(most, 0, later ? 20 * ROUNDING : ROUNDING);
        }
        rheo_world_destroy(world);
    }
}

/* ---- Hard cases ---- */

/* Velocities do not lose digits far from the origin, as they would as quotients of positions. */
static void fall_far_from_the_origin(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    rheo_real x[24];
    for (int i = 0; i < 24; i++)
        x[i] = (rheo_real)(10000 + 2 * (i % 3 == 0 ? i / 3 % 2 : i % 3 == 1 ? i / 6 % 2 : i / 12));
    rheo_world *world = world_of(def, 8, x, NULL);
    step(world, 1000);
    for (int axis = 0; axis < 3; axis++) {
        double mean = 0;
        for (int i = 0; i < 8; i++)
            mean += (double)rheo_world_velocities(world)[3 * i + axis] / 8;
        NEAR(mean / (9.81 * 33), axis == 1 ? -1 : 0, 1e-4);
    }
    rheo_world_destroy(world);
}

/* No entry of a NaN row has the distance 0, so the number of coinciding partners was negative. */
static void a_position_that_is_not_finite_counts_no_partners(void **unused)
{
    (void)unused;
    rheo_real x[3 * 20];
    for (int i = 0; i < 3 * 20; i++)
        x[i] = (rheo_real)(i % 3 ? 0 : i);
    rheo_world *world = world_of(rheo_default_world_def(), 20, x, NULL);
    world->state.position[3 * 7] = (rheo_real)NAN;
    assert_int_equal(rheo_world_step(world, NULL), RHEO_ERROR_STATE);
    assert_true(rheo__thickening_of(world)->diagnostics.mean_neighbours <= 20);
    rheo_world_destroy(world);
}

/* Particles without neighbours have no density here; the middle of three that touch has the largest. */
static void the_densest_particle_has_a_name_or_none(void **unused)
{
    (void)unused;
    for (int touch = 0; touch < 2; touch++) {
        const rheo_real apart = touch ? 2 : 100, x[] = {0, 0, 0, 2 * apart, 0, 0, apart, 0, 0};
        rheo_world_def def = rheo_default_world_def();
        memset(def.gravity, 0, sizeof def.gravity);
        rheo_world *world = world_of(def, 3, x, NULL);
        step(world, 1);
        assert_true(metric(world, "max_density_id") == (touch ? 2 : -1));
        assert_true((metric(world, "max_density") > 0) == (touch != 0));
        const double density = metric(world, "max_density") * def.fluid.rest_density;
        rheo_world_destroy(world);
        def.fluid.rest_density = 0.125; /* the metric is in densities at rest, also of a thin fluid */
        world = world_of(def, 3, x, NULL);
        step(world, 1);
        NEAR(metric(world, "max_density") * 0.125, density, 0.1 * density); /* the pressures differ */
        rheo_world_destroy(world);
    }
}

/* Coinciding particles part, and their momentum stays. */
static void coinciding_particles_part_without_momentum(void **unused)
{
    (void)unused;
    rheo_real x[3 * 20] = {0};
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    rheo_world *world = world_of(def, 20, x, NULL);
    step(world, 30);
    double sum[3] = {0}, size = 0, least = 1e9;
    for (uint32_t i = 0; i < 20; i++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            sum[axis] += (double)rheo_world_velocities(world)[3 * i + axis];
            size += fabs((double)rheo_world_velocities(world)[3 * i + axis]);
        }
    for (uint32_t a = 0; a < 20; a++)
        for (uint32_t b = 0; b < a; b++) {
            double d[3];
            least = fmin(least, distance_of(rheo_world_positions(world), a, b, d));
        }
    assert_true(least > 0.1 && size > 1);
    for (int axis = 0; axis < 3; axis++)
        NEAR(sum[axis] / size, 0, 100 * ROUNDING);
    rheo_world_destroy(world);
}

/* Particles that are added in a run take part at once, and a saved world goes on with the same bits. */
static void particles_are_added_in_a_run(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world(), *loaded;
    step(world, 5);
    for (uint32_t more = 1; more < 40; more += 12) {
        const uint32_t n = rheo_world_particle_count(world);
        rheo_real x[3 * 40];
        for (uint32_t i = 0; i < 3 * more; i++)
            x[i] =
                (rheo_real)(i % 3 == 1 ? 12 + more + 2 * (i / 3 / 8) : 1 + 2 * (i % 3 ? i / 3 / 4 % 2 : i / 3 % 4));
        OK(rheo_world_add_particles(world, more, x, NULL, &error));
        step(world, 1);
        for (uint32_t i = n; i < n + more; i++) {
            rheo_particle_state p;
            OK(rheo_world_particle(world, i, &p, &error));
            assert_true(p.velocity[1] < -0.1 || more > 2);
        }
        void *bytes;
        size_t size;
        rheo_recording *checkpoint;
        OK(rheo_world_save_memory(world, "added", &bytes, &size, &error));
        OK(rheo_recording_open_memory(bytes, size, &checkpoint, &error));
        OK(rheo_recording_world(checkpoint, rheo_world_step_count(world), NULL, &loaded, &error));
        for (int k = 0; k < 4; k++) {
            step(world, 1);
            step(loaded, 1);
            assert_true(rheo_world_hash(world) == rheo_world_hash(loaded));
        }
        rheo_world_destroy(loaded);
        rheo_recording_close(checkpoint);
        free(bytes);
    }
    rheo_world_destroy(world);
}

/* A wider support makes another list, also in a world in which nothing moves, as in a loaded one. */
static void a_changed_support_makes_another_list(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 1;
    const rheo_real x[6] = {0, 0, 0, 2.5F, 0, 0};
    rheo_world *world = world_of(def, 2, x, NULL);
    step(world, 3);
    assert_int_equal(rheo_world_spring_count(world), 0);
    OK(rheo_world_set(world, "fluid.support", "3", &error));
    step(world, 1);
    assert_int_equal(rheo_world_spring_count(world), 1);
    OK(rheo_world_set(world, "fluid.support", "2", &error));
    run_to(world, "neighbours");
    assert_int_equal(rheo_world_spring_count(world), 0);
    step(world, 1);
    assert_int_equal(rheo_world_spring_count(world), 0);
    rheo_world_destroy(world);
}

/* A ball made inside fluid pushes the particles out of its place, but not apart with the speed of an explosion. */
static void a_ball_made_inside_fluid_does_not_explode(void **unused)
{
    (void)unused;
    static rheo_real x[3 * COUNT];
    rheo_world_def def = hit(1, x);
    memset(def.ball.velocity, 0, sizeof def.ball.velocity);
    memset(def.ball.spin, 0, sizeof def.ball.spin);
    def.ball.position[0] = def.ball.position[1] = 0;
    rheo_world *world = world_of(def, COUNT, x, NULL);
    double fastest = 0;
    rheo_body ball;
    for (int n = 0; n < 60; n++) {
        step(world, 1);
        fastest = fmax(fastest, metric(world, "max_speed"));
    }
    OK(rheo_world_body(world, 0, &ball));
    assert_true(fastest > 1 && fastest < 45); /* of the overlap in a substep, the speed would be 180 */
    for (int axis = 0; axis < 3; axis++)
        NEAR(ball.velocity[axis], 0, 0.1);
    rheo_world_destroy(world);
}

/* Settling is damped at a rate: falling particles approach g/c at any step. */
static void damping_does_not_depend_on_the_step(void **unused)
{
    (void)unused;
    for (double dt = 0.04; dt > 0.001; dt /= 4) {
        rheo_scene scene = rheo_default_scene();
        scene.world = inert_def();
        scene.world.gravity[1] = -10;
        scene.world.step = dt;
        scene.world.fluid.spacing = 5;
        scene.fill = some_fills();
        scene.fill_count = 1;
        fills_of(&scene)[0].kind = RHEO_FILL_BLOCK;
        fills_of(&scene)[0].max[0] = fills_of(&scene)[0].max[1] = fills_of(&scene)[0].max[2] = 10;
        scene.settle.time = 1;
        scene.settle.damping = 2;
        scene.settle.fraction = 1;
        rheo_world *world;
        OK(rheo_scene_create_world(&scene, &world, &error));
        assert_true(rheo_world_particle_count(world) > 0);
        for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
            NEAR((double)rheo_world_velocities(world)[3 * i + 1], -5 * (1 - exp(-2)), 10 * dt / 2);
        rheo_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_the_plain_sums),
        cmocka_unit_test(forces_of_a_pair_are_opposite),
        cmocka_unit_test(viscosity_is_bounded),
        cmocka_unit_test(viscosity_never_turns_a_pair_back),
        cmocka_unit_test(sums_of_kappa_are_bounded),
        cmocka_unit_test(hardening_keeps_forces_or_rest_lengths),
        cmocka_unit_test(substeps_follow_from_the_state),
        cmocka_unit_test(changing_substeps_are_recorded),
        cmocka_unit_test(the_ball_counts_as_fluid),
        cmocka_unit_test(a_hit_conserves_momentum),
        cmocka_unit_test(motion_does_not_depend_on_numbers_and_axes),
        cmocka_unit_test(fall_far_from_the_origin),
        cmocka_unit_test(a_position_that_is_not_finite_counts_no_partners),
        cmocka_unit_test(coinciding_particles_part_without_momentum),
        cmocka_unit_test(the_densest_particle_has_a_name_or_none),
        cmocka_unit_test(particles_are_added_in_a_run),
        cmocka_unit_test(a_changed_support_makes_another_list),
        cmocka_unit_test(a_ball_made_inside_fluid_does_not_explode),
        cmocka_unit_test(damping_does_not_depend_on_the_step),
    };
    return cmocka_run_group_tests_name("summed", tests, NULL, NULL);
}
