/*
 * Writes plots as SVG: panels with frame, grid, ticks and labels, their curves, and one legend below. Everything is placed
 * by numbers of this file; only widths of texts are guessed, because fonts differ.
 */
#include <assert.h>
#include <string.h>

#include "core/text.h"
#include "view/plot.h"

/* Sizes in pixels. */
enum {
    WIDTH = 310, /* of the area of curves */
    HEIGHT = 200,
    FONT = 12,
    TITLE_FONT = 14,
    TOP = 30,   /* above the panels: the title */
    ABOVE = 24, /* above the curves of a panel: its title */
    BELOW = 48, /* below them: ticks and label */
    RIGHT = 22, /* beside them: half of a label */
    LABEL = 26, /* for the label of the vertical axis */
    TICK = 4,
    SAMPLE = 30, /* of a line in the legend */
    ENTRY = 20,  /* height of a row of the legend */
    EDGE = 8
};

/* Colours that differ for the colour-blind (Okabe and Ito), and dashes that differ in print. */
static const struct {
    const char *colour, *dashes;
} LOOK[RHEO_PLOT_LOOKS] = {
    {"#0072b2", ""}, {"#d55e00", "9 3"},  {"#009e73", "9 3 2 3"}, {"#cc79a7", "4 2"},
    {"#000000", ""}, {"#e69f00", "15 3"}, {"#56b4e9", "2 2"},     {"#666666", "9 2 2 2 2 2"},
};

typedef struct layout {
    rheo__output *out;
    const rheo_plot *plot;
    double left, pitch, down; /* left margin of a panel; distances of panels */
    double width, height;
    uint32_t rows;
} layout;

/* ---- Ranges ---- */

static void include(double value, double *least, double *most)
{
    *least = value < *least ? value : *least;
    *most = value > *most ? value : *most;
}

static bool is_outside(const rheo_plot_axis *axis, double value)
{
    return axis->min < axis->max && (value < axis->min || value > axis->max);
}

/* The range of y is that of the points that the range of x shows. */
static void choose_ranges(const rheo_plot_panel *panel, rheo__plot_range *x, rheo__plot_range *y)
{
    double least[2] = {1e300, 1e300}, most[2] = {-1e300, -1e300};
    for (size_t c = 0; c < panel->curve_count; c++)
        for (size_t i = 0; i < panel->curve[c].count; i++) {
            const double px = panel->curve[c].x[i], py = panel->curve[c].y[i];
            if (!rheo__plot_is_visible(&panel->x, px) || !rheo__plot_is_visible(&panel->y, py) ||
                is_outside(&panel->x, px))
                continue;
            include(px, &least[0], &most[0]);
            include(py, &least[1], &most[1]);
        }
    rheo__plot_choose_range(&panel->x, least[0], most[0], x);
    rheo__plot_choose_range(&panel->y, least[1], most[1], y);
}

/* ---- Elements ---- */

static void put_numbers(rheo__output *out, const char *format, size_t count, const double *value)
{
    for (; *format; format++)
        if (*format == '@') {
            assert(count > 0);
            rheo__plot_number(out, *value++);
            count--;
        } else {
            rheo__output_bytes(out, format, 1);
        }
    assert(count == 0);
}

/* Writes a text, each @ of which is replaced by a number. */
#define PUT(out, format, ...) \
    put_numbers(out, format, sizeof(double[]){__VA_ARGS__} / sizeof(double), (const double[]){__VA_ARGS__})

static void put_label(rheo__output *out, double x, double y, const char *anchor, int size, const char *text)
{
    PUT(out, "<text x=\"@\" y=\"@\"", x, y);
    rheo__output_text(out, anchor);
    if (size != FONT)
        rheo__output_format(out, " font-size=\"%d\"", size);
    rheo__output_text(out, ">");
    rheo__plot_text(out, text, size);
    rheo__output_text(out, "</text>\n");
}

static const char MIDDLE[] = " text-anchor=\"middle\"", END[] = " text-anchor=\"end\"";

static void put_look(rheo__output *out, const rheo_plot_curve *curve)
{
    const uint32_t look = curve->look % RHEO_PLOT_LOOKS;
    rheo__output_format(out, " stroke=\"%s\"", LOOK[look].colour);
    if (curve->mark == RHEO_PLOT_LINE && *LOOK[look].dashes)
        rheo__output_format(out, " stroke-dasharray=\"%s\"", LOOK[look].dashes);
}

/* ---- Panels ---- */

/* Writes the grid and the ticks of both axes, in coordinates of the area of curves. */
static void put_ticks(rheo__output *out, const rheo__plot_range *x, const rheo__plot_range *y)
{
    for (int minor = 0; minor < 2; minor++) {
        rheo__output_text(out, minor ? "<path stroke=\"#666\" d=\"" : "<path stroke=\"#ddd\" d=\"");
        for (uint32_t i = 0; i < x->count; i++) {
            const double at = WIDTH * rheo__plot_place(x, x->tick[i].value),
                         size = x->tick[i].label[0] ? TICK : TICK / 2;
            if (minor)
                PUT(out, "M@ @v@", at, HEIGHT, size);
            else if (x->tick[i].label[0])
                PUT(out, "M@ 0v@", at, HEIGHT);
        }
        for (uint32_t i = 0; i < y->count; i++) {
            const double at = HEIGHT * (1 - rheo__plot_place(y, y->tick[i].value)),
                         size = y->tick[i].label[0] ? TICK : TICK / 2;
            if (minor)
                PUT(out, "M0 @h@", at, -size);
            else if (y->tick[i].label[0])
                PUT(out, "M0 @h@", at, WIDTH);
        }
        rheo__output_text(out, "\"/>\n");
    }
}

static void put_labels(rheo__output *out, const rheo_plot_panel *panel, const rheo__plot_range *x,
                       const rheo__plot_range *y, double left)
{
    for (uint32_t i = 0; i < x->count; i++)
        if (x->tick[i].label[0])
            put_label(out, WIDTH * rheo__plot_place(x, x->tick[i].value), HEIGHT + 18, MIDDLE, FONT,
                      x->tick[i].label);
    for (uint32_t i = 0; i < y->count; i++)
        if (y->tick[i].label[0])
            put_label(out, -7, HEIGHT * (1 - rheo__plot_place(y, y->tick[i].value)) + 4, END, FONT, y->tick[i].label);
    if (panel->title)
        put_label(out, WIDTH / 2., -8, MIDDLE, FONT, panel->title);
    if (panel->x.label)
        put_label(out, WIDTH / 2., HEIGHT + 36, MIDDLE, FONT, panel->x.label);
    if (panel->y.label) {
        PUT(out, "<g transform=\"translate(@ @) rotate(-90)\">", 18 - left, HEIGHT / 2.);
        put_label(out, 0, 0, MIDDLE, FONT, panel->y.label);
        rheo__output_text(out, "</g>\n");
    }
}

/* The area of curves cuts off what is outside. It has a margin for lines and marks at its edges. */
static void put_curves(rheo__output *out, const rheo_plot_panel *panel, const rheo__plot_range *x,
                       const rheo__plot_range *y)
{
    double margin = 1;
    for (size_t c = 0; c < panel->curve_count; c++)
        if (panel->curve[c].mark == RHEO_PLOT_POINTS)
            margin = 5;
    const double width = WIDTH + 2 * margin, height = HEIGHT + 2 * margin;
    PUT(out, "<svg x=\"@\" y=\"@\" width=\"@\" height=\"@\" viewBox=\"@ @ @ @\"", -margin, -margin, width, height,
        -margin, -margin, width, height);
    rheo__output_text(out, " fill=\"none\" stroke-width=\"1.8\" stroke-linejoin=\"round\">\n");
    for (size_t c = 0; c < panel->curve_count; c++) {
        const rheo_plot_curve *curve = &panel->curve[c];
        rheo__output_text(out, "<path");
        put_look(out, curve);
        rheo__output_text(out, " d=\"");
        rheo__plot_line(out, panel, curve, x, y, WIDTH, HEIGHT);
        rheo__output_text(out, curve->name ? "\"><title>" : "\"/>\n");
        if (curve->name) {
            rheo__plot_plain(out, curve->name);
            rheo__output_text(out, "</title></path>\n");
        }
    }
    rheo__output_text(out, "</svg>\n");
}

static void put_panel(const layout *l, size_t index)
{
    const rheo_plot_panel *panel = &l->plot->panel[index];
    rheo__plot_range x, y;
    choose_ranges(panel, &x, &y);
    PUT(l->out, "<g transform=\"translate(@ @)\">\n", l->left + l->pitch * (double)(index % l->plot->columns),
        TOP + ABOVE + l->down * (double)(index / l->plot->columns));
    rheo__output_text(l->out, "<g fill=\"none\">\n");
    put_ticks(l->out, &x, &y);
    PUT(l->out, "<path stroke=\"#666\" d=\"M0 0h@v@h@z\"/>\n</g>\n", WIDTH, HEIGHT, -WIDTH);
    put_labels(l->out, panel, &x, &y, l->left);
    put_curves(l->out, panel, &x, &y);
    rheo__output_text(l->out, "</g>\n");
}

/* ---- Legend ---- */

/* Whether an earlier curve has the same name. */
static bool is_listed(const rheo_plot *plot, size_t panel, size_t curve)
{
    const char *name = plot->panel[panel].curve[curve].name;
    for (size_t p = 0; p <= panel; p++)
        for (size_t c = 0; c < (p < panel ? plot->panel[p].curve_count : curve); c++) {
            const char *other = plot->panel[p].curve[c].name;
            if (other && strcmp(other, name) == 0)
                return true;
        }
    return false;
}

/* Writes the legend, or only counts its rows. */
static uint32_t put_legend(const layout *l, bool writes)
{
    double x = 0;
    uint32_t rows = 0;
    for (size_t p = 0; p < l->plot->panel_count; p++)
        for (size_t c = 0; c < l->plot->panel[p].curve_count; c++) {
            const rheo_plot_curve *curve = &l->plot->panel[p].curve[c];
            if (!curve->name || is_listed(l->plot, p, c))
                continue;
            const double width = SAMPLE + 6 + rheo__plot_text_width(curve->name, FONT) + 20;
            if (rows == 0 || l->left + x + width > l->width) {
                rows++;
                x = 0;
            }
            const double left = l->left + x, y = l->height - EDGE - ENTRY * (l->rows - rows) - 8;
            x += width;
            if (!writes)
                continue;
            rheo__output_text(l->out, "<path fill=\"none\" stroke-width=\"1.8\"");
            put_look(l->out, curve);
            rheo__output_text(l->out, " d=\"");
            if (curve->mark == RHEO_PLOT_LINE)
                PUT(l->out, "M@ @h@", left, y, SAMPLE);
            else
                rheo__plot_mark(l->out, left + SAMPLE / 2., y, curve->look);
            rheo__output_text(l->out, "\"/>\n");
            put_label(l->out, left + SAMPLE + 6, y + 4, "", FONT, curve->name);
        }
    return rows;
}

/* ---- Description ---- */

static void describe_axis(rheo__output *out, const char *which, const rheo_plot_axis *axis)
{
    rheo__output_format(out, " %s: ", which);
    rheo__plot_plain(out, axis->label ? axis->label : "no label");
    rheo__output_text(out, axis->scale == RHEO_PLOT_LOGARITHMIC ? ", logarithmic." : ".");
}

static void describe_curve(rheo__output *out, const rheo_plot_panel *panel, const rheo_plot_curve *curve)
{
    size_t most = curve->count;
    for (size_t i = 0; i < curve->count; i++)
        if (rheo__plot_is_visible(&panel->x, curve->x[i]) && rheo__plot_is_visible(&panel->y, curve->y[i]) &&
            (most == curve->count || curve->y[i] > curve->y[most]))
            most = i;
    rheo__output_text(out, " Curve ");
    rheo__plot_plain(out, curve->name ? curve->name : "without name");
    if (most == curve->count) {
        rheo__output_text(out, ": no points.");
        return;
    }
    char y[32], x[32];
    rheo__output_format(out, ": largest %s at %s.", rheo__text_brief(curve->y[most], 4, false, y),
                        rheo__text_brief(curve->x[most], 4, false, x));
}

static void put_description(const layout *l)
{
    const rheo_plot *plot = l->plot;
    rheo__output_text(l->out, "<title>");
    rheo__plot_plain(l->out, plot->title);
    rheo__output_text(l->out, "</title>\n<desc>");
    rheo__plot_plain(l->out, plot->description ? plot->description : "");
    for (size_t p = 0; p < plot->panel_count; p++) {
        const rheo_plot_panel *panel = &plot->panel[p];
        rheo__output_format(l->out, "\nPanel %zu", p + 1);
        rheo__output_text(l->out, panel->title ? ", " : "");
        rheo__plot_plain(l->out, panel->title ? panel->title : "");
        rheo__output_text(l->out, ".");
        describe_axis(l->out, "Horizontal", &panel->x);
        describe_axis(l->out, "Vertical", &panel->y);
        for (size_t c = 0; c < panel->curve_count; c++)
            describe_curve(l->out, panel, &panel->curve[c]);
    }
    rheo__output_text(l->out, "</desc>\n");
}

/* ---- All ---- */

static void choose_layout(layout *l)
{
    double ticks = 0;
    bool labelled = false;
    for (size_t p = 0; p < l->plot->panel_count; p++) {
        rheo__plot_range x, y;
        choose_ranges(&l->plot->panel[p], &x, &y);
        labelled = labelled || l->plot->panel[p].y.label;
        for (uint32_t i = 0; i < y.count; i++) {
            const double width = rheo__plot_text_width(y.tick[i].label, FONT);
            ticks = width > ticks ? width : ticks;
        }
    }
    const size_t columns = l->plot->columns < l->plot->panel_count ? l->plot->columns : l->plot->panel_count;
    l->left = (labelled ? LABEL : EDGE) + ticks + 7;
    l->pitch = l->left + WIDTH + RIGHT;
    l->down = ABOVE + HEIGHT + BELOW;
    l->width = l->pitch * (double)columns;
    l->rows = put_legend(l, false);
    l->height = TOP + l->down * (double)((l->plot->panel_count + columns - 1) / columns) + l->rows * ENTRY + EDGE;
}

static void put_plot(rheo__output *out, const rheo_plot *plot)
{
    layout l = {.out = out, .plot = plot};
    choose_layout(&l);
    PUT(out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"@\" height=\"@\" viewBox=\"0 0 @ @\" role=\"img\" "
        "font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" font-size=\"",
        l.width, l.height, l.width, l.height);
    rheo__output_format(out, "%d\">\n", FONT);
    put_description(&l);
    rheo__output_text(out, "<path fill=\"#fff\" d=\"M0 0");
    PUT(out, "h@v@h@z\"/>\n", l.width, l.height, -l.width);
    put_label(out, l.width / 2, 20, MIDDLE, TITLE_FONT, plot->title);
    for (size_t p = 0; p < plot->panel_count; p++)
        put_panel(&l, p);
    put_legend(&l, true);
    rheo__output_text(out, "</svg>\n");
}

/* ---- Arguments ---- */

static rheo_result check_axis(const rheo_plot_axis *axis, size_t panel, char name, rheo_error *error)
{
    if (axis->scale != RHEO_PLOT_LINEAR && axis->scale != RHEO_PLOT_LOGARITHMIC)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the scale of %c of panel %zu is %d; it must be linear or logarithmic", name, panel,
                          (int)axis->scale);
    if (axis->min < axis->max && !(rheo__plot_is_visible(axis, axis->min) && rheo__plot_is_visible(axis, axis->max)))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the range of %c of panel %zu must be within +-1e100%s", name,
                          panel,
                          axis->scale == RHEO_PLOT_LOGARITHMIC ? " and above 1e-100, because it is logarithmic" : "");
    return RHEO_OK;
}

static rheo_result check_plot(const rheo_plot *plot, rheo_error *error)
{
    if (!plot || !plot->title || plot->panel_count < 1 || !plot->panel || plot->columns < 1)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a plot needs a title, a panel, and columns");
    for (size_t p = 0; p < plot->panel_count; p++) {
        const rheo_plot_panel *panel = &plot->panel[p];
        RHEO__TRY(check_axis(&panel->x, p, 'x', error));
        RHEO__TRY(check_axis(&panel->y, p, 'y', error));
        if (panel->curve_count && !panel->curve)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "panel %zu has no list of its curves", p);
        for (size_t c = 0; c < panel->curve_count; c++)
            if (panel->curve[c].count && (!panel->curve[c].x || !panel->curve[c].y))
                return rheo__fail(error, RHEO_ERROR_ARGUMENT, "curve %zu of panel %zu has no coordinates", c, p);
    }
    return RHEO_OK;
}

rheo_result rheo_plot_write(const rheo_plot *plot, const char *path, bool force, rheo_error *error)
{
    rheo__output out;
    RHEO__TRY(check_plot(plot, error));
    RHEO__TRY(rheo__output_open(&out, path, force, error));
    put_plot(&out, plot);
    return rheo__output_close(&out, RHEO_OK, error);
}

rheo_result rheo_plot_text(const rheo_plot *plot, char **text, size_t *size, rheo_error *error)
{
    rheo__output out;
    *text = NULL;
    *size = 0;
    RHEO__TRY(check_plot(plot, error));
    rheo__output_open_memory(&out);
    put_plot(&out, plot);
    return rheo__output_close_memory(&out, text, size, error);
}
