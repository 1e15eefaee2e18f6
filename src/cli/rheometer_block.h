/*
 * The block of `rheolog rheometer`: fluid between two plates of its own particles, periodic along x and z, with the parameters of a
 * scene and without gravity, walls, ball and vibrators. Its number density is that of the fluid at rest.
 *
 * Stress is the force along x over the area, two thirds of that on the lower plate and one third of that on the upper one, divided by
 * the number density as in docs/model.md (The fluid as a continuum): unit L^2/T^2. In a steady flow both forces are the same. In an
 * oscillation the inertia of the fluid changes them by (k gap)^2/6 and -(k gap)^2/3, k the wave number, so this mean has no such
 * error of second order. Times the density of a real fluid in kg/m^3, with L in m and T in s, it is in Pa. Strain is the
 * displacement of the upper plate over the gap. The block settles in space that is periodic along all axes; then it is cut at two
 * heights, so plates and fluid have the same disorder, and the gap is the distance of the cuts.
 */
#ifndef CLI_RHEOMETER_BLOCK_H
#define CLI_RHEOMETER_BLOCK_H

#include "cli/rheometer.h"

/* A settled block, from which each measurement begins. */
typedef struct cli_block {
    rheo_scene scene;            /* with the plates; its arrays are its own */
    rheo_world *rest;            /* settled, at rest */
    double density;              /* particles per volume */
    double height, lower, upper; /* of the settled block, and where it is cut into plates and fluid */
    double gap, area, step;
    /* Of the fluid at rest, docs/model.md; NaN where unknown. */
    double shear_modulus, history_modulus, yield_stress, viscosity;
    double diffusion_time; /* in which momentum crosses the gap: gap^2/(pi^2 viscosity); 0 if unknown */
} cli_block;

/* Makes the block of a scene. Returns an exit code; release it in any case. */
int cli_block_make(const cli_measurement *measurement, cli_block *block);
void cli_block_release(cli_block *block);

/* Makes a block, measures with it and releases it. */
int cli_block_measure(cli_measurement *measurement,
                      int (*measure)(cli_measurement *measurement, const cli_block *block));

/* A measurement on a copy of the block at rest. */
typedef struct cli_shear {
    const cli_block *block;
    cli_measurement *measurement;
    const char *name; /* for the progress */
    rheo_world *world;
    size_t samples, capacity;
    /* At the ends of steps; the stress and what one plate feels more than the other are means over the step. */
    double *time, *strain, *stress, *unbalance;
} cli_shear;

/*
 * Begins one; `control` is velocity or stress. Plates and fluid begin with the velocities of a uniform shear at this rate, so that
 * none has to wait until the momentum of a plate has crossed the gap. Returns an exit code; release it in any case.
 */
int cli_shear_begin(cli_shear *shear, const cli_block *block, cli_measurement *measurement, const char *name,
                    const char *control, double rate);
void cli_shear_release(cli_shear *shear);
/* Sets a parameter of the plates: its number, or along x if it is a vector. */
int cli_shear_set(cli_shear *shear, const char *path, bool vector, double value);
/* Makes steps, and keeps their samples. Returns an exit code. */
int cli_shear_run(cli_shear *shear, size_t steps);

/* Changes the shear rate in so many steps, because a sudden jump of the plate shears the fluid beside it only. */
int cli_shear_ramp(cli_shear *shear, double from, double to, size_t steps);

/* Steps of a time, at least 1. */
size_t cli_block_steps(const cli_block *block, double time);

/* Shear rate at which rest lengths flow as fast as they are stretched, or one for fluids whose rest lengths do not flow. */
double cli_block_rate(const cli_block *block);
/* Frequency at which a shear wave crosses the gap in half a radian. At twice this the inertia of the fluid begins to count. */
double cli_block_omega(const cli_block *block);
/* The highest rate whose plate moves by at most a quarter of the support in a step. */
double cli_block_most_rate(const cli_block *block);

/* Refuse shear rates and frequencies that take too many steps. */
int cli_block_check_rates(const cli_measurement *measurement);
int cli_block_check_omegas(const cli_measurement *measurement);

/* Protocols, by file. */
int cli_block_flow(cli_measurement *measurement);
int cli_block_startup(cli_measurement *measurement);
int cli_block_stop(cli_measurement *measurement);
int cli_block_amplitude(cli_measurement *measurement);
int cli_block_creep(cli_measurement *measurement);

#endif
