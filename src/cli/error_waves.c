/*
 * Waves on lattices without pressure, whose closed forms are exact sums over the lattice. Displacements are small and
 * along x. Each end of a spring moves by half, so two particles vibrate like masses on a spring of stiffness K/2.
 *
 *   block    a free cubic block in which springs join the six nearest neighbours only: rows of N masses along x.
 *            mode cos(pi (i + 1/2)/N), angular frequency 2 sqrt(K/2) sin(pi/(2 N))
 *   elastic  shear wave sin(k y) in periodic springs: angular frequency^2 = K/2 sum (d_x/r)^2 (1 - cos(k d_y))
 *   viscous  shear wave (-1)^layer in periodic fluid with sigma: rate = sigma/4 sum w (d_x/r)^2 2, over pairs of adjacent
 *            layers. Only pairs that approach act, which is one of each two pairs that are mirror images in x. In this
 *            mode, and in no longer one, the normal forces of the two neighbouring layers cancel.
 *
 * Sums are over the neighbours of one particle. No spring flows, so waves in springs keep their energy: their damping is
 * that of the scheme. Its measure is the rate at which the amplitude decays, divided by the angular frequency.
 */
#include "cli/error_trials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- Lattices ---- */

typedef struct lattice {
    int n[3];
    double spacing;
    bool periodic;
} lattice;

/* Distance of two lattice points along an axis, in spacings. */
static int apart(const lattice *l, int axis, int from, int to)
{
    const int d = to - from, n = l->n[axis];
    if (!l->periodic)
        return d;
    return d > n / 2 ? d - n : d < -((n - 1) / 2) ? d + n : d;
}

/* Springs between all points closer than the support, without stress. Returns their number; NULL ends: only counts. */
static size_t add_springs(const lattice *l, double support, uint32_t *ends, rheo_real *rest_length)
{
    const int count = l->n[0] * l->n[1] * l->n[2], plane = l->n[1] * l->n[2];
    size_t springs = 0;
    for (int a = 0; a < count; a++)
        for (int b = a + 1; b < count; b++) {
            const double d[3] = {apart(l, 0, a / plane, b / plane),
                                 apart(l, 1, a / l->n[2] % l->n[1], b / l->n[2] % l->n[1]),
                                 apart(l, 2, a % l->n[2], b % l->n[2])},
                         r = l->spacing * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            if (!(r < support))
                continue;
            if (ends) {
                ends[2 * springs] = (uint32_t)a;
                ends[2 * springs + 1] = (uint32_t)b;
                rest_length[springs] = (rheo_real)r;
            }
            springs++;
        }
    return springs;
}

/* A lattice around the origin, ids with z fastest, in fluid without pressure, viscosity, flow of springs and gravity. */
static rheo_result make_lattice(const lattice *l, cli_settled *s, cli_wave *wave, double **mode, bool springs,
                                rheo_error *error)
{
    const size_t count = (size_t)l->n[0] * (size_t)l->n[1] * (size_t)l->n[2];
    *s = (cli_settled){.def = rheo_default_world_def()};
    rheo_world_def *def = &s->def;
    def->fluid.spacing = l->spacing;
    def->fluid.stiffness = def->fluid.near_stiffness = 0;
    def->fluid.linear_viscosity = def->fluid.quadratic_viscosity = 0;
    def->springs.plasticity = 0;
    def->springs.stiffness = springs ? def->springs.stiffness : 0;
    def->history.stiffness = 0;
    def->gravity[1] = 0;
    const size_t most = springs ? add_springs(l, def->fluid.support, NULL, NULL) : 0;
    s->position = calloc(3 * count, sizeof *s->position);
    s->velocity = calloc(3 * count, sizeof *s->velocity);
    s->ends = malloc((2 * most + 1) * sizeof *s->ends);
    s->rest_length = malloc((most + 1) * sizeof *s->rest_length);
    *mode = malloc(count * sizeof **mode);
    wave->mode = *mode;
    if (!s->position || !s->velocity || !s->ends || !s->rest_length || !*mode) {
        snprintf(error->message, sizeof error->message, "no memory for a lattice of %zu particles", count);
        return RHEO_ERROR_MEMORY;
    }
    size_t i = 0;
    for (int x = 0; x < l->n[0]; x++)
        for (int y = 0; y < l->n[1]; y++)
            for (int z = 0; z < l->n[2]; z++, i++) {
                const int at[3] = {x, y, z};
                for (size_t axis = 0; axis < 3; axis++) {
                    s->position[3 * i + axis] = (rheo_real)(l->spacing * (at[axis] + 0.5 - 0.5 * l->n[axis]));
                    def->space.period[axis] = l->periodic ? l->spacing * l->n[axis] : 0;
                }
            }
    def->particles.count = (uint32_t)count;
    def->particles.position = s->position;
    def->particles.velocity = s->velocity;
    if (springs) {
        def->particles.spring_count = (uint32_t)add_springs(l, def->fluid.support, s->ends, s->rest_length);
        def->particles.spring_ends = s->ends;
        def->particles.spring_rest_length = s->rest_length;
    }
    return RHEO_OK;
}

/* Sum of weight (d_x/r)^2 (1 - cos(k d_y)) over the neighbours of a point; the weight is 1, or 1 - r/h. */
static double shear_sum(double spacing, double support, double k, bool weighted)
{
    double sum = 0;
    for (int x = -3; x <= 3; x++)
        for (int y = -3; y <= 3; y++)
            for (int z = -3; z <= 3; z++) {
                const double r = spacing * sqrt(x * x + y * y + z * z);
                if (r > 0 && r < support)
                    sum += (weighted ? 1 - r / support : 1) * pow(spacing * x / r, 2) * (1 - cos(k * spacing * y));
            }
    return sum;
}

/* ---- Runs ---- */

/* The wave in the last state, and its passages through 0. */
typedef struct passages {
    double place, time; /* amplitude of the displacement, from the first state on */
    double first, last; /* times of passages */
    uint32_t count;
    double speed, energy; /* amplitude of the velocity; energy as a share of that at the start */
} passages;

static double amplitude(const rheo_real *vector, const rheo_real *from, const double *mode, uint32_t count)
{
    double sum = 0, norm = 0;
    for (size_t i = 0; i < count; i++) {
        sum += mode[i] * (double)(vector[3 * i] - (from ? from[3 * i] : 0));
        norm += mode[i] * mode[i];
    }
    return sum / norm;
}

/* Three periods, or the time in which a wave decays to e^-3. */
static bool measure_wave(cli_trial *t, rheo_world *world)
{
    const cli_wave *wave = t->of->data;
    passages *p = t->memory;
    const uint32_t n = rheo_world_particle_count(world);
    const double time = rheo_world_time(world);
    p->speed = amplitude(rheo_world_velocities(world), NULL, wave->mode, n);
    const double place =
        wave->decays
            ? 0
            : amplitude(rheo_world_positions(world), t->of->def.particles.position, wave->mode, n) + wave->amplitude;
    if (rheo_world_step_count(world) > 0 && place * p->place < 0) {
        p->last = time - (time - p->time) * place / (place - p->place);
        p->first = p->count++ ? p->first : p->last;
    }
    p->place = place;
    p->time = time;
    p->energy =
        (p->speed * p->speed / (wave->rate * wave->rate) + place * place) / (wave->amplitude * wave->amplitude);
    return time + 0.5 * t->def.step < t->of->longest;
}

static void finish_wave(cli_trial *t)
{
    const cli_wave *wave = t->of->data;
    const passages *p = t->memory;
    if (p->time + t->def.step < t->of->longest)
        return;
    if (wave->decays) {
        t->quantity[0] = -log(p->speed / wave->amplitude) / p->time;
    } else {
        t->quantity[0] = p->count > 1 ? 2 * (p->last - p->first) / (p->count - 1) : (double)NAN;
        t->quantity[1] = -log(p->energy) / (2 * wave->rate * p->time);
    }
}

/* ---- Cases ---- */

/* Scheme positions has no springs. Without a history its onset changes nothing. */
static bool has_springs(const rheo_world_def *def)
{
    return def->scheme != RHEO_SCHEME_POSITIONS && def->history.onset > 0;
}

static bool has_periods(const rheo_world_def *def)
{
    return def->scheme == RHEO_SCHEME_SUMMED;
}

static cli_case wave_case(const char *name, const cli_wave *wave, const cli_settled *s)
{
    cli_case c = {.name = name,
                  .quantity = {"period", "damping"},
                  .reference = {2 * PI / wave->rate, 0},
                  .def = s->def,
                  .longest = 3 * 2 * PI / wave->rate,
                  .data = wave,
                  .bytes = sizeof(passages),
                  .has = has_periods,
                  .measure = measure_wave,
                  .finish = finish_wave};
    if (wave->decays) {
        c.quantity[0] = "decay";
        c.quantity[1] = NULL;
        c.reference[0] = wave->rate;
        c.longest = 3 / wave->rate;
    }
    return c;
}

/* Adds the wave to positions or velocities. */
static void start_wave(rheo_real *vector, const cli_wave *wave, uint32_t count)
{
    for (size_t i = 0; i < count; i++)
        vector[3 * i] += (rheo_real)(wave->amplitude * wave->mode[i]);
}

rheo_result cli_block_case(cli_case *c, cli_wave *wave, cli_settled *s, rheo_error *error)
{
    static const lattice block = {{8, 6, 6}, 3, false};
    double *mode;
    const rheo_result result = make_lattice(&block, s, wave, &mode, true, error);
    if (result != RHEO_OK)
        return result;
    for (uint32_t i = 0; i < s->def.particles.count; i++)
        mode[i] = -cos(PI * (i / 36 + 0.5) / 8);
    wave->amplitude = 0.15; /* 2 % in the middle */
    wave->rate = 2 * sqrt(s->def.springs.stiffness / 2) * sin(PI / 16);
    start_wave(s->position, wave, s->def.particles.count);
    *c = wave_case("block", wave, s);
    c->has = has_springs;
    return RHEO_OK;
}

rheo_result cli_elastic_wave_case(cli_case *c, cli_wave *wave, cli_settled *s, rheo_error *error)
{
    static const lattice fluid = {{6, 16, 6}, 2, true};
    double *mode;
    const rheo_result result = make_lattice(&fluid, s, wave, &mode, true, error);
    if (result != RHEO_OK)
        return result;
    const double k = 2 * PI / 32;
    for (uint32_t i = 0; i < s->def.particles.count; i++)
        mode[i] = sin(k * 2 * (i / 6 % 16 + 0.5));
    wave->amplitude = 0.05;
    wave->rate = sqrt(s->def.springs.stiffness / 2 * shear_sum(2, s->def.fluid.support, k, false));
    start_wave(s->position, wave, s->def.particles.count);
    *c = wave_case("elastic-shear-wave", wave, s);
    return RHEO_OK;
}

rheo_result cli_viscous_wave_case(cli_case *c, cli_wave *wave, cli_settled *s, rheo_error *error)
{
    static const lattice fluid = {{8, 8, 8}, 2, true};
    double *mode;
    const rheo_result result = make_lattice(&fluid, s, wave, &mode, false, error);
    if (result != RHEO_OK)
        return result;
    s->def.fluid.linear_viscosity = rheo_default_world_def().fluid.linear_viscosity;
    for (uint32_t i = 0; i < s->def.particles.count; i++)
        mode[i] = i / 8 % 2 ? 1 : -1;
    wave->amplitude = 0.002;
    wave->decays = true;
    wave->rate = s->def.fluid.linear_viscosity / 4 * shear_sum(2, s->def.fluid.support, PI / 2, true);
    start_wave(s->velocity, wave, s->def.particles.count);
    *c = wave_case("shear-wave", wave, s);
    return RHEO_OK;
}
