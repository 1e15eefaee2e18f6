/* Exports a world to a file, and writes collections of VTP files. */
#include <string.h>

#include "view/output.h"
#include "view/picture.h"

static const char *const names[] = {
    [RHEO_EXPORT_VTP] = "vtp",       [RHEO_EXPORT_PLY] = "ply",        [RHEO_EXPORT_OBJ] = "obj",
    [RHEO_EXPORT_POV] = "pov",       [RHEO_EXPORT_CSV] = "csv",        [RHEO_EXPORT_SPRINGS] = "springs",
    [RHEO_EXPORT_SOLIDS] = "solids", [RHEO_EXPORT_SURFACE] = "surface"};

enum { FORMATS = sizeof names / sizeof names[0] };

const char *rheo_export_format_name(uint32_t format)
{
    return format < FORMATS ? names[format] : NULL;
}

const char *rheo_export_format_ending(uint32_t format)
{
    const bool is_vtp =
        format == RHEO_EXPORT_SPRINGS || format == RHEO_EXPORT_SOLIDS || format == RHEO_EXPORT_SURFACE;
    return rheo_export_format_name(is_vtp ? RHEO_EXPORT_VTP : format);
}

bool rheo_export_has_surface(rheo_export_format format)
{
    return format == RHEO_EXPORT_PLY || format == RHEO_EXPORT_OBJ || format == RHEO_EXPORT_POV ||
           format == RHEO_EXPORT_SURFACE;
}

static bool has_temperatures(const rheo_world *world)
{
    rheo_field_info info;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, "temperature") == 0)
            return true;
    return false;
}

/* Makes the surface with the values that the options name, turned as the file needs it, and their colours. */
static rheo_result make_surface(const rheo_world *world, const rheo_export_options *options,
                                const rheo_extent *extent, rheo_surface *surface, rheo__colours *colours,
                                rheo_error *error)
{
    const bool is_heat = !options->colour && has_temperatures(world);
    const rheo_picture_options painted = {.colour = is_heat           ? "temperature"
                                                    : options->colour ? options->colour
                                                                      : "none"};
    rheo__painted values;
    *colours =
        (rheo__colours){.name = painted.colour, .range = {extent->coldest, extent->hottest}, .is_heat = is_heat};
    RHEO__TRY(rheo__painted_read(world, &painted, &values, error));
    rheo_result result = RHEO_OK;
    if (options->range)
        memcpy(colours->range, options->range, sizeof colours->range);
    else if (!is_heat)
        result = rheo__painted_range(&values, rheo_world_particle_count(world), colours->range, error);
    if (result == RHEO_OK)
        result = rheo__world_surface(world, &options->surface, values.value, surface, error);
    rheo__painted_release(&values);
    return result;
}

static void turn_floats(const rheo__output *out, float *vector, size_t count)
{
    for (size_t i = 0; i < count; i++, vector += 3) {
        double turned[3] = {(double)vector[0], (double)vector[1], (double)vector[2]};
        rheo__output_turn(out, turned);
        for (int a = 0; a < 3; a++)
            vector[a] = (float)turned[a];
    }
}

static rheo_result export_surface(const rheo_world *world, rheo_export_format format, const char *path,
                                  const rheo_export_options *options, rheo_exported *exported, rheo_error *error)
{
    rheo_surface s = {0};
    rheo__output out;
    rheo__colours colours;
    const rheo_extent extent = options->extent ? *options->extent : rheo_world_extent(world);
    RHEO__TRY(make_surface(world, options, &extent, &s, &colours, error));
    rheo_result result = rheo__output_open(&out, path, options->force, error);
    if (result == RHEO_OK) {
        out.z_up = options->z_up;
        turn_floats(&out, s.position, s.vertices);
        turn_floats(&out, s.normal, s.vertices);
        if (format == RHEO_EXPORT_PLY)
            rheo__write_ply(&out, &s, &colours);
        else if (format == RHEO_EXPORT_OBJ)
            rheo__write_obj(&out, &s, options->colour ? &colours : NULL);
        else if (format == RHEO_EXPORT_SURFACE)
            rheo__write_surface(&out, world, &s, &colours);
        else
            rheo__write_pov(&out, world, &s, &extent, &colours);
        result = rheo__output_close(&out, RHEO_OK, error);
    }
    *exported = (rheo_exported){.vertices = s.vertices, .triangles = s.triangles, .left_out = s.left_out};
    rheo_surface_release(&s);
    return result;
}

/* Turns all columns of vectors. */
static void turn_columns(const rheo__output *out, const rheo__columns *columns)
{
    for (uint32_t i = 0; i < columns->count; i++) {
        const rheo__column *c = &columns->column[i];
        rheo_real *vector = c->values;
        if (c->info.components != 3)
            continue;
        for (uint64_t k = 0; k < c->info.items; k++, vector += 3) {
            double turned[3] = {(double)vector[0], (double)vector[1], (double)vector[2]};
            rheo__output_turn(out, turned);
            for (int a = 0; a < 3; a++)
                vector[a] = (rheo_real)turned[a];
        }
    }
}

static rheo_result export_particles(const rheo_world *world, rheo_export_format format, const char *path,
                                    const rheo_export_options *options, rheo_exported *exported, rheo_error *error)
{
    rheo__columns columns;
    rheo__output out;
    RHEO__TRY(rheo__columns_read(world, &columns, error));
    RHEO__TRY(rheo__columns_read_quantities(world, &columns, error));
    rheo_result result = rheo__output_open(&out, path, options->force, error);
    if (result == RHEO_OK) {
        out.z_up = options->z_up;
        turn_columns(&out, &columns);
        if (format == RHEO_EXPORT_VTP)
            rheo__write_vtp(&out, world, &columns);
        else
            rheo__write_csv(&out, world, &columns);
        result = rheo__output_close(&out, RHEO_OK, error);
    }
    *exported = (rheo_exported){.particles = rheo_world_particle_count(world)};
    rheo__columns_release(&columns);
    return result;
}

/* Springs or solids. */
static rheo_result export_others(const rheo_world *world, rheo_export_format format, const char *path,
                                 const rheo_export_options *options, rheo_error *error)
{
    rheo__output out;
    rheo_result result = rheo__output_open(&out, path, options->force, error);
    if (result != RHEO_OK)
        return result;
    out.z_up = options->z_up;
    if (format == RHEO_EXPORT_SPRINGS) {
        result = rheo__write_springs(&out, world, error);
    } else {
        const rheo_extent extent = options->extent ? *options->extent : rheo_world_extent(world);
        rheo__write_solids(&out, world, &extent);
    }
    return rheo__output_close(&out, result, error);
}

rheo_result rheo_world_export(const rheo_world *world, rheo_export_format format, const char *path,
                              const rheo_export_options *options, rheo_exported *exported, rheo_error *error)
{
    rheo_exported ignored;
    exported = exported ? exported : &ignored;
    *exported = (rheo_exported){0};
    if ((uint32_t)format >= FORMATS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no export format %d; they are 0 (vtp) to %d (%s)",
                          (int)format, FORMATS - 1, names[FORMATS - 1]);
    const double *range = options->range;
    if (range && !(range[0] <= range[1] && range[0] >= -1e30 && range[1] <= 1e30))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the range of colours must ascend and be within 1e30");
    if (format == RHEO_EXPORT_SPRINGS || format == RHEO_EXPORT_SOLIDS)
        return export_others(world, format, path, options, error);
    return rheo_export_has_surface(format) ? export_surface(world, format, path, options, exported, error)
                                           : export_particles(world, format, path, options, exported, error);
}

rheo_result rheo_export_bytes(const char *path, const void *bytes, size_t size, bool force, rheo_error *error)
{
    rheo__output out;
    RHEO__TRY(rheo__output_open(&out, path, force, error));
    rheo__output_bytes(&out, bytes, size);
    return rheo__output_close(&out, RHEO_OK, error);
}

/* Escapes a text for an XML attribute. */
static void put_attribute(rheo__output *out, const char *text)
{
    for (; *text; text++) {
        if (*text == '&' || *text == '"' || *text == '<')
            rheo__output_text(out, *text == '&' ? "&amp;" : *text == '"' ? "&quot;" : "&lt;");
        else
            rheo__output_bytes(out, text, 1);
    }
}

rheo_result rheo_export_collection(const char *path, size_t count, const char *const *files, const double *times,
                                   bool force, rheo_error *error)
{
    rheo__output out;
    RHEO__TRY(rheo__output_open(&out, path, force, error));
    rheo__output_text(&out, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
                            "byte_order=\"LittleEndian\">\n<Collection>\n");
    for (size_t i = 0; i < count; i++) {
        rheo__output_text(&out, "<DataSet timestep=\"");
        rheo__output_double(&out, times[i]);
        rheo__output_text(&out, "\" part=\"0\" file=\"");
        put_attribute(&out, files[i]);
        rheo__output_text(&out, "\"/>\n");
    }
    rheo__output_text(&out, "</Collection>\n</VTKFile>\n");
    return rheo__output_close(&out, RHEO_OK, error);
}
