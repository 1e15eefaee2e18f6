/* Places the camera of a picture, and its floors. */
#include "view/camera.h"
#include "view/vectors.h"
#include "world/model.h"

rheo__camera rheo__camera_for(const rheo_extent *extent, double slope_aside, double slope_up)
{
    rheo__camera c = {.forward = {-.42, -.5, -1}, .up = {0, 1, 0}};
    double half[3], distance = 0;
    for (int a = 0; a < 3; a++) {
        c.centre[a] = .5 * extent->min[a] + .5 * extent->max[a];
        half[a] = .5 * extent->max[a] - .5 * extent->min[a];
    }
    c.size = rheo__view_length(half);
    c.size = c.size > 0 ? c.size : 1;
    rheo__view_normalise(c.forward);
    rheo__view_cross(c.forward, c.up, c.aside);
    rheo__view_normalise(c.aside);
    rheo__view_cross(c.aside, c.forward, c.up);
    for (int k = 0; k < 8; k++) {
        const double corner[3] = {k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]};
        const double x = rheo__view_dot(corner, c.aside) / slope_aside, y = rheo__view_dot(corner, c.up) / slope_up;
        const double wide = x < 0 ? -x : x, high = y < 0 ? -y : y;
        const double needed = (wide > high ? wide : high) - rheo__view_dot(corner, c.forward);
        distance = needed > distance ? needed : distance;
    }
    distance = 1.06 * (distance > c.size ? distance : c.size);
    for (int a = 0; a < 3; a++)
        c.eye[a] = c.centre[a] - distance * c.forward[a];
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
