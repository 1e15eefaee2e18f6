/*
 * Error and speed of the elementary functions (core/math.h), compared with MPFR at 200 bits and with the C library.
 *
 *   bench/functions [POINTS [SEED]]      POINTS: random points of each range (default 1000000; a tenth for gamma)
 *
 * Prints CSV after a comment with processor, compiler and library. The columns are function, range, points, largest
 * error in units of the last place of the result (0.5 is correct rounding), its argument, ns per call, and the same
 * for libm. ns are medians of 15 repetitions in which both alternate over the same 2048 arguments. The C library has
 * no sine of turns, so sin(2 pi t) replaces it. Its argument is rounded, so it misses the zeros.
 */
#define _POSIX_C_SOURCE 200112L
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

#include <mpfr.h>

#include "core/math.h"
#include "rheolog/rheolog.h"

enum { BITS = 200, BATCH = 2048, REPEATS = 15, ROUNDS = 20 };

static uint64_t random_state = 1;

static uint64_t random_bits(void)
{
    random_state += UINT64_C(0x9e3779b97f4a7c15); /* splitmix64 */
    uint64_t z = random_state;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static double uniform(double a, double b)
{
    return a + (b - a) * ((double)(random_bits() >> 11) * 0x1p-53);
}

/* Any exponent from a to b is equally likely. */
static double any(int a, int b)
{
    return ldexp(uniform(1, 2), a + (int)(random_bits() % (unsigned)(b - a + 1)));
}

typedef struct point {
    double x, y;
} point;

/* ---- Functions: ours, libm's and MPFR's at a point ---- */

static double our_exp(point p)
{
    return rheo__exp(p.x);
}
static double our_expm1(point p)
{
    return rheo__expm1(p.x);
}
static double our_ln(point p)
{
    return rheo__ln(p.x);
}
static double our_pow(point p)
{
    return rheo__pow(p.x, p.y);
}
static double our_gamma(point p)
{
    return rheo__gamma(p.x);
}
static double our_sin(point p)
{
    return rheo__sin_turns(p.x);
}
static double our_cos(point p)
{
    return rheo__cos_turns(p.x);
}

static const double TWO_PI = 0x1.921fb54442d18p+2;

static double libm_exp(point p)
{
    return exp(p.x);
}
static double libm_expm1(point p)
{
    return expm1(p.x);
}
static double libm_ln(point p)
{
    return log(p.x);
}
static double libm_pow(point p)
{
    return pow(p.x, p.y);
}
static double libm_gamma(point p)
{
    return tgamma(p.x);
}
static double libm_sin(point p)
{
    return sin(TWO_PI * p.x);
}
static double libm_cos(point p)
{
    return cos(TWO_PI * p.x);
}

static mpfr_t argument, exponent, exact, difference;

static void set_exp(point p)
{
    mpfr_set_d(argument, p.x, MPFR_RNDN);
    mpfr_exp(exact, argument, MPFR_RNDN);
}
static void set_expm1(point p)
{
    mpfr_set_d(argument, p.x, MPFR_RNDN);
    mpfr_expm1(exact, argument, MPFR_RNDN);
}
static void set_ln(point p)
{
    mpfr_set_d(argument, p.x, MPFR_RNDN);
    mpfr_log(exact, argument, MPFR_RNDN);
}
static void set_pow(point p)
{
    mpfr_set_d(argument, p.x, MPFR_RNDN);
    mpfr_set_d(exponent, p.y, MPFR_RNDN);
    mpfr_pow(exact, argument, exponent, MPFR_RNDN);
}
static void set_gamma(point p)
{
    mpfr_set_d(argument, p.x, MPFR_RNDN);
    mpfr_gamma(exact, argument, MPFR_RNDN);
}
static void set_sin(point p)
{
    mpfr_set_d(argument, p.x, MPFR_RNDN);
    mpfr_sinu(exact, argument, 1, MPFR_RNDN);
}
static void set_cos(point p)
{
    mpfr_set_d(argument, p.x, MPFR_RNDN);
    mpfr_cosu(exact, argument, 1, MPFR_RNDN);
}

typedef double function(point);

static const struct {
    const char *name;
    function *ours, *libms;
    void (*set_exact)(point);
} functions[] = {
    {"exp", our_exp, libm_exp, set_exp},
    {"expm1", our_expm1, libm_expm1, set_expm1},
    {"ln", our_ln, libm_ln, set_ln},
    {"pow", our_pow, libm_pow, set_pow},
    {"gamma", our_gamma, libm_gamma, set_gamma},
    {"sin_turns", our_sin, libm_sin, set_sin},
    {"cos_turns", our_cos, libm_cos, set_cos},
};
enum { EXP, EXPM1, LN, POW, GAMMA, SIN, COS };

/* ---- Ranges ---- */

static point exp_all(void)
{
    return (point){uniform(-708, 709.78), 0};
}
static point exp_small(void)
{
    return (point){(random_bits() & 1 ? 1 : -1) * any(-70, -1), 0};
}
static point expm1_all(void)
{
    return (point){uniform(-40, 709.78), 0};
}
static point expm1_negative(void)
{
    return (point){uniform(-40, 0), 0};
}
static point exp_subnormal(void)
{
    return (point){uniform(-745.1, -708.4), 0};
}
static point ln_all(void)
{
    return (point){any(-1022, 1023), 0};
}
static point ln_near_one(void)
{
    return (point){1 + (random_bits() & 1 ? 1 : -0.5) * any(-52, -1), 0};
}
static point ln_subnormal(void)
{
    return (point){ldexp(uniform(0x1p-52, 1), -1022), 0};
}
static point pow_small(void)
{
    return (point){uniform(0, 100), uniform(-5, 5)};
}
static point pow_lags(void)
{
    return (point){(double)(1 + random_bits() % 1000000), uniform(0, 2)};
}
static point pow_all(void)
{
    const double x = any(-1022, 1023);
    return (point){x, uniform(-708, 709) / log(x)};
}
static point pow_near_one(void)
{
    const double x = 1 + any(-50, -2);
    return (point){x, uniform(-708, 709) / log(x)};
}
static point pow_subnormal(void)
{
    const double x = any(-1022, 1023);
    return (point){x, uniform(-745, -708.4) / log(x)};
}
static point gamma_orders(void)
{
    return (point){uniform(1, 3), 0};
}
static point gamma_all(void)
{
    return (point){uniform(0.001, 170), 0};
}
static point gamma_small(void)
{
    return (point){any(-1020, -1), 0};
}
static point turns_one(void)
{
    return (point){uniform(-1, 1), 0};
}
static point turns_many(void)
{
    return (point){uniform(-0x1p30, 0x1p30), 0};
}
static point turns_small(void)
{
    return (point){any(-1000, -3), 0};
}
static point turns_subnormal(void)
{
    return (point){ldexp(uniform(0, 1), -1024), 0};
}

static const struct {
    int function;
    const char *name;
    point (*draw)(void);
} ranges[] = {
    {EXP, "-708..709.78", exp_all},
    {EXP, "+-2^-70..1", exp_small},
    {EXP, "-745.1..-708.4 (subnormal)", exp_subnormal},
    {EXPM1, "-40..709.78", expm1_all},
    {EXPM1, "-40..0", expm1_negative},
    {EXPM1, "+-2^-70..1", exp_small},
    {LN, "2^-1022..2^1024", ln_all},
    {LN, "1 - 1/2..1 + 1 at any distance", ln_near_one},
    {LN, "subnormal", ln_subnormal},
    {POW, "0..100 ^ -5..5", pow_small},
    {POW, "1..1000000 whole ^ 0..2 (lags)", pow_lags},
    {POW, "any: result 1e-307..1e308", pow_all},
    {POW, "1 + 2^-50..1/2: result 1e-307..1e308", pow_near_one},
    {POW, "any: result subnormal", pow_subnormal},
    {GAMMA, "1..3 (orders)", gamma_orders},
    {GAMMA, "0.001..170", gamma_all},
    {GAMMA, "2^-1020..1", gamma_small},
    {SIN, "-1..1", turns_one},
    {SIN, "-2^30..2^30", turns_many},
    {SIN, "2^-1000..2^-2", turns_small},
    {SIN, "0..2^-1024 (subnormal)", turns_subnormal},
    {COS, "-1..1", turns_one},
    {COS, "-2^30..2^30", turns_many},
    {COS, "2^-1000..2^-2", turns_small},
};

/* ---- Measuring ---- */

static double ulps(double got)
{
    if (mpfr_zero_p(exact))
        return got == 0 ? 0 : (double)INFINITY;
    /* MPFR scales its mantissa to 1/2..1. */
    const long unit = (long)mpfr_get_exp(exact) - 53 > -1074 ? (long)mpfr_get_exp(exact) - 53 : -1074;
    mpfr_sub_d(difference, exact, got, MPFR_RNDN);
    mpfr_mul_2si(difference, difference, -unit, MPFR_RNDN);
    return fabs(mpfr_get_d(difference, MPFR_RNDN));
}

/* CPU time of this thread, independent of other load. */
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static double time_of(function *f, const point batch[BATCH])
{
    static volatile double sink;
    double sum = 0;
    const double start = now();
    for (int round = 0; round < ROUNDS; round++)
        for (int i = 0; i < BATCH; i++)
            sum += f(batch[i]);
    const double end = now();
    sink = sum;
    (void)sink; /* keeps the calls from being optimised away */
    return (end - start) / (ROUNDS * BATCH);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct worst {
    double error;
    point at;
} worst;

static void take_worse(worst *w, double error, point at)
{
    if (error > w->error)
        *w = (worst){error, at};
}

static void print_worst(worst w, bool two)
{
    if (w.error >= 1000)
        printf("%.2g,%a", w.error, w.at.x);
    else
        printf("%.7f,%a", w.error, w.at.x);
    if (two)
        printf(" ^ %a", w.at.y);
}

static void measure(size_t range, uint64_t points)
{
    const int f = ranges[range].function;
    worst ours = {0}, libms = {0};
    if (f == GAMMA)
        points /= 10; /* MPFR's gamma function is slow */
    for (uint64_t i = 0; i < points; i++) {
        const point p = ranges[range].draw();
        functions[f].set_exact(p);
        take_worse(&ours, ulps(functions[f].ours(p)), p);
        take_worse(&libms, ulps(functions[f].libms(p)), p);
    }
    static point batch[BATCH];
    for (int i = 0; i < BATCH; i++)
        batch[i] = ranges[range].draw();
    double our_time[REPEATS], libm_time[REPEATS];
    time_of(functions[f].ours, batch);
    time_of(functions[f].libms, batch);
    for (int i = 0; i < REPEATS; i++) {
        our_time[i] = time_of(functions[f].ours, batch);
        libm_time[i] = time_of(functions[f].libms, batch);
    }
    qsort(our_time, REPEATS, sizeof *our_time, ascending);
    qsort(libm_time, REPEATS, sizeof *libm_time, ascending);
    printf("%s,%s,%" PRIu64 ",", functions[f].name, ranges[range].name, points);
    print_worst(ours, f == POW);
    printf(",%.1f,", our_time[REPEATS / 2]);
    print_worst(libms, f == POW);
    printf(",%.1f\n", libm_time[REPEATS / 2]);
    fflush(stdout);
}

static void print_machine(void)
{
    char line[256] = "", *name = NULL;
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && !name && fgets(line, sizeof line, file))
        if (strncmp(line, "model name", 10) == 0 && (name = strchr(line, ':')))
            name[strcspn(name, "\n")] = 0;
    if (file)
        fclose(file);
    printf("# %s; %s; MPFR %s; libm of ", name ? name + 2 : "unknown processor", rheo_build(), mpfr_get_version());
#ifdef __GLIBC__
    printf("glibc %s\n", gnu_get_libc_version());
#else
    puts("another C library");
#endif
}

int main(int argc, char **argv)
{
    const uint64_t points = argc > 1 ? strtoull(argv[1], NULL, 10) : 1000000;
    if (argc > 2)
        random_state = strtoull(argv[2], NULL, 10);
    if (argc > 3 || points < 10) {
        fputs("functions: usage: functions [POINTS [SEED]], at least 10 points\n", stderr);
        return 2;
    }
    mpfr_inits2(BITS, argument, exponent, exact, difference, (mpfr_ptr)0);
    print_machine();
    puts("function,range,points,ulp,at,ns,libm_ulp,libm_at,libm_ns");
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        measure(i, points);
    mpfr_clears(argument, exponent, exact, difference, (mpfr_ptr)0);
    mpfr_free_cache();
    return 0;
}
