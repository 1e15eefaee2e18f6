/* Prints the results of an experiment as text and JSON. */
#include "cli/experiment.h"

#include <math.h>
#include <string.h>

/* ---- Text ---- */

static void figure_text(double value, char *text, size_t size)
{
    if (isinf(value))
        snprintf(text, size, "never");
    else if (isnan(value))
        snprintf(text, size, "-");
    else
        snprintf(text, size, "%.3g", value);
}

/* The middle of the seeds, and how far the others are from it. */
static void cell_text(const cli_result *r, uint32_t variant, uint32_t figure, char *text, size_t size)
{
    double range[3];
    cli_figure_range(r, variant, figure, range);
    figure_text(range[1], text, size);
    const double away = fmax(range[2] - range[1], range[1] - range[0]);
    const bool several = cli_finished_seeds(r, variant) > 1;
    if (several && isfinite(range[1]) && isinf(range[2]))
        snprintf(text + strlen(text), size - strlen(text), " or never");
    else if (several && isfinite(away))
        snprintf(text + strlen(text), size - strlen(text), " +-%.2g", away);
}

static void label_of(const cli_quantity *quantity, char *text, size_t size)
{
    snprintf(text, size, "%s%s%s", quantity->name, quantity->unit[0] ? ", " : "", quantity->unit);
}

/* The name of a variant, or the label of a figure. */
static const char *name_of(const cli_result *r, bool variants, uint32_t i, char text[64])
{
    if (variants)
        return r->experiment->variant[i].name;
    label_of(&r->experiment->figure[i], text, 64);
    return text;
}

/* A column for each variant, or a row if they are many. */
static void print_table(const cli_result *r)
{
    const bool turned = r->variants > 5;
    const uint32_t rows = turned ? r->variants : r->figures, columns = turned ? r->figures : r->variants;
    int first = 0, width = r->seeds > 1 ? 14 : 9;
    char text[64], cell[64];
    for (uint32_t i = 0; i < rows; i++)
        first = (int)strlen(name_of(r, turned, i, text)) > first ? (int)strlen(name_of(r, turned, i, text)) : first;
    for (uint32_t i = 0; i < columns; i++)
        width = (int)strlen(name_of(r, !turned, i, text)) > width ? (int)strlen(name_of(r, !turned, i, text)) : width;
    printf("%-*s", first, "");
    for (uint32_t i = 0; i < columns; i++)
        printf("  %*s", width, name_of(r, !turned, i, text));
    putchar('\n');
    for (uint32_t i = 0; i < rows; i++) {
        printf("%-*s", first, name_of(r, turned, i, text));
        for (uint32_t k = 0; k < columns; k++) {
            cell_text(r, turned ? i : k, turned ? k : i, cell, sizeof cell);
            printf("  %*s", width, cell);
        }
        putchar('\n');
    }
}

void cli_experiment_print(const cli_result *r, int status)
{
    const cli_experiment *e = r->experiment;
    cli_print(stdout, 0, "%s%s (%s): %s\n", e->name, r->small ? ", small" : "", e->reference, e->about);
    if (!cli_experiment_is_finished(r))
        cli_print(stdout, 0,
                  "%s after %zu of %zu runs: the figures are of these, and nothing is said of the claims\n",
                  cli_status_name(status), r->finished, (size_t)r->variants * r->seeds);
    print_table(r);
    for (uint32_t i = 0; i < r->wholes; i++) {
        char label[64], cell[64];
        label_of(&e->whole[i], label, sizeof label);
        cell_text(r, r->variants, i, cell, sizeof cell);
        printf("%s: %s\n", label, cell);
    }
    for (uint32_t k = 0; k < r->claims && cli_experiment_is_finished(r); k++) {
        if (!cli_claim_counts(r, k))
            continue;
        char text[256];
        cli_claim_text(&e->claim[k], text, sizeof text);
        printf("%s %s\n", r->holds[k] ? "holds:" : "FAILS:", text);
    }
}

/* ---- JSON ---- */

void cli_experiment_json(const cli_result *r, int status)
{
    const cli_experiment *e = r->experiment;
    bool all = true;
    const bool finished = cli_experiment_is_finished(r);
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "experiment", e->name);
    rheo__json_text(&json, "reference", e->reference);
    rheo__json_bool(&json, "small", r->small);
    rheo__json_integer(&json, "steps", r->steps);
    rheo__json_integer(&json, "seeds", r->seeds);
    rheo__json_text(&json, "outcome", cli_status_name(status));
    rheo__json_text(&json, "reason", status == CLI_DONE ? NULL : cli_said());
    rheo__json_integer(&json, "runs", (uint64_t)r->variants * r->seeds);
    rheo__json_integer(&json, "finished", r->finished);
    rheo__json_begin_list(&json, "figures");
    for (uint32_t i = 0; i < r->figures; i++) {
        rheo__json_begin_object(&json, NULL);
        rheo__json_text(&json, "name", e->figure[i].name);
        rheo__json_text(&json, "unit", e->figure[i].unit);
        rheo__json_text(&json, "about", e->figure[i].about);
        rheo__json_end_object(&json);
    }
    rheo__json_end_list(&json);
    rheo__json_begin_list(&json, "variants");
    for (uint32_t v = 0; v < r->variants; v++) {
        rheo__json_begin_object(&json, NULL);
        rheo__json_text(&json, "name", e->variant[v].name);
        rheo__json_begin_list(&json, "set");
        for (size_t k = 0; k < CLI_MOST_SETTINGS && e->variant[v].set[k]; k++)
            rheo__json_text(&json, NULL, e->variant[v].set[k]);
        rheo__json_end_list(&json);
        rheo__json_begin_object(&json, "figures");
        for (uint32_t i = 0; i < r->figures; i++) {
            double values[CLI_MOST_SEEDS];
            const uint32_t seeds = cli_finished_seeds(r, v);
            for (uint32_t seed = 0; seed < seeds; seed++)
                values[seed] = cli_figure_of(r, v, i, seed);
            rheo__json_vector(&json, e->figure[i].name, values, seeds);
        }
        rheo__json_end_object(&json);
        rheo__json_end_object(&json);
    }
    rheo__json_end_list(&json);
    rheo__json_begin_object(&json, "whole");
    for (uint32_t i = 0; i < r->wholes; i++) {
        double values[CLI_MOST_SEEDS];
        const uint32_t seeds = cli_finished_seeds(r, r->variants);
        for (uint32_t seed = 0; seed < seeds; seed++)
            values[seed] = cli_figure_of(r, r->variants, i, seed);
        rheo__json_vector(&json, e->whole[i].name, values, seeds);
    }
    rheo__json_end_object(&json);
    rheo__json_begin_list(&json, "claims");
    for (uint32_t k = 0; k < r->claims && finished; k++) {
        if (!cli_claim_counts(r, k))
            continue;
        char text[256];
        cli_claim_text(&e->claim[k], text, sizeof text);
        rheo__json_begin_object(&json, NULL);
        rheo__json_text(&json, "text", text);
        rheo__json_bool(&json, "holds", r->holds[k]);
        rheo__json_end_object(&json);
        all = all && r->holds[k];
    }
    rheo__json_end_list(&json);
    if (finished)
        rheo__json_bool(&json, "holds", all);
    else
        rheo__json_null(&json, "holds");
    rheo__json_end_object(&json);
}
