/* Several balls: their contact with each other, with particles and walls, their commands, metrics and recordings. */
#include "why.h"

#include <math.h>

#include "resume.h"

#define PATH "test_balls.rlog"

static const double ROUNDING = RHEO_DOUBLE ? 0x1p-53 : 0x1p-24;

static rheo_ball ball_at(double x, double y, double z, double radius, double ratio)
{
    rheo_ball ball = rheo_default_ball();
    ball.position[0] = x, ball.position[1] = y, ball.position[2] = z;
    ball.radius = radius;
    ball.density_ratio = ratio;
    return ball;
}

/* Balls in free space, without gravity. */
static rheo_world_def with_balls(rheo_scheme scheme, uint32_t count, const rheo_ball *balls)
{
    rheo_world_def def = inert_def();
    def.scheme = scheme;
    def.fluid.number_density = 1;
    def.step = 0.0625;
    def.substeps = 1;
    def.ball = balls[0];
    for (uint32_t i = 1; i < count; i++)
        OK(rheo_world_def_add_ball(&def, &balls[i], &error));
    return def;
}

static rheo_body body(const rheo_world *world, uint32_t index)
{
    rheo_body ball;
    OK(rheo_world_body(world, index, &ball));
    return ball;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

typedef struct motion {
    double momentum[3], turning[3], energy, size; /* size: of the terms of the momentum */
} motion;

/* Momentum, angular momentum about the origin and kinetic energy of balls and particles. */
static motion motion_of(const rheo_world *world)
{
    motion m = {{0}, {0}, 0, 0};
    const uint32_t balls = rheo_world_body_count(world), count = balls + rheo_world_particle_count(world);
    for (uint32_t i = 0; i < count; i++) {
        rheo_body b = {.mass = 1};
        if (i < balls)
            b = body(world, i);
        for (size_t axis = 0; axis < 3 && i >= balls; axis++) {
            b.position[axis] = (double)rheo_world_positions(world)[3 * (size_t)(i - balls) + axis];
            b.velocity[axis] = (double)rheo_world_velocities(world)[3 * (size_t)(i - balls) + axis];
        }
        const double inertia = 0.4 * b.mass * b.radius * b.radius, *x = b.position, *v = b.velocity;
        for (int a = 0; a < 3; a++) {
            const int c = (a + 1) % 3, d = (a + 2) % 3;
            m.momentum[a] += b.mass * v[a];
            m.turning[a] += b.mass * (x[c] * v[d] - x[d] * v[c]) + inertia * b.spin[a];
        }
        m.energy += 0.5 * b.mass * dot(v, v) + 0.5 * inertia * dot(b.spin, b.spin);
        m.size += b.mass * sqrt(dot(v, v));
    }
    return m;
}

static const rheo_scheme SCHEMES[] = {RHEO_SCHEME_SUMMED, RHEO_SCHEME_SEQUENTIAL, RHEO_SCHEME_POSITIONS};
enum { SCHEME_COUNT = 3 };

/* ---- Two balls ---- */

/* A head-on collision: both balls go on with the velocity of their centre of mass, side by side. */
static void two_balls_stop_without_a_bounce(void **unused)
{
    (void)unused;
    for (int k = 0; k < SCHEME_COUNT; k++) {
        rheo_ball balls[] = {ball_at(0, 0, 0, 2, 3), ball_at(5, 0, 0, 1.5, 1)};
        balls[0].velocity[0] = 6;
        balls[1].velocity[0] = -10;
        rheo_world *world = world_of(with_balls(SCHEMES[k], 2, balls), 0, NULL, NULL);
        const double m = body(world, 0).mass, n = body(world, 1).mass, together = (6 * m - 10 * n) / (m + n);
        NEAR(m, 3 * 4.0 / 3 * 3.14159265358979 * 8, 1e-4);
        NEAR(n, 4.0 / 3 * 3.14159265358979 * 1.5 * 1.5 * 1.5, 1e-5);
        step(world, 1);
        NEAR(body(world, 0).velocity[0], 6, 0); /* still apart */
        step(world, 3);
        NEAR(body(world, 0).velocity[0], together, 1e-5);
        NEAR(body(world, 1).velocity[0], together, 1e-5);
        NEAR(body(world, 1).position[0] - body(world, 0).position[0], 3.5, 1e-5);
        step(world, 20); /* nothing parts them, and nothing holds them */
        NEAR(body(world, 1).position[0] - body(world, 0).position[0], 3.5, 1e-5);
        for (uint32_t i = 0; i < 2; i++)
            assert_true(body(world, i).velocity[1] == 0 && body(world, i).spin[2] == 0);
        rheo_world_destroy(world);
    }
}

/* The impulses of an oblique contact, with spins, are those of the formulas in docs/model.md. */
static void friction_turns_both_balls(void **unused)
{
    (void)unused;
    for (int slippery = 0; slippery < 2; slippery++) {
        rheo_ball balls[] = {ball_at(0, 0, 0, 2, 3), ball_at(0, 3, 0, 1, 1)}; /* touching, before they move */
        balls[0].friction = slippery ? 0 : 30;
        balls[1].friction = slippery ? 0 : 10;
        balls[0].velocity[1] = 0.5;
        balls[0].velocity[0] = 3;
        balls[0].spin[2] = 0.25;
        balls[1].velocity[1] = -1;
        balls[1].spin[2] = -2;
        balls[1].velocity[2] = 1;
        rheo_world_def def = with_balls(RHEO_SCHEME_SUMMED, 2, balls);
        def.step = 0x1p-10;
        def.ball.position[0] = -3 * def.step; /* so that the second ball is above the first when they touch */
        def.balls.list[0].position[2] = -def.step;
        rheo_world *world = world_of(def, 0, NULL, NULL);
        const motion before = motion_of(world);
        const double m = body(world, 0).mass, n = body(world, 1).mass, reduced = m * n / (m + n);
        const double tau = def.step, share = 20 * tau / (1 + 20 * tau);
        /* Velocity of the second relative to the first where they touch; u_y is the approach, which ends. */
        const double u[3] = {-3 + 1 * -2 + 2 * 0.25, -1.5, 1};
        const double slowed = slippery ? 0 : share * reduced / 3.5, tangential[2] = {-slowed * u[0], -slowed * u[2]};
        step(world, 1);
        const rheo_body a = body(world, 0), b = body(world, 1);
        const double overlap = 1.5 * tau, normal = reduced * fmin(1.5, fmax(0, overlap / tau));
        NEAR(a.velocity[0], 3 - tangential[0] / m, 2e-5);
        NEAR(a.velocity[1], 0.5 - normal / m, 2e-5);
        NEAR(a.velocity[2], -tangential[1] / m, 2e-5);
        NEAR(b.velocity[0], tangential[0] / n, 2e-5);
        NEAR(b.velocity[1], -1 + normal / n, 2e-5);
        NEAR(b.velocity[2], 1 + tangential[1] / n, 2e-5);
        /* arm x J/(2/5 M R^2): the arms are (0, 2, 0) with -J and (0, -1, 0) with J */
        NEAR(a.spin[2], 0.25 + 2 * tangential[0] / (0.4 * m * 4), 2e-5);
        NEAR(b.spin[2], -2 + 1 * tangential[0] / (0.4 * n), 2e-4);
        NEAR(a.spin[0], -2 * tangential[1] / (0.4 * m * 4), 2e-5);
        NEAR(b.spin[0], -1 * tangential[1] / (0.4 * n), 2e-4);
        assert_true(slippery || fabs(tangential[0]) > 0.01);
        const motion after = motion_of(world);
        assert_true(after.energy < before.energy);
        for (int axis = 0; axis < 3; axis++) {
            NEAR(after.momentum[axis], before.momentum[axis], 8 * ROUNDING * before.size);
            NEAR(after.turning[axis], before.turning[axis], 2e-3 * before.size);
        }
        rheo_world_destroy(world);
    }
}

/* Balls that begin inside each other are moved apart, without velocity, about their centre of mass; also in one place. */
static void overlap_of_balls_makes_no_velocity(void **unused)
{
    (void)unused;
    for (int same_place = 0; same_place < 2; same_place++) {
        const rheo_ball balls[] = {ball_at(0, 0, 0, 2, 3), ball_at(0, same_place ? 0 : 1, 0, 2, 1)};
        rheo_world *world = world_of(with_balls(RHEO_SCHEME_SUMMED, 2, balls), 0, NULL, NULL);
        const double centre = (same_place ? 0 : 1) * 0.25;
        step(world, 1);
        const rheo_body a = body(world, 0), b = body(world, 1);
        NEAR(b.position[1] - a.position[1], 4, 1e-5);
        NEAR(0.75 * a.position[1] + 0.25 * b.position[1], centre, 1e-6);
        for (int axis = 0; axis < 3; axis++)
            assert_true(a.velocity[axis] == 0 && b.velocity[axis] == 0 && a.spin[axis] == 0 && b.spin[axis] == 0);
        rheo_world_destroy(world);
    }
}

/* Balls that part, and balls that only nearly touch, do not act on each other. */
static void balls_that_part_are_not_rubbed(void **unused)
{
    (void)unused;
    for (int apart = 0; apart < 2; apart++) {
        rheo_ball balls[] = {ball_at(0, 0, 0, 2, 3), ball_at(0, apart ? 4.01 : 4, 0, 2, 1)};
        balls[1].velocity[1] = apart ? 0 : 1;
        balls[1].velocity[0] = 2;
        balls[0].spin[2] = 3;
        rheo_world_def def = with_balls(RHEO_SCHEME_SUMMED, 2, balls);
        def.step = 0x1p-10;
        rheo_world *world = world_of(def, 0, NULL, NULL);
        step(world, 5);
        NEAR(body(world, 0).velocity[0], 0, 0);
        NEAR(body(world, 1).velocity[0], 2, 0);
        NEAR(body(world, 0).spin[2], 3, 0);
        rheo_world_destroy(world);
    }
}

/* ---- Many ---- */

static uint64_t random_state = 1;
static double random_unit(void)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(random_state >> 11) / 9007199254740992.0;
}

/* A cloud of balls of all sizes that fly at each other, with particles between them. */
static rheo_world *cloud(rheo_scheme scheme, uint32_t particles)
{
    static rheo_real position[3 * 64], velocity[3 * 64];
    rheo_ball balls[RHEO_MAX_BALLS];
    random_state = 7;
    for (int i = 0; i < RHEO_MAX_BALLS; i++) {
        balls[i] = ball_at(0, 0, 0, 0.5 + random_unit(), 0.1 + 4 * random_unit());
        balls[i].friction = 40 * random_unit();
        for (int axis = 0; axis < 3; axis++) {
            balls[i].position[axis] = 10 * random_unit() - 5;
            balls[i].velocity[axis] = -balls[i].position[axis] + 2 * random_unit() - 1;
            balls[i].spin[axis] = 2 * random_unit() - 1;
        }
    }
    for (size_t i = 0; i < 3 * (size_t)particles; i++) {
        position[i] = (rheo_real)(8 * random_unit() - 4);
        velocity[i] = (rheo_real)(4 * random_unit() - 2);
    }
    return world_of(with_balls(scheme, RHEO_MAX_BALLS, balls), particles, position, velocity);
}

/* Sixteen balls, and particles that touch several of them, keep their momentum to rounding. No step adds kinetic energy. */
static void momentum_is_kept_and_energy_never_grows(void **unused)
{
    (void)unused;
    for (int k = 0; k < 2 * SCHEME_COUNT - 1; k++) { /* the density constraint of scheme positions pushes particles */
        rheo_world *world = cloud(SCHEMES[k / 2], k % 2 ? 64 : 0);
        const motion first = motion_of(world);
        motion last = first;
        for (int n = 0; n < 100; n++) {
            step(world, 1);
            const motion now = motion_of(world);
            for (int axis = 0; axis < 3; axis++)
                NEAR(now.momentum[axis], first.momentum[axis], 300 * ROUNDING * first.size);
            if (!(now.energy <= last.energy * (1 + 40 * ROUNDING)))
                fail_msg("scheme %d, step %d: energy %.9g, then %.9g", k, n, last.energy, now.energy);
            last = now;
        }
        assert_true(last.energy < 0.8 * first.energy); /* there were contacts */
        rheo_world_destroy(world);
    }
}

/* All SIMD variants give the same bits. */
static void variants_agree_on_several_balls(void **unused)
{
    (void)unused;
    const char *variant;
    uint64_t hash[SCHEME_COUNT] = {0};
    for (uint32_t i = 0; (variant = rheo_simd_available(i)) != NULL; i++) {
        OK(rheo_use_simd(variant, &error));
        for (int k = 0; k < SCHEME_COUNT; k++) {
            rheo_world *world = cloud(SCHEMES[k], 64);
            step(world, 20);
            if (i == 0)
                hash[k] = rheo_world_hash(world);
            assert_true(rheo_world_hash(world) == hash[k]);
            rheo_world_destroy(world);
        }
    }
    OK(rheo_use_simd(rheo_simd_available(0), &error));
}

/* A heavy ball rests on a light one, which rests on the floor: a stack, with the wall between them and the ground. */
static void balls_stack_on_a_floor(void **unused)
{
    (void)unused;
    static const rheo_wall floor_only = {{0, 0, 0}, {0, 1, 0}};
    const rheo_ball balls[] = {ball_at(0, 2, 0, 2, 1), ball_at(0, 5, 0, 1, 4), ball_at(9, 4, 0, 3, 1)};
    rheo_world_def def = with_balls(RHEO_SCHEME_SUMMED, 3, balls);
    def.gravity[1] = -9.81;
    def.step = 0.01;
    def.walls.count = 1;
    def.walls.plane = &floor_only;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    step(world, 300);
    NEAR(body(world, 0).position[1], 2, 0.01);
    NEAR(body(world, 1).position[1], 5, 0.02);
    NEAR(body(world, 2).position[1], 3, 0.01); /* with its own radius */
    /* The floor stops the lower ball after the contact of both, so that the upper one keeps g tau times the ratio of masses. */
    NEAR(body(world, 1).velocity[1], -9.81 * def.step * (1 + body(world, 1).mass / body(world, 0).mass), 0.01);
    rheo_world_destroy(world);
}

/* Mirrored balls stay mirrored, to the last bit: rolling on a floor into each other, with spins. */
static void a_mirrored_pair_stays_mirrored(void **unused)
{
    (void)unused;
    static const rheo_wall floor_only = {{0, 0, 0}, {0, 1, 0}};
    rheo_ball balls[] = {ball_at(-3, 2.3, 0.125, 2, 1.5), ball_at(3, 2.3, 0.125, 2, 1.5)};
    for (int i = 0; i < 2; i++) {
        const double side = i ? 1 : -1;
        balls[i].velocity[0] = -side * 1.7;
        balls[i].velocity[2] = 0.3;
        balls[i].spin[0] = 0.7; /* a mirror turns the components of a spin that are in its plane */
        balls[i].spin[1] = side * 0.4;
        balls[i].spin[2] = side * -1.1;
    }
    rheo_world_def def = with_balls(RHEO_SCHEME_SUMMED, 2, balls);
    def.gravity[1] = -9.81;
    def.walls.count = 1;
    def.walls.plane = &floor_only;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    bool touched = false;
    for (int n = 0; n < 200; n++) {
        step(world, 1);
        const rheo_body a = body(world, 0), b = body(world, 1);
        touched = touched || b.position[0] < 2.0001;
        assert_true(a.position[0] == -b.position[0] && a.position[1] == b.position[1] &&
                    a.position[2] == b.position[2]);
        assert_true(a.velocity[0] == -b.velocity[0] && a.velocity[1] == b.velocity[1] &&
                    a.velocity[2] == b.velocity[2]);
        assert_true(a.spin[0] == b.spin[0] && a.spin[1] == -b.spin[1] && a.spin[2] == -b.spin[2]);
    }
    assert_true(touched);
    rheo_world_destroy(world);
}

/* ---- Particles ---- */

/* A particle between two balls is held by both; the same with the balls in the other order, to rounding. */
static void a_particle_touches_two_balls(void **unused)
{
    (void)unused;
    double x[2];
    for (int swapped = 0; swapped < 2; swapped++) {
        rheo_ball balls[] = {ball_at(-2, 0, 0, 2, 50), ball_at(2.5, 0, 0, 2, 50)};
        balls[0].velocity[0] = 4;
        balls[1].velocity[0] = -4;
        if (swapped) {
            const rheo_ball first = balls[0];
            balls[0] = balls[1];
            balls[1] = first;
        }
        rheo_world_def def = with_balls(RHEO_SCHEME_SUMMED, 2, balls);
        def.step = 0.01;
        const rheo_real position[] = {RHEO_DOUBLE ? 0.25 : 0.25F, 0, 0};
        rheo_world *world = world_of(def, 1, position, NULL);
        const motion before = motion_of(world);
        step(world, 40);
        const motion after = motion_of(world);
        assert_true(after.energy < before.energy);
        NEAR(after.momentum[0], before.momentum[0], 1e-3);
        NEAR(after.momentum[1], 0, 1e-3); /* the particle may be squeezed out to a side */
        x[swapped] = (double)rheo_world_positions(world)[0];
        rheo_world_destroy(world);
    }
    NEAR(x[0], x[1], 0.02);
}

static rheo_scene pool_with_balls(rheo_scheme scheme)
{
    rheo_scene scene = lively_scene();
    scene.world.scheme = scheme;
    if (scheme == RHEO_SCHEME_POSITIONS)
        scene.world.step = 0.01;
    scene.world.ball.radius = 2.5;
    scene.world.ball.position[0] = scene.world.ball.position[2] = 4;
    rheo_ball light = ball_at(11, 0, 11, 3, 0.3), heavy = ball_at(4, 0, 11, 2, 8);
    light.push[1] = -2;
    OK(rheo_world_def_add_ball(&scene.world, &light, &error));
    OK(rheo_world_def_add_ball(&scene.world, &heavy, &error));
    scene.balls.clearance[0] = 0;
    scene.balls.clearance[1] = 1;
    return scene;
}

static rheo_world *made(const rheo_scene *scene)
{
    rheo_world *world;
    OK(rheo_scene_create_world(scene, &world, &error));
    return world;
}

/* A second ball that touches nothing leaves fluid and first ball as they were, to the last bit. */
static void a_ball_far_away_changes_nothing(void **unused)
{
    (void)unused;
    for (int k = 0; k < SCHEME_COUNT; k++) {
        rheo_scene scene = lively_scene();
        scene.world.scheme = SCHEMES[k];
        if (SCHEMES[k] == RHEO_SCHEME_POSITIONS)
            scene.world.step = 0.01;
        rheo_world *one = made(&scene);
        const rheo_ball far = ball_at(0, 500, 0, 1, 1);
        OK(rheo_world_def_add_ball(&scene.world, &far, &error));
        rheo_world *two = made(&scene);
        assert_int_equal(rheo_world_stage_count(two), rheo_world_stage_count(one) + 1);
        assert_int_equal(rheo_world_metric_count(two), rheo_world_metric_count(one) + 10);
        for (int n = 0; n < 40; n++) {
            step(one, 1);
            step(two, 1);
        }
        const uint32_t count = rheo_world_particle_count(one);
        const rheo_body a = body(one, 0), b = body(two, 0);
        assert_memory_equal(&a, &b, sizeof a);
        assert_memory_equal(rheo_world_positions(one), rheo_world_positions(two), 3 * count * sizeof(rheo_real));
        assert_memory_equal(rheo_world_velocities(one), rheo_world_velocities(two), 3 * count * sizeof(rheo_real));
        assert_true(metric(one, "springs") == metric(two, "springs") || SCHEMES[k] == RHEO_SCHEME_POSITIONS);
        rheo_world_destroy(one);
        rheo_world_destroy(two);
    }
}

/* Every ball wets the particles around it: the second one alone feels the same lift as when it is the first. */
static void any_ball_is_lifted(void **unused)
{
    (void)unused;
    double speed[2];
    for (int first = 0; first < 2; first++) {
        rheo_scene scene = pool_with_balls(RHEO_SCHEME_SUMMED);
        scene.world.vibrators.count = 0;
        scene.world.ball.velocity[1] = 0;
        scene.world.ball.push[0] = scene.world.ball.push[1] = scene.world.balls.list[0].push[1] = 0;
        scene.world.balls.count = 1;
        scene.ball.clearance = scene.balls.clearance[0] = -1;
        rheo_ball under = ball_at(8, 4, 8, 2.5, 0.2), away = ball_at(8, 200, 8, 2.5, 0.2);
        scene.world.ball = first ? under : away;
        scene.world.balls.list[0] = first ? away : under;
        rheo_world *world = made(&scene);
        step(world, 3);
        speed[first] = body(world, first ? 0 : 1).velocity[1];
        assert_true(speed[first] > 0.5);
        rheo_world_destroy(world);
    }
    assert_true(speed[0] == speed[1]);
}

/* In a pool a light ball stays on top, and a heavy one sinks to the floor. */
static void a_light_ball_floats_and_a_heavy_one_sinks(void **unused)
{
    (void)unused;
    rheo_scene scene = pool_with_balls(RHEO_SCHEME_SUMMED);
    scene.world.vibrators.count = 0;
    scene.world.springs.stiffness = 0;
    scene.world.ball.push[0] = scene.world.ball.push[1] = scene.world.balls.list[0].push[1] = 0;
    scene.world.ball.velocity[1] = 0;
    scene.world.balls.list[1].density_ratio = 20;
    rheo_world *world = made(&scene);
    step(world, 400);
    const rheo_body light = body(world, 1), heavy = body(world, 2);
    assert_true(light.position[1] - light.radius > 4); /* the pool is 8 deep */
    NEAR(heavy.position[1], heavy.radius, 1);          /* at most a layer of particles is below it */
    rheo_world_destroy(world);
}

/* ---- Commands ---- */

static void commands_take_the_number_of_a_ball(void **unused)
{
    (void)unused;
    rheo_ball balls[] = {ball_at(0, 0, 0, 2, 1), ball_at(20, 0, 0, 1, 3), ball_at(40, 0, 0, 1, 1)};
    balls[2].push[1] = 5;
    balls[2].push_frequency = 16; /* one period a step */
    rheo_world *world = world_of(with_balls(RHEO_SCHEME_SUMMED, 3, balls), 0, NULL, NULL);
    const double impulse[3] = {0, 0, 10}, point[3] = {21, 0, 0};
    OK(rheo_world_push_body(world, 1, impulse, point, &error));
    const double mass = body(world, 1).mass;
    NEAR(body(world, 1).velocity[2], 10 / mass, 1e-6);
    NEAR(body(world, 1).spin[1], -2.5 * 10 / mass, 1e-6);
    NEAR(body(world, 0).velocity[2], 0, 0);
    OK(rheo_world_set(world, "ball2.velocity", "[1, 2, 3]", &error));
    OK(rheo_world_set(world, "ball2.position", "[20, 7, 0]", &error));
    OK(rheo_world_set(world, "ball3.spin", "[0, 0, 4]", &error));
    OK(rheo_world_set(world, "ball2.density_ratio", "6", &error));
    NEAR(body(world, 1).velocity[1], 2, 0);
    NEAR(body(world, 1).position[1], 7, 0);
    NEAR(body(world, 2).spin[2], 4, 0);
    NEAR(body(world, 1).mass, 2 * mass, 1e-4);
    NEAR(body(world, 0).position[1], 0, 0);
    step(world, 1);
    NEAR(body(world, 2).velocity[1], 5 * 0.0625, 1e-6); /* pushed once */
    NEAR(body(world, 1).velocity[1], 2, 0);
    NEAR(metric(world, "ball2_y"), 7 + 2 * 0.0625, 1e-6);
    NEAR(metric(world, "ball3_spin_z"), 4, 0);
    NEAR(metric(world, "ball2_max_speed"), sqrt(14), 1e-6);
    NEAR(metric(world, "energy"), motion_of(world).energy, 1e-4 * motion_of(world).energy);
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no body 3; this world has 3",
            rheo_world_push_body(world, 3, impulse, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "ball4.spin: there is no ball 4; this world has 3",
            rheo_world_set(world, "ball4.spin", "[0, 0, 1]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no ball 8", rheo_world_set(world, "ball9.spin", "[0, 0, 1]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "fixed when a world is made", rheo_world_set(world, "ball2.radius", "3", &error));
    assert_int_equal(rheo_world_def_ball_count(rheo_world_definition(world)), 3);
    rheo_world_destroy(world);
}

static void what_is_wrong_is_said(void **unused)
{
    (void)unused;
    const rheo_ball balls[] = {ball_at(0, 0, 0, 2, 1), ball_at(9, 0, 0, 1, 1)};
    rheo_world_def def = with_balls(RHEO_SCHEME_SUMMED, 2, balls), bad = def;
    rheo_world *world;
    char value[96];
#define SET_REFUSED(text, path, to) REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_world_def_set(&bad, path, to, &error))
    SET_REFUSED("ball4.radius: there is no ball 3; balls are numbered without gaps, so the next is ball 3",
                "ball4.radius", "1");
    SET_REFUSED("a world has at most 16 balls", "ball17.radius", "1");
    SET_REFUSED("a world has at most 16 balls", "ball99999999999.radius", "1");
    SET_REFUSED("the first ball has no number; it is ball.radius", "ball1.radius", "1");
    SET_REFUSED("a ball has no such parameter; it has: radius, density_ratio, position", "ball2.mass", "1");
    SET_REFUSED("ball2.radius is -1", "ball2.radius", "-1");
    SET_REFUSED("ball3.radius cannot be \"x\"", "ball3.radius", "x");
    SET_REFUSED("unknown parameter", "ball0.radius", "1");
    SET_REFUSED("unknown parameter", "ball2x.radius", "1");
    assert_int_equal(bad.balls.count, 1); /* nothing was added */
    assert_int_equal(rheo_world_def_get(&bad, "ball3.radius", value, sizeof value), RHEO_ERROR_ARGUMENT);
    OK(rheo_world_def_set(&bad, "ball3.friction", "7", &error)); /* the next ball is added, with defaults */
    assert_int_equal(bad.balls.count, 2);
    NEAR(bad.balls.list[1].friction, 7, 0);
    NEAR(bad.balls.list[1].density_ratio, def.ball.density_ratio * 2, 0);
    REFUSED(RHEO_ERROR_ARGUMENT, "ball3.radius is 0; it must be at least 1e-12",
            rheo_world_create(&bad, &world, &error));
    bad = def;
    bad.ball.radius = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "ball2 is given, but no first ball; set ball.radius",
            rheo_world_create(&bad, &world, &error));
    bad = def;
    bad.balls.list[0].density_ratio = 1e20;
    bad.balls.list[0].radius = 1e9;
    REFUSED(RHEO_ERROR_ARGUMENT, "ball2 has the mass of", rheo_world_create(&bad, &world, &error));
    bad = def;
    bad.balls.list[0].position[1] = NAN;
    REFUSED(RHEO_ERROR_ARGUMENT, "ball2.position", rheo_world_create(&bad, &world, &error));
    bad = def;
    bad.balls.count = RHEO_MAX_BALLS;
    REFUSED(RHEO_ERROR_ARGUMENT, "there are 16 further balls; at most 15", rheo_world_create(&bad, &world, &error));
    for (bad = def; bad.balls.count < RHEO_MAX_BALLS - 1;)
        OK(rheo_world_def_add_ball(&bad, &balls[1], &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 16 balls", rheo_world_def_add_ball(&bad, &balls[1], &error));
    rheo_world_def melting = rheo_default_model_def(RHEO_MODEL_MELTING);
    REFUSED(RHEO_ERROR_ARGUMENT, "ball2.radius is a parameter of the model thickening",
            rheo_world_def_set(&melting, "ball2.radius", "1", &error));
}

/* A scene warns of balls that overlap, that do not fit, and that begin in the fluid, each by its name. */
static void scenes_warn_of_further_balls(void **unused)
{
    (void)unused;
    enum { ROOM = 16 };
    rheo_warning found[ROOM];
    size_t count;
    rheo_scene scene = pool_with_balls(RHEO_SCHEME_SUMMED);
    scene.settle.time = 0;
    OK(rheo_scene_warnings(&scene, found, ROOM, &count, &error));
    assert_int_equal(count, 0);
    scene.world.balls.list[0].position[0] = 18;
    scene.world.balls.list[1].position[0] = 6;
    scene.world.balls.list[1].position[2] = 5;
    scene.balls.clearance[1] = 0.5;
    scene.world.balls.list[1].radius = 9;
    OK(rheo_scene_warnings(&scene, found, ROOM, &count, &error));
    bool wall = false, large = false, overlap = false, fluid = false;
    for (size_t i = 0; i < count && i < ROOM; i++) {
        wall = wall ||
               (found[i].kind == RHEO_WARNING_BALL_IN_WALL && found[i].refused && says(found[i].text, "ball 2, of"));
        large = large || (found[i].kind == RHEO_WARNING_BALL_TOO_LARGE && says(found[i].text, "ball 3 does not fit"));
        overlap = overlap ||
                  (found[i].kind == RHEO_WARNING_BALLS_OVERLAP && says(found[i].text, "ball 3 overlaps the ball by"));
    }
    assert_true(wall && large && overlap);
    scene = pool_with_balls(RHEO_SCHEME_SUMMED);
    scene.settle.time = 0;
    scene.balls.clearance[0] = -1;
    scene.world.balls.list[0].position[1] = 6;
    OK(rheo_scene_warnings(&scene, found, ROOM, &count, &error));
    for (size_t i = 0; i < count && i < ROOM; i++)
        fluid = fluid || (found[i].kind == RHEO_WARNING_BALL_IN_FLUID && says(found[i].text, "inside ball 2,") &&
                          says(found[i].text, "or set ball2.clearance to 0 or more"));
    assert_true(fluid);
}

/* ---- Recordings ---- */

/* Runs with several balls go on from any step with the same bits, in all schemes. */
static void runs_resume_from_any_step(void **unused)
{
    (void)unused;
    for (int k = 0; k < SCHEME_COUNT; k++) {
        const rheo_scene scene = pool_with_balls(SCHEMES[k]);
        resume_every_step(made(&scene), 12, PATH, "balls");
        rheo_recording *recording;
        OK(rheo_recording_open(PATH, &recording, &error));
        rheo_world *world;
        OK(rheo_recording_world(recording, 12, NULL, &world, &error));
        const rheo_world_def *def = rheo_world_definition(world);
        assert_int_equal(rheo_world_def_ball_count(def), 3);
        NEAR(def->balls.list[1].density_ratio, 8, 0);
        NEAR(def->balls.list[0].push[1], -2, 0);
        NEAR(def->balls.list[0].radius, 3, 0);
        assert_true(body(world, 1).radius == 3 && body(world, 2).radius == 2);
        rheo_world_destroy(world);
        rheo_recording_close(recording);
        remove(PATH);
    }
}

/* Commands on a further ball are recorded, told, and replayed. */
static void commands_are_replayed(void **unused)
{
    (void)unused;
    const rheo_scene scene = pool_with_balls(RHEO_SCHEME_SUMMED);
    rheo_world *world = made(&scene);
    rheo_recorder *recorder = record_in_memory(world);
    const double impulse[3] = {3, 0, 0};
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_world_set(world, "ball3.velocity", "[0, -4, 0]", &error));
    OK(rheo_world_push_body(world, 1, impulse, NULL, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    const uint64_t hash = rheo_world_hash(world);
    recorded r = reopen(recorder, world);
    rheo_command command;
    OK(rheo_recording_command(r.recording, 0, &command, &error));
    assert_string_equal(command.text, "ball3.velocity was set to [0, -4, 0]");
    OK(rheo_recording_command(r.recording, 1, &command, &error));
    assert_true(says(command.text, "ball 2 was pushed by impulse [3, 0, 0]") && command.index == 1);
    OK(rheo_player_seek(r.player, 3, &error));
    assert_true(rheo_world_hash(rheo_player_world(r.player)) == hash);
    discard(&r);
}

/* ---- Causes and conditions ---- */

static bool of_second_ball(void *data, const rheo_change *change)
{
    bool *any = data;
    assert_true(change->exact);
    for (size_t i = 0; i < change->count; i++)
        if (change->contribution[i].source == RHEO_SOURCE_BALL)
            *any = *any || change->contribution[i].item == 1;
    return true;
}

/* What the second ball does to particles is told of it, exactly, by wetting and by contact, in all schemes. */
static void causes_name_the_ball(void **unused)
{
    (void)unused;
    for (int k = 0; k < SCHEME_COUNT; k++) {
        rheo_scene scene = pool_with_balls(SCHEMES[k]);
        rheo_world *world = made(&scene);
        OK(rheo_world_set(world, "ball2.velocity", "[0, -8, 0]", &error));
        rheo_recorder *recorder = record_in_memory(world);
        for (int n = 0; n < 8; n++)
            OK(rheo_recorder_step(recorder, &error));
        /* The particle that is nearest to the second ball. */
        const rheo_body ball = body(world, 1);
        double least = 1e30;
        uint64_t nearest = 0;
        for (uint32_t i = 0; i < rheo_world_particle_count(world); i++) {
            const rheo_real *x = rheo_world_positions(world) + 3 * (size_t)i;
            const double d[3] = {(double)x[0] - ball.position[0], (double)x[1] - ball.position[1],
                                 (double)x[2] - ball.position[2]};
            if (dot(d, d) < least) {
                least = dot(d, d);
                nearest = i;
            }
        }
        recorded r = reopen(recorder, world);
        told t = {.of = "balls"};
        bool contact = false, any = false;
        for (uint64_t n = 1; n <= 8; n++) {
            check_particle(r.player, n, nearest, &t);
            OK(rheo_player_why(r.player, n, NULL, nearest, "velocity", of_second_ball, &any, &error));
            OK(rheo_player_why(r.player, n, "ball", nearest, "velocity", of_second_ball, &contact, &error));
        }
        assert_true(any && contact && t.by[RHEO_SOURCE_BALL] > 0);
        discard(&r);
    }
}

static void conditions_name_the_ball(void **unused)
{
    (void)unused;
    const rheo_scene scene = pool_with_balls(RHEO_SCHEME_SUMMED);
    rheo_world *world = made(&scene);
    rheo_recorder *recorder = record_in_memory(world);
    for (int n = 0; n < 10; n++)
        OK(rheo_recorder_step(recorder, &error));
    const double y = body(world, 2).position[1];
    recorded r = reopen(recorder, world);
    const rheo_find_options options = {.which = RHEO_FIND_LAST};
    char condition[64];
    rheo_search search;
    snprintf(condition, sizeof condition, "ball 3: y < %.9g and ball3_y < 90", y + 1e-3);
    OK(rheo_player_find(r.player, condition, &options, &search, &error));
    assert_string_equal(search.found.item, "ball 3");
    assert_int_equal(search.found.id, 2);
    assert_int_equal(search.found.step, 10);
    NEAR(search.found.value, y, 1e-6);
    OK(rheo_player_find(r.player, "ball 1: y < 90", &options, &search, &error));
    assert_string_equal(search.found.item, "ball");
    REFUSED(RHEO_ERROR_ARGUMENT, "the recording has no ball 4; it has 3",
            rheo_player_find(r.player, "ball 4: y < 1", &options, &search, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "balls are numbered from 1 on",
            rheo_player_find(r.player, "ball 0: y < 1", &options, &search, &error));
    discard(&r);
}

/* The doctor looks at the fastest ball, whichever it is. */
static void a_fast_second_ball_is_diagnosed(void **unused)
{
    (void)unused;
    rheo_scene scene = pool_with_balls(RHEO_SCHEME_SUMMED);
    scene.world.balls.list[0].velocity[1] = -600;
    scene.world.max_substeps = 4;
    rheo_world *world = made(&scene);
    rheo_recorder *recorder = record_in_memory(world);
    for (int n = 0; n < 3; n++)
        if (rheo_recorder_step(recorder, &(rheo_error){""}) != RHEO_OK)
            break;
    recorded r = reopen(recorder, world);
    rheo_diagnosis diagnosis;
    OK(rheo_diagnose(r.recording, &diagnosis, &error));
    bool found = false;
    for (size_t i = 0; i < diagnosis.finding_count; i++)
        found = found || strcmp(diagnosis.findings[i].measure, "ball_speed") == 0;
    assert_true(found);
    discard(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_balls_stop_without_a_bounce),
        cmocka_unit_test(friction_turns_both_balls),
        cmocka_unit_test(overlap_of_balls_makes_no_velocity),
        cmocka_unit_test(balls_that_part_are_not_rubbed),
        cmocka_unit_test(momentum_is_kept_and_energy_never_grows),
        cmocka_unit_test(variants_agree_on_several_balls),
        cmocka_unit_test(balls_stack_on_a_floor),
        cmocka_unit_test(a_mirrored_pair_stays_mirrored),
        cmocka_unit_test(a_particle_touches_two_balls),
        cmocka_unit_test(a_ball_far_away_changes_nothing),
        cmocka_unit_test(any_ball_is_lifted),
        cmocka_unit_test(a_light_ball_floats_and_a_heavy_one_sinks),
        cmocka_unit_test(commands_take_the_number_of_a_ball),
        cmocka_unit_test(what_is_wrong_is_said),
        cmocka_unit_test(scenes_warn_of_further_balls),
        cmocka_unit_test(runs_resume_from_any_step),
        cmocka_unit_test(commands_are_replayed),
        cmocka_unit_test(causes_name_the_ball),
        cmocka_unit_test(conditions_name_the_ball),
        cmocka_unit_test(a_fast_second_ball_is_diagnosed),
    };
    return cmocka_run_group_tests_name("balls", tests, NULL, NULL);
}
