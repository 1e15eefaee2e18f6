/*
 * rheolog curves: the curves of Figs. 2, 3 and 4 of Ozgen, Kallmann and Brown, which show what the order q and the window d of a
 * memory do. Nothing is simulated.
 */
#include "cli/curves.h"

#include <string.h>

#include "json/file_name.h"

static const struct {
    const char *name;
    bool of_weights;
    rheo_signal signal;
    size_t at_count;
    uint64_t at[8]; /* steps or lags that are printed by default */
} CURVES[] = {{"weights", true, RHEO_SIGNAL_IMPACT, 8, {1, 2, 5, 10, 50, 150, 250, 500}},
              {"impact", false, RHEO_SIGNAL_IMPACT, 2, {100, 600}},
              {"steady", false, RHEO_SIGNAL_STEADY, 2, {100, 300}}};

static const double DURATION = 49.5; /* T; 1500 steps of 0.033 */
enum { LAGS = 501, MOST_WINDOW = 1000000 };

typedef struct arguments {
    const char *kinds, *orders, *windows, *at, *weights, *step, *path;
    cli_number count;
    bool csv, json, force;
} arguments;

/* ---- Lists ---- */

/* Copies the word at *text and moves *text behind its comma, or to NULL after the last word. False: it is too long. */
static bool next_word(const char **text, char word[64])
{
    const size_t length = strcspn(*text, ",");
    const bool fits = length < 64;
    snprintf(word, 64, "%.*s", (int)(fits ? length : 63), *text);
    *text = (*text)[length] ? *text + length + 1 : NULL;
    return fits;
}

static int too_many(const char *option, size_t most)
{
    return cli_usage(&cli_curves, "%s takes at most %zu values", option, most);
}

static int named_twice(const char *option, const char *word)
{
    return cli_usage(&cli_curves, "%s names %s twice", option, word);
}

static bool real_from(const char *word, double *value)
{
    const char *end;
    *value = rheo_text_number(word, &end);
    return end != word && *end == 0;
}

static int read_orders(const char *text, cli_curves_request *r)
{
    char word[64];
    while (text) {
        if (r->orders == CLI_CURVES_MOST)
            return too_many("--order", CLI_CURVES_MOST);
        double *order = &r->order[r->orders++];
        if (!next_word(&text, word) || !real_from(word, order) || !(*order > 0 && *order < 1))
            return cli_usage(&cli_curves,
                             "--order needs numbers between 0 and 1, both excluded, such as 0.2,0.5; got \"%s\"",
                             word);
        for (size_t i = 0; i + 1 < r->orders; i++)
            if (r->order[i] == *order)
                return named_twice("--order", word);
    }
    return CLI_DONE;
}

static int read_at(const char *text, cli_curves_request *r)
{
    char word[64];
    for (r->at_count = 0; text;) {
        if (r->at_count == CLI_CURVES_MOST_AT)
            return too_many("--at", CLI_CURVES_MOST_AT);
        uint64_t *at = &r->at[r->at_count++];
        if (!next_word(&text, word) || !cli_number_from(word, at))
            return cli_usage(&cli_curves, "--at needs whole numbers, such as 100,600; got \"%s\"", word);
        if (*at >= r->count)
            return cli_usage(&cli_curves, "--at %s is beyond the last %s, %zu; --count sets how many there are", word,
                             r->of_weights ? "lag" : "step", r->count - 1);
        for (size_t i = 0; i + 1 < r->at_count; i++)
            if (r->at[i] == *at)
                return named_twice("--at", word);
    }
    return CLI_DONE;
}

static int read_windows(const char *text, uint32_t window[CLI_CURVES_MOST], size_t *count)
{
    char word[64];
    for (*count = 0; text; ++*count) {
        uint64_t number = 0;
        if (*count == CLI_CURVES_MOST)
            return too_many("--window", CLI_CURVES_MOST);
        const bool fits = next_word(&text, word);
        if (strcmp(word, "full") != 0 &&
            (!fits || !cli_number_from(word, &number) || number < 1 || number > MOST_WINDOW))
            return cli_usage(&cli_curves, "--window needs whole numbers of steps, 1 to %d, or full; got \"%s\"",
                             MOST_WINDOW, word);
        window[*count] = (uint32_t)number;
        for (size_t i = 0; i < *count; i++)
            if (window[i] == window[*count])
                return named_twice("--window", word);
    }
    return CLI_DONE;
}

static int read_kinds(const char *text, rheo_history_kind kind[4], size_t *count)
{
    const rheo_parameter *p = rheo_scene_parameter_find("history.kind");
    char word[64], suggestion[CLI_SUGGESTION];
    for (*count = 0; text;) {
        uint32_t choice = 0;
        const bool fits = next_word(&text, word);
        while (choice < p->choice_count && strcmp(p->choices[choice], word) != 0)
            choice++;
        const char *nearest = rheo_nearest_word(word, p->choices, p->choice_count);
        if (!fits || choice == p->choice_count)
            return cli_usage(&cli_curves, "unknown kind \"%s\"%s", word,
                             *cli_did_you_mean(word, nearest, suggestion)
                                 ? suggestion
                                 : "; there are window, window-fast, full and tempered");
        for (size_t i = 0; i < *count; i++)
            if (kind[i] == (rheo_history_kind)choice)
                return named_twice("--kind", word);
        kind[(*count)++] = (rheo_history_kind)choice;
    }
    return CLI_DONE;
}

/* ---- Options ---- */

/* Combines kinds and windows: window-fast and tempered need a number of steps, and full has no window. */
static int choose_memories(const arguments *a, cli_curves_request *r)
{
    uint32_t window[CLI_CURVES_MOST] = {50, 150, 250, 500, 0};
    rheo_history_kind kind[4] = {RHEO_HISTORY_WINDOW};
    size_t windows = 5, kinds = 1;
    int status = a->kinds ? read_kinds(a->kinds, kind, &kinds) : CLI_DONE;
    if (r->of_weights) { /* Fig. 2 shows the weights without a window */
        window[0] = 0;
        windows = kinds > 1 || kind[0] != RHEO_HISTORY_WINDOW ? 2 : 1;
    }
    if (status == CLI_DONE && a->windows)
        status = read_windows(a->windows, window, &windows);
    for (size_t k = 0; k < kinds && status == CLI_DONE; k++) {
        const size_t before = r->memories;
        const char *word = cli_curves_word("history.kind", kind[k]);
        if (kind[k] == RHEO_HISTORY_FULL && a->windows && kinds == 1)
            return cli_usage(&cli_curves, "kind full counts all steps; it does not go with --window");
        if (kind[k] == RHEO_HISTORY_FULL)
            r->memory[r->memories++] = (struct cli_curves_memory){kind[k], 0};
        for (size_t w = 0; w < windows && kind[k] != RHEO_HISTORY_FULL; w++)
            if (window[w] || kind[k] == RHEO_HISTORY_WINDOW)
                r->memory[r->memories++] = (struct cli_curves_memory){kind[k], window[w]};
        if (r->memories == before)
            status =
                cli_usage(&cli_curves, "kind %s needs a window of some steps; got --window %s", word, a->windows);
    }
    return status;
}

static int choose_weights(const char *text, cli_curves_request *r)
{
    const rheo_parameter *p = rheo_scene_parameter_find("history.weights");
    uint32_t choice = 0;
    while (text && choice < p->choice_count && strcmp(p->choices[choice], text) != 0)
        choice++;
    if (choice == p->choice_count)
        return cli_usage(&cli_curves, "--weights needs paper or l1; got \"%s\"", text);
    r->weights = (rheo_weights)choice;
    return CLI_DONE;
}

static int choose_steps(const arguments *a, cli_curves_request *r)
{
    r->step = 0.033;
    if (a->step && (!real_from(a->step, &r->step) || !(r->step >= 1e-9 && r->step <= 1e9)))
        return cli_usage(&cli_curves, "--step needs a number between 1e-9 and 1e9; got \"%s\"", a->step);
    const double count = a->count.given ? (double)a->count.value : r->of_weights ? LAGS : DURATION / r->step + .5;
    if (!(count >= 1 && count < CLI_CURVES_MOST_COUNT + 1)) {
        if (a->count.given)
            return cli_usage(&cli_curves, "--count needs 1 to %d; got %llu", CLI_CURVES_MOST_COUNT,
                             (unsigned long long)a->count.value);
        return cli_usage(&cli_curves, "--step %s makes too %s steps of 49.5 T; give --count", a->step,
                         count < 1 ? "few" : "many");
    }
    r->count = (size_t)count;
    return CLI_DONE;
}

static int choose_curves(int operands, char **operand, cli_curves_request *r)
{
    if (operands != 1)
        return cli_usage(&cli_curves, "needs one of weights, impact and steady; got %d operands", operands);
    for (size_t i = 0; i < sizeof CURVES / sizeof *CURVES; i++)
        if (strcmp(CURVES[i].name, operand[0]) == 0) {
            r->name = CURVES[i].name;
            r->of_weights = CURVES[i].of_weights;
            r->signal = CURVES[i].signal;
            r->at_count = CURVES[i].at_count;
            memcpy(r->at, CURVES[i].at, sizeof CURVES[i].at);
            return CLI_DONE;
        }
    char suggestion[CLI_SUGGESTION];
    const char *const names[] = {CURVES[0].name, CURVES[1].name, CURVES[2].name};
    return cli_usage(&cli_curves, "there are no curves \"%s\"%s", operand[0],
                     *cli_did_you_mean(operand[0], rheo_nearest_word(operand[0], names, 3), suggestion)
                         ? suggestion
                         : "; there are weights, impact and steady");
}

static int check_output(const arguments *a)
{
    if (a->csv && a->json)
        return cli_usage(&cli_curves, "give one of --csv and --json");
    if (a->force && !a->path)
        return cli_usage(&cli_curves, "--force goes with -o");
    if (a->path && !rheo__json_ends_with(a->path, ".csv") && !rheo__json_ends_with(a->path, ".svg"))
        return cli_usage(&cli_curves, "-o needs a file name that ends in .csv or .svg; got \"%s\"", a->path);
    return a->path ? cli_check_replaced(a->path, a->force) : CLI_DONE;
}

static int read_arguments(const arguments *a, int operands, char **operand, cli_curves_request *r)
{
    int status = choose_curves(operands, operand, r);
    if (status == CLI_DONE)
        status = choose_steps(a, r);
    if (status == CLI_DONE)
        status = choose_weights(a->weights, r);
    if (status == CLI_DONE)
        status = read_orders(a->orders ? a->orders : "0.2,0.5,0.8", r);
    if (status == CLI_DONE)
        status = choose_memories(a, r);
    if (status == CLI_DONE && a->at)
        status = read_at(a->at, r);
    return status == CLI_DONE ? check_output(a) : status;
}

static int output(const arguments *a, const cli_curve_set *curves)
{
    int status = CLI_DONE;
    if (a->path && rheo__json_ends_with(a->path, ".svg"))
        status = cli_curves_plot(curves, a->path, a->force);
    else if (a->path)
        status = cli_write_file(a->path, cli_curves_put_csv, curves);
    if (status != CLI_DONE)
        return status;
    if (a->csv)
        cli_curves_put_csv(stdout, curves);
    else
        (a->json ? cli_curves_print_json : cli_curves_print)(curves);
    return CLI_DONE;
}

static int run(int argc, char **argv)
{
    arguments a = {0};
    cli_curves_request request = {0};
    cli_curve_set curves = {0};
    const cli_option options[] = {
        {"--order", NULL, "Q,Q,...", CLI_TEXT, &a.orders}, {"--window", NULL, "D,D,...", CLI_TEXT, &a.windows},
        {"--kind", NULL, "KIND,...", CLI_TEXT, &a.kinds},  {"--weights", NULL, "NAME", CLI_TEXT, &a.weights},
        {"--step", NULL, "T", CLI_TEXT, &a.step},          {"--count", NULL, "N", CLI_NUMBER, &a.count},
        {"--at", NULL, "N,N,...", CLI_TEXT, &a.at},        {"--output", "-o", "FILE", CLI_TEXT, &a.path},
        {"--force", NULL, NULL, CLI_FLAG, &a.force},       {"--csv", NULL, NULL, CLI_FLAG, &a.csv},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},         {0},
    };
    int status = cli_parse(&cli_curves, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    status = read_arguments(&a, argc, argv, &request);
    if (status == CLI_DONE)
        status = cli_curves_compute(&request, &curves);
    if (status == CLI_DONE)
        status = output(&a, &curves);
    cli_curves_release(&curves);
    return status;
}

static const char help[] = {
#include "cli/help/curves.txt.inc"
    0};

const cli_command cli_curves = {"curves", help, run};
