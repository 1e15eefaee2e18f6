/*
 * Lights the samples of a picture: a key light with soft shadows, a fill light, and a sky that crevices see little of.
 * Colours are linear: the stored value of a pixel is the square root, which is close to sRGB.
 */
#include <stdlib.h>
#include <string.h>

#include "core/math.h"
#include "view/canvas.h"
#include "view/vectors.h"

/*
 * A pixel looks at a few points for shadows and crevices. The four pixels of a block look at different ones, and every
 * pixel uses the mean of a block, so that it has seen four times as many.
 */
enum { BLOCK = 2, PHASES = BLOCK * BLOCK, TAPS = 4 };

/* What the first sample of a pixel sees: the parts of the key light and of the sky. */
typedef struct view {
    float lit, open;
} view;

/* What is common to all pixels. */
typedef struct lights {
    const rheo__canvas *canvas;
    uint32_t width, height;      /* in pixels */
    double reach, bias, blur;    /* unit L */
    double tap[PHASES][TAPS][2]; /* points of the unit disc */
    double fill[3], sky[3];      /* directions */
    view *view;                  /* of each pixel */
    /* Number of tiles above and to the left of a corner that show something else than one floor and the background. */
    uint32_t *busy, corners; /* row by row; corners in a row */
} lights;

/* ---- Shadows: the depths that the light sees ---- */

/* A point as the light sees it: cells to the right and up, and the distance along its direction. */
static void seen_by_light(const rheo__canvas *c, const double point[3], double seen[3])
{
    double from[3];
    for (int a = 0; a < 3; a++)
        from[a] = point[a] - c->light_centre[a];
    const double scale = .5 * RHEO__SHADOW / c->light_half;
    seen[0] = .5 * RHEO__SHADOW + scale * rheo__view_dot(from, c->light_aside);
    seen[1] = .5 * RHEO__SHADOW + scale * rheo__view_dot(from, c->light_up);
    seen[2] = -rheo__view_dot(from, c->light);
}

/* The cells with centres between two places: the first, and the one after the last. */
static void cells_between(double low, double high, uint32_t cell[2])
{
    for (int end = 0; end < 2; end++) {
        const double place = (end ? high : low) + .5;
        cell[end] = (uint32_t)(place > 0 ? place < RHEO__SHADOW ? place : RHEO__SHADOW : 0);
    }
}

static void cast(rheo__canvas *canvas, uint32_t column, uint32_t row, double depth)
{
    float *cell = &canvas->shadow[(size_t)row * RHEO__SHADOW + column];
    *cell = (float)depth < *cell ? (float)depth : *cell;
}

void rheo__shade_sphere(rheo__canvas *canvas, const double centre[3], double radius)
{
    double seen[3];
    uint32_t column[2], row[2];
    seen_by_light(canvas, centre, seen);
    const double scale = 2 * canvas->light_half / RHEO__SHADOW, cells = radius / scale;
    cells_between(seen[0] - cells, seen[0] + cells, column);
    cells_between(seen[1] - cells, seen[1] + cells, row);
    for (uint32_t k = row[0]; k < row[1]; k++)
        for (uint32_t i = column[0]; i < column[1]; i++) {
            const double x = (i + .5 - seen[0]) * scale, y = (k + .5 - seen[1]) * scale;
            const double left = radius * radius - x * x - y * y;
            if (left >= 0)
                cast(canvas, i, k, seen[2] - __builtin_sqrt(left));
        }
}

void rheo__shade_triangle(rheo__canvas *canvas, const double corner[3][3])
{
    double seen[3][3], low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (int k = 0; k < 3; k++) {
        seen_by_light(canvas, corner[k], seen[k]);
        for (int a = 0; a < 2; a++) {
            low[a] = seen[k][a] < low[a] ? seen[k][a] : low[a];
            high[a] = seen[k][a] > high[a] ? seen[k][a] : high[a];
        }
    }
    uint32_t column[2], row[2];
    cells_between(low[0], high[0], column);
    cells_between(low[1], high[1], row);
    for (uint32_t y = row[0]; y < row[1]; y++)
        for (uint32_t x = column[0]; x < column[1]; x++) {
            double part[3], depth = 0, sum = 0;
            for (int k = 0; k < 3; k++) {
                const double *a = seen[(k + 1) % 3], *b = seen[(k + 2) % 3];
                part[k] = (a[0] - (x + .5)) * (b[1] - (y + .5)) - (a[1] - (y + .5)) * (b[0] - (x + .5));
                depth += part[k] * seen[k][2];
                sum += part[k];
            }
            const bool inside =
                (part[0] >= 0 && part[1] >= 0 && part[2] >= 0) || (part[0] <= 0 && part[1] <= 0 && part[2] <= 0);
            if (inside && sum != 0)
                cast(canvas, x, y, depth / sum);
        }
}

/* The part of the key light that reaches a point. */
static double lit_part(const lights *l, int phase, const double point[3], const double normal[3])
{
    const rheo__canvas *c = l->canvas;
    double off[3], seen[3];
    for (int a = 0; a < 3; a++)
        off[a] = point[a] + l->bias * (normal[a] + c->light[a]);
    seen_by_light(c, off, seen);
    const double blur = l->blur * .5 * RHEO__SHADOW / c->light_half, soft = 1 / l->bias;
    double sum = 0;
    for (int t = 0; t < TAPS; t++) {
        const double x = seen[0] + blur * l->tap[phase][t][0], y = seen[1] + blur * l->tap[phase][t][1];
        if (!(x >= 0 && x < RHEO__SHADOW && y >= 0 && y < RHEO__SHADOW)) {
            sum += 1;
            continue;
        }
        const double behind = soft * (seen[2] - (double)c->shadow[(size_t)(uint32_t)y * RHEO__SHADOW + (uint32_t)x]);
        sum += behind > 0 ? behind < 1 ? 1 - behind : 0 : 1;
    }
    return sum / TAPS;
}

/* ---- Crevices ---- */

static bool is_floor(const rheo__sample *s)
{
    return s->paint == RHEO__PAINT_FLOOR || s->paint == RHEO__PAINT_LINE;
}

/* Most of a picture is a floor that nothing is near. A floor hides no sky from itself, so points need not be looked at. */
enum { TILE = 16 };

static bool is_busy(const rheo__canvas *c, uint32_t left, uint32_t top)
{
    const rheo__sample *floor = NULL;
    for (uint32_t row = top; row < top + TILE && row < c->height; row++)
        for (uint32_t column = left; column < left + TILE && column < c->width; column++) {
            const rheo__sample *s = &c->sample[(size_t)row * c->width + column];
            if (s->paint == RHEO__PAINT_NONE)
                continue;
            floor = floor ? floor : s;
            if (!is_floor(s) || memcmp(s->normal, floor->normal, sizeof s->normal) != 0)
                return true;
        }
    return false;
}

static bool count_tiles(lights *l)
{
    const rheo__canvas *c = l->canvas;
    const uint32_t across = (c->width + TILE - 1) / TILE, down = (c->height + TILE - 1) / TILE;
    l->corners = across + 1;
    l->busy = calloc((size_t)l->corners * (down + 1), sizeof *l->busy);
    for (uint32_t k = 0; l->busy && k < down; k++)
        for (uint32_t i = 0, sum = 0; i < across; i++) {
            uint32_t *corner = &l->busy[(size_t)k * l->corners + i];
            sum += is_busy(c, TILE * i, TILE * k);
            corner[l->corners + 1] = corner[1] + sum;
        }
    return l->busy != NULL;
}

/* Whether a floor fills what is around a sample. Two floors with one normal are parallel, and the upper one hides the lower. */
static bool is_plain(const lights *l, uint32_t column, uint32_t row, double radius)
{
    const rheo__canvas *c = l->canvas;
    const double x = column + .5, y = row + .5;
    const uint32_t left = (uint32_t)(x > radius ? x - radius : 0) / TILE,
                   top = (uint32_t)(y > radius ? y - radius : 0) / TILE;
    const double right = x + radius < c->width ? x + radius : c->width - 1,
                 bottom = y + radius < c->height ? y + radius : c->height - 1;
    const size_t first = (size_t)top * l->corners, last = (size_t)((uint32_t)bottom / TILE + 1) * l->corners;
    const uint32_t end = (uint32_t)right / TILE + 1;
    return l->busy[last + end] - l->busy[last + left] - l->busy[first + end] + l->busy[first + left] == 0;
}

/* The part of the sky that a point sees: things in front of its tangent plane hide some, near ones more. */
static double open_part(const lights *l, int phase, uint32_t column, uint32_t row, const double point[3],
                        const double normal[3])
{
    const rheo__canvas *c = l->canvas;
    const double radius = l->reach / (point[2] * c->step), square = l->reach * l->reach;
    double hidden = 0;
    if (is_floor(&c->sample[(size_t)row * c->width + column]) && is_plain(l, column, row, radius))
        return 1;
    for (int t = 0; t < TAPS; t++) {
        const double x = column + .5 + radius * l->tap[phase][t][0], y = row + .5 + radius * l->tap[phase][t][1];
        if (!(x >= 0 && x < c->width && y >= 0 && y < c->height))
            continue;
        const uint32_t i = (uint32_t)x, k = (uint32_t)y;
        const double depth = (double)c->sample[(size_t)k * c->width + i].depth;
        if (!(depth < 4 * point[2]))
            continue;
        double ray[3], to[3];
        rheo__canvas_ray(c, i, k, ray);
        for (int a = 0; a < 3; a++)
            to[a] = depth * ray[a] - point[a];
        const double distance = rheo__view_dot(to, to), above = rheo__view_dot(to, normal) - .02 * l->reach;
        if (above > 0 && distance < 4 * square)
            hidden += above * l->reach / (distance + .02 * square);
    }
    const double open = 1 - .8 * hidden / TAPS;
    return open > .1 ? open : .1;
}

/* ---- Views ---- */

static void place_of(const lights *l, uint32_t column, uint32_t row, double point[3], double normal[3])
{
    const rheo__sample *s = &l->canvas->sample[(size_t)row * l->canvas->width + column];
    rheo__canvas_ray(l->canvas, column, row, point);
    for (int a = 0; a < 3; a++) {
        point[a] *= (double)s->depth;
        normal[a] = s->normal[a] * (1. / RHEO__NORMAL);
    }
}

/* Far from the centre a floor becomes the background, so that no horizon is seen. */
static double fade_of(const rheo__canvas *c, const double point[3])
{
    double from[3];
    for (int a = 0; a < 3; a++)
        from[a] = point[a] - c->light_centre[a];
    const double away = (rheo__view_length(from) / c->camera.size - 1) / 2.5,
                 part = away > 0 ? away < 1 ? away : 1 : 0;
    return part * part * (3 - 2 * part);
}

static view view_of(const lights *l, uint32_t column, uint32_t row)
{
    const rheo__sample *s = &l->canvas->sample[(size_t)row * l->canvas->width + column];
    double point[3], normal[3];
    place_of(l, column, row, point, normal);
    if (s->paint == RHEO__PAINT_NONE || (is_floor(s) && fade_of(l->canvas, point) >= 1))
        return (view){1, 1};
    const int phase = (int)(row / RHEO__SAMPLES % BLOCK * BLOCK + column / RHEO__SAMPLES % BLOCK);
    const bool faces = rheo__view_dot(normal, l->canvas->light) > 0;
    return (view){(float)(faces ? lit_part(l, phase, point, normal) : 0),
                  (float)open_part(l, phase, column, row, point, normal)};
}

static bool is_alike(const lights *l, const rheo__sample *a, const rheo__sample *b)
{
    const double apart = (double)a->depth - (double)b->depth, near = .1 * l->reach;
    double turn = 0;
    if (a->paint == RHEO__PAINT_NONE || b->paint == RHEO__PAINT_NONE || is_floor(a) != is_floor(b))
        return a->paint == b->paint;
    for (int k = 0; k < 3; k++)
        turn += (double)a->normal[k] * b->normal[k];
    return turn > .9 * RHEO__NORMAL * RHEO__NORMAL && ((apart < near && -apart < near) || is_floor(a));
}

/* The mean view of the pixels of a block that show the same thing as a sample. */
static view mean_view(const lights *l, uint32_t column, uint32_t row)
{
    const rheo__canvas *c = l->canvas;
    const rheo__sample *own = &c->sample[(size_t)row * c->width + column];
    const uint32_t x = column / RHEO__SAMPLES, y = row / RHEO__SAMPLES;
    float lit = 0, open = 0;
    int count = 0;
    for (uint32_t k = y; k < y + BLOCK && k < l->height; k++)
        for (uint32_t i = x; i < x + BLOCK && i < l->width; i++) {
            if (!is_alike(l, own, &c->sample[(size_t)RHEO__SAMPLES * k * c->width + RHEO__SAMPLES * i]))
                continue;
            const view *v = &l->view[(size_t)k * l->width + i];
            lit += v->lit;
            open += v->open;
            count++;
        }
    return count ? (view){lit / (float)count, open / (float)count} : view_of(l, column, row);
}

/* ---- Colours ---- */

/* The background becomes lighter downwards, where it meets the floor. */
static void background_at(const rheo__canvas *c, uint32_t row, double colour[3])
{
    static const double ABOVE[3] = {.60, .67, .77}, BELOW[3] = {.84, .87, .91};
    const double part = (double)row / c->height;
    for (int a = 0; a < 3; a++)
        colour[a] = ABOVE[a] + part * (BELOW[a] - ABOVE[a]);
}

static double positive(double x)
{
    return x > 0 ? x : 0;
}

/* x^(2^squarings) */
static double power(double x, int squarings)
{
    for (int i = 0; i < squarings; i++)
        x *= x;
    return x;
}

/* Lights one sample. */
static void light_sample(const lights *l, uint32_t column, uint32_t row, double colour[3])
{
    const rheo__canvas *c = l->canvas;
    const rheo__sample *s = &c->sample[(size_t)row * c->width + column];
    double back[3], point[3], normal[3], half[3], fade = 0;
    background_at(c, row, back);
    for (int a = 0; a < 3; a++)
        colour[a] = back[a];
    place_of(l, column, row, point, normal);
    if (s->paint == RHEO__PAINT_NONE || (is_floor(s) && (fade = fade_of(c, point)) >= 1))
        return;
    const view v = mean_view(l, column, row);
    const double open = (double)v.open, lit = (double)v.lit, sky = .5 + .5 * rheo__view_dot(normal, l->sky);
    const double diffuse = (.22 + .26 * sky) * open + .68 * positive(rheo__view_dot(normal, c->light)) * lit +
                           .26 * open * positive(rheo__view_dot(normal, l->fill));
    double shine = 0;
    if (!is_floor(s)) {
        const double length = rheo__view_length(point);
        const bool is_ball = s->paint == RHEO__PAINT_DARK || s->paint == RHEO__PAINT_PALE;
        for (int a = 0; a < 3; a++)
            half[a] = c->light[a] - point[a] / length;
        rheo__view_normalise(half);
        shine = (is_ball ? .4 : .14) * lit * power(positive(rheo__view_dot(normal, half)), is_ball ? 6 : 5);
    }
    for (int a = 0; a < 3; a++)
        colour[a] += (1 - fade) * (c->colour[s->paint][a] * diffuse + shine - back[a]);
}

/* ---- Pixels ---- */

/* The mean of a pixel's samples. Samples that show the same are lit once. */
static void light_pixel(const lights *l, uint32_t column, uint32_t row, unsigned char *pixel)
{
    enum { ALL = RHEO__SAMPLES * RHEO__SAMPLES };
    const rheo__canvas *c = l->canvas;
    const rheo__sample *sample[ALL];
    double sum[3] = {0, 0, 0};
    bool done[ALL] = {false};
    for (uint32_t s = 0; s < ALL; s++)
        sample[s] = &c->sample[(size_t)(RHEO__SAMPLES * row + s / RHEO__SAMPLES) * c->width + RHEO__SAMPLES * column +
                               s % RHEO__SAMPLES];
    for (uint32_t s = 0; s < ALL; s++) {
        double colour[3];
        int same = 1;
        if (done[s])
            continue;
        for (uint32_t other = s + 1; other < ALL; other++)
            if (!done[other] && sample[s]->paint == sample[other]->paint && is_alike(l, sample[s], sample[other])) {
                done[other] = true;
                same++;
            }
        light_sample(l, RHEO__SAMPLES * column + s % RHEO__SAMPLES, RHEO__SAMPLES * row + s / RHEO__SAMPLES, colour);
        /* A highlight must not outshine an edge. */
        for (int a = 0; a < 3; a++)
            sum[a] += same * (colour[a] > 0 ? colour[a] < 1 ? colour[a] : 1 : 0);
    }
    for (int a = 0; a < 3; a++)
        pixel[a] = (unsigned char)(255 * __builtin_sqrt(sum[a] / ALL) + .5);
}

rheo_result rheo__canvas_light(const rheo__canvas *canvas, double reach, unsigned char *rgb, rheo_error *error)
{
    static const double FILL[3] = {6, 3, 6}, SKY[3] = {0, 1, 0};
    lights l = {.canvas = canvas,
                .width = canvas->width / RHEO__SAMPLES,
                .height = canvas->height / RHEO__SAMPLES,
                .reach = reach,
                .bias = .12 * reach,
                .blur = .3 * reach};
    const size_t pixels = (size_t)l.width * l.height;
    l.view = malloc(pixels * sizeof *l.view);
    if (!l.view || !count_tiles(&l)) {
        free(l.view);
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a picture of %u x %u pixels", l.width, l.height);
    }
    rheo__canvas_light_from(canvas, FILL, l.fill);
    rheo__canvas_light_from(canvas, SKY, l.sky);
    /* A spiral in which each point turns by the golden section covers the disc evenly. */
    for (int i = 0; i < PHASES * TAPS; i++) {
        const double radius = __builtin_sqrt((i + .5) / (PHASES * TAPS)), turns = .6180339887498949 * i;
        l.tap[i % PHASES][i / PHASES][0] = radius * rheo__cos_turns(turns);
        l.tap[i % PHASES][i / PHASES][1] = radius * rheo__sin_turns(turns);
    }
    for (uint32_t row = 0; row < l.height; row++)
        for (uint32_t column = 0; column < l.width; column++)
            l.view[(size_t)row * l.width + column] = view_of(&l, RHEO__SAMPLES * column, RHEO__SAMPLES * row);
    for (uint32_t row = 0; row < l.height; row++)
        for (uint32_t column = 0; column < l.width; column++)
            light_pixel(&l, column, row, rgb + 3 * ((size_t)row * l.width + column));
    free(l.busy);
    free(l.view);
    return RHEO_OK;
}
