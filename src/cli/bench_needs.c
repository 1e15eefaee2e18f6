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
 * In scheme summed a particle has a row with all of its n neighbours, so every pair is computed from both ends. The
 * list holds a few more pairs, those within its margin, which are not counted. Scheme sequential has n/2 pairs. Half
 * of the 27 cells around a particle holds 27/(4 pi/3) times as many candidates as the half sphere holds neighbours.
 */
typedef struct stage_model {
    const char *stage;
    double operations, values, words;                                     /* per particle */
    double entry_operations, roots, divisions, entry_values, entry_words; /* per neighbour, or per pair */
    double candidate_operations;                                          /* per candidate for a pair */
    bool in_substeps;                                                     /* all of this in every substep */
    bool memory;
} stage_model;

#define CANDIDATES_PER_PAIR (27 / 4.18879020478639098)

/* Largest ring that can stay in the caches from one step to the next, bytes. */
#define RING_IN_CACHE ((size_t)8 << 20)

/* Stages of scheme summed, or of several schemes. */
static const stage_model SUMMED[] = {
    /*
     * A list that lasts is only checked: its position and the present one 6, squared distance 5; squared speed 8, that
     * from the ball 8, margin 5, a comparison. Positions, velocity and margin read.
     */
    {"neighbours", .operations = 33, .values = 10},
    /*
     * A neighbour: difference 3, squared length 5, lower bound 1, shared by both parts. Impulse: difference of velocity 3,
     * weight 3, approach 7, share 4, impulse 4, along the direction 6, sum 1. Stiffness: difference of D^q 3, squared
     * length 5, K 6, sums and largest 12; rest length read, K written. Particles: D^q, positions and velocities into rank
     * order (21, 3 ids), read (12), velocities written and put back (4 + 7, an id), sums and wall_friction 4 (2).
     */
    {"viscosity", .operations = 4, .values = 21 + 12 + 11 + 2, .words = 4, .entry_operations = 63, .roots = 2,
     .divisions = 2, .entry_values = 2, .entry_words = 1},
    /* Squared speed, and the largest. */
    {"substeps", .operations = 6, .values = 3},
    /* v += substep g: 3 additions; v read and written. */
    {"gravity", .operations = 3, .values = 6, .in_substeps = true},
    /* x += substep v: both are read, x is written. */
    {"prediction", .operations = 6, .values = 9, .in_substeps = true},
    /*
     * A neighbour: difference 3, squared length 5, weight 3, both densities 4, closest 1, count 2; flow: new length 2,
     * tolerance 1, stretch 1, what stays 3, flow 3, lower bound 1, existence 2; rest length read and written. Particles:
     * positions into rank order (7, an id), read (3), pressures 6 (2), the density measured 4.
     */
    {"densities", .operations = 10, .values = 7 + 3 + 2, .words = 1, .entry_operations = 31, .roots = 1,
     .entry_values = 2, .entry_words = 1, .in_substeps = true},
    /*
     * A neighbour: difference 3, squared length 5, lower bound 1, direction 1; weight 3, push 6, along the direction 6;
     * stretch 1, force 3, existence 2, along the direction 6; rest length and K read. Particles: position and pressures
     * read (5), two accelerations written and read (16); velocity and position 12 (6 read, 6 written, an id).
     */
    {"forces", .operations = 12, .values = 5 + 16 + 12, .words = 1, .entry_operations = 37, .roots = 1,
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

/* Stages of scheme sequential. Those that are not here are as above. Entries are pairs. */
static const stage_model SEQUENTIAL[] = {
    /*
     * Cells: 3 multiplications, 3 x 2 comparisons; position read (3 values); key of 2 words written, read and written
     * again; two sorting passes (key and id read for counting and moving, and written: 2 + 3 + 3); positions into
     * rank order (id, 3 values read, 3 written, rank written); cells from the keys (2). Candidates: three
     * differences, 5 for the squared length, a comparison. Pairs: the partner written.
     */
    {"neighbours_start", .operations = 9, .values = 9, .words = 6 + 16 + 2 + 2, .candidate_operations = 9,
     .entry_words = 1},
    /*
     * The same, plus the squared distance of each pair written. Complete rows: partners are read twice, to count and
     * to fill two rows; the start of a row is written and read twice.
     */
    {"neighbours", .operations = 9, .values = 9, .words = 6 + 16 + 2 + 2 + 4, .candidate_operations = 9,
     .entry_values = 1, .entry_words = 1 + 2 + 2},
    /*
     * A pair: difference 3, squared length 5, weight 2, direction 3, its existence 2, approach 6 + 2 = 8, its sign 2,
     * impulse 4 + 2 + 1, along the direction 3 and its opposite 3, both ends 6; one root, one division.
     * Particles: positions and velocities into rank order (6 + 8 values, 2 ids), the sweep (8 read, 4 written),
     * velocities back (4 + 3, an id), row start.
     */
    {"viscosity", .entry_operations = 44, .roots = 1, .divisions = 1, .entry_words = 1, .values = 14 + 12 + 7,
     .words = 4},
    /*
     * Old spring of a pair: partners compared (1 operation, 2 words), old length read, new one written. Flow: root;
     * new length 2, tolerance 1, stretched 4, squeezed 4, flow 3, lower bound 2; length read and written, squared
     * distance read. Particles: id, old rank, its copy, three row starts.
     */
    {"springs", .operations = 1, .words = 7, .entry_operations = 1 + 16, .roots = 1, .entry_values = 5,
     .entry_words = 2},
    /*
     * A pair: kappa: difference of D^q 3, squared length 5, stiffness 1, sum 1, largest 2, kappa 2, half of it 1;
     * then difference 3, squared length 5, stretch 1, times kappa 1, existence of a direction 2, along it 3 and its
     * opposite 3, both ends 6, the other end's sum 1; two roots and a division; partner and rest length read.
     * Particles: positions and D^q into rank order (14 values, 2 ids), the sweep (8 read, 4 written), sums and
     * wall_friction 7 (2 values, 3 words), positions back and displacements 9 (3 + 4 read, 3 written, an id).
     */
    {"spring_displacement", .operations = 16, .values = 14 + 12 + 2 + 10, .words = 2 + 3 + 1 + 1,
     .entry_operations = 40, .roots = 2, .divisions = 1, .entry_values = 1, .entry_words = 1},
    /*
     * A neighbour (two per pair): difference 3, squared length 5, weight 2, coinciding 2, inside 2, direction 3, both
     * densities 4; pressure 3, along the direction 3 and its opposite 3, both ends 6; a root, a division; the row
     * read. Particles: positions into rank order (7, an id), the sweep (4 read, 4 written), pressures 6, the density
     * written and measured 4 (2), positions back and displacements 9 (10, an id), row start.
     */
    {"density", .operations = 19, .values = 7 + 8 + 2 + 10, .words = 3, .entry_operations = 72, .roots = 2,
     .divisions = 2, .entry_words = 2},
    /* v = (x - previous x)/step. */
    {"velocity", .operations = 6, .values = 9},
};

static const stage_model *find(const stage_model *models, size_t count, const char *stage)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(models[i].stage, stage) == 0)
            return &models[i];
    return NULL;
}

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
    const stage_model *m = NULL;
    double n = c->neighbours;
    if (strcmp(c->scheme, "sequential") == 0 &&
        (m = find(SEQUENTIAL, sizeof SEQUENTIAL / sizeof *SEQUENTIAL, stage)) != NULL)
        n /= 2;
    if (!m && strcmp(c->scheme, "positions") == 0 && strcmp(stage, "viscosity") == 0)
        return false; /* another stage of the same name */
    if (!m)
        m = find(SUMMED, sizeof SUMMED / sizeof *SUMMED, stage);
    if (!m)
        return false;
    const double times = m->in_substeps && c->substeps > 0 ? c->substeps : 1;
    needs->operations =
        times * (m->operations + n * m->entry_operations + n * CANDIDATES_PER_PAIR * m->candidate_operations);
    needs->roots = times * n * m->roots;
    needs->divisions = times * n * m->divisions;
    needs->bytes = times * (real * (m->values + n * m->entry_values) + 4 * (m->words + n * m->entry_words));
    needs->memory = m->memory && c->history_bytes > RING_IN_CACHE;
    return true;
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
