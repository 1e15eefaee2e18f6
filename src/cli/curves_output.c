/* Text, JSON, CSV and plot of `rheolog curves`. */
#include "cli/curves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *kind_name(const cli_curve *curve)
{
    return cli_curves_word("history.kind", curve->memory->kind);
}

static const char *weights_name(const cli_curve_set *c)
{
    return cli_curves_word("history.weights", c->request->weights);
}

static bool has_window(const struct cli_curves_memory *memory)
{
    return memory->kind != RHEO_HISTORY_FULL;
}

/* The window as in --window; "-" for kind full, which has none. */
static const char *window_text(const struct cli_curves_memory *memory, char text[32])
{
    if (memory->window)
        snprintf(text, 32, "%u", (unsigned)memory->window);
    else
        snprintf(text, 32, "%s", has_window(memory) ? "full" : "-");
    return text;
}

static bool any_fitted(const cli_curve_set *c)
{
    bool any = false;
    for (size_t i = 0; i < c->request->memories; i++)
        any = any || c->request->memory[i].kind != RHEO_HISTORY_WINDOW;
    return any;
}

/* ---- Text ---- */

/* Prints a number right-aligned, or "-" if there is none. */
static void put_value(double value, int width, int decimals)
{
    if (value == value)
        printf(" %*.*f", width, decimals, value);
    else
        printf(" %*s", width, "-");
}

static void put_step(const cli_curve_set *c, size_t step)
{
    if (step < c->request->count)
        printf(" %5zu", step);
    else
        printf(" %5s", "-");
}

static void put_memory(const cli_curve *curve)
{
    char order[32], window[32];
    rheo_number_text(curve->order, order);
    printf("%5s %-11s %5s", order, kind_name(curve), window_text(curve->memory, window));
}

static void put_difference(const cli_curve_set *c, const cli_curve *curve)
{
    const bool known = curve->difference == curve->difference;
    if (known)
        printf(" %9.1e", curve->difference);
    else
        printf(" %9s", "-");
    put_step(c, known ? curve->difference_at : c->request->count);
}

static void print_head(const cli_curve_set *c)
{
    static const char *const SIGNAL[] = {"v = 5 sin^2(pi u), u = (t - 1)/0.33, for 0 < u < 1, else 0",
                                         "v = 1 for 1 < t < 6, else 0"};
    char step[32];
    rheo_number_text(c->request->step, step);
    if (c->request->of_weights)
        printf("weights of the history term at lag m (Fig. 2), rule %s; step %s T\n\n", weights_name(c), step);
    else
        printf("|D^q x|, history stiffness over k_hist, L/T^q, %s\n%s, L/T\n%zu steps of %s T; weights %s\n\n",
               c->request->signal == RHEO_SIGNAL_IMPACT ? "after an impact (Fig. 3)"
                                                        : "in and after steady motion (Fig. 4)",
               SIGNAL[c->request->signal], c->request->count, step, weights_name(c));
}

static void print_weights(const cli_curve_set *c)
{
    printf("%5s %-11s %5s %6s %12s %12s %14s\n", "q", "kind", "d", "m",
           c->request->weights == RHEO_WEIGHTS_PAPER ? "c_m" : "b_m", "a_0,m", "sum, T^(1-q)");
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < c->request->at_count; k++) {
            const size_t lag = (size_t)c->request->at[k];
            if (lag >= c->request->count)
                continue;
            put_memory(&c->curve[i]);
            printf(" %6zu", lag);
            put_value(c->curve[i].value[lag], 12, 9);
            put_value(cli_curves_first_weight(c, &c->curve[i], lag), 12, 9);
            put_value(cli_curves_sum(c, &c->curve[i], lag), 14, 9);
            putchar('\n');
        }
    puts("\na_0,m: weight of the very first sample at step m. sum: |D^q x| m steps after the\n"
         "start of a motion at speed 1; a window d keeps that of m = d.");
}

static void print_signal(const cli_curve_set *c)
{
    const bool fitted = any_fitted(c);
    printf("%5s %-11s %5s %12s %5s %5s %5s", "q", "kind", "d", "peak", "n", "1/2", "1/100");
    for (size_t k = 0; k < c->request->at_count; k++) {
        char title[32];
        snprintf(title, sizeof title, "n = %llu", (unsigned long long)c->request->at[k]);
        printf(" %12s", title);
    }
    puts(fitted ? " to window    at" : "");
    for (size_t i = 0; i < c->count; i++) {
        const cli_curve *curve = &c->curve[i];
        put_memory(curve);
        put_value(curve->peak, 12, 9);
        put_step(c, curve->peak_at);
        put_step(c, curve->half_at);
        put_step(c, curve->hundredth_at);
        for (size_t k = 0; k < c->request->at_count; k++)
            put_value(c->request->at[k] < c->request->count ? curve->value[c->request->at[k]] : NAN, 12, 9);
        if (fitted)
            put_difference(c, curve);
        putchar('\n');
    }
    puts("\nn: step of the peak. 1/2, 1/100: first step from which this part of the peak is\n"
         "not exceeded; -: not within these steps.");
    if (fitted)
        puts("to window, at: largest difference from kind window with the same d (kind full:\n"
             "all steps), as a part of the peak of that kind, and its step.");
}

void cli_curves_print(const cli_curve_set *c)
{
    print_head(c);
    (c->request->of_weights ? print_weights : print_signal)(c);
}

/* ---- JSON ---- */

static void put_json_values(rheo__json *json, const cli_curve_set *c, const cli_curve *curve)
{
    rheo__json_begin_list(json, "at");
    for (size_t k = 0; k < c->request->at_count; k++) {
        const size_t at = (size_t)c->request->at[k];
        if (at >= c->request->count)
            continue;
        rheo__json_begin_object(json, NULL);
        rheo__json_integer(json, c->request->of_weights ? "lag" : "step", at);
        rheo__json_number(json, "value", curve->value[at]);
        if (c->request->of_weights) {
            rheo__json_number(json, "first_weight", cli_curves_first_weight(c, curve, at));
            rheo__json_number(json, "sum", cli_curves_sum(c, curve, at));
        }
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

static void print_json(const cli_curve_set *c, const cli_curve *curve)
{
    rheo__json json = {.file = stdout};
    const bool fitted = curve->memory->kind != RHEO_HISTORY_WINDOW;
    const size_t count = c->request->count;
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "curves", c->request->name);
    rheo__json_text(&json, "kind", kind_name(curve));
    rheo__json_number(&json, "order", curve->order);
    rheo__json_known_integer(&json, "window", curve->memory->window, curve->memory->window);
    rheo__json_text(&json, "weights", weights_name(c));
    rheo__json_number(&json, "step", c->request->step);
    rheo__json_integer(&json, "count", count);
    rheo__json_number(&json, "peak", curve->peak);
    rheo__json_integer(&json, "peak_at", curve->peak_at);
    rheo__json_known_integer(&json, "half_at", curve->half_at < count, curve->half_at);
    rheo__json_known_integer(&json, "hundredth_at", curve->hundredth_at < count, curve->hundredth_at);
    rheo__json_number(&json, "difference", curve->difference);
    rheo__json_known_integer(&json, "difference_at", fitted, curve->difference_at);
    rheo__json_number(&json, "fit_error", curve->fit_error);
    put_json_values(&json, c, curve);
    rheo__json_end_object(&json);
}

void cli_curves_print_json(const cli_curve_set *c)
{
    for (size_t i = 0; i < c->count; i++)
        print_json(c, &c->curve[i]);
}

/* ---- CSV ---- */

static void put_number(FILE *file, double value)
{
    char text[32];
    rheo_number_text(value, text);
    fputs(text, file);
}

void cli_curves_put_csv(FILE *file, const void *curves)
{
    const cli_curve_set *c = curves;
    fputs(c->request->of_weights ? "lag" : "step,time,velocity", file);
    for (size_t i = 0; i < c->count; i++) {
        char window[32];
        fprintf(file, ",%s", kind_name(&c->curve[i]));
        if (has_window(c->curve[i].memory))
            fprintf(file, "_%s", window_text(c->curve[i].memory, window));
        fputs("_q", file);
        put_number(file, c->curve[i].order);
    }
    for (size_t n = 0; n < c->request->count; n++) {
        fprintf(file, "\n%zu", n);
        if (c->velocity) {
            putc(',', file);
            put_number(file, (double)n * c->request->step);
            putc(',', file);
            put_number(file, c->velocity[n]);
        }
        for (size_t i = 0; i < c->count; i++) {
            putc(',', file);
            put_number(file, c->curve[i].value[n]);
        }
    }
    putc('\n', file);
}

/* ---- Plot ---- */

enum { FULL_LOOK = 4 /* black */ };

/* The exact sum of all steps is black; other memories have the other looks in turn. */
static uint32_t look_of(const cli_curves_request *r, const struct cli_curves_memory *memory)
{
    uint32_t look = 0;
    if (memory->kind == RHEO_HISTORY_WINDOW && !memory->window)
        return FULL_LOOK;
    for (const struct cli_curves_memory *m = r->memory; m < memory; m++)
        look += m->kind != RHEO_HISTORY_WINDOW || m->window;
    look %= RHEO_PLOT_LOOKS - 1;
    return look + (look >= FULL_LOOK);
}

/* Names what differs between the curves of a panel. */
static void name_curve(const cli_curves_request *r, const cli_curve *curve, char text[96])
{
    bool kinds = false, windows = !r->of_weights;
    for (size_t m = 1; m < r->memories; m++) {
        kinds = kinds || r->memory[m].kind != r->memory[0].kind;
        windows = windows || r->memory[m].window != r->memory[0].window;
    }
    char order[32] = "", window[32] = "";
    if (r->of_weights)
        rheo_number_text(curve->order, order);
    if (curve->memory->window)
        snprintf(window, sizeof window, "d = %u", (unsigned)curve->memory->window);
    else
        snprintf(window, sizeof window, has_window(curve->memory) || !kinds ? "full history" : "");
    kinds = kinds || curve->memory->kind != RHEO_HISTORY_WINDOW;
    snprintf(text, 96, "%s%s", *order ? "q = " : "", order);
    const char *const part[] = {kinds ? kind_name(curve) : "", windows || curve->memory->window ? window : ""};
    for (int p = 0; p < 2; p++)
        if (*part[p])
            snprintf(text + strlen(text), 96 - strlen(text), "%s%s", *text ? ", " : "", part[p]);
}

typedef struct picture {
    const cli_curve_set *c;
    double *x;
    char (*name)[96];
    rheo_plot_curve *curve; /* those of the memories, then the velocity */
    rheo_plot_panel *panel;
    char (*title)[32];
} picture;

static void make_curves(const picture *p)
{
    const cli_curves_request *r = p->c->request;
    for (size_t i = 0; i < p->c->count; i++) {
        const cli_curve *curve = &p->c->curve[i];
        name_curve(r, curve, p->name[i]);
        const uint32_t look = (uint32_t)(r->of_weights ? i : look_of(r, curve->memory));
        p->curve[i] = (rheo_plot_curve){p->name[i], r->count, p->x, curve->value, RHEO_PLOT_LINE, look};
    }
}

static int write_picture(const picture *p, const char *path, bool force)
{
    const cli_curves_request *r = p->c->request;
    char step[32], steps[64], stiffness[64];
    rheo_plot plot = {.panel = p->panel, .columns = 2};
    rheo_number_text(r->step, step);
    snprintf(steps, sizeof steps, "step n (%s T each)", step);
    snprintf(stiffness, sizeof stiffness, "|D^{q} x|, L/T^{q}");
    make_curves(p);
    if (r->of_weights) {
        const char *label = r->weights == RHEO_WEIGHTS_PAPER ? "weight c_{m}" : "weight b_{m}";
        plot.title = "Fig. 2: weights of the history term";
        plot.description = "The weight of a past velocity falls with its lag, the more slowly the smaller q is.";
        plot.panel_count = 2;
        p->panel[0] = (rheo_plot_panel){"the first 100 lags",
                                        {"lag m, steps", RHEO_PLOT_LINEAR, 0, 100},
                                        {label, RHEO_PLOT_LINEAR, 0, 0},
                                        p->c->count,
                                        p->curve};
        p->panel[1] = (rheo_plot_panel){"all lags",
                                        {"lag m, steps", RHEO_PLOT_LOGARITHMIC, 0, 0},
                                        {label, RHEO_PLOT_LOGARITHMIC, 0, 0},
                                        p->c->count,
                                        p->curve};
    } else {
        rheo_plot_curve *velocity = &p->curve[p->c->count];
        const bool impact = r->signal == RHEO_SIGNAL_IMPACT;
        *velocity = (rheo_plot_curve){NULL, r->count, p->x, p->c->velocity, RHEO_PLOT_LINE, FULL_LOOK};
        plot.title = impact ? "Fig. 3: history stiffness after an impact"
                            : "Fig. 4: history stiffness in and after steady motion";
        plot.description =
            "The stiffness of a spring rises while its ends move, and falls when they rest: the sooner the greater q "
            "is, and at once when the motion leaves the window of d steps.";
        plot.panel_count = 1 + r->orders;
        p->panel[0] = (rheo_plot_panel){
            "velocity", {steps, RHEO_PLOT_LINEAR, 0, 0}, {"v, L/T", RHEO_PLOT_LINEAR, 0, 0}, 1, velocity};
        for (size_t i = 0; i < r->orders; i++) {
            char order[32];
            rheo_number_text(r->order[i], order);
            snprintf(p->title[i], 32, "q = %.24s", order);
            p->panel[1 + i] = (rheo_plot_panel){p->title[i],
                                                {steps, RHEO_PLOT_LINEAR, 0, 0},
                                                {stiffness, RHEO_PLOT_LINEAR, 0, 0},
                                                r->memories,
                                                p->curve + i * r->memories};
        }
    }
    rheo_error error = {""};
    const rheo_result result = rheo_plot_write(&plot, path, force, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_curves_plot(const cli_curve_set *c, const char *path, bool force)
{
    const cli_curves_request *r = c->request;
    picture p = {c,
                 malloc(r->count * sizeof *p.x),
                 calloc(c->count, sizeof *p.name),
                 calloc(c->count + 1, sizeof *p.curve),
                 calloc(r->orders + 2, sizeof *p.panel),
                 calloc(r->orders, sizeof *p.title)};
    int status = CLI_SYSTEM;
    if (p.x && p.name && p.curve && p.panel && p.title) {
        for (size_t n = 0; n < r->count; n++)
            p.x[n] = (double)n;
        status = write_picture(&p, path, force);
    } else {
        cli_fail(status, "no memory for the plot");
    }
    free(p.x);
    free(p.name);
    free(p.curve);
    free(p.panel);
    free(p.title);
    return status;
}
