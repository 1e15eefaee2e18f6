/* Exports a world to a file, and writes collections of VTP files. */
#include <string.h>

#include "view/output.h"

static const char *const names[] = {
    [RHEO_EXPORT_VTP] = "vtp",      [RHEO_EXPORT_PLY] = "ply", [RHEO_EXPORT_OBJ] = "obj",
    [RHEO_EXPORT_POV] = "pov",      [RHEO_EXPORT_CSV] = "csv", [RHEO_EXPORT_SPRINGS] = "springs",
    [RHEO_EXPORT_SOLIDS] = "solids"};

enum { FORMATS = sizeof names / sizeof names[0] };

const char *rheo_export_format_name(uint32_t format)
{
    return format < FORMATS ? names[format] : NULL;
}

const char *rheo_export_format_ending(uint32_t format)
{
    return rheo_export_format_name(format == RHEO_EXPORT_SPRINGS || format == RHEO_EXPORT_SOLIDS ? RHEO_EXPORT_VTP
                                                                                                 : format);
}

bool rheo_export_has_surface(rheo_export_format format)
{
    return format == RHEO_EXPORT_PLY || format == RHEO_EXPORT_OBJ || format == RHEO_EXPORT_POV;
}

static rheo_result export_surface(const rheo_world *world, rheo_export_format format, const char *path,
                                  const rheo_export_options *options, rheo_exported *exported, rheo_error *error)
{
    rheo_surface s;
    rheo__output out;
    RHEO__TRY(rheo_world_surface(world, &options->surface, NULL, &s, error));
    const rheo_extent extent = options->extent ? *options->extent : rheo_world_extent(world);
    rheo_result result = rheo__output_open(&out, path, options->force, error);
    if (result == RHEO_OK) {
        if (format == RHEO_EXPORT_PLY)
            rheo__write_ply(&out, &s, &extent);
        else if (format == RHEO_EXPORT_OBJ)
            rheo__write_obj(&out, &s);
        else
            rheo__write_pov(&out, world, &s, &extent);
        result = rheo__output_close(&out, RHEO_OK, error);
    }
    *exported = (rheo_exported){.vertices = s.vertices, .triangles = s.triangles, .left_out = s.left_out};
    rheo_surface_release(&s);
    return result;
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
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no export format %d; they are 0 (vtp) to %d (solids)",
                          (int)format, FORMATS - 1);
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
