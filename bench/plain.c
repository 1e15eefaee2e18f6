/*
 * The same step programmed plainly, as a yardstick. It measures a step written directly from the papers and rheolog's
 * own step, alternating in one process and from one state.
 *
 *   bench/plain F.rlog [STEPS] [REPETITIONS]     starts at the last state of F.rlog: bowling-ball or a similar scene
 *
 * The plain step uses floats, one number at a time, and processes pairs in the order of ids. It has a hash grid with
 * lists, separate neighbour searches for viscosity and pressure, and a hash table of springs with a lookup per pair.
 * The physics are gravity, viscosity, springs with plasticity, pressure (Clavet et al. 2005) and walls, without
 * history and ball. rheolog runs the same scene without history, then with it. Prints CSV: step, ns per particle and
 * step (least and median), ratio of medians.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "rheolog/rheolog.h"

enum { MOST_NEIGHBOURS = 128, MOST_REPETITIONS = 99 };

typedef struct spring {
    uint64_t pair; /* smaller id << 32 | larger id; UINT64_MAX: empty slot */
    float rest_length;
    uint32_t seen; /* last step in which the pair was close */
} spring;

typedef struct plain {
    rheo_world_def def;
    uint32_t count, buckets, places, springs, step;
    float *x, *v, *before;
    int32_t *cell; /* cell of each particle */
    uint32_t *head, *next, *neighbour, *neighbours;
    spring *table;
} plain;

static _Noreturn void give_up(const char *message)
{
    fprintf(stderr, "plain: %s\n", message);
    exit(1);
}

static void *room(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);
    if (!memory)
        give_up("no memory");
    return memory;
}

static uint32_t bucket_of(const plain *p, const int32_t cell[3])
{
    return ((uint32_t)cell[0] * 73856093U ^ (uint32_t)cell[1] * 19349663U ^ (uint32_t)cell[2] * 83492791U) &
           (p->buckets - 1);
}

/* Finds all neighbours of each particle. */
static void find_neighbours(plain *p)
{
    const float h = (float)p->def.fluid.support;
    memset(p->head, 0xFF, p->buckets * sizeof *p->head);
    for (uint32_t i = p->count; i-- > 0;) {
        int32_t *cell = p->cell + 3 * (size_t)i;
        for (size_t axis = 0; axis < 3; axis++)
            cell[axis] = (int32_t)floorf(p->x[3 * (size_t)i + axis] / h);
        uint32_t bucket = bucket_of(p, cell);
        p->next[i] = p->head[bucket];
        p->head[bucket] = i;
    }
    for (uint32_t i = 0; i < p->count; i++) {
        const float *xi = p->x + 3 * (size_t)i;
        const int32_t *own = p->cell + 3 * (size_t)i;
        int32_t cell[3];
        p->neighbours[i] = 0;
        for (cell[2] = own[2] - 1; cell[2] <= own[2] + 1; cell[2]++)
            for (cell[1] = own[1] - 1; cell[1] <= own[1] + 1; cell[1]++)
                for (cell[0] = own[0] - 1; cell[0] <= own[0] + 1; cell[0]++)
                    for (uint32_t j = p->head[bucket_of(p, cell)]; j != UINT32_MAX; j = p->next[j]) {
                        const float *xj = p->x + 3 * (size_t)j;
                        if (j == i || memcmp(p->cell + 3 * (size_t)j, cell, sizeof cell) !=
                                          0) /* another cell with the same hash */
                            continue;
                        float dx = xj[0] - xi[0], dy = xj[1] - xi[1], dz = xj[2] - xi[2];
                        if (dx * dx + dy * dy + dz * dz < h * h && p->neighbours[i] < MOST_NEIGHBOURS)
                            p->neighbour[(size_t)i * MOST_NEIGHBOURS + p->neighbours[i]++] = j;
                    }
    }
}

/* Distance and direction from i to j. */
static float direction(const plain *p, uint32_t i, uint32_t j, float to[3])
{
    float r2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        to[axis] = p->x[3 * (size_t)j + (size_t)axis] - p->x[3 * (size_t)i + (size_t)axis];
        r2 += to[axis] * to[axis];
    }
    float r = sqrtf(r2);
    for (int axis = 0; axis < 3; axis++)
        to[axis] = r > 0 ? to[axis] / r : 0;
    return r;
}

static void viscosity(plain *p)
{
    const float h = (float)p->def.fluid.support, step = (float)p->def.step;
    const float sigma = (float)p->def.fluid.linear_viscosity, beta = (float)p->def.fluid.quadratic_viscosity;
    for (uint32_t i = 0; i < p->count; i++)
        for (uint32_t k = 0; k < p->neighbours[i]; k++) {
            uint32_t j = p->neighbour[(size_t)i * MOST_NEIGHBOURS + k];
            if (j < i)
                continue;
            float to[3], *vi = p->v + 3 * (size_t)i, *vj = p->v + 3 * (size_t)j, r = direction(p, i, j, to);
            float u = (vi[0] - vj[0]) * to[0] + (vi[1] - vj[1]) * to[1] + (vi[2] - vj[2]) * to[2];
            if (u <= 0)
                continue;
            float impulse = fminf(step * (1 - r / h) * (sigma * u + beta * u * u), u) / 2;
            for (int axis = 0; axis < 3; axis++) {
                vi[axis] -= impulse * to[axis];
                vj[axis] += impulse * to[axis];
            }
        }
}

static spring *find_spring(plain *p, uint32_t i, uint32_t j, float length)
{
    uint64_t pair = (uint64_t)i << 32 | j, hash = pair * UINT64_C(0x9E3779B97F4A7C15);
    for (uint32_t place = (uint32_t)(hash >> 32) & (p->places - 1);; place = (place + 1) & (p->places - 1)) {
        spring *s = &p->table[place];
        if (s->pair == pair)
            return s;
        if (s->pair == UINT64_MAX) {
            *s = (spring){pair, length, 0};
            p->springs++;
            return s;
        }
    }
}

static void springs(plain *p)
{
    const float step = (float)p->def.step, rate = step * (float)p->def.springs.plasticity;
    const float yield = (float)p->def.springs.yield_ratio, kappa = step * step * (float)p->def.springs.stiffness;
    for (uint32_t i = 0; i < p->count; i++)
        for (uint32_t k = 0; k < p->neighbours[i]; k++) {
            uint32_t j = p->neighbour[(size_t)i * MOST_NEIGHBOURS + k];
            if (j < i)
                continue;
            float to[3], r = direction(p, i, j, to);
            spring *s = find_spring(p, i, j, r);
            s->seen = p->step;
            float tolerated = yield * s->rest_length;
            if (r > s->rest_length + tolerated)
                s->rest_length += rate * (r - s->rest_length - tolerated);
            else if (r < s->rest_length - tolerated)
                s->rest_length -= rate * (s->rest_length - tolerated - r);
        }
    /* Drops the springs that are no longer close by making a new table. */
    spring *old = p->table;
    p->table = room(p->places, sizeof *p->table);
    memset(p->table, 0xFF, p->places * sizeof *p->table);
    p->springs = 0;
    for (uint32_t place = 0; place < p->places; place++)
        if (old[place].pair != UINT64_MAX && old[place].seen == p->step) {
            spring *s = find_spring(p, (uint32_t)(old[place].pair >> 32), (uint32_t)old[place].pair, 0);
            *s = old[place];
        }
    free(old);
    for (uint32_t place = 0; place < p->places; place++) {
        const spring *s = &p->table[place];
        if (s->pair == UINT64_MAX)
            continue;
        uint32_t i = (uint32_t)(s->pair >> 32), j = (uint32_t)s->pair;
        float to[3], r = direction(p, i, j, to), by = kappa * (r - s->rest_length) / 2;
        for (size_t axis = 0; axis < 3; axis++) {
            p->x[3 * (size_t)i + axis] += by * to[axis];
            p->x[3 * (size_t)j + axis] -= by * to[axis];
        }
    }
}

static void pressure(plain *p)
{
    const float h = (float)p->def.fluid.support, step = (float)p->def.step;
    for (uint32_t i = 0; i < p->count; i++) {
        const uint32_t *neighbour = p->neighbour + (size_t)i * MOST_NEIGHBOURS;
        float density = 0, near_density = 0, to[3], moved[3] = {0, 0, 0};
        for (uint32_t k = 0; k < p->neighbours[i]; k++) {
            float w = fmaxf(1 - direction(p, i, neighbour[k], to) / h, 0);
            density += w * w;
            near_density += w * w * w;
        }
        float of = (float)p->def.fluid.stiffness * (density - (float)p->def.fluid.rest_density);
        float near_of = (float)p->def.fluid.near_stiffness * near_density;
        for (uint32_t k = 0; k < p->neighbours[i]; k++) {
            float w = fmaxf(1 - direction(p, i, neighbour[k], to) / h, 0);
            float by = step * step * (of * w + near_of * w * w) / 2;
            for (size_t axis = 0; axis < 3; axis++) {
                p->x[3 * (size_t)neighbour[k] + axis] += by * to[axis];
                moved[axis] -= by * to[axis];
            }
        }
        for (size_t axis = 0; axis < 3; axis++)
            p->x[3 * (size_t)i + axis] += moved[axis];
    }
}

static void walls(plain *p)
{
    for (uint32_t w = 0; w < p->def.walls.count; w++)
        for (uint32_t i = 0; i < p->count; i++) {
            const rheo_wall *wall = &p->def.walls.plane[w];
            float *x = p->x + 3 * (size_t)i, *v = p->v + 3 * (size_t)i, distance = 0, into = 0;
            for (int axis = 0; axis < 3; axis++) {
                distance += ((float)x[axis] - (float)wall->point[axis]) * (float)wall->normal[axis];
                into += v[axis] * (float)wall->normal[axis];
            }
            for (int axis = 0; axis < 3; axis++) {
                x[axis] -= fminf(distance, 0) * (float)wall->normal[axis];
                v[axis] -= distance < 0 ? fminf(into, 0) * (float)wall->normal[axis] : 0;
            }
        }
}

static void plain_step(plain *p)
{
    const float step = (float)p->def.step;
    p->step++;
    for (uint32_t i = 0; i < p->count; i++)
        for (int axis = 0; axis < 3; axis++)
            p->v[3 * (size_t)i + (size_t)axis] += step * (float)p->def.gravity[axis];
    find_neighbours(p);
    viscosity(p);
    memcpy(p->before, p->x, 3 * (size_t)p->count * sizeof *p->x);
    for (size_t i = 0; i < 3 * (size_t)p->count; i++)
        p->x[i] += step * p->v[i];
    find_neighbours(p);
    springs(p);
    pressure(p);
    for (size_t i = 0; i < 3 * (size_t)p->count; i++)
        p->v[i] = (p->x[i] - p->before[i]) / step;
    walls(p);
}

static plain plain_of(const rheo_world *world)
{
    plain p = {.def = *rheo_world_definition(world), .count = rheo_world_particle_count(world)};
    size_t springs = rheo_world_spring_count(world);
    for (p.buckets = 1; p.buckets < 2 * p.count;)
        p.buckets *= 2;
    for (p.places = 1; p.places < 4 * springs + 1024;)
        p.places *= 2;
    p.x = room(3 * (size_t)p.count, sizeof *p.x);
    p.v = room(3 * (size_t)p.count, sizeof *p.v);
    p.cell = room(3 * (size_t)p.count, sizeof *p.cell);
    p.before = room(3 * (size_t)p.count, sizeof *p.before);
    p.head = room(p.buckets, sizeof *p.head);
    p.next = room(p.count, sizeof *p.next);
    p.neighbour = room((size_t)p.count * MOST_NEIGHBOURS, sizeof *p.neighbour);
    p.neighbours = room(p.count, sizeof *p.neighbours);
    p.table = room(p.places, sizeof *p.table);
    memset(p.table, 0xFF, p.places * sizeof *p.table);
    for (size_t i = 0; i < 3 * (size_t)p.count; i++) {
        p.x[i] = (float)rheo_world_positions(world)[i];
        p.v[i] = (float)rheo_world_velocities(world)[i];
    }
    rheo_spring *all = room(springs, sizeof *all);
    if (rheo_world_springs(world, all, springs) != RHEO_OK)
        give_up("the springs cannot be read");
    for (size_t k = 0; k < springs; k++)
        find_spring(&p, all[k].a, all[k].b, (float)all[k].rest_length);
    free(all);
    return p;
}

static void release(plain *p)
{
    void *const memory[] = {p->x, p->v, p->before, p->cell, p->head, p->next, p->neighbour, p->neighbours, p->table};
    for (size_t i = 0; i < sizeof memory / sizeof *memory; i++)
        free(memory[i]);
}

/* ---- Timing ---- */

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static rheo_world *world_of(const char *file, bool history)
{
    rheo_error error = {""};
    rheo_recording *recording;
    rheo_world *world;
    if (rheo_recording_open(file, &recording, &error) != RHEO_OK)
        give_up(error.message);
    if (rheo_recording_world(recording, rheo_recording_get_info(recording).last_step, NULL, &world, &error) !=
        RHEO_OK)
        give_up(error.message);
    rheo_recording_close(recording);
    if (history)
        return world;
    /* The same particles and springs in a world without history and ball. */
    rheo_world_def def = *rheo_world_definition(world);
    size_t springs = rheo_world_spring_count(world);
    rheo_spring *all = room(springs, sizeof *all);
    uint32_t *ends = room(2 * springs, sizeof *ends);
    rheo_real *length = room(springs, sizeof *length);
    if (rheo_world_springs(world, all, springs) != RHEO_OK)
        give_up("the springs cannot be read");
    for (size_t k = 0; k < springs; k++) {
        ends[2 * k] = all[k].a;
        ends[2 * k + 1] = all[k].b;
        length[k] = all[k].rest_length;
    }
    def.history.stiffness = 0;
    def.ball.radius = 0;
    def.particles.count = rheo_world_particle_count(world);
    def.particles.position = rheo_world_positions(world);
    def.particles.velocity = rheo_world_velocities(world);
    def.particles.spring_count = (uint32_t)springs;
    def.particles.spring_ends = ends;
    def.particles.spring_rest_length = length;
    rheo_world *without;
    if (rheo_world_create(&def, &without, &error) != RHEO_OK)
        give_up(error.message);
    free(all);
    free(ends);
    free(length);
    rheo_world_destroy(world);
    return without;
}

static double time_world(const char *file, const char *kernels, bool history, int steps)
{
    rheo_error error = {""};
    if (rheo_use_simd(kernels, &error) != RHEO_OK)
        give_up(error.message);
    rheo_world *world = world_of(file, history);
    if (rheo_world_step(world, &error) != RHEO_OK) /* the first step allocates memory */
        give_up(error.message);
    double start = now();
    for (int i = 0; i < steps; i++)
        if (rheo_world_step(world, &error) != RHEO_OK)
            give_up(error.message);
    double seconds = now() - start;
    seconds /= (double)steps * rheo_world_particle_count(world);
    rheo_world_destroy(world);
    return 1e9 * seconds;
}

static double time_plain(const char *file, int steps)
{
    rheo_world *world = world_of(file, true);
    plain p = plain_of(world);
    plain_step(&p);
    double start = now(), neighbours = 0;
    for (int i = 0; i < steps; i++)
        plain_step(&p);
    double seconds = (now() - start) / ((double)steps * p.count);
    for (uint32_t i = 0; i < p.count; i++)
        neighbours += p.neighbours[i];
    if (!(neighbours / p.count > 5 && neighbours / p.count < 60))
        give_up("the plain step has lost its fluid");
    release(&p);
    rheo_world_destroy(world);
    return 1e9 * seconds;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    if (argc < 2 || argc > 4)
        give_up("usage: plain F.rlog [STEPS] [REPETITIONS]");
    int steps = argc > 2 ? atoi(argv[2]) : 50, repetitions = argc > 3 ? atoi(argv[3]) : 5;
    if (steps < 1 || repetitions < 1 || repetitions > MOST_REPETITIONS)
        give_up("STEPS and REPETITIONS are whole numbers from 1 on, REPETITIONS up to 99");
    enum { MOST_CASES = 12 };
    static double ns[MOST_CASES][MOST_REPETITIONS];
    char name[MOST_CASES][64] = {"plain, no history"};
    int cases = 0;
    for (int r = 0; r < repetitions; r++) {
        cases = 0;
        ns[cases++][r] = time_plain(argv[1], steps);
        const char *kernels;
        for (uint32_t k = 0; (kernels = rheo_simd_available(k)); k++)
            for (int history = 0; history < 2; history++) {
                snprintf(name[cases], sizeof *name, "rheolog %s, %s history", kernels, history ? "with" : "no");
                ns[cases++][r] = time_world(argv[1], kernels, history, steps);
            }
    }
    printf("step,ns_least,ns_median,ratio_of_medians\n");
    double first = 0;
    for (int c = 0; c < cases; c++) {
        qsort(ns[c], (size_t)repetitions, sizeof ns[c][0], compare);
        double median = ns[c][repetitions / 2];
        first = c ? first : median;
        printf("\"%s\",%.1f,%.1f,%.3f\n", name[c], ns[c][0], median, median / first);
    }
    return 0;
}
