/* Parts of a picture besides its samples: values of particles, colours, and captions. */
#ifndef RHEO__VIEW_PICTURE_H
#define RHEO__VIEW_PICTURE_H

#include "core/error.h"
#include "core/real.h"
#include "rheolog/view.h"

/* ---- Values that are painted ---- */

typedef struct rheo__painted {
    char name[64], unit[32];         /* as in a caption; name "" if there are none */
    rheo_real *value;                /* of each particle */
    const rheo_world_def *materials; /* the values are numbers of materials; NULL: they are not */
} rheo__painted;

/* Reads what the options say: a quantity or a field, of a vector the length; or its difference between two worlds. */
rheo_result rheo__painted_read(const rheo_world *world, const rheo_picture_options *options, rheo__painted *values,
                               rheo_error *error);
void rheo__painted_release(rheo__painted *values);
/* The range that rheo_world_colour_range() describes. */
rheo_result rheo__painted_range(const rheo__painted *values, uint32_t count, double range[2], rheo_error *error);

/* Colour of the scale at a place between 0 and 1: red, green and blue in sRGB, from 0 to 1. */
void rheo__scale_colour(double place, double colour[3]);

enum { RHEO__LABELS = 1 + RHEO_MAX_MATERIALS };

/* A value of the scale, and its place between 0 and 1. */
typedef struct rheo__label {
    double place;
    char text[32];
} rheo__label;

/* The names of the materials whose numbers are in a range; returns how many. */
uint32_t rheo__material_labels(const rheo_world_def *def, const double range[2], rheo__label label[RHEO__LABELS]);
/* Chooses round values for the labels of a range, ascending; returns their number, at least 1. */
uint32_t rheo__scale_labels(const double range[2], rheo__label label[RHEO__LABELS]);

/* ---- Captions: drawn on pixels, three bytes each, row by row from the top ---- */

typedef struct rheo__sheet {
    unsigned char *rgb;
    uint32_t width, height;
} rheo__sheet;

/* Writes a line in a stroke font. (x, y): left end of the base line; `height`: that of capitals. Unit pixels. */
void rheo__sheet_text(const rheo__sheet *sheet, double x, double y, double height, const char *text);
double rheo__text_length(double height, const char *text);
/* Draws the colour scale with its name and values. */
void rheo__sheet_scale(const rheo__sheet *sheet, const rheo__painted *values, const double range[2]);
/* Writes the step and the time. */
void rheo__sheet_time(const rheo__sheet *sheet, const rheo_world *world);

#endif
