/*
 * Writes particles as VTP (VTK XML PolyData with raw appended arrays, for ParaView) and as CSV. Both contain ids,
 * positions, velocities, all other fields of particles, and the quantities of the model.
 */
#include <string.h>

#include "view/vtp.h"

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

static void declare_column(rheo__vtp *vtp, const rheo__column *c)
{
    rheo__vtp_declare(vtp, c->info.element, c->info.name, c->info.components, c->info.bytes);
}

static void put_column(const rheo__vtp *vtp, const rheo__column *c)
{
    const size_t size = rheo__column_element_size(c), count = (size_t)c->info.bytes / size;
    rheo__vtp_begin_array(vtp, c->info.bytes);
    for (size_t i = 0; i < count; i++)
        rheo__output_little(vtp->out, size == 4 ? bits32(c, i) : bits64(c, i), size);
}

void rheo__write_vtp(rheo__output *out, const rheo_world *world, const rheo__columns *columns)
{
    const uint32_t count = rheo_world_particle_count(world);
    const rheo__column *position = &columns->column[0];
    rheo__vtp vtp = rheo__vtp_begin(out, world, count, count, 0, 0);
    rheo__vtp_open(&vtp, "PointData", " Vectors=\"velocity\"");
    rheo__vtp_declare(&vtp, RHEO_ELEMENT_U32, "id", 1, (uint64_t)count * 4);
    for (uint32_t i = 1; i < columns->count; i++)
        declare_column(&vtp, &columns->column[i]);
    rheo__vtp_close(&vtp, "PointData");
    rheo__vtp_open(&vtp, "Points", "");
    declare_column(&vtp, position);
    rheo__vtp_close(&vtp, "Points");
    rheo__vtp_declare_cells(&vtp, "Verts", count, count);
    rheo__vtp_begin_values(&vtp);
    rheo__vtp_progression(&vtp, 0, 1, count, 4);
    for (uint32_t i = 1; i < columns->count; i++)
        put_column(&vtp, &columns->column[i]);
    put_column(&vtp, position);
    rheo__vtp_progression(&vtp, 0, 1, count, 8);
    rheo__vtp_progression(&vtp, 1, 1, count, 8);
    rheo__vtp_end(&vtp);
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
