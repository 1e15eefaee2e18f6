/* Hard cases of the melting model: each is finite and bounded, or refused with a reason. docs/hard-cases.md lists them. */
#include "melting_support.h"

#include "core/text.h"
#include "melting.h"

/* Half of the last bit of 1. */
static const double ROUNDING = RHEO_DOUBLE ? 0x1p-53 : 0x1p-24;

/* What steps led to; the largest numbers are of any step. */
typedef struct outcome {
    int steps; /* made */
    rheo_failure_reason reason;
    double fastest, density, substeps, iterations; /* density: of its error; iterations: per substep */
    double all_substeps;
} outcome;

/* Makes steps until one is refused. A refused step leaves the world as it was, and has a reason. */
static outcome run(rheo_world *world, int steps)
{
    outcome o = {0};
    for (; o.steps < steps; o.steps++) {
        const uint64_t before = rheo_world_hash(world);
        rheo_error why = {""};
        const rheo_result result = rheo_world_step(world, &why);
        if (result != RHEO_OK) {
            rheo_failure failure;
            assert_int_equal(result, RHEO_ERROR_STATE);
            assert_true(rheo_world_failure(world, &failure));
            assert_true(rheo_world_hash(world) == before);
            assert_true(failure.reason != RHEO_FAILURE_NONE && strlen(why.message) > 40);
            o.reason = failure.reason;
            return o;
        }
        o.fastest = fmax(o.fastest, fastest(world));
        o.density = fmax(o.density, metric(world, "max_density_error"));
        o.substeps = fmax(o.substeps, metric(world, "substeps"));
        o.iterations = fmax(o.iterations, metric(world, "iterations") / metric(world, "substeps"));
        o.all_substeps += metric(world, "substeps");
    }
    return o;
}

static void show(const char *what, const outcome *o)
{
    print_message("%s: %d steps, speed %.3g, density error %.3g, substeps %.0f, iterations %.1f, %s\n", what,
                  o->steps, o->fastest, o->density, o->substeps, o->iterations, rheo_failure_reason_name(o->reason));
}

static double lowest_temperature(const rheo_world *world)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < world->state.particles; i++)
        least = fmin(least, (double)world->state.temperature[i]);
    return least;
}
static double highest_temperature(const rheo_world *world)
{
    double most = -INFINITY;
    for (uint32_t i = 0; i < world->state.particles; i++)
        most = fmax(most, (double)world->state.temperature[i]);
    return most;
}

/* ---- Solids and temperatures ---- */

/* The height of the box is 1, so nothing is faster than a fall from its top. Beyond 1e7, J changes nothing. */
static void jump_numbers_from_0_to_1e9(void **unused)
{
    (void)unused;
    static const char *const J[] = {"0", "1", "1e5", "1e7", "1e9"};
    enum { COUNT = sizeof J / sizeof *J };
    for (int nested = 0; nested < 2; nested++) {
        double moved[COUNT];
        for (size_t k = 0; k < COUNT; k++) {
            rheo_world_def def = melt_def(0.125);
            set(&def, "melting.jump_number_max", J[k]);
            def.melting.stress = nested ? RHEO_STRESS_NESTED : RHEO_STRESS_PAIRWISE;
            rheo_world *world = melting_box(def, 4, 8, 4);
            const outcome o = run(world, 50);
            show(J[k], &o);
            assert_int_equal(o.steps, 50);
            assert_true(o.fastest < sqrt(2) && o.density < 0.1 && o.iterations <= 100);
            assert_true(lowest(world, 1) >= 0);
            moved[k] = metric(world, "cold_displacement");
            rheo_world_destroy(world);
        }
        print_message("cold part, J 0 to 1e9: moved by %.3g %.3g %.3g %.3g %.3g\n", moved[0], moved[1], moved[2],
                      moved[3], moved[4]);
        assert_true(moved[0] > 0.05 && moved[1] > moved[2] && moved[2] > 0.9 * moved[3]);
        for (int solid = 2; solid < COUNT; solid++)
            assert_true(moved[solid] < 5e-3);
    }
    rheo_world_def def = melt_def(0.125);
    def.melting.solver = RHEO_VISCOSITY_EXPLICIT;
    set(&def, "melting.jump_number_max", "1e9");
    rheo_world *world = melting_box(def, 4, 8, 4);
    assert_int_equal(run(world, 1).reason, RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY);
    rheo_world_destroy(world);
}

/*
 * Neighbours 1e6 apart. Heat flows downhill only, so the extremes never grow. A substep rounds each temperature by half
 * of its last bit, and its change, which is below a hundredth of the temperature, by 100 times as much relative to itself.
 */
static void temperatures_jump_by_a_million(void **unused)
{
    (void)unused;
    for (double jump = 1e6; jump > -2e6; jump -= 2e6) {
        rheo_world_def def = melt_def(0.1);
        add_wall(&def, 0, 0, 0, 0, 1, 0);
        fluid f = lattice(0.1, 4, 6, 4, 0.1);
        f.warm = true;
        for (uint32_t i = 0; i < f.count; i++)
            f.temperature[i] = i % 2 ? (rheo_real)jump : 0;
        rheo_world *world = melt_of(def, f);
        const double before = heat_of(world);
        double low = fmin(jump, 0), high = fmax(jump, 0), substeps = 0;
        for (int s = 0; s < 100; s++) {
            const outcome o = run(world, 1);
            assert_true(o.steps == 1 && o.fastest < 2 && o.density < 0.1);
            assert_true(lowest_temperature(world) >= low && highest_temperature(world) <= high);
            low = lowest_temperature(world);
            high = highest_temperature(world);
            substeps += o.substeps;
        }
        print_message("temperatures from 0 to %g: %g to %g in the end, heat changed by %.2g\n", jump, low, high,
                      heat_of(world) / before - 1);
        NEAR(heat_of(world) / before, 1, 2 * ROUNDING * substeps);
        rheo_world_destroy(world);
    }
}

/* A table of solid with a hole, and a drop of liquid above it. It falls through the hole and spreads on the floor. */
static void a_drop_falls_through_a_hole(void **unused)
{
    (void)unused;
    const double s = 0.1;
    rheo_world_def def = melt_def(s);
    def.melting.diffusivity = 0;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    fluid f = {0};
    f.warm = true;
    add_lattice(&f, s, (double[]){0, 0, 0}, 3, 8, 12, 0); /* legs */
    add_lattice(&f, s, (double[]){10 * s, 0, 0}, 3, 8, 12, 0);
    add_lattice(&f, s, (double[]){3 * s, 5 * s, 0}, 7, 3, 3, 0); /* top, around a hole of 6 x 6 spacings */
    add_lattice(&f, s, (double[]){3 * s, 5 * s, 9 * s}, 7, 3, 3, 0);
    const uint32_t cold = f.count;
    add_lattice(&f, s, (double[]){5 * s, 10 * s, 4.5 * s}, 3, 3, 3, 0);
    for (uint32_t i = cold; i < f.count; i++)
        f.temperature[i] = 1;
    rheo_world *world = melt_of(def, f);
    const outcome o = run(world, 150);
    double moved = 0, top = 0;
    for (uint32_t i = 0; i < world->state.particles; i++) {
        const rheo_real *x = world->state.position + 3 * i, *from = world->state.start_position + 3 * i;
        if (i >= cold)
            top = fmax(top, (double)x[1]);
        else
            for (int axis = 0; axis < 3; axis++)
                moved = fmax(moved, fabs((double)x[axis] - (double)from[axis]));
    }
    show("hole", &o);
    print_message("hole: the drop ends below %.2f spacings, the table moved by %.2g spacings\n", top / s, moved / s);
    assert_int_equal(o.steps, 150);
    assert_true(top < 5 * s && lowest(world, 1) >= 0);
    assert_true(moved < 0.3 * s);
    assert_true(o.fastest < sqrt(2 * 13 * s) && o.density < 0.2);
    rheo_world_destroy(world);
}

/*
 * A drop of hot and cold particles side by side, as warm as solid in the mean, solidifies while it falls and spins. Its fall
 * stays that of a stone, and so does the drop: distances of its particles no longer change.
 */
static void a_drop_freezes_while_it_falls(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.melting.diffusivity = 0.02;
    fluid f = sphere(0.1, 0.4);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++) {
        f.temperature[i] = i % 2 ? 0 : (rheo_real)0.7; /* mean 0.35 */
        f.v[3 * i] = f.x[3 * i + 2] / 2;
        f.v[3 * i + 2] = -f.x[3 * i] / 2;
    }
    rheo_world *world = melt_of(def, f);
    const uint32_t count = world->state.particles;
    const double heat = heat_of(world);
    assert_true(highest_temperature(world) > def.melting.temperature_max);
    outcome o = run(world, 100);
    double substeps = o.all_substeps, momentum[3], stretched = 0;
    assert_true(o.steps == 100 && highest_temperature(world) < def.melting.temperature_min);
    rheo_real *frozen = malloc(3 * (size_t)count * sizeof *frozen);
    assert_non_null(frozen);
    memcpy(frozen, world->state.position, 3 * (size_t)count * sizeof *frozen);
    o = run(world, 100);
    substeps += o.all_substeps;
    momentum_of(world, momentum);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < i; j++) {
            double then = 0, now = 0;
            for (int axis = 0; axis < 3; axis++) {
                then += pow((double)frozen[3 * i + axis] - (double)frozen[3 * j + axis], 2);
                now +=
                    pow((double)world->state.position[3 * i + axis] - (double)world->state.position[3 * j + axis], 2);
            }
            stretched = fmax(stretched, fabs(sqrt(now) - sqrt(then)));
        }
    print_message("freezing: velocity/(g t) %.7f, heat changed by %.2g, distances by %.2g spacings in a time of 2\n",
                  momentum[1] / count / -4, heat_of(world) / heat - 1, stretched / 0.1);
    /* Each substep rounds a velocity of at most 4 by half of its last bit. */
    NEAR(momentum[1] / count, -4, 4 * ROUNDING * substeps);
    NEAR(momentum[0] / count, 0, 4 * ROUNDING * substeps);
    NEAR(heat_of(world) / heat, 1, 2 * ROUNDING * substeps);
    assert_true(stretched < 0.1 * 0.1);
    free(frozen);
    rheo_world_destroy(world);
}

/* A box without room: full to the lid, with up to 1.3^3 times the mass. Gravity turns over. */
static void a_box_is_full_to_the_lid(void **unused)
{
    (void)unused;
    static const double filled[] = {1, 1.1, 1.3};
    static const char *const gravity[] = {"[0, -1, 0]", "[0, 1, 0]", "[1, 0, 0]", "[0, 0, 0]"};
    for (int hot = 0; hot < 2; hot++)
        for (size_t k = 0; k < sizeof filled / sizeof *filled; k++) {
            const double spacing = 0.1, width = 6 * spacing / filled[k];
            rheo_world_def def = melt_def(spacing);
            def.melting.temperature = hot;
            add_box(&def, width, width);
            add_wall(&def, 0, width, 0, 0, -1, 0);
            fluid f = lattice(spacing / filled[k], 6, 6, 6, 0);
            for (uint32_t i = 0; i < f.count; i++)
                f.density[i] = (rheo_real)pow(filled[k], 3);
            rheo_world *world = melt_of(def, f);
            outcome all = {0}, o = {0};
            for (size_t turn = 0; turn < sizeof gravity / sizeof *gravity; turn++) {
                OK(rheo_world_set(world, "gravity", gravity[turn], &error));
                o = run(world, 25);
                assert_int_equal(o.steps, 25);
                all.fastest = fmax(all.fastest, o.fastest);
                all.density = fmax(all.density, o.density);
                for (int axis = 0; axis < 3; axis++)
                    assert_true(lowest(world, axis) >= 0 && highest(world, axis) <= width * (1 + 4 * ROUNDING));
            }
            print_message("box, %s, %.2f of its mass: speed at most %.2g, %.2g in the end, density error %.3g\n",
                          hot ? "hot" : "cold", pow(filled[k], 3), all.fastest, fastest(world), all.density);
            assert_true(all.fastest < 0.05 * def.melting.sound_speed);
            assert_true(fabs(1 + all.density - pow(filled[k], 3)) < 0.1);
            rheo_world_destroy(world);
        }
}

/* ---- Impacts and sprays ---- */

/*
 * A block hits the floor at up to 1e5 times the usual speed, 1. Energy is never made, so far above the speed of sound it
 * bursts into pieces that are no faster than it was. A step that would need too many substeps is refused.
 */
static void impacts_at_any_speed(void **unused)
{
    (void)unused;
    for (int hot = 0; hot < 2; hot++)
        for (double speed = 1; speed <= 1e5; speed *= 10) {
            rheo_world_def def = melt_def(0.1);
            def.melting.temperature = hot;
            add_wall(&def, 0, 0, 0, 0, 1, 0);
            fluid f = lattice(0.1, 4, 4, 4, 0);
            for (uint32_t i = 0; i < f.count; i++) {
                f.x[3 * i + 1] += (rheo_real)0.05;
                f.v[3 * i + 1] = (rheo_real)-speed;
            }
            rheo_world *world = melt_of(def, f);
            const double before = metric(world, "kinetic_energy"), weight = 0.064 * 0.5;
            const outcome o = run(world, 10);
            if (speed == 1 || speed == 100)
                show(hot ? "impact, hot" : "impact, cold", &o);
            if (speed < 1e5) {
                assert_true(o.steps == 10 && o.reason == RHEO_FAILURE_NONE);
                assert_true(metric(world, "kinetic_energy") < before + weight);
                assert_true(o.fastest < 1.3 * speed);
                assert_true(lowest(world, 1) >= 0);
            } else {
                assert_true(o.steps == 0 && o.reason == RHEO_FAILURE_SUBSTEPS_FOR_SOUND);
            }
            rheo_world_destroy(world);
        }
}

/* 2 and 20 particles in one place part, 1000 are refused; they have the momentum that they had, none. */
static void coincident_particles(void **unused)
{
    (void)unused;
    static const int counts[] = {2, 20, 1000};
    for (int hot = 0; hot < 2; hot++)
        for (int k = 0; k < 3; k++) {
            rheo_world_def def = melt_def(0.1);
            def.gravity[1] = 0;
            def.melting.temperature = hot;
            fluid f = {0};
            for (int i = 0; i < counts[k]; i++)
                add_particle(&f, 0.3, 0.4, 0.5);
            rheo_world *world = melt_of(def, f);
            const outcome o = run(world, 10);
            double momentum[3], width = 0;
            momentum_of(world, momentum);
            for (int axis = 0; axis < 3; axis++)
                width = fmax(width, highest(world, axis) - lowest(world, axis));
            show(hot ? "coincident, hot" : "coincident, cold", &o);
            print_message("coincident: %d particles fill %.2g spacings after %d steps\n", counts[k], width / 0.1,
                          o.steps);
            assert_true(o.steps == 10 || o.reason == RHEO_FAILURE_DENSITY_NOT_POSITIVE);
            for (int axis = 0; axis < 3; axis++)
                NEAR(momentum[axis], 0,
                     ROUNDING * counts[k] * counts[k] * fmax(o.fastest, 1) * fmax(o.all_substeps, 1));
            if (k < 2) /* the drift moved 20 against their velocities, so they stayed in 0.03 spacings */
                assert_true(o.steps == 10 && width > 0.2 * 0.1 && o.fastest < def.melting.sound_speed);
            rheo_world_destroy(world);
        }
}

/*
 * Without neighbours a particle flies as a stone, v += dt g, x += dt v: to the last bit without stage viscosity, which
 * rounds each velocity once more.
 */
static void a_gas_without_neighbours_flies_freely(void **unused)
{
    (void)unused;
    enum { SIDE = 5, COUNT = SIDE * SIDE * SIDE };
    for (int viscous = 0; viscous < 2; viscous++) {
        rheo_world_def def = melt_def(0.05);
        def.melting.viscosity *= viscous;
        fluid f = {0};
        rheo_real x[3 * COUNT], v[3 * COUNT];
        for (int i = 0; i < COUNT; i++) {
            add_particle(&f, 0.2 * (i % SIDE), 0.2 * (i / SIDE % SIDE), 0.2 * (i / SIDE / SIDE));
            for (int axis = 0; axis < 3; axis++)
                f.v[3 * i + axis] = 20 * f.x[3 * i + axis] - 7;
        }
        memcpy(x, f.x, sizeof x);
        memcpy(v, f.v, sizeof v);
        rheo_world *world = melt_of(def, f);
        double substeps = 0;
        for (int s = 0; s < 200; s++) {
            const outcome o = run(world, 1);
            assert_true(o.steps == 1 && o.density == 0 && o.iterations == 0);
            const rheo_real substep = (rheo_real)(def.step / o.substeps);
            substeps += o.substeps;
            for (int i = 0; i < o.substeps; i++)
                for (size_t k = 0; k < 3 * COUNT; k++) {
                    v[k] += substep * (rheo_real)def.gravity[k % 3];
                    x[k] += substep * v[k];
                }
            for (size_t k = 0; k < 3 * COUNT && viscous; k++)
                NEAR((double)world->state.velocity[k], (double)v[k], 4 * 16 * ROUNDING * substeps);
            if (!viscous) {
                assert_memory_equal(world->state.position, x, sizeof x);
                assert_memory_equal(world->state.velocity, v, sizeof v);
            }
        }
        rheo_world_destroy(world);
    }
}

/* A hundred drops of eight particles fly apart through each other at five times the speed of sound. */
static void a_spray_flies_apart(void **unused)
{
    (void)unused;
    for (int hot = 0; hot < 2; hot++) {
        rheo_world_def def = melt_def(0.05);
        def.melting.temperature = hot;
        def.gravity[1] = 0;
        fluid f = {0};
        random_state = 1;
        for (int drop = 0; drop < 100; drop++) {
            const double d[3] = {random_unit() - 0.5, random_unit() - 0.5, random_unit() - 0.5};
            const double by = 50 / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            const uint32_t first = f.count;
            add_lattice(&f, 0.05, (double[]){0.3 * (drop % 5), 0.3 * (drop / 5 % 5), 0.3 * (drop / 25)}, 2, 2, 2,
                        0.1);
            for (uint32_t k = 3 * first; k < 3 * f.count; k++)
                f.v[k] = (rheo_real)(by * d[k % 3]);
        }
        rheo_world *world = melt_of(def, f);
        const uint32_t count = world->state.particles;
        const double energy = metric(world, "kinetic_energy");
        double before[3], after[3];
        momentum_of(world, before);
        const outcome o = run(world, 60);
        momentum_of(world, after);
        show(hot ? "spray, hot" : "spray, cold", &o);
        assert_int_equal(o.steps, 60);
        assert_true(o.fastest < 50 + def.melting.sound_speed);
        assert_true(metric(world, "kinetic_energy") < energy && highest(world, 0) - lowest(world, 0) > 60);
        for (int axis = 0; axis < 3; axis++) /* half of the last bit of a speed of 50, in each substep */
            NEAR((after[axis] - before[axis]) / count, 0, 50 * ROUNDING * o.all_substeps);
        rheo_world_destroy(world);
    }
}

/* ---- Numbers ---- */

/* Units of length, time, density and temperature that are powers of two. */
typedef struct units {
    int length, time, density, temperature;
} units;

static rheo_world *in_units(units u, int variant)
{
    const double length = ldexp(1, u.length), time = ldexp(1, u.time), density = ldexp(1, u.density),
                 kelvin = ldexp(1, u.temperature), spacing = 0.125 * length;
    rheo_world_def def = melt_def(spacing);
    def.step *= time;
    def.gravity[1] *= length / (time * time);
    def.melting.rest_density = density;
    def.melting.sound_speed *= length / time;
    def.melting.viscosity *= density * length * length / time;
    def.melting.time_scale *= time;
    def.melting.diffusivity *= length * length / time;
    def.melting.temperature_min *= kelvin;
    def.melting.temperature_max *= kelvin;
    def.melting.stress = variant == 1 ? RHEO_STRESS_NESTED : RHEO_STRESS_PAIRWISE;
    def.melting.laplacian = variant == 2 ? RHEO_LAPLACIAN_SECOND : RHEO_LAPLACIAN_FIRST;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    add_wall(&def, -spacing, 0, 0, 1, 0, 0.5);
    random_state = 7;
    fluid f = lattice(spacing, 4, 6, 4, 0.1);
    warm_by_height(&f, 6 * spacing / kelvin);
    for (uint32_t i = 0; i < f.count; i++)
        f.density[i] = (rheo_real)density;
    return melt_of(def, f);
}

static void assert_scaled(const rheo_real *values, int power, const rheo_real *other, size_t count)
{
    for (size_t i = 0; i < count; i++)
        assert_true((double)values[i] == ldexp((double)other[i], power));
}

/* Lengths, times, densities and temperatures in other units give the same bits, or are refused. */
static void units_do_not_change_bits(void **unused)
{
    (void)unused;
    static const units trials[] = {{-12, 0, 0, 0}, {16, 0, 0, 0}, {0, 20, 0, 0},  {0, -20, 0, 0},    {0, 0, 20, 0},
                                   {0, 0, -20, 0}, {0, 0, 0, 20}, {0, 0, 0, -20}, {-12, -10, 15, 20}};
    for (int variant = 0; variant < 3; variant++) {
        rheo_world *world = in_units((units){0, 0, 0, 0}, variant);
        assert_int_equal(run(world, 10).steps, 10);
        const size_t count = world->state.particles;
        for (size_t t = 0; t < sizeof trials / sizeof *trials; t++) {
            units u = trials[t];
            if (!IS_FLOAT && u.length)
                u.length = u.length < 0 ? -20 : 20;
            rheo_world *scaled = in_units(u, variant);
            assert_int_equal(run(scaled, 10).steps, 10);
            assert_scaled(scaled->state.position, u.length, world->state.position, 3 * count);
            assert_scaled(scaled->state.velocity, u.length - u.time, world->state.velocity, 3 * count);
            assert_scaled(scaled->state.density, u.density, world->state.density, count);
            assert_scaled(scaled->state.temperature, u.temperature, world->state.temperature, count);
            rheo_world_destroy(scaled);
        }
        rheo_world_destroy(world);
    }
}

/* The factors of pairs overflowed silently with smoothing lengths that were allowed, and solid crept. */
static void lengths_beyond_the_range_of_numbers_are_refused(void **unused)
{
    (void)unused;
    if (!IS_FLOAT)
        skip();
    static const double bad[] = {9e-6, 1e-7, 1.1e5, 1e12};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        rheo_world_def def = melt_def(bad[k]);
        REFUSED(RHEO_ERROR_ARGUMENT, "choose another unit of length", rheo_world_def_check(&def, &error));
    }
    static const double good[] = {1.01e-5, 9.9e4};
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        const double s = good[k];
        rheo_world_def def = melt_def(s);
        def.gravity[1] *= s;
        def.melting.sound_speed *= s;
        def.melting.viscosity *= s * s;
        fluid f = lattice(s, 4, 4, 4, 0);
        for (uint32_t i = 0; i < f.count; i++)
            f.v[3 * i] = f.x[3 * i + 1]; /* shear */
        rheo_world *world = melt_of(def, f);
        step(world, 1);
        for (uint32_t i = 0; i < world->state.particles; i++)
            assert_true(rheo__melting_of(world)->viscous_factor[i] > 0.1 &&
                        rheo__melting_of(world)->viscous_factor[i] < 50);
        rheo_world_destroy(world);
    }
}

/*
 * A body that falls 1e5 h from the origin keeps its velocities: their mean is g t. In float its places are multiples of
 * h/128, so where it moves slowly it stays.
 */
static void far_from_the_origin(void **unused)
{
    (void)unused;
    const double spacing = 0.1, away = 1e5 * spacing, grid = away * 2 * ROUNDING;
    for (int hot = 0; hot < 2; hot++) {
        rheo_world_def def = melt_def(spacing);
        def.melting.temperature = hot;
        fluid f = {0};
        add_lattice(&f, spacing, (double[]){away, away, away}, 4, 4, 4, 0);
        rheo_world *world = melt_of(def, f);
        const double from = lowest(world, 1);
        const outcome o = run(world, 100);
        double momentum[3];
        momentum_of(world, momentum);
        print_message("far: velocity/(g t) %.7f, fell by %.4f, a height of 0.3 became %.4f\n", momentum[1] / -128,
                      from - lowest(world, 1), highest(world, 1) - lowest(world, 1));
        assert_int_equal(o.steps, 100);
        NEAR(momentum[1] / 64, -2, 2 * ROUNDING * o.all_substeps);
        NEAR(from - lowest(world, 1), 2, grid / 2 * o.all_substeps / 10 + 0.01);
        NEAR(highest(world, 1) - lowest(world, 1), 0.3, 4 * grid);
        rheo_world_destroy(world);
        /* Where places are coarser than the body, all particles are in one. */
        f = (fluid){0};
        add_lattice(&f, spacing, (double[]){1e3 * away, 1e3 * away, 1e3 * away}, 4, 4, 4, 0);
        world = melt_of(def, f);
        const outcome lost = run(world, 5);
        show("farther", &lost);
        rheo_world_destroy(world);
    }
}

/* Velocities, temperatures and displacements of the size of the least numbers: they stay of that size. */
static void denormals_stay_small(void **unused)
{
    (void)unused;
    const double tiny = IS_FLOAT ? 0x1p-140 : 0x1p-1065;
    rheo_world_def def = melt_def(0.1);
    def.gravity[1] = 0;
    def.melting.temperature_min = tiny;
    def.melting.temperature_max = 3 * tiny;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    fluid f = lattice(0.1, 4, 4, 4, 0);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++) {
        f.temperature[i] = (rheo_real)(tiny * (i % 5));
        for (int axis = 0; axis < 3; axis++)
            f.v[3 * i + axis] = (rheo_real)(tiny * ((int)(3 * i + axis) % 7 - 3));
    }
    rheo_world *world = melt_of(def, f);
    const double heat = heat_of(world);
    const outcome o = run(world, 50);
    assert_true(o.steps == 50 && o.density < 1e-6);
    for (uint32_t i = 0; i < 3 * world->state.particles; i++)
        assert_true(fabs((double)world->state.velocity[i]) <= 4 * tiny);
    assert_true(lowest_temperature(world) >= 0 && highest_temperature(world) <= 4 * tiny);
    NEAR(heat_of(world) / heat, 1, 0.05);
    rheo_world_destroy(world);
}

/* ---- Commands ---- */

/* A value of a parameter: its least, its largest, and one between. */
static void value_of(const rheo_parameter *p, int way, char text[96])
{
    const double least = p->above_minimum ? 1e-12 : p->minimum,
                 most = strcmp(p->path, "melting.substeps") == 0 ? 500 : p->maximum,
                 between = sqrt(fmax(least, 1e-3) * fmin(most, 1e9)),
                 value = way == 0   ? least
                         : way == 1 ? most
                                    : between;
    if (p->type == RHEO_PARAMETER_CHOICE)
        snprintf(text, 96, "%s", p->choices[way]);
    else if (p->type == RHEO_PARAMETER_VECTOR)
        snprintf(text, 96, way == 0 ? "[0, 0, 0]" : way == 1 ? "[1e12, -1e12, 0]" : "[1000, 0, 0]");
    else
        rheo__text_from_double(p->type == RHEO_PARAMETER_INTEGER ? floor(value) : value, text);
}

/*
 * The step and every other live parameter changes in mid-run to values up to the limits of its range, and back. Steps are
 * made or refused for a reason, and a refusal costs nothing: the world goes on as if nothing had been.
 */
static void live_parameters_change_to_their_limits(void **unused)
{
    (void)unused;
    const rheo_parameter *p;
    uint32_t changed = 0, stepped = 0, refused = 0;
    rheo_real values[7 * 8];
    rheo_world_def def = melting_def(2, values);
    rheo_world *plain;
    OK(rheo_world_create(&def, &plain, &error));
    assert_int_equal(run(plain, 12).steps, 12);
    for (size_t i = 0; (p = rheo_parameter_at(i)); i++) {
        const int ways = p->type == RHEO_PARAMETER_CHOICE ? (int)p->choice_count : 3;
        if (!p->live || !(p->models & UINT32_C(1) << RHEO_MODEL_MELTING))
            continue;
        for (int way = 0; way < ways; way++) {
            rheo_world *world;
            OK(rheo_world_create(&def, &world, &error));
            assert_int_equal(run(world, 2).steps, 2);
            char old[96], text[96];
            OK(rheo_world_def_get(rheo_world_definition(world), p->path, old, sizeof old));
            value_of(p, way, text);
            rheo_error why = {""};
            const bool accepted = rheo_world_set(world, p->path, text, &why) == RHEO_OK;
            assert_true(accepted || strlen(why.message) > 40);
            changed += accepted;
            const outcome o = accepted ? run(world, 2) : (outcome){0};
            stepped += o.steps == 2;
            refused += accepted && o.steps < 2;
            OK(rheo_world_set(world, p->path, old, &error));
            const outcome back = run(world, 10);
            if (o.steps == 0)
                assert_memory_equal(world->state.position, plain->state.position, 24 * sizeof(rheo_real));
            else
                assert_true(back.steps == 10 || back.reason == RHEO_FAILURE_SUBSTEPS_FOR_SOUND);
            rheo_world_destroy(world);
        }
    }
    print_message("%u changes: steps were made after %u and refused after %u\n", changed, stepped, refused);
    assert_true(changed > 80 && stepped > 70 && refused > 10 && stepped + refused == changed);
    rheo_world_destroy(plain);
}

/*
 * A pool poured into a box, eight particles at a time, over 1000 steps. Where surfaces merge, neighbours approach, so
 * integrated densities grow and particles stay farther apart: the pool has more than twice its volume. Summed densities
 * keep it.
 */
static void a_pool_is_poured_in(void **unused)
{
    (void)unused;
    const double spacing = 0.1, width = 1.2;
    for (int summed = 0; summed < 2; summed++) {
        rheo_world_def def = melt_def(spacing);
        def.melting.temperature = 1;
        def.melting.density = summed ? RHEO_DENSITY_SUMMATION : RHEO_DENSITY_CONTINUITY;
        add_box(&def, width, width);
        rheo_world *world = melt_of(def, (fluid){0});
        fluid drop = {0};
        add_lattice(&drop, spacing, (double[]){0.5, 1.2, 0.5}, 2, 2, 2, 0);
        for (uint32_t i = 0; i < drop.count; i++)
            drop.v[3 * i + 1] = (rheo_real)-0.5;
        outcome all = {0};
        for (int s = 0; s < 1000; s++) {
            if (s % 20 == 0)
                OK(rheo_world_add_particles(world, drop.count, drop.x, drop.v, &error));
            const outcome o = run(world, 1);
            assert_int_equal(o.steps, 1);
            all.fastest = fmax(all.fastest, o.fastest);
            all.density = fmax(all.density, o.density);
        }
        assert_int_equal(run(world, 100).steps, 100);
        double height = 0;
        for (uint32_t i = 0; i < world->state.particles; i++)
            height += 2 * (double)world->state.position[3 * i + 1] / world->state.particles;
        const double volume = height * width * width / (world->state.particles * pow(spacing, 3));
        print_message("poured, density %s: speed %.3g, density error %.2g, volume %.2f, speed at rest %.2g\n",
                      summed ? "summation" : "continuity", all.fastest, all.density, volume, fastest(world));
        assert_int_equal(world->state.particles, 400);
        assert_true(all.fastest < (summed ? 5 : sqrt(0.25 + 2 * 1.4)) && all.density < (summed ? 0.9 : 0.1));
        assert_true(summed ? volume > 0.95 && volume < 1.1 : volume > 1.5 && volume < 3);
        assert_true(fastest(world) < 0.3);
        for (int axis = 0; axis < 3; axis++)
            assert_true(lowest(world, axis) >= 0 &&
                        (axis == 1 || highest(world, axis) <= width * (1 + 4 * ROUNDING)));
        release_fluid(&drop);
        rheo_world_destroy(world);
    }
}

/* Particles added where others are burst apart, until their densities are refused. */
static void adding_into_fluid_is_refused_in_the_end(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    rheo_world *world = melting_box(def, 4, 4, 4);
    fluid f = lattice(0.1, 4, 4, 4, 0.05);
    outcome o = {0};
    int times = 0;
    for (; times < 60 && o.reason == RHEO_FAILURE_NONE; times++) {
        OK(rheo_world_add_particles(world, f.count, f.x, f.v, &error));
        o = run(world, 1);
    }
    print_message("added into fluid %d times: %s\n", times, rheo_failure_reason_name(o.reason));
    assert_int_equal(o.reason, RHEO_FAILURE_DENSITY_NOT_POSITIVE);
    release_fluid(&f);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jump_numbers_from_0_to_1e9),
        cmocka_unit_test(temperatures_jump_by_a_million),
        cmocka_unit_test(a_drop_falls_through_a_hole),
        cmocka_unit_test(a_drop_freezes_while_it_falls),
        cmocka_unit_test(a_box_is_full_to_the_lid),
        cmocka_unit_test(impacts_at_any_speed),
        cmocka_unit_test(coincident_particles),
        cmocka_unit_test(a_gas_without_neighbours_flies_freely),
        cmocka_unit_test(a_spray_flies_apart),
        cmocka_unit_test(units_do_not_change_bits),
        cmocka_unit_test(lengths_beyond_the_range_of_numbers_are_refused),
        cmocka_unit_test(far_from_the_origin),
        cmocka_unit_test(denormals_stay_small),
        cmocka_unit_test(live_parameters_change_to_their_limits),
        cmocka_unit_test(a_pool_is_poured_in),
        cmocka_unit_test(adding_into_fluid_is_refused_in_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
