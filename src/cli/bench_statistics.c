/* Statistics of measured cases: medians, and the list of all stages. */
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

double cli_bench_median(const double *values, uint32_t count)
{
    double sorted[CLI_BENCH_MAX_REPETITIONS];
    if (count == 0)
        return 0;
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare);
    return count % 2 ? sorted[count / 2] : (sorted[count / 2 - 1] + sorted[count / 2]) / 2;
}

double cli_bench_least(const double *values, uint32_t count)
{
    double least = count ? values[0] : 0;
    for (uint32_t i = 1; i < count; i++)
        least = values[i] < least ? values[i] : least;
    return least;
}

double cli_bench_largest(const double *values, uint32_t count)
{
    double largest = count ? values[0] : 0;
    for (uint32_t i = 1; i < count; i++)
        largest = values[i] > largest ? values[i] : largest;
    return largest;
}

void cli_bench_median_range(const double *values, uint32_t count, double range[2])
{
    double sorted[CLI_BENCH_MAX_REPETITIONS];
    range[0] = range[1] = 0;
    if (count == 0)
        return;
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare);
    /* Probability that at most `end` of the values are below the median: each of them is with probability 1/2. */
    uint32_t end = 0;
    double exactly = pow(.5, count), at_most = exactly;
    while (2 * end + 3 < count) {
        exactly *= (double)(count - end) / (end + 1);
        if (2 * (at_most + exactly) > .05)
            break;
        at_most += exactly;
        end++;
    }
    range[0] = sorted[end];
    range[1] = sorted[count - 1 - end];
}

bool cli_bench_has_stage(const cli_bench_case *c, const char *stage)
{
    for (uint32_t s = 0; s < c->stages; s++)
        if (strcmp(c->stage[s], stage) == 0)
            return true;
    return false;
}

double cli_bench_stage(const cli_bench_case *c, const char *stage)
{
    for (uint32_t s = 0; s < c->stages; s++)
        if (strcmp(c->stage[s], stage) == 0)
            return cli_bench_median(c->stage_ns[s], c->repetitions);
    return 0;
}

uint32_t cli_bench_all_stages(const cli_bench_cases *cases, char stage[CLI_BENCH_MAX_STAGES][32])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < cases->count; i++) {
        uint32_t next = 0; /* index after the previous stage of this case */
        for (uint32_t s = 0; s < cases->item[i].stages; s++) {
            const char *name = cases->item[i].stage[s];
            uint32_t found = 0;
            while (found < count && strcmp(stage[found], name) != 0)
                found++;
            if (found == count) {
                if (count == CLI_BENCH_MAX_STAGES)
                    continue;
                memmove(stage[next + 1], stage[next], (count - next) * sizeof stage[0]);
                snprintf(stage[next], sizeof stage[0], "%s", name);
                count++;
                found = next;
            }
            next = found + 1;
        }
    }
    return count;
}

double cli_bench_total(const cli_bench_case *c)
{
    return cli_bench_median(c->total, c->repetitions);
}

double cli_bench_rest(const cli_bench_case *c)
{
    return cli_bench_median(c->rest, c->repetitions);
}

double cli_bench_per_particle(const cli_bench_case *c, size_t bytes)
{
    return c->particles ? (double)bytes / c->particles : 0;
}
