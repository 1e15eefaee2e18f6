/* Makes surfaces of triangles (space/surface.h): checks them, and computes pseudonormals and the grid. */
#include <string.h>

#include "core/strict.h"
#include "rheolog/world.h"
#include "space/surface.h"

/* ---- Making: normals ---- */

/* The angle whose tangent is t >= 0. */
static double arc(double t)
{
    const bool steep = t > 1;
    t = steep ? 1 / t : t;
    for (int halving = 0; halving < 3; halving++)
        t = t / (1 + __builtin_sqrt(1 + t * t));
    double power = t, sum = 0;
    for (int k = 1; k < 24; k += 4) {
        sum += power / k - power * t * t / (k + 2);
        power *= t * t * t * t;
    }
    return steep ? 1.5707963267948966 - 8 * sum : 8 * sum;
}

static double unit(double v[3])
{
    const double length = __builtin_sqrt(rheo__dot3(v, v));
    for (int axis = 0; axis < 3; axis++)
        v[axis] /= length;
    return length;
}

/* Angle of a triangle at a corner. */
static double angle_at(const rheo__surface *s, size_t triangle, int k)
{
    double a[3], b[3], difference[3];
    rheo__minus3(rheo__corner(s, triangle, k + 1), rheo__corner(s, triangle, k), a);
    rheo__minus3(rheo__corner(s, triangle, k + 2), rheo__corner(s, triangle, k), b);
    unit(a);
    unit(b);
    rheo__minus3(a, b, difference);
    const double sum[3] = {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    return 2 * arc(__builtin_sqrt(rheo__dot3(difference, difference)) / __builtin_sqrt(rheo__dot3(sum, sum)));
}

static rheo_result make_normals(rheo__surface *s, double *volume, rheo_error *error)
{
    *volume = 0;
    for (size_t t = 0; t < s->triangles; t++) {
        double ab[3], ac[3], n[3];
        rheo__minus3(rheo__corner(s, t, 1), rheo__corner(s, t, 0), ab);
        rheo__minus3(rheo__corner(s, t, 2), rheo__corner(s, t, 0), ac);
        rheo__cross3(ab, ac, n);
        *volume += rheo__dot3(rheo__corner(s, t, 0), n);
        if (!(unit(n) > 0))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "has a triangle without area, %zu", t);
        memcpy(s->face_normal[t], n, sizeof n);
        for (int k = 0; k < 3; k++) {
            const double angle = angle_at(s, t, k);
            for (int axis = 0; axis < 3; axis++)
                s->vertex_normal[s->triangle[t][k]][axis] += angle * n[axis];
        }
    }
    return RHEO_OK;
}

/* Sorts edges by their smaller (which: 0) or larger vertex; edges of the same keep their order. */
static void sort_edges(const rheo__surface *s, int which, const uint32_t *from, uint32_t *to, uint32_t *start)
{
    const uint32_t edges = 3 * s->triangles;
    memset(start, 0, ((size_t)s->vertices + 1) * sizeof *start);
    for (uint32_t pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < edges; i++) {
            const uint32_t edge = from[i], a = s->triangle[edge / 3][edge % 3],
                           b = s->triangle[edge / 3][(edge + 1) % 3], key = (a < b) == (which == 0) ? a : b;
            if (pass)
                to[start[key]++] = edge;
            else
                start[key + 1]++;
        }
        for (uint32_t v = 0; v < s->vertices && !pass; v++)
            start[v + 1] += start[v];
    }
}

static rheo_result make_edges(rheo__surface *s, uint32_t *order, uint32_t *sorted, uint32_t *start, rheo_error *error)
{
    const uint32_t edges = 3 * s->triangles;
    for (uint32_t i = 0; i < edges; i++)
        order[i] = i;
    sort_edges(s, 1, order, sorted, start);
    sort_edges(s, 0, sorted, order, start);
    for (uint32_t i = 0; i < edges; i += 2) {
        const uint32_t one = order[i], other = i + 1 < edges ? order[i + 1] : one;
        const uint32_t a = s->triangle[one / 3][one % 3], b = s->triangle[one / 3][(one + 1) % 3],
                       c = s->triangle[other / 3][other % 3], d = s->triangle[other / 3][(other + 1) % 3];
        if (a != d || b != c)
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "is not closed: the edge from vertex %u to %u does not have two triangles that are oriented alike", a,
                b);
        for (int axis = 0; axis < 3; axis++)
            s->edge_normal[one][axis] = s->edge_normal[other][axis] =
                s->face_normal[one / 3][axis] + s->face_normal[other / 3][axis];
    }
    /* An edge with four triangles is two edges at the same place, which follow one another here. */
    for (uint32_t i = 2; i < edges; i += 2) {
        const uint32_t one = order[i], before = order[i - 1];
        const uint32_t a = s->triangle[one / 3][one % 3], b = s->triangle[one / 3][(one + 1) % 3],
                       c = s->triangle[before / 3][before % 3], d = s->triangle[before / 3][(before + 1) % 3];
        if ((a == c && b == d) || (a == d && b == c))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "has an edge with more than two triangles, from vertex %u to %u", a, b);
    }
    return RHEO_OK;
}

/* ---- Making: the grid ---- */

static void box_of(const rheo__surface *s, size_t triangle, double low[3], double high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = high[axis] = rheo__corner(s, triangle, 0)[axis];
        for (int k = 1; k < 3; k++) {
            const double x = rheo__corner(s, triangle, k)[axis];
            low[axis] = x < low[axis] ? x : low[axis];
            high[axis] = x > high[axis] ? x : high[axis];
        }
    }
}

/* Calls of a grid of triangles: counts the members of cells, then writes them. */
static size_t for_cells(rheo__surface *s, bool write)
{
    size_t count = 0;
    for (uint32_t t = 0; t < s->triangles; t++) {
        double low[3], high[3];
        uint32_t at[3], from[3], to[3];
        box_of(s, t, low, high);
        for (int axis = 0; axis < 3; axis++) {
            from[axis] = rheo__cell_along(s, low[axis], axis);
            to[axis] = rheo__cell_along(s, high[axis], axis);
        }
        if (!write) {
            count += (size_t)(to[0] - from[0] + 1) * (to[1] - from[1] + 1) * (to[2] - from[2] + 1);
            continue;
        }
        for (at[2] = from[2]; at[2] <= to[2]; at[2]++)
            for (at[1] = from[1]; at[1] <= to[1]; at[1]++)
                for (at[0] = from[0]; at[0] <= to[0]; at[0]++)
                    if (s->member)
                        s->member[s->first[rheo__cell_at(s, at)]++] = t;
                    else
                        s->first[rheo__cell_at(s, at) + 1]++;
    }
    return count;
}

/* About two cells for each triangle, but at most 32 along an axis, and fewer where triangles are so large that they would be members of too many. */
static size_t choose_cells(rheo__surface *s, const double low[3], const double high[3])
{
    enum { MOST = 32, MEMBERS = 32 }; /* MOST: each cell costs a search when a world is made */
    uint32_t along = 1;
    while (along < MOST && (double)along * along * along < 2.0 * s->triangles)
        along++;
    double longest = 0;
    for (int axis = 0; axis < 3; axis++) {
        longest = high[axis] - low[axis] > longest ? high[axis] - low[axis] : longest;
        s->low[axis] = low[axis];
    }
    for (;; along /= 2) {
        s->cell = longest / along * (1 + 1e-9);
        for (int axis = 0; axis < 3; axis++)
            s->cells[axis] = (uint32_t)((high[axis] - low[axis]) / s->cell) + 1;
        const size_t members = for_cells(s, false);
        if (along == 1 || members <= MEMBERS * (size_t)s->triangles)
            return members;
    }
}

static rheo_result make_grid(rheo__surface *s, const rheo_allocator *allocator, rheo_error *error)
{
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (uint32_t t = 0; t < s->triangles; t++) {
        double from[3], to[3];
        box_of(s, t, from, to);
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = !t || from[axis] < low[axis] ? from[axis] : low[axis];
            high[axis] = !t || to[axis] > high[axis] ? to[axis] : high[axis];
        }
    }
    const size_t members = choose_cells(s, low, high), cells = (size_t)s->cells[0] * s->cells[1] * s->cells[2];
    s->first = rheo__allocate(allocator, cells + 2, sizeof *s->first);
    uint32_t *member = rheo__allocate(allocator, members + 1, sizeof *member);
    s->cell_distance = rheo__allocate(allocator, cells, sizeof *s->cell_distance);
    if (!s->first || !member || !s->cell_distance) {
        rheo__release(allocator, member);
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the mesh of an obstacle");
    }
    for_cells(s, true);
    for (size_t cell = 0; cell < cells; cell++)
        s->first[cell + 1] += s->first[cell];
    s->member = member;
    for_cells(s, true); /* moves the starts to the ends */
    memmove(s->first + 1, s->first, cells * sizeof *s->first);
    s->first[0] = 0;
    uint32_t at[3];
    for (at[2] = 0; at[2] < s->cells[2]; at[2]++)
        for (at[1] = 0; at[1] < s->cells[1]; at[1]++)
            for (at[0] = 0; at[0] < s->cells[0]; at[0]++) {
                double x[3], normal[3];
                for (int axis = 0; axis < 3; axis++)
                    x[axis] = s->low[axis] + s->cell * (at[axis] + 0.5);
                s->cell_distance[rheo__cell_at(s, at)] = rheo__surface_distance(s, x, __builtin_inf(), false, normal);
            }
    return RHEO_OK;
}

/* ---- Making ---- */

static rheo_result check_numbers(const rheo__surface_mesh *m, rheo_error *error)
{
    if (!m->vertex || !m->triangle || !m->vertices || !m->triangles)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "has no triangles");
    if (m->vertices > RHEO_MAX_OBSTACLE_VERTICES || m->triangles > RHEO_MAX_OBSTACLE_TRIANGLES)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "has %u vertices and %u triangles; at most %d and %d are possible", m->vertices,
                          m->triangles, RHEO_MAX_OBSTACLE_VERTICES, RHEO_MAX_OBSTACLE_TRIANGLES);
    for (uint32_t v = 0; v < m->vertices; v++)
        for (int axis = 0; axis < 3; axis++)
            if (!(m->vertex[v][axis] > -1e30 && m->vertex[v][axis] < 1e30))
                return rheo__fail(error, RHEO_ERROR_ARGUMENT, "has a vertex that is not finite, %u", v);
    for (uint32_t t = 0; t < m->triangles; t++)
        for (int k = 0; k < 3; k++)
            if (m->triangle[t][k] >= m->vertices)
                return rheo__fail(error, RHEO_ERROR_ARGUMENT, "has %u vertices, but triangle %u has vertex %u",
                                  m->vertices, t, m->triangle[t][k]);
    return RHEO_OK;
}

/* Copies the triangles, and the vertices scaled, about the middle of the box of the triangles. */
static void take_over(rheo__surface *s, const rheo__surface_mesh *m)
{
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    memcpy(s->triangle, m->triangle, m->triangles * sizeof *s->triangle);
    memcpy(s->vertex, m->vertex, m->vertices * sizeof *s->vertex);
    for (size_t i = 0; i < 3 * (size_t)m->triangles; i++)
        for (int axis = 0; axis < 3; axis++) {
            const double x = m->vertex[m->triangle[i / 3][i % 3]][axis];
            low[axis] = !i || x < low[axis] ? x : low[axis];
            high[axis] = !i || x > high[axis] ? x : high[axis];
        }
    const double scale = m->height > 0 && high[1] > low[1] ? m->height / (high[1] - low[1]) : 1;
    double reach2 = 0;
    for (uint32_t v = 0; v < s->vertices; v++) {
        for (int axis = 0; axis < 3; axis++)
            s->vertex[v][axis] = scale * (s->vertex[v][axis] - (low[axis] + (high[axis] - low[axis]) / 2));
        const double length2 = rheo__dot3(s->vertex[v], s->vertex[v]);
        reach2 = length2 > reach2 ? length2 : reach2;
    }
    s->half_height = scale * (high[1] - low[1]) / 2;
    s->reach = __builtin_sqrt(reach2);
}

static rheo_result fill(rheo__surface *s, const rheo__surface_mesh *m, const rheo_allocator *allocator,
                        rheo_error *error)
{
    const size_t edges = 3 * (size_t)m->triangles;
    s->vertices = m->vertices;
    s->triangles = m->triangles;
    s->vertex = rheo__allocate(allocator, m->vertices, sizeof *s->vertex);
    s->vertex_normal = rheo__allocate(allocator, m->vertices, sizeof *s->vertex_normal);
    s->triangle = rheo__allocate(allocator, m->triangles, sizeof *s->triangle);
    s->face_normal = rheo__allocate(allocator, m->triangles, sizeof *s->face_normal);
    s->edge_normal = rheo__allocate(allocator, edges, sizeof *s->edge_normal);
    uint32_t *work = rheo__allocate(allocator, 2 * edges + m->vertices + 1, sizeof *work);
    double volume = 0;
    rheo_result result = RHEO_OK;
    if (!s->vertex || !s->vertex_normal || !s->triangle || !s->face_normal || !s->edge_normal || !work)
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the mesh of an obstacle");
    if (result == RHEO_OK) {
        take_over(s, m);
        result = make_normals(s, &volume, error);
    }
    if (result == RHEO_OK)
        result = make_edges(s, work, work + edges, work + 2 * edges, error);
    rheo__release(allocator, work);
    if (result == RHEO_OK && !(volume > 0))
        result = rheo__fail(error, RHEO_ERROR_ARGUMENT, "is inside out, or encloses nothing");
    return result == RHEO_OK ? make_grid(s, allocator, error) : result;
}

rheo_result rheo__surface_make(const rheo__surface_mesh *mesh, const rheo_allocator *allocator,
                               rheo__surface **surface, rheo_error *error)
{
    *surface = NULL;
    RHEO__TRY(check_numbers(mesh, error));
    rheo__surface *made = rheo__allocate(allocator, 1, sizeof *made);
    if (!made)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the mesh of an obstacle");
    const rheo_result result = fill(made, mesh, allocator, error);
    if (result == RHEO_OK)
        *surface = made;
    else
        rheo__surface_release(made, allocator);
    return result;
}

void rheo__surface_release(rheo__surface *s, const rheo_allocator *allocator)
{
    if (!s)
        return;
    void *const arrays[] = {s->vertex,      s->triangle, s->vertex_normal, s->face_normal,
                            s->edge_normal, s->first,    s->member,        s->cell_distance};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rheo__release(allocator, arrays[i]);
    rheo__release(allocator, s);
}
