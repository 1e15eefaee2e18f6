/* Writes surfaces as OBJ and as binary little-endian PLY. PLY includes temperatures and their colours, if any. */
#include "view/output.h"

void rheo__write_ply(rheo__output *out, const rheo_surface *s, const rheo_extent *extent)
{
    rheo__output_format(out,
                        "ply\nformat binary_little_endian 1.0\ncomment free surface, made by rheolog %s\n"
                        "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
                        "property float nx\nproperty float ny\nproperty float nz\n",
                        rheo_version(), s->vertices);
    if (s->value)
        rheo__output_text(out, "property float temperature\nproperty uchar red\nproperty uchar green\n"
                               "property uchar blue\n");
    rheo__output_format(out, "element face %u\nproperty list uchar int vertex_indices\nend_header\n", s->triangles);
    for (size_t i = 0; i < s->vertices; i++) {
        for (int a = 0; a < 3; a++)
            rheo__output_little_float(out, s->position[3 * i + a]);
        for (int a = 0; a < 3; a++)
            rheo__output_little_float(out, s->normal[3 * i + a]);
        if (!s->value)
            continue;
        double colour[3];
        rheo__temperature_colour((double)s->value[i], extent, colour);
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

void rheo__write_obj(rheo__output *out, const rheo_surface *s)
{
    rheo__output_format(out, "# free surface, made by rheolog %s: %u vertices, %u triangles\n", rheo_version(),
                        s->vertices, s->triangles);
    for (size_t i = 0; i < s->vertices; i++) {
        rheo__output_text(out, "v ");
        rheo__output_floats(out, s->position + 3 * i, 3, " ");
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
