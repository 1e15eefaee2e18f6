/*
 * Measures the peak rates of one core of this machine: additions and multiplications, square roots, divisions, and
 * bytes read and copied. The benchmark measures them in the same run, because other processes slow a machine down.
 *
 * Arithmetic uses vectors as wide as those of the SIMD variant in use, without fused operations, which the model must
 * not use. Bytes are read and copied in arrays larger than the caches, and in arrays as large as a field of 20 000
 * particles.
 */
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if (defined(__GNUC__) || defined(__clang__)) && defined(RHEO__X86_VARIANTS)
#include <immintrin.h>
#endif

/* ---- Arithmetic ---- */

/*
 * Every measurement is one loop over registers with seven independent chains of operations (and seven more for
 * multiplications). Seven chains hide the latency and fit into 16 registers. The chains start from different values,
 * or the compiler would merge them. BARRIER stops the compiler from turning scalars into vectors. A loop returns its
 * number of results per iteration.
 */
static rheo_real sink[16]; /* target of stores, so that the compiler cannot drop the results */
#define KEEP(value)                                    \
    do {                                               \
        memcpy(sink, &(value), sizeof(value));         \
        __asm__ volatile("" : : "r"(sink) : "memory"); \
    } while (0)
#define BEGIN_CHAINS(TYPE, c, ALL)                                                                                   \
    TYPE c##0 = ALL(1.10), c##1 = ALL(1.11), c##2 = ALL(1.12), c##3 = ALL(1.13), c##4 = ALL(1.14), c##5 = ALL(1.15), \
         c##6 = ALL(1.16)
#define SUM_OF(c) (c##0 + c##1 + c##2 + c##3 + c##4 + c##5 + c##6)
#define HOLD(BARRIER, c) \
    BARRIER(c##0);       \
    BARRIER(c##1);       \
    BARRIER(c##2);       \
    BARRIER(c##3);       \
    BARRIER(c##4);       \
    BARRIER(c##5);       \
    BARRIER(c##6)
#define EACH_CHAIN(WORK, ...) \
    WORK(0, __VA_ARGS__);     \
    WORK(1, __VA_ARGS__);     \
    WORK(2, __VA_ARGS__);     \
    WORK(3, __VA_ARGS__);     \
    WORK(4, __VA_ARGS__);     \
    WORK(5, __VA_ARGS__);     \
    WORK(6, __VA_ARGS__)
#define ADD_AND_MULTIPLY(i, unused) \
    a##i = a##i + term;             \
    m##i = m##i * factor
#define TAKE_ROOT(i, ROOT) a##i = ROOT(a##i + term)
#define DIVIDE(i, unused) a##i = term / a##i

/* A loop that uses the chains a only. */
#define LIMIT_LOOP(NAME, TARGET, TYPE, ALL, BARRIER, WORK, ROOT) \
    TARGET static double NAME(uint64_t rounds)                   \
    {                                                            \
        TYPE term = ALL(1.7);                                    \
        BEGIN_CHAINS(TYPE, a, ALL);                              \
        BARRIER(term);                                           \
        for (uint64_t i = 0; i < rounds; i++) {                  \
            EACH_CHAIN(WORK, ROOT);                              \
            HOLD(BARRIER, a);                                    \
        }                                                        \
        TYPE sum = SUM_OF(a);                                    \
        KEEP(sum);                                               \
        return 7 * (double)(sizeof(TYPE) / sizeof(rheo_real));   \
    }
#define LIMIT_LOOPS(NAME, TARGET, TYPE, ALL, ROOT, BARRIER)               \
    TARGET static double arithmetic_##NAME(uint64_t rounds)               \
    {                                                                     \
        TYPE factor = ALL(1.0000001), term = ALL(1e-6);                   \
        BEGIN_CHAINS(TYPE, a, ALL);                                       \
        BEGIN_CHAINS(TYPE, m, ALL);                                       \
        BARRIER(factor);                                                  \
        BARRIER(term);                                                    \
        for (uint64_t i = 0; i < rounds; i++) {                           \
            EACH_CHAIN(ADD_AND_MULTIPLY, ROOT);                           \
            HOLD(BARRIER, a);                                             \
            HOLD(BARRIER, m);                                             \
        }                                                                 \
        TYPE sum = SUM_OF(a) + SUM_OF(m);                                 \
        KEEP(sum);                                                        \
        return 14 * (double)(sizeof(TYPE) / sizeof(rheo_real));           \
    }                                                                     \
    LIMIT_LOOP(roots_##NAME, TARGET, TYPE, ALL, BARRIER, TAKE_ROOT, ROOT) \
    LIMIT_LOOP(divisions_##NAME, TARGET, TYPE, ALL, BARRIER, DIVIDE, ROOT)

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

typedef double limit_loop(uint64_t rounds);

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

enum { TRIES = 15, FEWEST_TRIES = 3 };

/* Results per ns, the best of several measurements. */
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

/* ---- Bytes ---- */

/* Reads every word of an array, in four chains. */
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

/*
 * Measures GB/s when an array is read, and when one half is copied to the other, `times` times per measurement. The
 * number of measurements is limited on a slow machine, or in a build with sanitizers.
 */
static void bandwidth_of(char *memory, size_t bytes, uint64_t times, double *read, double *copy)
{
    static volatile uint64_t word;
    *read = *copy = 0;
    const double begin = cli_now();
    for (int i = 0; i < TRIES && (i < FEWEST_TRIES || cli_now() - begin < 1); i++) {
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

bool cli_bench_measure_limits(cli_bench_limits *limits)
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
