/*
 * Plots of curves as SVG: panels side by side with axes, ticks at round numbers and one legend. The same plot gives the
 * same bytes on every machine and in every locale. Colours differ for the colour-blind, and dashes in print.
 *
 * Texts are UTF-8. In titles of panels, labels and names, ^{...} is a superscript and _{...} a subscript.
 */
#ifndef RHEOLOG_PLOT_H
#define RHEOLOG_PLOT_H

#include "rheolog/base.h"

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Scale of an axis. */
typedef enum rheo_plot_scale {
    /** Linear. */
    RHEO_PLOT_LINEAR = 0,
    /** Logarithmic. Values that are not positive leave gaps. */
    RHEO_PLOT_LOGARITHMIC = 1
} rheo_plot_scale;

/** An axis of a panel. */
typedef struct rheo_plot_axis {
    /** Quantity and unit, such as "time, T"; NULL: none. */
    const char *label;
    /** Scale. */
    rheo_plot_scale scale;
    /**
     * Least value. Parts of curves out of range are not drawn. If it is not less than `max`, the range is that of the data up to
     * round numbers. On a logarithmic axis it must be positive.
     */
    double min;
    /** Largest value. */
    double max;
} rheo_plot_axis;

/** How a curve is drawn. */
typedef enum rheo_plot_mark {
    /** Straight lines from point to point. */
    RHEO_PLOT_LINE = 0,
    /** A mark at each point. */
    RHEO_PLOT_POINTS = 1
} rheo_plot_mark;

/** A curve of a panel. */
typedef struct rheo_plot_curve {
    /** Name in the legend, which has each name once; NULL: none. */
    const char *name;
    /** Number of points. */
    size_t count;
    /** Coordinates along the x axis. A point whose coordinates are not finite, or beyond +-1e100, leaves a gap. */
    const double *x;
    /** Coordinates along the y axis. */
    const double *y;
    /** Line or points. */
    rheo_plot_mark mark;
    /** Number of a colour with its dashes and its shape of points. There are RHEO_PLOT_LOOKS; others repeat them. */
    uint32_t look;
} rheo_plot_curve;

/** Number of different looks. */
enum { RHEO_PLOT_LOOKS = 8 };

/** A panel: two axes and curves. Later curves are drawn over earlier ones. */
typedef struct rheo_plot_panel {
    /** Title above the panel; NULL: none. */
    const char *title;
    /** Axis to the right. */
    rheo_plot_axis x;
    /** Axis upwards. */
    rheo_plot_axis y;
    /** Number of curves. */
    size_t curve_count;
    /** Curves. */
    const rheo_plot_curve *curve;
} rheo_plot_panel;

/** A plot: panels in rows. */
typedef struct rheo_plot {
    /** Title above all; not NULL. */
    const char *title;
    /**
     * What the plot shows, in plain sentences for screen readers; NULL: none. Titles, axes, and the largest value of
     * each curve are added.
     */
    const char *description;
    /** Number of panels, at least 1. */
    size_t panel_count;
    /** Panels, row by row. */
    const rheo_plot_panel *panel;
    /** Panels in a row, at least 1. */
    uint32_t columns;
} rheo_plot;

/**
 * Writes a plot as SVG, under a temporary name that is renamed at the end. Points that cannot be seen are left out: a
 * line stays within a tenth of a pixel, and has at most four points per quarter of a pixel if x does not decrease.
 *
 * RHEO_ERROR_ARGUMENT if there are no panels or columns, a text, a list or coordinates are missing, a range is not
 * possible, or the file exists (without `force`) or is no regular file; RHEO_ERROR_FILE if it cannot be written;
 * RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_plot_write(const rheo_plot *plot, const char *path, bool force, rheo_error *error);

/**
 * Makes the same SVG as text: *text with a 0 behind its *size bytes, such as an element of an HTML page. Release *text
 * with free(). Errors as of rheo_plot_write(), but for the file; *text is then NULL.
 */
RHEO_API rheo_result rheo_plot_text(const rheo_plot *plot, char **text, size_t *size, rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
