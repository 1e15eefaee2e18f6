/* Parameters of scenes: the parameters of the world, then those that are used only to create a scene. */
#include "scenes/parameters.h"

#include <string.h>

#include "core/error.h"
#include "world/parameters.h"
#include "world/model_list.h"
#include "world/row_macros.h"

#define OWNER rheo_scene
#define SCENE_ONLY true
static const rheo__parameter_row rows[] = {
#include "scenes/parameters.def"
};
enum { ROWS = sizeof rows / sizeof *rows };

/* Those of further balls: found by path, and not listed. */
#define CLEARANCE(number)                                                                                         \
    {{.path = "ball" #number ".clearance",                                                                        \
      .type = RHEO_PARAMETER_REAL,                                                                                \
      .unit = "L",                                                                                                \
      .about =                                                                                                    \
          "height of the ball's lowest point above the settled surface at step 0; below 0: its position is used", \
      .models = RHEO__MODELS_THAT_SETTLE,                                                                         \
      .scene_only = true,                                                                                         \
      ANY},                                                                                                       \
     offsetof(rheo_scene, balls.clearance[(number)-2]),                                                           \
     0,                                                                                                           \
     {-1}},
static const rheo__parameter_row of_balls[] = {
    CLEARANCE(2) CLEARANCE(3) CLEARANCE(4) CLEARANCE(5) CLEARANCE(6) CLEARANCE(7) CLEARANCE(8) CLEARANCE(9)
        CLEARANCE(10) CLEARANCE(11) CLEARANCE(12) CLEARANCE(13) CLEARANCE(14) CLEARANCE(15) CLEARANCE(16)};
enum { OF_BALLS = sizeof of_balls / sizeof *of_balls };
_Static_assert(OF_BALLS == RHEO_MAX_BALLS - 1, "every further ball has a row");

size_t rheo_scene_parameter_count(void)
{
    return rheo_parameter_count() + ROWS;
}

const rheo_parameter *rheo_scene_parameter_at(size_t index)
{
    const size_t of_world = rheo_parameter_count();
    if (index < of_world)
        return rheo_parameter_at(index);
    return index - of_world < ROWS ? &rows[index - of_world].parameter : NULL;
}

static const rheo__parameter_row *find_row(const char *path)
{
    for (size_t i = 0; i < ROWS; i++)
        if (strcmp(rows[i].parameter.path, path) == 0)
            return &rows[i];
    for (size_t i = 0; i < OF_BALLS; i++)
        if (strcmp(of_balls[i].parameter.path, path) == 0)
            return &of_balls[i];
    return NULL;
}

const rheo_parameter *rheo_scene_parameter_find(const char *path)
{
    const rheo__parameter_row *row = find_row(path);
    const rheo_parameter *of_ball = row ? &row->parameter : rheo__ball_parameter_find(path);
    return of_ball ? of_ball : rheo__parameter_find(path);
}

const char *rheo_scene_parameter_nearest(const char *path)
{
    const char *nearest = rheo_parameter_nearest(path);
    for (size_t i = 0; i < ROWS; i++) {
        const char *const two[] = {nearest, rows[i].parameter.path};
        nearest = rheo_nearest_word(path, two, 2);
    }
    return nearest;
}

rheo_result rheo_scene_set(rheo_scene *scene, const char *path, const char *value, rheo_error *error)
{
    const rheo_parameter *p = rheo_scene_parameter_find(path);
    const char *member;
    if (!p && (rheo__list_of(path) || rheo__is_of_obstacle(path) || rheo__ball_in(path, &member)))
        return rheo_world_def_set(&scene->world, path, value, error);
    if (!p)
        return rheo__parameter_unknown(path, rheo_scene_parameter_nearest(path), error);
    if (strcmp(path, "model") == 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "model cannot be set: a scene is made for one model, this one for %s; a scene file "
                          "chooses by \"model\": \"NAME\"",
                          rheo_model_name(scene->world.model));
    if (!p->scene_only)
        return rheo_world_def_set(&scene->world, path, value, error);
    RHEO__TRY(rheo__parameter_check_model(p, scene->world.model, error));
    RHEO__TRY(rheo__ball_provide(&scene->world, p, error));
    return rheo__row_set(scene, find_row(path), value, error);
}

rheo_result rheo_scene_get(const rheo_scene *scene, const char *path, char *value, size_t size)
{
    const rheo__parameter_row *row = find_row(path);
    return row ? rheo__row_get(scene, row, value, size) : rheo_world_def_get(&scene->world, path, value, size);
}

void rheo__scene_set_defaults(rheo_scene *scene)
{
    for (size_t i = 0; i < ROWS; i++)
        rheo__row_set_default(scene, &rows[i]);
    for (size_t i = 0; i < OF_BALLS; i++)
        rheo__row_set_default(scene, &of_balls[i]);
}

rheo_result rheo__scene_parameters_check(const rheo_scene *scene, rheo_error *error)
{
    for (size_t i = 0; i < ROWS; i++) {
        RHEO__TRY(rheo__row_check(scene, &rows[i], error));
        if (!rheo__row_has_default(scene, &rows[i])) /* a changed parameter must exist in the model */
            RHEO__TRY(rheo__parameter_check_model(&rows[i].parameter, scene->world.model, error));
    }
    for (size_t i = 0; i < scene->world.balls.count && i < OF_BALLS; i++)
        RHEO__TRY(rheo__row_check(scene, &of_balls[i], error));
    return RHEO_OK;
}
