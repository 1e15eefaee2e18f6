/* What the files of a world are made from, and how they are written (internal). */
#ifndef RHEO_VIEW_LOOK_H
#define RHEO_VIEW_LOOK_H

#include <stdio.h>

#include "core/error.h"
#include "rheolog/view.h"

/* ---- A file that is being written, beside its place ---- */

enum { RHEO_OUTPUT_BUFFER = 1 << 16 };

typedef struct rheo_output {
    FILE *file;
    const char *path;
    char *name; /* that it has until it is whole */
    size_t used;
    int trouble; /* errno of the first write that failed */
    unsigned char buffer[RHEO_OUTPUT_BUFFER];
} rheo_output;

rheo_result rheo_output_open(rheo_output *out, const char *path, bool force, rheo_error *error);
/* Puts the file in its place, or takes it away if `result` is not RHEO_OK or writing has failed. */
rheo_result rheo_output_close(rheo_output *out, rheo_result result, rheo_error *error);

void rheo_output_bytes(rheo_output *out, const void *bytes, size_t size);
void rheo_output_text(rheo_output *out, const char *text);
/* Text with numbers that are whole: %g would take its point from the locale. */
void rheo_output_format(rheo_output *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Numbers that read back to the same bits. */
void rheo_output_float(rheo_output *out, float value);
void rheo_output_double(rheo_output *out, double value);
/* `count` numbers with `between` after each but the last. */
void rheo_output_floats(rheo_output *out, const float *value, int count, const char *between);
void rheo_output_doubles(rheo_output *out, const double *value, int count, const char *between);
/* Little-endian, on any machine. */
void rheo_output_little(rheo_output *out, uint64_t value, size_t bytes);
void rheo_output_little_float(rheo_output *out, float value);

/* ---- Fields of particles ---- */

/* A flat field that particles have, by id. */
typedef struct rheo_column {
    rheo_field_info info;
    void *values;
} rheo_column;

enum { RHEO_MOST_COLUMNS = 32 };

typedef struct rheo_columns {
    uint32_t count;
    rheo_column column[RHEO_MOST_COLUMNS]; /* position and velocity first, then in the order of the fields */
} rheo_columns;

rheo_result rheo_columns_read(const rheo_world *world, rheo_columns *columns, rheo_error *error);
void rheo_columns_release(rheo_columns *columns);
/* A field of one rheo_real a particle; NULL if the world does not have it. */
const rheo_real *rheo_columns_reals(const rheo_columns *columns, const char *name);
size_t rheo_column_element_size(const rheo_column *column);

/* The colour of a temperature, each part 0..1 in sRGB. */
void rheo_temperature_colour(double temperature, const rheo_extent *extent, double colour[3]);

/* ---- Formats ---- */

void rheo_write_vtp(rheo_output *out, const rheo_world *world, const rheo_columns *columns);
void rheo_write_csv(rheo_output *out, const rheo_world *world, const rheo_columns *columns);
void rheo_write_ply(rheo_output *out, const rheo_surface *surface, const rheo_extent *extent);
void rheo_write_obj(rheo_output *out, const rheo_surface *surface);
void rheo_write_pov(rheo_output *out, const rheo_world *world, const rheo_surface *surface,
                    const rheo_extent *extent);

#endif
