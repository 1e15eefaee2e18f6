/*
 * What a machine can do at best, and what each stage of a step needs at least: the share of the one in the other
 * tells how far a stage is from the fastest that its work could be done.
 *
 * Limits are measured beside the benchmark, since a machine's speed changes with what else runs on it: additions and
 * multiplications that wait for nothing, square roots and divisions, in vectors as wide as those of the kernels in
 * use and without fused operations, which the model may not use; and reading and copying arrays larger than the
 * caches, and of the size that a field of 20 000 particles has.
 *
 * The needs below count what the stage's formulas (docs/model.md) ask for; finding the data, moving it in and out of
 * vectors, lanes that have no pair and waiting for what a pair before has left are the difference to what is
 * measured. So a share near 1 leaves nothing to be had but by another algorithm.
 */
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if (defined(__GNUC__) || defined(__clang__)) && defined(RHEO__X86_VARIANTS)
#include <immintrin.h>
#endif

/* ---- Limits of the machine ---- */

/*
 * Each measurement is one loop over registers: so many chains that none waits for another, and few enough to stay in
 * 16 registers; each from another start, or the compiler would make one of them. BARRIER keeps the compiler from
 * making vectors of plain numbers. Returns the results of a round.
 */
static rheo_real sink[16]; /* where results go; the compiler is told that something reads them */
#define KEEP(value)                                    \
    do {                                               \
        memcpy(sink, &(value), sizeof(value));         \
        __asm__ volatile("" : : "r"(sink) : "memory"); \
    } while (0)
#define LIMIT_LOOPS(NAME, TARGET, TYPE, ALL, ROOT, BARRIER)                                                  \
    TARGET static double arithmetic_##NAME(uint64_t rounds)                                                  \
    {                                                                                                        \
        TYPE factor = ALL(1.0000001), term = ALL(1e-6);                                                      \
        TYPE a0 = ALL(1.10), a1 = ALL(1.11), a2 = ALL(1.12), a3 = ALL(1.13), a4 = ALL(1.14), a5 = ALL(1.15), \
             a6 = ALL(1.16);                                                                                 \
        TYPE m0 = ALL(1.10), m1 = ALL(1.11), m2 = ALL(1.12), m3 = ALL(1.13), m4 = ALL(1.14), m5 = ALL(1.15), \
             m6 = ALL(1.16);                                                                                 \
        BARRIER(factor);                                                                                     \
        BARRIER(term);                                                                                       \
        for (uint64_t i = 0; i < rounds; i++) {                                                              \
            a0 = a0 + term;                                                                                  \
            m0 = m0 * factor;                                                                                \
            a1 = a1 + term;                                                                                  \
            m1 = m1 * factor;                                                                                \
            a2 = a2 + term;                                                                                  \
            m2 = m2 * factor;                                                                                \
            a3 = a3 + term;                                                                                  \
            m3 = m3 * factor;                                                                                \
            a4 = a4 + term;                                                                                  \
            m4 = m4 * factor;                                                                                \
            a5 = a5 + term;                                                                                  \
            m5 = m5 * factor;                                                                                \
            a6 = a6 + term;                                                                                  \
            m6 = m6 * factor;                                                                                \
            BARRIER(a0);                                                                                     \
            BARRIER(a1);                                                                                     \
            BARRIER(a2);                                                                                     \
            BARRIER(a3);                                                                                     \
            BARRIER(a4);                                                                                     \
            BARRIER(a5);                                                                                     \
            BARRIER(a6);                                                                                     \
            BARRIER(m0);                                                                                     \
            BARRIER(m1);                                                                                     \
            BARRIER(m2);                                                                                     \
            BARRIER(m3);                                                                                     \
            BARRIER(m4);                                                                                     \
            BARRIER(m5);                                                                                     \
            BARRIER(m6);                                                                                     \
        }                                                                                                    \
        TYPE sum = a0 + a1 + a2 + a3 + a4 + a5 + a6 + m0 + m1 + m2 + m3 + m4 + m5 + m6;                      \
        KEEP(sum);                                                                                           \
        return 14 * (double)(sizeof(TYPE) / sizeof(rheo_real));                                              \
    }                                                                                                        \
    TARGET static double roots_##NAME(uint64_t rounds)                                                       \
    {                                                                                                        \
        TYPE term = ALL(1.7);                                                                                \
        TYPE a0 = ALL(1.10), a1 = ALL(1.11), a2 = ALL(1.12), a3 = ALL(1.13), a4 = ALL(1.14), a5 = ALL(1.15), \
             a6 = ALL(1.16);                                                                                 \
        BARRIER(term);                                                                                       \
        for (uint64_t i = 0; i < rounds; i++) {                                                              \
            a0 = ROOT(a0 + term);                                                                            \
            a1 = ROOT(a1 + term);                                                                            \
            a2 = ROOT(a2 + term);                                                                            \
            a3 = ROOT(a3 + term);                                                                            \
            a4 = ROOT(a4 + term);                                                                            \
            a5 = ROOT(a5 + term);                                                                            \
            a6 = ROOT(a6 + term);                                                                            \
            BARRIER(a0);                                                                                     \
            BARRIER(a1);                                                                                     \
            BARRIER(a2);                                                                                     \
            BARRIER(a3);                                                                                     \
            BARRIER(a4);                                                                                     \
            BARRIER(a5);                                                                                     \
            BARRIER(a6);                                                                                     \
        }                                                                                                    \
        TYPE sum = a0 + a1 + a2 + a3 + a4 + a5 + a6;                                                         \
        KEEP(sum);                                                                                           \
        return 7 * (double)(sizeof(TYPE) / sizeof(rheo_real));                                               \
    }                                                                                                        \
    TARGET static double divisions_##NAME(uint64_t rounds)                                                   \
    {                                                                                                        \
        TYPE term = ALL(1.7);                                                                                \
        TYPE a0 = ALL(1.10), a1 = ALL(1.11), a2 = ALL(1.12), a3 = ALL(1.13), a4 = ALL(1.14), a5 = ALL(1.15), \
             a6 = ALL(1.16);                                                                                 \
        BARRIER(term);                                                                                       \
        for (uint64_t i = 0; i < rounds; i++) {                                                              \
            a0 = term / a0;                                                                                  \
            a1 = term / a1;                                                                                  \
            a2 = term / a2;                                                                                  \
            a3 = term / a3;                                                                                  \
            a4 = term / a4;                                                                                  \
            a5 = term / a5;                                                                                  \
            a6 = term / a6;                                                                                  \
            BARRIER(a0);                                                                                     \
            BARRIER(a1);                                                                                     \
            BARRIER(a2);                                                                                     \
            BARRIER(a3);                                                                                     \
            BARRIER(a4);                                                                                     \
            BARRIER(a5);                                                                                     \
            BARRIER(a6);                                                                                     \
        }                                                                                                    \
        TYPE sum = a0 + a1 + a2 + a3 + a4 + a5 + a6;                                                         \
        KEEP(sum);                                                                                           \
        return 7 * (double)(sizeof(TYPE) / sizeof(rheo_real));                                               \
    }

#define NO_TARGET
#if RHEO_DOUBLE
#define ROOT_ONE(a) __builtin_sqrt(a)
#else
#define ROOT_ONE(a) __builtin_sqrtf(a)
#endif
#define ALL_ONE(value) ((rheo_real)(value))
#define ALL_LANES(value) ((rheo_real)(value) - (lanes){0})
#if defined(__x86_64__) || defined(__i386__)
#define BARRIER_ONE(a) __asm__("" : "+x"(a))
#elif defined(__aarch64__)
#define BARRIER_ONE(a) __asm__("" : "+w"(a))
#else
#define BARRIER_ONE(a) (void)(a)
#endif
#define BARRIER_NONE(a) (void)(a)

LIMIT_LOOPS(scalar, NO_TARGET, rheo_real, ALL_ONE, ROOT_ONE, BARRIER_ONE)

typedef rheo_real lanes_portable __attribute__((vector_size(4 * sizeof(rheo_real))));
static inline lanes_portable root_portable(lanes_portable a)
{
#if defined(__SSE2__) && defined(RHEO__X86_VARIANTS) && !RHEO_DOUBLE
    return (lanes_portable)_mm_sqrt_ps((__m128)a);
#else
    for (int lane = 0; lane < 4; lane++)
        a[lane] = ROOT_ONE(a[lane]);
    return a;
#endif
}
#define lanes lanes_portable
LIMIT_LOOPS(portable, NO_TARGET, lanes_portable, ALL_LANES, root_portable, BARRIER_NONE)
#undef lanes

#ifdef RHEO__X86_VARIANTS
typedef rheo_real lanes_avx2 __attribute__((vector_size(32)));
typedef rheo_real lanes_avx512 __attribute__((vector_size(64)));
#if RHEO_DOUBLE
#define ROOT_AVX2(a) (lanes_avx2) _mm256_sqrt_pd((__m256d)(a))
#define ROOT_AVX512(a) (lanes_avx512) _mm512_sqrt_pd((__m512d)(a))
#else
#define ROOT_AVX2(a) (lanes_avx2) _mm256_sqrt_ps((__m256)(a))
#define ROOT_AVX512(a) (lanes_avx512) _mm512_sqrt_ps((__m512)(a))
#endif
#define lanes lanes_avx2
LIMIT_LOOPS(avx2, __attribute__((target("avx2"))), lanes_avx2, ALL_LANES, ROOT_AVX2, BARRIER_NONE)
#undef lanes
#define lanes lanes_avx512
LIMIT_LOOPS(avx512, __attribute__((target("avx512f"))), lanes_avx512, ALL_LANES, ROOT_AVX512, BARRIER_NONE)
#undef lanes
#endif

typedef double limit_loop(uint64_t rounds); /* returns results a round */

static const struct {
    const char *simd;
    limit_loop *arithmetic, *roots, *divisions;
} LOOPS[] = {
    {"scalar", arithmetic_scalar, roots_scalar, divisions_scalar},
    {"portable", arithmetic_portable, roots_portable, divisions_portable},
#ifdef RHEO__X86_VARIANTS
    {"avx2", arithmetic_avx2, roots_avx2, divisions_avx2},
    {"avx512", arithmetic_avx512, roots_avx512, divisions_avx512},
#endif
};

enum { TRIES = 15 };

/* Results a nanosecond; the best of several tries, since this is a limit. */
static double rate_of(limit_loop *loop)
{
    uint64_t rounds = 1000;
    double seconds = 0, best = 0;
    while (seconds < .004) {
        rounds *= 2;
        const double start = cli_now();
        loop(rounds);
        seconds = cli_now() - start;
    }
    for (int i = 0; i < TRIES; i++) {
        const double start = cli_now(), results = loop(rounds), end = cli_now();
        best = fmax(best, (double)rounds * results / (end - start));
    }
    return 1e-9 * best;
}

/* Every word of an array, in as many chains as keep any machine busy. */
static uint64_t read_array(const char *from, size_t bytes)
{
    typedef uint64_t words __attribute__((vector_size(16)));
    words a = {0}, b = a, c = a, d = a, e, f, g, h;
    for (const char *end = from + bytes; from < end; from += 4 * sizeof(words)) {
        memcpy(&e, from, sizeof e);
        memcpy(&f, from + sizeof e, sizeof f);
        memcpy(&g, from + 2 * sizeof e, sizeof g);
        memcpy(&h, from + 3 * sizeof e, sizeof h);
        a ^= e;
        b ^= f;
        c ^= g;
        d ^= h;
    }
    a ^= b ^ c ^ d;
    return a[0] ^ a[1];
}

/* GB/s of reading an array, and of copying half of it to the other half, so many times for each measurement. */
static void bandwidth_of(char *memory, size_t bytes, uint64_t times, double *read, double *copy)
{
    static volatile uint64_t word;
    *read = *copy = 0;
    for (int i = 0; i < TRIES; i++) {
        const double start = cli_now();
        for (uint64_t n = 0; n < times; n++)
            word = read_array(memory, bytes);
        const double middle = cli_now();
        for (uint64_t n = 0; n < times; n++) {
            memcpy(memory + bytes / 2, memory, bytes / 2);
            word = (uint64_t)memory[bytes - 1 - n % 16];
        }
        const double end = cli_now(), moved = 1e-9 * (double)bytes * (double)times;
        *read = fmax(*read, moved / (middle - start));
        *copy = fmax(*copy, moved / (end - middle));
    }
    (void)word;
}

bool bench_measure_limits(bench_limits *limits)
{
    const size_t cache = (size_t)256 << 10;
    size_t large = (size_t)256 << 20;
    char *memory = NULL;
    while (!memory && large >= (size_t)16 << 20) {
        memory = malloc(large);
        if (!memory)
            large /= 2;
    }
    if (!memory)
        return false;
    memset(memory, 1, large);
    bandwidth_of(memory, large, 1, &limits->memory_read, &limits->memory_copy);
    bandwidth_of(memory, cache, large / cache / 16, &limits->cache_read, &limits->cache_copy);
    free(memory);
    limits->memory_bytes = (double)large;
    limits->cache_bytes = (double)cache;
    limits->memory = fmax(limits->memory_read, limits->memory_copy);
    limits->cache = fmax(limits->cache_read, limits->cache_copy);
    size_t loops = 0;
    for (size_t i = 0; i < sizeof LOOPS / sizeof *LOOPS; i++)
        if (strcmp(LOOPS[i].simd, rheo_simd()) == 0)
            loops = i;
    limits->arithmetic = rate_of(LOOPS[loops].arithmetic);
    limits->root = rate_of(LOOPS[loops].roots);
    limits->division = rate_of(LOOPS[loops].divisions);
    return true;
}

/* ---- Needs of the stages ---- */

/*
 * Operations are additions, multiplications, comparisons and choices of one number; those on three components count
 * three times. Values (numbers of the state) and words (ranks, ids: 4 bytes) count once for each loop of the stage
 * that reads or writes them, in order or through an index: what a sweep over pairs touches again and again (positions
 * of partners) stays in the nearest cache and counts for the sweep once, read and written.
 *
 * A particle has n neighbours, so n/2 pairs belong to it. The half of the 27 cells around a particle holds as many
 * candidates as 27/(4 pi/3) half spheres of neighbours.
 */
typedef struct stage_model {
    const char *stage;
    double operations, values, words;                                  /* a particle */
    double pair_operations, roots, divisions, pair_values, pair_words; /* a pair */
    double candidate_operations;
    bool memory;
} stage_model;

/* Bytes of a ring that may stay in the caches from one step to the next. */
#define RING_IN_CACHE ((size_t)8 << 20)

#define CANDIDATES_PER_PAIR (27 / 4.18879020478639098)

static const stage_model MODEL[] = {
    /* v += step g: 3 additions; v read and written. */
    {"gravity", .operations = 3, .values = 6},
    /*
     * Cells: 3 multiplications and 3 times two comparisons; the position read (3 values), key written and made again
     * (2 words each, written, read, written), two passes of sorting (key and id read for counting and moving, and
     * written: 2 + 3 + 3), positions into rank order (id, 3 values read, 3 written, rank written), cells from the
     * keys (2). Pairs: three differences, 5 for the squared length, a comparison for each candidate; the partner
     * written.
     */
    {"neighbours_start", .operations = 9, .values = 9, .words = 6 + 16 + 2 + 2, .candidate_operations = 9,
     .pair_words = 1},
    /*
     * The same, and the squared distance of each pair is kept; then whole rows: partners are read twice, once to
     * count and once to fill two rows, and a row's start is written and read twice.
     */
    {"neighbours", .operations = 9, .values = 9, .words = 6 + 16 + 2 + 2 + 4, .candidate_operations = 9,
     .pair_values = 1, .pair_words = 1 + 2 + 2},
    /*
     * A pair: difference 3, squared length 5, weight 2, direction 3, is there one 2, approach 6 + 2 = 8, if it is one
     * 2, impulse 4 + 2 + 1, along the direction 3 and its opposite 3, both ends 6; one root, one division.
     * Particles: positions and velocities into rank order (6 + 8 values, 2 ids), the sweep (8 read, 4 written),
     * velocities back (4 + 3, an id), row start.
     */
    {"viscosity", .pair_operations = 44, .roots = 1, .divisions = 1, .pair_words = 1, .values = 14 + 12 + 7,
     .words = 4},
    /* x += step v: read both, written one. */
    {"prediction", .operations = 6, .values = 9},
    /*
     * A pair's old place: its partner now and then compared (1 operation, 2 words), the old length read and the new
     * one written. Flow: root; the length if new 2, tolerated 1, stretched 4, squeezed 4, flow 3, not below zero 2;
     * the length read and written, the squared distance read. Particles: id, old rank, its copy, three row starts.
     */
    {"springs", .operations = 1, .words = 7, .pair_operations = 1 + 16, .roots = 1, .pair_values = 5,
     .pair_words = 2},
    /*
     * A pair: kappa: difference of D^q 3, squared length 5, stiffness 1, sum 1, largest 2, kappa 2, half of it 1;
     * then difference 3, squared length 5, stretch 1, times kappa 1, if there is a direction 2, along it 3 and its
     * opposite 3, both ends 6, the other end's sum 1; two roots and a division; partner and rest length read.
     * Particles: positions and D^q into rank order (14 values, 2 ids), the sweep (8 read, 4 written), sums and wall_friction 7
     * (2 values, 3 words), positions back and how far they moved 9 (3 + 4 read, 3 written, an id).
     */
    {"spring_displacement", .operations = 16, .values = 14 + 12 + 2 + 10, .words = 2 + 3 + 1 + 1,
     .pair_operations = 40, .roots = 2, .divisions = 1, .pair_values = 1, .pair_words = 1},
    /*
     * A neighbour, twice a pair: difference 3, squared length 5, weight 2, coinciding 2, inside 2, direction 3, both
     * densities 4; pressure 3, along the direction 3 and its opposite 3, both ends 6; a root, a division; the row
     * read. Particles: positions into rank order (7, an id), the sweep (4 read, 4 written), pressures 6, the density
     * written and looked at 4 (2), positions back and how far they moved 9 (10, an id), row start.
     */
    {"density", .operations = 19, .values = 7 + 8 + 2 + 10, .words = 3, .pair_operations = 72, .roots = 2,
     .divisions = 2, .pair_words = 2},
    /* v = (x - x before)/step. */
    {"velocity", .operations = 6, .values = 9},
    /* Squared distance from the ball, and whether it is inside; the few that are inside are left out. */
    {"ball", .operations = 9, .values = 3, .words = 1},
    /* Distance from each of five walls (6) and a comparison; the few that are at one are left out. */
    {"walls", .operations = 35, .values = 3},
    /* A row of the ring is written: the velocity read, the row fetched and written. */
    {"history", .values = 9, .memory = true},
    /*
     * The rest of a step: positions and velocities are copied (12), looked through for what is no number (6 read),
     * and measured: speed, its largest, energies, mean position (6 read, some 16 operations).
     */
    {"", .operations = 16 + 6, .values = 24},
};

bool bench_stage_needs(const bench_case *c, const char *stage, bench_needs *needs)
{
    *needs = (bench_needs){0};
    const double real = sizeof(rheo_real);
    if (strcmp(stage, "fractional_derivative") == 0 && (!*c->kind || strcmp(c->kind, "window") == 0)) {
        /*
         * Every one of d + 1 rows a multiplication and an addition of 3 values, once and for all. A pass over the
         * ring makes the sums of 8 steps, so a step reads an eighth of it, and writes and reads one sum; the rows
         * that came since, 3.5 of them on average, are read again; D^q is written.
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
        const double pairs = c->neighbours / 2, candidates = pairs * CANDIDATES_PER_PAIR;
        needs->operations = m->operations + pairs * m->pair_operations + candidates * m->candidate_operations;
        needs->roots = pairs * m->roots;
        needs->divisions = pairs * m->divisions;
        needs->bytes = real * (m->values + pairs * m->pair_values) + 4 * (m->words + pairs * m->pair_words);
        needs->memory = m->memory && c->history_bytes > RING_IN_CACHE;
        return true;
    }
    return false;
}

/* Arithmetic, roots with divisions (one unit does both), and bytes can go on side by side: the longest sets it. */
double bench_limit(const bench_limits *limits, const bench_needs *needs, const char **bound)
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
