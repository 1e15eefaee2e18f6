/* Helpers for all tests: small worlds, files, and assertions that print the library's message. */
#ifndef RHEO__TESTS_SUPPORT_H
#define RHEO__TESTS_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <cmocka.h>

#include "rheolog/rheolog.h"

#include "arrays.h"

/* Asserts that a call succeeds. */
#define OK(call)                                                                       \
    do {                                                                               \
        rheo_error error = {""};                                                       \
        rheo_result ok_result = (call);                                                \
        if (ok_result != RHEO_OK)                                                      \
            fail_msg("%s: %s: %s", #call, rheo_result_name(ok_result), error.message); \
    } while (0)

/* Messages of the reworded library are in capitals (src/core/error.h), so tests of messages ignore case. */
#ifdef RHEO__REWORDED
enum { REWORDED = 1 };
#else
enum { REWORDED = 0 };
#endif

/* Whether a message contains a text. */
static inline bool says(const char *message, const char *text)
{
    const size_t length = strlen(text);
    for (const char *at = message; strlen(at) >= length; at++)
        if ((REWORDED ? strncasecmp(at, text, length) : strncmp(at, text, length)) == 0)
            return true;
    return false;
}

/* Asserts that a call returns this error, with a message that contains this text. */
#define REFUSED(result, text, call)                                                 \
    do {                                                                            \
        rheo_error error = {""};                                                    \
        assert_int_equal(call, result);                                             \
        if (!says(error.message, text))                                             \
            fail_msg("%s: \"%s\" does not say \"%s\"", #call, error.message, text); \
    } while (0)

#define NEAR(actual, expected, tolerance)                                                                      \
    do {                                                                                                       \
        double near_actual = (actual), near_expected = (expected), near_tolerance = (tolerance);               \
        if (!(near_actual - near_expected <= near_tolerance && near_expected - near_actual <= near_tolerance)) \
            fail_msg("%s is %.12g, not %.12g +- %g", #actual, near_actual, near_expected, near_tolerance);     \
    } while (0)

#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer)
#define SANITIZED 1
#endif
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

/* Of very many similar cases a test takes every n-th: all, or fewer in slow builds or if RHEOLOG_TEST_EVERY says so. */
static inline size_t every(void)
{
    const char *text = getenv("RHEOLOG_TEST_EVERY");
    const int n = text ? atoi(text) : 0;
    return n > 0 ? (size_t)n : SANITIZED ? 11 : 1;
}

/* Returns a file's bytes, from malloc, followed by a zero. */
static inline uint8_t *read_file(const char *path, size_t *size)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    fseek(stream, 0, SEEK_END);
    *size = (size_t)ftell(stream);
    rewind(stream);
    uint8_t *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, stream), *size);
    bytes[*size] = 0;
    fclose(stream);
    return bytes;
}

static inline void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(bytes, 1, size, stream), size);
    assert_int_equal(fclose(stream), 0);
}

typedef struct file {
    uint8_t *bytes;
    size_t size;
} file;

static inline file read_and_remove(const char *path)
{
    file f;
    f.bytes = read_file(path, &f.size);
    remove(path);
    return f;
}

/* A definition without gravity, pressure, viscosity, springs and history. */
static inline rheo_world_def inert_def(void)
{
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    def.fluid.support = 2;
    def.fluid.spacing = 1;
    def.fluid.stiffness = def.fluid.near_stiffness = 0;
    def.fluid.linear_viscosity = def.fluid.quadratic_viscosity = 0;
    def.springs.stiffness = def.springs.plasticity = 0;
    def.history.stiffness = 0;
    return def;
}

/* A world of n particles; velocity may be NULL. */
static inline rheo_world *world_of(rheo_world_def def, uint32_t n, const rheo_real *position,
                                   const rheo_real *velocity)
{
    rheo_world *world = NULL;
    def.particles.count = n;
    def.particles.position = position;
    def.particles.velocity = velocity;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

/* The metric of the last step with this name. */
static inline double metric(const rheo_world *world, const char *name)
{
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        if (strcmp(rheo_world_metric_name(world, i), name) == 0)
            return rheo_world_metric(world, i);
    fail_msg("there is no metric %s", name);
    return 0;
}

static inline void step(rheo_world *world, int steps)
{
    for (int i = 0; i < steps; i++)
        OK(rheo_world_step(world, &error));
}

/* A built-in scene whose arrays need no release. */
static inline rheo_scene builtin_scene(const char *name)
{
    rheo_scene scene;
    OK(rheo_scene_builtin(name, &scene, &error));
    rheo_scene copy = scene;
    memset(&copy.owned, 0, sizeof copy.owned);
    copy.fill = memcpy(some_fills(), scene.fill, scene.fill_count * sizeof *scene.fill);
    copy.world.walls.plane =
        memcpy(some_walls(), scene.world.walls.plane, scene.world.walls.count * sizeof *scene.world.walls.plane);
    copy.world.vibrators.position = some_vibrators();
    memcpy(vibrators_of(&copy.world), scene.world.vibrators.position,
           scene.world.vibrators.count * sizeof *scene.world.vibrators.position);
    rheo_scene_release(&scene);
    return copy;
}

/* A small scene that has every kind of state: pool, walls, a ball that is pushed, springs, history, vibrators. */
static inline rheo_scene lively_scene(void)
{
    rheo_scene scene = builtin_scene("bowling-ball-small");
    fills_of(&scene)[0].max[0] = fills_of(&scene)[0].max[2] = 16;
    fills_of(&scene)[0].max[1] = 8;
    walls_of(&scene.world)[2].point[0] = 16;
    walls_of(&scene.world)[4].point[2] = 16;
    scene.world.ball.radius = 4;
    scene.world.ball.position[0] = scene.world.ball.position[2] = 8;
    scene.world.ball.velocity[1] = -10;
    scene.world.ball.push[0] = 2;
    scene.world.ball.push[1] = -3;
    scene.world.ball.push_frequency = 7;
    scene.ball.clearance = 0.5;
    scene.settle.time = 0.5;
    scene.world.history.window = 10;
    scene.world.vibrators.position = some_vibrators();
    scene.world.vibrators.count = 2;
    vibrators_of(&scene.world)[0][0] = vibrators_of(&scene.world)[0][1] = 4;
    vibrators_of(&scene.world)[1][0] = vibrators_of(&scene.world)[1][1] = 12;
    scene.world.vibrators.amplitude = 0.3;
    scene.world.vibrators.radius = 5;
    return scene;
}

static inline rheo_world *lively_world(void)
{
    rheo_scene scene = lively_scene();
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/* The same in scheme sequential, which overflows in one step if springs are too stiff. */
static inline rheo_world *sequential_world(void)
{
    rheo_scene scene = lively_scene();
    scene.world.scheme = RHEO_SCHEME_SEQUENTIAL;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

#endif
