/*
 * Fuzz target of mesh files: PLY if the bytes begin with "ply", otherwise OBJ. Properties of an accepted mesh: it is
 * closed, so every lattice row leaves it as often as it enters; points are inside its bounds; its volume is >= 0.
 */
#include <string.h>

#include "fuzz_support.h"
#include "scenes/mesh.h"

enum { MOST_BYTES = 64 * 1024, POINTS = 20 };

static bool within(void *user, int64_t x, int64_t end, int64_t y, int64_t z)
{
    int64_t *last = user;
    HOLDS(x < end && x >= 0 && end <= POINTS && y >= 0 && y < POINTS && z >= 0 && z < POINTS);
    HOLDS((z * POINTS + y) * POINTS + x >= *last);
    *last = (z * POINTS + y) * POINTS + end;
    return true;
}

void drive(const uint8_t *bytes, size_t size)
{
    const rheo_allocator allocator = {NULL, NULL, NULL};
    rheo__mesh mesh;
    rheo_error error = {""};
    if (size > MOST_BYTES)
        return;
    const bool ply = size >= 3 && memcmp(bytes, "ply", 3) == 0;
    if (rheo__mesh_read(&mesh, &allocator, (const char *)bytes, size, ply ? "fuzz.ply" : "fuzz.obj", &error) !=
        RHEO_OK) {
        HOLDS(strncmp(error.message, "fuzz.", 5) == 0);
        return;
    }
    HOLDS(mesh.triangles >= 4 || mesh.volume == 0);
    HOLDS(mesh.volume >= 0);
    rheo__mesh_frame frame = {.scale = 0};
    double size_of_it = 0;
    for (int axis = 0; axis < 3; axis++) {
        HOLDS(mesh.low[axis] < mesh.high[axis]);
        frame.base[axis] = mesh.low[axis];
        double extent = mesh.high[axis] - mesh.low[axis];
        size_of_it = extent > size_of_it ? extent : size_of_it;
    }
    frame.scale = (POINTS - 1) / size_of_it;
    int64_t last = 0;
    if (frame.scale < 1e200)
        HOLDS(rheo__mesh_scan(&mesh, &frame, within, &last, &error) == RHEO_OK);
    rheo__mesh_release(&mesh);
}

#ifndef RHEO__LIBFUZZER
int main(int argc, char **argv)
{
    return read_arguments(argc, argv, "meshes");
}
#endif
