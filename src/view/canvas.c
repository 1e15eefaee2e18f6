/* Draws spheres, triangles and floors: which is the nearest thing on the ray of each sample. */
#include "view/canvas.h"

#include <stdlib.h>
#include <string.h>

#include "view/vectors.h"

/* Half the height of a picture at distance 1, as in scenes for POV-Ray. */
#define SLOPE_UP .23
/* The part of the width that is left to a colour bar. */
#define BAR_PART .13

static const double KEY[3] = {-3.5, 7, 3}; /* direction of the key light for the default camera */

rheo_result rheo__canvas_make(rheo__canvas *canvas, uint32_t width, uint32_t height, const rheo_extent *extent,
                              const rheo_camera *how, bool has_scale, rheo_error *error)
{
    rheo__canvas *c = canvas;
    *c = (rheo__canvas){.width = RHEO__SAMPLES * width, .height = RHEO__SAMPLES * height};
    const double slope_aside = SLOPE_UP * width / height, part = has_scale ? BAR_PART : 0;
    c->camera = rheo__camera_for(extent, how, slope_aside * (1 - part), SLOPE_UP);
    c->step = 2 * SLOPE_UP / c->height * c->camera.lens;
    c->left = slope_aside * (part - 1) * c->camera.lens + .5 * c->step;
    c->top = SLOPE_UP * c->camera.lens - .5 * c->step;
    const size_t samples = (size_t)c->width * c->height, cells = (size_t)RHEO__SHADOW * RHEO__SHADOW;
    c->sample = malloc(samples * sizeof *c->sample);
    c->shadow = malloc(cells * sizeof *c->shadow);
    if (!c->sample || !c->shadow) {
        rheo__canvas_release(c);
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a picture of %u x %u pixels", width, height);
    }
    const rheo__sample nothing = {.depth = __builtin_inff(), .paint = RHEO__PAINT_NONE};
    for (size_t i = 0; i < samples; i++)
        c->sample[i] = nothing;
    for (size_t i = 0; i < cells; i++)
        c->shadow[i] = __builtin_inff();
    rheo__canvas_light_from(c, KEY, c->light);
    rheo__view_cross((const double[3]){0, 0, 1}, c->light, c->light_aside);
    rheo__view_normalise(c->light_aside);
    rheo__view_cross(c->light, c->light_aside, c->light_up);
    rheo__canvas_point(c, c->camera.centre, c->light_centre);
    c->light_half = 1.05 * c->camera.size;
    return RHEO_OK;
}

void rheo__canvas_release(rheo__canvas *canvas)
{
    free(canvas->sample);
    free(canvas->shadow);
    canvas->sample = NULL;
    canvas->shadow = NULL;
}

void rheo__canvas_direction(const rheo__canvas *canvas, const double direction[3], double seen[3])
{
    seen[0] = rheo__view_dot(direction, canvas->camera.aside);
    seen[1] = rheo__view_dot(direction, canvas->camera.up);
    seen[2] = rheo__view_dot(direction, canvas->camera.forward);
}

void rheo__canvas_light_from(const rheo__canvas *canvas, const double from[3], double seen[3])
{
    const double *turn = canvas->camera.turn,
                 level = .1; /* a camera that looks up more steeply has its lights below */
    double direction[3] = {turn[0] * from[0] - turn[1] * from[2],
                           canvas->camera.forward[1] > level ? -from[1] : from[1],
                           turn[1] * from[0] + turn[0] * from[2]};
    rheo__view_normalise(direction);
    rheo__canvas_direction(canvas, direction, seen);
}

void rheo__canvas_point(const rheo__canvas *canvas, const double point[3], double seen[3])
{
    double from[3];
    for (int a = 0; a < 3; a++)
        from[a] = point[a] - canvas->camera.eye[a];
    rheo__canvas_direction(canvas, from, seen);
}

uint16_t rheo__paint_of(double value)
{
    const double shade = value * (RHEO__SHADES - 1) + .5;
    return (uint16_t)(shade > 0 ? shade < RHEO__SHADES ? (int)shade : RHEO__SHADES - 1 : 0);
}

/* ---- Ranges of samples ---- */

/* Index of the first of `count` samples that is not before `place`. */
static uint32_t first_from(double place, uint32_t count)
{
    if (!(place > 0))
        return 0;
    if (!(place < count))
        return count;
    const uint32_t whole = (uint32_t)place;
    return whole + (whole < place);
}

typedef struct region {
    uint32_t column[2], row[2]; /* from the first to before the second */
} region;

/* The samples whose rays have x and y between these. */
static region region_between(const rheo__canvas *c, const double low[2], const double high[2])
{
    return (region){
        {first_from((low[0] - c->left) / c->step, c->width), first_from((high[0] - c->left) / c->step, c->width)},
        {first_from((c->top - high[1]) / c->step, c->height), first_from((c->top - low[1]) / c->step, c->height)}};
}

static void set_sample(rheo__sample *s, double depth, const double normal[3], uint16_t paint)
{
    s->depth = (float)depth;
    for (int a = 0; a < 3; a++)
        s->normal[a] = (int16_t)(normal[a] * RHEO__NORMAL);
    s->paint = paint;
}

/* ---- Spheres ---- */

/* The least and the largest slope x/z of a sphere: those of the tangents from the eye in the plane of x and z. */
static void slopes_of(double x, double z, double radius, double *low, double *high)
{
    const double root = radius * __builtin_sqrt(x * x + z * z - radius * radius), below = z * z - radius * radius;
    *low = (x * z - root) / below;
    *high = (x * z + root) / below;
}

/* Neighbouring octants of a ball have different panels. */
static uint16_t panel_at(const rheo__ball *ball, const double normal[3])
{
    int negative = 0;
    for (int a = 0; a < 3; a++)
        negative += rheo__view_dot(ball->axis[a], normal) < 0;
    return negative % 2 ? RHEO__PAINT_DARK : RHEO__PAINT_PALE;
}

void rheo__draw_sphere(rheo__canvas *canvas, const rheo__ball *ball)
{
    const double *c = ball->centre, r = ball->radius, nearest = c[2] - r;
    if (!(nearest > 1e-6 * r)) /* the eye is in it, or it is behind the eye */
        return;
    double low[2], high[2];
    slopes_of(c[0], c[2], r, &low[0], &high[0]);
    slopes_of(c[1], c[2], r, &low[1], &high[1]);
    const region in = region_between(canvas, low, high);
    for (uint32_t row = in.row[0]; row < in.row[1]; row++) {
        rheo__sample *sample = canvas->sample + (size_t)row * canvas->width;
        for (uint32_t column = in.column[0]; column < in.column[1]; column++) {
            if (!(nearest < (double)sample[column].depth))
                continue;
            /* The point of the ray that is nearest to the centre is `away` from it. */
            double ray[3], away[3];
            rheo__canvas_ray(canvas, column, row, ray);
            const double square = ray[0] * ray[0] + ray[1] * ray[1] + 1, middle = rheo__view_dot(ray, c) / square;
            for (int a = 0; a < 3; a++)
                away[a] = middle * ray[a] - c[a];
            const double left = r * r - rheo__view_dot(away, away);
            if (!(left >= 0))
                continue;
            const double back = __builtin_sqrt(left / square), depth = middle - back;
            if (!((float)depth < sample[column].depth))
                continue;
            double normal[3];
            for (int a = 0; a < 3; a++)
                normal[a] = (away[a] - back * ray[a]) / r;
            set_sample(&sample[column], depth, normal, ball->axis ? panel_at(ball, normal) : ball->paint);
        }
    }
}

/* ---- Triangles ---- */

/*
 * A ray meets a triangle if it is on the same side of the three planes through the eye and an edge. Two triangles of
 * an edge compute that plane from the same numbers, so there is no gap between them.
 */
void rheo__draw_triangle(rheo__canvas *canvas, const double corner[3][3], const double normal[3][3],
                         const double shade[3], uint16_t paint)
{
    double plane[3][3], low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (int k = 0; k < 3; k++) {
        if (!(corner[k][2] > 0))
            return;
        rheo__view_cross(corner[(k + 1) % 3], corner[(k + 2) % 3], plane[k]);
        for (int a = 0; a < 2; a++) {
            const double slope = corner[k][a] / corner[k][2];
            low[a] = slope < low[a] ? slope : low[a];
            high[a] = slope > high[a] ? slope : high[a];
        }
    }
    const double volume = rheo__view_dot(corner[0], plane[0]);
    if (!(volume > 0)) /* seen from behind */
        return;
    /* Rounding may move the bounds, so that a margin is needed. */
    const double margin = 1e-6 * canvas->step;
    for (int a = 0; a < 2; a++) {
        low[a] -= margin;
        high[a] += margin;
    }
    const region in = region_between(canvas, low, high);
    for (uint32_t row = in.row[0]; row < in.row[1]; row++) {
        rheo__sample *sample = canvas->sample + (size_t)row * canvas->width;
        for (uint32_t column = in.column[0]; column < in.column[1]; column++) {
            double ray[3], part[3], mean[3] = {0, 0, 0}, value = 0;
            rheo__canvas_ray(canvas, column, row, ray);
            for (int k = 0; k < 3; k++)
                part[k] = rheo__view_dot(ray, plane[k]);
            if (!(part[0] >= 0 && part[1] >= 0 && part[2] >= 0))
                continue;
            const double sum = part[0] + part[1] + part[2], depth = volume / sum;
            if (!(sum > 0) || !((float)depth < sample[column].depth))
                continue;
            for (int k = 0; k < 3; k++) {
                for (int a = 0; a < 3; a++)
                    mean[a] += part[k] * normal[k][a];
                value += shade ? part[k] * shade[k] : 0;
            }
            const double length = rheo__view_length(mean);
            for (int a = 0; a < 3; a++)
                mean[a] = length > 0 ? mean[a] / length : a == 2 ? -1 : 0;
            set_sample(&sample[column], depth, mean, shade ? rheo__paint_of(value / sum) : paint);
        }
    }
}

/* ---- Floors ---- */

enum { MOST_LINES = 1 << 20 }; /* above and below height 0 */

/* A tilted floor has lines of equal height, as on a map; a level one has none. */
void rheo__draw_floor(rheo__canvas *canvas, const double normal[3], double offset)
{
    const rheo__camera *camera = &canvas->camera;
    const bool is_level = normal[0] == 0 && normal[2] == 0;
    const double above = rheo__view_dot(normal, camera->eye) - offset, apart = .2 * camera->size;
    double seen[3];
    rheo__canvas_direction(canvas, normal, seen);
    if (!(above > 0)) /* the eye is below it */
        return;
    for (uint32_t row = 0; row < canvas->height; row++) {
        rheo__sample *sample = canvas->sample + (size_t)row * canvas->width;
        for (uint32_t column = 0; column < canvas->width; column++) {
            double ray[3];
            rheo__canvas_ray(canvas, column, row, ray);
            const double down = -rheo__view_dot(seen, ray), depth = above / down;
            if (!(down > 0) || !((float)depth < sample[column].depth))
                continue;
            const double rise = ray[0] * camera->aside[1] + ray[1] * camera->up[1] + camera->forward[1],
                         lines = (camera->eye[1] + depth * rise) / apart + MOST_LINES;
            const bool is_line = !is_level && lines > 0 && lines < 2 * MOST_LINES && lines - (int)lines > .93;
            set_sample(&sample[column], depth, seen, is_line ? RHEO__PAINT_LINE : RHEO__PAINT_FLOOR);
        }
    }
}
