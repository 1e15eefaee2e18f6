/* The obstacles of a scene: reads their meshes, and examines the fluid and the steps at them. */
#include "scenes/obstacles.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "core/text.h"

/* ---- Meshes ---- */

static rheo_result open_mesh(rheo__scene_obstacles *o, rheo_world_def *def, uint32_t k, rheo_error *error)
{
    rheo_obstacle *obstacle = &def->obstacles.list[k];
    rheo_error why;
    if (obstacle->shape != RHEO_OBSTACLE_MESH || obstacle->mesh.triangle_count)
        return RHEO_OK;
    if (!obstacle->file[0])
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "obstacle %u: no mesh is named; it is \"bunny\" or an .obj or .ply file", k);
    rheo__mesh *mesh = &o->mesh[k];
    const rheo_result result = rheo__mesh_open(mesh, &o->allocator, obstacle->file, &why);
    if (result != RHEO_OK)
        return rheo__fail(error, result, "obstacle %u: %.480s", k, why.message);
    if (mesh->vertices > RHEO_MAX_OBSTACLE_VERTICES || mesh->triangles > RHEO_MAX_OBSTACLE_TRIANGLES)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "obstacle %u: %.200s has %zu vertices and %zu triangles; at most %d and %d are possible", k,
                          obstacle->file, mesh->vertices, mesh->triangles, RHEO_MAX_OBSTACLE_VERTICES,
                          RHEO_MAX_OBSTACLE_TRIANGLES);
    obstacle->mesh.vertex = (const double(*)[3])(void *)mesh->vertex;
    obstacle->mesh.triangle = (const uint32_t(*)[3])(void *)mesh->triangle;
    obstacle->mesh.vertex_count = (uint32_t)mesh->vertices;
    obstacle->mesh.triangle_count = (uint32_t)mesh->triangles;
    return RHEO_OK;
}

rheo_result rheo__scene_obstacles_open(rheo__scene_obstacles *o, const rheo_allocator *allocator, rheo_world_def *def,
                                       rheo_error *error)
{
    memset(o, 0, sizeof *o);
    o->allocator = rheo__allocator_or_default(*allocator);
    for (uint32_t k = 0; k < def->obstacles.count; k++) {
        rheo_error why;
        RHEO__TRY(open_mesh(o, def, k, error));
        const rheo_result result = rheo__rigid_make(&o->solid[k], &def->obstacles.list[k], &o->allocator, &why);
        if (result != RHEO_OK)
            return rheo__fail(error, result, "the mesh of obstacle %u %.480s", k, why.message);
    }
    return RHEO_OK;
}

void rheo__scene_obstacles_close(rheo__scene_obstacles *o)
{
    for (uint32_t k = 0; k < RHEO_MAX_OBSTACLES && o->allocator.release; k++) {
        rheo__rigid_release(&o->solid[k], &o->allocator);
        rheo__mesh_release(&o->mesh[k]);
    }
}

double rheo__scene_obstacles_speed(const rheo__scene_obstacles *o, const rheo_world_def *def)
{
    double fastest = 0;
    for (uint32_t k = 0; k < def->obstacles.count; k++) {
        const double speed = rheo__obstacle_speed(&def->obstacles.list[k], o->solid[k].reach);
        fastest = speed > fastest ? speed : fastest;
    }
    return fastest;
}

/* ---- Fluid in an obstacle ---- */

/* Depth of a particle in an obstacle; jitter and rounding do not count. */
static double depth_in(const rheo__scene_obstacles *o, const rheo__filling *filling, const rheo_world_def *def,
                       uint32_t k, uint32_t shape, size_t id)
{
    double q[4], local[3], normal[3], centre[3], x[3], size = 0;
    const rheo__rigid *solid = &o->solid[k];
    rheo__rigid_rotation(&def->obstacles.list[k], q);
    const rheo__matrix matrix = rheo__rotation_matrix(q);
    for (size_t axis = 0; axis < 3; axis++) {
        centre[axis] = def->obstacles.list[k].position[axis] + solid->centre[axis];
        x[axis] = (double)def->particles.position[3 * id + axis];
        size += fabs(x[axis]);
    }
    rheo__into_frame(&matrix, centre, x, local);
    const double jitter = sqrt(3) * filling->scene->fill[shape].jitter * filling->spacing,
                 rounding = 1e-6 * (size + filling->spacing),
                 depth = -rheo__rigid_distance(solid, local, filling->spacing, normal);
    return depth > jitter + rounding ? depth : 0;
}

static void check_fluid(const rheo__scene_obstacles *o, const rheo__filling *filling, const rheo_world_def *def,
                        uint32_t k, rheo__warnings *warnings)
{
    const uint32_t shapes = filling->scene->fill_count;
    const bool inside = o->solid[k].inside;
    uint64_t all = 0, in[RHEO_MAX_FILLS] = {0};
    double deepest[RHEO_MAX_FILLS] = {0}, most = 0;
    size_t id = 0;
    for (uint32_t s = 0; s < shapes; s++)
        for (; id < (size_t)filling->end[s]; id++) {
            const double depth = depth_in(o, filling, def, k, s, id);
            in[s] += depth > 0;
            deepest[s] = depth > deepest[s] ? depth : deepest[s];
            all += depth > 0;
            most = depth > most ? depth : most;
        }
    char number[32];
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_IN_OBSTACLE);
    warning.obstacle = (int32_t)k;
    warning.limit = 0;
    if (all > 0 && all == def->particles.count) {
        warning.refused = true;
        warning.count = all;
        warning.value = most;
        rheo__warn(warnings, warning,
                   "all %llu particle%s %s obstacle %u: set its \"inside\" to %s, or move it or the shapes",
                   (unsigned long long)all, all == 1 ? " is" : "s are", inside ? "outside of" : "in", k,
                   inside ? "false" : "true");
        return;
    }
    for (uint32_t s = 0; s < shapes; s++) {
        if (!in[s])
            continue;
        warning.shape = (int32_t)s;
        warning.count = in[s];
        warning.value = deepest[s];
        rheo__warn(
            warnings, warning,
            "%llu of the %zu particles of shape %u %s %s obstacle %u, up to %s deep, and will be put outside at once; move "
            "the shape or the obstacle",
            (unsigned long long)in[s], (size_t)(filling->end[s] - (s ? filling->end[s - 1] : 0)), s,
            in[s] == 1 ? "is" : "are", inside ? "beyond" : "in", k, rheo__text_brief(deepest[s], 3, false, number));
    }
}

/* ---- Speed ---- */

static void check_speed(const rheo__scene_obstacles *o, const rheo_world_def *def, uint32_t k,
                        rheo__warnings *warnings)
{
    const rheo__measures *measures = rheo__measures_of(def);
    const uint32_t row = rheo__measure_index(measures, "speed_jump");
    const double speed = rheo__obstacle_speed(&def->obstacles.list[k], o->solid[k].reach),
                 support = rheo__def_support(def), way = speed * def->step / support;
    if (row == measures->count || !(way > measures->row[row].limit))
        return;
    const double limit = measures->row[row].limit;
    char step[32], moved[32];
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_SPEED);
    warning.obstacle = (int32_t)k;
    warning.value = way;
    warning.limit = limit;
    rheo__warn(
        warnings, warning,
        "the surface of obstacle %u moves by up to %s supports in a step, more than %g: no impact at this speed is "
        "resolved; what helps: step=%s, or a slower motion",
        k, rheo__text_brief(way, 3, false, moved), limit,
        rheo__text_brief(0.5 * limit * support / speed, 2, true, step));
}

void rheo__check_obstacles(const rheo__scene_obstacles *o, const rheo__filling *filling, const rheo_world_def *def,
                           rheo__warnings *warnings)
{
    for (uint32_t k = 0; k < def->obstacles.count; k++) {
        check_fluid(o, filling, def, k, warnings);
        check_speed(o, def, k, warnings);
    }
}
