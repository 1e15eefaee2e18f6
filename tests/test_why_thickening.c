/*
 * What rheo_player_why() tells of the thickening model is true: forces are those of the equations, the partners of a pair tell the
 * opposite of each other, a wall stops a particle. It is exact in each scheme and kind of memory.
 */
#include "why.h"

/* ---- Recordings in memory ---- */

/* Records these steps of a world, which it destroys; before the last one it adds `more` particles. */
static recorded record_and_add(rheo_world *world, int steps, uint32_t more, const rheo_real *position)
{
    rheo_recorder *recorder = record_in_memory(world);
    for (int i = 0; i < steps; i++) {
        if (more && i == steps - 1)
            OK(rheo_world_add_particles(world, more, position, NULL, &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    return reopen(recorder, world);
}

static recorded record(rheo_world *world, int steps)
{
    return record_and_add(world, steps, 0, NULL);
}

/* ---- Contributions of one stage run ---- */

enum { MOST = 1000 };

typedef struct list {
    rheo_change change;
    rheo_contribution of[MOST];
    size_t count;
} list;

static bool keep(void *data, const rheo_change *change)
{
    list *l = data;
    assert_true(change->exact);
    assert_true(change->count <= MOST);
    l->change = *change;
    l->count = change->count;
    memcpy(l->of, change->contribution, change->count * sizeof *l->of);
    return false;
}

/* The first change of the field by runs of this stage; empty if there is none. It holds until the fourth call from here. */
static const list *ask(const recorded *r, uint64_t step, const char *stage, uint64_t id, const char *field)
{
    static list lists[4];
    static size_t next;
    list *l = &lists[next++ % 4];
    memset(l, 0, sizeof *l);
    OK(rheo_player_why(r->player, step, stage, id, field, keep, l, &error));
    return l;
}

/* The only contribution of this source and item; NULL if there is none. */
static const rheo_contribution *only(const list *l, rheo_source source, uint64_t item)
{
    const rheo_contribution *found = NULL;
    for (size_t i = 0; i < l->count; i++)
        if (l->of[i].source == source && l->of[i].item == item) {
            assert_null(found);
            found = &l->of[i];
        }
    return found;
}

static const rheo_contribution *needed(const list *l, rheo_source source, uint64_t item)
{
    const rheo_contribution *found = only(l, source, item);
    if (!found)
        fail_msg("%s: the %s has no contribution %s %llu", l->change.stage, l->change.field, rheo_source_name(source),
                 (unsigned long long)item);
    return found;
}

static void is_vector(const double actual[3], double x, double y, double z, double tolerance)
{
    NEAR(actual[0], x, tolerance);
    NEAR(actual[1], y, tolerance);
    NEAR(actual[2], z, tolerance);
}

static const double ROUNDING = RHEO_DOUBLE ? 0x1p-52 : 0x1p-23;

/* ---- Forces and contacts ---- */

static void gravity_adds_step_times_g(void **state)
{
    (void)state;
    for (int scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++) {
        const rheo_real position[3] = {1, 2, 3};
        rheo_world_def def = inert_def();
        def.scheme = (rheo_scheme)scheme;
        def.substeps = scheme == RHEO_SCHEME_SUMMED;
        def.gravity[0] = 0.5;
        def.gravity[1] = -9.81;
        recorded r = record(world_of(def, 1, position, NULL), 2);
        const list *l = ask(&r, 2, "gravity", 0, "velocity");
        assert_int_equal(l->count, 1);
        const rheo_contribution *g = needed(l, RHEO_SOURCE_GRAVITY, 0);
        is_vector(g->change, def.step * 0.5, -def.step * 9.81, 0, 2 * ROUNDING);
        assert_string_equal(g->sum, "");
        assert_false(g->sets);
        /* The velocity moves it. */
        const list *moved = ask(&r, 2, "prediction", 0, "position");
        const rheo_contribution *v = needed(moved, RHEO_SOURCE_VELOCITY, 0);
        NEAR(v->factor, def.step, ROUNDING);
        for (int axis = 0; axis < 3; axis++)
            assert_true(v->value[axis] == l->change.after[axis]);
        is_vector(v->change, moved->change.after[0] - moved->change.before[0],
                  moved->change.after[1] - moved->change.before[1], moved->change.after[2] - moved->change.before[2],
                  4 * ROUNDING);
        discard(&r);
    }
}

/* Two particles with a spring of rest length h along x. */
static recorded two_with_a_spring(rheo_scheme scheme, double *step)
{
    const rheo_real position[6] = {3, 1, 2, 4.25, 1, 2};
    rheo_world_def def = inert_def();
    def.scheme = scheme;
    def.substeps = scheme == RHEO_SCHEME_SUMMED;
    def.springs.stiffness = 15;
    def.springs.rest_length = RHEO_REST_SUPPORT;
    *step = def.step;
    return record(world_of(def, 2, position, NULL), 2);
}

static void a_spring_acts_on_both_ends(void **state)
{
    (void)state;
    double tau;
    recorded r = two_with_a_spring(RHEO_SCHEME_SUMMED, &tau);
    OK(rheo_player_seek_stage(r.player, 2, "densities", &error));
    const rheo_real *x = rheo_world_positions(rheo_player_world(r.player));
    const double length = (double)(x[3] - x[0]), expected = 15 * (length - 2) / 2; /* towards the other */
    assert_true(expected < -1);
    for (uint64_t id = 0; id < 2; id++) {
        const list *v = ask(&r, 2, "forces", id, "velocity"), *p = ask(&r, 2, "forces", id, "position");
        assert_int_equal(v->count, 1);
        const rheo_contribution *a = needed(v, RHEO_SOURCE_SPRING, 1 - id),
                                *b = needed(p, RHEO_SOURCE_SPRING, 1 - id);
        const double towards = id ? -expected : expected;
        assert_string_equal(a->sum, "springs");
        is_vector(a->change, tau * towards, 0, 0, 8 * ROUNDING);
        is_vector(b->change, tau * tau * towards, 0, 0, 8 * ROUNDING);
    }
    discard(&r);
}

static void a_spring_displaces_both_ends_in_scheme_sequential(void **state)
{
    (void)state;
    double tau;
    recorded r = two_with_a_spring(RHEO_SCHEME_SEQUENTIAL, &tau);
    OK(rheo_player_seek_stage(r.player, 2, "springs", &error));
    const rheo_real *x = rheo_world_positions(rheo_player_world(r.player));
    const double expected = tau * tau * 15 * ((double)(x[3] - x[0]) - 2) / 2;
    assert_true(expected < -1e-3);
    for (uint64_t id = 0; id < 2; id++) {
        const list *l = ask(&r, 2, "spring_displacement", id, "position");
        assert_int_equal(l->count, 1);
        is_vector(needed(l, RHEO_SOURCE_SPRING, 1 - id)->change, id ? -expected : expected, 0, 0, 8 * ROUNDING);
        /* The velocity is set by all that moved the particle. */
        const list *v = ask(&r, 2, "velocity", id, "velocity");
        const rheo_contribution *set = needed(v, RHEO_SOURCE_DISPLACEMENT, 0);
        assert_true(set->sets && set->value[0] == v->change.after[0]);
        const double start = ask(&r, 2, "prediction", id, "position")->change.before[0];
        NEAR(set->value[0], (l->change.after[0] - start) / tau, 8 * ROUNDING / tau);
    }
    discard(&r);
}

/* Particle 0 falls onto wall 1, a floor at y = 0. */
static void a_wall_stops_a_particle(void **state)
{
    (void)state;
    for (int scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++) {
        const rheo_real position[6] = {0, 0.01F, 0, 0, 30, 0}, velocity[6] = {3, -5, 0, 0, 0, 0};
        rheo_world_def def = inert_def();
        def.scheme = (rheo_scheme)scheme;
        def.substeps = scheme == RHEO_SCHEME_SUMMED;
        def.walls.count = 2;
        def.walls.plane = some_walls();
        walls_of(&def)[0] = (rheo_wall){.point = {0, 50, 0}, .normal = {0, -1, 0}};
        walls_of(&def)[1] = (rheo_wall){.point = {0, 0, 0}, .normal = {0, 1, 0}};
        recorded r = record(world_of(def, 2, position, velocity), 1);
        const list *v = ask(&r, 1, "walls", 0, "velocity"), *x = ask(&r, 1, "walls", 0, "position");
        const rheo_contribution *stops = needed(v, RHEO_SOURCE_WALL, 1), *lifts = needed(x, RHEO_SOURCE_WALL, 1);
        assert_int_equal(v->count, 1);
        assert_true(v->change.after[1] <= 0 && stops->change[1] > 4.5);
        NEAR(v->change.before[1] + stops->change[1], v->change.after[1], 8 * ROUNDING);
        is_vector(lifts->change, 0, def.fluid.spacing / 2 - x->change.before[1], 0, 8 * ROUNDING);
        assert_int_equal(ask(&r, 1, "walls", 1, "velocity")->count, 0);
        discard(&r);
    }
}

/* The contribution points away from the ball, and the particle then leaves it alone. */
static void the_ball_pushes_outwards(void **state)
{
    (void)state;
    const rheo_real position[6] = {0, 2, 0, 9, 9, 9}, velocity[6] = {0, -6, 0, 0, 0, 0};
    rheo_world_def def = inert_def();
    def.substeps = 1;
    def.ball.radius = 1.9;
    def.fluid.number_density = 1;
    recorded r = record(world_of(def, 2, position, velocity), 1);
    const list *v = ask(&r, 1, "ball", 0, "velocity");
    const rheo_contribution *hit = needed(v, RHEO_SOURCE_BALL, 0);
    assert_true(hit->change[1] > 1);
    NEAR(v->change.before[1] + hit->change[1], v->change.after[1], 16 * ROUNDING);
    assert_int_equal(ask(&r, 1, "ball", 1, "velocity")->count, 0);
    discard(&r);
}

static void a_vibrator_pushes_along_y(void **state)
{
    (void)state;
    const rheo_real position[6] = {8, 1, 0, 0, 9, 0};
    rheo_world_def def = inert_def();
    def.vibrators.kind = RHEO_VIBRATOR_FORCE;
    def.vibrators.count = 2;
    def.vibrators.position = some_vibrators();
    vibrators_of(&def)[1][0] = 8;
    def.vibrators.amplitude = 0.3;
    def.vibrators.radius = 5;
    def.vibrators.height = 2;
    recorded r = record(world_of(def, 2, position, NULL), 2);
    const list *l = ask(&r, 2, "vibrators", 0, "velocity");
    assert_int_equal(l->count, 1);
    const rheo_contribution *push = needed(l, RHEO_SOURCE_VIBRATOR, 1);
    assert_true(push->change[0] == 0 && push->change[1] != 0 && push->change[2] == 0);
    assert_int_equal(ask(&r, 2, "vibrators", 1, "velocity")->count, 0);
    discard(&r);
}

/* ---- Pairs ---- */

/* Parts that a test sets in the lively scene; NULL ends them. */
static rheo_world *lively(const char *const *settings)
{
    rheo_scene scene = lively_scene();
    for (; *settings; settings += 2)
        OK(rheo_scene_set(&scene, settings[0], settings[1], &error));
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/* Squared distance of two particles at the player's position. */
static double distance2(const rheo_player *player, uint64_t a, uint64_t b, double period)
{
    const rheo_real *x = rheo_world_positions(rheo_player_world(player));
    double sum = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        double d = (double)x[3 * a + axis] - (double)x[3 * b + axis];
        while (period > 0 && axis != 1 && d > period / 2)
            d -= period;
        while (period > 0 && axis != 1 && d < -period / 2)
            d += period;
        sum += d * d;
    }
    return sum;
}

/*
 * Every pair that a particle tells of exists, and its partner tells the opposite, to the last bit: the sums of each scheme are
 * made so. Returns the number of pairs.
 */
static size_t partners_agree(const recorded *r, uint64_t step, const char *stage, const char *field, double period)
{
    const double support = rheo_recording_definition(r->recording)->fluid.support;
    const uint64_t particles = rheo_world_particle_count(rheo_player_world(r->player));
    size_t pairs = 0;
    for (uint64_t n = 0; n < (every() > 1 ? 2 : 5); n++) {
        const uint64_t id = (n * 1009 + 17) % particles;
        static list own;
        own = *ask(r, step, stage, id, field);
        for (size_t i = 0; i < own.count; i++) {
            const rheo_contribution *c = &own.of[i], *back = NULL;
            if (strcmp(rheo_source_item(c->source), "particle") != 0)
                continue; /* of the ball */
            assert_true(c->item < particles && c->item != id);
            OK(rheo_player_seek(r->player, step, &error));
            if (!(distance2(r->player, id, c->item, period) < 2 * support * support))
                fail_msg("%s: %s of particle %llu is far from particle %llu", stage, rheo_source_name(c->source),
                         (unsigned long long)c->item, (unsigned long long)id);
            const list *other = ask(r, step, stage, c->item, field);
            for (size_t k = 0; k < other->count; k++)
                if (other->of[k].source == c->source && other->of[k].item == id &&
                    other->of[k].value[0] == -c->value[0] && other->of[k].value[1] == -c->value[1] &&
                    other->of[k].value[2] == -c->value[2])
                    back = &other->of[k];
            if (!back)
                fail_msg("%s: particle %llu does not tell the opposite of what %llu tells of %s %llu", stage,
                         (unsigned long long)c->item, (unsigned long long)id, rheo_source_name(c->source),
                         (unsigned long long)c->item);
            pairs++;
        }
    }
    return pairs;
}

/* The ranks of the particles differ from their ids in all lists. */
static void partners_tell_the_opposite(void **state)
{
    (void)state;
    static const char *const summed[] = {NULL}, *const sequential[] = {"scheme", "sequential", NULL},
                             *const positions[] = {"scheme", "positions", NULL};
    recorded r = record(lively(summed), 12);
    assert_true(partners_agree(&r, 12, "viscosity", "velocity", 0) > 10);
    assert_true(partners_agree(&r, 12, "forces@1", "velocity", 0) > 10);
    assert_true(partners_agree(&r, 12, "forces@1", "position", 0) > 10);
    discard(&r);
    r = record(lively(sequential), 12);
    assert_true(partners_agree(&r, 12, "viscosity", "velocity", 0) > 5);
    assert_true(partners_agree(&r, 12, "spring_displacement", "position", 0) > 10);
    assert_true(partners_agree(&r, 12, "density", "position", 0) > 10);
    discard(&r);
    r = record(lively(positions), 12);
    assert_true(partners_agree(&r, 12, "density_constraint", "position", 0) > 10);
    assert_true(partners_agree(&r, 12, "density_constraint", "velocity", 0) > 10);
    assert_true(partners_agree(&r, 12, "viscosity", "velocity", 0) > 10);
    discard(&r);
}

/* A block that fills a periodic space along x and z, and drifts. */
static rheo_world *periodic_world(double length)
{
    enum { SIDE = 5, COUNT = SIDE * SIDE * SIDE };
    static rheo_real x[3 * COUNT], v[3 * COUNT];
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    def.space.period[0] = def.space.period[2] = length;
    def.history.window = 10;
    for (int i = 0; i < COUNT; i++) {
        const int n = i * 37 % COUNT; /* ids are no order of places */
        const int at[3] = {n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE};
        for (int axis = 0; axis < 3; axis++) {
            x[3 * i + axis] = (rheo_real)((at[axis] + 0.02 * (i * (axis + 3) % 7)) * 2 - length / 2);
            v[3 * i + axis] = (rheo_real)(axis == 0 ? 20 : 0.1 * (i % 5));
        }
    }
    return world_of(def, COUNT, x, v);
}

static void periodic_space_puts_particles_back(void **state)
{
    (void)state;
    const double length = 10.25;
    enum { STEPS = 12 };
    recorded r = record(periodic_world(length), STEPS);
    const uint64_t particles = rheo_world_particle_count(rheo_player_world(r.player));
    uint64_t put_back = 0;
    for (uint64_t id = 0; id < particles; id += 4)
        for (uint64_t step = 2; step <= STEPS; step++) {
            const list *l = ask(&r, step, "neighbours", id, "position");
            if (!l->count)
                continue;
            const rheo_contribution *c = needed(l, RHEO_SOURCE_PERIOD, 0);
            assert_true(c->sets && l->count == 1);
            for (int axis = 0; axis < 3; axis++)
                if (c->change[axis] != 0)
                    NEAR(magnitude(c->change[axis]), axis == 1 ? 0 : length, 32 * ROUNDING);
            assert_true(c->change[0] != 0 || c->change[2] != 0);
            put_back += c->change[0] < 0;
        }
    assert_true(put_back > 3);
    assert_true(partners_agree(&r, STEPS, "viscosity", "velocity", length) > 10);
    assert_true(partners_agree(&r, STEPS, "forces@1", "velocity", length) > 10);
    told t = {.of = "periodic"};
    for (uint64_t id = 0; id < particles; id += 9)
        check_particle(r.player, STEPS, id, &t);
    discard(&r);
}

/* Two particles at one place part in opposite directions, whatever else is around them. */
static void coinciding_particles_tell_of_their_parting(void **state)
{
    (void)state;
    const char *const stages[] = {"forces", "density", "density_constraint"};
    for (int scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++) {
        const rheo_real position[12] = {1, 1, 1, 1, 3, 1, 1, 1, 1, 2, 2, 3};
        rheo_world_def def = rheo_default_world_def();
        def.scheme = (rheo_scheme)scheme;
        def.substeps = scheme == RHEO_SCHEME_SUMMED;
        def.fluid.rest_density = 1;
        recorded r = record(world_of(def, 4, position, NULL), 1);
        const list *a = ask(&r, 1, stages[scheme], 0, "position"), *b = ask(&r, 1, stages[scheme], 2, "position");
        const rheo_contribution *of_a = NULL, *of_b = NULL;
        for (size_t i = a->count; i-- > 0;)
            of_a = a->of[i].source == RHEO_SOURCE_PARTING ? &a->of[i] : of_a;
        for (size_t i = b->count; i-- > 0;)
            of_b = b->of[i].source == RHEO_SOURCE_PARTING ? &b->of[i] : of_b;
        assert_non_null(of_a);
        assert_non_null(of_b);
        assert_int_equal(of_a->item, 2);
        assert_int_equal(of_b->item, 0);
        assert_true(of_a->change[0] != 0);
        is_vector(of_b->change, -of_a->change[0], -of_a->change[1], -of_a->change[2], 0);
        told t = {.of = "coinciding"};
        for (uint64_t id = 0; id < 4; id++)
            check_particle(r.player, 1, id, &t);
        discard(&r);
    }
}

/* ---- The past ---- */

/* Lag by lag, oldest first: each weight times the velocity that the world remembers. */
static void each_lag_of_the_past_is_told(void **state)
{
    (void)state;
    enum { WINDOW = 20, LAG = 3, STEPS = 40, ID = 5 };
    static const char *const settings[] = {"history.window", "20", "history.lag", "3", NULL};
    recorded r = record(lively(settings), STEPS);
    const rheo_world *world = rheo_player_world(r.player);
    const rheo_world_def *def = rheo_recording_definition(r.recording);
    const double scale = rheo_history_scale(def->history.order, def->step, def->history.weights);
    for (uint64_t step = LAG + 2; step <= STEPS; step += 3) {
        OK(rheo_player_seek(r.player, step - 1, &error));
        world = rheo_player_world(r.player);
        rheo_real velocity[3 * (WINDOW + LAG + 1)];
        double weight[WINDOW + 1];
        const uint32_t rows = rheo_world_history_rows(world), old = rows - LAG;
        assert_true(rows > LAG && rows <= WINDOW + LAG + 1);
        assert_int_equal(rheo_world_particle_history(world, ID, velocity), RHEO_OK);
        rheo_history_weights(def->history.order, WINDOW + 1, weight);
        weight[old - 1] =
            old == WINDOW + 1 ? weight[old - 1] : rheo_history_first_weight(def->history.order, old - 1);
        const list *l = ask(&r, step, "fractional_derivative", ID, "derivative");
        assert_int_equal(l->count, old + 1);
        assert_int_equal(l->of[0].source, RHEO_SOURCE_NONE);
        assert_true(l->of[0].sets && l->of[0].value[0] == 0);
        for (uint32_t m = 0; m < old; m++) {
            const rheo_contribution *c = &l->of[old - m];
            assert_int_equal(c->source, RHEO_SOURCE_PAST);
            assert_int_equal(c->item, LAG + m);
            NEAR(c->factor, scale, ROUNDING * scale);
            for (size_t axis = 0; axis < 3; axis++) {
                const double expected = weight[m] * (double)velocity[3 * (LAG + m) + axis];
                NEAR(c->value[axis], expected, 2 * ROUNDING * magnitude(expected));
            }
        }
    }
    discard(&r);
}

static void each_mode_of_the_past_is_told(void **state)
{
    (void)state;
    enum { STEPS = 15, ID = 5 };
    static const char *const kinds[] = {"full", "tempered", "window-fast"};
    for (size_t k = 0; k < 3; k++) {
        const char *const settings[] = {"history.kind", kinds[k], NULL};
        recorded r = record(lively(settings), STEPS);
        OK(rheo_player_seek(r.player, STEPS - 1, &error));
        const rheo_world *world = rheo_player_world(r.player);
        rheo_mode_state modes[RHEO_HISTORY_MAX_MODES];
        rheo_real velocity[3 * (STEPS + 160)];
        const uint32_t count = rheo_world_history_modes(world);
        assert_int_equal(rheo_world_particle_modes(world, ID, modes), RHEO_OK);
        assert_int_equal(rheo_world_particle_history(world, ID, velocity), RHEO_OK);
        assert_true(count > 3);
        const list *l = ask(&r, STEPS, "fractional_derivative", ID, "derivative");
        assert_int_equal(l->count, count + 2);
        for (uint32_t m = 0; m < count; m++) {
            const rheo_contribution *c = needed(l, RHEO_SOURCE_MODE, m);
            const double expected = modes[m].weight * modes[m].sum[1];
            NEAR(c->value[1], expected, 2 * ROUNDING * magnitude(expected));
        }
        is_vector(needed(l, RHEO_SOURCE_PAST, 0)->value, (double)velocity[0], (double)velocity[1],
                  (double)velocity[2], 0);
        discard(&r);
    }
}

/* ---- Every scheme and kind of memory ---- */

static void each_scheme_and_memory_is_exact(void **state)
{
    (void)state;
    static const char *const cases[][7] = {
        {"history.kind", "window", "history.lag", "4", NULL},
        {"history.kind", "window", "history.weights", "l1", "history.window", "3", NULL},
        {"history.kind", "window-fast", NULL},
        {"history.kind", "full", "history.lag", "2", NULL},
        {"history.kind", "tempered", NULL},
        {"history.of", "length", NULL},
        {"history.hardening", "passive", NULL},
        {"history.stiffness", "0", NULL},
        {"springs.stiffness", "0", NULL},
        {"fluid.stiffness", "0", "fluid.near_stiffness", "0", NULL},
        {"vibrators.kind", "force", NULL},
        {"scheme", "sequential", NULL},
        {"scheme", "sequential", "springs.solver", "implicit", "history.kind", "full", NULL},
        {"scheme", "sequential", "history.stiffness", "0", "vibrators.kind", "force", NULL},
        {"scheme", "positions", NULL},
        {"scheme", "positions", "positions.iterations", "9", "history.stiffness", "0", NULL},
        {"scheme", "positions", "positions.history", "viscosity", "history.kind", "tempered", NULL},
    };
    enum { STEPS = 14 };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char name[128] = "";
        for (int i = 0; cases[k][i]; i++)
            snprintf(name + strlen(name), sizeof name - strlen(name), " %s", cases[k][i]);
        recorded r = record(lively(cases[k]), STEPS);
        told t = {.of = name};
        for (uint64_t step = 1; step <= STEPS; step += every() > 1 ? 13 : 4) {
            uint64_t id[INTERESTING];
            OK(rheo_player_seek(r.player, step - 1, &error));
            const size_t count = interesting(rheo_player_world(r.player), id);
            for (size_t i = 0; i < count; i++)
                check_particle(r.player, step, id[i], &t);
        }
        assert_true(t.by[RHEO_SOURCE_WALL] > 0 && t.by[RHEO_SOURCE_VISCOSITY] > 0);
        discard(&r);
    }
}

/* ---- Particles that come or do not exist ---- */

static void particles_added_in_the_step_are_told(void **state)
{
    (void)state;
    for (int scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++) {
        static const char *const names[] = {"summed", "sequential", "positions"};
        const char *const settings[] = {"scheme", names[scheme], NULL};
        const rheo_real position[6] = {7, 9, 7, 9, 9, 7};
        recorded r = record_and_add(lively(settings), 6, 2, position);
        const uint64_t before = rheo_recording_get_info(r.recording).particles;
        told t = {.of = "added"};
        for (uint64_t id = before; id < before + 2; id++) {
            check_particle(r.player, 6, id, &t);
            const list *l = ask(&r, 6, "prediction", id, "position");
            is_vector(l->change.before, (double)position[3 * (id - before)], 9, 7, 0);
        }
        assert_true(t.by[RHEO_SOURCE_GRAVITY] > 0 && t.by[RHEO_SOURCE_PRESSURE] > 0);
        REFUSED(RHEO_ERROR_ARGUMENT, "no particle",
                rheo_player_why(r.player, 6, NULL, before + 2, "position", check_change, &t, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "no particle",
                rheo_player_why(r.player, 5, NULL, before, "position", check_change, &t, &error));
        discard(&r);
    }
}

/* Springs that are far too stiff: some value of the step is not finite. */
static void a_step_that_fails_is_told(void **state)
{
    (void)state;
    rheo_error why = {""};
    rheo_failure failure;
    rheo_world *world = sequential_world();
    rheo_recorder *recorder = record_in_memory(world);
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_world_set(world, "springs.stiffness", "1e30", &error));
    rheo_result result = RHEO_OK;
    for (int i = 0; i < 50 && result == RHEO_OK; i++)
        result = rheo_recorder_step(recorder, &why);
    assert_int_equal(result, RHEO_ERROR_STATE);
    recorded r = reopen(recorder, world);
    assert_true(rheo_recording_failure(r.recording, &failure));
    told t = {.of = "failing"};
    for (uint64_t id = 0; id < 12; id++)
        check_particle(r.player, failure.step, 20 * id, &t);
    check_particle(r.player, failure.step, failure.id, &t);
    assert_true(t.by[RHEO_SOURCE_SPRING] > 50);
    /* The player is at the step before, and goes on from there. */
    assert_int_equal(rheo_world_step_count(rheo_player_world(r.player)), failure.step - 1);
    check_particle(r.player, failure.step - 1, 1, &t);
    discard(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gravity_adds_step_times_g),
        cmocka_unit_test(a_spring_acts_on_both_ends),
        cmocka_unit_test(a_spring_displaces_both_ends_in_scheme_sequential),
        cmocka_unit_test(a_wall_stops_a_particle),
        cmocka_unit_test(the_ball_pushes_outwards),
        cmocka_unit_test(a_vibrator_pushes_along_y),
        cmocka_unit_test(partners_tell_the_opposite),
        cmocka_unit_test(periodic_space_puts_particles_back),
        cmocka_unit_test(coinciding_particles_tell_of_their_parting),
        cmocka_unit_test(each_lag_of_the_past_is_told),
        cmocka_unit_test(each_mode_of_the_past_is_told),
        cmocka_unit_test(each_scheme_and_memory_is_exact),
        cmocka_unit_test(particles_added_in_the_step_are_told),
        cmocka_unit_test(a_step_that_fails_is_told),
    };
    return cmocka_run_group_tests_name("why of thickening", tests, NULL, NULL);
}
