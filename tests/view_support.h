/* Clouds of particles and files for the tests of surfaces, exports and pictures. Needs _XOPEN_SOURCE 700. */
#ifndef RHEO__TESTS_VIEW_SUPPORT_H
#define RHEO__TESTS_VIEW_SUPPORT_H

#include "support.h"

#include <math.h>
#include <unistd.h>

#include "view/output.h"

static char folder[] = "/tmp/rheolog-view-XXXXXX";

static inline int set_up(void **state)
{
    (void)state;
    return !mkdtemp(folder) || chdir(folder) != 0;
}

static inline int tear_down(void **state)
{
    (void)state;
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return chdir("/") != 0 || system(command) != 0;
}

/* ---- Clouds of particles ---- */

enum { MOST = 20000 };

typedef struct cloud {
    uint32_t count;
    rheo_real position[3 * MOST], volume[MOST], value[MOST];
} cloud;

static inline void add(cloud *c, double x, double y, double z)
{
    assert_true(c->count < MOST);
    rheo_real *at = c->position + 3 * (size_t)c->count;
    at[0] = (rheo_real)x;
    at[1] = (rheo_real)y;
    at[2] = (rheo_real)z;
    c->count++;
}

static inline cloud *new_cloud(void)
{
    cloud *c = calloc(1, sizeof *c);
    assert_non_null(c);
    return c;
}

static inline void add_ball(cloud *c, double radius, double x0, double y0, double z0)
{
    const int n = (int)radius + 1;
    for (int z = -n; z <= n; z++)
        for (int y = -n; y <= n; y++)
            for (int x = -n; x <= n; x++)
                if (x * x + y * y + z * z <= radius * radius)
                    add(c, x0 + x, y0 + y, z0 + z);
}

static inline void add_torus(cloud *c, double large, double small)
{
    const int n = (int)(large + small) + 1;
    for (int z = -n; z <= n; z++)
        for (int y = -n; y <= n; y++)
            for (int x = -n; x <= n; x++) {
                const double ring = sqrt((double)(x * x + z * z)) - large;
                if (ring * ring + y * y <= small * small)
                    add(c, x, y, z);
            }
}

static inline double random_number(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 40) / (1 << 24);
}

static inline rheo_surface surface_of(const cloud *c, rheo_surface_options options)
{
    const rheo_surface_particles p = {
        .count = c->count, .position = c->position, .spacing = 1, .smoothing_length = 1};
    rheo_surface s;
    OK(rheo_surface_make(&p, &options, NULL, &s, &error));
    return s;
}

/* ---- Files ---- */

static inline rheo_exported export_to(const rheo_world *world, rheo_export_format format, const char *path)
{
    rheo_exported exported;
    const rheo_export_options options = {.surface = rheo_default_surface_options(), .force = true};
    OK(rheo_world_export(world, format, path, &options, &exported, &error));
    return exported;
}

/* ---- Properties of a surface ---- */

static inline int by_value(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Returns NULL if every edge is used once in each direction, every vertex is used and all numbers are finite. */
static inline const char *fault_of(const rheo_surface *s)
{
    const size_t edges = 3 * (size_t)s->triangles;
    uint64_t *edge = malloc((2 * edges + 1) * sizeof *edge), *back = edge + edges;
    bool *used = calloc((size_t)s->vertices + 1, sizeof *used);
    assert_non_null(edge);
    assert_non_null(used);
    const char *fault = NULL;
    for (size_t k = 0; k < edges && !fault; k++) {
        const uint32_t a = s->triangle[k], b = s->triangle[k % 3 == 2 ? k - 2 : k + 1];
        if (a >= s->vertices || b >= s->vertices || a == b)
            fault = "a triangle names a vertex that is none, or one twice";
        else
            used[a] = true;
        edge[k] = (uint64_t)a << 32 | b;
        back[k] = (uint64_t)b << 32 | a;
    }
    qsort(edge, edges, sizeof *edge, by_value);
    qsort(back, edges, sizeof *back, by_value);
    for (size_t k = 0; k < edges && !fault; k++) {
        if (k && edge[k] == edge[k - 1])
            fault = "an edge is run through twice in one direction";
        else if (edge[k] != back[k])
            fault = "an edge is run through in one direction only";
    }
    for (size_t v = 0; v < s->vertices && !fault; v++) {
        const float *n = s->normal + 3 * v, *x = s->position + 3 * v;
        const double length2 =
            (double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] + (double)n[2] * (double)n[2];
        if (!used[v])
            fault = "a vertex is of no triangle";
        else if (!(fabs(length2 - 1) < 1e-5))
            fault = "a normal is no unit vector";
        else if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
            fault = "a vertex is not finite";
    }
    free(edge);
    free(used);
    return fault;
}

static inline void assert_closed(const rheo_surface *s)
{
    const char *fault = fault_of(s);
    if (fault)
        fail_msg("%u vertices, %u triangles: %s", s->vertices, s->triangles, fault);
}

/* Euler characteristic of a closed surface: vertices - edges + faces. */
static inline int euler(const rheo_surface *s)
{
    return (int)((long)s->vertices - (long)s->triangles / 2);
}

static inline double volume_of(const rheo_surface *s)
{
    double sum = 0;
    for (size_t t = 0; t < s->triangles; t++) {
        double x[3][3];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                x[k][a] = (double)s->position[3 * (size_t)s->triangle[3 * t + k] + a];
        sum += x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) + x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
               x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
    }
    return sum / 6;
}

static inline uint64_t little(const char *bytes, size_t count)
{
    uint64_t value = 0;
    for (size_t i = count; i-- > 0;)
        value = value << 8 | (unsigned char)bytes[i];
    return value;
}

/* Start of an array of a VTP file, and its stated number of bytes. */
static inline const char *array_of(const char *text, const char *name, uint64_t *bytes)
{
    char head[64];
    snprintf(head, sizeof head, "Name=\"%s\"", name);
    const char *at = strstr(text, head), *data = strstr(text, "encoding=\"raw\">\n_");
    assert_non_null(at);
    assert_non_null(data);
    at = strstr(at, "offset=\"");
    data += strlen("encoding=\"raw\">\n_") + strtoul(at + 8, NULL, 10);
    *bytes = little(data, 8);
    return data + 8;
}

#endif
