/* rheolog bench limits: compares each stage with the shortest possible time of its work on this machine. */
#include "cli/bench.h"

#include <math.h>

static void print_machine(const cli_bench_limits *l)
{
    char memory[32], cache[32];
    cli_bytes(l->memory_bytes, memory, sizeof memory);
    cli_bytes(l->cache_bytes, cache, sizeof cache);
    printf(
        "this machine at best, one core, simd %s: %.1f G/s additions and multiplications, %.2f G/s square "
        "roots,\n%.2f G/s divisions; memory %.1f GB/s read, %.1f copied (arrays of %s); caches %.1f, %.1f (%s)\n\n",
        rheo_simd(), l->arithmetic, l->root, l->division, l->memory_read, l->memory_copy, memory, l->cache_read,
        l->cache_copy, cache);
}

/* Prints each stage with its limit. The last stage, "", is the rest of the step. */
static void print_stages(const cli_bench_case *c, const cli_bench_limits *limits)
{
    printf("%s, scheme %s, d = %u, %u particles, %.1f neighbours\n", c->name, c->scheme, c->window, c->particles,
           c->neighbours);
    printf("  %-22s %8s %7s %8s %6s %6s %7s %7s %7s  %s\n", "stage", "ns", "share", "operat.", "roots", "div.",
           "bytes", "limit", "reached", "set by");
    double sum = 0;
    const double total = cli_bench_total(c);
    for (uint32_t s = 0; s <= c->stages; s++) {
        const char *stage = s < c->stages ? c->stage[s] : "";
        const double ns = *stage ? cli_bench_stage(c, stage) : cli_bench_rest(c);
        cli_bench_needs needs;
        printf("  %-22s %8.2f %5.1f %%", *stage ? stage : "the rest", ns, total > 0 ? 100 * ns / total : 0);
        if (cli_bench_stage_needs(c, stage, &needs)) {
            const char *bound;
            const double limit = cli_bench_limit(limits, &needs, &bound);
            sum += limit;
            printf(" %8.0f %6.1f %6.1f %7.0f %7.2f %5.0f %%  %s", needs.operations, needs.roots, needs.divisions,
                   needs.bytes, limit, ns > 0 ? 100 * limit / ns : 0, bound);
        }
        putchar('\n');
    }
    printf("  %-22s %8.2f %5.1f %% %8s %6s %6s %7s %7.2f %5.0f %%\n", "all", total, 100., "", "", "", "", sum,
           total > 0 ? 100 * sum / total : 0);
}

static void list_stages(const cli_bench_case *c, const cli_bench_limits *limits, const cli_bench_arguments *a)
{
    cli_bench_table table = {.json = a->json};
    for (uint32_t s = 0; s <= c->stages; s++) {
        const char *stage = s < c->stages ? c->stage[s] : "";
        const double ns = *stage ? cli_bench_stage(c, stage) : cli_bench_rest(c);
        char hash[17];
        cli_bench_needs needs;
        const char *bound = "";
        const bool known = cli_bench_stage_needs(c, stage, &needs);
        const double limit = known ? cli_bench_limit(limits, &needs, &bound) : NAN;
        snprintf(hash, sizeof hash, "%016llx", (unsigned long long)c->hash);
        cli_bench_cell_text(&table, "case", c->name);
        cli_bench_cell_whole(&table, "particles", c->particles);
        cli_bench_cell_whole(&table, "window", c->window);
        cli_bench_cell_text(&table, "scheme", c->scheme);
        cli_bench_cell_text(&table, "stage", *stage ? stage : "rest");
        cli_bench_cell_number(&table, "ns_median", 3, ns);
        cli_bench_cell_number(&table, "operations", 1, known ? needs.operations : NAN);
        cli_bench_cell_number(&table, "roots", 1, known ? needs.roots : NAN);
        cli_bench_cell_number(&table, "divisions", 1, known ? needs.divisions : NAN);
        cli_bench_cell_number(&table, "bytes", 1, known ? needs.bytes : NAN);
        cli_bench_cell_number(&table, "ns_limit", 3, limit);
        cli_bench_cell_number(&table, "reached", 3, known && ns > 0 ? limit / ns : NAN);
        cli_bench_cell_text(&table, "set_by", bound);
        cli_bench_cell_text(&table, "hash", hash);
        cli_bench_cell_number(&table, "machine_operations", 2, limits->arithmetic);
        cli_bench_cell_number(&table, "machine_roots", 2, limits->root);
        cli_bench_cell_number(&table, "machine_divisions", 2, limits->division);
        cli_bench_cell_number(&table, "machine_memory_read", 2, limits->memory_read);
        cli_bench_cell_number(&table, "machine_memory_copy", 2, limits->memory_copy);
        cli_bench_cell_number(&table, "machine_cache_read", 2, limits->cache_read);
        cli_bench_cell_number(&table, "machine_cache_copy", 2, limits->cache_copy);
        cli_bench_cell_build(&table);
        cli_bench_end_row(&table);
    }
}

int cli_bench_print_limits(const cli_bench_case *c)
{
    cli_bench_limits limits;
    if (!cli_bench_measure_limits(&limits))
        return cli_fail(CLI_SYSTEM, "no memory to measure the machine's limits");
    print_machine(&limits);
    print_stages(c, &limits);
    return CLI_DONE;
}

static int list_limits(const cli_bench_case *c, const cli_bench_arguments *a)
{
    cli_bench_limits limits;
    if (!cli_bench_measure_limits(&limits))
        return cli_fail(CLI_SYSTEM, "no memory to measure the machine's limits");
    list_stages(c, &limits, a);
    return CLI_DONE;
}

int cli_bench_run_limits(cli_bench_arguments *a)
{
    cli_bench_cases cases = {0};
    if (!cli_bench_add(&cases, "bowling-ball", a->particles))
        return cli_bench_no_memory(&cases);
    int status = cli_bench_measure(&cases, a);
    if (status == CLI_DONE && (a->csv || a->json)) {
        status = list_limits(&cases.item[0], a);
    } else if (status == CLI_DONE) {
        cli_bench_print_head(a, cli_bench_per_step);
        status = cli_bench_print_limits(&cases.item[0]);
    }
    cli_bench_release(&cases);
    return status;
}
