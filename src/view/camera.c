/* Places the camera of a picture, and its floors. */
#include "view/camera.h"
#include "view/vectors.h"
#include "world/model.h"

/* How much farther the eye is in a parallel projection. Depths are floats, so that it must not be too far. */
#define FAR 64.

rheo_camera rheo_default_camera(void)
{
    return (rheo_camera){.direction = {-.42, -.5, -1}, .zoom = 1};
}

static bool is_within(const double v[3], double limit)
{
    return v[0] >= -limit && v[0] <= limit && v[1] >= -limit && v[1] <= limit && v[2] >= -limit && v[2] <= limit;
}

rheo_result rheo__camera_check(const rheo_camera *how, rheo_error *error)
{
    const double *d = how->direction;
    if (!is_within(d, 1e30) || !(rheo__view_dot(d, d) >= 1e-30))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the direction of a camera needs a length between 1e-15 and 1e30");
    if (how->target && !is_within(how->target, 1e30))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the target of a camera must be within 1e30");
    if (!(how->zoom >= .01 && how->zoom <= 1000))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the zoom of a camera must be 0.01..1000, but is %g",
                          how->zoom);
    return RHEO_OK;
}

/* The default direction gets exactly 1 and 0. */
static void set_turn(double turn[2], const double direction[3])
{
    const rheo_camera usual = rheo_default_camera();
    const double x = usual.direction[0], z = usual.direction[2], along = x * direction[0] + z * direction[2],
                 across = x * direction[2] - z * direction[0];
    const double length = __builtin_sqrt(along * along + across * across);
    turn[0] = across == 0 && along > 0 ? 1 : along / length;
    turn[1] = across == 0 && along > 0 ? 0 : across / length;
}

/* The directions of the picture: y points up in it. If it looks straight down or up, x points to the right. */
static void set_directions(rheo__camera *c, const double direction[3])
{
    double largest = 0, sky[3] = {0, 1, 0};
    for (int a = 0; a < 3; a++) {
        const double size = direction[a] < 0 ? -direction[a] : direction[a];
        largest = size > largest ? size : largest;
    }
    for (int a = 0; a < 3; a++)
        c->forward[a] = direction[a] / largest;
    rheo__view_normalise(c->forward);
    const double across = c->forward[0] * c->forward[0] + c->forward[2] * c->forward[2];
    if (across < 1e-12) {
        sky[1] = 0;
        sky[2] = c->forward[1] < 0 ? -1 : 1;
    }
    set_turn(c->turn, across < 1e-12 ? (const double[3]){0, 0, -1} : direction);
    rheo__view_cross(c->forward, sky, c->aside);
    rheo__view_normalise(c->aside);
    rheo__view_cross(c->aside, c->forward, c->up);
}

rheo__camera rheo__camera_for(const rheo_extent *extent, const rheo_camera *how, double slope_aside, double slope_up)
{
    const rheo_camera usual = rheo_default_camera();
    how = how ? how : &usual;
    rheo__camera c = {.lens = how->parallel ? 1 / FAR : 1};
    double half[3], off[3], distance = 0;
    for (int a = 0; a < 3; a++) {
        c.centre[a] = .5 * extent->min[a] + .5 * extent->max[a];
        half[a] = .5 * extent->max[a] - .5 * extent->min[a];
        off[a] = how->target ? how->target[a] - c.centre[a] : 0;
    }
    c.size = rheo__view_length(half);
    c.size = c.size > 0 ? c.size : 1;
    set_directions(&c, how->direction);
    for (int k = 0; k < 8; k++) {
        const double corner[3] = {(k & 1 ? half[0] : -half[0]) - off[0], (k & 2 ? half[1] : -half[1]) - off[1],
                                  (k & 4 ? half[2] : -half[2]) - off[2]};
        const double x = rheo__view_dot(corner, c.aside) / (c.lens * slope_aside),
                     y = rheo__view_dot(corner, c.up) / (c.lens * slope_up);
        const double wide = x < 0 ? -x : x, high = y < 0 ? -y : y;
        const double needed = (wide > high ? wide : high) - rheo__view_dot(corner, c.forward);
        distance = needed > distance ? needed : distance;
    }
    distance = 1.06 * (distance > c.size ? distance : c.size);
    for (int a = 0; a < 3; a++)
        c.eye[a] = c.centre[a] + off[a] - distance * c.forward[a];
    c.lens /= how->zoom;
    return c;
}

bool rheo__is_floor(const rheo_world_def *def, uint32_t wall, double normal[3], double *offset)
{
    const rheo__model_type *type = rheo__model(def->model);
    /* Particles that touch a wall have their surface beyond the wall, so floors are drawn lower. */
    const double below = type->wall_distance ? .8 * type->wall_distance(def) : 0;
    for (int a = 0; a < 3; a++)
        normal[a] = def->walls.plane[wall].normal[a];
    rheo__view_normalise(normal);
    *offset = rheo__view_dot(normal, def->walls.plane[wall].point) - below;
    return normal[1] > .5;
}
