/*
 * The balls of a definition: the first is def.ball, further ones are in def.balls. Their parameters are ball2.radius, ball3.radius
 * and so on; like those of materials, they have rows for each number that a ball may have.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "world/ball_rows.h"
#include "world/parameters.h"

/* ---- Rows ---- */

#define MODELS UINT32_C(1) << RHEO_MODEL_THICKENING
#define SCENE_ONLY false

#define REAL_OF_ANY(ball, member, unit, range, initial, live, meaning) \
    {HEAD("ballN." #member, REAL, unit, live, meaning), range},
#define VECTOR_OF_ANY(ball, member, unit, range, initial, live, meaning) \
    {HEAD("ballN." #member, VECTOR, unit, live, meaning), range},
#define REAL_OF(ball, member, unit, range, initial, live, meaning)       \
    {{HEAD("ball" #ball "." #member, REAL, unit, live, meaning), range}, \
     offsetof(rheo_world_def, balls.list[(ball)-2].member),              \
     0,                                                                  \
     {initial}},
#define VECTOR_OF(ball, member, unit, range, initial, live, meaning)       \
    {{HEAD("ball" #ball "." #member, VECTOR, unit, live, meaning), range}, \
     offsetof(rheo_world_def, balls.list[(ball)-2].member),                \
     0,                                                                    \
     {initial}},
#define ROWS(number) RHEO__BALL_ROWS(REAL_OF, VECTOR_OF, number)

static const rheo_parameter of_any[] = {RHEO__BALL_ROWS(REAL_OF_ANY, VECTOR_OF_ANY, N)};
static const rheo__parameter_row rows[] = {ROWS(2) ROWS(3) ROWS(4) ROWS(5) ROWS(6) ROWS(7) ROWS(8) ROWS(9) ROWS(10)
                                               ROWS(11) ROWS(12) ROWS(13) ROWS(14) ROWS(15) ROWS(16)};

enum { ROWS_OF_ONE = sizeof of_any / sizeof *of_any };
_Static_assert(sizeof rows / sizeof *rows == (RHEO_MAX_BALLS - 1) * ROWS_OF_ONE, "every further ball has its rows");

const rheo_parameter *rheo_ball_parameter_at(size_t index)
{
    return index < ROWS_OF_ONE ? &of_any[index] : NULL;
}

size_t rheo__ball_parameter_count(const rheo_world_def *def)
{
    return def->balls.count < RHEO_MAX_BALLS ? (size_t)def->balls.count * ROWS_OF_ONE : 0;
}

const rheo_parameter *rheo__ball_parameter_at(size_t index)
{
    return &rows[index].parameter;
}

const rheo_parameter *rheo__ball_parameter_find(const char *path)
{
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(rows[i].parameter.path, path) == 0)
            return &rows[i].parameter;
    return NULL;
}

uint32_t rheo__ball_in(const char *path, const char **member)
{
    if (strncmp(path, "ball", 4) != 0 || path[4] < '1' || path[4] > '9')
        return 0;
    uint32_t number = 0;
    const char *at = path + 4;
    for (; *at >= '0' && *at <= '9'; at++)
        number = number < 1000 ? 10 * number + (uint32_t)(*at - '0') : number;
    if (*at != '.' && *at != 0)
        return 0;
    *member = *at ? at + 1 : at;
    return number;
}

rheo_result rheo__ball_unknown(const char *path, rheo_error *error)
{
    const char *member;
    const uint32_t number = rheo__ball_in(path, &member);
    if (number == 1)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.64s: the first ball has no number; it is ball.%.32s", path,
                          member);
    if (number > RHEO_MAX_BALLS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.64s: a world has at most %d balls", path, RHEO_MAX_BALLS);
    char known[256] = "";
    for (size_t i = 0; i < ROWS_OF_ONE; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "",
                 of_any[i].path + strlen("ballN."));
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "%.64s: a ball has no such parameter; it has: %s, and in scenes clearance", path, known);
}

rheo_result rheo__ball_provide(rheo_world_def *def, const rheo_parameter *parameter, rheo_error *error)
{
    const char *member;
    const uint32_t number = rheo__ball_in(parameter->path, &member), count = def->balls.count + 1;
    if (number <= count)
        return RHEO_OK;
    const rheo_ball ball = rheo_default_ball();
    if (number > count + 1)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s: there is no ball %u; balls are numbered without gaps, so the next is ball %u",
                          parameter->path, number - 1, count + 1);
    return rheo_world_def_add_ball(def, &ball, error);
}

/* ---- Balls ---- */

rheo_ball rheo_default_ball(void)
{
    rheo_world_def def = {.cookie = 0};
    for (size_t i = 0; i < ROWS_OF_ONE; i++)
        rheo__row_set_default(&def, &rows[i]);
    return def.balls.list[0];
}

rheo_result rheo_world_def_add_ball(rheo_world_def *def, const rheo_ball *ball, rheo_error *error)
{
    if (def->balls.count >= RHEO_MAX_BALLS - 1)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a world has at most %d balls", RHEO_MAX_BALLS);
    def->balls.list[def->balls.count++] = *ball;
    return RHEO_OK;
}

uint32_t rheo_world_def_ball_count(const rheo_world_def *def)
{
    return def->ball.radius > 0 ? 1 + def->balls.count : 0;
}

const rheo_ball *rheo_world_def_ball(const rheo_world_def *def, uint32_t index)
{
    return index >= rheo_world_def_ball_count(def) ? NULL : index ? &def->balls.list[index - 1] : &def->ball;
}

rheo_result rheo__balls_check(const rheo_world_def *def, rheo_error *error)
{
    if (def->balls.count > RHEO_MAX_BALLS - 1)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u further balls; at most %d are possible",
                          def->balls.count, RHEO_MAX_BALLS - 1);
    for (size_t i = 0; i < rheo__ball_parameter_count(def); i++)
        RHEO__TRY(rheo__row_check(def, &rows[i], error));
    if (def->balls.count && !(def->ball.radius > 0))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "ball2 is given, but no first ball; set ball.radius");
    for (uint32_t i = 0; i <= def->balls.count; i++) {
        const double radius = i ? def->balls.list[i - 1].radius : def->ball.radius;
        if (i ? !(radius >= 1e-12) : radius > 0 && radius < 1e-12)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s.radius is %g; it must be %sat least 1e-12",
                              RHEO__BALL_NAME(i), radius, i ? "" : "0 (no ball) or ");
    }
    return RHEO_OK;
}

const char *rheo__ball_name(uint32_t index, char name[RHEO__BALL_NAME_SIZE])
{
    snprintf(name, RHEO__BALL_NAME_SIZE, index ? "ball%u" : "ball", (unsigned)(index % 1000 + 1));
    return name;
}
