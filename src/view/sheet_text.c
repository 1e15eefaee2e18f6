/*
 * A stroke font. A letter is a list of strokes, and a stroke a list of points: a digit across, from 0 to 4, and one up.
 * The base line is at 2, small letters end at 6, capitals at 8. The points inside a stroke that begins with ~ pull a
 * curve that runs through the middles between them: a quadratic spline.
 */
#include <string.h>

#include "view/picture.h"
#include "view/vectors.h"

#define NARROW .75    /* width of a unit across, relative to that of a unit up */
#define THICKNESS .07 /* half of it, relative to the height of capitals */

enum { UNITS = 6, BASE = 2, MOST_LINES = 64, PARTS = 5 /* straight lines of a part of a curve */ };

/* clang-format off */
static const char *const LETTERS[128] = {
    ['0'] = "~284842020828", ['1'] = "172822", ['2'] = "~0608484502 0242", ['3'] = "~0728484525 ~2545422203",
    ['4'] = "380444 3832", ['5'] = "480805 ~052646422203", ['6'] = "~47280804 ~264642020626", ['7'] = "084812",
    ['8'] = "~284845050828 ~254542020525", ['9'] = "~284844040828 ~46422203",
    ['+'] = "2327 0545", ['-'] = "0545", ['.'] = "0202", [','] = "1201", [':'] = "0202 0505", ['/'] = "0148",
    ['^'] = "062846", ['('] = "~19080210", [')'] = "~09181200", ['='] = "0444 0646", ['|'] = "0109",
    ['A'] = "022842 1434", ['B'] = "0802 0828 ~28484525 0525 ~25454222 2202", ['C'] = "~472808022243",
    ['D'] = "28080222 ~22424828", ['E'] = "48080242 0535", ['F'] = "480802 0535", ['G'] = "~472808022243 434525",
    ['H'] = "0802 4842 0545", ['I'] = "0802", ['J'] = "4844 ~44422203", ['K'] = "0802 4804 1542", ['L'] = "080242",
    ['M'] = "0208244842", ['N'] = "02084248", ['O'] = "~284842020828", ['P'] = "020828 ~28484424 2404",
    ['Q'] = "~284842020828 2442", ['R'] = "020828 ~28484424 2404 2442", ['S'] = "~4728080545422203",
    ['T'] = "0848 2822", ['U'] = "0804 ~04024244 4448", ['V'] = "082248", ['W'] = "0812263248", ['X'] = "0248 0842",
    ['Y'] = "0825 4825 2522", ['Z'] = "08480242",
    ['a'] = "~264642020626 4642", ['b'] = "0802 ~264642020626", ['c'] = "~452606022243", ['d'] = "4842 ~264642020626",
    ['e'] = "0444 ~44462606022243", ['f'] = "~381815 1512 0636", ['g'] = "~264642020626 4641 ~41402001",
    ['h'] = "0802 ~04064643 4342", ['i'] = "0602 0808", ['j'] = "1611 ~111000 1818", ['k'] = "0802 3604 1532",
    ['l'] = "0802", ['m'] = "0602 ~04062624 2422 ~24264644 4442", ['n'] = "0602 ~04064643 4342",
    ['o'] = "~264642020626", ['p'] = "0600 ~264642020626", ['q'] = "4640 ~264642020626", ['r'] = "0602 ~040636",
    ['s'] = "~4526060444422203", ['t'] = "1814 ~141232 0636", ['u'] = "0604 ~04024244 4642", ['v'] = "062246",
    ['w'] = "0612253246", ['x'] = "0246 0642", ['y'] = "0622 4610", ['z'] = "06460242",
};
/* clang-format on */

static const char *strokes_of(char character)
{
    const char *strokes = (unsigned char)character < 128 ? LETTERS[(unsigned char)character] : NULL;
    return strokes ? strokes : "0848420208"; /* a box */
}

/* Width in units. Digits have the same, so that numbers in a film do not tremble. */
static int width_of(char character)
{
    int width = 0, across = 1;
    if (character == ' ')
        return 1;
    if (character >= '0' && character <= '9')
        return 4;
    for (const char *s = strokes_of(character); *s; s++) {
        if (*s == ' ' || *s == '~')
            across = 1;
        else if (across && *s - '0' > width)
            width = *s - '0', across = 0;
        else
            across = !across;
    }
    return width;
}

/* ---- Lines of a letter ---- */

typedef struct lines {
    int count;
    double end[MOST_LINES][2][2]; /* in pixels */
} lines;

static void add_line(lines *l, const double a[2], const double b[2])
{
    if (l->count == MOST_LINES)
        return;
    memcpy(l->end[l->count][0], a, sizeof l->end[0][0]);
    memcpy(l->end[l->count++][1], b, sizeof l->end[0][1]);
}

/* From a, pulled by the point between, to b. */
static void add_curve(lines *l, const double a[2], const double between[2], const double b[2])
{
    double from[2] = {a[0], a[1]};
    for (int part = 1; part <= PARTS; part++) {
        const double t = (double)part / PARTS;
        double to[2];
        for (int k = 0; k < 2; k++)
            to[k] = (1 - t) * (1 - t) * a[k] + 2 * t * (1 - t) * between[k] + t * t * b[k];
        add_line(l, from, to);
        memcpy(from, to, sizeof from);
    }
}

static void add_stroke(lines *l, const double (*point)[2], int points, bool is_curve)
{
    double from[2] = {point[0][0], point[0][1]};
    for (int i = 1; i < points; i++) {
        if (!is_curve) {
            add_line(l, point[i - 1], point[i]);
        } else if (i + 1 < points) {
            double to[2];
            for (int k = 0; k < 2; k++)
                to[k] = i + 2 < points ? .5 * (point[i][k] + point[i + 1][k]) : point[i + 1][k];
            add_curve(l, from, point[i], to);
            memcpy(from, to, sizeof from);
        }
    }
}

/* The lines of a letter at a place. */
static lines lines_of(char character, double x, double y, double unit)
{
    enum { MOST_POINTS = 16 };
    lines l = {.count = 0};
    const char *s = character == ' ' ? "" : strokes_of(character);
    while (*s) {
        double point[MOST_POINTS][2];
        int points = 0;
        const bool is_curve = *s == '~';
        s += is_curve;
        for (; *s && *s != ' ' && points < MOST_POINTS; s += 2, points++) {
            point[points][0] = x + NARROW * unit * (s[0] - '0');
            point[points][1] = y - unit * (s[1] - '0' - BASE);
        }
        add_stroke(&l, (const double(*)[2])point, points, is_curve);
        s += *s == ' ';
    }
    return l;
}

/* ---- Pixels ---- */

static double distance_to(const double end[2][2], double x, double y)
{
    const double along[2] = {end[1][0] - end[0][0], end[1][1] - end[0][1]}, from[2] = {x - end[0][0], y - end[0][1]};
    const double square = along[0] * along[0] + along[1] * along[1];
    double part = square > 0 ? (along[0] * from[0] + along[1] * from[1]) / square : 0;
    part = part > 0 ? part < 1 ? part : 1 : 0;
    const double away[2] = {from[0] - part * along[0], from[1] - part * along[1]};
    return __builtin_sqrt(away[0] * away[0] + away[1] * away[1]);
}

static const double INK[3] = {.08, .09, .11}, HALO[3] = {.93, .94, .96};

/* How dark a pixel is: 0 in front of the background and a floor, even in a shadow, to 1. */
static double darkness(const rheo__sheet *sheet, uint32_t column, uint32_t row)
{
    const unsigned char *pixel = sheet->rgb + 3 * ((size_t)row * sheet->width + column);
    const double dark = (.6 - (pixel[0] + pixel[1] + pixel[2]) / 765.) / .2;
    return dark > 0 ? dark < 1 ? dark : 1 : 0;
}

/* Mixes a pixel with a colour. */
static void mix(const rheo__sheet *sheet, uint32_t column, uint32_t row, const double colour[3], double part)
{
    unsigned char *pixel = sheet->rgb + 3 * ((size_t)row * sheet->width + column);
    for (int k = 0; k < 3; k++) {
        const double old = pixel[k] / 255.;
        pixel[k] = (unsigned char)(255 * __builtin_sqrt((1 - part) * old * old + part * colour[k] * colour[k]) + .5);
    }
}

static uint32_t within(double place, uint32_t end)
{
    return place > 0 ? place < end ? (uint32_t)place : end : 0;
}

/* A halo around the lines lets them be read in front of something dark. */
static void draw_lines(const rheo__sheet *sheet, const lines *l, double x, double y, double unit, bool halo)
{
    const double thin = THICKNESS * UNITS * unit > .6 ? THICKNESS * UNITS * unit : .6, wide = thin + .7 * unit + 1,
                 half = halo ? wide : thin, soft = halo ? .7 * unit + 1 : 1, margin = half + 1;
    const uint32_t left = within(x - margin, sheet->width),
                   right = within(x + 4 * NARROW * unit + margin, sheet->width),
                   top = within(y - (9 - BASE) * unit - margin, sheet->height),
                   bottom = within(y + BASE * unit + margin, sheet->height);
    for (uint32_t row = top; row < bottom; row++)
        for (uint32_t column = left; column < right; column++) {
            double nearest = 1e9;
            for (int i = 0; i < l->count; i++) {
                const double distance = distance_to(l->end[i], column + .5, row + .5);
                nearest = distance < nearest ? distance : nearest;
            }
            const double part = (half + .5 - nearest) / soft;
            if (part > 0)
                mix(sheet, column, row, halo ? HALO : INK,
                    (halo ? .8 * darkness(sheet, column, row) : 1) * (part < 1 ? part : 1));
        }
}

void rheo__sheet_text(const rheo__sheet *sheet, double x, double y, double height, const char *text)
{
    const double unit = height / UNITS;
    for (int halo = 1; halo >= 0; halo--) {
        double left = x;
        for (const char *letter = text; *letter; letter++) {
            const lines l = lines_of(*letter, left, y, unit);
            draw_lines(sheet, &l, left, y, unit, halo == 1);
            left += NARROW * unit * (width_of(*letter) + 2);
        }
    }
}

double rheo__text_length(double height, const char *text)
{
    int units = 0;
    for (; *text; text++)
        units += width_of(*text) + 2;
    return units ? NARROW * height / UNITS * (units - 2) : 0;
}
