/*
 * Writes a scene for POV-Ray 3.7. It contains the surface as a mesh2 with normals, the balls, the floor, two lights,
 * and a camera that shows the whole extent. It renders without changes: povray +Iframe.pov +Oframe.png -D
 *
 * Y is up, or z (rheo__output_turn()). Axes are right-handed here and left-handed in POV-Ray; the negative `right` of the
 * camera mirrors them.
 */
#include "view/camera.h"
#include "view/facets.h"
#include "view/output.h"

/* Half the height of the picture at distance 1, and half its width for an aspect ratio of 4:3. */
#define SLOPE_UP .23
#define SLOPE_ASIDE (SLOPE_UP * 4 / 3)

static void put_three(rheo__output *out, const double v[3])
{
    rheo__output_text(out, "<");
    rheo__output_doubles(out, v, 3, ", ");
    rheo__output_text(out, ">");
}

static void put_vector(rheo__output *out, const double v[3])
{
    double turned[3] = {v[0], v[1], v[2]};
    rheo__output_turn(out, turned);
    put_three(out, turned);
}

/* ---- Camera and lights ---- */

/* Adds a light. `from` is its position relative to the centre, in half diagonals of the extent. */
static void put_light(rheo__output *out, const rheo__camera *s, const double from[3])
{
    double position[3];
    for (int a = 0; a < 3; a++)
        position[a] = s->centre[a] + s->size * from[a];
    rheo__output_text(out, "light_source {\n  ");
    put_vector(out, position);
}

static void put_stage(rheo__output *out, const rheo__camera *s)
{
    rheo__output_text(
        out,
        "#version 3.7;\nglobal_settings { assumed_gamma 1 }\n#default { finish { ambient 0.12 diffuse 0.7 } }\n\n"
        "camera {\n  right -x*image_width/image_height\n  up y\n  direction z*");
    rheo__output_double(out, .5 / SLOPE_UP);
    rheo__output_text(out, out->z_up ? "\n  sky z\n  location " : "\n  location ");
    put_vector(out, s->eye);
    rheo__output_text(out, "\n  look_at ");
    put_vector(out, s->centre);
    rheo__output_text(
        out,
        "\n}\nbackground { color srgb <0.87, 0.90, 0.94> }\nfog {\n  color srgb <0.87, 0.90, 0.94>\n  distance ");
    rheo__output_double(out, 60 * s->size);
    rheo__output_text(out, "\n}\n");
    /* The key light is a square of 5 x 5 lamps, for soft shadows. */
    const double key[3] = {-3.5, 7, 3}, fill[3] = {6, 3, 6}, edge[3] = {2 * s->size, 0, 0},
                 across[3] = {0, 0, edge[0]};
    put_light(out, s, fill);
    rheo__output_text(out, "\n  color rgb 0.35 shadowless\n}\n");
    put_light(out, s, key);
    rheo__output_text(out, "\n  color rgb 1.1\n  area_light ");
    put_vector(out, edge);
    rheo__output_text(out, ", ");
    put_vector(out, across);
    rheo__output_text(out, ", 5, 5 adaptive 1 circular orient\n}\n\n");
}

/* ---- Objects ---- */

/*
 * A floor fills the picture and hides the horizon, so a
 * tilted one has lines of equal height, as on a map; a level one has none.
 */
static void put_floors(rheo__output *out, const rheo_world_def *def, double size)
{
    for (uint32_t i = 0; i < def->walls.count; i++) {
        double normal[3], offset;
        if (!rheo__is_floor(def, i, normal, &offset))
            continue;
        rheo__output_text(out, "plane {\n  ");
        put_vector(out, normal);
        rheo__output_text(out, ", ");
        rheo__output_double(out, offset);
        if (normal[0] != 0 || normal[2] != 0) {
            rheo__output_format(out,
                                "\n  pigment {\n    gradient %s color_map { [0.93 color srgb <0.78, 0.79, 0.81>] "
                                "[0.93 color srgb <0.62, 0.64, 0.67>] }\n    scale ",
                                out->z_up ? "z" : "y");
            rheo__output_double(out, .2 * size);
            rheo__output_text(out, "\n  }");
        } else {
            rheo__output_text(out, "\n  pigment { color srgb <0.78, 0.79, 0.81> }");
        }
        rheo__output_text(out, "\n  finish { ambient 0.15 diffuse 0.75 }\n}\n");
    }
}

/* The rows of a POV-Ray matrix are the images of x, y and z. */
static void put_rotation(rheo__output *out, const double q[4])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    double row[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                        {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                        {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    rheo__output_text(out, "  matrix <");
    for (int k = 0; k < 3; k++) {
        rheo__output_turn(out, row[k]);
        rheo__output_doubles(out, row[k], 3, ", ");
        rheo__output_text(out, ", ");
    }
    rheo__output_text(out, "0, 0, 0>\n");
}

/* A dark ball with a pale ring, which shows its spin. */
static void put_balls(rheo__output *out, const rheo_world *world)
{
    for (uint32_t i = 0; i < rheo_world_body_count(world); i++) {
        rheo_body b;
        if (rheo_world_body(world, i, &b) != RHEO_OK)
            continue;
        rheo__output_text(out,
                          "sphere {\n  0, 1\n  pigment {\n    gradient x\n    color_map {\n"
                          "      [0.44 color srgb <0.10, 0.20, 0.42>]\n      [0.44 color srgb <0.93, 0.90, 0.82>]\n"
                          "      [0.56 color srgb <0.93, 0.90, 0.82>]\n      [0.56 color srgb <0.10, 0.20, 0.42>]\n"
                          "    }\n    translate -0.5*x\n    scale 2\n  }\n"
                          "  finish { ambient 0.1 diffuse 0.7 specular 0.6 roughness 0.01 reflection 0.06 }\n");
        put_rotation(out, b.orientation);
        rheo__output_text(out, "  scale ");
        rheo__output_double(out, b.radius);
        rheo__output_text(out, "\n  translate ");
        put_vector(out, b.position);
        rheo__output_text(out, "\n}\n");
    }
}

static void put_facet(void *user, const rheo__facet *facet)
{
    rheo__output *out = user;
    rheo__output_text(out, "  smooth_triangle { ");
    for (int k = 0; k < 3; k++) {
        put_vector(out, facet->corner[k]);
        rheo__output_text(out, ", ");
        put_vector(out, facet->normal[k]);
        rheo__output_text(out, k < 2 ? ", " : " }\n");
    }
}

/* Obstacles with the fluid inside would hide it, so they are like glass. */
static void put_obstacles(rheo__output *out, const rheo_world *world)
{
    const rheo_world_def *def = rheo_world_definition(world);
    for (uint32_t i = 0; i < rheo_world_obstacle_count(world); i++) {
        rheo__output_text(out, "mesh {\n");
        rheo__obstacle_facets(world, i, put_facet, out);
        rheo__output_text(out, def->obstacles.list[i].inside ? "  pigment { color srgbt <0.58, 0.62, 0.68, 0.9> }\n"
                                                             : "  pigment { color srgb <0.58, 0.62, 0.68> }\n");
        rheo__output_text(out, "  finish { ambient 0.12 diffuse 0.7 }\n}\n");
    }
}

/* Number of colours of values. POV-Ray interpolates between vertices. */
enum { SHADES = 64 };

static int shade_of(double value, const rheo__colours *c)
{
    const double range = c->range[1] - c->range[0];
    const double shade = range > 0 ? (value - c->range[0]) / range * (SHADES - 1) + .5 : 0;
    return shade > 0 ? shade < SHADES ? (int)shade : SHADES - 1 : 0;
}

static void put_shades(rheo__output *out, const rheo__colours *c)
{
    rheo__output_format(out, "texture_list {\n  %d", SHADES);
    for (int i = 0; i < SHADES; i++) {
        double rgb[3];
        rheo__colour_of(c, c->range[0] + (c->range[1] - c->range[0]) * i / (SHADES - 1), rgb);
        rheo__output_text(out, ",\n  texture { pigment { color srgb ");
        put_three(out, rgb);
        rheo__output_text(out, " } finish { fluid_finish } }");
    }
    rheo__output_text(out, "\n}\n");
}

static void put_vectors(rheo__output *out, const char *name, const float *vector, uint32_t count)
{
    rheo__output_format(out, "%s {\n%u", name, count);
    for (size_t i = 0; i < count; i++) {
        rheo__output_text(out, ",\n<");
        rheo__output_floats(out, vector + 3 * i, 3, ",");
        rheo__output_text(out, ">");
    }
    rheo__output_text(out, "\n}\n");
}

static void put_surface(rheo__output *out, const rheo_surface *s, const rheo__colours *colours)
{
    rheo__output_text(out,
                      "#declare fluid_finish = finish { ambient 0.12 diffuse 0.72 specular 0.35 roughness 0.02 }\n");
    if (s->triangles == 0) /* POV-Ray refuses an empty mesh */
        return;
    rheo__output_text(out, "mesh2 {\n");
    put_vectors(out, "vertex_vectors", s->position, s->vertices);
    put_vectors(out, "normal_vectors", s->normal, s->vertices);
    if (s->value)
        put_shades(out, colours);
    rheo__output_format(out, "face_indices {\n%u", s->triangles);
    for (size_t t = 0; t < s->triangles; t++) {
        const uint32_t *v = s->triangle + 3 * t;
        rheo__output_format(out, ",\n<%u,%u,%u>", v[0], v[1], v[2]);
        for (int k = 0; s->value && k < 3; k++)
            rheo__output_format(out, ",%d", shade_of((double)s->value[v[k]], colours));
    }
    rheo__output_text(out, "\n}\n");
    if (!s->value)
        rheo__output_text(out, "texture { pigment { color srgb <0.93, 0.88, 0.76> } finish { fluid_finish } }\n");
    rheo__output_text(out, "}\n");
}

void rheo__write_pov(rheo__output *out, const rheo_world *world, const rheo_surface *surface,
                     const rheo_extent *extent, const rheo__colours *colours)
{
    const rheo__camera s = rheo__camera_for(extent, NULL, SLOPE_ASIDE, SLOPE_UP);
    rheo__output_format(
        out, "// Step %llu, made by rheolog %s. Render it by: povray +Iframe.pov +Oframe.png +W800 +H600 +A -D\n",
        (unsigned long long)rheo_world_step_count(world), rheo_version());
    put_stage(out, &s);
    put_floors(out, rheo_world_definition(world), s.size);
    put_balls(out, world);
    put_obstacles(out, world);
    put_surface(out, surface, colours);
}
