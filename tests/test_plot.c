/* Plots: ticks, lines without the points that cannot be seen, texts, and the same bytes everywhere. */
#define _XOPEN_SOURCE 700
#include "view_support.h"

#include <locale.h>

#include "core/text.h"
#include "view/plot.h"

static char svg[1 << 22]; /* the last plot */

static void write_plot(const rheo_plot *plot)
{
    OK(rheo_plot_write(plot, "plot.svg", true, NULL));
    FILE *written = fopen("plot.svg", "rb");
    assert_non_null(written);
    svg[fread(svg, 1, sizeof svg - 1, written)] = 0;
    fclose(written);
    char *text; /* has the same bytes */
    size_t size;
    OK(rheo_plot_text(plot, &text, &size, NULL));
    assert_int_equal(size, strlen(svg));
    assert_string_equal(text, svg);
    free(text);
}

static void write_curves(const rheo_plot_curve *curve, size_t count, rheo_plot_axis x, rheo_plot_axis y)
{
    const rheo_plot_panel panel = {NULL, x, y, count, curve};
    write_plot(&(rheo_plot){.title = "curves", .panel_count = 1, .panel = &panel, .columns = 1});
}

static void write_line(const double *x, const double *y, size_t count)
{
    write_curves(&(rheo_plot_curve){.count = count, .x = x, .y = y}, 1, (rheo_plot_axis){0}, (rheo_plot_axis){0});
}

/* ---- XML ---- */

static bool is_entity(const char *text)
{
    static const char *const known[] = {"&amp;", "&lt;", "&gt;", "&quot;"};
    for (int i = 0; i < 4; i++)
        if (strncmp(text, known[i], strlen(known[i])) == 0)
            return true;
    return false;
}

/* Whether elements are nested and closed, attributes quoted, and texts escaped and printable. */
static bool is_well_formed(const char *text)
{
    char open[16][16];
    int depth = 0, roots = 0;
    while (*text) {
        if (*text != '<') {
            const size_t length = rheo_printable_length(text);
            if ((length == 0 && *text != '\n') || *text == '>' || (*text == '&' && !is_entity(text)) ||
                (depth == 0 && *text != '\n'))
                return false;
            text += length ? length : 1;
            continue;
        }
        const bool closes = text[1] == '/';
        char name[16];
        text += 1 + closes;
        const size_t length = strspn(text, "abcdefghijklmnopqrstuvwxyz");
        if (length == 0 || length > 15 || depth == 15)
            return false;
        snprintf(name, sizeof name, "%.*s", (int)length, text);
        text += length;
        while (*text == ' ') { /* name="value" */
            text += 1 + strcspn(text + 1, "=<>\"");
            const size_t value = strncmp(text, "=\"", 2) == 0 ? strcspn(text + 2, "\"<&") : 0;
            if (text[0] != '=' || text[2 + value] != '"')
                return false;
            text += 3 + value;
        }
        const bool empty = *text == '/';
        text += empty;
        if (*text++ != '>' || (closes && (depth == 0 || strcmp(open[--depth], name) != 0)))
            return false;
        roots += depth == 0 && !closes;
        if (!closes && !empty)
            strcpy(open[depth++], name);
    }
    return depth == 0 && roots == 1;
}

static void the_check_of_xml_notices_errors(void **unused)
{
    (void)unused;
    assert_true(is_well_formed("<a b=\"c\"><d/>e &lt; f<d g=\"\" h=\"1\">i</d></a>\n"));
    static const char *const wrong[] = {
        "<a>",   "<a></b>",     "<a/><a/>", "<a b=c/>",  "<a b=\"<\"/>",   "<a>&</a>",    "<a>></a>",
        "a<a/>", "<a>\001</a>", "</a>",     "<a b=\"/>", "<a><b></a></b>", "<a>\xff</a>", ""};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        if (is_well_formed(wrong[i]))
            fail_msg("not noticed: %s", wrong[i]);
}

/* ---- Ticks ---- */

/* The number of a label, such as "−1.5×10^{−7}". */
static double number_of(const char *label)
{
    char text[64] = "";
    for (const char *c = label; *c;) {
        static const char *const from[] = {"−", "×10^{", "10^{", "}"}, *const to[] = {"-", "e", "1e", ""};
        int which = 0;
        while (which < 4 && strncmp(c, from[which], strlen(from[which])) != 0)
            which++;
        snprintf(text + strlen(text), sizeof text - strlen(text), "%.*s", which < 4 ? 8 : 1,
                 which < 4 ? to[which] : c);
        c += which < 4 ? strlen(from[which]) : 1;
    }
    const char *end;
    const double value = rheo__text_to_double(text, &end);
    if (end == text || *end)
        fail_msg("no number: %s (%s)", label, text);
    return value;
}

static void check_ticks(rheo_plot_scale scale, double least, double most)
{
    rheo__plot_range r;
    rheo__plot_choose_range(&(rheo_plot_axis){.scale = scale}, least, most, &r);
    int labels = 0;
    assert_true(r.count >= 2 && r.count <= RHEO__PLOT_TICKS);
    const double slack = scale == RHEO_PLOT_LINEAR ? 1e-8 * (r.high - r.low) : 0;
    if (!(r.low <= least + slack && r.high >= most - slack && r.low < r.high))
        fail_msg("%g to %g has the range %g to %g", least, most, r.low, r.high);
    for (uint32_t i = 0; i < r.count; i++) {
        const double value = r.tick[i].value, place = rheo__plot_place(&r, value);
        assert_true(place >= -1e-6 && place <= 1 + 1e-6 && (i == 0 || value > r.tick[i - 1].value));
        if (!r.tick[i].label[0])
            continue;
        labels++;
        NEAR(number_of(r.tick[i].label) - value, 0, 1e-14 * fabs(value));
    }
    if (labels < 1 + (scale == RHEO_PLOT_LINEAR || most > 10 * least) || labels > 9)
        fail_msg("%g to %g has %d labels", least, most, labels);
    /* The data fill the axis, but for the way to the next tick. */
    if (scale == RHEO_PLOT_LINEAR && most - least > 1e-8 * fabs(most) + 1e-100 &&
        !(most - least >= .5 * (r.high - r.low)))
        fail_msg("%g to %g fill too little of %g to %g", least, most, r.low, r.high);
}

static void ticks_are_round_and_cover_the_data(void **unused)
{
    (void)unused;
    uint64_t random = 1;
    for (int i = 0; i < 20000; i += (int)every()) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const double exponent = (double)(random >> 33 & 511) / 2.7 - 95, part = (double)(random >> 45) / 0x1p19;
        const double size = pow(10, exponent), low = (part - .5) * size;
        check_ticks(RHEO_PLOT_LINEAR, low, low + size * ((double)(random & 1023) + 1) / 1024);
        check_ticks(RHEO_PLOT_LINEAR, 0, size);
        check_ticks(RHEO_PLOT_LINEAR, -size, 0);
        check_ticks(RHEO_PLOT_LINEAR, size, size);
        check_ticks(RHEO_PLOT_LOGARITHMIC, size, size * (1 + part * part * 1e4));
        check_ticks(RHEO_PLOT_LOGARITHMIC, size, size);
        check_ticks(RHEO_PLOT_LOGARITHMIC, 1 / (size + 1 / size), size + 1 / size);
    }
    check_ticks(RHEO_PLOT_LINEAR, 0, 0);
    check_ticks(RHEO_PLOT_LINEAR, 0, 1e-200);
    check_ticks(RHEO_PLOT_LINEAR, -1e100, 1e100);
    check_ticks(RHEO_PLOT_LINEAR, 1e6, 1e6 + .01);
}

static void assert_labels(rheo_plot_axis axis, double least, double most, const char *wanted)
{
    rheo__plot_range r;
    char all[512] = "";
    rheo__plot_choose_range(&axis, least, most, &r);
    for (uint32_t i = 0; i < r.count; i++)
        if (r.tick[i].label[0])
            snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", *all ? " " : "", r.tick[i].label);
    assert_string_equal(all, wanted);
}

static void labels_are_those_that_one_would_write(void **unused)
{
    (void)unused;
    const rheo_plot_axis linear = {0}, logarithmic = {.scale = RHEO_PLOT_LOGARITHMIC};
    assert_labels(linear, 0, 1499, "0 500 1000 1500");
    assert_labels(linear, 0, 1.109, "0 0.2 0.4 0.6 0.8 1.0 1.2");
    assert_labels(linear, -.013, .021, "−0.02 −0.01 0 0.01 0.02 0.03");
    assert_labels(linear, 0, 4e-9, "0 1×10^{−9} 2×10^{−9} 3×10^{−9} 4×10^{−9}");
    assert_labels(linear, 0, 2.5e7, "0 0.5×10^{7} 1.0×10^{7} 1.5×10^{7} 2.0×10^{7} 2.5×10^{7}");
    assert_labels(linear, 1, 0, "0 0.2 0.4 0.6 0.8 1.0"); /* no data */
    assert_labels((rheo_plot_axis){.min = .5, .max = 3.1}, 0, 9, "0.5 1.0 1.5 2.0 2.5 3.0");
    assert_labels(linear, .25, .25, "0.10 0.15 0.20 0.25 0.30 0.35 0.40"); /* one value is in the middle */
    assert_labels(logarithmic, 1, 500, "1 10 10^{2}");
    assert_labels(logarithmic, 1, 1, "0.5 1 2");
    assert_labels(logarithmic, 1.5, 40, "1 2 5 10 20 50");
    const rheo_plot_axis narrow = {.scale = RHEO_PLOT_LOGARITHMIC, .min = 0.025, .max = 0.045};
    assert_labels(narrow, 0.033, 0.033, "0.03 0.04"); /* regression: no label at all */
    assert_labels(logarithmic, 1e-30, 1, "10^{−30} 10^{−25} 10^{−20} 10^{−15} 10^{−10} 10^{−5} 1");
}

/* ---- Lines ---- */

typedef struct vertices {
    size_t count, parts;
    double x[20000], y[20000];
    bool begins[20000];
} vertices;

static vertices path;

/* Reads the path of the curve with the first colour. */
static void read_path(void)
{
    const char *at = strstr(svg, "stroke=\"#0072b2\" d=\"");
    assert_non_null(at);
    at += strlen("stroke=\"#0072b2\" d=\"");
    path.count = path.parts = 0;
    while (*at == 'M' || *at == 'L') {
        assert_true(path.count < 20000);
        path.begins[path.count] = *at == 'M';
        path.parts += *at == 'M';
        path.x[path.count] = rheo__text_to_double(at + 1, &at);
        path.y[path.count++] = rheo__text_to_double(at + 1, &at);
        at += strncmp(at, "m-1 0h2", 7) == 0 ? 7 : 0;
    }
    assert_int_equal(*at, '"');
}

enum { WIDE = 310, HIGH = 200 }; /* the area of curves */

/* Asserts that each point is within a tenth of a pixel of the path; x increases from 0 to 1, and so does the range of y. */
static void assert_near_path(const double *x, const double *y, size_t count)
{
    size_t k = 0;
    for (size_t i = 0; i < count; i++) {
        const double px = x[i] * WIDE, py = HIGH * (1 - y[i]);
        while (k + 2 < path.count && path.x[k + 1] < px)
            k++;
        const double run = path.x[k + 1] - path.x[k];
        const double at = run > 0 ? path.y[k] + (px - path.x[k]) / run * (path.y[k + 1] - path.y[k]) : path.y[k];
        const double slope = run > 0 ? fabs(path.y[k + 1] - path.y[k]) / run : 0;
        if (fabs(at - py) > .1 + .02 * (1 + slope))
            fail_msg("point %zu at (%g, %g) is %g pixels off", i, px, py, at - py);
    }
}

enum { SMOOTH = 3001, NOISE = 100000 };
static double x_of[NOISE], y_of[NOISE];

static void a_thinned_line_cannot_be_told_from_the_whole(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < 400;
         i++) { /* fewer points than columns, so that only points on straight parts are left out */
        x_of[i] = (double)i / 399;
        y_of[i] = .5 + .5 * sin(6 * x_of[i]) * exp(-x_of[i]);
    }
    y_of[0] = 0;
    y_of[1] = 1;
    write_line(x_of, y_of, 400);
    read_path();
    assert_true(path.count > 20 && path.count < 120 && path.parts == 1);
    assert_near_path(x_of, y_of, 400);
    for (size_t i = 0; i < 400; i++) /* a pulse keeps its corners */
        y_of[i] = i >= 100 && i < 200;
    write_line(x_of, y_of, 400);
    read_path();
    assert_int_equal(path.count, 6);
    assert_near_path(x_of, y_of, 400);
}

static void noise_keeps_its_extremes_and_little_else(void **unused)
{
    (void)unused;
    uint64_t random = 3;
    for (size_t i = 0; i < NOISE; i++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        x_of[i] = (double)i / (NOISE - 1);
        y_of[i] = .01 + .98 * (double)(random >> 34) / 0x1p30;
    }
    y_of[7777] = 0;
    y_of[55555] = 1;
    write_line(x_of, y_of, NOISE);
    read_path();
    assert_true(path.count > 2000 && path.count <= 4 * 4 * WIDE + 4);
    double low = HIGH, high = 0;
    for (size_t i = 0; i < path.count; i++) {
        low = fmin(low, path.y[i]);
        high = fmax(high, path.y[i]);
        if (path.y[i] == HIGH)
            NEAR(path.x[i], x_of[7777] * WIDE, .01);
    }
    assert_true(low == 0 && high == HIGH);
    assert_true(strlen(svg) < 100000);
}

static void lines_may_go_back(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < SMOOTH; i++) { /* a circle, begun and ended on the right */
        x_of[i] = .5 + .5 * cos(2 * 3.14159265358979 * (double)i / (SMOOTH - 1));
        y_of[i] = .5 + .5 * sin(2 * 3.14159265358979 * (double)i / (SMOOTH - 1));
    }
    write_line(x_of, y_of, SMOOTH);
    read_path();
    assert_true(path.count > 40 && path.count < 1500);
    for (size_t i = 0; i < path.count; i++)
        NEAR(hypot(path.x[i] / WIDE - .5, path.y[i] / HIGH - .5), .5, 1e-4);
    NEAR(path.x[0], path.x[path.count - 1], .011);
    for (size_t i = 1; i < path.count; i++) /* no way is cut short: a chord is near its arc */
        assert_true(hypot((path.x[i] + path.x[i - 1]) / 2 / WIDE - .5, (path.y[i] + path.y[i - 1]) / 2 / HIGH - .5) >
                    .4985);
}

/* Of the points in a column, the first, the highest, the lowest and the last stay, in the order of the curve. */
static void a_column_keeps_four_points_in_their_order(void **unused)
{
    (void)unused;
    static const int TURN[][4] = {/* places of the first, the least, the greatest and the last of ten points */
                                  {0, 3, 6, 9}, {0, 6, 3, 9}, {0, 0, 6, 9}, {0, 6, 0, 9},
                                  {0, 3, 9, 9}, {0, 9, 3, 9}, {0, 0, 9, 9}, {0, 9, 0, 9}};
    for (size_t t = 0; t < sizeof TURN / sizeof *TURN; t++) {
        double x[12], y[12], expected[12];
        size_t count = 1;
        x[0] = expected[0] = y[0] = 0;
        x[11] = y[11] = 1;
        for (int i = 0; i < 10; i++) {
            x[i + 1] = (100.1 + .01 * i) / (4. * WIDE); /* all in the column 100 of quarters of a pixel */
            y[i + 1] = i == TURN[t][1] ? .1 : i == TURN[t][2] ? .9 : i == 0 ? .3 : i == 9 ? .7 : .5;
            if (i == TURN[t][0] || i == TURN[t][1] || i == TURN[t][2] || i == TURN[t][3])
                expected[count++] = y[i + 1];
        }
        expected[count++] = 1;
        write_line(x, y, 12);
        read_path();
        assert_int_equal(path.count, count);
        for (size_t i = 0; i < count; i++)
            NEAR(path.y[i], HIGH * (1 - expected[i]), .011);
    }
}

static void gaps_stay_open(void **unused)
{
    (void)unused;
    const double x[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, y[] = {1, 2, NAN, 4, INFINITY, 5, 6, -1e101, 1, 1};
    write_line(x, y, 10);
    read_path();
    assert_int_equal(path.parts, 4);
    assert_non_null(strstr(svg, "m-1 0h2")); /* the lonely fourth point */
    const double powers[] = {1, 10, 0, 100, -5, 1000, 1e-101, 10, 10, 1};
    write_curves(&(rheo_plot_curve){.count = 10, .x = x, .y = powers}, 1, (rheo_plot_axis){0},
                 (rheo_plot_axis){.scale = RHEO_PLOT_LOGARITHMIC});
    read_path();
    assert_int_equal(path.parts, 4);
    NEAR(path.y[0], HIGH, .011); /* 1 to 1000: three decades */
    NEAR(path.y[1], HIGH * 2 / 3., .011);
    NEAR(path.y[2], HIGH / 3., .011);
    /* Nothing can be seen. */
    write_line(x, powers, 0);
    read_path();
    assert_int_equal(path.count, 0);
    assert_true(is_well_formed(svg));
}

static void a_given_range_cuts_off(void **unused)
{
    (void)unused;
    const double x[] = {0, 1, 2, 3, 4}, y[] = {0, 1, 0, 50, 1e99};
    write_curves(&(rheo_plot_curve){.count = 5, .x = x, .y = y}, 1, (rheo_plot_axis){.min = 0, .max = 2},
                 (rheo_plot_axis){0});
    read_path();
    NEAR(path.x[1], WIDE / 2., .011);
    NEAR(path.y[1], 0, .011); /* y is that of the points in the range of x */
    assert_true(fabs(path.y[path.count - 1]) <= 100 * HIGH);
    assert_non_null(strstr(svg, "<svg x=\"-1\" y=\"-1\" width=\"312\" height=\"202\" viewBox=\"-1 -1 312 202\""));
}

static void points_outside_are_left_out(void **unused)
{
    (void)unused;
    const double x[] = {1, -1, 3, 1, 1, 2, 3}, y[] = {1, 1, 1, -1, 3, 0, 3};
    write_curves(&(rheo_plot_curve){.count = 7, .x = x, .y = y, .mark = RHEO_PLOT_POINTS}, 1,
                 (rheo_plot_axis){.min = 0, .max = 2}, (rheo_plot_axis){.min = 0, .max = 2});
    assert_non_null(
        strstr(svg, " d=\"M155 100m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0M310 200m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0\"/>"));
}

/* The # of the frame's colour was once taken for the place of a number. */
static void panels_have_frames(void **unused)
{
    (void)unused;
    const double x[] = {0, 1};
    const rheo_plot_curve curve[] = {{.count = 2, .x = x, .y = x},
                                     {.count = 2, .x = x, .y = x, .mark = RHEO_PLOT_POINTS}};
    write_curves(curve, 1, (rheo_plot_axis){0}, (rheo_plot_axis){0});
    assert_non_null(strstr(svg, "<path stroke=\"#666\" d=\"M0 0h310v200h-310z\"/>"));
    assert_null(strchr(svg, '@'));
    /* Curves have a margin, which is wider for points. */
    assert_non_null(strstr(svg, "<svg x=\"-1\" y=\"-1\" width=\"312\""));
    write_curves(curve + 1, 1, (rheo_plot_axis){0}, (rheo_plot_axis){0});
    assert_non_null(strstr(svg, "<svg x=\"-5\" y=\"-5\" width=\"320\""));
}

static void points_have_shapes(void **unused)
{
    (void)unused;
    const double x[] = {0, 1, 1, 2, NAN}, y[] = {0, 1, 1, 2, 1};
    rheo_plot_curve curve[RHEO_PLOT_LOOKS];
    for (uint32_t i = 0; i < RHEO_PLOT_LOOKS; i++)
        curve[i] = (rheo_plot_curve){"points", 5, x, y, RHEO_PLOT_POINTS, i};
    write_curves(curve, RHEO_PLOT_LOOKS, (rheo_plot_axis){0}, (rheo_plot_axis){0});
    int marks = 0;
    for (const char *at = svg; (at = strstr(at, "M155 100")) != NULL; at++) /* those at the same place once */
        marks++;
    assert_int_equal(marks, RHEO_PLOT_LOOKS);
    assert_null(strstr(svg, "stroke-dasharray"));
    assert_true(is_well_formed(svg));
}

/* ---- Texts ---- */

static void texts_are_escaped(void **unused)
{
    (void)unused;
    const double x[] = {0, 1};
    const rheo_plot_curve curve = {"a < b & \"c\" > 'd'\002", 2, x, x, RHEO_PLOT_LINE, 0};
    const rheo_plot_panel panel = {"ends\xff badly \xe2\x88",
                                   {"^{open, x_{i} and max_speed", RHEO_PLOT_LINEAR, 0, 0},
                                   {"D^{q} x in L/T^{q}", RHEO_PLOT_LINEAR, 0, 0},
                                   1,
                                   &curve};
    const rheo_plot plot = {"<script>alert(1)</script>\n\001", "1 < 2 & ]]>", 1, &panel, 1};
    write_plot(&plot);
    assert_true(is_well_formed(svg));
    assert_null(strstr(svg, "<script"));
    assert_non_null(strstr(svg, "<title>&lt;script&gt;alert(1)&lt;/script&gt;?\?</title>"));
    assert_non_null(strstr(svg, "<title>a &lt; b &amp; &quot;c&quot; &gt; 'd'?</title>"));
    assert_non_null(strstr(svg, ">ends? badly ?\?</text>"));
    assert_non_null(strstr(svg,
                           ">D<tspan dy=\"-4\" font-size=\"9\">q</tspan><tspan dy=\"4\" dx=\"3\">x in L/T</tspan>"
                           "<tspan dy=\"-4\" font-size=\"9\">q</tspan></text>"));
    assert_non_null(strstr(svg, "Vertical: D^q x in L/T^q."));
    assert_non_null(strstr(svg, "max_speed</t"));
}

static void screen_readers_get_the_contents(void **unused)
{
    (void)unused;
    const double x[] = {0, 1, 2}, y[] = {1, 2.34567, 0}, none[] = {NAN, NAN, NAN};
    const rheo_plot_curve curve[] = {{"first", 3, x, y, RHEO_PLOT_LINE, 0}, {NULL, 3, x, none, RHEO_PLOT_LINE, 1}};
    const rheo_plot_panel panel[] = {
        {"above", {"time, T", RHEO_PLOT_LINEAR, 0, 0}, {NULL, RHEO_PLOT_LOGARITHMIC, 0, 0}, 2, curve},
        {NULL, {NULL, RHEO_PLOT_LINEAR, 0, 0}, {NULL, RHEO_PLOT_LINEAR, 0, 0}, 1, curve}};
    write_plot(&(rheo_plot){"all", "It falls.", 2, panel, 1});
    assert_non_null(strstr(svg, " role=\"img\" "));
    assert_non_null(strstr(
        svg,
        ">\n<title>all</title>\n<desc>It falls.\nPanel 1, above. Horizontal: time, T. Vertical: no label, logarithmic. "
        "Curve first: largest 2.346 at 1. Curve without name: no points.\nPanel 2. "));
    /* The legend has each name once. */
    const char *entry = strstr(svg, ">first</text>");
    assert_non_null(entry);
    assert_null(strstr(entry + 1, ">first</text>"));
}

/* ---- Files ---- */

static rheo_plot sample_plot(void)
{
    static rheo_plot_curve curve[3];
    static rheo_plot_panel panel[2];
    static double x[200], y[3][200];
    static const char *const names[] = {"q = 0.2", "q = 0.5", "measured"};
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < 200; i++) {
            x[i] = 1 + i;
            y[c][i] = 1 / (1 + .01 * (c + 1) * i * i);
        }
        curve[c] = (rheo_plot_curve){names[c],   c < 2 ? 200 : 20, x, y[c], c < 2 ? RHEO_PLOT_LINE : RHEO_PLOT_POINTS,
                                     (uint32_t)c};
    }
    panel[0] = (rheo_plot_panel){
        "linear", {"time, T", RHEO_PLOT_LINEAR, 0, 0}, {"F, ML/T^{2}", RHEO_PLOT_LINEAR, 0, 0}, 3, curve};
    panel[1] = (rheo_plot_panel){"logarithmic",
                                 {"time, T", RHEO_PLOT_LOGARITHMIC, 0, 0},
                                 {"F, ML/T^{2}", RHEO_PLOT_LOGARITHMIC, 0, 0},
                                 3,
                                 curve};
    return (rheo_plot){"a sample", "Curves that fall.", 2, panel, 2};
}

static void a_german_locale_gives_the_same_bytes(void **unused)
{
    (void)unused;
    const rheo_plot plot = sample_plot();
    write_plot(&plot);
    assert_true(is_well_formed(svg));
    char *plain = strdup(svg);
    assert_non_null(plain);
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
        free(plain);
        print_message("no German locale here: nothing to compare\n");
        skip();
    }
    write_plot(&plot);
    setlocale(LC_ALL, "C");
    assert_string_equal(svg, plain);
    free(plain);
}

static void bad_plots_are_refused(void **unused)
{
    (void)unused;
    rheo_plot plot = sample_plot();
    rheo_plot_panel *panel = (rheo_plot_panel *)plot.panel;
    remove("plot.svg");
    plot.title = NULL;
    REFUSED(RHEO_ERROR_ARGUMENT, "a title", rheo_plot_write(&plot, "plot.svg", true, &error));
    plot = sample_plot();
    plot.panel_count = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "a panel", rheo_plot_write(&plot, "plot.svg", true, &error));
    plot = sample_plot();
    plot.columns = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "columns", rheo_plot_write(&plot, "plot.svg", true, &error));
    plot = sample_plot();
    ((rheo_plot_curve *)panel[1].curve)[2].y = NULL;
    REFUSED(RHEO_ERROR_ARGUMENT, "curve 2 of panel 0 has no coordinates",
            rheo_plot_write(&plot, "plot.svg", true, &error));
    plot = sample_plot();
    panel[1].curve = NULL;
    REFUSED(RHEO_ERROR_ARGUMENT, "panel 1 has no list", rheo_plot_write(&plot, "plot.svg", true, &error));
    plot = sample_plot();
    panel[1].x.min = -1;
    panel[1].x.max = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "the range of x of panel 1 must be within +-1e100 and above 1e-100",
            rheo_plot_write(&plot, "plot.svg", true, &error));
    plot = sample_plot();
    panel[0].y.max = INFINITY;
    REFUSED(RHEO_ERROR_ARGUMENT, "the range of y of panel 0", rheo_plot_write(&plot, "plot.svg", true, &error));
    plot = sample_plot();
    panel[0].y.scale = (rheo_plot_scale)2;
    REFUSED(RHEO_ERROR_ARGUMENT, "the scale of y of panel 0 is 2; it must be linear or logarithmic",
            rheo_plot_write(&plot, "plot.svg", true, &error));
    assert_int_not_equal(access("plot.svg", F_OK), 0);
    plot = sample_plot();
    char *text = svg;
    size_t size = 1;
    plot.panel_count = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "a panel", rheo_plot_text(&plot, &text, &size, &error));
    assert_null(text);
    assert_int_equal(size, 0);
    plot = sample_plot();
    REFUSED(RHEO_ERROR_FILE, "cannot write", rheo_plot_write(&plot, "nowhere/plot.svg", true, &error));
    OK(rheo_plot_write(&plot, "plot.svg", false, NULL));
    REFUSED(RHEO_ERROR_ARGUMENT, "exists already", rheo_plot_write(&plot, "plot.svg", false, &error));
}

int main(int argc, char **argv)
{
    if (argc > 1) { /* to look at it */
        const rheo_plot plot = sample_plot();
        return rheo_plot_write(&plot, argv[1], true, NULL) != RHEO_OK;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_check_of_xml_notices_errors),
        cmocka_unit_test(ticks_are_round_and_cover_the_data),
        cmocka_unit_test(labels_are_those_that_one_would_write),
        cmocka_unit_test(a_thinned_line_cannot_be_told_from_the_whole),
        cmocka_unit_test(noise_keeps_its_extremes_and_little_else),
        cmocka_unit_test(lines_may_go_back),
        cmocka_unit_test(a_column_keeps_four_points_in_their_order),
        cmocka_unit_test(gaps_stay_open),
        cmocka_unit_test(a_given_range_cuts_off),
        cmocka_unit_test(points_outside_are_left_out),
        cmocka_unit_test(panels_have_frames),
        cmocka_unit_test(points_have_shapes),
        cmocka_unit_test(texts_are_escaped),
        cmocka_unit_test(screen_readers_get_the_contents),
        cmocka_unit_test(a_german_locale_gives_the_same_bytes),
        cmocka_unit_test(bad_plots_are_refused),
    };
    return cmocka_run_group_tests_name("plot", tests, set_up, tear_down);
}
