/*
 * Writes particles as VTP (VTK XML PolyData with raw appended arrays, for ParaView) and as CSV. Both contain ids,
 * positions, velocities, all other fields of particles, and the quantities of the model.
 */
#include <string.h>

#include "view/output.h"

static uint32_t bits32(const rheo__column *c, size_t index)
{
    uint32_t bits;
    memcpy(&bits, (const char *)c->values + index * sizeof bits, sizeof bits);
    return bits;
}

static uint64_t bits64(const rheo__column *c, size_t index)
{
    uint64_t bits;
    memcpy(&bits, (const char *)c->values + index * sizeof bits, sizeof bits);
    return bits;
}

/* ---- VTP ---- */

static const char *const vtk_type[] = {[RHEO_ELEMENT_F32] = "Float32",
                                       [RHEO_ELEMENT_F64] = "Float64",
                                       [RHEO_ELEMENT_U32] = "UInt32",
                                       [RHEO_ELEMENT_U64] = "UInt64"};

/* Declares an appended array; in the data each array is preceded by its size. */
static void put_array(rheo__output *out, const char *type, const char *name, uint32_t components, uint64_t bytes,
                      uint64_t *offset)
{
    rheo__output_format(
        out, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" format=\"appended\" offset=\"%llu\"/>\n",
        type, name, components, (unsigned long long)*offset);
    *offset += sizeof(uint64_t) + bytes;
}

static void put_column_head(rheo__output *out, const rheo__column *c, uint64_t *offset)
{
    put_array(out, vtk_type[c->info.element], c->info.name, c->info.components, c->info.bytes, offset);
}

static void put_column(rheo__output *out, const rheo__column *c)
{
    const size_t size = rheo__column_element_size(c), count = (size_t)c->info.bytes / size;
    rheo__output_little(out, c->info.bytes, sizeof(uint64_t));
    for (size_t i = 0; i < count; i++)
        rheo__output_little(out, size == 4 ? bits32(c, i) : bits64(c, i), size);
}

static void put_counting(rheo__output *out, uint32_t first, uint32_t count, size_t bytes)
{
    rheo__output_little(out, (uint64_t)count * bytes, sizeof(uint64_t));
    for (uint32_t i = 0; i < count; i++)
        rheo__output_little(out, (uint64_t)first + i, bytes);
}

void rheo__write_vtp(rheo__output *out, const rheo_world *world, const rheo__columns *columns)
{
    const uint32_t count = rheo_world_particle_count(world);
    const rheo__column *position = &columns->column[0];
    uint64_t offset = 0;
    rheo__output_text(out, "<?xml version=\"1.0\"?>\n"
                           "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                           "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n"
                           "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">");
    rheo__output_double(out, rheo_world_time(world));
    rheo__output_format(
        out,
        "</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"%u\" NumberOfVerts=\"%u\" NumberOfLines=\"0\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData Vectors=\"velocity\">\n",
        count, count);
    put_array(out, "UInt32", "id", 1, (uint64_t)count * 4, &offset);
    for (uint32_t i = 1; i < columns->count; i++)
        put_column_head(out, &columns->column[i], &offset);
    rheo__output_text(out, "</PointData>\n<Points>\n");
    put_column_head(out, position, &offset);
    rheo__output_text(out, "</Points>\n<Verts>\n");
    put_array(out, "Int64", "connectivity", 1, (uint64_t)count * 8, &offset);
    put_array(out, "Int64", "offsets", 1, (uint64_t)count * 8, &offset);
    rheo__output_text(out, "</Verts>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
    put_counting(out, 0, count, 4);
    for (uint32_t i = 1; i < columns->count; i++)
        put_column(out, &columns->column[i]);
    put_column(out, position);
    put_counting(out, 0, count, 8);
    put_counting(out, 1, count, 8);
    rheo__output_text(out, "\n</AppendedData>\n</VTKFile>\n");
}

/* ---- CSV ---- */

static void put_names(rheo__output *out, const rheo__column *c)
{
    static const char *const axis[] = {"x", "y", "z"};
    const bool position = strcmp(c->info.name, "position") == 0, velocity = strcmp(c->info.name, "velocity") == 0;
    for (uint32_t k = 0; k < c->info.components; k++) {
        if (position || velocity)
            rheo__output_format(out, ",%s%s", velocity ? "v" : "", axis[k % 3]);
        else if (c->info.components == 1)
            rheo__output_format(out, ",%s", c->info.name);
        else if (c->info.components == 3)
            rheo__output_format(out, ",%s_%s", c->info.name, axis[k % 3]);
        else
            rheo__output_format(out, ",%s_%u", c->info.name, k);
    }
}

static void put_value(rheo__output *out, const rheo__column *c, size_t index)
{
    float single;
    double twice;
    switch (c->info.element) {
    case RHEO_ELEMENT_F32:
        memcpy(&single, (const char *)c->values + index * sizeof single, sizeof single);
        rheo__output_float(out, single);
        break;
    case RHEO_ELEMENT_F64:
        memcpy(&twice, (const char *)c->values + index * sizeof twice, sizeof twice);
        rheo__output_double(out, twice);
        break;
    case RHEO_ELEMENT_U32:
        rheo__output_format(out, "%lu", (unsigned long)bits32(c, index));
        break;
    case RHEO_ELEMENT_U64:
        rheo__output_format(out, "%llu", (unsigned long long)bits64(c, index));
        break;
    }
}

void rheo__write_csv(rheo__output *out, const rheo_world *world, const rheo__columns *columns)
{
    rheo__output_text(out, "id");
    for (uint32_t i = 0; i < columns->count; i++)
        put_names(out, &columns->column[i]);
    rheo__output_text(out, "\n");
    for (uint32_t id = 0; id < rheo_world_particle_count(world); id++) {
        rheo__output_format(out, "%lu", (unsigned long)id);
        for (uint32_t i = 0; i < columns->count; i++) {
            const rheo__column *c = &columns->column[i];
            for (uint32_t k = 0; k < c->info.components; k++) {
                rheo__output_text(out, ",");
                put_value(out, c, (size_t)id * c->info.components + k);
            }
        }
        rheo__output_text(out, "\n");
    }
}
