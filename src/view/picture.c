/* Makes the picture of a world: its particles or their surface, balls, floors and captions. */
#include <stdlib.h>
#include <string.h>

#include "core/environment.h"
#include "view/canvas.h"
#include "view/facets.h"
#include "view/output.h"
#include "view/picture.h"

rheo_picture_options rheo_default_picture_options(void)
{
    return (rheo_picture_options){.width = 1280, .height = 720};
}

/* What the parts of a picture have in common. */
typedef struct picture {
    const rheo_world *world;
    const rheo_picture_options *options;
    rheo__canvas canvas;
    rheo__painted values;
    double range[2];
} picture;

/* Place of a value in the range of colours. */
static double place_of(const picture *p, double value)
{
    const double width = p->range[1] - p->range[0];
    return width > 0 ? (value - p->range[0]) / width : .5;
}

/* ---- The fluid ---- */

typedef struct place {
    double depth;
    uint32_t id;
} place;

static int by_depth(const void *a, const void *b)
{
    const place *x = a, *y = b;
    if (x->depth != y->depth)
        return x->depth < y->depth ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

/* Draws the nearest particles first, because hidden samples cost little. */
static rheo_result draw_particles(picture *p, rheo_error *error)
{
    const uint32_t count = rheo_world_particle_count(p->world);
    const rheo_real *position = rheo_world_positions(p->world);
    place *order = malloc(((size_t)count + 1) * sizeof *order);
    double(*seen)[3] = malloc(((size_t)count + 1) * sizeof *seen);
    const bool enough = order && seen;
    const double radius = .52 * rheo_world_definition(p->world)->fluid.spacing;
    for (uint32_t i = 0; enough && i < count; i++) {
        const rheo_real *x = position + 3 * (size_t)i;
        rheo__canvas_point(&p->canvas, (const double[3]){(double)x[0], (double)x[1], (double)x[2]}, seen[i]);
        order[i] = (place){seen[i][2], i};
    }
    if (enough)
        qsort(order, count, sizeof *order, by_depth);
    for (uint32_t k = 0; enough && k < count; k++) {
        const uint32_t i = order[k].id;
        rheo__ball ball = {.radius = radius, .paint = RHEO__PAINT_PLAIN};
        if (p->values.value)
            ball.paint = rheo__paint_of(place_of(p, (double)p->values.value[i]));
        memcpy(ball.centre, seen[i], sizeof ball.centre);
        rheo__draw_sphere(&p->canvas, &ball);
        rheo__shade_sphere(&p->canvas, seen[i], radius);
    }
    free(order);
    free(seen);
    return enough ? RHEO_OK : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a picture of %u particles", count);
}

static rheo_result draw_surface(picture *p, rheo_error *error)
{
    rheo_surface s;
    RHEO__TRY(rheo__world_surface(p->world, p->options->surface, p->values.value, &s, error));
    for (size_t t = 0; t < s.triangles; t++) {
        double corner[3][3], normal[3][3], value[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            const size_t v = s.triangle[3 * t + (size_t)k];
            const float *x = s.position + 3 * v, *n = s.normal + 3 * v;
            rheo__canvas_point(&p->canvas, (const double[3]){(double)x[0], (double)x[1], (double)x[2]}, corner[k]);
            rheo__canvas_direction(&p->canvas, (const double[3]){(double)n[0], (double)n[1], (double)n[2]},
                                   normal[k]);
            if (p->values.value)
                value[k] = place_of(p, (double)s.value[v]);
        }
        rheo__draw_triangle(&p->canvas, (const double(*)[3])corner, (const double(*)[3])normal,
                            p->values.value ? value : NULL, RHEO__PAINT_PLAIN);
        rheo__shade_triangle(&p->canvas, (const double(*)[3])corner);
    }
    rheo_surface_release(&s);
    return RHEO_OK;
}

/* ---- Solids ---- */

/* The axes of a body, from its unit quaternion. */
static void axes_of(const double q[4], double axis[3][3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double columns[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                                  {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                                  {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(axis, columns, sizeof columns);
}

static void draw_balls(picture *p)
{
    for (uint32_t i = 0; i < rheo_world_body_count(p->world); i++) {
        rheo_body body;
        double axis[3][3], seen[3][3];
        if (rheo_world_body(p->world, i, &body) != RHEO_OK)
            continue;
        axes_of(body.orientation, axis);
        for (int a = 0; a < 3; a++)
            rheo__canvas_direction(&p->canvas, axis[a], seen[a]);
        rheo__ball ball = {.radius = body.radius, .axis = (const double(*)[3])seen};
        rheo__canvas_point(&p->canvas, body.position, ball.centre);
        rheo__draw_sphere(&p->canvas, &ball);
        rheo__shade_sphere(&p->canvas, ball.centre, body.radius);
    }
}

/* Vibrators are studs in the floor below them, or at the lowest height of the picture. */
static void draw_vibrators(picture *p, const rheo_extent *extent)
{
    const rheo_world_def *def = rheo_world_definition(p->world);
    double normal[3] = {0, 1, 0}, offset = extent->min[1];
    for (uint32_t i = def->walls.count; i-- > 0;) {
        double of[3], its;
        if (rheo__is_floor(def, i, of, &its)) {
            memcpy(normal, of, sizeof normal);
            offset = its;
        }
    }
    for (uint32_t i = 0; i < rheo_world_vibrator_count(p->world); i++) {
        rheo_vibrator v;
        if (rheo_world_vibrator(p->world, i, &v) != RHEO_OK)
            continue;
        rheo__ball stud = {.radius = .5 * def->fluid.spacing, .paint = RHEO__PAINT_VIBRATOR};
        rheo__canvas_point(&p->canvas,
                           (const double[3]){v.x, (offset - normal[0] * v.x - normal[2] * v.z) / normal[1], v.z},
                           stud.centre);
        rheo__draw_sphere(&p->canvas, &stud);
    }
}

static void draw_facet(void *user, const rheo__facet *facet)
{
    picture *p = user;
    double corner[3][3], normal[3][3];
    for (int k = 0; k < 3; k++) {
        rheo__canvas_point(&p->canvas, facet->corner[k], corner[k]);
        rheo__canvas_direction(&p->canvas, facet->normal[k], normal[k]);
    }
    rheo__draw_triangle(&p->canvas, (const double(*)[3])corner, (const double(*)[3])normal, NULL, RHEO__PAINT_SOLID);
}

/* An obstacle casts a shadow, unless the fluid is inside, where its far side is seen. */
static void shade_facet(void *user, const rheo__facet *facet)
{
    picture *p = user;
    double corner[3][3];
    for (int k = 0; k < 3; k++)
        rheo__canvas_point(&p->canvas, facet->corner[k], corner[k]);
    rheo__shade_triangle(&p->canvas, (const double(*)[3])corner);
}

static void draw_obstacles(picture *p)
{
    const rheo_world_def *def = rheo_world_definition(p->world);
    for (uint32_t i = 0; i < rheo_world_obstacle_count(p->world); i++) {
        rheo__obstacle_facets(p->world, i, draw_facet, p);
        if (!def->obstacles.list[i].inside)
            rheo__obstacle_facets(p->world, i, shade_facet, p);
    }
}

static void draw_floors(picture *p)
{
    const rheo_world_def *def = rheo_world_definition(p->world);
    for (uint32_t i = 0; i < def->walls.count; i++) {
        double normal[3], offset;
        if (rheo__is_floor(def, i, normal, &offset))
            rheo__draw_floor(&p->canvas, normal, offset);
    }
}

/* ---- The whole ---- */

static void set_colours(rheo__canvas *canvas)
{
    static const double OTHERS[RHEO__PAINTS - RHEO__SHADES][3] = {{.90, .85, .72}, {.10, .20, .42}, {.93, .90, .82},
                                                                  {.86, .87, .89}, {.68, .70, .73}, {.55, .22, .12},
                                                                  {.58, .62, .68}, {0, 0, 0}};
    for (int i = 0; i < RHEO__PAINTS; i++) {
        double colour[3];
        if (i < RHEO__SHADES)
            rheo__scale_colour((double)i / (RHEO__SHADES - 1), colour);
        else
            memcpy(colour, OTHERS[i - RHEO__SHADES], sizeof colour);
        for (int a = 0; a < 3; a++)
            canvas->colour[i][a] = colour[a] * colour[a];
    }
}

static rheo_result check(const rheo_picture_options *o, rheo_error *error)
{
    const double *range = o->range;
    if (o->width < RHEO_PICTURE_MIN || o->width > RHEO_PICTURE_MAX || o->height < RHEO_PICTURE_MIN ||
        o->height > RHEO_PICTURE_MAX)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a picture has %d to %d pixels in each direction; got %u x %u",
                          RHEO_PICTURE_MIN, RHEO_PICTURE_MAX, o->width, o->height);
    if (range && !(range[0] <= range[1] && range[0] >= -1e30 && range[1] <= 1e30))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the range of colours must ascend and be within 1e30");
    if (o->camera)
        RHEO__TRY(rheo__camera_check(o->camera, error));
    return rheo__check_environment(error);
}

static rheo_result draw(picture *p, unsigned char *rgb, rheo_error *error)
{
    const rheo_picture_options *o = p->options;
    const rheo_extent extent = o->extent ? *o->extent : rheo_world_extent(p->world);
    const bool has_scale = p->values.value && !o->without_captions;
    RHEO__TRY(rheo__canvas_make(&p->canvas, o->width, o->height, &extent, o->camera, has_scale, error));
    set_colours(&p->canvas);
    draw_balls(p);
    draw_obstacles(p);
    draw_floors(p);
    draw_vibrators(p, &extent);
    rheo_result result = o->surface ? draw_surface(p, error) : draw_particles(p, error);
    if (result == RHEO_OK)
        result = rheo__canvas_light(&p->canvas, 3 * rheo_world_definition(p->world)->fluid.spacing, rgb, error);
    if (result == RHEO_OK) {
        const rheo__sheet sheet = {rgb, o->width, o->height};
        if (has_scale)
            rheo__sheet_scale(&sheet, &p->values, p->range);
        if (!o->without_captions)
            rheo__sheet_time(&sheet, p->world);
    }
    rheo__canvas_release(&p->canvas);
    return result;
}

rheo_result rheo_world_render(const rheo_world *world, const rheo_picture_options *options, unsigned char *rgb,
                              rheo_error *error)
{
    RHEO__TRY(check(options, error));
    picture p = {.world = world, .options = options};
    RHEO__TRY(rheo__painted_read(world, options, &p.values, error));
    rheo_result result = RHEO_OK;
    if (options->range)
        memcpy(p.range, options->range, sizeof p.range);
    else
        result = rheo__painted_range(&p.values, rheo_world_particle_count(world), p.range, error);
    if (result == RHEO_OK)
        result = draw(&p, rgb, error);
    rheo__painted_release(&p.values);
    return result;
}
