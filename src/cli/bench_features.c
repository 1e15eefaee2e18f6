/* rheolog bench features: scenes with and without springs, history, ball, walls and vibrators. */
#include "cli/bench.h"

#include <string.h>

enum { SPRINGS = 1, HISTORY = 2, BALL = 4, WALLS = 8, VIBRATORS = 16 };

/* A scene without walls has no gravity, because the fluid would fall apart. */
static const struct {
    const char *name;
    unsigned has;
} FEATURES[] = {
    {"fluid", 0},
    {"walls", WALLS},
    {"springs", SPRINGS},
    {"springs, walls", SPRINGS | WALLS},
    {"history", SPRINGS | HISTORY},
    {"ball", BALL},
    {"ball, walls", BALL | WALLS},
    {"vibrators, walls", VIBRATORS | WALLS},
    {"all but vibrators", SPRINGS | HISTORY | BALL | WALLS},
    {"all", SPRINGS | HISTORY | BALL | WALLS | VIBRATORS},
};

static cli_bench_case *add_features(cli_bench_cases *cases, uint64_t particles, const char *name, unsigned has)
{
    cli_bench_case *c = cli_bench_add(cases, "bowling-ball", particles);
    if (!c)
        return NULL;
    rheo_world_def *def = &c->scene.world;
    snprintf(c->name, sizeof c->name, "%s", name);
    if (!(has & SPRINGS))
        def->springs.stiffness = 0;
    if (!(has & HISTORY))
        cli_bench_set_window(c, 0);
    if (!(has & BALL)) {
        def->ball.radius = 0;
        c->scene.ball.clearance = -1;
    }
    if (!(has & WALLS)) {
        def->walls.count = 0;
        memset(def->gravity, 0, sizeof def->gravity);
    }
    if (has & VIBRATORS) {
        rheo_scene vibration;
        if (rheo_scene_builtin("vibration", &vibration, NULL) != RHEO_OK)
            return NULL;
        const double *size = c->scene.fill[0].max, *its = vibration.fill[0].max;
        const double(*position)[2] = vibration.world.vibrators.position;
        bool enough = true;
        def->vibrators = vibration.world.vibrators;
        def->vibrators.position = (const double(*)[2])c->scene.owned.position;
        def->vibrators.count = 0;
        for (uint32_t i = 0; i < vibration.world.vibrators.count && enough; i++)
            enough = rheo_scene_add_vibrator(&c->scene, position[i][0] * size[0] / its[0],
                                             position[i][1] * size[2] / its[2], NULL) == RHEO_OK;
        def->springs.solver =
            vibration.world.springs.solver; /* the explicit solver becomes unstable with vibrators */
        rheo_scene_release(&vibration);
        if (!enough)
            return NULL;
    }
    return c;
}

/* Time of the stages that are common to all cases. */
static double common_of(const cli_bench_cases *cases, const cli_bench_case *c)
{
    double sum = 0;
    for (uint32_t s = 0; s < c->stages; s++) {
        bool common = true;
        for (uint32_t i = 0; i < cases->count; i++)
            common = common && cli_bench_has_stage(&cases->item[i], c->stage[s]);
        sum += common ? cli_bench_stage(c, c->stage[s]) : 0;
    }
    return sum;
}

static double stages_of(const cli_bench_case *c)
{
    double sum = 0;
    for (uint32_t s = 0; s < c->stages; s++)
        sum += cli_bench_stage(c, c->stage[s]);
    return sum;
}

static void print_features(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    cli_bench_print_head(a, cli_bench_per_step);
    printf("%-16s %6s %8s %13s %8s %8s %7s %7s %7s  %s\n", "scene with", "neigh.", "all", "least-most", "common",
           "own", "rest", "state", "world", "own stages");
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        const double common = common_of(cases, c);
        printf("%-16s %6.1f", c->name, c->neighbours);
        cli_bench_print_spread(c, 1);
        printf(" %8.1f %8.1f %7.1f %7.0f %7.0f ", common, stages_of(c) - common, cli_bench_rest(c),
               cli_bench_per_particle(c, c->field_bytes), cli_bench_per_particle(c, c->world_bytes));
        for (uint32_t s = 0; s < c->stages; s++) {
            bool everywhere = true;
            for (uint32_t other = 0; other < cases->count; other++)
                everywhere = everywhere && cli_bench_has_stage(&cases->item[other], c->stage[s]);
            if (!everywhere)
                printf(" %s %.1f", c->stage[s], cli_bench_stage(c, c->stage[s]));
        }
        putchar('\n');
    }
    fputs("\ncommon: the stages that every scene has:", stdout);
    const cli_bench_case *first = &cases->item[0];
    for (uint32_t s = 0; s < first->stages; s++) {
        bool everywhere = true;
        for (uint32_t i = 1; i < cases->count; i++)
            everywhere = everywhere && cli_bench_has_stage(&cases->item[i], first->stage[s]);
        if (everywhere)
            printf(" %s", first->stage[s]);
    }
    puts(".\nown: the other stages; rest: time of a step outside all stages. all = common + own + rest: a feature\n"
         "that a scene lacks has no stage and costs nothing. common changes with the number of neighbours, and if a\n"
         "ball or vibrators stir the fluid. state, world: bytes per particle that are saved, and that the library\n"
         "holds. Scenes without walls have no gravity, or the fluid would fall apart.");
}

static void own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c)
{
    const double common = common_of(cases, c);
    cli_bench_cell_number(table, "ns_common", 2, common);
    cli_bench_cell_number(table, "ns_own", 2, stages_of(c) - common);
}

int cli_bench_run_features(cli_bench_arguments *a)
{
    cli_bench_cases cases = {0};
    for (size_t f = 0; f < sizeof FEATURES / sizeof *FEATURES; f++)
        if (!add_features(&cases, a->particles, FEATURES[f].name, FEATURES[f].has))
            return cli_bench_no_memory(&cases);
    return cli_bench_report(&cases, a, print_features, own_cells);
}
