/*
 * A picture in the making: samples, two by two in each pixel, with the nearest thing that each shows. Lengths are in the
 * frame of the camera: x to the right, y up, z away from the eye. The ray of a sample is (x, y, 1).
 */
#ifndef RHEO__VIEW_CANVAS_H
#define RHEO__VIEW_CANVAS_H

#include "core/error.h"
#include "view/camera.h"

enum {
    RHEO__SAMPLES = 2,    /* of a pixel, in each direction */
    RHEO__SHADES = 256,   /* colours of the scale, the first paints */
    RHEO__NORMAL = 32767, /* a stored component of 1 */
};

/* Paints: the colours of the scale, and these. */
typedef enum rheo__paint {
    RHEO__PAINT_PLAIN = RHEO__SHADES, /* the fluid without a scale */
    RHEO__PAINT_DARK,                 /* panels of a ball */
    RHEO__PAINT_PALE,
    RHEO__PAINT_FLOOR,
    RHEO__PAINT_LINE, /* lines of equal height on a tilted floor */
    RHEO__PAINT_VIBRATOR,
    RHEO__PAINT_SOLID, /* obstacles */
    RHEO__PAINT_NONE,  /* the background */
    RHEO__PAINTS
} rheo__paint;

typedef struct rheo__sample {
    float depth; /* z; infinite for the background */
    int16_t normal[3];
    uint16_t paint;
} rheo__sample;

typedef struct rheo__canvas {
    rheo__camera camera;
    uint32_t width, height;         /* in samples */
    double left, top, step;         /* ray of the sample (i, k): x = left + step i, y = top - step k */
    rheo__sample *sample;           /* row by row from the top */
    double colour[RHEO__PAINTS][3]; /* linear red, green and blue */
    /* The key light: its direction, and the depth of what it meets first, seen from it. */
    double light[3], light_aside[3], light_up[3]; /* in the frame of the camera */
    double light_centre[3], light_half;           /* the shadows are those in a square of this half width */
    float *shadow;
} rheo__canvas;

enum { RHEO__SHADOW = 1024 }; /* cells along each side of the square */

/* Allocates the samples and shadows of a picture and places its camera; NULL: the default one. */
rheo_result rheo__canvas_make(rheo__canvas *canvas, uint32_t width, uint32_t height, const rheo_extent *extent,
                              const rheo_camera *how, bool has_scale, rheo_error *error);
void rheo__canvas_release(rheo__canvas *canvas);

/* A point or, without the eye, a direction of the world in the frame of the camera. */
void rheo__canvas_point(const rheo__canvas *canvas, const double point[3], double seen[3]);
void rheo__canvas_direction(const rheo__canvas *canvas, const double direction[3], double seen[3]);
/*
 * The direction of a light that moves around with the camera; `from`: where it is for the default camera. If the camera looks
 * up, it is below.
 */
void rheo__canvas_light_from(const rheo__canvas *canvas, const double from[3], double seen[3]);
/* The ray of a sample. */
static inline void rheo__canvas_ray(const rheo__canvas *canvas, uint32_t column, uint32_t row, double ray[3])
{
    ray[0] = canvas->left + canvas->step * column;
    ray[1] = canvas->top - canvas->step * row;
    ray[2] = 1;
}

/* ---- Things, nearest first: of two at the same depth the one that was drawn first is seen ---- */

/* A sphere with its centre in the frame of the camera. */
typedef struct rheo__ball {
    double centre[3], radius;
    uint16_t paint;
    const double (*axis)[3]; /* of a ball with panels: its own axes in the frame of the camera; else NULL */
} rheo__ball;

void rheo__draw_sphere(rheo__canvas *canvas, const rheo__ball *ball);
/* A triangle that is seen from the side on which its corners are anticlockwise. shade: NULL: it has the paint. */
void rheo__draw_triangle(rheo__canvas *canvas, const double corner[3][3], const double normal[3][3],
                         const double shade[3], uint16_t paint);
/* The plane normal * x = offset in the frame of the world. */
void rheo__draw_floor(rheo__canvas *canvas, const double normal[3], double offset);
/* A value between 0 and 1 as a paint of the scale. */
uint16_t rheo__paint_of(double value);

/* ---- Shadows ---- */

void rheo__shade_sphere(rheo__canvas *canvas, const double centre[3], double radius);
void rheo__shade_triangle(rheo__canvas *canvas, const double corner[3][3]);

/* ---- Light, and pixels ---- */

/* Lights the samples and writes the pixels. `reach`: the distance that crevices are dark within. Unit L. */
rheo_result rheo__canvas_light(const rheo__canvas *canvas, double reach, unsigned char *rgb, rheo_error *error);

#endif
