/* What the files of a world are made from, and how they are written (internal). */
#ifndef RHEO__VIEW_LOOK_H
#define RHEO__VIEW_LOOK_H

#include <stdio.h>

#include "core/error.h"
#include "rheolog/view.h"

/* ---- A file that is being written, beside its place ---- */

enum { RHEO__OUTPUT_BUFFER = 1 << 16 };

typedef struct rheo__output {
    FILE *file;
    const char *path;
    char *name; /* that it has until it is whole */
    size_t used;
    int trouble; /* errno of the first write that failed */
    unsigned char buffer[RHEO__OUTPUT_BUFFER];
} rheo__output;

rheo_result rheo__output_open(rheo__output *out, const char *path, bool force, rheo_error *error);
/* Puts the file in its place, or takes it away if `result` is not RHEO_OK or writing has failed. */
rheo_result rheo__output_close(rheo__output *out, rheo_result result, rheo_error *error);

void rheo__output_bytes(rheo__output *out, const void *bytes, size_t size);
void rheo__output_text(rheo__output *out, const char *text);
/* Text with numbers that are whole: %g would take its point from the locale. */
void rheo__output_format(rheo__output *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Numbers that read back to the same bits. */
void rheo__output_float(rheo__output *out, float value);
void rheo__output_double(rheo__output *out, double value);
/* `count` numbers with `between` after each but the last. */
void rheo__output_floats(rheo__output *out, const float *value, int count, const char *between);
void rheo__output_doubles(rheo__output *out, const double *value, int count, const char *between);
/* Little-endian, on any machine. */
void rheo__output_little(rheo__output *out, uint64_t value, size_t bytes);
void rheo__output_little_float(rheo__output *out, float value);

/* ---- Fields of particles ---- */

/* A flat field that particles have, by id. */
typedef struct rheo__column {
    rheo_field_info info;
    void *values;
} rheo__column;

enum { RHEO__MAX_COLUMNS = 32 };

typedef struct rheo__columns {
    uint32_t count;
    rheo__column column[RHEO__MAX_COLUMNS]; /* position and velocity first, then in the order of the fields */
} rheo__columns;

rheo_result rheo__columns_read(const rheo_world *world, rheo__columns *columns, rheo_error *error);
void rheo__columns_release(rheo__columns *columns);
/* A field of one rheo_real a particle; NULL if the world does not have it. */
const rheo_real *rheo__columns_reals(const rheo__columns *columns, const char *name);
size_t rheo__column_element_size(const rheo__column *column);

/* The colour of a temperature, each part 0..1 in sRGB. */
void rheo__temperature_colour(double temperature, const rheo_extent *extent, double colour[3]);

/* ---- Formats ---- */

void rheo__write_vtp(rheo__output *out, const rheo_world *world, const rheo__columns *columns);
void rheo__write_csv(rheo__output *out, const rheo_world *world, const rheo__columns *columns);
void rheo__write_ply(rheo__output *out, const rheo_surface *surface, const rheo_extent *extent);
void rheo__write_obj(rheo__output *out, const rheo_surface *surface);
void rheo__write_pov(rheo__output *out, const rheo_world *world, const rheo_surface *surface,
                     const rheo_extent *extent);

#endif
