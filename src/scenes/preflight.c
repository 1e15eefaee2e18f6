/* What a run of a scene is expected to be like: the part that follows from its shapes. The model knows the rest. */
#include <math.h>

#include "core/strict.h"
#include "scenes/making.h"
#include "scenes/obstacles.h"
#include "world/emitters.h"

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Height of the uppermost points of the shapes, L. */
static double top_of(const rheo__filling *filling)
{
    double top = -INFINITY, size[3];
    for (uint32_t f = 0; f < filling->scene->fill_count; f++) {
        rheo__lattice lattice;
        if (rheo__fill_size(filling, f, filling->spacing, size) &&
            rheo__fill_lattice(filling, f, filling->spacing, &lattice))
            top = larger(top, lattice.origin[1] + filling->spacing * ((double)lattice.high[1] + 0.5));
    }
    return top;
}

/* How far a ball falls until it meets the fluid, L. */
static double fall_of_ball(const rheo__filling *filling, const rheo_ball *ball, double clearance)
{
    const double below = ball->position[1] - ball->radius - top_of(filling);
    return ball->radius > 0 ? larger(clearance >= 0 ? clearance : below, 0) : 0;
}

double rheo__arrival_speed(const rheo__filling *filling, const rheo_world_def *def)
{
    const double *g = def->gravity, gravity = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    double fastest = 0;
    for (uint32_t i = 0; i <= def->balls.count; i++) {
        const rheo_ball *ball = rheo__ball_of(def, i);
        const double *v = ball->velocity, fall = fall_of_ball(filling, ball, rheo__ball_clearance(filling->scene, i));
        fastest = larger(fastest, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + 2 * gravity * fall));
    }
    return fastest;
}

static rheo__start start_of(const rheo__filling *filling, const rheo_world_def *def)
{
    const rheo_scene *scene = filling->scene;
    rheo__start start = {.has_temperatures = filling->has_temperatures, .coldest = INFINITY, .hottest = -INFINITY};
    for (uint32_t f = 0; f < scene->fill_count; f++) {
        const rheo_fill *fill = &scene->fill[f];
        const double *v = fill->velocity;
        start.speed = larger(start.speed, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
        for (int i = 0; i < 2; i++) {
            const double t = fill->has_temperature ? fill->temperature[i] : def->melting.temperature;
            start.coldest = t < start.coldest ? t : start.coldest;
            start.hottest = larger(start.hottest, t);
        }
    }
    for (uint32_t k = 0; k < def->emitters.count; k++) {
        const rheo_emitter *e = &def->emitters.list[k];
        const double t = rheo__emitter_has_temperature(e) ? e->temperature : def->melting.temperature;
        start.speed = larger(start.speed, e->speed);
        start.coldest = t < start.coldest ? t : start.coldest;
        start.hottest = larger(start.hottest, t);
        start.has_temperatures = start.has_temperatures || rheo__emitter_has_temperature(e);
    }
    start.ball_speed = rheo__arrival_speed(filling, def);
    return start;
}

rheo_result rheo_scene_preflight(const rheo_scene *scene, rheo_preflight *preflight, rheo_error *error)
{
    rheo_world_def def;
    rheo__filling filling = {0};
    const double no = NAN;
    *preflight =
        (rheo_preflight){no, no, no, no, no, no, no, no, no, no, no, no, no, no, no, no, no, no, no, NULL, no, no};
    RHEO__TRY(rheo__scene_check_parameters(scene, &def, error));
    rheo__scene_obstacles obstacles;
    rheo_result result = rheo__scene_obstacles_open(&obstacles, &scene->world.allocator, &def, error);
    if (result == RHEO_OK && def.obstacles.count) {
        preflight->obstacle_speed = rheo__scene_obstacles_speed(&obstacles, &def);
        preflight->obstacle_way = preflight->obstacle_speed * def.step / rheo__def_support(&def);
    }
    rheo__scene_obstacles_close(&obstacles);
    if (result == RHEO_OK)
        result = rheo__filling_open(&filling, scene, error);
    if (result == RHEO_OK) {
        def.fluid.spacing = filling.spacing;
        const rheo__model_type *type = rheo__model(def.model);
        const rheo__start start = start_of(&filling, &def);
        if (type->foresee)
            type->foresee(&def, &start, preflight);
    }
    rheo__filling_close(&filling);
    return result;
}
