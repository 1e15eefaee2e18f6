/*
 * Ranges and ticks of axes. A tick is an integer times a power of ten, so that its label is exact text and the same on
 * every machine.
 */
#include <math.h>
#include <string.h>

#include "core/math.h"
#include "core/text.h"
#include "view/plot.h"

enum {
    INTERVALS = 6,     /* at most, between labelled ticks of a linear axis */
    DECADES = 7,       /* at most, with a label */
    MINOR_DECADES = 10 /* at most, with minor ticks */
};
static const double LARGEST = 1e100;

bool rheo__plot_is_visible(const rheo_plot_axis *axis, double value)
{
    return value >= -LARGEST && value <= LARGEST && (axis->scale == RHEO_PLOT_LINEAR || value >= 1 / LARGEST);
}

/* digits * 10^exponent */
static double decimal(double digits, int exponent)
{
    double power = 1;
    for (int i = exponent < 0 ? -exponent : exponent; i > 0; i--)
        power *= 10;
    return exponent < 0 ? digits / power : digits * power;
}

/* The largest e with 10^e <= value; value > 0. */
static int exponent_of(double value)
{
    int exponent = 0;
    while (decimal(1, exponent) > value)
        exponent--;
    while (decimal(1, exponent + 1) <= value)
        exponent++;
    return exponent;
}

/* Writes an integer times 10^-decimals. */
static void put_decimal(char *text, size_t size, long long digits, int decimals)
{
    char number[48];
    const int length = snprintf(number, sizeof number, "%0*lld", decimals + 1, digits < 0 ? -digits : digits);
    rheo__text_add(text, size, "%s%.*s%s%s", digits < 0 ? "−" : "", length - decimals, number, decimals ? "." : "",
                   number + length - decimals);
}

/* Writes digits * 10^exponent; `most` is the largest exponent of a tick of the axis. */
static void put_label(char *text, size_t size, long long digits, int exponent, int most)
{
    text[0] = 0;
    if (digits == 0)
        rheo__text_add(text, size, "0");
    else if (most >= 6 || (exponent < -6 && most < -3)) {
        put_decimal(text, size, digits, most - exponent);
        rheo__text_add(text, size, "×10^{%s%d}", most < 0 ? "−" : "", most < 0 ? -most : most);
    } else if (exponent >= 0) {
        put_decimal(text, size, (long long)decimal((double)digits, exponent), 0);
    } else {
        put_decimal(text, size, digits, -exponent);
    }
}

/* ---- Linear axes ---- */

/* Widens a range that is too narrow to have ticks. */
static void widen(double *low, double *high)
{
    double size = fabs(*low) > fabs(*high) ? fabs(*low) : fabs(*high);
    if (size < 1 / LARGEST)
        size = 0;
    if (*high - *low < (size > 0 ? size * 1e-9 : 1)) {
        const double more = size > 0 ? size / 2 : .5;
        *low -= more;
        *high += more;
    }
}

/* Integers that are the ends of a range in units of a step; a value within 1e-9 steps of a tick is at the tick. */
static double below(double value, double step)
{
    return floor(value / step + 1e-9);
}

static double above(double value, double step)
{
    return ceil(value / step - 1e-9);
}

static void linear_ticks(rheo__plot_range *r, bool to_ticks)
{
    static const int FACTOR[] = {1, 2, 5};
    int exponent = exponent_of((r->high - r->low) / INTERVALS), factor = 0;
    double step = 0;
    for (;; exponent += factor == 2, factor = (factor + 1) % 3) {
        step = decimal(FACTOR[factor], exponent);
        if (above(r->high, step) - below(r->low, step) <= INTERVALS)
            break;
    }
    const double first = to_ticks ? below(r->low, step) : above(r->low, step);
    const double last = to_ticks ? above(r->high, step) : below(r->high, step);
    const double largest = fabs(first) > fabs(last) ? fabs(first) : fabs(last);
    const int most = exponent + (largest > 0 ? exponent_of(largest * FACTOR[factor]) : 0);
    r->count = 0;
    for (double i = first; i <= last; i++) {
        rheo__plot_tick *tick = &r->tick[r->count++];
        tick->value = decimal(i * FACTOR[factor], exponent);
        put_label(tick->label, sizeof tick->label, (long long)(i * FACTOR[factor]), exponent, most);
    }
    if (to_ticks && r->count) {
        r->low = r->tick[0].value;
        r->high = r->tick[r->count - 1].value;
    }
}

/* ---- Logarithmic axes ---- */

/* 1, 2 or 5 times a power of ten, at or below (above) a value. */
static double round_down(double value)
{
    const int exponent = exponent_of(value);
    return value >= decimal(5, exponent)   ? decimal(5, exponent)
           : value >= decimal(2, exponent) ? decimal(2, exponent)
                                           : decimal(1, exponent);
}

static double round_up(double value)
{
    const double lower = round_down(value);
    const int exponent = exponent_of(value);
    if (lower == value)
        return value;
    return lower < decimal(2, exponent)   ? decimal(2, exponent)
           : lower < decimal(5, exponent) ? decimal(5, exponent)
                                          : decimal(1, exponent + 1);
}

static void put_power(char *text, size_t size, int exponent)
{
    text[0] = 0;
    if (exponent == 0 || exponent == 1)
        rheo__text_add(text, size, "1%s", exponent ? "0" : "");
    else
        rheo__text_add(text, size, "10^{%s%d}", exponent < 0 ? "−" : "", exponent < 0 ? -exponent : exponent);
}

static void logarithmic_ticks(rheo__plot_range *r, bool to_ticks)
{
    if (to_ticks) {
        r->low = round_down(r->low);
        r->high = round_up(r->high);
    }
    if (!(r->high > r->low)) {
        const double value = r->low; /* one of these ends */
        r->low = round_down(value * .99);
        r->high = round_up(value * 1.01);
    }
    const int first = exponent_of(r->low), last = exponent_of(r->high), decades = last - first;
    const int stride = decades > DECADES ? (decades + DECADES - 1) / DECADES : 1;
    bool labelled = false;
    for (int every = 0; every < 2 && !labelled; every++) { /* from 0.025 to 0.045 there is no 1, 2 or 5 */
        r->count = 0;
        for (int exponent = first; exponent <= last; exponent += decades > MINOR_DECADES ? stride : 1)
            for (int digit = 1; digit <= (decades > MINOR_DECADES ? 1 : 9); digit++) {
                const double value = decimal(digit, exponent);
                if (value < r->low || value > r->high)
                    continue;
                rheo__plot_tick *tick = &r->tick[r->count++];
                *tick = (rheo__plot_tick){.value = value};
                if (decades < 2 && (every || digit == 1 || digit == 2 || digit == 5))
                    put_label(tick->label, sizeof tick->label, digit, exponent, last);
                else if (digit == 1 && (exponent - first) % stride == 0)
                    put_power(tick->label, sizeof tick->label, exponent);
                labelled = labelled || tick->label[0];
            }
    }
}

void rheo__plot_choose_range(const rheo_plot_axis *axis, double least, double most, rheo__plot_range *r)
{
    const bool given = axis->min < axis->max;
    *r = (rheo__plot_range){.logarithmic = axis->scale == RHEO_PLOT_LOGARITHMIC};
    r->low = given ? axis->min : least <= most ? least : r->logarithmic ? 1 : 0;
    r->high = given ? axis->max : least <= most ? most : r->logarithmic ? 10 : 1;
    if (r->logarithmic) {
        logarithmic_ticks(r, !given);
        r->ln_low = rheo__ln(r->low);
        r->ln_high = rheo__ln(r->high);
    } else {
        widen(&r->low, &r->high);
        linear_ticks(r, !given);
    }
}

double rheo__plot_place(const rheo__plot_range *r, double value)
{
    if (r->logarithmic)
        return (rheo__ln(value) - r->ln_low) / (r->ln_high - r->ln_low);
    return (value - r->low) / (r->high - r->low);
}
