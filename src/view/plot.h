/* Shared by the parts of a plot: axes (plot_axis.c), lines (plot_line.c), texts and numbers (plot_text.c). */
#ifndef RHEO__VIEW_PLOT_H
#define RHEO__VIEW_PLOT_H

#include "rheolog/plot.h"
#include "view/output.h"

/* ---- Axes ---- */

enum { RHEO__PLOT_TICKS = 128 };

typedef struct rheo__plot_tick {
    double value;
    char label[64]; /* with ^{...}; "" for a minor tick */
} rheo__plot_tick;

/* The range of an axis in values and in logarithms of values, and its ticks, ascending. */
typedef struct rheo__plot_range {
    bool logarithmic;
    double low, high, ln_low, ln_high;
    uint32_t count;
    rheo__plot_tick tick[RHEO__PLOT_TICKS];
} rheo__plot_range;

/* Whether a value can be drawn. */
bool rheo__plot_is_visible(const rheo_plot_axis *axis, double value);
/* Chooses the range of an axis for data between two values, least > most if there are none; and its ticks. */
void rheo__plot_choose_range(const rheo_plot_axis *axis, double least, double most, rheo__plot_range *range);
/* Place of a value: 0 at the low end of the range, 1 at its high end. */
double rheo__plot_place(const rheo__plot_range *range, double value);

/* ---- Lines ---- */

/* Writes the path of a curve in a panel of this size, with y downwards. */
void rheo__plot_line(rheo__output *out, const rheo_plot_panel *panel, const rheo_plot_curve *curve,
                     const rheo__plot_range *x, const rheo__plot_range *y, double width, double height);

/* Writes the path of the mark of a point. */
void rheo__plot_mark(rheo__output *out, double x, double y, uint32_t look);

/* ---- Texts and numbers ---- */

/* Writes hundredths of a pixel. */
void rheo__plot_number(rheo__output *out, double value);
/* Writes text for XML. Characters that cannot be printed become ?. */
void rheo__plot_plain(rheo__output *out, const char *text);
/* Does the same with ^{...} and _{...} as raised and lowered text of this size. */
void rheo__plot_text(rheo__output *out, const char *text, int size);
/* Approximate width of such a text. */
double rheo__plot_text_width(const char *text, int size);

#endif
