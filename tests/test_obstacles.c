/* Contact with obstacles and their motion (solids/obstacles.c, docs/model.md, Obstacles). */
#include "obstacles.h"

enum { MOST = 1000 };

static rheo_world *make(const rheo_world_def *def)
{
    rheo_world *world;
    OK(rheo_world_create(def, &world, &error));
    return world;
}

/* A block of side^3 particles of the default fluid above y = 0. */
static void block(rheo_world_def *def, rheo_real *position, uint32_t side, double height)
{
    uint32_t n = 0;
    for (uint32_t x = 0; x < side; x++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t z = 0; z < side; z++, n++) {
                position[3 * n] = (rheo_real)(2 * x - (side - 1.0) + 0.2 * random_signed());
                position[3 * n + 1] = (rheo_real)(height + 2 * y + 0.2 * random_signed());
                position[3 * n + 2] = (rheo_real)(2 * z - (side - 1.0) + 0.2 * random_signed());
            }
    def->particles.count = n;
    def->particles.position = position;
}

static double largest_difference(const rheo_world *a, const rheo_world *b)
{
    double most = 0;
    for (size_t i = 0; i < 3 * (size_t)rheo_world_particle_count(a); i++) {
        most = fmax(most, fabs((double)(rheo_world_positions(a)[i] - rheo_world_positions(b)[i])));
        most = fmax(most, fabs((double)(rheo_world_velocities(a)[i] - rheo_world_velocities(b)[i])));
    }
    return most;
}

/* ---- Contact ---- */

/* With history, so that fluid sticks, and a ball that rolls. Differences of rounding grow from step to step. */
static void a_large_box_is_a_wall(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    for (rheo_scheme scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++) {
        rheo_world_def of_wall = rheo_default_world_def();
        const rheo_wall wall = {{0, 0, 0}, {0, 1, 0}};
        of_wall.scheme = scheme;
        of_wall.history.window = 5;
        of_wall.gravity[0] = 3;
        of_wall.ball.radius = 2;
        of_wall.ball.position[0] = 20;
        of_wall.ball.position[1] = 2.05;
        of_wall.ball.velocity[0] = 5;
        of_wall.ball.velocity[1] = -4;
        of_wall.ball.spin[2] = 1;
        block(&of_wall, x, 4, 0.5);
        rheo_world_def of_box = of_wall;
        of_wall.walls.count = 1;
        of_wall.walls.plane = &wall;
        rheo_obstacle box = box_obstacle(200, 60, 200);
        box.position[1] = -30;
        box.rotation[1] = 90;
        add_obstacle(&of_box, box);
        rheo_world *a = make(&of_wall), *b = make(&of_box);
        const double rounding = RHEO_DOUBLE ? 1e-12 : 2e-5;
        for (int s = 0; s < 8; s++) {
            step(a, 1);
            step(b, 1);
            if (!(largest_difference(a, b) <= rounding * (1 << s)))
                fail_msg("scheme %d, step %d: %g", (int)scheme, s + 1, largest_difference(a, b));
            rheo_body at_wall, at_box;
            rheo_world_body(a, 0, &at_wall);
            rheo_world_body(b, 0, &at_box);
            for (int axis = 0; axis < 3; axis++) {
                NEAR(at_box.position[axis], at_wall.position[axis], rounding * 4);
                NEAR(at_box.spin[axis], at_wall.spin[axis], rounding * 4);
            }
        }
        rheo_body ball;
        rheo_world_body(b, 0, &ball);
        assert_true(ball.spin[2] < -0.2); /* it has begun to roll */
        rheo_world_destroy(a);
        rheo_world_destroy(b);
    }
}

/* A box that is driven into fluid at rest, and fluid that is driven into a box at rest. */
static void a_moving_box_is_a_wall_in_its_own_frame(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST], v[3 * MOST];
    const double u[3] = {2, 3, -1};
    rheo_world_def still = rheo_default_world_def();
    memset(still.gravity, 0, sizeof still.gravity);
    still.history.window = 5;
    block(&still, x, 4, 1.5);
    rheo_world_def driven = still;
    rheo_obstacle box = box_obstacle(100, 20, 100);
    box.position[1] = -10;
    add_obstacle(&driven, box);
    for (size_t i = 0; i < 3 * (size_t)still.particles.count; i++)
        v[i] = (rheo_real)-u[i % 3];
    driven.particles.velocity = v;
    memcpy(box.velocity, u, sizeof u);
    add_obstacle(&still, box);
    rheo_world *a = make(&still), *b = make(&driven);
    for (int s = 0; s < 8; s++) {
        step(a, 1);
        step(b, 1);
        const double t = rheo_world_time(a), rounding = (RHEO_DOUBLE ? 1e-13 : 1e-4) * (1 << s);
        for (size_t i = 0; i < 3 * (size_t)still.particles.count; i++) {
            NEAR((double)rheo_world_positions(a)[i], (double)rheo_world_positions(b)[i] + t * u[i % 3], rounding);
            NEAR((double)rheo_world_velocities(a)[i], (double)rheo_world_velocities(b)[i] + u[i % 3], rounding * 10);
        }
    }
    assert_true(metric(a, "max_speed") > 1); /* it has been pushed */
    rheo_world_destroy(a);
    rheo_world_destroy(b);
}

/* Overlap is removed, but for a hundred-thousandth, so no particle is nearer than half a spacing. */
static void fluid_does_not_enter(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    static test_mesh mesh;
    sphere_mesh(&mesh, 5, 8);
    for (rheo_scheme scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++)
        for (rheo_obstacle_shape shape = RHEO_OBSTACLE_SPHERE; shape <= RHEO_OBSTACLE_MESH; shape++) {
            rheo_world_def def = rheo_default_world_def();
            rheo_obstacle o = shape == RHEO_OBSTACLE_MESH ? mesh_obstacle(&mesh) : rheo_default_obstacle(shape);
            def.scheme = scheme;
            def.history.window = 5;
            o.position[1] = shape == RHEO_OBSTACLE_MESH ? -12 : -7;
            o.radius = 5;
            o.length = 8;
            o.size[0] = o.size[1] = o.size[2] = 8;
            o.rotation[0] = 20;
            o.rotation[2] = 35;
            add_obstacle(&def, o);
            block(&def, x, 6, 0);
            rheo_world *world = make(&def);
            double deepest = 1e9;
            for (int s = 0; s < 60; s++) {
                step(world, 1);
                for (uint32_t i = 0; i < def.particles.count; i++)
                    deepest = fmin(deepest, distance_of(world, i));
            }
            if (!(deepest >= 1 - 1.2e-5 && deepest < 1.01))
                fail_msg("scheme %d, shape %d: a particle came to %g", (int)scheme, (int)shape, deepest);
            rheo_world_destroy(world);
        }
}

/* Fluid in a turning drum stays inside and is carried up. */
static void a_drum_holds_its_fluid(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    static test_mesh mesh;
    sphere_mesh(&mesh, 9, 8);
    for (rheo_obstacle_shape shape = RHEO_OBSTACLE_SPHERE; shape <= RHEO_OBSTACLE_MESH; shape++) {
        rheo_world_def def = rheo_default_world_def();
        rheo_obstacle o = shape == RHEO_OBSTACLE_MESH ? mesh_obstacle(&mesh) : rheo_default_obstacle(shape);
        def.history.window = 5;
        o.inside = RHEO_OBSTACLE_INSIDE;
        o.position[1] = shape == RHEO_OBSTACLE_MESH ? -5 : 4;
        o.radius = 9;
        o.axis[1] = 0;
        o.axis[2] = 1;
        o.length = o.size[0] = o.size[1] = o.size[2] = 14;
        o.spin[2] = 1.5;
        add_obstacle(&def, o);
        block(&def, x, 5, 0);
        rheo_world *world = make(&def);
        for (int s = 0; s < 40; s++) {
            step(world, 1);
            for (uint32_t i = 0; i < def.particles.count; i++) {
                const double d = distance_of(world, i);
                if (!(d >= 1 - 1.2e-5))
                    fail_msg("shape %d, step %d: particle %u came to %g", (int)shape, s + 1, i, d);
            }
        }
        double turned = 0; /* angular momentum about the axis */
        for (uint32_t i = 0; i < def.particles.count; i++) {
            const rheo_real *at = rheo_world_positions(world) + 3 * (size_t)i,
                            *v = rheo_world_velocities(world) + 3 * (size_t)i;
            turned += (double)at[0] * (double)v[1] - ((double)at[1] - 4) * (double)v[0];
        }
        assert_true(turned > 0);
        rheo_world_destroy(world);
    }
}

/* Three faces meet in a corner: a particle that flies into it stops there. */
static void a_particle_stops_in_the_corner_of_a_box(void **unused)
{
    (void)unused;
    const rheo_real x[3] = {(rheo_real)2.2, (rheo_real)2.3, (rheo_real)2.1}, v[3] = {30, 40, 50};
    rheo_world_def def = inert_def();
    rheo_obstacle o = box_obstacle(6, 6, 6);
    o.inside = RHEO_OBSTACLE_INSIDE;
    add_obstacle(&def, o);
    rheo_world *world = world_of(def, 1, x, v);
    step(world, 3);
    for (int axis = 0; axis < 3; axis++) {
        NEAR((double)rheo_world_positions(world)[axis], 2.5, 1e-6);
        NEAR((double)rheo_world_velocities(world)[axis], 0, 1e-4);
    }
    rheo_world_destroy(world);
}

/* Without friction a paddle gives a particle its velocity along the normal only. */
static void a_turning_paddle_pushes_with_the_speed_of_its_surface(void **unused)
{
    (void)unused;
    const rheo_real x[3] = {4, (rheo_real)0.99, 0};
    rheo_world_def def = inert_def();
    rheo_obstacle o = box_obstacle(10, 1, 10);
    o.spin[2] = 0.5;
    add_obstacle(&def, o);
    rheo_world *world = world_of(def, 1, x, NULL);
    step(world, 1);
    const rheo_real *at = rheo_world_positions(world), *v = rheo_world_velocities(world);
    const double angle = 0.5 * def.step;
    NEAR((double)v[1], 0.5 * 4, 0.04);
    NEAR((double)v[0] / (double)v[1], -tan(angle), 0.01);
    assert_true(distance_of(world, 0) >= 0.5 - 1e-5);
    assert_true((double)at[1] > 0.99);
    rheo_world_destroy(world);
}

/* ---- Motion ---- */

static void a_rotation_stays_orthonormal(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    rheo_obstacle o = box_obstacle(1, 2, 3);
    o.rotation[0] = 30;
    o.rotation[2] = -70;
    const double spin[3] = {3, -5, 2}, steps = 100000;
    memcpy(o.spin, spin, sizeof spin);
    def.step = 0.03;
    def.substeps = 1;
    add_obstacle(&def, o);
    rheo_world *world = make(&def);
    const rheo_obstacle_state first = state_of(world, 0);
    step(world, (int)steps);
    const rheo_obstacle_state last = state_of(world, 0);
    double length2 = 0;
    for (int i = 0; i < 4; i++)
        length2 += last.rotation[i] * last.rotation[i];
    NEAR(length2, 1, 4e-16);
    /* The rotation by |spin| t, then the first one. */
    const double tau = (double)(rheo_real)def.step, rate = sqrt(38), half = fmod(rate * tau * steps / 2, 8 * atan(1)),
                 c = cos(half), s = sin(half) / rate, *q = first.rotation;
    const double expected[4] = {c * q[0] - s * (spin[0] * q[1] + spin[1] * q[2] + spin[2] * q[3]),
                                c * q[1] + s * (spin[0] * q[0] + spin[1] * q[3] - spin[2] * q[2]),
                                c * q[2] + s * (spin[1] * q[0] + spin[2] * q[1] - spin[0] * q[3]),
                                c * q[3] + s * (spin[2] * q[0] + spin[0] * q[2] - spin[1] * q[1])};
    for (int i = 0; i < 4; i++)
        NEAR(last.rotation[i], expected[i], 1e-9);
    rheo_world_destroy(world);
}

static void the_centre_moves_at_its_velocity_and_swings(void **unused)
{
    (void)unused;
    const double two_pi = 6.283185307179586;
    rheo_world_def def = inert_def();
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_SPHERE);
    def.step = 0.03125;
    def.substeps = 2;
    for (int axis = 0; axis < 3; axis++) {
        o.position[axis] = axis;
        o.velocity[axis] = 0.5 - axis;
        o.amplitude[axis] = 1 + axis;
    }
    o.frequency = 1.3;
    add_obstacle(&def, o);
    rheo_world *world = make(&def);
    for (int s = 1; s <= 300; s++) {
        step(world, 1);
        const double t = s * def.step, phase = fmod(1.3 * t, 1);
        const rheo_obstacle_state state = state_of(world, 0);
        NEAR(state.phase, phase, 1e-12);
        for (int axis = 0; axis < 3; axis++) {
            NEAR(state.position[axis], axis + (0.5 - axis) * t + (1 + axis) * sin(two_pi * phase), 1e-11);
            NEAR(state.velocity[axis], 0.5 - axis + (1 + axis) * two_pi * 1.3 * cos(two_pi * phase), 1e-10);
        }
    }
    /* A change of the amplitude does not displace. */
    const rheo_obstacle_state before = state_of(world, 0);
    OK(rheo_world_set(world, "obstacles.0.amplitude", "[0, 0, 0]", &error));
    OK(rheo_world_set(world, "obstacles.0.velocity", "[0, 0, 0]", &error));
    step(world, 2);
    const rheo_obstacle_state after = state_of(world, 0);
    assert_memory_equal(before.position, after.position, sizeof before.position);
    rheo_world_destroy(world);
}

static void the_centre_of_a_mesh_is_above_its_position(void **unused)
{
    (void)unused;
    static test_mesh mesh;
    const double size[3] = {2, 4, 6};
    box_mesh(&mesh, size, 1);
    rheo_world_def def = inert_def();
    rheo_obstacle o = mesh_obstacle(&mesh);
    o.position[0] = 7;
    o.rotation[2] = 90; /* about its centre */
    o.height = 2;
    add_obstacle(&def, o);
    rheo_world *world = make(&def);
    const rheo_obstacle_state state = state_of(world, 0);
    NEAR(state.position[0], 7, 0);
    NEAR(state.position[1], 1, 1e-15);
    const double above[3] = {7, 2, 0}, beside[3] = {8.5, 1, 0};
    double n[3];
    NEAR(rheo_world_obstacle_distance(world, 0, above, n), 0.5, 1e-12);
    NEAR(n[1], 1, 1e-12);
    NEAR(rheo_world_obstacle_distance(world, 0, beside, n), 0.5, 1e-12);
    NEAR(n[0], 1, 1e-12);
    OK(rheo_world_set(world, "obstacles.0.position", "[1, 2, 3]", &error));
    OK(rheo_world_set(world, "obstacles.0.rotation", "[0, 0, 0]", &error));
    const rheo_obstacle_state moved = state_of(world, 0);
    assert_true(moved.position[0] == 1 && moved.position[1] == 3 && moved.position[2] == 3 && moved.rotation[0] == 1);
    assert_true(isnan(rheo_world_obstacle_distance(world, 1, above, NULL)));
    rheo_world_destroy(world);
}

/* ---- Only worlds with obstacles ---- */

static void other_worlds_have_no_stage_for_them(void **unused)
{
    (void)unused;
    for (int with = 0; with < 2; with++) {
        rheo_world_def def = rheo_default_world_def();
        if (with)
            add_obstacle(&def, rheo_default_obstacle(RHEO_OBSTACLE_SPHERE));
        rheo_world *world = make(&def);
        int stages = 0, fields = 0;
        for (uint32_t i = 0; i < rheo_world_stage_count(world); i++) {
            rheo_stage_info info;
            rheo_world_stage(world, i, &info);
            stages += strcmp(info.name, "obstacles") == 0;
        }
        for (uint32_t i = 0; i < rheo_world_field_count(world); i++) {
            rheo_field_info info;
            rheo_world_field(world, i, &info);
            fields += info.location == RHEO_LOCATION_OBSTACLE;
        }
        assert_int_equal(stages, with);
        assert_int_equal(fields, 3 * with);
        assert_int_equal(rheo_world_obstacle_count(world), with);
        rheo_world_destroy(world);
    }
}

static void simd_variants_are_alike(void **unused)
{
    (void)unused;
    static rheo_real x[3 * MOST];
    const char *kernels;
    uint64_t first = 0;
    rheo_world_def def = rheo_default_world_def();
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_CYLINDER);
    def.history.window = 5;
    o.radius = o.length = 6;
    o.position[1] = -4;
    o.spin[0] = 2;
    add_obstacle(&def, o);
    obstacle_seed = 9;
    block(&def, x, 6, 1);
    for (uint32_t i = 0; (kernels = rheo_simd_available(i)); i++) {
        OK(rheo_use_simd(kernels, &error));
        rheo_world *world = make(&def);
        step(world, 30);
        first = i ? first : rheo_world_hash(world);
        assert_true(rheo_world_hash(world) == first);
        rheo_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_large_box_is_a_wall),
        cmocka_unit_test(a_moving_box_is_a_wall_in_its_own_frame),
        cmocka_unit_test(fluid_does_not_enter),
        cmocka_unit_test(a_drum_holds_its_fluid),
        cmocka_unit_test(a_particle_stops_in_the_corner_of_a_box),
        cmocka_unit_test(a_turning_paddle_pushes_with_the_speed_of_its_surface),
        cmocka_unit_test(a_rotation_stays_orthonormal),
        cmocka_unit_test(the_centre_moves_at_its_velocity_and_swings),
        cmocka_unit_test(the_centre_of_a_mesh_is_above_its_position),
        cmocka_unit_test(other_worlds_have_no_stage_for_them),
        cmocka_unit_test(simd_variants_are_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
