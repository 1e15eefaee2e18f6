/* Writes surfaces as OBJ, as binary little-endian PLY and as VTP, with the values of their vertices and their colours. */
#include "view/vtp.h"

void rheo__write_ply(rheo__output *out, const rheo_surface *s, const rheo__colours *colours)
{
    rheo__output_format(out,
                        "ply\nformat binary_little_endian 1.0\ncomment free surface, made by rheolog %s\n"
                        "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
                        "property float nx\nproperty float ny\nproperty float nz\n",
                        rheo_version(), s->vertices);
    if (s->value)
        rheo__output_format(out, "property float %s\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n",
                            colours->name);
    rheo__output_format(out, "element face %u\nproperty list uchar int vertex_indices\nend_header\n", s->triangles);
    for (size_t i = 0; i < s->vertices; i++) {
        for (int a = 0; a < 3; a++)
            rheo__output_little_float(out, s->position[3 * i + a]);
        for (int a = 0; a < 3; a++)
            rheo__output_little_float(out, s->normal[3 * i + a]);
        if (!s->value)
            continue;
        double colour[3];
        rheo__colour_of(colours, (double)s->value[i], colour);
        rheo__output_little_float(out, s->value[i]);
        for (int c = 0; c < 3; c++)
            rheo__output_little(out, (uint64_t)(255 * colour[c] + .5), 1);
    }
    for (size_t t = 0; t < s->triangles; t++) {
        rheo__output_little(out, 3, 1);
        for (int k = 0; k < 3; k++)
            rheo__output_little(out, s->triangle[3 * t + k], 4);
    }
}

void rheo__write_obj(rheo__output *out, const rheo_surface *s, const rheo__colours *colours)
{
    rheo__output_format(out, "# free surface, made by rheolog %s: %u vertices, %u triangles\n", rheo_version(),
                        s->vertices, s->triangles);
    for (size_t i = 0; i < s->vertices; i++) {
        rheo__output_text(out, "v ");
        rheo__output_floats(out, s->position + 3 * i, 3, " ");
        for (int c = 0; c < 3 && colours && s->value; c++) {
            double colour[3];
            rheo__colour_of(colours, (double)s->value[i], colour);
            rheo__output_text(out, " ");
            rheo__output_float(out, (float)colour[c]);
        }
        rheo__output_text(out, "\n");
    }
    for (size_t i = 0; i < s->vertices; i++) {
        rheo__output_text(out, "vn ");
        rheo__output_floats(out, s->normal + 3 * i, 3, " ");
        rheo__output_text(out, "\n");
    }
    for (size_t t = 0; t < s->triangles; t++) {
        const uint32_t *v = s->triangle + 3 * t;
        rheo__output_format(out, "f %u//%u %u//%u %u//%u\n", v[0] + 1, v[0] + 1, v[1] + 1, v[1] + 1, v[2] + 1,
                            v[2] + 1);
    }
}

static void put_floats(const rheo__vtp *vtp, const float *value, uint64_t count)
{
    rheo__vtp_begin_array(vtp, count * sizeof *value);
    for (uint64_t i = 0; i < count; i++)
        rheo__output_little_float(vtp->out, value[i]);
}

void rheo__write_surface(rheo__output *out, const rheo_world *world, const rheo_surface *s,
                         const rheo__colours *colours)
{
    const uint64_t points = s->vertices, corners = 3 * (uint64_t)s->triangles;
    rheo__vtp vtp = rheo__vtp_begin(out, world, s->vertices, 0, 0, s->triangles);
    if (s->value)
        rheo__output_format(out, "<PointData Scalars=\"%s\" Normals=\"normal\">\n", colours->name);
    else
        rheo__vtp_open(&vtp, "PointData", " Normals=\"normal\"");
    rheo__vtp_declare(&vtp, RHEO_ELEMENT_F32, "normal", 3, points * 3 * sizeof(float));
    if (s->value)
        rheo__vtp_declare(&vtp, RHEO_ELEMENT_F32, colours->name, 1, points * sizeof(float));
    rheo__vtp_close(&vtp, "PointData");
    rheo__vtp_open(&vtp, "Points", "");
    rheo__vtp_declare(&vtp, RHEO_ELEMENT_F32, "position", 3, points * 3 * sizeof(float));
    rheo__vtp_close(&vtp, "Points");
    rheo__vtp_declare_cells(&vtp, "Polys", corners, s->triangles);
    rheo__vtp_begin_values(&vtp);
    put_floats(&vtp, s->normal, 3 * points);
    if (s->value)
        put_floats(&vtp, s->value, points);
    put_floats(&vtp, s->position, 3 * points);
    rheo__vtp_begin_array(&vtp, corners * 8);
    for (uint64_t i = 0; i < corners; i++)
        rheo__output_little(out, s->triangle[i], 8);
    rheo__vtp_progression(&vtp, 3, 3, s->triangles, 8);
    rheo__vtp_end(&vtp);
}
