/*
 * A small scene with every kind of state, and its recordings in the file PATH. The test program defines PATH, because
 * test programs run at the same time.
 */
#ifndef RHEO__TESTS_RECORD_SUPPORT_H
#define RHEO__TESTS_RECORD_SUPPORT_H

#include "support.h"

#include "record/recording.h"

static rheo_error why; /* error of calls that may be refused */

/* ---- A small scene of everything ---- */

enum { MOST = 1000 };

static inline rheo_world_def scene_def(uint32_t side, rheo_real *position)
{
    rheo_world_def def = rheo_default_world_def();
    def.step = 0.02;
    def.history.window = 7;
    def.walls.plane = some_walls();
    def.walls.count = 3;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    walls_of(&def)[1] = (rheo_wall){{-1, 0, 0}, {1, 0, 0}};
    walls_of(&def)[2] = (rheo_wall){{0, 0, -1}, {0, 0.1, 1}};
    def.ball.radius = 2;
    def.ball.position[0] = def.ball.position[2] = 3;
    def.ball.position[1] = 2.0 * side + 3;
    def.ball.velocity[1] = -20;
    def.ball.spin[2] = 1;
    def.vibrators.position = some_vibrators();
    def.vibrators.count = 2;
    vibrators_of(&def)[0][0] = 1;
    vibrators_of(&def)[1][1] = 4;
    def.vibrators.amplitude = 0.8;
    uint32_t count = 0;
    for (uint32_t x = 0; x < side; x++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t z = 0; z < side; z++, count++) {
                position[3 * count] = (rheo_real)(2 * x) + (rheo_real)0.125 * (rheo_real)(y % 3);
                position[3 * count + 1] = (rheo_real)(2 * y + 1) + (rheo_real)0.0625 * (rheo_real)(x % 2);
                position[3 * count + 2] = (rheo_real)(2 * z) + (rheo_real)0.25 * (rheo_real)(x % 2);
            }
    def.particles.count = count;
    def.particles.position = position;
    return def;
}

/* History kind of the worlds that make_world() makes. */
static rheo_history_kind kind = RHEO_HISTORY_WINDOW;
static rheo_scheme scheme = RHEO_SCHEME_SUMMED; /* and their scheme */

static inline rheo_world *make_world(uint32_t side)
{
    rheo_real position[3 * MOST];
    rheo_world_def def = scene_def(side, position);
    def.history.kind = kind;
    def.scheme = scheme;
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

/* Gives every kind of command, before the named steps. */
static inline void command(rheo_world *world, uint64_t step)
{
    const double impulse[3] = {3, 1, -2}, point[3] = {3, 6, 4};
    const rheo_real position[6] = {0, 20, 0, 1, 23, 1}, velocity[6] = {0, -9, 0, 1, -8, 0};
    if (step == 2)
        OK(rheo_world_push_body(world, 0, impulse, NULL, &error));
    if (step == 3) {
        OK(rheo_world_push_body(world, 0, impulse, point, &error));
        OK(rheo_world_set(world, "fluid.linear_viscosity", "0.7", &error));
    }
    if (step == 4)
        OK(rheo_world_add_particles(world, 2, position, velocity, &error));
    if (step == 5) {
        OK(rheo_world_move_vibrator(world, 1, 0.5, 1.5, &error));
        OK(rheo_world_set(world, "ball.spin", "[1, 2, 3]", &error));
        OK(rheo_world_set(world, "step", "0.019", &error));
    }
    if (step == 6) /* a feature may be set to zero, and saving must keep it */
        OK(rheo_world_set(world, "history.stiffness", "0", &error));
    if (step == 8) {
        OK(rheo_world_set(world, "history.stiffness", "200", &error));
        OK(rheo_world_set(world, "springs.stiffness", "0", &error));
        OK(rheo_world_set(world, "walls.sticking", "0", &error));
    }
    if (step == 10)
        OK(rheo_world_set(world, "springs.stiffness", "15", &error));
}

static inline void save(const rheo_world *world, void **bytes, size_t *size)
{
    OK(rheo_world_save_memory(world, "test", bytes, size, &error));
}

static inline rheo_world *load(const void *bytes, size_t size, uint64_t step)
{
    rheo_recording *r;
    rheo_world *world;
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    OK(rheo_recording_world(r, step, NULL, &world, &error));
    rheo_recording_close(r);
    return world;
}

/* ---- Files ---- */

/* Records a run of the small scene; hashes (steps + 1 of them) may be NULL. */
static inline uint8_t *record(uint32_t side, uint64_t steps, uint64_t spacing, bool full, uint64_t *hashes,
                              size_t *size)
{
    rheo_world *world = make_world(side);
    rheo_recorder *recorder;
    rheo_record_options options = {.scene = "small", .keyframe_spacing = spacing, .full = full, .force = true};
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (uint64_t step = 0;; step++) {
        if (hashes)
            hashes[step] = rheo_world_hash(world);
        if (step == steps)
            break;
        command(world, step);
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    uint8_t *bytes = read_file(PATH, size);
    remove(PATH);
    return bytes;
}

#endif
