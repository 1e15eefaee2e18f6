/* The inside of a closed triangle mesh, scaled to a height and placed by its underside. mesh.c finds the points. */
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "scenes/mesh.h"
#include "scenes/shape.h"

static const rheo_shape_member members[] = {
    RHEO__MEMBER("file", name, RHEO_SHAPE_FILE, "", "\"bunny\", which is built in, or an .obj or .ply file",
                 .required = true),
    RHEO__MEMBER("height", height, RHEO_SHAPE_NUMBER, "L", "height (y) to scale the mesh to; 0: as in the file",
                 .maximum = 1e30),
    RHEO__MEMBER("position", position, RHEO_SHAPE_VECTOR, "L", "middle of the underside of its bounding box",
                 RHEO__FINITE),
    RHEO__COMMON_MEMBERS,
};

static rheo_result check(const rheo_fill *fill, rheo_error *error)
{
    return fill->name[0]
               ? RHEO_OK
               : rheo__fail(error, RHEO_ERROR_ARGUMENT, "no mesh is named; it is \"bunny\" or an .obj or .ply file");
}

static rheo_result open(const rheo_fill *fill, const rheo_allocator *allocator, void **data, rheo_error *error)
{
    rheo__mesh *mesh = rheo__allocate(allocator, 1, sizeof *mesh);
    if (!mesh)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a mesh");
    const rheo_result result = rheo__mesh_open(mesh, allocator, fill->name, error);
    if (result == RHEO_OK)
        *data = mesh;
    else
        rheo__release(allocator, mesh);
    return result;
}

static void close(const rheo_allocator *allocator, void *data)
{
    rheo__mesh_release(data);
    rheo__release(allocator, data);
}

static void measure(const rheo_fill *fill, const void *data, double size[3])
{
    const rheo__mesh *mesh = data;
    for (int axis = 0; axis < 3; axis++) {
        size[axis] = mesh->high[axis] - mesh->low[axis];
        if (fill->height > 0)
            size[axis] *= fill->height / (mesh->high[1] - mesh->low[1]);
    }
}

static rheo_result run_rows(const rheo__solid *solid, const rheo__lattice *l, rheo__run *run, void *user,
                            rheo_error *error)
{
    const rheo__mesh *mesh = solid->data;
    const double height = solid->fill->height;
    rheo__mesh_frame frame = {.scale = 1 / solid->spacing};
    if (height > 0)
        frame.scale = height / (mesh->high[1] - mesh->low[1]) / solid->spacing;
    for (int axis = 0; axis < 3; axis++) {
        frame.base[axis] = axis == 1 ? mesh->low[1] : mesh->low[axis] + (mesh->high[axis] - mesh->low[axis]) / 2;
        frame.shift[axis] = axis == 1 ? -0.5 : 0.5 * (double)l->high[axis];
    }
    return rheo__mesh_scan(mesh, &frame, run, user, error);
}

const rheo__shape rheo__shape_mesh = {
    .row = RHEO__ROW("mesh", "the inside of a closed triangle mesh", members),
    .max_points = 65536, /* rows are counted one by one */
    .check = check,
    .open = open,
    .close = close,
    .measure = measure,
    .lattice = rheo__lattice_on_underside,
    .run = run_rows,
};
