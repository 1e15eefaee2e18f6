/*
 * Closed triangle meshes. A mesh is closed if every directed edge of a triangle has its reverse in another
 * triangle. Then every straight line leaves it as often as it enters it, and the winding number along a row of
 * lattice points tells which points are inside.
 *
 * The scan cuts the mesh with the planes z = 0, 1, ... A triangle that crosses a plane leaves a directed segment in
 * it. The ends of the segment lie on two edges of the triangle. They are computed from the lower to the higher vertex
 * number of the edge, so both triangles of an edge get the same bits.
 *
 * A vertex in the plane counts as below the plane. The end of a segment in a row of points counts as below the row.
 * So the segments in a plane form closed loops, however they are rounded, and each row is crossed equally often in
 * both directions. A row that meets an edge or a vertex exactly needs no special case. Only IEEE + - * / are used.
 */
#include "scenes/mesh.h"

#include <string.h>

#include "core/error.h"
#include "core/strict.h"

/* ---- Vertices and triangles ---- */

void rheo__mesh_init(rheo__mesh *mesh, const rheo_allocator *allocator, uint32_t first_number)
{
    memset(mesh, 0, sizeof *mesh);
    mesh->allocator = rheo__allocator_or_default(*allocator);
    mesh->first_number = first_number;
}

void rheo__mesh_release(rheo__mesh *mesh)
{
    if (!mesh->allocator.release)
        return;
    rheo__release(&mesh->allocator, mesh->vertex);
    rheo__release(&mesh->allocator, mesh->triangle);
    memset(mesh, 0, sizeof *mesh);
}

/* Makes room for one more item. */
static bool grow_by_one(const rheo_allocator *allocator, void **memory, size_t *room, size_t used, size_t size)
{
    return used < *room || rheo__grow(allocator, memory, room, used < 64 ? 64 : used + 1, used, size);
}

bool rheo__mesh_add_vertex(rheo__mesh *mesh, const double position[3])
{
    void *memory = mesh->vertex;
    bool enough = grow_by_one(&mesh->allocator, &memory, &mesh->vertex_room, mesh->vertices, 3 * sizeof(double));
    mesh->vertex = memory;
    if (enough)
        memcpy(mesh->vertex + 3 * mesh->vertices++, position, 3 * sizeof(double));
    return enough;
}

bool rheo__mesh_add_triangle(rheo__mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    if (a == b || b == c || c == a)
        return true;
    void *memory = mesh->triangle;
    bool enough = grow_by_one(&mesh->allocator, &memory, &mesh->triangle_room, mesh->triangles, 3 * sizeof(uint32_t));
    mesh->triangle = memory;
    if (enough) {
        const uint32_t corners[3] = {a, b, c};
        memcpy(mesh->triangle + 3 * mesh->triangles++, corners, sizeof corners);
    }
    return enough;
}

/* ---- Sorting: edges by end, triangles by first plane, crossings by row and x ---- */

typedef struct item {
    int64_t major, minor;
    int64_t value; /* not compared: no result depends on the order of equal items */
} item;

static bool less(const item *a, const item *b)
{
    return a->major < b->major || (a->major == b->major && a->minor < b->minor);
}

/* Heap sort (Williams 1964). It needs no memory, and it is fast for every input. */
static void sort(item *items, size_t count)
{
    for (size_t root = count / 2, end = count; end > 1;) {
        item moving;
        if (root > 0) {
            moving = items[--root];
        } else {
            moving = items[--end];
            items[end] = items[0];
        }
        size_t hole = root, child;
        while ((child = 2 * hole + 1) < end) {
            child += child + 1 < end && less(&items[child], &items[child + 1]);
            if (!less(&moving, &items[child]))
                break;
            items[hole] = items[child];
            hole = child;
        }
        items[hole] = moving;
    }
}

/* ---- Holes ---- */

/* Index of the first open edge that starts at this vertex or a later one. Open edges are sorted by start. */
static size_t first_from(const item *open, size_t count, int64_t vertex)
{
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (open[middle].major < vertex)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/*
 * Walks along open edges, from start (major) to end (minor), and marks them as used. The first edge of each start
 * vertex counts the used edges of that vertex in `value`. Returns the number of edges in the loop.
 */
static size_t walk_loop(const rheo__mesh *mesh, item *open, size_t count, size_t from, double middle[3])
{
    size_t edges = 0;
    middle[0] = middle[1] = middle[2] = 0;
    for (int64_t vertex = open[from].major;;) {
        size_t group = first_from(open, count, vertex);
        if (group == count || open[group].major != vertex)
            break;
        size_t next = group + (size_t)open[group].value;
        if (next == count || open[next].major != vertex)
            break;
        open[group].value++;
        edges++;
        for (int axis = 0; axis < 3; axis++)
            middle[axis] += mesh->vertex[3 * (size_t)vertex + (size_t)axis];
        vertex = open[next].minor;
        if (vertex == open[from].major)
            break;
    }
    for (int axis = 0; axis < 3; axis++)
        middle[axis] /= edges ? (double)edges : 1;
    return edges;
}

static rheo_result name_hole(const rheo__mesh *mesh, const char *name, item *open, size_t count, rheo_error *error)
{
    sort(open, count);
    size_t holes = 0, max_edges = 0, largest = 0;
    double centre[3] = {0, 0, 0};
    for (size_t start = 0; start < count;) {
        double middle[3];
        size_t edges = walk_loop(mesh, open, count, start, middle);
        if (edges > max_edges) {
            max_edges = edges;
            largest = start;
            memcpy(centre, middle, sizeof centre);
        }
        holes += edges > 0;
        /* Continues at the next vertex when all edges of this one are used. */
        size_t next = start + (size_t)open[start].value;
        if (next == count || open[next].major != open[start].major)
            start = next;
    }
    return rheo__fail(
        error, RHEO_ERROR_FORMAT,
        "%.200s: the mesh is not closed: %zu open %s around %zu %s, the largest with %zu edges around "
        "(%g, %g, %g), one of them from vertex %lld to %lld, counted from %u; only a closed mesh has an "
        "inside",
        name, count, count == 1 ? "edge" : "edges", holes, holes == 1 ? "hole" : "holes", max_edges, centre[0],
        centre[1], centre[2], (long long)open[largest].major + mesh->first_number,
        (long long)open[largest].minor + mesh->first_number, mesh->first_number);
}

/* ---- Check ---- */

/* Edges are sorted by lower, then by higher vertex. Their value is 1 from lower to higher vertex, -1 otherwise. */
static rheo_result check_edges(const rheo__mesh *mesh, const char *name, item *edge, size_t count, rheo_error *error)
{
    size_t open = 0;
    const item *alike = NULL, *many = NULL;
    size_t uses = 0;
    for (size_t i = 0, next; i < count; i = next) {
        int64_t sum = 0;
        for (next = i; next < count && !less(&edge[i], &edge[next]); next++)
            sum += edge[next].value;
        if (next - i > 2 && !many) {
            many = &edge[i];
            uses = next - i;
        }
        if (next - i == 2 && sum != 0 && !alike)
            alike = &edge[i];
    }
    if (many)
        return rheo__fail(
            error, RHEO_ERROR_FORMAT,
            "%.200s: %zu triangles share the edge between vertices %lld and %lld, counted from %u; in a "
            "closed mesh two do",
            name, uses, (long long)many->major + mesh->first_number, (long long)many->minor + mesh->first_number,
            mesh->first_number);
    if (alike)
        return rheo__fail(
            error, RHEO_ERROR_FORMAT,
            "%.200s: the two triangles at the edge between vertices %lld and %lld, counted from %u, are "
            "oriented differently; all must be counterclockwise seen from outside, or all clockwise",
            name, (long long)alike->major + mesh->first_number, (long long)alike->minor + mesh->first_number,
            mesh->first_number);
    for (size_t i = 0; i < count; i++) {
        if (i + 1 < count && !less(&edge[i], &edge[i + 1])) {
            i++; /* two opposite edges */
            continue;
        }
        bool forwards = edge[i].value > 0;
        /* The boundary of the hole runs opposite to the boundary of the triangle. */
        edge[open++] = (item){forwards ? edge[i].minor : edge[i].major, forwards ? edge[i].major : edge[i].minor, 0};
    }
    return open ? name_hole(mesh, name, edge, open, error) : RHEO_OK;
}

static void measure(rheo__mesh *mesh)
{
    const double *origin = mesh->vertex + 3 * (size_t)mesh->triangle[0];
    double six = 0;
    memcpy(mesh->low, origin, sizeof mesh->low);
    memcpy(mesh->high, origin, sizeof mesh->high);
    for (size_t t = 0; t < mesh->triangles; t++) {
        double side[3][3];
        for (size_t k = 0; k < 3; k++)
            for (size_t axis = 0; axis < 3; axis++) {
                double x = mesh->vertex[3 * (size_t)mesh->triangle[3 * t + k] + axis];
                mesh->low[axis] = x < mesh->low[axis] ? x : mesh->low[axis];
                mesh->high[axis] = x > mesh->high[axis] ? x : mesh->high[axis];
                side[k][axis] = x - origin[axis];
            }
        six += side[0][0] * (side[1][1] * side[2][2] - side[1][2] * side[2][1]) +
               side[0][1] * (side[1][2] * side[2][0] - side[1][0] * side[2][2]) +
               side[0][2] * (side[1][0] * side[2][1] - side[1][1] * side[2][0]);
    }
    mesh->volume = six / 6;
}

static void turn(rheo__mesh *mesh)
{
    for (size_t t = 0; t < mesh->triangles; t++) {
        uint32_t *corner = mesh->triangle + 3 * t, first = corner[0];
        corner[0] = corner[1];
        corner[1] = first;
    }
    mesh->volume = -mesh->volume;
}

rheo_result rheo__mesh_check(rheo__mesh *mesh, const char *name, rheo_error *error)
{
    if (mesh->triangles == 0)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%.200s: the mesh has no triangle", name);
    size_t count = 3 * mesh->triangles;
    item *edge = rheo__allocate(&mesh->allocator, count, sizeof *edge);
    if (!edge)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "%.200s: no memory for a mesh of %zu triangles", name,
                          mesh->triangles);
    for (size_t t = 0; t < mesh->triangles; t++)
        for (size_t k = 0; k < 3; k++) {
            int64_t a = mesh->triangle[3 * t + k], b = mesh->triangle[3 * t + (k + 1) % 3];
            edge[3 * t + k] = a < b ? (item){a, b, 1} : (item){b, a, -1};
        }
    sort(edge, count);
    rheo_result result = check_edges(mesh, name, edge, count, error);
    rheo__release(&mesh->allocator, edge);
    if (result != RHEO_OK)
        return result;
    measure(mesh);
    for (int axis = 0; axis < 3; axis++)
        if (!(mesh->high[axis] > mesh->low[axis]))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "%.200s: the mesh is flat along %c and has no inside", name,
                              "xyz"[axis]);
    if (mesh->volume < 0)
        turn(mesh);
    return RHEO_OK;
}

/* ---- Inside ---- */

/* Largest number of crossings of rows and segments in a plane, far more than any shape needs. */
enum { MAX_CROSSINGS = 1 << 22 };

typedef struct scan {
    rheo_allocator allocator;
    const rheo__mesh *mesh;
    double *vertex;   /* vertices in lattice coordinates */
    item *start;      /* triangles; major: first plane that cuts the triangle; minor: one past the last such plane */
    uint32_t *active; /* triangles that the current plane cuts, as indices into start */
    item *crossing;   /* crossings in the current plane: row, first point after the crossing, direction */
    size_t starts, actives, crossings, crossing_room;
} scan;

/* Adds the crossings of the rows with the segment of one triangle. */
static rheo_result cut(scan *s, size_t triangle, int64_t plane, rheo_error *error)
{
    const uint32_t *corner = s->mesh->triangle + 3 * triangle;
    const double z = (double)plane;
    double x[2] = {0, 0}, y[2] = {0, 0}; /* 0: an edge goes down through the plane; 1: an edge goes up */
    for (size_t k = 0; k < 3; k++) {
        uint32_t a = corner[k], b = corner[(k + 1) % 3];
        bool up = s->vertex[3 * (size_t)b + 2] > z;
        if ((s->vertex[3 * (size_t)a + 2] > z) == up)
            continue;
        const double *low = s->vertex + 3 * (size_t)(a < b ? a : b), *high = s->vertex + 3 * (size_t)(a < b ? b : a);
        double part = (z - low[2]) / (high[2] - low[2]);
        x[up] = low[0] + part * (high[0] - low[0]);
        y[up] = low[1] + part * (high[1] - low[1]);
    }
    size_t first = y[1] < y[0], last = 1 - first;
    int64_t row = rheo__round_up(y[first]), end = rheo__round_up(y[last]);
    size_t count = s->crossings + (size_t)(end - row);
    if (count > MAX_CROSSINGS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the rows of particles cross a mesh more than %d times in one plane", MAX_CROSSINGS);
    void *memory = s->crossing;
    if (!rheo__grow(&s->allocator, &memory, &s->crossing_room, count < 256 ? 256 : count, s->crossings,
                    sizeof *s->crossing))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to fill a mesh");
    s->crossing = memory;
    for (; row < end; row++) {
        double part = ((double)row - y[first]) / (y[last] - y[first]);
        s->crossing[s->crossings++] =
            (item){row, rheo__round_up(x[first] + part * (x[last] - x[first])), last == 1 ? 1 : -1};
    }
    return RHEO_OK;
}

static bool run_rows(scan *s, int64_t plane, rheo__run *run, void *user)
{
    int64_t winding = 0, from = 0;
    sort(s->crossing, s->crossings);
    for (size_t i = 0; i < s->crossings; i++) {
        const item *c = &s->crossing[i];
        if (winding == 0)
            from = c->minor;
        winding += c->value;
        if (winding == 0 && from < c->minor && !run(user, from, c->minor, c->major, plane))
            return false;
    }
    return true;
}

static bool begin_scan(scan *s, const rheo__mesh_frame *frame, rheo_error *error, rheo_result *result)
{
    const rheo__mesh *mesh = s->mesh;
    s->vertex = rheo__allocate(&s->allocator, mesh->vertices, 3 * sizeof *s->vertex);
    s->start = rheo__allocate(&s->allocator, mesh->triangles, sizeof *s->start);
    s->active = rheo__allocate(&s->allocator, mesh->triangles, sizeof *s->active);
    if (!s->vertex || !s->start || !s->active) {
        *result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to fill a mesh of %zu triangles", mesh->triangles);
        return false;
    }
    for (size_t i = 0; i < 3 * mesh->vertices; i++)
        s->vertex[i] = (mesh->vertex[i] - frame->base[i % 3]) * frame->scale + frame->shift[i % 3];
    for (size_t t = 0; t < mesh->triangles; t++) {
        double low = 0, high = 0;
        for (size_t k = 0; k < 3; k++) {
            const double *corner = s->vertex + 3 * (size_t)mesh->triangle[3 * t + k];
            for (int axis = 0; axis < 3; axis++)
                if (!(corner[axis] >= -1e9 && corner[axis] <= 1e9)) {
                    *result = rheo__fail(error, RHEO_ERROR_ARGUMENT, "a mesh reaches farther than 1e9 spacings");
                    return false;
                }
            low = k == 0 || corner[2] < low ? corner[2] : low;
            high = k == 0 || corner[2] > high ? corner[2] : high;
        }
        item planes = {rheo__round_up(low), rheo__round_up(high), (int64_t)t};
        if (planes.major < planes.minor)
            s->start[s->starts++] = planes;
    }
    sort(s->start, s->starts);
    return true;
}

static rheo_result scan_planes(scan *s, rheo__run *run, void *user, rheo_error *error)
{
    size_t next = 0;
    for (int64_t plane = 0; s->actives || next < s->starts; plane++) {
        if (s->actives == 0)
            plane = s->start[next].major;
        for (; next < s->starts && s->start[next].major == plane; next++)
            s->active[s->actives++] = (uint32_t)next;
        size_t kept = 0;
        s->crossings = 0;
        for (size_t i = 0; i < s->actives; i++) {
            const item *triangle = &s->start[s->active[i]];
            if (triangle->minor <= plane)
                continue;
            s->active[kept++] = s->active[i];
            RHEO__TRY(cut(s, (size_t)triangle->value, plane, error));
        }
        s->actives = kept;
        if (!run_rows(s, plane, run, user))
            return RHEO_OK;
    }
    return RHEO_OK;
}

rheo_result rheo__mesh_scan(const rheo__mesh *mesh, const rheo__mesh_frame *frame, rheo__run *run, void *user,
                            rheo_error *error)
{
    scan s = {.allocator = mesh->allocator, .mesh = mesh};
    rheo_result result = RHEO_OK;
    if (begin_scan(&s, frame, error, &result))
        result = scan_planes(&s, run, user, error);
    rheo__release(&s.allocator, s.vertex);
    rheo__release(&s.allocator, s.start);
    rheo__release(&s.allocator, s.active);
    rheo__release(&s.allocator, s.crossing);
    return result;
}
