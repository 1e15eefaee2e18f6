/* Sphere, box and cylinder (space/rigid_shapes.h); space/surface.c has meshes. */
#include "space/rigid_shapes.h"

#include "core/math.h"
#include "space/surface.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length_of(const double v[3])
{
    return __builtin_sqrt(dot(v, v));
}

/* ---- Making ---- */

rheo_result rheo__rigid_make(rheo__rigid *solid, const rheo_obstacle *obstacle, const rheo_allocator *allocator,
                             rheo_error *error)
{
    *solid = (rheo__rigid){.shape = obstacle->shape,
                           .inside = obstacle->inside == RHEO_OBSTACLE_INSIDE,
                           .radius = obstacle->radius,
                           .reach = obstacle->radius};
    switch (obstacle->shape) {
    case RHEO_OBSTACLE_SPHERE:
        break;
    case RHEO_OBSTACLE_BOX:
        for (int axis = 0; axis < 3; axis++)
            solid->half[axis] = obstacle->size[axis] / 2;
        solid->reach = length_of(solid->half);
        break;
    case RHEO_OBSTACLE_CYLINDER: {
        const double length = length_of(obstacle->axis), half = obstacle->length / 2;
        for (int axis = 0; axis < 3; axis++)
            solid->axis[axis] = obstacle->axis[axis] / length;
        solid->half[1] = half;
        solid->reach = __builtin_sqrt(solid->radius * solid->radius + half * half);
        break;
    }
    case RHEO_OBSTACLE_MESH: {
        const rheo__surface_mesh mesh = {.vertex = obstacle->mesh.vertex,
                                         .triangle = obstacle->mesh.triangle,
                                         .vertices = obstacle->mesh.vertex_count,
                                         .triangles = obstacle->mesh.triangle_count,
                                         .height = obstacle->height};
        RHEO__TRY(rheo__surface_make(&mesh, allocator, &solid->surface, error));
        solid->reach = solid->surface->reach;
        solid->centre[1] = solid->surface->half_height;
        break;
    }
    }
    return RHEO_OK;
}

void rheo__rigid_release(rheo__rigid *solid, const rheo_allocator *allocator)
{
    rheo__surface_release(solid->surface, allocator);
    solid->surface = NULL;
}

void rheo__rigid_rotation(const rheo_obstacle *obstacle, double q[4])
{
    const double *r = obstacle->rotation, degrees = length_of(r), turns = degrees / 720,
                 sine = degrees > 0 ? rheo__sin_turns(turns) / degrees : 0;
    q[0] = degrees > 0 ? rheo__cos_turns(turns) : 1;
    for (int axis = 0; axis < 3; axis++)
        q[1 + axis] = sine * r[axis];
}

rheo__matrix rheo__rotation_matrix(const double q[4])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    return (rheo__matrix){{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

/* ---- Distances, positive outside ---- */

/* Sets a unit vector along v; along y where v is 0. Returns the length. */
static double direction_of(const double v[3], double n[3])
{
    const double length = length_of(v);
    for (int axis = 0; axis < 3; axis++)
        n[axis] = length > 0 ? v[axis] / length : axis == 1;
    return length;
}

/* Inside: the nearest face, of equally near ones the first. Outside: the nearest point of face, edge or corner. */
static double from_box(const rheo__rigid *s, const double x[3], double n[3])
{
    double over[3], beyond[3], sign[3];
    int nearest = 0;
    for (int axis = 0; axis < 3; axis++) {
        sign[axis] = x[axis] < 0 ? -1 : 1;
        over[axis] = sign[axis] * x[axis] - s->half[axis];
        beyond[axis] = over[axis] > 0 ? sign[axis] * over[axis] : 0;
        nearest = over[axis] > over[nearest] ? axis : nearest;
    }
    if (over[nearest] > 0)
        return direction_of(beyond, n);
    for (int axis = 0; axis < 3; axis++)
        n[axis] = axis == nearest ? sign[axis] : 0;
    return over[nearest];
}

/* A unit vector across an axis. */
static void across(const double axis[3], double n[3])
{
    int least = 0;
    for (int k = 1; k < 3; k++)
        least = axis[k] * axis[k] < axis[least] * axis[least] ? k : least;
    double v[3];
    for (int k = 0; k < 3; k++)
        v[k] = (k == least) - axis[least] * axis[k];
    direction_of(v, n);
}

static double from_cylinder(const rheo__rigid *s, const double x[3], double n[3])
{
    const double along = dot(x, s->axis), sign = along < 0 ? -1 : 1;
    double radial[3], outward[3];
    for (int axis = 0; axis < 3; axis++)
        radial[axis] = x[axis] - along * s->axis[axis];
    const double from_axis = length_of(radial);
    if (from_axis > 0)
        direction_of(radial, outward);
    else
        across(s->axis, outward);
    const double aside = from_axis - s->radius, above = sign * along - s->half[1];
    if (aside > 0 && above > 0) {
        double beyond[3];
        for (int axis = 0; axis < 3; axis++)
            beyond[axis] = aside * outward[axis] + above * sign * s->axis[axis];
        return direction_of(beyond, n);
    }
    for (int axis = 0; axis < 3; axis++)
        n[axis] = above > aside ? sign * s->axis[axis] : outward[axis];
    return above > aside ? above : aside;
}

double rheo__rigid_distance(const rheo__rigid *s, const double x[3], double within, double normal[3])
{
    double distance = 0;
    switch (s->shape) {
    case RHEO_OBSTACLE_SPHERE:
        distance = direction_of(x, normal) - s->radius;
        break;
    case RHEO_OBSTACLE_BOX:
        distance = from_box(s, x, normal);
        break;
    case RHEO_OBSTACLE_CYLINDER:
        distance = from_cylinder(s, x, normal);
        break;
    case RHEO_OBSTACLE_MESH:
        distance = rheo__surface_distance(s->surface, x, s->inside ? -within : within, s->inside, normal);
        break;
    }
    if (!s->inside)
        return distance;
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = -normal[axis];
    return -distance;
}
