/*
 * Marching cubes (Lorensen and Cline, 1987) without a table of cases. An edge of the grid on which chi crosses the
 * isovalue has one vertex, shared by the cells around it. On a face of a cell the surface is a segment between two
 * such vertices, or two segments if the corners alternate between inside and outside. Two pairs of segments are then
 * possible; the sign of chi - isovalue at the saddle of the bilinear function selects one (Nielson and Hamann, "The
 * asymptotic decider", 1991). It depends only on the four corners, so both cells of the face have the same segments.
 *
 * The segments around a cell form closed loops, and each loop is cut into triangles. A cut never joins two vertices
 * of one face, because the cell on the other side could make the same cut. If there is no other cut, the triangles
 * meet at a new vertex in the middle of the loop. So every edge has exactly two triangles for any values at the
 * corners: the surface is closed and manifold.
 *
 * A vertex keeps a distance of 1/1024 of the edge from both ends. So a corner at exactly the isovalue makes small
 * triangles, but none with zero area.
 */
#include "view/marching_cubes.h"

#include <float.h>
#include <string.h>

#include "core/error.h"
#include "view/cell.h"

/* Corners along an axis that the cells and gradients of a block need: from -1 to RHEO__BLOCK + 1. */
enum { WIDE = RHEO__BLOCK + 3 };

typedef struct maker {
    const rheo__grid *grid;
    double isovalue;
    rheo_surface *s;
    size_t position_room, normal_room, value_room, triangle_room;
    uint32_t *slot; /* index of each block in `edge`; RHEO__NO_BLOCK: it has no vertices */
    uint32_t *edge; /* vertex on each edge of the blocks with vertices: slots x 3 axes x RHEO__BLOCK_CORNERS */
    size_t edge_room;
    uint32_t slots;
    double chi[WIDE * WIDE * WIDE], value[WIDE * WIDE * WIDE]; /* corners of the current block */
} maker;

static size_t wide(int x, int y, int z)
{
    return ((size_t)(z + 1) * WIDE + (size_t)(y + 1)) * WIDE + (size_t)(x + 1);
}

/* Offset of the block that contains a corner from -1 to RHEO__BLOCK + 1, relative to the current block. */
static int aside(int x)
{
    return x < 0 ? -1 : x >= RHEO__BLOCK ? 1 : 0;
}

static size_t in_block(int x, int y, int z)
{
    enum { MASK = RHEO__BLOCK - 1 };
    return (size_t)(((z & MASK) * RHEO__BLOCK + (y & MASK)) * RHEO__BLOCK + (x & MASK));
}

static void find_blocks_around(const rheo__grid *grid, uint32_t block, uint32_t around[27])
{
    for (int n = 0; n < 27; n++)
        around[n] =
            rheo__grid_block(grid, rheo__grid_key_beside(grid->key[block], n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
}

static uint32_t block_at(const uint32_t around[27], int x, int y, int z)
{
    return around[(aside(z) + 1) * 9 + (aside(y) + 1) * 3 + aside(x) + 1];
}

/* Loads chi around a block. False: the surface does not pass through it. */
static bool take_block(maker *m, const uint32_t around[27])
{
    bool inside = false, outside = false;
    for (int z = -1; z < WIDE - 1; z++) {
        for (int y = -1; y < WIDE - 1; y++) {
            for (int x = -1; x < WIDE - 1; x++) {
                const uint32_t from = block_at(around, x, y, z);
                const size_t at = (size_t)from * RHEO__BLOCK_CORNERS + in_block(x, y, z);
                const double chi = from == RHEO__NO_BLOCK ? 0 : m->grid->chi[at];
                m->chi[wide(x, y, z)] = chi - m->isovalue;
                if (m->grid->value)
                    m->value[wide(x, y, z)] = from == RHEO__NO_BLOCK ? 0 : m->grid->value[at];
                inside |= chi >= m->isovalue;
                outside |= chi < m->isovalue;
            }
        }
    }
    return inside && outside;
}

/* Central difference of chi at a corner: the gradient, apart from a factor. */
static double slope(const maker *m, size_t at, int axis)
{
    static const size_t stride[3] = {1, WIDE, WIDE * WIDE};
    return m->chi[at + stride[axis]] - m->chi[at - stride[axis]];
}

/* The normal is opposite to the gradient. If the gradient is zero, it points outwards along the edge. */
static void set_normal(float normal[3], const double gradient[3], int axis, bool outwards_up)
{
    double largest = 0;
    for (int a = 0; a < 3; a++) {
        const double size = gradient[a] < 0 ? -gradient[a] : gradient[a];
        largest = size > largest ? size : largest;
    }
    double n[3] = {0, 0, 0};
    n[axis] = outwards_up ? 1 : -1;
    if (largest > 0 && largest <= DBL_MAX) {
        double length2 = 0; /* components are at most 1: no overflow */
        for (int a = 0; a < 3; a++) {
            n[a] = -gradient[a] / largest;
            length2 += n[a] * n[a];
        }
        const double length = __builtin_sqrt(length2);
        for (int a = 0; a < 3; a++)
            n[a] /= length;
    }
    for (int a = 0; a < 3; a++)
        normal[a] = (float)n[a];
}

static rheo_result no_memory(const maker *m, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a surface of more than %u vertices and %u triangles",
                      m->s->vertices, m->s->triangles);
}

static rheo_result too_many(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_UNSUPPORTED,
                      "the surface has more than 2147483647 vertices or triangles; choose a lower resolution");
}

/* Makes room for one more vertex. */
static rheo_result another_vertex(maker *m, rheo_error *error)
{
    rheo_surface *s = m->s;
    const rheo_allocator *allocator = &s->allocator;
    if (s->vertices == INT32_MAX)
        return too_many(error);
    void *position = s->position, *normal = s->normal, *value = s->value;
    const size_t n = s->vertices;
    const bool grown = rheo__grow(allocator, &position, &m->position_room, n + 1, n, 3 * sizeof *s->position) &&
                       rheo__grow(allocator, &normal, &m->normal_room, n + 1, n, 3 * sizeof *s->normal) &&
                       (!m->grid->value || rheo__grow(allocator, &value, &m->value_room, n + 1, n, sizeof *s->value));
    s->position = position;
    s->normal = normal;
    s->value = value;
    if (!grown)
        return no_memory(m, error);
    s->vertices++;
    return RHEO_OK;
}

/* Adds the vertex on the edge that starts at a corner of the current block and runs along an axis. */
static rheo_result add_vertex(maker *m, const int32_t first[3], const int corner[3], int axis, rheo_error *error)
{
    static const size_t stride[3] = {1, WIDE, WIDE * WIDE};
    RHEO__TRY(another_vertex(m, error));
    rheo_surface *s = m->s;
    const size_t n = s->vertices - 1, a = wide(corner[0], corner[1], corner[2]), b = a + stride[axis];
    double t = m->chi[a] / (m->chi[a] - m->chi[b]);
    const double least = 1.0 / 1024;
    t = t > least ? t < 1 - least ? t : 1 - least : least;
    double gradient[3];
    for (int d = 0; d < 3; d++) {
        const double coordinate = (double)(first[d] + corner[d]) + (d == axis ? t : 0);
        s->position[3 * n + d] = (float)(coordinate * m->grid->cell);
        gradient[d] = (1 - t) * slope(m, a, d) + t * slope(m, b, d);
    }
    set_normal(s->normal + 3 * n, gradient, axis, m->chi[a] >= 0);
    if (m->grid->value) {
        const double chi_a = m->chi[a] + m->isovalue, chi_b = m->chi[b] + m->isovalue;
        s->value[n] =
            (float)(((1 - t) * m->value[a] + t * m->value[b]) / ((1 - t) * chi_a + t * chi_b)); /* chi is > 0 there */
    }
    return RHEO_OK;
}

static rheo_result edges_of(maker *m, uint32_t block, uint32_t **edge, rheo_error *error)
{
    enum { EACH = 3 * RHEO__BLOCK_CORNERS };
    if (m->slot[block] == RHEO__NO_BLOCK) {
        void *grown = m->edge;
        const bool got = rheo__grow(&m->s->allocator, &grown, &m->edge_room, (size_t)m->slots + 1, m->slots,
                                    EACH * sizeof *m->edge);
        m->edge = grown;
        if (!got)
            return no_memory(m, error);
        m->slot[block] = m->slots++;
    }
    *edge = m->edge + (size_t)m->slot[block] * EACH;
    return RHEO_OK;
}

static rheo_result make_vertices(maker *m, uint32_t block, rheo_error *error)
{
    int32_t first[3];
    uint32_t *edge = NULL;
    for (int a = 0; a < 3; a++)
        first[a] = rheo__grid_first_corner(m->grid->key[block], a);
    static const size_t stride[3] = {1, WIDE, WIDE * WIDE};
    for (int k = 0; k < RHEO__BLOCK_CORNERS; k++) {
        const int corner[3] = {k % RHEO__BLOCK, k / RHEO__BLOCK % RHEO__BLOCK, k / RHEO__BLOCK / RHEO__BLOCK};
        const size_t at = wide(corner[0], corner[1], corner[2]);
        for (int axis = 0; axis < 3; axis++) {
            if ((m->chi[at] >= 0) == (m->chi[at + stride[axis]] >= 0))
                continue;
            if (!edge)
                RHEO__TRY(edges_of(m, block, &edge, error));
            edge[axis * RHEO__BLOCK_CORNERS + k] = m->s->vertices;
            RHEO__TRY(add_vertex(m, first, corner, axis, error));
        }
    }
    return RHEO_OK;
}

/* ---- Triangles ---- */

static rheo_result add_triangle(maker *m, uint32_t a, uint32_t b, uint32_t c, rheo_error *error)
{
    rheo_surface *s = m->s;
    if (s->triangles == INT32_MAX)
        return too_many(error);
    void *triangle = s->triangle;
    const size_t n = s->triangles;
    const bool grown = rheo__grow(&s->allocator, &triangle, &m->triangle_room, n + 1, n, 3 * sizeof *s->triangle);
    s->triangle = triangle;
    if (!grown)
        return no_memory(m, error);
    s->triangle[3 * n] = a;
    s->triangle[3 * n + 1] = b;
    s->triangle[3 * n + 2] = c;
    s->triangles++;
    return RHEO_OK;
}

typedef struct loop {
    int count, edge[RHEO__CELL_EDGES];
    uint32_t vertex[RHEO__CELL_EDGES];
} loop;

static double distance2(const rheo_surface *s, uint32_t a, uint32_t b)
{
    double sum = 0;
    for (int d = 0; d < 3; d++) {
        const double difference = (double)s->position[3 * (size_t)a + d] - (double)s->position[3 * (size_t)b + d];
        sum += difference * difference;
    }
    return sum;
}

/* Index of the vertex that the shortest cut removes from the loop; -1: every cut would lie in a face. */
static int best_ear(const maker *m, const loop *l)
{
    int best = -1;
    double shortest = 0;
    for (int i = 0; i < l->count; i++) {
        const int before = (i + l->count - 1) % l->count, after = (i + 1) % l->count;
        if (rheo__cell_edge_faces(l->edge[before]) & rheo__cell_edge_faces(l->edge[after]))
            continue;
        const double length2 = distance2(m->s, l->vertex[before], l->vertex[after]);
        if (best < 0 || length2 < shortest) {
            best = i;
            shortest = length2;
        }
    }
    return best;
}

/* Adds a vertex in the middle of the loop, and a triangle from it to each side. */
static rheo_result fill_from_middle(maker *m, const loop *l, rheo_error *error)
{
    RHEO__TRY(another_vertex(m, error));
    rheo_surface *s = m->s;
    const size_t n = s->vertices - 1;
    double inwards[3] = {0, 0, 0}, value = 0;
    for (int d = 0; d < 3; d++) {
        double sum = 0;
        for (int i = 0; i < l->count; i++) {
            sum += (double)s->position[3 * (size_t)l->vertex[i] + d];
            inwards[d] -= (double)s->normal[3 * (size_t)l->vertex[i] + d];
        }
        s->position[3 * n + d] = (float)(sum / l->count);
    }
    set_normal(s->normal + 3 * n, inwards, 1, true);
    for (int i = 0; s->value && i < l->count; i++)
        value += (double)s->value[l->vertex[i]];
    if (s->value)
        s->value[n] = (float)(value / l->count);
    for (int i = 0; i < l->count; i++)
        RHEO__TRY(add_triangle(m, (uint32_t)n, l->vertex[i], l->vertex[(i + 1) % l->count], error));
    return RHEO_OK;
}

static rheo_result fill_loop(maker *m, loop *l, rheo_error *error)
{
    while (l->count > 3) {
        const int ear = best_ear(m, l);
        if (ear < 0)
            return fill_from_middle(m, l, error);
        RHEO__TRY(add_triangle(m, l->vertex[(ear + l->count - 1) % l->count], l->vertex[ear],
                               l->vertex[(ear + 1) % l->count], error));
        l->count--;
        for (int i = ear; i < l->count; i++) {
            l->edge[i] = l->edge[i + 1];
            l->vertex[i] = l->vertex[i + 1];
        }
    }
    return add_triangle(m, l->vertex[0], l->vertex[1], l->vertex[2], error);
}

static uint32_t vertex_of(const maker *m, const uint32_t around[27], const int cell[3], int edge)
{
    const int low = rheo__cell_edge_low(edge), x = cell[0] + (low & 1), y = cell[1] + (low >> 1 & 1),
              z = cell[2] + (low >> 2);
    const uint32_t block = block_at(around, x, y, z);
    return m->edge[((size_t)m->slot[block] * 3 + (size_t)(edge / 4)) * RHEO__BLOCK_CORNERS + in_block(x, y, z)];
}

static rheo_result fill_cell(maker *m, const uint32_t around[27], const int cell[3], rheo_error *error)
{
    double v[RHEO__CELL_CORNERS];
    int inside = 0, next[RHEO__CELL_EDGES];
    for (int c = 0; c < RHEO__CELL_CORNERS; c++) {
        v[c] = m->chi[wide(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2))];
        inside += v[c] >= 0;
    }
    if (inside == 0 || inside == RHEO__CELL_CORNERS)
        return RHEO_OK;
    for (int e = 0; e < RHEO__CELL_EDGES; e++)
        next[e] = RHEO__CELL_NO_EDGE;
    for (int f = 0; f < RHEO__CELL_FACES; f++)
        rheo__cell_add_segments(f, v, next);
    for (int e = 0; e < RHEO__CELL_EDGES; e++) {
        loop l = {.count = 0};
        for (int at = e; next[at] != RHEO__CELL_NO_EDGE;) {
            const int then = next[at];
            l.edge[l.count] = at;
            l.vertex[l.count++] = vertex_of(m, around, cell, at);
            next[at] = RHEO__CELL_NO_EDGE;
            at = then;
        }
        if (l.count)
            RHEO__TRY(fill_loop(m, &l, error));
    }
    return RHEO_OK;
}

static rheo_result make_triangles(maker *m, const uint32_t around[27], rheo_error *error)
{
    for (int k = 0; k < RHEO__BLOCK_CORNERS; k++) {
        const int cell[3] = {k % RHEO__BLOCK, k / RHEO__BLOCK % RHEO__BLOCK, k / RHEO__BLOCK / RHEO__BLOCK};
        RHEO__TRY(fill_cell(m, around, cell, error));
    }
    return RHEO_OK;
}

/* Makes all vertices before any triangle, because a cell uses vertices of later blocks. */
static rheo_result march(maker *m, rheo_error *error)
{
    uint32_t around[27];
    for (uint32_t pass = 0; pass < 2; pass++) {
        for (uint32_t b = 0; b < m->grid->count; b++) {
            find_blocks_around(m->grid, b, around);
            if (take_block(m, around))
                RHEO__TRY(pass == 0 ? make_vertices(m, b, error) : make_triangles(m, around, error));
        }
    }
    return RHEO_OK;
}

rheo_result rheo__march(const rheo__grid *grid, double isovalue, rheo_surface *s, rheo_error *error)
{
    maker *m = rheo__allocate(&s->allocator, 1, sizeof *m);
    uint32_t *slot = rheo__allocate(&s->allocator, (size_t)grid->count + 1, sizeof *slot);
    rheo_result result = RHEO_ERROR_MEMORY;
    if (m && slot) {
        memset(slot, 0xff, ((size_t)grid->count + 1) * sizeof *slot); /* every slot is RHEO__NO_BLOCK */
        *m = (maker){.grid = grid, .isovalue = isovalue, .s = s, .slot = slot};
        result = march(m, error);
        rheo__release(&s->allocator, m->edge);
    } else {
        rheo__fail(error, result, "no memory for the surface");
    }
    rheo__release(&s->allocator, slot);
    rheo__release(&s->allocator, m);
    return result;
}
