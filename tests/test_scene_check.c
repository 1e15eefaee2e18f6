/* Warnings about scenes: what rheo_scene_warnings() finds, what creation refuses, and settling that blew up. */
#include <locale.h>
#include <math.h>

#define STORED "scene_warnings.txt"
#include "stored.h"

enum { ROOM = 32 };
static rheo_warning found[ROOM];
static size_t found_count;

/* All warnings of this program, with four digits of their numbers, are those of scene_warnings.txt. */
static void keep(const rheo_warning *w)
{
    char value[32], limit[32];
    stored_keep("%s%s, %llu, shapes %d %d, wall %d, %s of %s: %s\n", rheo_warning_name(w->kind),
                w->refused ? " refused" : "", (unsigned long long)w->count, w->shape, w->other_shape, w->wall,
                rheo__text_brief(w->value, 4, true, value), rheo__text_brief(w->limit, 4, true, limit), w->text);
}

static void examine(const rheo_scene *scene)
{
    OK(rheo_scene_warnings(scene, found, ROOM, &found_count, &error));
    assert_true(found_count <= ROOM);
    for (size_t i = 0; i < found_count; i++)
        keep(&found[i]);
}

/* The only warning of a scene. */
static const rheo_warning *only(const rheo_scene *scene, rheo_warning_kind kind)
{
    examine(scene);
    if (found_count != 1 || found[0].kind != kind)
        fail_msg("%zu warnings, first %s: %s; not one of %s", found_count, rheo_warning_name(found[0].kind),
                 found[0].text, rheo_warning_name(kind));
    return found;
}

static void assert_good(const rheo_scene *scene)
{
    examine(scene);
    if (found_count)
        fail_msg("%s: %zu warnings: %s", scene->name, found_count, found[0].text);
}

static void assert_says(const rheo_warning *warning, const char *part)
{
    if (!says(warning->text, part))
        fail_msg("\"%s\" is missing in: %s", part, warning->text);
}

static void add_block(rheo_scene *scene, double x, double y, double z, double size)
{
    rheo_fill *fill = (rheo_fill *)(uintptr_t)scene->fill + scene->fill_count++;
    const double low[3] = {x, y, z};
    fill->kind = RHEO_FILL_BLOCK;
    for (int axis = 0; axis < 3; axis++) {
        fill->min[axis] = low[axis];
        fill->max[axis] = low[axis] + size;
    }
}

static rheo_fill *fill_of(rheo_scene *scene, uint32_t index)
{
    return (rheo_fill *)(uintptr_t)scene->fill + index;
}

/* A cube of 4 x 4 x 4 particles, spacing 2, on a floor. */
static rheo_scene cube(void)
{
    rheo_scene scene = rheo_default_scene();
    rheo_wall *walls = some_walls();
    walls[0].normal[1] = 1;
    scene.world.walls.plane = walls;
    scene.world.walls.count = 1;
    scene.fill = some_fills();
    add_block(&scene, 0, 0, 0, 8);
    return scene;
}

/* The same with walls at x = 0 and x = 12 that face each other, and a ball well above between them. */
static rheo_scene ball_above(void)
{
    rheo_scene scene = cube();
    rheo_wall *walls = walls_of(&scene.world);
    walls[1].normal[0] = 2;
    walls[2].point[0] = 12;
    walls[2].normal[0] = -1;
    scene.world.walls.count = 3;
    scene.world.ball.radius = 4;
    scene.world.ball.position[0] = 6;
    scene.world.ball.position[1] = 30;
    return scene;
}

/* ---- No false alarm ---- */

static void built_in_scenes_have_no_warnings(void **state)
{
    (void)state;
    for (size_t i = 0; i < rheo_scene_builtin_count(); i++) {
        rheo_scene scene;
        OK(rheo_scene_builtin_at(i, &scene));
        assert_good(&scene);
        rheo_scene_release(&scene);
    }
}

static void good_scenes_have_no_warnings(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    assert_good(&scene);
    scene = ball_above();
    assert_good(&scene);
    scene = lively_scene();
    assert_good(&scene);
}

/* ---- Materials ---- */

/* Regression: a material that is missing in its shape is the main one there, and nothing told. */
static void a_material_that_no_shape_is_of_is_told(void **state)
{
    (void)state;
    static const char *const names[] = {"stiff", "soft"};
    rheo_scene scene = cube();
    for (int k = 0; k < 2; k++) {
        const rheo_material material = rheo_default_material(names[k]);
        OK(rheo_world_def_add_material(&scene.world, &material, &error));
    }
    strcpy(fill_of(&scene, 0)->material, "stiff");
    assert_says(only(&scene, RHEO_WARNING_PARAMETER), "no shape is of the material \"soft\": give one");
    strcpy(fill_of(&scene, 0)->material, "soft");
    assert_says(only(&scene, RHEO_WARNING_PARAMETER), "no shape is of the material \"stiff\"");
    scene.world.materials.count = 1;
    fill_of(&scene, 0)->material[0] = 0;
    assert_says(only(&scene, RHEO_WARNING_PARAMETER), "no shape is of the material \"stiff\"");
    strcpy(fill_of(&scene, 0)->material, "stiff");
    assert_good(&scene);
}

/* ---- Walls ---- */

static void particles_behind_a_wall_are_counted(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    add_block(&scene, 20, -4, 0, 8);
    const rheo_warning *w = only(&scene, RHEO_WARNING_BEHIND_WALL);
    assert_int_equal(w->shape, 1);
    assert_int_equal(w->wall, 0);
    assert_int_equal(w->count, 32); /* two of four layers, at y = -3 and -1 */
    NEAR(w->value, 3, 1e-6);
    assert_false(w->refused);
    assert_says(w, "32 of the 64 particles of shape 1 are behind wall 0");
    assert_says(w, "move the shape there by 4");
    fill_of(&scene, 1)->min[1] += 4;
    fill_of(&scene, 1)->max[1] += 4;
    assert_good(&scene);
    walls_of(&scene.world)[0].point[1] = 1.5; /* the lowest layers of both are at y = 1 */
    examine(&scene);
    assert_int_equal(found_count, 2);
    assert_int_equal(found[0].count + found[1].count, 32);
}

static void a_turned_normal_is_refused(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    rheo_world *world;
    walls_of(&scene.world)[0].normal[1] = -3;
    scene.world.gravity[1] = 0;
    const rheo_warning *w = only(&scene, RHEO_WARNING_TURNED_NORMAL);
    assert_true(w->refused);
    assert_int_equal(w->wall, 0);
    assert_int_equal(w->count, 64);
    NEAR(w->value, 7, 1e-6);
    assert_says(w, "turn it round, [0, 3, 0]");
    REFUSED(RHEO_ERROR_ARGUMENT, "all 64 particles are behind wall 0",
            rheo_scene_create_world(&scene, &world, &error));
    assert_null(world);
}

static void a_fall_without_a_floor_is_told(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    walls_of(&scene.world)[0].normal[1] = 0;
    walls_of(&scene.world)[0].normal[0] = 1;
    only(&scene, RHEO_WARNING_NO_FLOOR);
    walls_of(&scene.world)[0].normal[1] = 1e-3; /* a steep slope stops a fall */
    assert_good(&scene);
    scene.world.walls.count = 0;
    only(&scene, RHEO_WARNING_NO_FLOOR);
    memcpy(scene.world.gravity, (const double[3]){1, -2, 3}, sizeof scene.world.gravity);
    only(&scene, RHEO_WARNING_NO_FLOOR);
    assert_says(found, "no wall faces gravity [1, -2, 3]; add a wall");
    memset(scene.world.gravity, 0, sizeof scene.world.gravity);
    assert_good(&scene);
    rheo_scene melting = rheo_default_model_scene(RHEO_MODEL_MELTING);
    melting.fill = some_fills();
    add_block(&melting, 0, 0, 0, 0.5);
    only(&melting, RHEO_WARNING_NO_FLOOR);
    melting.world.melting.flow = RHEO_FLOW_FROZEN;
    assert_good(&melting);
}

/* ---- Overlap ---- */

static void shapes_that_overlap_are_named(void **state)
{
    (void)state;
    for (int far = 0; far < 2; far++) { /* on both sides of 0, where cells begin */
        const double x = far ? -7 : 1;
        rheo_scene scene = cube();
        scene.fill_count = 0;
        add_block(&scene, 40, 0, 0, 8);
        add_block(&scene, x, 0, 0, 8);
        add_block(&scene, x + 4.4, 0, 0, 8);
        const rheo_warning *w = only(&scene, RHEO_WARNING_OVERLAP);
        assert_int_equal(w->shape, 1);
        assert_int_equal(w->other_shape, 2);
        assert_int_equal(w->count, 32); /* two of four layers, 0.4 apart */
        NEAR(w->value, 0.4, 1e-5);
        assert_says(w, "shapes overlap, 1 and 2: 32 pairs");
        fill_of(&scene, 2)->min[0] = x + 5; /* just half the spacing apart */
        fill_of(&scene, 2)->max[0] = x + 13;
        only(&scene, RHEO_WARNING_COMPRESSED);
        fill_of(&scene, 2)->min[0] = x + 7; /* so are only the layers at their ends */
        fill_of(&scene, 2)->max[0] = x + 15;
        assert_good(&scene);
        fill_of(&scene, 2)->min[0] = x + 8; /* they touch */
        fill_of(&scene, 2)->max[0] = x + 16;
        assert_good(&scene);
    }
}

/* A lower spacing with the same support packs the fluid: it flies apart, unless the support follows. */
static void a_spacing_that_does_not_fit_the_support_is_told(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    scene.particles = 8 * 8 * 8; /* twice as close */
    const rheo_warning *w = only(&scene, RHEO_WARNING_COMPRESSED);
    assert_int_equal(w->shape, 0);
    assert_true(w->value > 5 && w->value < 15);
    assert_says(w, "what helps: resolution=2 in place of particles=512");
    assert_says(w, "fluid.support=1.9");
    scene.world.fluid.rest_density = 0; /* a gas has no density at rest */
    assert_good(&scene);
    scene = cube();
    scene.resolution = 2;
    assert_good(&scene);
}

/*
 * Two blocks in the same place, shifted by half a spacing along all axes: no pair is closer than 0.87 spacings, and the
 * density is twice that at rest, but for the weight of the sum at a particle itself.
 */
static void nested_blocks_are_compressed(void **state)
{
    (void)state;
    for (int melting = 0; melting < 2; melting++)
        for (int reversed = 0; reversed < 2; reversed++) {
            rheo_scene scene = melting ? rheo_default_model_scene(RHEO_MODEL_MELTING) : cube();
            const double s = scene.world.fluid.spacing, half = s / 2;
            if (melting) {
                scene.fill = some_fills();
                scene.world.melting.flow = RHEO_FLOW_FROZEN;
            }
            scene.fill_count = 0;
            add_block(&scene, reversed ? half : 0, reversed ? half : 0, reversed ? half : 0, 6 * s);
            add_block(&scene, 40 * s, 0, 0, 6 * s);
            add_block(&scene, reversed ? 0 : half, reversed ? 0 : half, reversed ? 0 : half, 6 * s);
            const rheo_warning *w = only(&scene, RHEO_WARNING_COMPRESSED);
            assert_int_equal(w->shape, 0);
            assert_int_equal(w->other_shape, 2);
            assert_in_range(w->count, 2 * 4 * 4 * 4, 2 * 6 * 6 * 6 - 1);
            const double rest = 1 + 6.0 / 9 + 12 * pow(1 - sqrt(2) / 1.5, 2),
                         nested = rest + 8 * pow(1 - sqrt(3) / 3, 2);
            NEAR(w->value, nested / rest, 0.02); /* with jitter */
            assert_says(w, "compressed");
            assert_says(w, "shapes 0 and 2 are in the same place");
            double x[3];
            const char *at = strstr(w->text, "at rest at [") + strlen("at rest at [");
            for (int axis = 0; axis < 3; axis++, at += strlen(", "))
                x[axis] = rheo_text_number(at, &at); /* with a point, whatever the locale */
            for (int axis = 0; axis < 3; axis++)
                assert_true(x[axis] > half && x[axis] < 6 * s);
            add_block(&scene, 40 * s + half, half, half, 6 * s); /* each pair is told */
            examine(&scene);
            assert_int_equal(found_count, 2);
            assert_true(found[0].shape == 0 && found[0].other_shape == 2);
            assert_true(found[1].shape == 1 && found[1].other_shape == 3);
            scene.fill_count--;
            fill_of(&scene, 2)->min[1] += 6 * s; /* on top of it */
            fill_of(&scene, 2)->max[1] += 6 * s;
            assert_good(&scene);
        }
}

/* Compared with all pairs. */
static void close_pairs_of_a_rough_shape_are_all_found(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    scene.fill_count = 0;
    add_block(&scene, -9, 0, -7, 16);
    fill_of(&scene, 0)->jitter = 0.5;
    const rheo_warning *w = only(&scene, RHEO_WARNING_OVERLAP);
    assert_int_equal(w->shape, 0);
    assert_int_equal(w->other_shape, 0);
    assert_says(w, "less jitter");
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    const rheo_real *x = rheo_world_positions(world);
    const uint32_t count = rheo_world_particle_count(world);
    uint64_t close = 0;
    double nearest = 1e30;
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < i; j++) {
            const double d[3] = {(double)x[3 * i] - (double)x[3 * j], (double)x[3 * i + 1] - (double)x[3 * j + 1],
                                 (double)x[3 * i + 2] - (double)x[3 * j + 2]};
            const double distance = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            close += distance < 0.999;
            nearest = distance < nearest ? distance : nearest;
        }
    rheo_world_destroy(world);
    assert_true(close > 20);
    assert_int_equal(w->count, close);
    NEAR(w->value, nearest, 1e-9);
}

/* ---- Ball ---- */

static void a_ball_in_a_wall_is_told_or_refused(void **state)
{
    (void)state;
    rheo_scene scene = ball_above();
    rheo_world *world;
    scene.world.ball.position[0] = 3; /* the normal of wall 1 is not of length 1 */
    const rheo_warning *w = only(&scene, RHEO_WARNING_BALL_IN_WALL);
    assert_int_equal(w->wall, 1);
    assert_false(w->refused);
    NEAR(w->value, 1, 1e-9);
    scene.world.ball.position[0] = -0.5;
    w = only(&scene, RHEO_WARNING_BALL_IN_WALL);
    assert_true(w->refused);
    NEAR(w->value, 4.5, 1e-9);
    REFUSED(RHEO_ERROR_ARGUMENT, "has its centre behind wall 1 by 0.5",
            rheo_scene_create_world(&scene, &world, &error));
    scene.world.ball.position[0] = 4; /* it touches the wall */
    assert_good(&scene);
}

static void a_ball_that_does_not_fit_between_walls_is_told(void **state)
{
    (void)state;
    rheo_scene scene = ball_above();
    scene.world.ball.radius = 6;
    assert_good(&scene);
    scene.world.ball.radius = 7;
    const rheo_warning *w = only(&scene, RHEO_WARNING_BALL_TOO_LARGE);
    NEAR(w->value, 14, 1e-9);
    NEAR(w->limit, 12, 1e-9);
    assert_says(w, "between walls 1 and 2: they are 12 apart");
    walls_of(&scene.world)[2].normal[2] = 0.5; /* no longer parallel: there is room at some z */
    examine(&scene);
    for (size_t i = 0; i < found_count; i++)
        assert_int_not_equal(found[i].kind, RHEO_WARNING_BALL_TOO_LARGE);
}

static void a_ball_in_the_fluid_is_told(void **state)
{
    (void)state;
    rheo_scene scene = ball_above();
    scene.world.ball.position[0] = 8;
    scene.world.ball.position[1] = 12; /* the highest particles are at y = 7 */
    scene.world.ball.position[2] = 4;
    assert_good(&scene);
    scene.world.ball.position[1] = 9.2; /* of them, those at x = 7, z = 3 and 5 are 2.61 away, others 3.85 and more */
    const rheo_warning *w = only(&scene, RHEO_WARNING_BALL_IN_FLUID);
    assert_int_equal(w->count, 2);
    NEAR(w->value, 4 - sqrt(1 + 1 + 2.2 * 2.2), 1e-5);
    assert_says(w, "raise ball.position by 1.542"); /* to y = 7 + sqrt(16 - 2) */
    scene.ball.clearance = 0;                       /* places it on the surface */
    assert_good(&scene);
    /* A block that stands out of the mean surface reaches into a ball that is placed on that. */
    add_block(&scene, 16, 0, 0, 8);
    add_block(&scene, 32, 0, 0, 8);
    add_block(&scene, 4, 8, 0, 8);
    walls_of(&scene.world)[2].point[0] = 60;
    w = only(&scene, RHEO_WARNING_BALL_IN_FLUID);
    const char *cure = strstr(w->text, "set ball.clearance to ");
    assert_non_null(cure);
    scene.ball.clearance = atof(cure + 22) + 0.01;
    assert_good(&scene);
}

/* The surface of a pool on a lattice lies half a spacing above the highest particles, whatever the depth. */
static void a_ball_is_placed_on_the_surface(void **state)
{
    (void)state;
    for (int depth = 16; depth <= 40; depth += 8) {
        rheo_fill block = {.kind = RHEO_FILL_BLOCK, .max = {24, depth, 24}};
        rheo_scene scene = rheo_default_scene();
        scene.fill = &block;
        scene.fill_count = 1;
        scene.world.fluid.spacing = 1;
        scene.world.fluid.support = 2;
        scene.world.ball.radius = 3;
        scene.ball.clearance = 5;
        rheo_world *world;
        rheo_body ball;
        OK(rheo_scene_create_world(&scene, &world, &error));
        OK(rheo_world_body(world, 0, &ball));
        double highest = 0;
        for (size_t i = 0; i < rheo_world_particle_count(world); i++)
            highest = fmax(highest, (double)rheo_world_positions(world)[3 * i + 1]);
        NEAR(ball.position[1] - ball.radius - 5, highest + 0.5, 0.1);
        rheo_world_destroy(world);
    }
}

/* ---- Speeds and parameters ---- */

static void speeds_that_a_step_does_not_resolve_are_told(void **state)
{
    (void)state;
    rheo_scene scene = ball_above();
    const double one = scene.world.fluid.support / scene.world.step; /* a support in a step */
    fill_of(&scene, 0)->velocity[2] = 0.9 * one;
    assert_good(&scene);
    fill_of(&scene, 0)->velocity[2] = -1.5 * one;
    const rheo_warning *w = only(&scene, RHEO_WARNING_SPEED);
    assert_int_equal(w->shape, 0);
    NEAR(w->value, 1.5, 1e-9);
    NEAR(w->limit, 1, 0);
    scene = ball_above();
    scene.world.ball.velocity[1] = -3 * one;
    scene.world.gravity[1] = 0; /* or it arrives faster */
    w = only(&scene, RHEO_WARNING_PARAMETER);
    assert_says(w, "ball_speed");
    assert_says(w, "step=");
    NEAR(w->value, 3, 1e-9);
    rheo_scene melting = rheo_default_model_scene(RHEO_MODEL_MELTING);
    melting.world.walls = scene.world.walls;
    melting.world.walls.count = 1;
    melting.fill = some_fills();
    add_block(&melting, 0, 0, 0, 0.5);
    assert_good(&melting);
    fill_of(&melting, 0)->velocity[0] = 0.5 * melting.world.melting.sound_speed;
    w = only(&melting, RHEO_WARNING_PARAMETER);
    assert_says(w, "mach_number");
    NEAR(w->value, 0.5, 1e-9);
}

/* They were silent: plates without particles do nothing, and fluid cannot follow a plate that is too fast. */
static void plates_without_particles_and_fast_ones_are_told(void **state)
{
    (void)state;
    rheo_scene scene;
    OK(rheo_scene_builtin("plates", &scene, &error));
    const double upper = scene.world.plates.upper, one = scene.world.fluid.support / scene.world.step;
    scene.world.plates.upper = 1000;
    const rheo_warning *w = only(&scene, RHEO_WARNING_EMPTY);
    assert_says(w, "the upper plate has no particles");
    scene.world.plates.lower = 999; /* all of the fluid is the lower plate */
    only(&scene, RHEO_WARNING_EMPTY);
    scene.world.plates.upper = upper;
    scene.world.plates.lower = -1000;
    assert_says(only(&scene, RHEO_WARNING_EMPTY), "the lower plate has no particles");
    scene.world.plates.upper = 1000;
    examine(&scene);
    assert_int_equal(found_count, 2);
    rheo_scene_release(&scene);
    OK(rheo_scene_builtin("plates", &scene, &error));
    scene.world.plates.velocity[0] = -0.49 * one;
    assert_good(&scene);
    scene.world.plates.velocity[0] = -1.5 * one;
    w = only(&scene, RHEO_WARNING_PARAMETER);
    assert_says(w, "plate_speed (how far the upper plate moves in a step, in supports) is 1.5, more than 1");
    NEAR(w->value, 1.5, 1e-9);
    scene.world.plates.velocity[0] = 0;
    scene.world.plates.amplitude = one;
    scene.world.plates.frequency = 1;
    NEAR(only(&scene, RHEO_WARNING_PARAMETER)->value, 6.283185307, 1e-6);
    scene.world.plates.control = RHEO_PLATES_STRESS;
    scene.world.plates.amplitude = scene.world.plates.frequency = 0;
    scene.world.plates.velocity[0] = 9 * one;
    only(&scene, RHEO_WARNING_PARAMETER); /* it is not too fast, because it does nothing */
    rheo_scene_release(&scene);
}

/* Jitter puts particles behind a wall that their lattice touches, by at most that far along each axis. */
static void only_jitter_behind_a_wall_is_no_mistake(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    rheo_wall *wall = walls_of(&scene.world);
    fill_of(&scene, 0)->jitter = 0.1;
    wall->point[1] = 1; /* the lowest layer */
    assert_good(&scene);
    wall->point[1] = 1.1; /* the layer is half as deep behind the wall as jitter reaches */
    const rheo_warning *w = only(&scene, RHEO_WARNING_BEHIND_WALL);
    assert_true(w->count > 1 && w->count < 16 && w->value > 0.2 && w->value <= 0.3 + 1e-5);
    fill_of(&scene, 0)->jitter = 0;
    assert_int_equal(only(&scene, RHEO_WARNING_BEHIND_WALL)->count, 16);
    wall->point[1] = 1 + 1e-3;
    assert_int_equal(only(&scene, RHEO_WARNING_BEHIND_WALL)->count, 16);
    wall->point[1] = 1 + 1e-7; /* rounding */
    assert_good(&scene);
    /* Along the normal of an inclined wall, jitter of several axes adds up. */
    fill_of(&scene, 0)->jitter = 0.1;
    for (int axis = 0; axis < 3; axis++) {
        wall->normal[axis] = 1;
        wall->point[axis] = 1;
    }
    assert_good(&scene);
    OK(rheo_scene_builtin("bowling-ball-small", &scene, &error));
    OK(rheo_scene_set(&scene, "particles", "1500", &error));
    assert_good(&scene);
    rheo_scene_release(&scene);
}

static void a_scene_without_shapes_has_no_fluid(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    scene.fill_count = 0;
    assert_says(only(&scene, RHEO_WARNING_EMPTY), "there is no fluid");
}

/* The parameter after "what helps: " can be set in the scene and brings the measure into its range. */
static void assert_helps(const rheo_scene *scene, const char *measure)
{
    char set[64] = "";
    for (size_t i = 0; i < found_count; i++) {
        const char *helps = strstr(found[i].text, "what helps: ");
        if (strncmp(found[i].text, measure, strlen(measure)) == 0 && helps)
            snprintf(set, sizeof set, "%.*s", (int)strcspn(helps + 12, " "), helps + 12);
    }
    char *value = strchr(set, '=');
    if (!value)
        fail_msg("nothing helps against %s in %s", measure, found[0].text);
    *value++ = 0;
    rheo_scene changed = *scene;
    OK(rheo_scene_set(&changed, set, value, &error));
    examine(&changed);
    for (size_t i = 0; i < found_count; i++)
        if (strncmp(found[i].text, measure, strlen(measure)) == 0)
            fail_msg("%s=%s does not help: %s", set, value, found[i].text);
}

static void what_helps_can_be_done_and_helps(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *set[6], *measure;
    } cases[] = {
        {"bowling-ball-small", {"fluid.stiffness", "4.35e5"}, "pressure_number"},
        {"bowling-ball-small", {"fluid.stiffness", "1e12"}, "pressure_number"}, /* settling would take years */
        {"bowling-ball-small", {"fluid.near_stiffness", "1e12"}, "near_pressure_number"},
        {"bowling-ball-small", {"fluid.stiffness", "1e5", "resolution", "2"}, "pressure_number"},
        {"bowling-ball-small", {"fluid.stiffness", "1e12", "scheme", "sequential"}, "pressure_number"},
        {"bowling-ball-small", {"substeps", "1", "fluid.stiffness", "1e9"}, "pressure_number"},
        {"bowling-ball-small", {"springs.plasticity", "1e9", "scheme", "sequential"}, "plasticity_number"},
        {"bowling-ball-small", {"ball.velocity", "[0, -1e5, 0]"}, "ball_speed"},
        {"vibration", {"vibrators.amplitude", "1e6"}, "vibrator_speed"},
        {"melting-box", {"melting.sound_speed", "1e6"}, "substep_courant_number"},
        {"melting-box", {"melting.sound_speed", "1e6", "melting.max_substeps", "2"}, "substep_courant_number"},
        {"melting-box", {"melting.solver", "explicit", "melting.max_substeps", "2"}, "viscous_number"},
        {"melting-box", {"melting.diffusivity", "1e3", "melting.max_substeps", "2"}, "heat_number"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_scene scene;
        OK(rheo_scene_builtin(cases[i].scene, &scene, &error));
        OK(rheo_scene_set(&scene, "particles", "500", &error));
        for (const char *const *set = cases[i].set; set < cases[i].set + 6 && *set; set += 2)
            OK(rheo_scene_set(&scene, set[0], set[1], &error));
        examine(&scene);
        assert_helps(&scene, cases[i].measure);
        rheo_scene_release(&scene);
    }
}

static void parameters_out_of_the_ranges_of_the_doctor_are_told(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    rheo_world_def *def = &scene.world;
    def->substeps = 1;
    def->step = 0.04;
    const rheo_warning *w;
    examine(&scene);
    assert_int_equal(found_count, 2);
    assert_says(&found[0], "pressure_number");
    assert_says(&found[0], "substeps=0");
    NEAR(found[0].value, 300 * 0.04 * 0.04 / 4, 1e-9);
    NEAR(found[0].limit, 0.085, 0);
    assert_says(&found[1], "near_pressure_number");
    def->substeps = 0; /* as many as the state needs, up to max_substeps */
    assert_good(&scene);
    def->max_substeps = 1;
    examine(&scene);
    assert_int_equal(found_count, 2);
    def->max_substeps = 16;
    def->scheme = RHEO_SCHEME_SEQUENTIAL;
    def->step = 0.033;
    assert_good(&scene);
    def->fluid.stiffness = 900;
    w = only(&scene, RHEO_WARNING_PARAMETER);
    NEAR(w->value, 900 * 0.033 * 0.033 / 4, 1e-9);
    assert_says(w, "what helps: step=0.0");
    def->fluid.stiffness = 300;
    def->scheme = RHEO_SCHEME_SUMMED;
    def->substeps = 2;
    def->springs.stiffness = 500; /* a warning of the model itself */
    w = only(&scene, RHEO_WARNING_PARAMETER);
    assert_says(w, "springs.stiffness is too large for substeps");
}

static void shapes_without_a_particle_are_told(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    fill_of(&scene, 0)->max[1] = 0.5;
    only(&scene, RHEO_WARNING_EMPTY);
}

/* ---- The list ---- */

static void a_short_list_counts_all_warnings(void **state)
{
    (void)state;
    rheo_scene scene = ball_above();
    size_t count = 0;
    scene.world.ball.position[0] = 3;
    scene.world.gravity[1] = 1;
    memset(found, 1, sizeof found);
    OK(rheo_scene_warnings(&scene, found, 1, &count, &error));
    assert_int_equal(count, 2);
    assert_int_equal(found[0].kind, RHEO_WARNING_NO_FLOOR);
    assert_int_equal(found[1].text[0], 1);
    OK(rheo_scene_warnings(&scene, NULL, 0, &count, &error));
    assert_int_equal(count, 2);
    scene.world.step = -1;
    REFUSED(RHEO_ERROR_ARGUMENT, "step", rheo_scene_warnings(&scene, NULL, 0, &count, &error));
    assert_int_equal(count, 0);
    assert_string_equal(rheo_warning_name(RHEO_WARNING_EMPTY), "empty");
    assert_string_equal(rheo_warning_name((rheo_warning_kind)99), "unknown");
}

static char told[8192];
static int warnings_told;

static void tell(const char *text, void *user)
{
    (void)user;
    warnings_told += strncmp(text, "warning: ", 9) == 0;
    snprintf(told + strlen(told), sizeof told - strlen(told), "%s\n", text);
}

/* Creates the world of a scene and notes what the log is told. */
static rheo_world *create(rheo_scene *scene)
{
    rheo_world *world;
    told[0] = 0;
    warnings_told = 0;
    scene->world.log = (rheo_log){tell, NULL};
    OK(rheo_scene_create_world(scene, &world, &error));
    return world;
}

static void creation_tells_the_same_warnings(void **state)
{
    (void)state;
    rheo_scene scene = ball_above();
    scene.world.ball.position[0] = 3;
    scene.world.substeps = 1; /* both pressures */
    scene.world.step = 0.05;
    rheo_world_destroy(create(&scene));
    examine(&scene);
    assert_int_equal(found_count, 3);
    assert_int_equal(warnings_told, 3);
    for (size_t i = 0; i < found_count; i++)
        if (!says(told, found[i].text))
            fail_msg("\"%s\" is missing in: %s", found[i].text, told);
    /* So does a world without a scene, of its parameters and speeds. */
    rheo_world_def def = scene.world;
    const rheo_real position[3] = {0, 1, 0}, velocity[3] = {1, 0, 0};
    told[0] = 0;
    warnings_told = 0;
    rheo_world_destroy(world_of(def, 1, position, velocity));
    assert_int_equal(warnings_told, 2);
    assert_true(says(told, "warning: pressure_number"));
}

/* ---- Settling ---- */

/* Settling of a scene that is too stiff for its step: scheme sequential has no substeps. */
static rheo_scene stiff_pool(double stiffness)
{
    rheo_scene scene = lively_scene();
    scene.world.scheme = RHEO_SCHEME_SEQUENTIAL;
    scene.world.fluid.stiffness = stiffness;
    scene.world.vibrators.count = 0;
    scene.settle.time = 2;
    return scene;
}

static void settling_that_blew_up_is_told(void **state)
{
    (void)state;
    rheo_scene scene = stiff_pool(3000);
    rheo_world *world = create(&scene);
    char supports[64];
    assert_int_equal(warnings_told, 2); /* of the parameter, and of what came of it */
    const char *text = strstr(told, "warning: settling blew up before step 0, from its step ");
    assert_non_null(text);
    assert_true(metric(world, "courant_number") > 0.5); /* of the world that was made */
    rheo__text_print(supports, sizeof supports, "%.3g supports per step", metric(world, "courant_number"));
    assert_non_null(strstr(text, supports));
    assert_non_null(strstr(text, "make the scene again with step="));
    /* Made again as advised, the scene settles. */
    const char *end;
    const double step = rheo_text_number(strstr(text, "with step=") + 10, &end);
    assert_true(step > 0.005 && step < 0.02);
    rheo_world_destroy(world);
    scene.world.step = step;
    rheo_world_destroy(create(&scene));
    assert_int_equal(warnings_told, 0);
}

static void a_good_settling_has_no_warning(void **state)
{
    (void)state;
    rheo_scene scene = stiff_pool(300);
    rheo_world_destroy(create(&scene));
    assert_int_equal(warnings_told, 0);
    assert_non_null(strstr(told, "settling"));
    scene = lively_scene();
    rheo_world_destroy(create(&scene));
    assert_int_equal(warnings_told, 0);
    /* Particles that are thrown apart at first come to rest: the state is what counts. */
    scene = cube();
    add_block(&scene, 0.3, 0, 0.3, 8);
    scene.settle.time = 9;
    rheo_world_destroy(create(&scene));
    assert_int_equal(warnings_told, 1);
    assert_non_null(strstr(told, "warning: shapes overlap"));
}

static void fluid_that_has_not_settled_is_told(void **state)
{
    (void)state;
    rheo_scene scene = cube();
    fill_of(&scene, 0)->min[1] += 900;
    fill_of(&scene, 0)->max[1] += 900;
    scene.settle.time = 8;
    scene.settle.fraction = 0;
    rheo_world_destroy(create(&scene));
    assert_int_equal(warnings_told, 1);
    assert_non_null(strstr(told, "warning: the fluid has not settled before step 0: its largest speed is 78"));
    assert_non_null(strstr(told, "settle.time=16"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(built_in_scenes_have_no_warnings),
                                       cmocka_unit_test(good_scenes_have_no_warnings),
                                       cmocka_unit_test(a_material_that_no_shape_is_of_is_told),
                                       cmocka_unit_test(particles_behind_a_wall_are_counted),
                                       cmocka_unit_test(a_turned_normal_is_refused),
                                       cmocka_unit_test(a_fall_without_a_floor_is_told),
                                       cmocka_unit_test(shapes_that_overlap_are_named),
                                       cmocka_unit_test(nested_blocks_are_compressed),
                                       cmocka_unit_test(a_spacing_that_does_not_fit_the_support_is_told),
                                       cmocka_unit_test(close_pairs_of_a_rough_shape_are_all_found),
                                       cmocka_unit_test(a_ball_in_a_wall_is_told_or_refused),
                                       cmocka_unit_test(a_ball_that_does_not_fit_between_walls_is_told),
                                       cmocka_unit_test(a_ball_in_the_fluid_is_told),
                                       cmocka_unit_test(speeds_that_a_step_does_not_resolve_are_told),
                                       cmocka_unit_test(plates_without_particles_and_fast_ones_are_told),
                                       cmocka_unit_test(only_jitter_behind_a_wall_is_no_mistake),
                                       cmocka_unit_test(a_scene_without_shapes_has_no_fluid),
                                       cmocka_unit_test(what_helps_can_be_done_and_helps),
                                       cmocka_unit_test(parameters_out_of_the_ranges_of_the_doctor_are_told),
                                       cmocka_unit_test(shapes_without_a_particle_are_told),
                                       cmocka_unit_test(a_short_list_counts_all_warnings),
                                       cmocka_unit_test(creation_tells_the_same_warnings),
                                       cmocka_unit_test(settling_that_blew_up_is_told),
                                       cmocka_unit_test(a_good_settling_has_no_warning),
                                       cmocka_unit_test(fluid_that_has_not_settled_is_told),
                                       cmocka_unit_test(a_ball_is_placed_on_the_surface),
                                       cmocka_unit_test(texts_are_the_stored_ones)};
    setlocale(LC_ALL, "de_DE.UTF-8"); /* where there is one: warnings have a point all the same */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
