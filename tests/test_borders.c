/* Limits hold at their very border: the last value that is allowed is taken, and the next one is refused. */
#include "support.h"

#include <float.h>
#include <math.h>

#include "world/world.h"

/* ---- Parameters ---- */

static bool takes(rheo_model model, const rheo_parameter *p, double value)
{
    rheo_world_def def = rheo_default_model_def(model);
    rheo_error error = {""};
    char text[128];
    snprintf(text, sizeof text, p->type == RHEO_PARAMETER_VECTOR ? "[0, %.17g, 0]" : "%.17g", value);
    const rheo_result result = rheo_world_def_set(&def, p->path, text, &error);
    assert_true(result == RHEO_OK || (result == RHEO_ERROR_ARGUMENT && strstr(error.message, p->path)));
    return result == RHEO_OK;
}

/* The number nearest to a limit on either side: whole numbers differ by 1. */
static double beside(const rheo_parameter *p, double limit, double towards)
{
    const bool whole = p->type == RHEO_PARAMETER_INTEGER || p->type == RHEO_PARAMETER_WINDOW;
    return whole ? limit + (towards > limit ? 1 : -1) : nextafter(limit, towards);
}

static void parameters_take_their_limits_and_nothing_beyond(void **unused)
{
    (void)unused;
    size_t examined = 0;
    for (rheo_model model = RHEO_MODEL_THICKENING; model <= RHEO_MODEL_MELTING; model++)
        for (size_t i = 0; i < rheo_parameter_count(); i++) {
            const rheo_parameter *p = rheo_parameter_at(i);
            if (p->type == RHEO_PARAMETER_CHOICE || !(p->models >> model & 1))
                continue;
            const double low = p->minimum, high = p->maximum;
            if (takes(model, p, low) == p->above_minimum || takes(model, p, high) == p->below_maximum)
                fail_msg("%s: a limit is not in the range as documented", p->path);
            if (takes(model, p, beside(p, low, -INFINITY)) || takes(model, p, beside(p, high, INFINITY)))
                fail_msg("%s: takes a value just beyond a limit", p->path);
            if (!takes(model, p, beside(p, low, INFINITY)) || !takes(model, p, beside(p, high, -INFINITY)))
                fail_msg("%s: refuses a value just inside a limit", p->path);
            examined++;
        }
    assert_true(examined > 50);
}

/* ---- Shapes ---- */

/* Whether the member itself is in range; other rules of the shape have other messages. */
static bool fits(rheo_fill_kind kind, const rheo_shape_member *member, double value)
{
    rheo_fill fill = {.kind = kind, .radius = 1, .height = 1, .depth = 1};
    const double values[3] = {value, value, value};
    memcpy((char *)&fill + member->offset, values, member->size);
    if (member->given)
        *((bool *)&fill + member->given) = true;
    char expected[96];
    snprintf(expected, sizeof expected, "%s must be", member->name);
    rheo_error error = {""};
    return rheo_fill_check(&fill, RHEO_MODEL_MELTING, &error) == RHEO_OK ||
           strncmp(error.message, expected, strlen(expected)) != 0;
}

static void shapes_take_their_limits_and_nothing_beyond(void **unused)
{
    (void)unused;
    size_t examined = 0;
    for (size_t kind = 0; kind < rheo_shape_count(); kind++) {
        const rheo_shape *shape = rheo_shape_at(kind);
        for (size_t m = 0; m < shape->member_count; m++) {
            const rheo_shape_member *member = &shape->member[m];
            if (member->type > RHEO_SHAPE_VECTOR)
                continue;
            const double low = member->minimum, high = member->maximum;
            if (fits((rheo_fill_kind)kind, member, low) == member->above_minimum ||
                !fits((rheo_fill_kind)kind, member, high) ||
                fits((rheo_fill_kind)kind, member, nextafter(low, -INFINITY)) ||
                fits((rheo_fill_kind)kind, member, nextafter(high, INFINITY)) ||
                !fits((rheo_fill_kind)kind, member, nextafter(low, INFINITY)) ||
                !fits((rheo_fill_kind)kind, member, nextafter(high, -INFINITY)))
                fail_msg("%s.%s: a limit is not that of the row", shape->name, member->name);
            examined++;
        }
    }
    assert_true(examined > 10);
}

/* Each axis of a block counts, and a block of no thickness is one. */
static void a_block_is_turned_in_no_axis(void **unused)
{
    (void)unused;
    for (int axis = 0; axis < 3; axis++) {
        rheo_fill fill = {.kind = RHEO_FILL_BLOCK, .max = {1, 1, 1}};
        fill.min[axis] = 1;
        OK(rheo_fill_check(&fill, RHEO_MODEL_THICKENING, &error));
        fill.min[axis] = nextafter(1, 2);
        REFUSED(RHEO_ERROR_ARGUMENT, "above", rheo_fill_check(&fill, RHEO_MODEL_THICKENING, &error));
    }
}

/* ---- Scenes ---- */

/* Whether a scene can be checked and its particles be counted, or neither, for a reason that names `limit`. */
static bool passes(const rheo_scene *scene, const char *limit)
{
    uint64_t count;
    rheo_error error[2] = {{""}, {""}};
    const bool bad[2] = {rheo_scene_check(scene, &error[0]) != RHEO_OK && says(error[0].message, limit),
                         rheo_scene_particle_count(scene, &count, &error[1]) != RHEO_OK &&
                             says(error[1].message, limit)};
    if (bad[0] != bad[1])
        fail_msg("\"%s\", but \"%s\"", error[0].message, error[1].message);
    return !bad[0];
}

static void scenes_take_their_limits_and_nothing_beyond(void **unused)
{
    (void)unused;
    static rheo_fill fill[RHEO_MAX_FILLS + 1];
    rheo_scene scene = rheo_default_scene();
    for (size_t f = 0; f <= RHEO_MAX_FILLS; f++)
        fill[f] = (rheo_fill){.kind = RHEO_FILL_SPHERE, .centre = {4.0 * (double)f, 0, 0}, .radius = 1};
    fill[RHEO_MAX_FILLS].radius = 1e12; /* too large, if it were one of them */
    scene.fill = fill;
    scene.world.fluid.spacing = 1;
    scene.fill_count = RHEO_MAX_FILLS;
    OK(rheo_scene_check(&scene, &error));
    assert_true(passes(&scene, "shapes"));
    scene.fill_count++;
    assert_false(passes(&scene, "65 shapes; at most 64"));
    scene.fill_count = 0;
    static const double limit[2][2] = {{0.1, 10}, {1e-12, 1e12}};
    for (int row = 0; row < 2; row++) {
        double *value = row ? &scene.world.fluid.spacing : &scene.resolution;
        const char *name = row ? "fluid.spacing is" : "resolution is";
        const double before = *value;
        for (int high = 0; high < 2; high++) {
            *value = limit[row][high];
            assert_true(passes(&scene, name));
            *value = nextafter(*value, high ? INFINITY : 0);
            assert_false(passes(&scene, name));
        }
        *value = before;
    }
    scene.particles = UINT64_C(1) << 30;
    assert_true(passes(&scene, "must be"));
    scene.particles++;
    assert_false(passes(&scene, "must be"));
}

/* ---- Definitions ---- */

static bool makes(const rheo_world_def *def)
{
    rheo_world *world = NULL;
    rheo_error error;
    const rheo_result result = rheo_world_create(def, &world, &error);
    assert_true(result == RHEO_OK || result == RHEO_ERROR_ARGUMENT);
    rheo_world_destroy(world);
    return result == RHEO_OK;
}

static void walls_take_their_limits_and_nothing_beyond(void **unused)
{
    (void)unused;
    rheo_wall plane[RHEO_MAX_WALLS + 1];
    rheo_world_def def = inert_def();
    for (int w = 0; w <= RHEO_MAX_WALLS; w++)
        plane[w] = (rheo_wall){.point = {1, -1, 2}, .normal = {0, 1, 0}};
    def.walls.plane = plane;
    def.walls.count = RHEO_MAX_WALLS;
    assert_true(makes(&def));
    def.walls.count++;
    assert_false(makes(&def));
    def.walls.count = 2;
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            const rheo_wall good = plane[1];
            plane[1].point[axis] = sign * nextafter(1e30, 0);
            assert_true(makes(&def));
            plane[1].point[axis] = sign * 1e30;
            const double *p = plane[1].point;
            char text[96];
            rheo_world *world;
            snprintf(text, sizeof text, "the point of wall 1 is [%g, %g, %g]", p[0], p[1], p[2]);
            REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_world_create(&def, &world, &error));
            plane[1] = good;
            memset(plane[1].normal, 0, sizeof plane[1].normal);
            plane[1].normal[axis] = sign * 1.01e-50; /* the limits of its square are 1e-100 and 1e100 */
            assert_true(makes(&def));
            plane[1].normal[axis] = sign * 0.99e-50;
            assert_false(makes(&def));
            plane[1].normal[axis] = sign * 0.99e50;
            assert_true(makes(&def));
            plane[1].normal[axis] = sign * 1.01e50;
            assert_false(makes(&def));
            plane[1] = good;
        }
}

static void vibrators_take_their_limits_and_nothing_beyond(void **unused)
{
    (void)unused;
    static double position[RHEO_MAX_VIBRATORS + 1][2];
    const rheo_wall floor = {.point = {0, 0, 0}, .normal = {0, 1, 0}};
    rheo_world_def def = inert_def();
    def.walls.plane = &floor;
    def.walls.count = 1;
    def.vibrators.position = (const double(*)[2])position;
    def.vibrators.count = RHEO_MAX_VIBRATORS;
    assert_true(makes(&def));
    def.vibrators.count++;
    assert_false(makes(&def));
    def.vibrators.count = 2;
    for (int axis = 0; axis < 2; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            position[1][axis] = sign * nextafter(1e30, 0);
            assert_true(makes(&def));
            position[1][axis] = sign * 1e30;
            assert_false(makes(&def));
            position[1][axis] = 0;
        }
}

/* ---- Items of arrays ---- */

static void ball_radii_are_0_or_at_least_1e_12(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    static const double good[] = {0, 1e-12, 1}, bad[] = {DBL_TRUE_MIN, 1e-13};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        def.ball.radius = good[i];
        OK(rheo_world_def_check(&def, &error));
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        def.ball.radius = bad[i];
        REFUSED(RHEO_ERROR_ARGUMENT, "ball.radius is", rheo_world_def_check(&def, &error));
    }
    def.ball.radius = nextafter(1e-12, 0);
    REFUSED(RHEO_ERROR_ARGUMENT, "ball.radius is", rheo_world_def_check(&def, &error));
}

enum { ITEMS = 3 };

static void refuses_each(const rheo_world_def *def, rheo_real *values, size_t count, size_t components,
                         const rheo_real *bad, size_t bads, const char *message)
{
    OK(rheo_world_def_check(def, &error));
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < bads; k++) {
            const rheo_real good = values[i];
            char text[96];
            snprintf(text, sizeof text, message, i / components);
            values[i] = bad[k];
            REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_world_def_check(def, &error));
            values[i] = good;
        }
}

static void every_item_of_a_definition_is_checked(void **unused)
{
    (void)unused;
    const rheo_real bad[] = {(rheo_real)NAN, (rheo_real)INFINITY, (rheo_real)-INFINITY, -1, 0};
    rheo_real position[3 * ITEMS] = {0, 0, 0, 1, 0, 0, 2, 0, 0}, velocity[3 * ITEMS] = {0};
    rheo_real density[ITEMS] = {1000, 1000, 1000}, temperature[ITEMS] = {300, 300, 300}, rest[2] = {0, 1};
    uint32_t material[ITEMS] = {0, 1, 0}, ends[4] = {0, 1, 0, 2};
    rheo_world_def def = rheo_default_world_def();
    def.particles.count = ITEMS;
    def.particles.position = position;
    def.particles.velocity = velocity;
    refuses_each(&def, position, 3 * ITEMS, 3, bad, 3, "the position of particle %zu is not finite");
    refuses_each(&def, velocity, 3 * ITEMS, 3, bad, 3, "the velocity of particle %zu is not finite");
    def.particles.spring_count = 2;
    def.particles.spring_ends = ends;
    def.particles.spring_rest_length = rest;
    refuses_each(&def, rest, 2, 1, bad, 4, "the rest length of spring %zu is not a finite length");
    static const struct {
        uint32_t ends[4];
        const char *refusal;
    } SPRINGS[] = {{{0, 1, 0, 3}, "spring 1 connects 0 and 3"},
                   {{0, 0, 0, 2}, "spring 0 connects 0 and 0"},
                   {{2, 1, 2, 1}, "spring 0 connects 2 and 1"},
                   {{0, 1, 0, 1}, "spring 1 is out of order"},
                   {{0, 2, 0, 1}, "spring 1 is out of order"},
                   {{1, 2, 0, 1}, "spring 1 is out of order"},
                   {{1, 2, 0, 2}, "spring 1 is out of order"},
                   {{0, 1, 1, 2}, NULL},
                   {{0, 2, 1, 2}, NULL}};
    for (size_t i = 0; i < sizeof SPRINGS / sizeof *SPRINGS; i++) {
        memcpy(ends, SPRINGS[i].ends, sizeof ends);
        if (SPRINGS[i].refusal)
            REFUSED(RHEO_ERROR_ARGUMENT, SPRINGS[i].refusal, rheo_world_def_check(&def, &error));
        else
            OK(rheo_world_def_check(&def, &error));
    }
    /* A material by the number behind the last one, for each particle. */
    const rheo_material soft = rheo_default_material("soft");
    OK(rheo_world_def_add_material(&def, &soft, &error));
    def.particles.material = material;
    OK(rheo_world_def_check(&def, &error));
    for (uint32_t i = 0; i < ITEMS; i++) {
        const uint32_t good = material[i];
        char text[64];
        snprintf(text, sizeof text, "particle %u is of material 2; the last material is 1", i);
        material[i] = 2;
        REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_world_def_check(&def, &error));
        material[i] = good;
    }
    def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.particles.count = ITEMS;
    def.particles.position = position;
    def.particles.density = density;
    def.particles.temperature = temperature;
    refuses_each(&def, density, ITEMS, 1, bad, 5, "the density of particle %zu is not above 0 and finite");
    refuses_each(&def, temperature, ITEMS, 1, bad, 3, "the temperature of particle %zu is not finite");
}

/* Each value of a loaded state is checked, from the first to the last of each field. */
static void every_item_of_a_state_is_checked(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    rheo__state *s = &world->state;
    OK(rheo__world_check_state(world, true, &error));
    const size_t n = s->particles;
    const struct {
        rheo_real *values;
        size_t count;
        const char *name;
    } FIELDS[] = {{s->position, 3 * n, "position"},
                  {s->velocity, 3 * n, "velocity"},
                  {s->ball_position, 3, "ball_position"},
                  {s->ball_velocity, 3, "ball_velocity"},
                  {s->ball_spin, 3, "ball_spin"},
                  {s->ball_orientation, 4, "ball_orientation"},
                  {s->vibrator_position, 4, "vibrator_position"},
                  {s->vibrator_phase, 2, "vibrator_phase"},
                  {s->vibrator_frequency, 2, "vibrator_frequency"}};
    for (size_t f = 0; f < sizeof FIELDS / sizeof *FIELDS; f++)
        for (size_t i = 0; i<FIELDS[f].count; i += FIELDS[f].count> 12 && i > 2 && i + 4 < FIELDS[f].count ? 7 : 1) {
            rheo_real *value = &FIELDS[f].values[i], good = *value;
            char text[64];
            snprintf(text, sizeof text, "%s of item", FIELDS[f].name);
            *value = (rheo_real)INFINITY;
            REFUSED(RHEO_ERROR_FORMAT, text, rheo__world_check_state(world, false, &error));
            *value = good;
        }
    for (uint32_t i = 0; i < 2; i++) {
        const rheo_real phase = s->vibrator_phase[i], frequency = s->vibrator_frequency[i];
        const struct {
            rheo_real phase, frequency;
            bool good;
        } CASES[] = {
            {0, 0, true}, {1, 1, false}, {(rheo_real)0.999, 1, true}, {(rheo_real)-0.001, 1, false}, {0, -1, false}};
        for (size_t c = 0; c < sizeof CASES / sizeof *CASES; c++) {
            s->vibrator_phase[i] = CASES[c].phase;
            s->vibrator_frequency[i] = CASES[c].frequency;
            char text[64];
            snprintf(text, sizeof text, "vibrator %u has no phase", i);
            if (CASES[c].good)
                OK(rheo__world_check_state(world, true, &error));
            else
                REFUSED(RHEO_ERROR_FORMAT, text, rheo__world_check_state(world, true, &error));
        }
        s->vibrator_phase[i] = phase;
        s->vibrator_frequency[i] = frequency;
    }
    const uint32_t rows = (uint32_t)*s->history_rows;
    assert_true(rows == 3 && s->ring.length > rows);
    for (uint32_t lag = 0; lag < rows; lag++)
        for (size_t i = 0; i < 3 * n; i += 3 * n - 1) {
            rheo_real *value = &rheo__ring_block(&s->ring, i / RHEO__RING_BLOCK,
                                                 rheo__ring_slot(&s->ring, lag))[i % RHEO__RING_BLOCK];
            const rheo_real good = *value;
            char text[96];
            snprintf(text, sizeof text, "history_velocity of particle %zu at lag %u is not finite", i / 3, lag);
            *value = (rheo_real)NAN;
            REFUSED(RHEO_ERROR_FORMAT, text, rheo__world_check_state(world, true, &error));
            OK(rheo__world_check_state(world, false, &error));
            *value = good;
        }
    *s->history_rows = s->ring.length;
    OK(rheo__world_check_state(world, false, &error));
    *s->history_rows += 1;
    REFUSED(RHEO_ERROR_FORMAT, "rows of history are more than the", rheo__world_check_state(world, false, &error));
    *s->history_rows = rows;
    OK(rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
}

/* ---- Commands ---- */

static void vibrators_go_as_far_as_1e30(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    for (int axis = 0; axis < 2; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double place[2] = {0, 0};
            place[axis] = sign * 1e30;
            OK(rheo_world_move_vibrator(world, 1, place[0], place[1], &error));
            place[axis] = sign * nextafter(1e30, INFINITY);
            REFUSED(RHEO_ERROR_ARGUMENT, "within 1e30",
                    rheo_world_move_vibrator(world, 1, place[0], place[1], &error));
        }
    rheo_world_destroy(world);
}

/* The speed and the spin that a push gives are limited along each axis, and a push that is refused changes nothing. */
static void a_push_gives_speed_and_spin_of_at_most_1e30(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo_body before, after;
    OK(rheo_world_body(world, 0, &before));
    const double spin_of_arm = 2.5 / (before.mass * before.radius * before.radius);
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double impulse[3] = {0, 0, 0}, point[3];
            impulse[axis] = sign * 1.000001e30 * before.mass;
            REFUSED(RHEO_ERROR_ARGUMENT, "at most 1e30", rheo_world_push_body(world, 0, impulse, NULL, &error));
            /* The spin is about the axis after the next one. */
            memcpy(point, before.position, sizeof point);
            impulse[axis] = sign * 1e10;
            const int arm = (axis + 1) % 3;
            point[arm] += 1.000001e30 / (1e10 * spin_of_arm);
            REFUSED(RHEO_ERROR_ARGUMENT, "at most 1e30", rheo_world_push_body(world, 0, impulse, point, &error));
            OK(rheo_world_body(world, 0, &after));
            assert_memory_equal(after.velocity, before.velocity, sizeof after.velocity);
            assert_memory_equal(after.spin, before.spin, sizeof after.spin);
            point[arm] = before.position[arm] + 0.999999e30 / (1e10 * spin_of_arm);
            OK(rheo_world_push_body(world, 0, impulse, point, &error));
            rheo_world_destroy(world);
            world = lively_world();
        }
    rheo_world_destroy(world);
}

static bool refuses;

static void *limited_allocate(size_t bytes, void *user)
{
    (void)user;
    return refuses ? NULL : malloc(bytes);
}
static void limited_release(void *memory, void *user)
{
    (void)user;
    free(memory);
}

/* As many particles as are allowed need memory, which is refused here; one more is refused before that. */
static void particles_are_at_most_a_power_of_two(void **unused)
{
    (void)unused;
    const rheo_real position[6] = {0, 0, 0, 3, 0, 0};
    rheo_world_def def = inert_def();
    def.allocator = (rheo_allocator){limited_allocate, limited_release, NULL};
    def.particles.count = (UINT32_C(1) << 30) + 1;
    def.particles.position = position;
    rheo_world *world = NULL;
    REFUSED(RHEO_ERROR_ARGUMENT, "2^30", rheo_world_create(&def, &world, &error));
    def.particles.count = 2;
    OK(rheo_world_create(&def, &world, &error));
    refuses = true;
    const uint32_t most = (UINT32_C(1) << 30) - 2;
    REFUSED(RHEO_ERROR_MEMORY, "no memory", rheo_world_add_particles(world, most, position, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "2^30", rheo_world_add_particles(world, most + 1, position, NULL, &error));
    refuses = false;
    rheo_world_destroy(world);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(parameters_take_their_limits_and_nothing_beyond),
        cmocka_unit_test(shapes_take_their_limits_and_nothing_beyond),
        cmocka_unit_test(a_block_is_turned_in_no_axis),
        cmocka_unit_test(scenes_take_their_limits_and_nothing_beyond),
        cmocka_unit_test(walls_take_their_limits_and_nothing_beyond),
        cmocka_unit_test(vibrators_take_their_limits_and_nothing_beyond),
        cmocka_unit_test(ball_radii_are_0_or_at_least_1e_12),
        cmocka_unit_test(every_item_of_a_definition_is_checked),
        cmocka_unit_test(every_item_of_a_state_is_checked),
        cmocka_unit_test(vibrators_go_as_far_as_1e30),
        cmocka_unit_test(a_push_gives_speed_and_spin_of_at_most_1e30),
        cmocka_unit_test(particles_are_at_most_a_power_of_two),
    };
    return cmocka_run_group_tests_name("borders", tests, NULL, NULL);
}
