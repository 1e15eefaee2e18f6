/* Hard cases of places: particles that coincide, in a plane, on cell borders, alone, far away, in other units, and denormals. */
#include "counting.h"
#include "hard.h"

/* ---- Coinciding particles ---- */

/*
 * In one step n coinciding particles push each of them by at most (n - 1)(P + P_near), all in one direction; after it they are apart.
 * In scheme positions an iteration moves a particle by at most omega 2 h/rho0 (n - 1) 2 lambda, where lambda < rho0/4 follows from
 * its formula: h (n - 1)/2. The velocity follows from the way of all iterations.
 */
static double most_speed(const rheo_world_def *def, double n)
{
    if (def->scheme == RHEO_SCHEME_POSITIONS)
        return (double)def->positions.iterations * def->fluid.support * (n - 1) / 2 / def->step;
    return def->step * (n - 1) *
           (def->fluid.stiffness * fabs(n - 1 - def->fluid.rest_density) + def->fluid.near_stiffness * (n - 1));
}

static void coinciding_particles_part(void **unused)
{
    (void)unused;
    static const uint32_t number[] = {2, 20, 1000};
    for (int scheme = 0; scheme < SCHEMES; scheme++)
        for (int k = 0; k < 3; k++) {
            const uint32_t n = number[k];
            rheo_world_def def = rheo_default_world_def();
            memset(def.gravity, 0, sizeof def.gravity);
            set(&def, "scheme", scheme_name(scheme));
            rheo_real *x = reals(3 * (size_t)n);
            for (uint32_t i = 0; i < 3 * n; i++)
                x[i] = (rheo_real)(i % 3 + 0.25);
            rheo_world *world = world_of(def, n, x, NULL);
            const course c = drive_all(world, 30);
            print_message("%s, %u: fastest %g of %g, momentum %g\n", scheme_name(scheme), n, c.fastest,
                          most_speed(&def, n), momentum(world, 0));
            assert_true(c.fastest > 0 && c.fastest <= most_speed(&def, n));
            /* Pairs move with opposite displacements; sums of n terms round. */
            for (int axis = 0; axis < 3; axis++)
                NEAR(momentum(world, axis), 0, (scheme == RHEO_SCHEME_SEQUENTIAL ? 40 : 4) * n * c.fastest * ULP);
            for (uint32_t i = 1; i < n; i++)
                assert_true(memcmp(rheo_world_positions(world), rheo_world_positions(world) + 3 * i, 3 * sizeof *x) !=
                            0);
            rheo_world_destroy(world);
            free(x);
        }
}

/* ---- Planes, lines and cell borders ---- */

/*
 * No force has a component out of a plane that holds all particles, so not one bit of the third coordinate changes. Particles that
 * come to coincide part in any direction: the places are not quite regular, and scheme positions, in which tension draws particles
 * together to a point, has none.
 */
static void particles_in_a_plane_stay_in_it(void **unused)
{
    (void)unused;
    enum { SIDE = 12, N = SIDE * SIDE };
    for (int scheme = 0; scheme < SCHEMES; scheme++)
        for (int axis = 0; axis < 3; axis++)
            for (int line = 0; line < 2; line++) { /* two coordinates are constant */
                rheo_world_def def = rheo_default_world_def();
                memset(def.gravity, 0, sizeof def.gravity);
                set(&def, "scheme", scheme_name(scheme));
                const double apart = scheme == RHEO_SCHEME_POSITIONS ? 0.5 : 1.5;
                if (scheme == RHEO_SCHEME_POSITIONS)
                    def.fluid.cohesion = 0;
                rheo_real x[3 * N];
                for (int i = 0; i < N; i++) {
                    const double odd[2] = {0.002 * (i * 7919 % 101), 0.002 * (i * 6007 % 103)};
                    x[3 * i + axis] = (rheo_real)0.7;
                    x[3 * i + (axis + 1) % 3] = line ? (rheo_real)-0.3 : (rheo_real)(apart * (i / SIDE) + odd[0]);
                    x[3 * i + (axis + 2) % 3] = (rheo_real)(apart * (line ? i : i % SIDE) + odd[1]);
                }
                rheo_world *world = world_of(def, N, x, NULL);
                const course c = drive_all(world, 100);
                assert_true(c.fastest > 0.1); /* they move */
                for (int i = 0; i < N; i++) {
                    const rheo_real *now = rheo_world_positions(world) + 3 * i;
                    if (now[axis] != x[3 * i + axis])
                        fail_msg("%s, axis %d, line %d: particle %d left the plane", scheme_name(scheme), axis, line,
                                 i);
                    assert_true(!line || now[(axis + 1) % 3] == x[3 * i + (axis + 1) % 3]);
                }
                rheo_world_destroy(world);
            }
}

/* Particles exactly one support apart, at multiples of it on both sides of 0, are no neighbours: nothing ever moves. */
static void particles_a_support_apart_do_not_move(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        memset(def.gravity, 0, sizeof def.gravity);
        set(&def, "scheme", scheme_name(scheme));
        def.fluid.spacing = def.fluid.support;
        rheo_real *x = reals(3 * 512);
        lattice(&def, 8, 8, 8, (double[]){-18, -18, -18}, x);
        rheo_world *world = world_of(def, 512, x, NULL);
        const course c = drive_all(world, 50);
        assert_true(c.fastest == 0 && rheo_world_spring_count(world) == 0 && metric(world, "neighbours") == 0);
        assert_memory_equal(rheo_world_positions(world), x, 3 * 512 * sizeof *x);
        rheo_world_destroy(world);
        free(x);
    }
}

/* Half a support apart, so on the borders, edges and corners of cells: neighbours are those that a plain search finds. */
static void neighbours_on_cell_borders_are_found(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        memset(def.gravity, 0, sizeof def.gravity);
        set(&def, "scheme", scheme_name(scheme));
        rheo_real *x = reals(3 * 343);
        lattice(&def, 7, 7, 7, (double[]){-7, -9, -5}, x);
        rheo_world *world = world_of(def, 343, x, NULL);
        for (int t = 0; t < 20; t++) {
            const rheo_real *now = rheo_world_positions(world);
            for (uint32_t i = 0; i < 343; i += 19) {
                size_t expected = 0, found;
                for (uint32_t j = 0; j < 343; j++) {
                    const rheo_real d[3] = {now[3 * j] - now[3 * i], now[3 * j + 1] - now[3 * i + 1],
                                            now[3 * j + 2] - now[3 * i + 2]};
                    expected += j != i && d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <
                                              (rheo_real)(def.fluid.support * def.fluid.support);
                }
                OK(rheo_world_neighbours(world, i, NULL, NULL, 0, &found, &error));
                assert_int_equal(found, expected);
            }
            step(world, 1);
        }
        assert_true(metric(world, "neighbours") > 10);
        rheo_world_destroy(world);
        free(x);
    }
}

/* ---- Particles alone ---- */

/*
 * A gas without neighbours, over a space of a million supports: each particle keeps its velocity to the last bit, and the world takes
 * no more memory than one of as many particles in one place.
 */
static void a_gas_without_neighbours_flies_freely(void **unused)
{
    (void)unused;
    enum { N = 1000 };
    size_t bytes[2];
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        for (int apart = 0; apart < 2; apart++) {
            rheo_world_def def = rheo_default_world_def();
            memset(def.gravity, 0, sizeof def.gravity);
            set(&def, "scheme", scheme_name(scheme));
            def.allocator = (rheo_allocator){count_allocate, count_release, NULL};
            rheo_real *x = reals(3 * N), *v = reals(3 * N);
            for (int i = 0; i < N; i++)
                for (int a = 0; a < 3; a++) {
                    const int place = a == 0 ? i % 10 : a == 1 ? i / 10 % 10 : i / 100;
                    x[3 * i + a] = (rheo_real)(apart ? 400000.0 * (place - 5) : 2 * place);
                    v[3 * i + a] = (rheo_real)(apart ? place - 4.5 : 0);
                }
            most_bytes_in_use = bytes_in_use = 0;
            rheo_world *world = world_of(def, N, x, v);
            drive_all(world, 50);
            bytes[apart] = most_bytes_in_use;
            if (apart) {
                assert_true(rheo_world_spring_count(world) == 0 && metric(world, "neighbours") == 0);
                if (scheme != RHEO_SCHEME_SEQUENTIAL) /* whose velocities are differences of positions */
                    assert_memory_equal(rheo_world_velocities(world), v, 3 * N * sizeof *v);
            }
            rheo_world_destroy(world);
            assert_true(bytes_in_use == 0);
            free(x);
            free(v);
        }
        print_message("%s: %zu bytes in one place, %zu apart\n", scheme_name(scheme), bytes[0], bytes[1]);
        assert_true(bytes[1] <= bytes[0]);
    }
}

/*
 * A hundred single drops fly apart and fall for 33 T, at last at 324 L/T. The symplectic step is late by g t tau/2 at most. Positions
 * of S L are rounded to S ULP in every substep, and velocities by v ULP, which adds up over the time: in one direction at worst. In
 * scheme sequential a velocity is a difference of positions, rounded to S ULP/step, which adds up at random: 1 % of the way.
 */
static void spray_follows_parabolas(void **unused)
{
    (void)unused;
    enum { N = 100, STEPS = 1000 };
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        set(&def, "scheme", scheme_name(scheme));
        rheo_real x[3 * N], v[3 * N];
        for (int i = 0; i < N; i++) {
            const double y = 1 - (i + 0.5) / (N / 2), r = sqrt(1 - y * y), turn = i * 2.399963;
            const double d[3] = {r * cos(turn), y, r * sin(turn)};
            for (int a = 0; a < 3; a++) {
                x[3 * i + a] = (rheo_real)(13 * d[a]);
                v[3 * i + a] = (rheo_real)(30 * d[a]);
            }
        }
        rheo_world *world = world_of(def, N, x, v);
        const course c = drive_all(world, STEPS);
        const double t = STEPS * def.step, way = 9.81 * t * t / 2;
        double worst = 0;
        for (int i = 0; i < 3 * N; i++)
            worst = fmax(worst, fabs((double)rheo_world_positions(world)[i] -
                                     ((double)x[i] + (double)v[i] * t - (i % 3 == 1 ? way : 0))));
        const double substeps = fmax(c.substeps, 1) * STEPS,
                     rounding =
                         scheme == RHEO_SCHEME_SEQUENTIAL ? 0.01 * way : substeps * ULP * (way + c.fastest * t),
                     most = 9.81 * t * def.step / 2 + rounding;
        print_message("%s: %g L of %g, at most %g\n", scheme_name(scheme), worst, way, most);
        assert_true(worst <= most && rheo_world_spring_count(world) == 0);
        rheo_world_destroy(world);
    }
}

/* ---- Far away ---- */

/*
 * A block falls at 1e5 supports from the origin. Positions there are multiples of q = 4e5 ULP. Summed: velocities do not come from
 * positions, so the mean velocity is that of free fall; forces shake the particles with the noise of positions, k q/h each, of about
 * 20 neighbours, in each substep; damping leaves a speed of about 1000 q/T (docs/model.md, Far from the origin).
 */
static void a_block_far_from_the_origin_falls(void **unused)
{
    (void)unused;
    enum { N = 125, STEPS = 300 };
    const double place = 4e5, quantum = place * ULP;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        set(&def, "scheme", scheme_name(scheme));
        rheo_real x[3 * N];
        lattice(&def, 5, 5, 5, (double[]){place, place, place}, x);
        rheo_world *world = world_of(def, N, x, NULL);
        drive_all(world, STEPS);
        const double falls = -9.81 * STEPS * def.step;
        double mean[3], shaken = 0;
        for (int a = 0; a < 3; a++)
            mean[a] = momentum(world, a) / N;
        for (int i = 0; i < 3 * N; i++)
            shaken += square((double)rheo_world_velocities(world)[i] - mean[i % 3]) / N;
        print_message("%s: mean %g of %g, shaken at %g L/T, quantum %g\n", scheme_name(scheme), mean[1], falls,
                      sqrt(shaken), quantum);
        if (scheme == RHEO_SCHEME_SEQUENTIAL) {
            /* v = displacement/step: in float g step^2 is below half a quantum, so that gravity is lost or doubled by rounding. */
            assert_true(fabs(mean[1]) <= STEPS * (9.81 * def.step + quantum / def.step) &&
                        sqrt(shaken) < 10 + 1000 * quantum);
        } else {
            NEAR(mean[1] / falls, 1, 1e-4);
            assert_true(sqrt(shaken) < 3 + 500 * quantum);
        }
        rheo_world_destroy(world);
    }
}

/* A scene far away, or with a step in which scheme sequential in float loses gravity, is warned of before it runs. */
static void places_that_are_too_far_are_told(void **unused)
{
    (void)unused;
    static const struct {
        const char *scheme, *step;
        double place;
        size_t warnings[2]; /* float, double */
        const char *says;
    } CASES[] = {
        {"summed", "0.033", 0, {0, 0}, ""},
        {"summed", "0.033", 16000, {0, 0}, ""},
        {"summed",
         "0.033",
         4e5,
         {1, 0},
         "particles are 400000 from the origin, where positions are multiples of 0.031"},
        {"sequential",
         "0.033",
         4e5,
         {2, 0},
         "scheme sequential loses gravity: it moves a particle by 0.011 in a step"},
        {"sequential", "0.033", 0, {0, 0}, ""},
        {"sequential",
         "1e-6",
         0,
         {1, 0},
         "positions up to 7 are multiples of 4.8e-07; take scheme summed or a longer step"},
        {"positions", "1e-6", 0, {0, 0}, ""},
        {"sequential", "1e-12", 0, {1, 1}, "scheme sequential loses gravity"},
    };
    for (size_t k = 0; k < sizeof CASES / sizeof *CASES; k++) {
        rheo_scene scene = rheo_default_scene();
        set(&scene.world, "scheme", CASES[k].scheme);
        set(&scene.world, "step", CASES[k].step);
        scene.fill = some_fills();
        scene.fill_count = 1;
        rheo_fill *fill = fills_of(&scene);
        fill->kind = RHEO_FILL_BLOCK;
        for (int a = 0; a < 3; a++) {
            fill->min[a] = CASES[k].place;
            fill->max[a] = CASES[k].place + 8;
        }
        rheo_warning warning[16];
        size_t count, found = 0;
        OK(rheo_scene_warnings(&scene, warning, 16, &count, &error));
        bool said = CASES[k].warnings[RHEO_DOUBLE] == 0;
        for (size_t w = 0; w < count && w < 16; w++) {
            found += warning[w].kind == RHEO_WARNING_FAR;
            said |= warning[w].kind == RHEO_WARNING_FAR && says(warning[w].text, CASES[k].says);
        }
        if (found != CASES[k].warnings[RHEO_DOUBLE] || !said)
            fail_msg("case %zu: %zu warnings, of them: %s", k, found, count ? warning[count - 1].text : "");
    }
}

/* ---- Denormals ---- */

#if RHEO_DOUBLE
#define DENORMAL 0x1p-1060
#define ITS_ROOT 0x1p-530
#else
#define DENORMAL 0x1p-140
#define ITS_ROOT 0x1p-73
#endif

/*
 * Denormal velocities; positions that differ by denormals, whose squares are 0; by numbers whose squares are denormals, so that
 * directions are rough. Nothing divides by such a square: particles whose distance is not resolved coincide.
 */
static void denormals_are_numbers_like_others(void **unused)
{
    (void)unused;
    enum { N = 125 };
    for (int scheme = 0; scheme < SCHEMES; scheme++)
        for (int k = 0; k < 4; k++) {
            rheo_world_def def = rheo_default_world_def();
            set(&def, "scheme", scheme_name(scheme));
            memset(def.gravity, 0, sizeof def.gravity);
            rheo_real x[3 * N], v[3 * N] = {0};
            def.fluid.spacing = k == 0 ? 5 : 2;
            lattice(&def, 5, 5, 5, (double[]){0, 0, 0}, x);
            for (int i = 0; i < 3 * N; i++) {
                const int odd = i * 7919 % 101;
                if (k < 2)
                    v[i] = (rheo_real)(DENORMAL * (odd - 50));
                else
                    x[i] = (rheo_real)((k == 2 ? DENORMAL : ITS_ROOT) * odd);
            }
            rheo_world *world = world_of(def, N, x, v);
            const course c = drive(world, 30);
            print_message("%s, %d: %d steps, fastest %g\n", scheme_name(scheme), k, c.steps, c.fastest);
            if (k == 0 && scheme != RHEO_SCHEME_SEQUENTIAL) /* alone: velocities keep their bits */
                assert_memory_equal(rheo_world_velocities(world), v, sizeof v);
            assert_int_equal(c.result, RHEO_OK);
            if (k >= 2) /* a rough direction is at most sqrt 2 long */
                assert_true(c.fastest > 1 && c.fastest <= 1.5 * most_speed(&def, N));
            else
                assert_true(c.fastest < 20);
            rheo_world_destroy(world);
        }
}

/* Denormal and huge parameters: none makes a value that is not a number. */
static void denormal_parameters_are_harmless(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++)
        for (size_t i = 0; i < rheo_parameter_count(); i++) {
            const rheo_parameter *p = rheo_parameter_at(i);
            if (!(p->models & 1) || !p->live || p->type != RHEO_PARAMETER_REAL)
                continue;
            rheo_scene scene = lively_scene();
            scene.world.scheme = (rheo_scheme)scheme;
            scene.settle.time = 0;
            rheo_error e;
            char text[32];
            snprintf(text, sizeof text, "%g", RHEO_DOUBLE ? 1e-310 : 1e-40);
            rheo_world *world;
            if (rheo_scene_set(&scene, p->path, text, &e) != RHEO_OK ||
                rheo_scene_create_world(&scene, &world, &e) != RHEO_OK) {
                if (!says(e.message, p->path))
                    fail_msg("%s: %s", p->path, e.message);
                continue;
            }
            const course c = drive(world, 10);
            if (c.result != RHEO_OK)
                fail_msg("%s, %s = %s: %s", scheme_name(scheme), p->path, text, c.error.message);
            rheo_world_destroy(world);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coinciding_particles_part),
        cmocka_unit_test(particles_in_a_plane_stay_in_it),
        cmocka_unit_test(particles_a_support_apart_do_not_move),
        cmocka_unit_test(neighbours_on_cell_borders_are_found),
        cmocka_unit_test(a_gas_without_neighbours_flies_freely),
        cmocka_unit_test(spray_follows_parabolas),
        cmocka_unit_test(a_block_far_from_the_origin_falls),
        cmocka_unit_test(places_that_are_too_far_are_told),
        cmocka_unit_test(denormals_are_numbers_like_others),
        cmocka_unit_test(denormal_parameters_are_harmless),
    };
    return cmocka_run_group_tests_name("hard_places", tests, NULL, NULL);
}
