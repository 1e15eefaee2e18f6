/*
 * rheolog bench scenes: whole runs from step 0. The other measurements time calm steps in a settled fluid; here balls
 * fall in and a floor shakes, so neighbours change quickly and substeps are many.
 */
#include "cli/bench.h"

#include <string.h>

/* Steps of a quick impression of each scene. */
static const struct {
    const char *name;
    uint64_t steps;
} SCENES[] = {
    {"bowling-ball", 300},       /* falls in, dips, rolls and stops */
    {"bowling-ball-small", 200}, /* falls in from higher, dips, is carried */
    {"vibration", 150},
};

/* Finds the name with this index in a list with commas. */
static bool name_at(const char *list, uint32_t index, char name[48])
{
    for (; index > 0 && *list; index--) {
        list += strcspn(list, ",");
        list += *list == ',';
    }
    snprintf(name, 48, "%.*s", (int)strcspn(list, ","), list);
    return *list != 0;
}

bool cli_bench_next_scene(const cli_bench_arguments *a, uint32_t index, char name[48], uint64_t *steps)
{
    enum { COUNT = sizeof SCENES / sizeof *SCENES, STEPS = 100 };
    *steps = STEPS;
    if (a->scenes ? !name_at(a->scenes, index, name) : index >= COUNT)
        return false;
    if (!a->scenes)
        snprintf(name, 48, "%s", SCENES[index].name);
    for (size_t i = 0; i < COUNT; i++)
        if (strcmp(SCENES[i].name, name) == 0)
            *steps = SCENES[i].steps;
    if (a->steps)
        *steps = a->steps;
    return true;
}

static void print_scenes(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    printf("%s, %s, %s, simd %s; %u repetition%s%s\n", cli_bench_machine(), cli_compiler(), cli_real(), rheo_simd(),
           a->repetitions, cli_plural(a->repetitions), cli_bench_per_step);
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        printf("\n%s%s%s, %u particles, steps 0 to %llu, %.1f neighbours, %.2f substeps per step\n", c->name,
               *c->scheme ? ", scheme " : "", c->scheme, c->particles, (unsigned long long)c->steps, c->neighbours,
               c->substeps);
        for (uint32_t s = 0; s < c->stages; s++)
            printf("  %-22s %8.2f\n", c->stage[s], cli_bench_stage(c, c->stage[s]));
        printf("  %-22s %8.2f\n  %-22s", "the rest", cli_bench_rest(c), "all");
        cli_bench_print_spread(c, 1);
        putchar('\n');
    }
}

static void own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c)
{
    (void)cases;
    cli_bench_cell_number(table, "substeps", 2, c->substeps);
}

int cli_bench_run_scenes(cli_bench_arguments *a)
{
    cli_bench_cases cases = {0};
    char name[48];
    uint64_t steps;
    for (uint32_t i = 0; cli_bench_next_scene(a, i, name, &steps); i++) {
        cli_bench_case *c = cli_bench_add(&cases, name, 0);
        if (!c)
            return cli_bench_no_memory(&cases);
        c->lead = c->warm_up = 0;
        c->steps = steps;
    }
    return cli_bench_report(&cases, a, print_scenes, own_cells);
}
