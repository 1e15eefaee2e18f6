/* Whether the figures of an experiment are what they must be. */
#include "cli/experiment.h"

#include <math.h>
#include <string.h>

/* Index of a name in a table; the number of its entries if there is none. */
static uint32_t index_of(const cli_quantity *quantity, const char *name)
{
    uint32_t i = 0;
    while (i < CLI_MOST_FIGURES && quantity[i].name && strcmp(quantity[i].name, name) != 0)
        i++;
    return i;
}

static uint32_t variant_of(const cli_experiment *e, const char *name)
{
    uint32_t i = 0;
    while (i < CLI_MOST_VARIANTS && e->variant[i].name && strcmp(e->variant[i].name, name) != 0)
        i++;
    return i;
}

bool cli_experiment_is_finished(const cli_result *r)
{
    return r->finished == (size_t)r->variants * r->seeds;
}

uint32_t cli_finished_seeds(const cli_result *r, uint32_t variant)
{
    return (uint32_t)(r->finished / r->variants + (variant < r->finished % r->variants));
}

double cli_figure_of(const cli_result *r, uint32_t variant, uint32_t figure, uint32_t seed)
{
    return variant < r->variants ? r->figure[((size_t)variant * r->seeds + seed) * r->figures + figure]
                                 : r->whole[(size_t)seed * r->wholes + figure];
}

const cli_series *cli_series_of(const cli_result *r, uint32_t variant, uint32_t seed)
{
    return &r->series[(size_t)variant * r->seeds + seed];
}

static double value_of(const cli_result *r, const char *figure, const char *variant, uint32_t seed)
{
    const cli_experiment *e = r->experiment;
    return variant ? cli_figure_of(r, variant_of(e, variant), index_of(e->figure, figure), seed)
                   : cli_figure_of(r, r->variants, index_of(e->whole, figure), seed);
}

static bool holds(const cli_result *r, const cli_claim *c, uint32_t seed)
{
    const double value = value_of(r, c->figure, c->variant, seed),
                 bound = c->of ? c->plus + c->factor * value_of(r, c->of, c->of_variant, seed) : c->plus;
    if (isinf(value))
        return c->or_never && c->relation == CLI_AT_LEAST && !isinf(bound);
    return c->relation == CLI_AT_LEAST ? value >= bound : value <= bound;
}

bool cli_claim_counts(const cli_result *r, uint32_t claim)
{
    return !r->small || !r->experiment->claim[claim].not_small;
}

bool cli_experiment_judge(cli_result *r)
{
    bool all = true;
    for (uint32_t k = 0; k < r->claims; k++) {
        r->holds[k] = true;
        for (uint32_t seed = 0; seed < r->seeds && cli_claim_counts(r, k); seed++)
            r->holds[k] = r->holds[k] && holds(r, &r->experiment->claim[k], seed);
        all = all && r->holds[k];
    }
    return all;
}

static void put_figure(char *text, size_t size, const char *figure, const char *variant)
{
    snprintf(text, size, "%s%s%s", figure, variant ? " of " : "", variant ? variant : "");
}

void cli_claim_text(const cli_claim *c, char *text, size_t size)
{
    char bound[160] = "", number[32];
    if (c->of && c->factor != 1) {
        snprintf(number, sizeof number, "%.4g", c->factor);
        snprintf(bound, sizeof bound, "%s x ", number);
    }
    if (c->of)
        put_figure(bound + strlen(bound), sizeof bound - strlen(bound), c->of, c->of_variant);
    if (!c->of || c->plus != 0) {
        snprintf(number, sizeof number, "%.4g", c->plus);
        snprintf(bound + strlen(bound), sizeof bound - strlen(bound), "%s%s", c->of ? " + " : "", number);
    }
    put_figure(text, size, c->figure, c->variant);
    snprintf(text + strlen(text), size - strlen(text), " %s %s", c->relation == CLI_AT_LEAST ? ">=" : "<=", bound);
}

void cli_figure_range(const cli_result *r, uint32_t variant, uint32_t figure, double range[3])
{
    double sorted[CLI_MOST_SEEDS];
    const uint32_t seeds = cli_finished_seeds(r, variant);
    range[0] = range[1] = range[2] = (double)NAN;
    for (uint32_t seed = 0; seed < seeds; seed++) {
        const double value = cli_figure_of(r, variant, figure, seed);
        uint32_t at = seed;
        for (; at > 0 && sorted[at - 1] > value; at--)
            sorted[at] = sorted[at - 1];
        sorted[at] = value;
    }
    if (!seeds)
        return;
    range[0] = sorted[0];
    range[1] = sorted[seeds / 2];
    range[2] = sorted[seeds - 1];
}
