/* Opens meshes by name: built-in meshes, and files. The ending of a file name tells the format. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "scenes/mesh_reader.h"

static const char bunny[] = {
#include "scenes/data/bunny.obj.inc"
};

/* Whether a name has this ending, in upper or lower case. */
static bool ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), tail = strlen(ending);
    if (length <= tail)
        return false;
    for (size_t i = 0; i < tail; i++) {
        char c = name[length - tail + i];
        if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != ending[i])
            return false;
    }
    return true;
}

rheo_result rheo__mesh_read(rheo__mesh *mesh, const rheo_allocator *allocator, const char *bytes, size_t size,
                            const char *name, rheo_error *error)
{
    bool obj = ends_with(name, ".obj");
    if (!obj && !ends_with(name, ".ply"))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "there is no mesh \"%.200s\"; a mesh is \"bunny\" or a file that ends in .obj or .ply",
                          name);
    if (size > RHEO__MAX_MESH_BYTES)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%.200s: the file has more than %zu MiB", name,
                          RHEO__MAX_MESH_BYTES >> 20);
    rheo__mesh_init(mesh, allocator, obj ? 1 : 0);
    rheo__mesh_reader r = {mesh, bytes, bytes, bytes + size, name, 1, error};
    rheo_result result = obj ? rheo__mesh_read_obj(&r) : rheo__mesh_read_ply(&r);
    if (result == RHEO_OK)
        result = rheo__mesh_check(mesh, name, error);
    if (result != RHEO_OK)
        rheo__mesh_release(mesh);
    return result;
}

rheo_result rheo__mesh_open(rheo__mesh *mesh, const rheo_allocator *allocator, const char *name, rheo_error *error)
{
    if (strcmp(name, "bunny") == 0)
        return rheo__mesh_read(mesh, allocator, bunny, sizeof bunny, "bunny.obj", error);
    if (!ends_with(name, ".obj") && !ends_with(name, ".ply"))
        return rheo__mesh_read(mesh, allocator, "", 0, name, error); /* the message lists the valid names */
    rheo_allocator from = rheo__allocator_or_default(*allocator);
    FILE *file = fopen(name, "rb");
    if (!file)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "cannot read the mesh %.200s: %s", name, strerror(errno));
    void *bytes = NULL;
    size_t size = 0, room = 0, got = 1;
    bool enough = true;
    while (enough && got > 0 && size <= RHEO__MAX_MESH_BYTES) {
        enough = size < room || rheo__grow(&from, &bytes, &room, size < 65536 ? 65536 : 2 * size, size, 1);
        if (enough)
            size += got = fread((char *)bytes + size, 1, room - size, file);
    }
    bool failed = ferror(file) != 0;
    fclose(file);
    rheo_result result;
    if (!enough)
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to read %.200s", name);
    else if (failed)
        result = rheo__fail(error, RHEO_ERROR_FILE, "cannot read %.200s to its end", name);
    else
        result = rheo__mesh_read(mesh, allocator, bytes, size, name, error);
    rheo__release(&from, bytes);
    return result;
}
