/*
 * Reads bytes as a recording with every function that reads one. Built with RHEO__LIBFUZZER it is a target of
 * libFuzzer. Its mutator changes the payloads of chunks and seals them again (tests/forge.h). Otherwise it is a
 * program:
 *
 *   fuzz_recording FILE...|FOLDER...   reads each
 *   fuzz_recording --make FOLDER       writes the first seeds of tests/corpus/recording
 *
 * Nothing may crash, leak or take long. Two properties abort when violated: a world that loads can be saved and
 * loaded again with the same hash; a recording that is `same` has no difference from itself.
 */
#define _POSIX_C_SOURCE 200809L
#include <float.h>
#include <unistd.h>

#include "forge.h"
#include "fuzz_support.h"
#include "world/model_melting.h"
#include "rheolog/rheolog.h"

#include "arrays.h"

/* Limits of one input, because the readers are tested and not the speed of steps. */
enum { MOST_BYTES = 64 * 1024, MOST_RAW = 128 * 1024, MOST_STEPS = 40, MOST_PARTICLES = 300, MOST_SUBSTEPS = 64 };

static rheo_error ignored;
static volatile size_t sink; /* keeps reads from being optimised away */

/* ---- Driving ---- */

/* Reads everything that a world offers. */
static void look(const rheo_world *world)
{
    rheo_body body;
    rheo_vibrator vibrator;
    rheo_field_info field;
    const uint32_t particles = rheo_world_particle_count(world), rows = rheo_world_history_rows(world);
    for (uint32_t i = 0; rheo_world_field(world, i, &field) == RHEO_OK; i++) {
        void *values = malloc((size_t)field.bytes + 1);
        HOLDS(rheo_world_field_read(world, i, values, (size_t)field.bytes) == RHEO_OK);
        free(values);
    }
    const size_t springs = rheo_world_spring_count(world);
    rheo_spring *spring = malloc((springs + 1) * sizeof *spring);
    rheo_real *history = malloc(((size_t)rows * 3 + 1) * sizeof *history);
    HOLDS(rheo_world_springs(world, spring, springs) == RHEO_OK);
    for (size_t i = 0; i < springs; i += 1 + springs / 4) {
        rheo_spring_state state;
        HOLDS(rheo_world_spring(world, spring[i].a, spring[i].b, &state, &ignored) == RHEO_OK);
        rheo_world_spring_history(world, spring[i].a, spring[i].b, history);
    }
    if (particles)
        rheo_world_particle_history(world, particles - 1, history);
    rheo_world_body(world, 0, &body);
    rheo_world_vibrator(world, 0, &vibrator);
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        sink += strlen(rheo_world_metric_name(world, i)) + (rheo_world_metric(world, i) > 0);
    sink += rheo_world_time(world) > 0;
    const rheo_top what[] = {RHEO_TOP_FASTEST, RHEO_TOP_DENSEST, RHEO_TOP_STIFFEST, RHEO_TOP_HOTTEST,
                             RHEO_TOP_FURTHEST};
    for (size_t i = 0; i < sizeof what / sizeof *what; i++) {
        rheo_top_entry top[3];
        size_t count;
        HOLDS(rheo_world_top(world, what[i], 3, top, &count, &ignored) == RHEO_OK && count <= 3);
    }
    if (particles) {
        rheo_particle_state state;
        HOLDS(rheo_world_particle(world, particles - 1, &state, &ignored) == RHEO_OK);
    }
    free(history);
    free(spring);
}

/* A loaded world can be saved, and loads again with the same hash. */
static void save_and_load(const rheo_world *world)
{
    void *bytes;
    size_t size;
    rheo_recording *r;
    rheo_world *again;
    HOLDS(rheo_world_save_memory(world, "again", &bytes, &size, &ignored) == RHEO_OK);
    HOLDS(rheo_recording_open_memory(bytes, size, &r, &ignored) == RHEO_OK);
    HOLDS(rheo_recording_world(r, rheo_world_step_count(world), NULL, &again, &ignored) == RHEO_OK);
    HOLDS(rheo_world_hash(again) == rheo_world_hash(world));
    rheo_world_destroy(again);
    rheo_recording_close(r);
    free(bytes);
}

static void load(rheo_recording *r, uint64_t step)
{
    rheo_world *world;
    if (rheo_recording_world(r, step, NULL, &world, &ignored) != RHEO_OK) {
        HOLDS(!world);
        return;
    }
    HOLDS(rheo_world_step_count(world) == step);
    look(world);
    if (step == rheo_recording_get_info(r).last_step)
        save_and_load(world);
    for (int i = 0; i < 2 && rheo_world_step(world, &ignored) == RHEO_OK; i++)
        look(world);
    rheo_world_destroy(world);
}

static void play(rheo_recording *r, const rheo_recording_info *info)
{
    rheo_player *player;
    uint32_t stage;
    rheo_stage_info name;
    if (rheo_player_open(r, NULL, &player, &ignored) != RHEO_OK) {
        HOLDS(!player);
        return;
    }
    const uint64_t middle = info->first_step + (info->last_step - info->first_step) / 2;
    for (int i = 0; i < 4; i++)
        rheo_player_stage(player, &stage, &ignored);
    look(rheo_player_world(player));
    rheo_player_step(player, &ignored);
    rheo_player_seek(player, info->last_step, &ignored);
    look(rheo_player_world(player));
    for (uint32_t i = 0; i < rheo_world_stage_count(rheo_player_world(player));
         i++) /* includes stages of a failed step */
        rheo_player_stage(player, &stage, &ignored);
    for (int i = 0; i < 3; i++)
        rheo_player_step_back(player, &ignored);
    for (uint32_t i = 0; i < 40 && rheo_world_stage(rheo_player_world(player), i, &name) == RHEO_OK; i += 3)
        rheo_player_seek_stage(player, middle + 1, name.name, &ignored);
    look(rheo_player_world(player));
    rheo_player_seek(player, middle, &ignored);
    rheo_player_step_back(player, &ignored);
    rheo_player_seek_stage(player, middle + 1, "viscosity@2", &ignored);
    look(rheo_player_world(player));
    rheo_player_seek_stage(player, middle + 1, "integration@1", &ignored);
    rheo_player_seek_stage(player, info->last_step + 1, "gravity", &ignored);
    rheo_player_seek_stage(player, info->last_step, "no stage", &ignored);
    look(rheo_player_world(player));
    rheo_player_close(player);
}

static void read_all(const uint8_t *bytes, size_t size)
{
    rheo_recording *r;
    if (rheo_recording_open_memory(bytes, size, &r, &ignored) != RHEO_OK) {
        HOLDS(!r && memchr(ignored.message, 0, sizeof ignored.message));
        return;
    }
    rheo_recording_info info = rheo_recording_get_info(r);
    rheo_failure failure;
    rheo_blessing blessing;
    char message[512];
    char text[96];
    HOLDS(info.bytes == size && info.last_step >= info.first_step);
    sink += strlen(info.scene) + strlen(info.build);
    const rheo_world_def *def = rheo_recording_definition(r);
    for (size_t i = 0; i < rheo_world_def_parameter_count(def); i++)
        HOLDS(rheo_world_def_get(def, rheo_world_def_parameter_at(def, i)->path, text, sizeof text) == RHEO_OK);
    for (uint64_t i = 0; i < info.keyframes; i++)
        HOLDS(rheo_recording_keyframe_step(r, i) <= info.last_step);
    const uint32_t metrics = rheo_recording_metric_count(r);
    double *values = malloc((metrics + (size_t)1) * sizeof *values);
    for (uint32_t i = 0; i < metrics; i++)
        sink += strlen(rheo_recording_metric_name(r, i));
    for (uint64_t i = 0; i <= info.last_step - info.first_step; i++)
        rheo_recording_metrics(r, info.first_step + i, values, &ignored);
    free(values);
    if (rheo_recording_failure(r, &failure)) {
        rheo_failure_message(&failure, message, sizeof message);
        sink += strlen(message);
    }
    for (uint32_t i = 0; rheo_recording_blessing(r, i, &blessing) == RHEO_OK; i++)
        sink += strlen(blessing.because) + strlen(blessing.build);
    load(r, info.first_step);
    if (info.last_step != info.first_step) {
        load(r, info.first_step + (info.last_step - info.first_step) / 2);
        load(r, info.last_step);
    }
    play(r, &info);
    rheo_diagnosis diagnosis;
    if (rheo_diagnose(r, &diagnosis, &ignored) == RHEO_OK)
        HOLDS(memchr(diagnosis.why, 0, sizeof diagnosis.why) && diagnosis.finding_count <= RHEO_MAX_FINDINGS);
    rheo_recording_close(r);
}

/* Finds a parameter in a keyframe: its path, a 1 and the value. */
static bool is_at_most(const forged_chunk *c, const char *path, double most)
{
    const size_t length = strlen(path);
    for (size_t at = 2; at + length + 12 <= c->size; at++) {
        if (forge_get(c->data + at - 2, 2) != length || memcmp(c->data + at, path, length) != 0)
            continue;
        const uint64_t bits = forge_get(c->data + at + length + 4, 8);
        double value;
        memcpy(&value, &bits, sizeof value);
        return value <= most;
    }
    return false;
}

/* Whether the steps of a melting world have few enough substeps and iterations to be fast. */
static bool has_few_substeps(const forged *f)
{
    rheo__head head;
    rheo__cursor cursor = {f->count ? f->chunk[0].data : NULL, f->count ? f->chunk[0].size : 0, 0, false};
    if (f->count == 0 || rheo__head_get(&cursor, &head, &ignored) != RHEO_OK)
        return true; /* another model */
    const bool melts = head.features & RHEO__FEATURE_MELTING;
    rheo__head_release(&head);
    for (size_t i = 0; melts && i < f->count; i++) {
        const forged_chunk *c = &f->chunk[i];
        if (c->type == RHEO__KEYF &&
            !(is_at_most(c, "melting.substeps", MOST_SUBSTEPS) &&
              is_at_most(c, "melting.max_substeps", MOST_SUBSTEPS) && is_at_most(c, "melting.max_iterations", 100)))
            return false;
        for (size_t at = 0; c->type == RHEO__INPT && at + 8 <= c->size; at++)
            if (memcmp(c->data + at, "substeps", 8) == 0 || memcmp(c->data + at, "iteratio", 8) == 0)
                return false;
    }
    return true;
}

/* Whether reading the bytes costs little enough. */
static bool is_small(const uint8_t *bytes, size_t size)
{
    if (size > MOST_BYTES)
        return false;
    size_t steps = 0, raw = 0;
    for (size_t at = 8; at + 36 <= size;) {
        uint64_t stored = forge_get(bytes + at + 16, 8);
        raw += (size_t)(forge_get(bytes + at + 24, 8) % (MOST_RAW + 1));
        if (forge_get(bytes + at + 24, 8) > MOST_RAW || stored > size - at - 36)
            break;
        at += 36 + (size_t)stored;
    }
    if (raw > MOST_RAW)
        return false;
    forged f;
    forge_open(&f, bytes, size, MOST_RAW);
    uint64_t most = 0, added = 0;
    for (size_t i = 0; i < f.count; i++) {
        const forged_chunk *c = &f.chunk[i];
        steps += c->type == RHEO__STEP;
        if (c->type == RHEO__KEYF && c->size >= 8 && forge_get(c->data, 8) > most)
            most = forge_get(c->data, 8);
        if (c->type == RHEO__INPT && c->size >= 8 && forge_get(c->data, 4) == 3)
            added += forge_get(c->data + 4, 4);
    }
    /* Larger counts than the file can hold are refused at no cost. */
    bool large = steps > MOST_STEPS || (most < MOST_RAW && most + added > MOST_PARTICLES) || !has_few_substeps(&f);
    forge_release(&f);
    return !large;
}

/* Recipe of a seed. */
typedef struct seed {
    const char *name;
    uint32_t side; /* side^3 particles */
    uint32_t window, steps, spacing;
    rheo_history_kind kind;
    bool full, apart, ball, floor, force, commands, fails, blessed, checkpoint, melting;
    bool stored, packed, note,
        truncated; /* no chunk compressed; all chunks compressed; with an unknown chunk; cut off */
} seed;

static const seed SEEDS[] = {
    {"checkpoint", .side = 2, .window = 3, .steps = 2, .checkpoint = true},
    {"checkpoint-start", .side = 2, .window = 200, .checkpoint = true},
    {"long-window", .side = 1, .window = 1000000, .steps = 2, .spacing = 1},
    {"run", .side = 2, .window = 20, .steps = 8, .spacing = 3},
    {"history-full", .side = 2, .window = 3, .steps = 8, .spacing = 6},
    {"commands", .side = 2, .window = 6, .steps = 8, .spacing = 4, .ball = true, .floor = true, .commands = true},
    {"full", .side = 2, .window = 6, .steps = 6, .spacing = 4, .full = true},
    {"full-commands", .side = 2, .window = 4, .steps = 6, .spacing = 5, .full = true, .ball = true, .force = true,
     .commands = true},
    {"ball", .side = 2, .window = 6, .steps = 4, .spacing = 4, .ball = true},
    {"floor", .side = 2, .window = 6, .steps = 4, .spacing = 4, .floor = true},
    {"force", .side = 2, .window = 6, .steps = 4, .spacing = 4, .force = true},
    {"fail", .side = 2, .window = 6, .steps = 3, .spacing = 3, .fails = true},
    {"blessed", .side = 2, .window = 6, .steps = 3, .spacing = 8, .blessed = true},
    {"fail-blessed-full", .side = 2, .window = 6, .steps = 3, .spacing = 8, .full = true, .fails = true,
     .blessed = true},
    {"empty", .side = 0, .window = 6, .steps = 3, .spacing = 2, .full = true},
    {"empty-added", .side = 0, .window = 6, .steps = 6, .spacing = 5, .full = true, .commands = true},
    {"one", .side = 1, .window = 6, .steps = 3, .spacing = 2, .full = true},
    {"27", .side = 3, .window = 4, .steps = 3, .spacing = 2, .full = true},
    {"springs", .side = 2, .window = 3, .steps = 5, .spacing = 9, .full = true, .apart = true},
    {"springs-simulated", .side = 2, .window = 3, .steps = 5, .spacing = 9, .apart = true},
    {"seeking", .side = 1, .window = 3, .steps = 24, .spacing = 99},
    {"stored", .side = 2, .window = 4, .steps = 3, .spacing = 2, .full = true, .stored = true},
    {"packed", .side = 2, .window = 4, .steps = 3, .spacing = 2, .full = true, .packed = true},
    {"note", .side = 2, .window = 4, .steps = 3, .spacing = 2, .note = true},
    {"modes", .side = 2, .window = 4, .steps = 6, .spacing = 4, .kind = RHEO_HISTORY_FULL, .commands = true},
    {"modes-ring", .side = 2, .window = 3, .steps = 6, .spacing = 4, .kind = RHEO_HISTORY_WINDOW_FAST, .full = true,
     .commands = true},
    {"modes-fading", .side = 2, .window = 4, .steps = 3, .spacing = 2, .kind = RHEO_HISTORY_TEMPERED, .full = true},
    {"truncated", .side = 2, .window = 4, .steps = 3, .spacing = 2, .truncated = true},
    {"melting", .side = 2, .window = 1, .steps = 5, .spacing = 3, .melting = true, .commands = true},
    {"melting-full", .side = 2, .window = 1, .steps = 5, .spacing = 4, .melting = true, .full = true,
     .commands = true},
    {"melting-fails", .side = 2, .window = 1, .steps = 1, .spacing = 4, .melting = true, .fails = true},
};
enum { SEED_COUNT = sizeof SEEDS / sizeof *SEEDS };

/* Makes a world with about two substeps per step. */
static rheo_world *melting_seed_world(const seed *s)
{
    rheo_real position[3 * 27], velocity[3 * 27] = {0}, temperature[27];
    rheo_world *world;
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.fluid.spacing = 0.1;
    def.melting.sound_speed = 4;
    def.melting.max_substeps = MOST_SUBSTEPS;
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    for (uint32_t i = 0; i < s->side * s->side * s->side; i++) {
        position[3 * i] = (rheo_real)(i % s->side) / 10;
        position[3 * i + 1] = (rheo_real)(i / s->side % s->side) / 10 + (rheo_real)0.05;
        position[3 * i + 2] = (rheo_real)(i / s->side / s->side) / 10;
        velocity[3 * i] = (rheo_real)(i % 3) / 8;
        temperature[i] = (rheo_real)(i % 4) / 3;
        def.particles.count = i + 1;
    }
    def.particles.position = position;
    def.particles.velocity = velocity;
    def.particles.temperature = temperature;
    HOLDS(rheo_world_create(&def, &world, &ignored) == RHEO_OK);
    return world;
}

static rheo_world *seed_world(const seed *s)
{
    if (s->melting)
        return melting_seed_world(s);
    rheo_real position[3 * 27], velocity[3 * 27] = {0};
    rheo_world *world;
    rheo_world_def def = rheo_default_world_def();
    def.step = 0.02;
    def.history.window = s->window;
    def.history.kind = s->kind;
    def.walls.plane = some_walls();
    def.walls.count = 2;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    walls_of(&def)[1] = (rheo_wall){{-1, 0, 0}, {1, 0, 0}};
    if (s->ball) {
        def.ball.radius = 2;
        def.ball.position[1] = 2.0 * s->side + 2;
        def.ball.velocity[1] = -20;
    }
    if (s->floor || s->force) {
        def.vibrators.position = some_vibrators();
        def.vibrators.count = 2;
        def.vibrators.kind = s->force ? RHEO_VIBRATOR_FORCE : RHEO_VIBRATOR_FLOOR;
        vibrators_of(&def)[0][0] = 1;
        def.vibrators.height = 4;
    }
    for (uint32_t i = 0; i < s->side * s->side * s->side; i++) {
        position[3 * i] = (rheo_real)(2 * (i % s->side)) + (rheo_real)0.125 * (rheo_real)(i % 2);
        position[3 * i + 1] = (rheo_real)(2 * (i / s->side % s->side) + 1);
        position[3 * i + 2] = (rheo_real)(2 * (i / s->side / s->side));
        velocity[3 * i] = s->apart ? (rheo_real)(60 * (i % 3)) - 60 : 0; /* springs form and break */
        def.particles.count = i + 1;
    }
    def.particles.position = position;
    def.particles.velocity = velocity;
    HOLDS(rheo_world_create(&def, &world, &ignored) == RHEO_OK);
    return world;
}

/* Commands may be refused if the world lacks their object. */
static void give_commands(rheo_world *world, uint32_t step)
{
    const double impulse[3] = {3, 1, -2}, point[3] = {3, 6, 4};
    const rheo_real position[6] = {0, 8, 0, 1, 9, 1}, velocity[6] = {0, -9, 0, 1, -8, 0};
    if (step == 1)
        rheo_world_push_body(world, 0, impulse, NULL, &ignored);
    if (step == 2) {
        rheo_world_push_body(world, 0, impulse, point, &ignored);
        rheo_world_set(world, "fluid.linear_viscosity", "0.7", &ignored);
        rheo_world_set(world, "melting.viscosity", "0.7", &ignored);
    }
    if (step == 3)
        rheo_world_add_particles(world, 2, position, velocity, &ignored);
    if (step == 4) {
        rheo_world_move_vibrator(world, 1, 0.5, 1.5, &ignored);
        rheo_world_set(world, "ball.spin", "[1, 2, 3]", &ignored);
        rheo_world_set(world, "step", "0.019", &ignored);
        rheo_world_set(world, "history.order", "0.25", &ignored);
    }
    if (step == 5)
        rheo_world_set(world, "history.stiffness", "0", &ignored);
}

static void record(const seed *s, const char *path)
{
    rheo_world *world = seed_world(s);
    rheo_recorder *recorder;
    for (uint32_t step = 0; s->checkpoint && step < s->steps; step++)
        HOLDS(rheo_world_step(world, &ignored) == RHEO_OK);
    if (s->checkpoint) {
        HOLDS(rheo_world_save(world, s->name, path, true, &ignored) == RHEO_OK);
        rheo_world_destroy(world);
        return;
    }
    rheo_record_options options = {.scene = s->name, .keyframe_spacing = s->spacing, .full = s->full, .force = true};
    HOLDS(rheo_recorder_open(world, path, &options, &recorder, &ignored) == RHEO_OK);
    for (uint32_t step = 0; step < s->steps; step++) {
        if (s->commands)
            give_commands(world, step);
        HOLDS(rheo_recorder_step(recorder, &ignored) == RHEO_OK);
    }
    if (s->fails) { /* a speed near the largest number, until the position overflows */
        const rheo_real fastest = sizeof(rheo_real) == 4 ? (rheo_real)FLT_MAX : (rheo_real)DBL_MAX;
        const rheo_real position[3] = {9, 9, 9}, velocity[3] = {fastest, 0, 0};
        HOLDS(rheo_world_add_particles(world, 1, position, velocity, &ignored) == RHEO_OK);
        HOLDS(rheo_world_set(world, "step", "1e6", &ignored) == RHEO_OK);
        HOLDS(rheo_recorder_step(recorder, &ignored) == RHEO_ERROR_STATE);
    }
    HOLDS(rheo_recorder_close(recorder, &ignored) == RHEO_OK);
    rheo_world_destroy(world);
}

/* Returns memory from malloc. */
static uint8_t *make_seed(const seed *s, size_t *size)
{
    char path[64], blessed[80];
    snprintf(path, sizeof path, "/tmp/rheo-seed-%ld.rlog", (long)getpid());
    snprintf(blessed, sizeof blessed, "%s.blessed", path);
    record(s, path);
    if (s->blessed) {
        static rheo_verification v;
        HOLDS(rheo_bless(blessed, path, "a seed", false, &v, &ignored) == RHEO_OK);
        HOLDS(rename(blessed, path) == 0);
    }
    uint8_t *bytes = read_file(path, size);
    remove(path);
    if (s->stored || s->packed || s->note) {
        forged f;
        forge_open(&f, bytes, *size, MOST_RAW);
        if (s->note)
            forge_insert(&f, f.count / 2, RHEO__CHUNK('N', 'O', 'T', 'E'), RHEO__CHUNK_OPTIONAL, 1, "hello", 5);
        for (size_t i = 0; i < f.count && !s->note; i++)
            f.chunk[i].flags = s->packed && f.chunk[i].type != RHEO__STAT ? RHEO__CHUNK_ZLIB : 0;
        bytes = realloc(bytes, MOST_BYTES);
        *size = forge_write(&f, true, bytes, MOST_BYTES);
        forge_release(&f);
    }
    if (s->truncated)
        *size -= 100;
    return bytes;
}

/* ---- Comparing ---- */

/* The seeds as recordings to compare with: the first with the same stages and fields, or else the first. */
static struct {
    uint8_t *bytes;
    size_t size;
    rheo_recording *r;
} made[SEED_COUNT];

static void make_seeds(void)
{
    for (size_t i = 0; i < SEED_COUNT; i++) {
        made[i].bytes = make_seed(&SEEDS[i], &made[i].size);
        HOLDS(rheo_recording_open_memory(made[i].bytes, made[i].size, &made[i].r, &ignored) == RHEO_OK);
    }
}

static size_t seed_like(const uint8_t *bytes, size_t size)
{
    rheo_recording *r;
    size_t like = 0;
    if (rheo_recording_open_memory(bytes, size, &r, &ignored) != RHEO_OK)
        return like;
    for (size_t i = 0; i < SEED_COUNT; i++) {
        const rheo__head *a = &r->head, *b = &made[i].r->head;
        bool same = a->layout.size == b->layout.size && memcmp(a->layout.data, b->layout.data, a->layout.size) == 0;
        bool named = strcmp(a->scene, b->scene) == 0;
        if (same && (named || like == 0))
            like = i;
        if (same && named)
            break;
    }
    rheo_recording_close(r);
    return like;
}

void drive(const uint8_t *bytes, size_t size)
{
    static rheo_verification v, other;
    if (!is_small(bytes, size))
        return;
    read_all(bytes, size);
    HOLDS(rheo_verify_memory(bytes, size, &v, &ignored) == RHEO_OK);
    HOLDS(memchr(v.message, 0, sizeof v.message));
    HOLDS(rheo_diff_memory(bytes, size, bytes, size, &other, &ignored) == RHEO_OK);
    HOLDS(other.verdict != RHEO_DIFFERS && (v.verdict != RHEO_SAME || other.verdict == RHEO_SAME));
    const size_t like = seed_like(bytes, size);
    HOLDS(rheo_diff_memory(bytes, size, made[like].bytes, made[like].size, &other, &ignored) == RHEO_OK);
    HOLDS(memchr(other.message, 0, sizeof other.message));
    HOLDS(rheo_diff_memory(made[like].bytes, made[like].size, bytes, size, &other, &ignored) == RHEO_OK);
}

/* ---- As a target of libFuzzer ---- */

#ifdef RHEO__LIBFUZZER

const char *__asan_default_options(void);
int LLVMFuzzerInitialize(int *argc, char ***argv);
size_t LLVMFuzzerMutate(uint8_t *bytes, size_t size, size_t room);
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t room, unsigned int number);
size_t LLVMFuzzerCustomCrossOver(const uint8_t *a, size_t a_size, const uint8_t *b, size_t b_size, uint8_t *to,
                                 size_t room, unsigned int number);

/* Halves the time of a run with a smaller quarantine and shorter stacks. */
const char *__asan_default_options(void)
{
    return "quarantine_size_mb=4:malloc_context_size=6:allocator_release_to_os_interval_ms=-1";
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    make_seeds();
    return 0;
}

static uint32_t random_state;
static uint32_t below(size_t n)
{
    random_state = random_state * 1664525 + 1013904223;
    return n ? (random_state >> 8) % (uint32_t)n : 0;
}

/* Replaces a number by one that often breaks programs. */
static void set_number(forged_chunk *c)
{
    static const uint64_t ODD[] = {0,
                                   1,
                                   2,
                                   3,
                                   4,
                                   7,
                                   8,
                                   255,
                                   65535,
                                   65536,
                                   0x7FFFFFFF,
                                   0x80000000,
                                   0xFFFFFFFE,
                                   0xFFFFFFFF,
                                   UINT64_C(1) << 32,
                                   UINT64_C(1) << 62,
                                   UINT64_MAX >> 1,
                                   UINT64_MAX - 1,
                                   UINT64_MAX,
                                   0x7F800000,
                                   0x7FC00000,
                                   0xFF800000,
                                   0x00000001,
                                   0x7F7FFFFF,
                                   0x80000000,
                                   UINT64_C(0x7FF0000000000000),
                                   UINT64_C(0x7FF8000000000000),
                                   UINT64_C(0x412E848000000000),
                                   UINT64_C(0x3FF0000000000000),
                                   UINT64_C(0xBFF0000000000000),
                                   UINT64_C(0x46293E5939A08CEA)};
    static const size_t SIZES[] = {1, 2, 4, 4, 8, 8};
    size_t bytes = SIZES[below(6)];
    if (c->size < bytes)
        return;
    uint8_t *at = c->data + below(c->size - bytes + 1);
    if (below(3))
        at = c->data + (size_t)(at - c->data) / 4 * 4;
    uint64_t old = forge_get(at, bytes);
    uint64_t value = below(3) == 0 ? old + below(9) - 4 : ODD[below(sizeof ODD / sizeof *ODD)];
    forge_put(at, value, bytes);
}

static void mutate_payload(forged_chunk *c, size_t room)
{
    if (below(2)) {
        set_number(c);
        return;
    }
    size_t most = c->size + (room < 64 ? room : 64);
    c->data = realloc(c->data, most + 1);
    c->size = LLVMFuzzerMutate(c->data, c->size, most ? most : 1);
}

static void mutate_chunks(forged *f, size_t room)
{
    static const uint32_t TYPES[] = {RHEO__HEAD, RHEO__FILD, RHEO__KEYF, RHEO__INPT, RHEO__STAT,
                                     RHEO__STEP, RHEO__FAIL, RHEO__BLES, RHEO__INDX, RHEO__DONE,
                                     RHEO__GOLD, RHEO__MADE, RHEO__MEMB, RHEO__SAME, RHEO__CHUNK('N', 'O', 'T', 'E')};
    size_t place = below(f->count), other = below(f->count);
    forged_chunk *c = &f->chunk[place], swap;
    switch (below(12)) {
    case 0:
        forge_remove(f, place);
        break;
    case 1: {
        forged_chunk *from = &f->chunk[other];
        forge_insert(f, place, from->type, from->flags, from->step, from->data, from->size);
        break;
    }
    case 2:
        swap = *c;
        *c = f->chunk[other];
        f->chunk[other] = swap;
        break;
    case 3:
        if (below(4))
            c->flags ^= RHEO__CHUNK_ZLIB;
        else
            c->flags ^= 1u << below(4);
        break;
    case 4:
        if (below(2)) {
            c->step += below(5) - UINT64_C(2);
        } else { /* all steps at once, so that their order is kept */
            uint64_t by = below(2) ? UINT64_MAX - below(8) : UINT64_C(1) << below(64);
            for (size_t i = 1; i < f->count; i++)
                f->chunk[i].step += by;
        }
        break;
    case 5:
        if (below(3) == 0)
            c->type = TYPES[below(sizeof TYPES / sizeof *TYPES)];
        else if (place)
            forge_insert(f, place, TYPES[10 + below(2)], RHEO__CHUNK_OPTIONAL, c->step, "note", below(5));
        break;
    default:
        mutate_payload(c, room);
    }
}

size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t room, unsigned int number)
{
    random_state = number;
    if (below(24) == 0) /* raw bytes, including check sums */
        return LLVMFuzzerMutate(bytes, size, room);
    forged f;
    forge_open(&f, bytes, size, MOST_RAW);
    if (f.count == 0) {
        forge_release(&f);
        size_t i = below(SEED_COUNT), start = made[i].size < room ? made[i].size : room;
        memcpy(bytes, made[i].bytes, start);
        return start;
    }
    for (uint32_t times = 1 + below(3); times && f.count; times--)
        mutate_chunks(&f, size < room ? room - size : 0);
    if (below(8))
        forge_hashes(&f);
    size_t written = forge_write(&f, below(16) != 0, bytes, room);
    if (written && below(3) == 0 && is_small(bytes, written)) {
        forge_steps(&f, bytes, written);
        written = forge_write(&f, true, bytes, room);
    }
    forge_release(&f);
    if (written > 8 && below(32) == 0)
        written -= below(written - 8);
    return written ? written : LLVMFuzzerMutate(bytes, size, room);
}

/* Replaces some chunks of one recording by chunks of the other. */
size_t LLVMFuzzerCustomCrossOver(const uint8_t *a, size_t a_size, const uint8_t *b, size_t b_size, uint8_t *to,
                                 size_t room, unsigned int number)
{
    forged f, g;
    random_state = number;
    forge_open(&f, a, a_size, MOST_RAW);
    forge_open(&g, b, b_size, MOST_RAW);
    for (uint32_t times = 1 + below(4); times && f.count && g.count; times--) {
        size_t place = below(f.count), from = below(g.count), as = place;
        for (size_t i = 0; i < f.count; i++) /* a chunk of the same type, if there is one */
            if (f.chunk[(place + i) % f.count].type == g.chunk[from].type) {
                as = (place + i) % f.count;
                break;
            }
        if (below(4))
            forge_remove(&f, as);
        forge_insert(&f, as, g.chunk[from].type, g.chunk[from].flags, g.chunk[from].step, g.chunk[from].data,
                     g.chunk[from].size);
    }
    if (f.count)
        forge_hashes(&f);
    size_t written = forge_write(&f, true, to, room);
    forge_release(&f);
    forge_release(&g);
    return written;
}

#else

/* ---- As a program ---- */

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--make") == 0) {
        for (size_t i = 0; i < SEED_COUNT; i++) {
            char path[1024];
            size_t size;
            uint8_t *bytes = make_seed(&SEEDS[i], &size);
            snprintf(path, sizeof path, "%s/%s", argv[2], SEEDS[i].name);
            FILE *file = fopen(path, "wb");
            HOLDS(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
            free(bytes);
        }
        return 0;
    }
    make_seeds();
    const int code = read_arguments(argc, argv, "recordings");
    for (size_t i = 0; i < SEED_COUNT; i++) {
        rheo_recording_close(made[i].r);
        free(made[i].bytes);
    }
    return code;
}

#endif
