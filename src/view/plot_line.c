/*
 * Curves of plots. Points that cannot be seen are left out, in two steps:
 *
 * 1. Of consecutive points in one column of a quarter of a pixel, the first, the lowest, the highest and the last stay.
 * 2. A point is left out while one straight line passes all points since the last one written at a vertical distance
 *    of at most TOLERANCE. The slopes of such lines form an interval, which each point narrows.
 */
#include <math.h>

#include "view/plot.h"

static const double COLUMNS = 4;    /* per pixel */
static const double TOLERANCE = .1; /* pixels */
static const double FAR = 100;      /* heights: beyond, a line leaves the panel as steeply as it can be seen */

typedef struct point {
    double x, y;
} point;

typedef struct line {
    rheo__output *out;
    /* Step 1: the column and its points; index: their numbers in the column. */
    double column;
    uint64_t count, index[4];
    point kept[4]; /* first, lowest, highest, last */
    /* Step 2: the last point written, the last one seen, and the slopes of lines from the former. */
    bool begun, alone;
    point anchor, latest;
    double least, most;
} line;

static void put_point(line *l, const char *letter, point p)
{
    rheo__output_text(l->out, letter);
    rheo__plot_number(l->out, p.x);
    rheo__output_text(l->out, " ");
    rheo__plot_number(l->out, p.y);
}

/* ---- Step 2 ---- */

static void turn_at(line *l, point p)
{
    put_point(l, "L", p);
    l->alone = false;
    l->anchor = l->latest = p;
    l->least = -INFINITY;
    l->most = INFINITY;
}

static bool is_latest(const line *l, point p)
{
    return p.x == l->latest.x && p.y == l->latest.y;
}

static bool passes(line *l, point p)
{
    const double run = p.x - l->anchor.x, rise = p.y - l->anchor.y;
    if (!(p.x > l->latest.x) || rise < l->least * run || rise > l->most * run)
        return false;
    l->least = fmax(l->least, (rise - TOLERANCE) / run);
    l->most = fmin(l->most, (rise + TOLERANCE) / run);
    l->latest = p;
    return true;
}

static void add_vertex(line *l, point p)
{
    if (!l->begun) {
        put_point(l, "M", p);
        l->begun = l->alone = true;
        l->anchor = l->latest = p;
        l->least = -INFINITY;
        l->most = INFINITY;
    } else if (!is_latest(l, p) && !passes(l, p)) {
        if (!is_latest(l, l->anchor))
            turn_at(l, l->latest);
        if (!passes(l, p)) /* x does not increase */
            turn_at(l, p);
    }
}

/* ---- Step 1 ---- */

static void end_column(line *l)
{
    uint64_t next = 0;
    while (l->count) { /* the points by ascending index, each once */
        int best = -1;
        for (int k = 0; k < 4; k++)
            if (l->index[k] >= next && (best < 0 || l->index[k] < l->index[best]))
                best = k;
        if (best < 0)
            break;
        add_vertex(l, l->kept[best]);
        next = l->index[best] + 1;
    }
    l->count = 0;
}

static void add_point(line *l, point p)
{
    const double column = floor(p.x * COLUMNS);
    if (l->count && column != l->column)
        end_column(l);
    for (int k = 0; k < 4; k++)
        if (l->count == 0 || k == 3 || (k == 1 && p.y > l->kept[1].y) || (k == 2 && p.y < l->kept[2].y)) {
            l->kept[k] = p;
            l->index[k] = l->count;
        }
    l->column = column;
    l->count++;
}

static void end_line(line *l)
{
    end_column(l);
    if (l->begun && !is_latest(l, l->anchor))
        turn_at(l, l->latest);
    else if (l->begun && l->alone)
        rheo__output_text(l->out, "m-1 0h2"); /* a point between gaps */
    l->begun = false;
}

/* ---- Points ---- */

static const char *const SHAPE[RHEO_PLOT_LOOKS] = {
    "m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0", /* circle */
    "m-2.6-2.6h5.2v5.2h-5.2z",           /* square */
    "m0-3.6l3.2 5.6h-6.4z",              /* triangle */
    "m0-3.8l3.8 3.8-3.8 3.8-3.8-3.8z",   /* diamond */
    "m-2.6-2.6l5.2 5.2m0-5.2l-5.2 5.2",  /* cross */
    "m-3.4 0h6.8m-3.4-3.4v6.8",          /* plus */
    "m0 3.6l3.2-5.6h-6.4z",              /* triangle, upside down */
    "m-3.4 0h6.8",                       /* bar */
};

void rheo__plot_mark(rheo__output *out, double x, double y, uint32_t look)
{
    put_point(&(line){.out = out}, "M", (point){x, y});
    rheo__output_text(out, SHAPE[look % RHEO_PLOT_LOOKS]);
}

static void add_mark(line *l, point p, uint32_t look)
{
    if (l->begun && fabs(p.x - l->latest.x) < .25 && fabs(p.y - l->latest.y) < .25)
        return;
    l->begun = true;
    l->latest = p;
    rheo__plot_mark(l->out, p.x, p.y, look);
}

void rheo__plot_line(rheo__output *out, const rheo_plot_panel *panel, const rheo_plot_curve *curve,
                     const rheo__plot_range *x, const rheo__plot_range *y, double width, double height)
{
    line l = {.out = out};
    const double bound = FAR * height;
    for (size_t i = 0; i < curve->count; i++) {
        const bool visible =
            rheo__plot_is_visible(&panel->x, curve->x[i]) && rheo__plot_is_visible(&panel->y, curve->y[i]);
        if (!visible && curve->mark == RHEO_PLOT_LINE)
            end_line(&l);
        if (!visible)
            continue;
        const double right = width * rheo__plot_place(x, curve->x[i]),
                     down = height * (1 - rheo__plot_place(y, curve->y[i]));
        const point p = {fmax(-bound, fmin(bound, right)), fmax(-bound, fmin(bound, down))};
        if (curve->mark == RHEO_PLOT_LINE)
            add_point(&l, p);
        else if (p.x >= 0 && p.x <= width && p.y >= 0 && p.y <= height)
            add_mark(&l, p, curve->look);
    }
    if (curve->mark == RHEO_PLOT_LINE)
        end_line(&l);
}
