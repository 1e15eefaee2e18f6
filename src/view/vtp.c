/* Writes the frame of VTP files (view/vtp.h). */
#include "view/vtp.h"

static const char *const vtk_type[] = {[RHEO_ELEMENT_F32] = "Float32",
                                       [RHEO_ELEMENT_F64] = "Float64",
                                       [RHEO_ELEMENT_U32] = "UInt32",
                                       [RHEO_ELEMENT_U64] = "UInt64"};

rheo__vtp rheo__vtp_begin(rheo__output *out, const rheo_world *world, uint32_t points, uint32_t vertices,
                          size_t lines, uint32_t polygons)
{
    rheo__output_text(out, "<?xml version=\"1.0\"?>\n"
                           "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                           "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n"
                           "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">");
    rheo__output_double(out, rheo_world_time(world));
    rheo__output_format(out,
                        "</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"%u\" NumberOfVerts=\"%u\" "
                        "NumberOfLines=\"%llu\" NumberOfStrips=\"0\" NumberOfPolys=\"%u\">\n",
                        points, vertices, (unsigned long long)lines, polygons);
    return (rheo__vtp){out, 0};
}

void rheo__vtp_open(const rheo__vtp *vtp, const char *element, const char *attributes)
{
    rheo__output_format(vtp->out, "<%s%s>\n", element, attributes);
}

void rheo__vtp_close(const rheo__vtp *vtp, const char *element)
{
    rheo__output_format(vtp->out, "</%s>\n", element);
}

static void declare(rheo__vtp *vtp, const char *type, const char *name, uint32_t components, uint64_t bytes)
{
    rheo__output_format(
        vtp->out,
        "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" format=\"appended\" offset=\"%llu\"/>\n", type,
        name, components, (unsigned long long)vtp->offset);
    vtp->offset += sizeof(uint64_t) + bytes;
}

void rheo__vtp_declare(rheo__vtp *vtp, rheo_element element, const char *name, uint32_t components, uint64_t bytes)
{
    declare(vtp, vtk_type[element], name, components, bytes);
}

void rheo__vtp_declare_cells(rheo__vtp *vtp, const char *element, uint64_t points, uint64_t cells)
{
    rheo__vtp_open(vtp, element, "");
    declare(vtp, "Int64", "connectivity", 1, points * 8);
    declare(vtp, "Int64", "offsets", 1, cells * 8);
    rheo__vtp_close(vtp, element);
}

void rheo__vtp_begin_values(const rheo__vtp *vtp)
{
    rheo__output_text(vtp->out, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
}

void rheo__vtp_begin_array(const rheo__vtp *vtp, uint64_t bytes)
{
    rheo__output_little(vtp->out, bytes, sizeof(uint64_t));
}

void rheo__vtp_progression(const rheo__vtp *vtp, uint64_t first, uint64_t each, uint64_t count, size_t bytes)
{
    rheo__vtp_begin_array(vtp, count * bytes);
    for (uint64_t i = 0; i < count; i++)
        rheo__output_little(vtp->out, first + i * each, bytes);
}

void rheo__vtp_end(const rheo__vtp *vtp)
{
    rheo__output_text(vtp->out, "\n</AppendedData>\n</VTKFile>\n");
}
