/* OBJ (Wavefront): lines "v x y z" and "f a b c ..."; other lines are skipped. Polygons are cut into fans. */
#include "core/strict.h"
#include "scenes/mesh_reader.h"

static rheo_result read_vertex(rheo__mesh_reader *r)
{
    double position[3];
    char text[RHEO__TOKEN];
    for (int axis = 0; axis < 3; axis++) {
        rheo__token t = rheo__mesh_word(r);
        if (!rheo__token_number(&t, &position[axis]) || !rheo__is_coordinate(position[axis]))
            return rheo__mesh_wrong(r, "\"%s\" is no finite coordinate; a vertex is \"v x y z\"",
                                    rheo__token_shown(&t, text));
    }
    return rheo__mesh_add_vertex(r->mesh, position) ? RHEO_OK : rheo__mesh_no_memory(r);
}

/* Reads an integer at *at and moves *at past it. False: no digit, or more than ten digits. */
static bool read_index(const char **at, const char *end, int64_t *index)
{
    bool negative = *at < end && **at == '-';
    const char *digits = *at += negative;
    for (*index = 0; *at < end && **at >= '0' && **at <= '9' && *at - digits < 11; ++*at)
        *index = 10 * *index + (**at - '0');
    size_t count = (size_t)(*at - digits);
    *index = negative ? -*index : *index;
    return count > 0 && count <= 10;
}

/* Reads a, a/b, a//c or a/b/c (vertex, texture, normal). Only the vertex is used. */
static bool read_corner(const rheo__token *t, int64_t *vertex)
{
    const char *at = t->text, *end = at + t->length;
    int64_t other;
    if (!read_index(&at, end, vertex))
        return false;
    if (at < end && *at++ != '/')
        return false;
    if (at < end && *at != '/' && !read_index(&at, end, &other))
        return false;
    if (at < end && *at++ != '/')
        return false;
    if (at < end && !read_index(&at, end, &other))
        return false;
    return at == end && end[-1] != '/';
}

static rheo_result read_face(rheo__mesh_reader *r)
{
    rheo__fan f = {0, 0, 0};
    char text[RHEO__TOKEN];
    for (rheo__token t; (t = rheo__mesh_word(r)).length > 0;) {
        int64_t vertex, count = (int64_t)r->mesh->vertices;
        if (!read_corner(&t, &vertex))
            return rheo__mesh_wrong(r, "\"%s\" is no corner of a face; one is a, a/b, a/b/c or a//c",
                                    rheo__token_shown(&t, text));
        if (vertex == 0 || vertex > count || vertex < -count)
            return rheo__mesh_wrong(r, "a face has the vertex %lld; so far there are %lld, counted from 1",
                                    (long long)vertex, (long long)count);
        if (!rheo__fan_add(&f, r->mesh, (uint32_t)(vertex > 0 ? vertex - 1 : count + vertex)))
            return rheo__mesh_no_memory(r);
    }
    return f.corners < 3 ? rheo__mesh_wrong(r, "a face has %zu corners; it needs three or more", f.corners) : RHEO_OK;
}

rheo_result rheo__mesh_read_obj(rheo__mesh_reader *r)
{
    while (r->at < r->end) {
        rheo__token t = rheo__mesh_word(r);
        if (rheo__token_is(&t, "v"))
            RHEO__TRY(read_vertex(r));
        else if (rheo__token_is(&t, "f"))
            RHEO__TRY(read_face(r));
        rheo__mesh_skip_line(r);
    }
    return RHEO_OK;
}
