/* Shared by the writers of files: output, columns of particles, and formats. */
#ifndef RHEO__VIEW_OUTPUT_H
#define RHEO__VIEW_OUTPUT_H

#include <stdio.h>

#include "core/error.h"
#include "rheolog/view.h"

/* ---- Output: a file, which has a temporary name in its final folder until it is complete, or memory ---- */

enum { RHEO__OUTPUT_BUFFER = 1 << 16 };

typedef struct rheo__output {
    FILE *file; /* NULL: to memory */
    char *memory;
    size_t size, room; /* of memory */
    const char *path;
    char *target, *name; /* where `path` leads to, and the temporary name until the file is complete */
    size_t used;
    bool z_up;   /* vectors are turned (rheo__output_turn()); false until a writer sets it */
    int trouble; /* errno of the first write that failed */
    unsigned char buffer[RHEO__OUTPUT_BUFFER];
} rheo__output;

rheo_result rheo__output_open(rheo__output *out, const char *path, bool force, rheo_error *error);
/* Turns a vector of the world as the file needs it: (x, y, z) becomes (x, -z, y) in a file with z up. */
static inline void rheo__output_turn(const rheo__output *out, double v[3])
{
    const double z = out->z_up ? v[1] : v[2];
    v[1] = out->z_up ? 0 - v[2] : v[1]; /* not -0 */
    v[2] = z;
}
/* Renames the file to its path; removes it if `result` is not RHEO_OK or a write failed. */
rheo_result rheo__output_close(rheo__output *out, rheo_result result, rheo_error *error);

void rheo__output_open_memory(rheo__output *out);
/* Hands over the bytes, with a 0 behind them. Release *bytes with free(). RHEO_ERROR_MEMORY: *bytes is NULL. */
rheo_result rheo__output_close_memory(rheo__output *out, char **bytes, size_t *size, rheo_error *error);

void rheo__output_bytes(rheo__output *out, const void *bytes, size_t size);
void rheo__output_text(rheo__output *out, const char *text);
/* Use it only for integers and text, because %g depends on the locale. */
void rheo__output_format(rheo__output *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Writes the fewest digits, 15 to 17 (float: 7 to 9), that read back to the same bits. */
void rheo__output_float(rheo__output *out, float value);
void rheo__output_double(rheo__output *out, double value);
/* Writes `count` numbers, separated by `between`. */
void rheo__output_floats(rheo__output *out, const float *value, int count, const char *between);
void rheo__output_doubles(rheo__output *out, const double *value, int count, const char *between);
/* Writes little-endian bytes. */
void rheo__output_little(rheo__output *out, uint64_t value, size_t bytes);
void rheo__output_little_float(rheo__output *out, float value);

/* ---- Columns of particles ---- */

/* A field or a quantity: a row of values per particle, in the order of ids. */
typedef struct rheo__column {
    rheo_field_info info;
    void *values;
} rheo__column;

enum { RHEO__MAX_COLUMNS = 32 };

typedef struct rheo__columns {
    uint32_t count;
    rheo__column column[RHEO__MAX_COLUMNS]; /* position, velocity, then the other fields in the order of the world */
} rheo__columns;

rheo_result rheo__columns_read(const rheo_world *world, rheo__columns *columns, rheo_error *error);
/* Adds the quantities of the model that are no fields, as rheo_real. After an error, all columns are released. */
rheo_result rheo__columns_read_quantities(const rheo_world *world, rheo__columns *columns, rheo_error *error);
void rheo__columns_release(rheo__columns *columns);
/* Values of a field with one rheo_real per particle; NULL if the world does not have it. */
const rheo_real *rheo__columns_reals(const rheo__columns *columns, const char *name);
size_t rheo__column_element_size(const rheo__column *column);

/* Makes the surface of a world with values of its particles instead of temperatures; NULL: none. */
rheo_result rheo__world_surface(const rheo_world *world, const rheo_surface_options *options, const rheo_real *value,
                                rheo_surface *surface, rheo_error *error);

/* What the vertices of a surface have. */
typedef struct rheo__colours {
    const char *name; /* of their values */
    double range[2];  /* values with the first and the last colour */
    bool is_heat;     /* painted from blue to red; else with the scale of pictures */
} rheo__colours;

/* Colour of a value: red, green and blue in sRGB, from 0 to 1. */
void rheo__colour_of(const rheo__colours *colours, double value, double rgb[3]);

/* ---- Formats ---- */

void rheo__write_vtp(rheo__output *out, const rheo_world *world, const rheo__columns *columns);
void rheo__write_csv(rheo__output *out, const rheo_world *world, const rheo__columns *columns);
/* Fails before it writes anything. */
rheo_result rheo__write_springs(rheo__output *out, const rheo_world *world, rheo_error *error);
void rheo__write_solids(rheo__output *out, const rheo_world *world, const rheo_extent *extent);
/* Surfaces, whose vectors are as the file needs them. Colours count for surfaces with values; of OBJ NULL: none. */
void rheo__write_ply(rheo__output *out, const rheo_surface *surface, const rheo__colours *colours);
void rheo__write_obj(rheo__output *out, const rheo_surface *surface, const rheo__colours *colours);
void rheo__write_surface(rheo__output *out, const rheo_world *world, const rheo_surface *surface,
                         const rheo__colours *colours);
void rheo__write_pov(rheo__output *out, const rheo_world *world, const rheo_surface *surface,
                     const rheo_extent *extent, const rheo__colours *colours);

#endif
