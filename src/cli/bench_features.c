/*
 * rheolog bench features: what each part of a model costs. A scene with a part is compared with its base, the same scene
 * without it: stages, fields, bytes and time that the part adds.
 */
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum part {
    SPRINGS = 1,
    HISTORY = 2,
    BALL = 4,
    WALLS = 8,
    VIBRATORS = 16,
    MATERIAL = 32,
    PERIOD = 64,
    PLATES = 128,
    CURVE = 256,
    RECORDED = 512,
    MELTING = 1024,
    WARM = 2048
};

/* A scene without walls has no gravity, because the fluid would fall apart. */
static const struct {
    const char *name, *base;
    unsigned has;
    const char *set[2]; /* KEY=VALUE */
} FEATURES[] = {
    {"fluid", "fluid", 0, {NULL}},
    {"walls", "fluid", WALLS, {NULL}},
    {"springs", "fluid", SPRINGS, {NULL}},
    {"springs, walls", "walls", SPRINGS | WALLS, {NULL}},
    {"history", "springs", SPRINGS | HISTORY, {NULL}},
    {"history, lag", "history", SPRINGS | HISTORY, {"history.lag=30"}},
    {"history, curve", "history", SPRINGS | HISTORY | CURVE, {NULL}},
    {"history, full", "history", SPRINGS | HISTORY, {"history.kind=full"}},
    {"history, of length", "history", SPRINGS | HISTORY, {"history.of=length"}},
    {"history, passive", "history", SPRINGS | HISTORY, {"history.hardening=passive"}},
    {"materials", "history", SPRINGS | HISTORY | MATERIAL, {NULL}},
    {"substeps, 4", "springs", SPRINGS, {"substeps=4"}},
    {"ball", "fluid", BALL, {NULL}},
    {"ball, pushed", "ball", BALL, {"ball.push=[0, -1, 0]"}},
    {"ball, walls", "walls", BALL | WALLS, {NULL}},
    {"vibrators, walls", "walls", VIBRATORS | WALLS, {NULL}},
    {"periodic space", "fluid", PERIOD, {NULL}},
    {"plates", "periodic space", PERIOD | PLATES, {"plates.velocity=[1, 0, 0]"}},
    {"resolution 0.8", "fluid", 0, {"resolution=0.8"}},
    {"recorded", "fluid", RECORDED, {NULL}},
    {"all but vibrators", "fluid", SPRINGS | HISTORY | BALL | WALLS, {NULL}},
    {"all", "fluid", SPRINGS | HISTORY | BALL | WALLS | VIBRATORS, {NULL}},
    {"sequential", "fluid", 0, {"scheme=sequential"}},
    {"sequential, springs", "sequential", SPRINGS, {"scheme=sequential"}},
    {"positions", "fluid", 0, {"scheme=positions"}},
    {"positions, history", "positions", SPRINGS | HISTORY, {"scheme=positions"}},
    {"melting", "melting", MELTING, {"melting.viscosity=0"}},
    {"melting, walls", "melting", MELTING | WALLS, {"melting.viscosity=0"}},
    {"melting, viscosity", "melting", MELTING, {NULL}},
    {"melting, nested", "melting, viscosity", MELTING, {"melting.stress=nested"}},
    {"melting, explicit", "melting, viscosity", MELTING, {"melting.solver=explicit"}},
    {"melting, warm", "melting, viscosity", MELTING | WARM, {"melting.diffusivity=0"}},
    {"melting, heat", "melting, warm", MELTING | WARM, {NULL}},
    {"melting, summed", "melting", MELTING, {"melting.viscosity=0", "melting.density=summation"}},
    {"melting, frozen", "melting, frozen", MELTING | WARM, {"melting.flow=frozen"}},
};
enum { COUNT = sizeof FEATURES / sizeof *FEATURES };

/* ---- Scenes ---- */

static bool add_vibrators(cli_bench_case *c)
{
    rheo_world_def *def = &c->scene.world;
    rheo_scene vibration;
    if (rheo_scene_builtin("vibration", &vibration, NULL) != RHEO_OK)
        return false;
    const double *size = c->scene.fill[0].max, *its = vibration.fill[0].max;
    const double(*position)[2] = vibration.world.vibrators.position;
    bool enough = true;
    def->vibrators = vibration.world.vibrators;
    def->vibrators.position = (const double(*)[2])c->scene.owned.position;
    def->vibrators.count = 0;
    for (uint32_t i = 0; i < vibration.world.vibrators.count && enough; i++)
        enough = rheo_scene_add_vibrator(&c->scene, position[i][0] * size[0] / its[0],
                                         position[i][1] * size[2] / its[2], NULL) == RHEO_OK;
    def->springs.solver = vibration.world.springs.solver; /* the explicit solver becomes unstable with vibrators */
    rheo_scene_release(&vibration);
    return enough;
}

/* The power law of order 1/2 as far as the window reaches. */
static void add_curve(rheo_world_def *def)
{
    enum { POINTS = 30 };
    static rheo_curve_point curve[POINTS];
    for (int i = 0; i < POINTS; i++) {
        curve[i].age = def->step * def->history.window * (i + 1) / POINTS;
        curve[i].weight = 1 / sqrt(3.14159265358979323846 * curve[i].age);
    }
    def->history.curve = curve;
    def->history.curve_count = POINTS;
}

static bool add_thickening_parts(cli_bench_case *c, unsigned has)
{
    rheo_world_def *def = &c->scene.world;
    const double *size = c->scene.fill[0].max;
    if (!(has & SPRINGS))
        def->springs.stiffness = 0;
    if (!(has & HISTORY))
        cli_bench_set_window(c, 0);
    if (!(has & BALL)) {
        def->ball.radius = 0;
        c->scene.ball.clearance = -1;
    }
    for (int axis = 0; axis < 3; axis += 2)
        def->space.period[axis] = has & PERIOD ? size[axis] : 0;
    if (has & PLATES) {
        def->plates.lower = 2 * def->fluid.spacing;
        def->plates.upper = size[1] - 2 * def->fluid.spacing;
    }
    if (has & CURVE)
        add_curve(def);
    if (has & MATERIAL) {
        rheo_material stiff = rheo_default_material("stiff");
        stiff.history.stiffness = 2 * def->history.stiffness;
        if (rheo_world_def_add_material(def, &stiff, NULL) != RHEO_OK)
            return false;
    }
    return !(has & VIBRATORS) || add_vibrators(c);
}

/* The box has a tenth of the particles, because its steps have many substeps. */
static void add_melting_parts(cli_bench_case *c, unsigned has, uint64_t particles)
{
    c->scene.particles = particles / 10;
    c->lead = 1;
    c->window = 0;
    if (!(has & WARM)) {
        c->scene.owned.fill[0].has_temperature = false;
        c->scene.owned.fill[0].temperature[1] = 0;
        c->scene.world.melting.temperature = 1;
    }
}

static const char *scene_of(unsigned has)
{
    return has & MELTING ? "melting-box" : "bowling-ball";
}

static int set_all(cli_bench_case *c, const char *const set[2])
{
    for (int i = 0; i < 2 && set[i]; i++) {
        char key[64];
        const char *value = NULL;
        rheo_error error = {""};
        const int status = cli_split_setting(&cli_bench, set[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
        const rheo_result result = rheo_scene_set(&c->scene, key, value, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

static int add_feature(cli_bench_cases *cases, uint64_t particles, size_t f)
{
    const unsigned has = FEATURES[f].has;
    cli_bench_case *c = cli_bench_add(cases, scene_of(has), has & MELTING ? 0 : particles);
    if (!c)
        return cli_fail(CLI_SYSTEM, "no memory for the cases");
    rheo_world_def *def = &c->scene.world;
    snprintf(c->name, sizeof c->name, "%s", FEATURES[f].name);
    c->recorded = has & RECORDED;
    if (has & MELTING)
        add_melting_parts(c, has, particles);
    else if (!add_thickening_parts(c, has))
        return cli_fail(CLI_SYSTEM, "no memory for the parts of %s", c->name);
    if (!(has & WALLS)) {
        def->walls.count = 0;
        memset(def->gravity, 0, sizeof def->gravity);
    }
    return set_all(c, FEATURES[f].set);
}

/* ---- What a part adds ---- */

static const cli_bench_case *base_of(const cli_bench_cases *cases, const cli_bench_case *c)
{
    const char *base = FEATURES[c - cases->item].base;
    const cli_bench_case *found = cases->item;
    while (strcmp(found->name, base) != 0)
        found++;
    return found;
}

/* Time of the stages that the base has, too. */
static double common_of(const cli_bench_case *base, const cli_bench_case *c)
{
    double sum = 0;
    for (uint32_t s = 0; s < c->stages; s++)
        sum += cli_bench_has_stage(base, c->stage[s]) ? cli_bench_stage(c, c->stage[s]) : 0;
    return sum;
}

static double stages_of(const cli_bench_case *c)
{
    double sum = 0;
    for (uint32_t s = 0; s < c->stages; s++)
        sum += cli_bench_stage(c, c->stage[s]);
    return sum;
}

enum { LIST = 256 };

static void append(char text[LIST], const char *sign, const char *name)
{
    const size_t length = strlen(text);
    snprintf(text + length, LIST - length, "%s%s%s", length ? " " : "", sign, name);
}

/* Stages, or fields, that a scene has beside those of another. */
static void list_stages(char text[LIST], const char *sign, const cli_bench_case *c, const cli_bench_case *other)
{
    for (uint32_t s = 0; s < c->stages; s++)
        if (!cli_bench_has_stage(other, c->stage[s]))
            append(text, sign, c->stage[s]);
}

static bool has_field(const cli_bench_case *c, const char *name)
{
    for (uint32_t f = 0; f < c->fields; f++)
        if (strcmp(c->field[f], name) == 0)
            return true;
    return false;
}

static void list_fields(char text[LIST], const char *sign, const cli_bench_case *c, const cli_bench_case *other)
{
    for (uint32_t f = 0; f < c->fields; f++)
        if (!has_field(other, c->field[f]))
            append(text, sign, c->field[f]);
}

/* Stages and fields with + that the scene has and its base lacks, and with - the other way round. */
static void list_changes(const cli_bench_cases *cases, const cli_bench_case *c, char stages[LIST], char fields[LIST])
{
    const cli_bench_case *base = base_of(cases, c);
    stages[0] = fields[0] = 0;
    list_stages(stages, "+", c, base);
    list_stages(stages, "-", base, c);
    list_fields(fields, "+", c, base);
    list_fields(fields, "-", base, c);
}

/* The least time of a step: a busy machine only ever adds to it. */
static double least_of(const cli_bench_case *c)
{
    return cli_bench_least(c->total, c->repetitions);
}

/* State and memory of the library, in bytes per particle. */
static double state_of(const cli_bench_case *c)
{
    return cli_bench_per_particle(c, c->field_bytes);
}

static double world_of(const cli_bench_case *c)
{
    return cli_bench_per_particle(c, c->world_bytes);
}

/* ---- Reports ---- */

static void print_features(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    cli_bench_print_head(a, cli_bench_per_step);
    printf("%-19s %-18s %6s %8s %13s %8s %8s %7s %7s %7s %8s %7s %7s  %s\n", "scene with", "is added to", "neigh.",
           "all", "least-most", "common", "own", "rest", "state", "world", "+all", "+state", "+world",
           "stages and fields");
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i], *base = base_of(cases, c);
        const double common = common_of(base, c);
        char stages[LIST], fields[LIST];
        list_changes(cases, c, stages, fields);
        printf("%-19s %-18s %6.1f", c->name, base == c ? "" : base->name, c->neighbours);
        cli_bench_print_spread(c, 1);
        printf(" %8.1f %8.1f %7.1f %7.0f %7.0f", common, stages_of(c) - common, cli_bench_rest(c), state_of(c),
               world_of(c));
        if (base == c)
            printf(" %8s %7s %7s\n", "", "", "");
        else
            printf(" %+8.1f %+7.0f %+7.0f  %s%s%s\n", least_of(c) - least_of(base), state_of(c) - state_of(base),
                   world_of(c) - world_of(base), stages, stages[0] && fields[0] ? "; " : "", fields);
    }
    puts(
        "\ncommon: the stages that the scene it is added to has, too; own: the other stages; rest: time of a step\n"
        "outside all stages. all = common + own + rest: a part that a scene lacks has no stage and no field, and costs\n"
        "nothing. common changes with the number of neighbours, and if a ball or vibrators stir the fluid. state,\n"
        "world: bytes per particle that are saved, and that the library holds. +all, +state, +world: more than in the\n"
        "scene that it is added to. Scenes without walls have no gravity, or the fluid would fall apart.");
    for (uint32_t i = 0; i < cases->count; i++)
        if (cases->item[i].recorded)
            printf("%s: the recording grows by %.0f bytes in a step.\n", cases->item[i].name,
                   cases->item[i].recorded_bytes);
}

static void own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c)
{
    const cli_bench_case *base = base_of(cases, c);
    const double common = common_of(base, c);
    char stages[LIST], fields[LIST];
    list_changes(cases, c, stages, fields);
    cli_bench_cell_number(table, "ns_common", 2, common);
    cli_bench_cell_number(table, "ns_own", 2, stages_of(c) - common);
    cli_bench_cell_text(table, "base", base == c ? "" : base->name);
    cli_bench_cell_text(table, "stages", stages);
    cli_bench_cell_text(table, "fields", fields);
    cli_bench_cell_number(table, "more_ns", 2, least_of(c) - least_of(base));
    cli_bench_cell_number(table, "more_bytes_state", 1, state_of(c) - state_of(base));
    cli_bench_cell_number(table, "more_bytes_world", 1, world_of(c) - world_of(base));
    cli_bench_cell_number(table, "bytes_recorded", 1, c->recorded_bytes);
}

int cli_bench_run_features(cli_bench_arguments *a)
{
    cli_bench_cases cases = {0};
    for (size_t f = 0; f < COUNT; f++) {
        const int status = add_feature(&cases, a->particles, f);
        if (status != CLI_DONE) {
            cli_bench_release(&cases);
            return status;
        }
    }
    return cli_bench_report(&cases, a, print_features, own_cells);
}
