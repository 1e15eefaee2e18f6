/* Walls, ball and vibrators, each alone. */
#include "support.h"

#include <math.h>

static rheo_world_def walled(void)
{
    rheo_world_def def = inert_def();
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{5, 0, 5}, {0, 3, 0}};
    return def;
}

/* Walls keep the centres of particles half a spacing away. A particle that approaches is stopped, not thrown back. */
static void a_particle_stops_at_a_wall(void **unused)
{
    (void)unused;
    const rheo_real position[] = {0, 0.01F, 0, 9, 0.55F, 0}, velocity[] = {2, -3, 0, 2, -3, 0};
    rheo_world *world = world_of(walled(), 2, position, velocity);
    for (int n = 0; n < 5; n++) {
        step(world, 1);
        const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
        NEAR((double)x[1], 0.5, 1e-6);
        NEAR((double)x[4], 0.5, 1e-6);
        NEAR((double)v[1], 0, 0);
        NEAR((double)v[4], 0, n ? 1e-6 : 0.04);
        assert_true(v[0] == 2 && v[3] == 2); /* no springs, hence no sticking */
    }
    rheo_world_destroy(world);
}

/* Overlap without approach is removed without velocity, in every number of substeps. */
static void overlap_with_a_wall_makes_no_velocity(void **unused)
{
    (void)unused;
    for (uint32_t substeps = 0; substeps < 5; substeps++) {
        rheo_world_def def = walled();
        def.substeps = substeps;
        const rheo_real position[] = {0, 0.2F, 0, 9, -5, 0, 18, 0.3F, 0}, velocity[9] = {[7] = 0.125F};
        rheo_world *world = world_of(def, 3, position, velocity);
        step(world, 1);
        const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
        NEAR((double)x[1], 0.5, 1e-6);
        NEAR((double)x[4], 0.5, 1e-6);
        assert_true(v[1] == 0 && v[4] == 0 && v[7] == 0.125F);
        rheo_world_destroy(world);
    }
}

/* Particles in a corner, pressed against three walls, do not move. */
static void a_resting_particle_stays(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.walls.plane = some_walls();
    def.walls.count = 3;
    for (int axis = 0; axis < 3; axis++) {
        walls_of(&def)[axis] = (rheo_wall){{0, 0, 0}, {axis == 0, axis == 1, axis == 2}};
        def.gravity[axis] = -9.81 - axis;
    }
    const rheo_real position[] = {0.5F, 0.5F, 0.5F};
    rheo_world *world = world_of(def, 1, position, NULL);
    step(world, 1000);
    for (int axis = 0; axis < 3; axis++) {
        NEAR((double)rheo_world_positions(world)[axis], 0.5, 1e-6);
        NEAR((double)rheo_world_velocities(world)[axis], 0, 1e-6);
    }
    rheo_world_destroy(world);
}

/* A particle within half a spacing is at the wall; one farther out or moving away is not. */
static void walls_act_within_half_a_spacing(void **unused)
{
    (void)unused;
    const rheo_real position[] = {0, 0.45F, 0, 9, 0.6F, 0, 18, 0.3F, 0};
    const rheo_real velocity[] = {0, -0.1F, 0, 0, -0.1F, 0, 0, 0.1F, 0};
    rheo_world *world = world_of(walled(), 3, position, velocity);
    step(world, 1);
    const rheo_real *v = rheo_world_velocities(world);
    NEAR((double)v[1], 0, 0);
    NEAR((double)v[4], -0.1, 1e-5);
    NEAR((double)v[7], 0.1, 1e-5);
    rheo_world_destroy(world);
}

/*
 * Sliding falls by 1/(1 + tau c_b f) in each substep, f = mean(k_hist |D^q|)/(10 k_min) over the springs of the
 * particle. It is a rate: the limit of many substeps is exp(-step c_b f), and the error falls with tau.
 */
static void stiff_fluid_sticks(void **unused)
{
    (void)unused;
    static const double sticking[] = {0, 600, 3e8};
    double kept[3] = {0}, error_before = 0;
    for (uint32_t substeps = 1; substeps <= 8; substeps *= 2)
        for (int i = 0; i < 3; i++) {
            rheo_world_def def = walled();
            def.gravity[1] = -1;
            def.substeps = substeps;
            def.springs.stiffness = 1e-6;
            def.history.stiffness = 5e-6;
            def.walls.sticking = sticking[i];
            const rheo_real position[] = {0, 0.1F, 0, 1, 0.1F, 0}, velocity[] = {1, 0, 0, 0.5F, 0, 0};
            rheo_world *world = world_of(def, 2, position, velocity);
            step(world, 1); /* no history yet */
            NEAR((double)rheo_world_velocities(world)[0], 1, 1e-4);
            rheo_spring_state spring;
            OK(rheo_world_spring(world, 0, 1, &spring, &error));
            double v = (double)rheo_world_velocities(world)[0];
            step(world, 1);
            kept[i] = (double)rheo_world_velocities(world)[0] / v;
            const double n = spring.history_rate;
            const double rate = def.walls.sticking * 5e-6 * n * n / (n + def.history.onset) / (10 * 1e-6);
            NEAR(kept[i], pow(1 + rate * def.step / substeps, -(double)substeps), 1e-5);
            NEAR((double)rheo_world_velocities(world)[3], 0.5 * kept[i], 1e-5); /* the other end as well */
            if (i == 1) {
                const double off = kept[i] - exp(-rate * def.step);
                assert_true(off > 0 && (substeps == 1 || (off < 0.6 * error_before && off > 0.4 * error_before)));
                error_before = off;
            }
            rheo_world_destroy(world);
        }
    assert_true(kept[0] > kept[1] && kept[1] > 0.1 && kept[1] < 0.9 && fabs(kept[2]) < 1e-4);
}

static rheo_world_def ball_def(void)
{
    rheo_world_def def = inert_def();
    def.ball.radius = 2;
    def.ball.density_ratio = 1;
    def.ball.friction = 0;
    def.ball.position[1] = 2.1;
    def.step = 0.0625;
    return def;
}

/* Momentum passes from the ball to a particle in a head-on impact; a frictionless ball does not turn. */
static void the_ball_and_a_particle_exchange_momentum(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.ball.velocity[1] = -8;
    const rheo_real position[] = {0, 0, 0};
    rheo_world *world = world_of(def, 1, position, NULL);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    double mass = ball.mass;
    NEAR(mass, 4.0 / 3 * 3.14159265 * 8, 1e-4);
    step(world, 1);
    OK(rheo_world_body(world, 0, &ball));
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    NEAR(mass * ball.velocity[1] + (double)v[1], -8 * mass, 1e-4);
    NEAR((double)v[1], ball.velocity[1], 1e-5);     /* inelastic impact */
    NEAR(ball.position[1] - (double)x[1], 2, 1e-5); /* on the surface */
    NEAR(ball.spin[0] + ball.spin[1] + ball.spin[2], 0, 0);
    rheo_world_destroy(world);
}

/*
 * A particle that slides along the surface turns the ball: J = s u/(1 + s (1/mass + arm^2/inertia)), s = friction tau/
 * (1 + friction tau). Linear and angular momentum are conserved.
 */
static void friction_turns_the_ball(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.substeps = 1;
    def.ball.position[1] = 1.95;
    def.ball.friction = 16; /* s = 1/2 */
    const rheo_real position[] = {-0.1F, 0, 0}, velocity[] = {1.6F, 0, 0};
    rheo_world *world = world_of(def, 1, position, velocity);
    step(world, 1);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    const rheo_real *v = rheo_world_velocities(world);
    NEAR((double)v[0] + ball.mass * ball.velocity[0], 1.6, 1e-6);
    assert_true(ball.spin[2] > 0); /* below the centre, pushed towards +x */
    double friction = ball.mass * ball.velocity[0];
    const double arm = 1.95, inertia = 0.4 * ball.mass * 4; /* the particle is inside */
    NEAR(friction, 0.5 * 1.6 / (1 + 0.5 * (1 / ball.mass + arm * arm / inertia)), 1e-5);
    NEAR(ball.spin[2], friction * arm / inertia, 1e-5);
    rheo_world_destroy(world);
}

/* Friction is a rate: results converge to first order in the duration of a substep. */
static void friction_converges_with_the_step(void **unused)
{
    (void)unused;
    double speed[8], spin[8];
    for (int i = 0; i < 8; i++) {
        rheo_world_def def = ball_def();
        def.substeps = UINT32_C(1) << i;
        def.ball.position[1] = 1.95;
        def.ball.friction = 25;
        const rheo_real position[] = {-0.1F, 0, 0}, velocity[] = {1.6F, 0, 0};
        rheo_world *world = world_of(def, 1, position, velocity);
        step(world, 1);
        rheo_body ball;
        OK(rheo_world_body(world, 0, &ball));
        speed[i] = (double)rheo_world_velocities(world)[0];
        spin[i] = ball.spin[2];
        rheo_world_destroy(world);
    }
    for (int i = 1; i < 6; i++) {
        NEAR((speed[i] - speed[i + 1]) / (speed[i + 1] - speed[i + 2]), 2, 0.4);
        NEAR((spin[i] - spin[i + 1]) / (spin[i + 1] - spin[i + 2]), 2, 0.4);
    }
    assert_true(speed[0] - speed[7] > 0.02);
}

/* Particles inside the ball are put on its surface and get no velocity, nor does the ball. */
static void overlap_with_the_ball_makes_no_velocity(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.ball.friction = 25;
    const rheo_real position[] = {0.5F, 2, 0, -1, 3, 0.25F, 0, 1, 0};
    rheo_world *world = world_of(def, 3, position, NULL);
    step(world, 3);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    for (int i = 0; i < 3; i++) {
        const rheo_real *x = rheo_world_positions(world) + 3 * i, *v = rheo_world_velocities(world) + 3 * i;
        NEAR(hypot(hypot((double)x[0], (double)x[1] - 2.1), (double)x[2]), 2, 1e-6);
        assert_true(v[0] == 0 && v[1] == 0 && v[2] == 0);
        assert_true(ball.velocity[i] == 0 && ball.spin[i] == 0);
    }
    rheo_world_destroy(world);
}

/* Two particles that the ball hits at once stay mirror images, and the order of their ids has no effect. */
static void contacts_of_the_ball_have_no_order(void **unused)
{
    (void)unused;
    rheo_real speed[2][12];
    for (int order = 0; order < 2; order++) {
        rheo_world_def def = ball_def();
        def.ball.velocity[1] = -8;
        def.ball.friction = 25;
        def.ball.density_ratio = 0.05;
        const rheo_real at[4][3] = {{1, 0.25F, 0.5F}, {-1, 0.25F, 0.5F}, {-1, 0.25F, -0.5F}, {1, 0.25F, -0.5F}};
        rheo_real position[12];
        for (int i = 0; i < 4; i++)
            memcpy(position + 3 * (order ? 3 - i : i), at[i], sizeof at[i]);
        rheo_world *world = world_of(def, 4, position, NULL);
        step(world, 2);
        for (int i = 0; i < 4; i++)
            memcpy(speed[order] + 3 * i, rheo_world_velocities(world) + 3 * (order ? 3 - i : i),
                   3 * sizeof(rheo_real));
        rheo_body ball;
        OK(rheo_world_body(world, 0, &ball));
        NEAR(ball.velocity[0], 0, 1e-6);
        NEAR(ball.spin[0] + ball.spin[1] + ball.spin[2], 0, 1e-6);
        rheo_world_destroy(world);
    }
    for (int i = 0; i < 12; i++) {
        NEAR((double)speed[0][i], (double)speed[1][i], 2e-6);
        NEAR(fabs((double)speed[0][i]), fabs((double)speed[0][i % 3]), 2e-6);
    }
    assert_true(speed[0][1] < -0.5F);
}

static void a_particle_in_the_centre_of_the_ball(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    const rheo_real position[] = {0, (rheo_real)2.1, 0};
    rheo_world *world = world_of(def, 1, position, NULL);
    step(world, 1);
    NEAR((double)rheo_world_positions(world)[1], 4.1, 1e-5);
    rheo_world_destroy(world);
}

/* The ball starts to roll on an incline: after a while the contact point hardly slides. */
static void the_ball_rolls_along_a_wall(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.gravity[1] = -9.81;
    def.step = 0.01;
    def.ball.friction = 25;
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    def.ball.position[1] = 2;
    def.ball.velocity[0] = 5;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    step(world, 200);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    NEAR(ball.velocity[0], 5 * 5.0 / 7, 1e-2); /* rolling keeps 5/7 of the sliding speed */
    NEAR(-ball.spin[2] * 2, ball.velocity[0], 1e-3);
    NEAR(ball.position[1], 2, 1e-4);
    double q = 0;
    for (int i = 0; i < 4; i++)
        q += ball.orientation[i] * ball.orientation[i];
    NEAR(q, 1, 1e-6);
    assert_true(fabs(ball.orientation[3]) > 1e-3 || fabs(ball.orientation[0]) < 0.999);
    rheo_world_destroy(world);
}

/* A ball that falls on a floor stands there: it does not bounce, sink in or turn. */
static void the_ball_lands_on_a_floor(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.gravity[1] = -9.81;
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    def.ball.position[1] = 7;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    double lowest = 7;
    for (int i = 0; i < 200; i++) {
        step(world, 1);
        rheo_body ball;
        OK(rheo_world_body(world, 0, &ball));
        lowest = fmin(lowest, ball.position[1]);
        if (i > 20)
            NEAR(ball.velocity[1], 0, 1e-5);
    }
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    NEAR(ball.position[1], 2, 1e-5);
    NEAR(lowest, 2, 1e-5);
    NEAR(ball.spin[0] + ball.spin[1] + ball.spin[2], 0, 0);
    rheo_world_destroy(world);
}

/* A wall rubs a ball only while it stops it: one that leaves the wall keeps its velocity and spin. */
static void a_ball_that_leaves_a_wall_is_not_rubbed(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    def.ball.friction = 25;
    def.ball.position[1] = 1.5; /* half a unit inside */
    def.ball.velocity[0] = 3;
    def.ball.velocity[1] = 1;
    def.ball.spin[2] = 7;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    step(world, 1);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    NEAR(ball.velocity[0], 3, 1e-6);
    NEAR(ball.spin[2], 7, 1e-6);
    NEAR(ball.velocity[1], 1, 1e-6);
    rheo_world_destroy(world);
}

/* A push J at a point turns the ball by arm x J, which the moment of inertia 2/5 M R^2 resists. */
/*
 * A ball that slides, turns and rolls against a wall does the same, bit by bit, at a wall in each of the six directions: all
 * vectors have their components moved on, and mirrored. A mirror turns a spin the other way.
 */
static void a_wall_treats_the_ball_alike_in_each_direction(void **unused)
{
    (void)unused;
    static const double at[3] = {.25, 1.75, -.5}, velocity[3] = {3, -2, 1.5},
                        spin[3] = {1, -.5, 4}; /* floor: axis 1 */
    double first[9];
    for (int turn = 0; turn < 3; turn++)
        for (int sign = 1; sign >= -1; sign -= 2) {
            rheo_world_def def = ball_def();
            def.ball.friction = 25;
            def.walls.plane = some_walls();
            def.walls.count = 1;
            walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 0, 0}};
            walls_of(&def)[0].normal[(1 + turn) % 3] = sign;
            for (int a = 0; a < 3; a++) {
                const int to = (a + turn) % 3;
                def.ball.position[to] = sign * at[a];
                def.ball.velocity[to] = sign * velocity[a];
                def.ball.spin[to] = spin[a]; /* a mirror in a point keeps it */
            }
            rheo_world *world = world_of(def, 0, NULL, NULL);
            rheo_body ball;
            step(world, 1);
            OK(rheo_world_body(world, 0, &ball));
            double now[9];
            for (int a = 0; a < 3; a++) {
                const int to = (a + turn) % 3;
                now[a] = sign * ball.position[to];
                now[3 + a] = sign * ball.velocity[to];
                now[6 + a] = ball.spin[to];
            }
            if (turn == 0 && sign == 1) {
                memcpy(first, now, sizeof first);
                NEAR(now[1], 2, 1e-6); /* it touches the wall */
                NEAR(now[4], 0, 1e-6);
                assert_true(now[3] < 3 && now[5] > 1.5 && now[8] != 4 && now[6] != 1); /* it slides at (11, 0, -.5) */
                NEAR(now[7], -.5, 1e-6); /* nothing turns it around the normal */
            }
            for (int i = 0; i < 9; i++)
                assert_true(now[i] == first[i]);
            rheo_world_destroy(world);
        }
}

static void a_push_turns_the_ball_by_its_torque(void **unused)
{
    (void)unused;
    rheo_world *world = world_of(ball_def(), 0, NULL, NULL);
    rheo_body before, after;
    OK(rheo_world_body(world, 0, &before));
    const double arm[3] = {1, -0.5, 0.75}, j[3] = {30, 40, -50};
    double point[3], torque[3] = {0, 0, 0};
    for (int a = 0; a < 3; a++) {
        point[a] = before.position[a] + arm[a];
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        torque[a] = arm[b] * j[c] - arm[c] * j[b];
    }
    OK(rheo_world_push_body(world, 0, j, point, &error));
    OK(rheo_world_body(world, 0, &after));
    for (int a = 0; a < 3; a++) {
        NEAR(after.velocity[a] * after.mass, j[a], 1e-4);
        NEAR(after.spin[a] * after.mass * 2 / 5 * 4, torque[a], 1e-4); /* R = 2 */
    }
    rheo_world_destroy(world);
}

static rheo_world_def vibrated(rheo_vibrator_kind kind)
{
    rheo_world_def def = walled();
    def.vibrators.kind = kind;
    def.vibrators.position = some_vibrators();
    def.vibrators.count = 2;
    vibrators_of(&def)[0][0] = 3;
    vibrators_of(&def)[1][0] = 50;
    def.vibrators.radius = 4;
    def.vibrators.amplitude = 0.25;
    def.vibrators.height = 10;
    def.step = 0.01;
    return def;
}

/* The floor lifts particles on it by a (1 - rho^2)^2 sin(phase), and no others. They stay half a spacing above it. */
/* In free flight the metric is the speed after the step; in a step that stops the ball, that before its contact. */
static void the_largest_speed_of_the_ball_is_measured_before_contact(void **unused)
{
    (void)unused;
    for (int sequential = 0; sequential < 2; sequential++) {
        rheo_world_def def = walled();
        def.scheme = sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
        def.ball.radius = 1;
        def.ball.position[1] = 5.5;
        def.ball.velocity[0] = 3;
        def.ball.velocity[1] = -4 / def.step;
        rheo_world *world = world_of(def, 0, NULL, NULL);
        const double speed = sqrt(9 + 16 / (def.step * def.step));
        NEAR(metric(world, "ball_max_speed"), 0, 0);
        step(world, 1);
        NEAR(metric(world, "ball_max_speed"), speed, 1e-5 * speed);
        NEAR(metric(world, "ball_vy"), -4 / def.step, 1e-4);
        step(world, 1);
        NEAR(metric(world, "ball_max_speed"), speed, 1e-5 * speed);
        NEAR(metric(world, "ball_vy"), 0, 0.2 * speed); /* the floor stops what its overlap explains */
        step(world, 1);
        assert_true(metric(world, "ball_max_speed") < 0.3 * speed); /* each step begins anew */
        OK(rheo_world_set(world, "ball.velocity", "[0, 0, 0]", &error));
        step(world, 1);
        NEAR(metric(world, "ball_max_speed"), 0, 0.2);
        rheo_world_destroy(world);
    }
}

static void vibrators_raise_the_floor(void **unused)
{
    (void)unused;
    rheo_world_def def = vibrated(RHEO_VIBRATOR_FLOOR);
    const rheo_real position[] = {3, 0.5F, 0, 5, 0.5F, 0, 20, 0.5F, 0};
    def.gravity[1] = -0.5;
    rheo_world *world = world_of(def, 3, position, NULL);
    double highest[3] = {0};
    for (int i = 0; i < 100; i++) {
        step(world, 1);
        rheo_vibrator vibrator;
        OK(rheo_world_vibrator(world, 0, &vibrator));
        assert_true(vibrator.phase >= 0 && vibrator.phase < 1 && vibrator.frequency >= 2.499 &&
                    vibrator.frequency <= 7.501);
        double bump = 0.25 * sin(2 * 3.14159265358979 * vibrator.phase);
        const rheo_real *x = rheo_world_positions(world);
        assert_true((double)x[1] > 0.5 + bump - 1e-5);
        assert_true((double)x[4] > 0.5 + bump * 0.5625 - 1e-5); /* (1 - 1/4)^2 */
        for (int p = 0; p < 3; p++)
            highest[p] = fmax(highest[p], (double)x[3 * p + 1]);
    }
    assert_true(highest[0] > 0.75 && highest[1] > 0.64 && highest[2] < 0.501);
    rheo_world_destroy(world);
}

/* A particle pressed onto the vibrating floor moves with it, to first order in the substep. */
static void a_pressed_particle_follows_the_floor(void **unused)
{
    (void)unused;
    for (int fine = 0; fine < 2; fine++) {
        rheo_world_def def = vibrated(RHEO_VIBRATOR_FLOOR);
        def.gravity[1] = -1000; /* more than a omega^2 = 560 */
        def.step = fine ? 0.0005 : 0.002;
        const rheo_real position[] = {3, 0.5F, 0};
        rheo_world *world = world_of(def, 1, position, NULL);
        double fastest = 0;
        for (int i = 0; i < (fine ? 800 : 200); i++) {
            step(world, 1);
            rheo_vibrator vibrator;
            OK(rheo_world_vibrator(world, 0, &vibrator));
            const double turns = 2 * 3.14159265358979, rate = turns * vibrator.frequency;
            const double speed = 0.25 * rate * cos(turns * vibrator.phase);
            NEAR((double)rheo_world_positions(world)[1], 0.5 + 0.25 * sin(turns * vibrator.phase), 1e-5);
            NEAR((double)rheo_world_velocities(world)[1], speed, 0.25 * rate * rate * def.step / 2);
            fastest = fmax(fastest, fabs(speed));
        }
        assert_true(fastest > 5);
        rheo_world_destroy(world);
    }
}

static void sources_push_what_is_low(void **unused)
{
    (void)unused;
    rheo_world_def def = vibrated(RHEO_VIBRATOR_FORCE);
    def.walls.count = 0;
    def.substeps = 1;
    const rheo_real position[] = {3, 1, 0, 5, 1, 0, 3, 11, 0, 20, 1, 0};
    rheo_world *world = world_of(def, 4, position, NULL);
    step(world, 1);
    rheo_vibrator vibrator;
    OK(rheo_world_vibrator(world, 0, &vibrator));
    double omega = 2 * 3.14159265358979 * vibrator.frequency;
    double push = 0.01 * 0.25 * omega * omega * sin(2 * 3.14159265358979 * vibrator.phase);
    const rheo_real *v = rheo_world_velocities(world);
    assert_true(fabs(push) > 1e-3);
    NEAR((double)v[1], push, fabs(push) * 1e-3);
    NEAR((double)v[4], push * 0.75, fabs(push) * 1e-3);
    NEAR((double)v[7], 0, 0);
    NEAR((double)v[10], 0, 0);
    rheo_world_destroy(world);
}

/* The frequencies vary independently. The random numbers are part of the state, so another seed makes another run. */
static void frequencies_wander(void **unused)
{
    (void)unused;
    double frequency[2][2];
    for (int run = 0; run < 2; run++) {
        rheo_world_def def = vibrated(RHEO_VIBRATOR_FLOOR);
        def.vibrators.seed = (uint64_t)run + 1;
        rheo_world *world = world_of(def, 0, NULL, NULL);
        rheo_vibrator first, later;
        OK(rheo_world_vibrator(world, 0, &first));
        step(world, 50);
        for (uint32_t i = 0; i < 2; i++) {
            OK(rheo_world_vibrator(world, i, &later));
            frequency[run][i] = later.frequency;
        }
        assert_true(frequency[run][0] != first.frequency);
        rheo_world_destroy(world);
    }
    assert_true(frequency[0][0] != frequency[0][1] && frequency[0][0] != frequency[1][0]);
}

/* After a time t, the variance of f/f0 is wander^2 t/3, whatever the step and the number of substeps. */
static void wandering_does_not_depend_on_the_step(void **unused)
{
    (void)unused;
    enum { VIBRATORS = 8 };
    static const struct {
        double step;
        uint32_t substeps, steps;
    } run[] = {{0.04, 0, 50}, {0.04, 8, 50}, {0.01, 1, 200}};
    for (size_t r = 0; r < sizeof run / sizeof *run; r++) {
        double sum = 0, sum2 = 0;
        int count = 0;
        for (uint64_t seed = 1; seed <= 40; seed++) {
            rheo_world_def def = inert_def();
            def.vibrators.kind = RHEO_VIBRATOR_FORCE;
            def.vibrators.position = some_vibrators();
            def.vibrators.count = VIBRATORS;
            def.vibrators.spread = 0; /* begin at f0; then in a band so wide that no walk reaches its ends */
            def.vibrators.wander = 0.0625;
            def.vibrators.seed = seed;
            def.step = run[r].step;
            def.substeps = run[r].substeps;
            rheo_world *world = world_of(def, 0, NULL, NULL);
            OK(rheo_world_set(world, "vibrators.spread", "1", &error));
            step(world, (int)run[r].steps);
            for (uint32_t i = 0; i < VIBRATORS; i++, count++) {
                rheo_vibrator vibrator;
                OK(rheo_world_vibrator(world, i, &vibrator));
                const double change = vibrator.frequency / def.vibrators.frequency - 1;
                sum += change;
                sum2 += change * change;
            }
            rheo_world_destroy(world);
        }
        assert_true(count > 300);
        const double expected = 0.0625 * 0.0625 * 2 / 3;
        NEAR(sum / count, 0, 4 * sqrt(expected / count));
        NEAR(sum2 / count / expected, 1, 4 * sqrt(2.0 / count));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_stops_at_a_wall),
        cmocka_unit_test(overlap_with_a_wall_makes_no_velocity),
        cmocka_unit_test(a_resting_particle_stays),
        cmocka_unit_test(walls_act_within_half_a_spacing),
        cmocka_unit_test(stiff_fluid_sticks),
        cmocka_unit_test(the_ball_and_a_particle_exchange_momentum),
        cmocka_unit_test(friction_turns_the_ball),
        cmocka_unit_test(friction_converges_with_the_step),
        cmocka_unit_test(overlap_with_the_ball_makes_no_velocity),
        cmocka_unit_test(contacts_of_the_ball_have_no_order),
        cmocka_unit_test(a_particle_in_the_centre_of_the_ball),
        cmocka_unit_test(the_ball_rolls_along_a_wall),
        cmocka_unit_test(the_ball_lands_on_a_floor),
        cmocka_unit_test(a_push_turns_the_ball_by_its_torque),
        cmocka_unit_test(a_ball_that_leaves_a_wall_is_not_rubbed),
        cmocka_unit_test(a_wall_treats_the_ball_alike_in_each_direction),
        cmocka_unit_test(the_largest_speed_of_the_ball_is_measured_before_contact),
        cmocka_unit_test(vibrators_raise_the_floor),
        cmocka_unit_test(a_pressed_particle_follows_the_floor),
        cmocka_unit_test(sources_push_what_is_low),
        cmocka_unit_test(frequencies_wander),
        cmocka_unit_test(wandering_does_not_depend_on_the_step),
    };
    return cmocka_run_group_tests_name("solids", tests, NULL, NULL);
}
