/*
 * Neighbour lists: all pairs closer than the support, in one fixed order that depends on the positions alone.
 *
 * Space is cut into cubic cells a little wider than the support. Particles are ranked by cell (y fastest, then x,
 * then z) and within a cell by id. A line is the column of occupied cells with the same x and z; its colour is
 * (x mod 3) + 3 (z mod 3). The particles of a line have neighbours only in the nine lines around it, so two lines of
 * one colour share no particle: walking the lines of one colour side by side gives the result of the plain loop over
 * lines, rows and partners.
 *
 * Space is unbounded: cells are found by sorting keys, never by a grid in memory. Beyond 2^20 cells from the origin
 * particles share the outermost cells, which costs time but loses no pair.
 */
#ifndef RHEO__SPACE_NEIGHBOURS_H
#define RHEO__SPACE_NEIGHBOURS_H

#include "core/real.h"
#include "core/springs.h"
#include "space/period.h"

enum {
    RHEO__COLOURS = 9,
    RHEO__PADDING = 16, /* extra room in the arrays of a list, which are read and written in whole vectors */
};

typedef struct rheo__line {
    uint32_t first, end; /* ranks */
} rheo__line;

/* An image whose home is in the order of cells; next: the number of another image of that particle, or UINT32_MAX. */
typedef struct rheo__list_image {
    rheo__image at;
    uint32_t next;
} rheo__list_image;

/* Derived by every call; the memory is kept. */
typedef struct rheo__neighbours {
    rheo__line *line; /* by group, then in rank order; whole rows alone have none */
    uint32_t line_count;
    /*
     * The lines of a group have one colour and can be walked side by side. Groups must be walked one after another:
     * of two lines that share particles, the one with the lower colour is in the earlier group.
     */
    uint32_t *group_start; /* group_count + 1: where each group's lines begin */
    uint32_t group_count;
    uint32_t longest_row; /* partners */

    rheo_real *distance2; /* with rows: parallel to the pairs, their squared distances; room for RHEO__PADDING more */
    uint32_t *row_start;  /* rows + 1: all partners of rank i, ascending; the row of its pairs is the tail */
    uint32_t *row;        /* ends with the number of rows, as the pairs do: see space/walk.h */

    /* In periodic space row has images, too: that with number k is rows + k. */
    rheo__list_image *image;
    uint32_t *first_image; /* by rank: number of its last image, or UINT32_MAX */
    uint32_t images;

    uint64_t *key, *key_other; /* cell of each particle, in the order of ids and in rank order */
    uint32_t *id_other;
    uint32_t
        *block_rank;    /* by rank in the order of cells, then by image: the rank after rows are laid out in blocks */
    uint64_t *cell_key; /* occupied cells, ascending */
    uint32_t *cell_start; /* first rank of each; one more at the end */
    rheo__line *line_other;
    uint8_t *line_colour;
    uint32_t *line_group;
    rheo_real *x, *y, *z; /* positions in rank order, padded; then the candidates of a cell */
    rheo_real *reach;     /* likewise: half the support, and the margin */
    size_t particle_capacity, row_capacity, distance_capacity, image_capacity, block_rank_capacity;
} rheo__neighbours;

/*
 * Makes the list for particles at `position` (count x 3, by id): each pair once, in the row of its lower rank, and
 * the lines. with_rows: also the whole rows and the squared distances. False: no memory; the list is then unusable,
 * the state unchanged.
 */
bool rheo__neighbours_build(rheo__neighbours *list, rheo__pairs *pairs, const rheo_allocator *allocator,
                            uint32_t count, const rheo_real *position, double support, bool with_rows);
/*
 * Makes only the whole rows, row_start and row, for sums that need no pairs. Tests all cells around a cell; with many
 * neighbours this costs less than making rows from pairs. Of `ranks` only id_of and rank_of are set. margin: NULL, or
 * lengths by id; particles i and j are then neighbours below the distance support + margin[i] + margin[j]. period: NULL
 * in open space; periods must be at least twice the largest of these distances.
 */
bool rheo__neighbours_build_rows(rheo__neighbours *list, rheo__pairs *ranks, const rheo_allocator *allocator,
                                 uint32_t count, const rheo_real *position, double support, const rheo_real *margin,
                                 const rheo__period *period);
/*
 * Where a particle is in two lists, as an index of points (RHEO__POINT_VALUES x rank): now in the lower half, before in
 * the upper half.
 */
typedef uint64_t rheo__place;

/*
 * Lays whole rows out in blocks: deals the ranks again, so that rows of a block have about one length (id_of, rank_of), sets
 * width and start of `pairs`, and makes room for the partners. False: no memory. One of the others then writes the
 * rows; each keeps its partners in the order of cells.
 */
bool rheo__neighbours_lay_out(rheo__neighbours *list, rheo__pairs *pairs, const rheo_allocator *allocator);
void rheo__neighbours_write_rows(const rheo__neighbours *list, rheo__pairs *pairs);
/*
 * Writes the rows of now->pairs and their rest lengths, for which there must be room. Springs keep their rest lengths;
 * those of pairs that are not in the list are lost. The old rows must have forgotten their images. Workspace: a place of
 * every row and image, and a value of every rank of the old list, that of its idle entries included.
 */
void rheo__neighbours_write_springs(const rheo__neighbours *list, rheo__springs *now, const rheo__springs *old,
                                    rheo__place *place, rheo_real *carried);
void rheo__neighbours_release(rheo__neighbours *list, const rheo_allocator *allocator);

#endif
