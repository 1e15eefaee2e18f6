/*
 * Distances from surfaces of triangles (space/surface.h). For a point p, let c be the nearest point of the surface, and N
 * the pseudonormal of the face, edge or vertex that c is on:
 *
 *     face: its normal n;  edge: n_1 + n_2;  vertex: sum of angle x n over its faces
 *
 * The distance is |p - c| with the sign of N (p - c). Cells around that of p are searched in shells until no farther one
 * can hold a nearer triangle. The distance changes by no more than the point moves, so that of the middle of a cell tells
 * most points that they are far away.
 */
#include "space/surface.h"

#include <string.h>

#include "core/strict.h"
#include "rheolog/world.h"

enum { FACE, EDGE, VERTEX = EDGE + 3 }; /* EDGE + k: from corner k; VERTEX + k: corner k */

typedef struct nearest {
    double distance2, from[3]; /* from: p - c */
    uint32_t triangle;
    int feature;
} nearest;

/* ---- The nearest point of a triangle [Ericson, Real-Time Collision Detection, 5.1.5] ---- */

static void offer(nearest *best, const double p[3], const double c[3], uint32_t triangle, int feature)
{
    double from[3];
    rheo__minus3(p, c, from);
    const double distance2 = rheo__dot3(from, from);
    if (!(distance2 < best->distance2))
        return;
    *best = (nearest){.distance2 = distance2, .triangle = triangle, .feature = feature};
    memcpy(best->from, from, sizeof from);
}

/* Offers start + part along. */
static void offer_along(nearest *best, const double p[3], const double start[3], const double along[3], double part,
                        uint32_t triangle, int feature)
{
    const double c[3] = {start[0] + part * along[0], start[1] + part * along[1], start[2] + part * along[2]};
    offer(best, p, c, triangle, feature);
}

static void offer_triangle(const rheo__surface *s, uint32_t t, const double p[3], nearest *best)
{
    const double *a = rheo__corner(s, t, 0), *b = rheo__corner(s, t, 1), *c = rheo__corner(s, t, 2);
    double ab[3], ac[3], bc[3], ap[3], bp[3], cp[3];
    rheo__minus3(b, a, ab);
    rheo__minus3(c, a, ac);
    rheo__minus3(c, b, bc);
    rheo__minus3(p, a, ap);
    rheo__minus3(p, b, bp);
    rheo__minus3(p, c, cp);
    const double ab_a = rheo__dot3(ab, ap), ac_a = rheo__dot3(ac, ap), ab_b = rheo__dot3(ab, bp),
                 ac_b = rheo__dot3(ac, bp), ab_c = rheo__dot3(ab, cp), ac_c = rheo__dot3(ac, cp);
    const double of_c = ab_a * ac_b - ab_b * ac_a, of_b = ab_c * ac_a - ab_a * ac_c, of_a = ab_b * ac_c - ab_c * ac_b;
    if (ab_a <= 0 && ac_a <= 0)
        offer(best, p, a, t, VERTEX);
    else if (ab_b >= 0 && ac_b <= ab_b)
        offer(best, p, b, t, VERTEX + 1);
    else if (of_c <= 0 && ab_a >= 0 && ab_b <= 0)
        offer_along(best, p, a, ab, ab_a / (ab_a - ab_b), t, EDGE);
    else if (ac_c >= 0 && ab_c <= ac_c)
        offer(best, p, c, t, VERTEX + 2);
    else if (of_b <= 0 && ac_a >= 0 && ac_c <= 0)
        offer_along(best, p, a, ac, ac_a / (ac_a - ac_c), t, EDGE + 2);
    else if (of_a <= 0 && ac_b >= ab_b && ab_c >= ac_c)
        offer_along(best, p, b, bc, (ac_b - ab_b) / ((ac_b - ab_b) + (ab_c - ac_c)), t, EDGE + 1);
    else {
        const double height = rheo__dot3(s->face_normal[t], ap);
        offer_along(best, p, p, s->face_normal[t], -height, t, FACE);
    }
}

/* ---- Search ---- */

/* Searches a cell, unless all of it is farther than the nearest point so far. */
static void search_cell(const rheo__surface *s, const uint32_t at[3], const double p[3], nearest *best)
{
    double beyond2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double under = s->low[axis] + s->cell * at[axis] - p[axis], over = -under - s->cell,
                     beyond = (under > over ? under : over) - 1e-9 * s->reach;
        beyond2 += beyond > 0 ? beyond * beyond : 0;
    }
    if (beyond2 > best->distance2)
        return;
    const size_t cell = rheo__cell_at(s, at);
    for (uint32_t k = s->first[cell]; k < s->first[cell + 1]; k++)
        offer_triangle(s, s->member[k], p, best);
}

/* Searches the cells that are `ring` cells away along one axis, and no farther along the others. */
static void search_ring(const rheo__surface *s, const uint32_t middle[3], uint32_t ring, const double p[3],
                        nearest *best)
{
    uint32_t low[3], high[3], at[3];
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = middle[axis] > ring ? middle[axis] - ring : 0;
        high[axis] = middle[axis] + ring < s->cells[axis] ? middle[axis] + ring : s->cells[axis] - 1;
    }
    for (at[2] = low[2]; at[2] <= high[2]; at[2]++)
        for (at[1] = low[1]; at[1] <= high[1]; at[1]++) {
            const bool whole = at[2] + ring == middle[2] || at[2] == middle[2] + ring || at[1] + ring == middle[1] ||
                               at[1] == middle[1] + ring;
            for (at[0] = low[0]; at[0] <= high[0]; at[0]++)
                if (whole || at[0] + ring == middle[0] || at[0] == middle[0] + ring)
                    search_cell(s, at, p, best);
        }
}

/* Least distance of the cells outside of a ring; infinity if there are none. */
static double beyond_ring(const rheo__surface *s, const uint32_t middle[3], uint32_t ring, const double p[3])
{
    double least = __builtin_inf();
    for (int axis = 0; axis < 3; axis++) {
        const double below = p[axis] - (s->low[axis] + s->cell * ((double)middle[axis] - ring)),
                     above = s->low[axis] + s->cell * ((double)middle[axis] + ring + 1) - p[axis];
        if (middle[axis] > ring && below < least)
            least = below;
        if (middle[axis] + ring + 1 < s->cells[axis] && above < least)
            least = above;
    }
    return least;
}

static nearest search(const rheo__surface *s, const double p[3])
{
    const double rounding = 1e-9 * s->reach;
    nearest best = {.distance2 = __builtin_inf()};
    const uint32_t middle[3] = {rheo__cell_along(s, p[0], 0), rheo__cell_along(s, p[1], 1),
                                rheo__cell_along(s, p[2], 2)};
    for (uint32_t ring = 0;; ring++) {
        search_ring(s, middle, ring, p, &best);
        const double beyond = beyond_ring(s, middle, ring, p) - rounding;
        if (beyond == __builtin_inf() || (beyond > 0 && beyond * beyond > best.distance2))
            return best;
    }
}

/* The pseudonormal of the nearest point. */
static const double *normal_of(const rheo__surface *s, const nearest *found)
{
    const int feature = found->feature;
    const size_t t = found->triangle;
    return feature >= VERTEX ? s->vertex_normal[s->triangle[t][feature - VERTEX]]
           : feature >= EDGE ? s->edge_normal[3 * t + (size_t)(feature - EDGE)]
                             : s->face_normal[t];
}

static double exact_distance(const rheo__surface *s, const double x[3], double normal[3])
{
    const nearest found = search(s, x);
    const double *of = normal_of(s, &found), distance = __builtin_sqrt(found.distance2),
                 sign = rheo__dot3(of, found.from) < 0 ? -1 : 1;
    /* Close to the surface, p - c is rounding. */
    const bool close = !(distance > 1e-9 * s->reach);
    const double scale = close ? 1 / __builtin_sqrt(rheo__dot3(of, of)) : sign / distance;
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = scale * (close ? of[axis] : found.from[axis]);
    return sign * distance;
}

double rheo__surface_distance(const rheo__surface *s, const double x[3], double limit, bool below, double normal[3])
{
    double outside2 = 0;
    uint32_t at[3];
    for (int axis = 0; axis < 3; axis++) {
        const double under = s->low[axis] - x[axis], over = -under - s->cell * s->cells[axis],
                     beyond = under > over ? under : over;
        outside2 += beyond > 0 ? beyond * beyond : 0;
        at[axis] = rheo__cell_along(s, x[axis], axis);
        normal[axis] = axis == 1;
    }
    const double margin = 0.8660254037844387 * s->cell * (1 + 1e-9); /* half the diagonal of a cell */
    const double middle = s->cell_distance[rheo__cell_at(s, at)], far = __builtin_sqrt(outside2) * (1 - 1e-9);
    if (!below && outside2 > 0 && far >= limit)
        return far;
    if (!below && outside2 == 0 && middle - margin >= limit)
        return middle - margin;
    if (below && outside2 == 0 && middle + margin <= limit)
        return middle + margin;
    return exact_distance(s, x, normal);
}
