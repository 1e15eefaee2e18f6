/*
 * The obstacles of a definition: their parameters, which have rows for each number that an obstacle may have, as materials
 * do, their checks, their state, and queries.
 */
#include <stdio.h>
#include <string.h>

#include "core/math.h"
#include "solids/solids.h"
#include "world/row_macros.h"
#include "world/world.h"

/* ---- Rows ---- */

enum {
    SPHERE = 1 << RHEO_OBSTACLE_SPHERE,
    BOX = 1 << RHEO_OBSTACLE_BOX,
    CYLINDER = 1 << RHEO_OBSTACLE_CYLINDER,
    MESH = 1 << RHEO_OBSTACLE_MESH,
    ALL = SPHERE | BOX | CYLINDER | MESH
};

/*
 * X(kind, number of the obstacle, member of rheo_obstacle, C type, shapes that have it, unit, range or words, default, LIVE
 * or FIXED, meaning). The shape is first: others depend on it.
 */
#define PARAMETERS(X, number)                                                                                      \
    X(CHOICE, number, shape, uint32_t, ALL, "",                                                                    \
      WORDS([RHEO_OBSTACLE_SPHERE] = "sphere", [RHEO_OBSTACLE_BOX] = "box", [RHEO_OBSTACLE_CYLINDER] = "cylinder", \
            [RHEO_OBSTACLE_MESH] = "mesh"),                                                                        \
      XYZ(0, 0, 0), FIXED, "shape of the obstacle")                                                                \
    X(VECTOR, number, position, double *, ALL, "L", ANY, XYZ(0, 0, 0), LIVE,                                       \
      "centre at step 0; of a mesh: middle of the underside of its bounding box")                                  \
    X(REAL, number, radius, double, SPHERE | CYLINDER, "L", RANGE(0, 1e12), XYZ(1, 0, 0), FIXED, "radius")         \
    X(VECTOR, number, size, double *, BOX, "L", RANGE(0, 1e12), XYZ(1, 1, 1), FIXED, "lengths of its edges")       \
    X(VECTOR, number, axis, double *, CYLINDER, "1", ANY, XYZ(0, 1, 0), FIXED, "direction of its axis")            \
    X(REAL, number, length, double, CYLINDER, "L", RANGE(0, 1e12), XYZ(1, 0, 0), FIXED, "length along its axis")   \
    X(REAL, number, height, double, MESH, "L", RANGE(0, 1e12), XYZ(0, 0, 0), FIXED,                                \
      "height (y) to scale the mesh to; 0: as in the file")                                                        \
    X(VECTOR, number, rotation, double *, ALL, "degree", ANY, XYZ(0, 0, 0), LIVE,                                  \
      "rotation about the centre at step 0: along its axis, as long as its angle")                                 \
    X(CHOICE, number, inside, uint32_t, ALL, "",                                                                   \
      WORDS([RHEO_OBSTACLE_OUTSIDE] = "false", [RHEO_OBSTACLE_INSIDE] = "true"), XYZ(0, 0, 0), FIXED,              \
      "whether the fluid is inside, as in a drum")                                                                 \
    X(VECTOR, number, velocity, double *, ALL, "L/T", ANY, XYZ(0, 0, 0), LIVE, "velocity of the centre")           \
    X(VECTOR, number, spin, double *, ALL, "1/T", ANY, XYZ(0, 0, 0), LIVE, "angular velocity")                     \
    X(VECTOR, number, amplitude, double *, ALL, "L", ANY, XYZ(0, 0, 0), LIVE,                                      \
      "amplitude of an oscillation, which begins in the middle")                                                   \
    X(REAL, number, frequency, double, ALL, "1/T", RANGE(0, 1e12), XYZ(0, 0, 0), LIVE, "frequency of the oscillation")

#undef HEAD
#define HEAD(name, kind, unit_, is_live, meaning)                                                  \
    .path = name, .type = RHEO_PARAMETER_##kind, .unit = unit_, .live = is_live, .about = meaning, \
    .models = UINT32_C(1) << RHEO_MODEL_THICKENING
#define ROW(kind, number, member, c_type, shapes, unit, range, initial, live, meaning) \
    {{HEAD("obstacles." #number "." #member, kind, unit, live, meaning), range},       \
     _Generic(((rheo_obstacle *)0)->member, c_type                                     \
              : offsetof(rheo_obstacle, member)) +                                     \
         offsetof(rheo_world_def, obstacles.list) + (number) * sizeof(rheo_obstacle),  \
     0,                                                                                \
     {initial}},
#define SHAPES(kind, number, member, c_type, shapes, ...) shapes,

static const rheo__parameter_row rows[] = {
    PARAMETERS(ROW, 0) PARAMETERS(ROW, 1) PARAMETERS(ROW, 2) PARAMETERS(ROW, 3) PARAMETERS(ROW, 4) PARAMETERS(ROW, 5)
        PARAMETERS(ROW, 6) PARAMETERS(ROW, 7) PARAMETERS(ROW, 8) PARAMETERS(ROW, 9) PARAMETERS(ROW, 10)
            PARAMETERS(ROW, 11) PARAMETERS(ROW, 12) PARAMETERS(ROW, 13) PARAMETERS(ROW, 14) PARAMETERS(ROW, 15)};
static const unsigned shapes_of[] = {PARAMETERS(SHAPES, 0)};

enum { ROWS_OF_ONE = sizeof shapes_of / sizeof *shapes_of };
_Static_assert(sizeof rows / sizeof *rows == RHEO_MAX_OBSTACLES * ROWS_OF_ONE, "every obstacle has its rows");

static const char GROUP[] = "obstacles.";

bool rheo__is_of_obstacle(const char *path)
{
    return strncmp(path, GROUP, strlen(GROUP)) == 0;
}

static bool has_row(rheo_obstacle_shape shape, size_t row)
{
    return shapes_of[row] >> shape & 1;
}

const rheo_parameter *rheo_obstacle_parameter_at(size_t index)
{
    return index < ROWS_OF_ONE ? &rows[index].parameter : NULL;
}

bool rheo_obstacle_has_parameter(rheo_obstacle_shape shape, const rheo_parameter *parameter)
{
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (&rows[i].parameter == parameter)
            return has_row(shape, i % ROWS_OF_ONE);
    return false;
}

const rheo__parameter_row *rheo__obstacle_row(const rheo_parameter *parameter)
{
    return rheo__is_of_obstacle(parameter->path) ? (const rheo__parameter_row *)(const void *)parameter : NULL;
}

size_t rheo__obstacle_parameter_count(const rheo_world_def *def)
{
    size_t count = 0;
    for (uint32_t k = 0; k < def->obstacles.count; k++)
        for (size_t i = 0; i < ROWS_OF_ONE; i++)
            count += has_row(def->obstacles.list[k].shape, i);
    return count;
}

const rheo_parameter *rheo__obstacle_parameter(const rheo_world_def *def, size_t index)
{
    for (uint32_t k = 0; k < def->obstacles.count; k++)
        for (size_t i = 0; i < ROWS_OF_ONE; i++)
            if (has_row(def->obstacles.list[k].shape, i) && index-- == 0)
                return &rows[k * ROWS_OF_ONE + i].parameter;
    return NULL;
}

/* The number in a path, and what is after it; -1: there is none. */
static int number_in(const char *path, const char **member)
{
    const char *at = path + strlen(GROUP);
    int number = 0, digits = 0;
    for (; *at >= '0' && *at <= '9' && digits < 4; at++, digits++)
        number = 10 * number + (*at - '0');
    *member = *at == '.' ? at + 1 : at;
    return digits && *at == '.' && (digits == 1 || path[strlen(GROUP)] != '0') ? number : -1;
}

int rheo__obstacle_number(const char *path)
{
    const char *member;
    return rheo__is_of_obstacle(path) ? number_in(path, &member) : -1;
}

const rheo_parameter *rheo__obstacle_parameter_find(const rheo_world_def *def, const char *path)
{
    const int number = rheo__obstacle_number(path);
    for (size_t i = 0; number >= 0 && (uint32_t)number < def->obstacles.count && i < ROWS_OF_ONE; i++) {
        const rheo_parameter *p = &rows[(size_t)number * ROWS_OF_ONE + i].parameter;
        if (has_row(def->obstacles.list[number].shape, i) && strcmp(p->path, path) == 0)
            return p;
    }
    return NULL;
}

rheo_result rheo__obstacle_unknown(const rheo_world_def *def, const char *path, rheo_error *error)
{
    const char *member;
    const int number = number_in(path, &member);
    if (number < 0 || (uint32_t)number >= def->obstacles.count)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%.64s: there is no such obstacle; %u are given, and the first is obstacles.0", path,
                          def->obstacles.count);
    const rheo_obstacle_shape shape = def->obstacles.list[number].shape;
    char known[256] = "";
    for (size_t i = 0; i < ROWS_OF_ONE; i++)
        if (has_row(shape, i))
            snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", *known ? ", " : "",
                     rows[i].parameter.path + strlen("obstacles.0."));
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.64s: an obstacle of shape %s has no such parameter; it has: %s",
                      path, rows[0].parameter.choices[shape], known);
}

/* ---- Definitions ---- */

rheo_obstacle rheo_default_obstacle(rheo_obstacle_shape shape)
{
    return (rheo_obstacle){.shape = shape, .radius = 1, .size = {1, 1, 1}, .axis = {0, 1, 0}, .length = 1};
}

rheo_result rheo_world_def_add_obstacle(rheo_world_def *def, const rheo_obstacle *obstacle, rheo_error *error)
{
    if (def->obstacles.count >= RHEO_MAX_OBSTACLES)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a world has at most %d obstacles", RHEO_MAX_OBSTACLES);
    def->obstacles.list[def->obstacles.count++] = *obstacle;
    return RHEO_OK;
}

/* Half of the least thickness of a shape; of a mesh unknown. */
static double thinnest(const rheo_obstacle *o)
{
    const double *size = o->size, half = o->length / 2;
    double least = size[0] < size[1] ? size[0] : size[1];
    least = least < size[2] ? least : size[2];
    return o->shape == RHEO_OBSTACLE_SPHERE     ? o->radius
           : o->shape == RHEO_OBSTACLE_CYLINDER ? (o->radius < half ? o->radius : half)
           : o->shape == RHEO_OBSTACLE_BOX      ? least / 2
                                                : __builtin_inf();
}

static rheo_result check_obstacle(const rheo_world_def *def, uint32_t k, rheo_error *error)
{
    const rheo_obstacle *o = &def->obstacles.list[k];
    if ((unsigned)o->shape > RHEO_OBSTACLE_MESH)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "obstacles.%u.shape is %u; there is no such shape", k,
                          (unsigned)o->shape);
    for (size_t i = 0; i < ROWS_OF_ONE; i++)
        if (has_row(o->shape, i))
            RHEO__TRY(rheo__row_check(def, &rows[k * ROWS_OF_ONE + i], error));
    const double axis2 = o->axis[0] * o->axis[0] + o->axis[1] * o->axis[1] + o->axis[2] * o->axis[2],
                 least = thinnest(o);
    if (o->shape == RHEO_OBSTACLE_CYLINDER && !(axis2 > 1e-100 && axis2 < 1e100))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "obstacles.%u.axis is [%g, %g, %g]; it must be a vector other than zero", k, o->axis[0],
                          o->axis[1], o->axis[2]);
    if (!(least >= 5e-13))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "obstacle %u: %s must be above 0", k,
                          o->shape == RHEO_OBSTACLE_BOX        ? "each component of size"
                          : o->shape == RHEO_OBSTACLE_CYLINDER ? "radius and length"
                                                               : "its radius");
    if (o->inside && least < def->fluid.spacing)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "obstacle %u has the fluid inside, where it must leave room: half of its least thickness is %g, less "
            "than fluid.spacing, %g",
            k, least, def->fluid.spacing);
    return RHEO_OK;
}

/* All meshes together; what is wrong with one of them is found when a world makes it. */
static rheo_result check_meshes(const rheo_world_def *def, rheo_error *error)
{
    uint64_t vertices = 0, triangles = 0;
    for (uint32_t k = 0; k < def->obstacles.count; k++) {
        const rheo_obstacle *o = &def->obstacles.list[k];
        if (o->shape != RHEO_OBSTACLE_MESH)
            continue;
        vertices += o->mesh.vertex_count;
        triangles += o->mesh.triangle_count;
    }
    if (vertices > RHEO_MAX_OBSTACLE_VERTICES || triangles > RHEO_MAX_OBSTACLE_TRIANGLES)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "the meshes of obstacles have %llu vertices and %llu triangles; at most %d and %d are possible",
            (unsigned long long)vertices, (unsigned long long)triangles, RHEO_MAX_OBSTACLE_VERTICES,
            RHEO_MAX_OBSTACLE_TRIANGLES);
    return RHEO_OK;
}

rheo_result rheo__obstacles_check(const rheo_world_def *def, rheo_error *error)
{
    if (def->obstacles.count > RHEO_MAX_OBSTACLES)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u obstacles; at most %d are possible",
                          def->obstacles.count, RHEO_MAX_OBSTACLES);
    for (uint32_t k = 0; k < def->obstacles.count; k++)
        RHEO__TRY(check_obstacle(def, k, error));
    return check_meshes(def, error);
}

/* ---- State ---- */

void rheo__obstacle_put(rheo_world *w, uint32_t index)
{
    for (size_t axis = 0; axis < 3; axis++)
        w->state.obstacle_position[3 * (size_t)index + axis] =
            w->def.obstacles.list[index].position[axis] + w->solids->obstacle[index].centre[axis];
}

void rheo__obstacle_turn(rheo_world *w, uint32_t index)
{
    rheo__rigid_rotation(&w->def.obstacles.list[index], w->state.obstacle_rotation + 4 * (size_t)index);
}

/* ---- Queries ---- */

uint32_t rheo_world_obstacle_count(const rheo_world *w)
{
    return w->state.obstacles;
}

rheo_result rheo_world_obstacle(const rheo_world *w, uint32_t index, rheo_obstacle_state *state)
{
    if (index >= w->state.obstacles)
        return RHEO_ERROR_ARGUMENT;
    const rheo_obstacle *o = &w->def.obstacles.list[index];
    const double phase = w->state.obstacle_phase[index],
                 rate = 6.283185307179586 * o->frequency * rheo__cos_turns(phase);
    *state = (rheo_obstacle_state){.shape = o->shape, .inside = o->inside == RHEO_OBSTACLE_INSIDE, .phase = phase};
    for (size_t axis = 0; axis < 3; axis++) {
        state->position[axis] = w->state.obstacle_position[3 * (size_t)index + axis];
        state->velocity[axis] = o->velocity[axis] + o->amplitude[axis] * rate;
        state->spin[axis] = o->spin[axis];
    }
    memcpy(state->rotation, w->state.obstacle_rotation + 4 * (size_t)index, sizeof state->rotation);
    return RHEO_OK;
}

double rheo_world_obstacle_distance(const rheo_world *w, uint32_t index, const double point[3], double normal[3])
{
    double local[3], n[3];
    if (index >= w->state.obstacles)
        return __builtin_nan("");
    const rheo__matrix matrix = rheo__rotation_matrix(w->state.obstacle_rotation + 4 * (size_t)index);
    rheo__into_frame(&matrix, w->state.obstacle_position + 3 * (size_t)index, point, local);
    const double distance = rheo__rigid_distance(&w->solids->obstacle[index], local, __builtin_inf(), n);
    if (normal)
        rheo__out_of_frame(&matrix, n, normal);
    return distance;
}
