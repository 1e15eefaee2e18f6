/*
 * The least work of each stage, counted from its equations (docs/model.md): operations, square roots, divisions and
 * bytes. The rest of the measured time is data lookup, moves into and out of vectors, lanes without a pair, and
 * dependencies between pairs. A stage near its limit can only become faster with a new algorithm.
 */
#include "cli/bench.h"

#include <string.h>

/*
 * Operations are additions, multiplications, comparisons and selections of one number; an operation on a vector
 * counts three times. Values (numbers of the state) and words (ranks and ids, 4 bytes) count once for each loop of
 * the stage that reads or writes them, in order or through an index. A sweep over rows reads the positions of
 * partners many times. They stay in the nearest cache and are not counted again.
 *
 * A particle has a row with all of its n neighbours, so every pair is computed from both ends. The list holds a few
 * more pairs, those within its margin, which are not counted.
 */
typedef struct stage_model {
    const char *stage;
    double operations, values, words;                                     /* per particle */
    double entry_operations, roots, divisions, entry_values, entry_words; /* per neighbour */
    bool in_substeps;                                                     /* all of this in every substep */
    bool memory;
} stage_model;

/* Largest ring that can stay in the caches from one step to the next, bytes. */
#define RING_IN_CACHE ((size_t)8 << 20)

static const stage_model MODEL[] = {
    /*
     * A list that lasts is only checked: its position and the present one 6, squared distance 5; squared speed 8, that
     * from the ball 8, margin 5, a comparison. Positions, velocity and margin read.
     */
    {"neighbours", .operations = 33, .values = 10},
    /*
     * A neighbour: difference of D^q 3, squared length 5, K 2, the same of the last step 10; stretch: difference 3,
     * squared length 5, rest length that keeps the force 5, its condition 3; sums 5; partner, rest length read, rest
     * length and K written. Particles: D^q of two steps into rank order (14, 2 ids), read with the position (12), sums
     * and wall_friction 4 (3).
     */
    {"stiffness", .operations = 4, .values = 14 + 12 + 3, .words = 3, .entry_operations = 41, .roots = 3,
     .divisions = 1, .entry_values = 3, .entry_words = 1},
    /*
     * A neighbour: differences 6, squared length 5, weight 2, approach 6, its existence 5, impulse 6, along the
     * direction 6, sum 1. Particles: positions and velocities into rank order (14, 2 ids), read (8), velocities written
     * and put back (4 + 7, an id).
     */
    {"viscosity", .values = 14 + 8 + 11, .words = 3, .entry_operations = 37, .roots = 1, .divisions = 1,
     .entry_words = 1},
    /* Squared speed, and the largest. */
    {"substeps", .operations = 6, .values = 3},
    /* v += substep g: 3 additions; v read and written. */
    {"gravity", .operations = 3, .values = 6, .in_substeps = true},
    /* x += substep v: both are read, x is written. */
    {"prediction", .operations = 6, .values = 9, .in_substeps = true},
    /*
     * A neighbour: difference 3, squared length 5, weight 2, inside 3, both densities 4, coinciding 2; flow: new length
     * 2, tolerance 1, stretched 3, squeezed 3, flow 3, lower bound 1, inside 4, count 2; rest length read and written.
     * Particles: positions into rank order (7, an id), read (4), pressures 6 (2), the density measured 4.
     */
    {"densities", .operations = 10, .values = 7 + 4 + 2, .words = 1, .entry_operations = 38, .roots = 1,
     .entry_values = 2, .entry_words = 1, .in_substeps = true},
    /*
     * A neighbour: difference 3, squared length 5; weight 2, push 6, inside 3, along the direction 6; stretch 1, force
     * 3, existence 3, along the direction 6; rest length and K read. Particles: position and pressures read (5), two
     * accelerations written and read (16); velocity and position 12 (6 read, 6 written, an id).
     */
    {"forces", .operations = 12, .values = 5 + 16 + 12, .words = 1, .entry_operations = 38, .roots = 1,
     .divisions = 1, .entry_values = 2, .entry_words = 1, .in_substeps = true},
    /* Squared distance from the ball, and a comparison. Particles inside are few and not counted. */
    {"ball", .operations = 9, .values = 3, .in_substeps = true},
    /* Distance from each of five walls (6), and a comparison. Particles at a wall are few and not counted. */
    {"walls", .operations = 35, .values = 3, .in_substeps = true},
    /* A row of the ring is written: the velocity read, the row fetched and written. */
    {"history", .values = 9, .memory = true},
    /*
     * The rest of a step: positions and velocities are copied (12), checked for NaN and infinity (6 read),
     * and measured: speed, largest speed, energies, mean position (6 read, about 16 operations).
     */
    {"", .operations = 16 + 6, .values = 24},
};

bool cli_bench_stage_needs(const cli_bench_case *c, const char *stage, cli_bench_needs *needs)
{
    *needs = (cli_bench_needs){0};
    const double real = sizeof(rheo_real);
    if (strcmp(stage, "fractional_derivative") == 0 && (!*c->kind || strcmp(c->kind, "window") == 0)) {
        /*
         * A multiplication and an addition of 3 values for each of d + 1 rows. A pass over the ring computes the sums
         * of 8 steps, so a step reads an eighth of it, and writes and reads one sum. The rows that are newer than the
         * pass, 3.5 on average, are read again. D^q is written.
         */
        const double rows = c->window + 1.;
        needs->operations = 6 * rows + 3;
        needs->bytes = real * 3 * (rows / 8 + 3.5 + 2 + 1);
        needs->memory = c->history_bytes > RING_IN_CACHE;
        return true;
    }
    for (size_t i = 0; i < sizeof MODEL / sizeof *MODEL; i++) {
        const stage_model *m = &MODEL[i];
        if (strcmp(m->stage, stage) != 0)
            continue;
        const double n = c->neighbours, times = m->in_substeps && c->substeps > 0 ? c->substeps : 1;
        needs->operations = times * (m->operations + n * m->entry_operations);
        needs->roots = times * n * m->roots;
        needs->divisions = times * n * m->divisions;
        needs->bytes = times * (real * (m->values + n * m->entry_values) + 4 * (m->words + n * m->entry_words));
        needs->memory = m->memory && c->history_bytes > RING_IN_CACHE;
        return true;
    }
    return false;
}

/* Arithmetic, roots with divisions (in one unit), and bytes overlap, so the slowest of the three sets the limit. */
double cli_bench_limit(const cli_bench_limits *limits, const cli_bench_needs *needs, const char **bound)
{
    const double arithmetic = needs->operations / limits->arithmetic;
    const double roots = needs->roots / limits->root + needs->divisions / limits->division;
    const double bytes = needs->bytes / (needs->memory ? limits->memory : limits->cache);
    *bound = "arithmetic";
    double longest = arithmetic;
    if (roots > longest) {
        longest = roots;
        *bound = "roots, divisions";
    }
    if (bytes > longest) {
        longest = bytes;
        *bound = needs->memory ? "memory" : "caches";
    }
    return longest;
}
