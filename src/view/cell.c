/* Finds the segments of the surface on the faces of a cell. */
#include "view/cell.h"

#include <stdbool.h>

int rheo__cell_edge_low(int edge)
{
    const int a = edge / 4, u = edge & 1, v = edge >> 1 & 1;
    return u << (a + 1) % 3 | v << (a + 2) % 3;
}

uint32_t rheo__cell_edge_faces(int edge)
{
    const int a = edge / 4, u = edge & 1, v = edge >> 1 & 1;
    return 1U << (2 * ((a + 1) % 3) + u) | 1U << (2 * ((a + 2) % 3) + v);
}

/* Corner k of a face, anticlockwise seen from outside the cell. */
static int face_corner(int face, int k)
{
    const int a = face / 2, side = face & 1, p = (a + 1) % 3, q = (a + 2) % 3;
    static const int along[4] = {0, 1, 1, 0}, across[4] = {0, 0, 1, 1};
    return side << a | along[k] << (side ? p : q) | across[k] << (side ? q : p);
}

static int edge_between(int c, int d)
{
    const int a = (c ^ d) == 1 ? 0 : (c ^ d) == 2 ? 1 : 2, low = c & d;
    return 4 * a + (low >> (a + 1) % 3 & 1) + 2 * (low >> (a + 2) % 3 & 1);
}

void rheo__cell_add_segments(int face, const double v[RHEO__CELL_CORNERS], int next[RHEO__CELL_EDGES])
{
    int enter[2], leave[2], enters = 0, leaves = 0, corner[4];
    for (int k = 0; k < 4; k++)
        corner[k] = face_corner(face, k);
    for (int k = 0; k < 4; k++) {
        const int c = corner[k], d = corner[(k + 1) % 4];
        if (v[c] < 0 && v[d] >= 0)
            enter[enters++] = edge_between(c, d);
        else if (v[c] >= 0 && v[d] < 0)
            leave[leaves++] = edge_between(c, d);
    }
    if (enters == 1) {
        next[enter[0]] = leave[0];
    } else if (enters == 2) {
        /* Entries and exits alternate. The first is an entry unless corner 0 is inside. */
        const bool leaves_first = v[corner[0]] >= 0;
        const double even = v[corner[0]] * v[corner[2]], odd = v[corner[1]] * v[corner[3]];
        const bool joined = leaves_first ? even > odd : odd > even;
        for (int k = 0; k < 2; k++) {
            const int own = leaves_first ? (k + 1) % 2 : k; /* the exit that follows this entry */
            next[enter[k]] = leave[joined ? (own + 1) % 2 : own];
        }
    }
}
