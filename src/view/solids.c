/*
 * Writes what is no fluid as VTP: balls as spheres whose octants have two colours, so that their spin can be seen; walls
 * as squares as large as the fluid; vibrators as points; obstacles as triangles. Cells have a kind (0 wall, 1 ball,
 * 2 vibrator, 3 obstacle), an index, a panel (of a ball: 0 or 1), and the velocity and the spin of the ball or obstacle.
 */
#include "view/facets.h"
#include "view/vectors.h"
#include "view/vtp.h"

typedef struct solids {
    const rheo_world *world;
    rheo__vtp vtp;
    uint32_t walls, balls, vibrators, obstacles;
    uint32_t facets;                /* triangles of all obstacles */
    double centre[3], half, bottom; /* middle of the extent, half its diagonal, its lowest point */
} solids;

/* ---- A sphere: an octahedron whose faces are cut into rows of triangles ---- */

enum {
    ROWS = 12,
    OCTANTS = 8,
    FACE_POINTS = (ROWS + 1) * (ROWS + 2) / 2,
    FACE_TRIANGLES = ROWS * ROWS,
    BALL_POINTS = OCTANTS * FACE_POINTS,
    BALL_TRIANGLES = OCTANTS * FACE_TRIANGLES,
    CORNERS = 4, /* of a wall */
};

/* The unit vector of a point of an octant. Row 0 is the pole; row r has r + 1 points. */
static void direction_of(int octant, int row, int along, double direction[3])
{
    const double x[3] = {row - along, ROWS - row, along}, length = rheo__view_length(x);
    for (int axis = 0; axis < 3; axis++)
        direction[axis] = (octant >> axis & 1 ? -x[axis] : x[axis]) / length;
}

/* Rotates a vector by a unit quaternion (w, u): v + 2 u x (u x v + w v). */
static void rotate(const double q[4], double v[3])
{
    const double *u = q + 1;
    double inner[3], outer[3];
    rheo__view_cross(u, v, inner);
    for (int k = 0; k < 3; k++)
        inner[k] += q[0] * v[k];
    rheo__view_cross(u, inner, outer);
    for (int k = 0; k < 3; k++)
        v[k] += 2 * outer[k];
}

/* Anticlockwise from outside; octants with an odd number of negative axes are mirrored. */
static bool is_mirrored(int octant)
{
    return (octant ^ octant >> 1 ^ octant >> 2) & 1;
}

/* ---- Points: those of vibrators, walls, balls ---- */

static void put_point(const solids *s, const double point[3])
{
    double turned[3] = {point[0], point[1], point[2]};
    rheo__output_turn(s->vtp.out, turned);
    for (int axis = 0; axis < 3; axis++)
        rheo__output_little_float(s->vtp.out, (float)turned[axis]);
}

/* A square around the point of the wall that is nearest to the centre. */
static void put_wall(const solids *s, const rheo_wall *wall)
{
    static const int SIGN[CORNERS][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    double n[3], u[3], v[3], from[3], axis[3] = {0, 0, 0};
    int least = 0; /* the axis that the normal is farthest from */
    for (int k = 0; k < 3; k++) {
        n[k] = wall->normal[k];
        from[k] = s->centre[k] - wall->point[k];
        least = n[k] * n[k] < n[least] * n[least] ? k : least;
    }
    axis[least] = 1;
    rheo__view_normalise(n);
    rheo__view_cross(n, axis, u);
    rheo__view_normalise(u);
    rheo__view_cross(n, u, v);
    const double distance = rheo__view_dot(n, from);
    for (int corner = 0; corner < CORNERS; corner++) {
        double point[3];
        for (int k = 0; k < 3; k++)
            point[k] = s->centre[k] - distance * n[k] + s->half * (SIGN[corner][0] * u[k] + SIGN[corner][1] * v[k]);
        put_point(s, point);
    }
}

static void put_ball(const solids *s, const rheo_body *ball)
{
    for (int octant = 0; octant < OCTANTS; octant++)
        for (int row = 0; row <= ROWS; row++)
            for (int along = 0; along <= row; along++) {
                double point[3];
                direction_of(octant, row, along, point);
                rotate(ball->orientation, point);
                for (int k = 0; k < 3; k++)
                    point[k] = ball->position[k] + ball->radius * point[k];
                put_point(s, point);
            }
}

static void put_facet(void *user, const rheo__facet *facet)
{
    for (int k = 0; k < 3; k++)
        put_point(user, facet->corner[k]);
}

static void put_points(const solids *s, uint32_t points)
{
    rheo__vtp_begin_array(&s->vtp, (uint64_t)points * 3 * sizeof(float));
    for (uint32_t i = 0; i < s->vibrators; i++) {
        rheo_vibrator vibrator = {0};
        rheo_world_vibrator(s->world, i, &vibrator);
        put_point(s, (const double[3]){vibrator.x, s->bottom, vibrator.z});
    }
    for (uint32_t i = 0; i < s->walls; i++)
        put_wall(s, &rheo_world_definition(s->world)->walls.plane[i]);
    for (uint32_t i = 0; i < s->balls; i++) {
        rheo_body ball = {.radius = 0};
        rheo_world_body(s->world, i, &ball);
        put_ball(s, &ball);
    }
    for (uint32_t i = 0; i < s->obstacles; i++)
        rheo__obstacle_facets(s->world, i, put_facet, (void *)(uintptr_t)s);
}

/* ---- Cells: vertices of vibrators, squares of walls, triangles of balls ---- */

static void put_triangle(const solids *s, bool mirrored, uint64_t a, uint64_t b, uint64_t c)
{
    const uint64_t corner[3] = {a, mirrored ? c : b, mirrored ? b : c};
    for (int k = 0; k < 3; k++)
        rheo__output_little(s->vtp.out, corner[k], 8);
}

/* Between two rows are triangles with one point above, and with two. */
static void put_octant(const solids *s, int octant, uint64_t first)
{
    const bool mirrored = is_mirrored(octant);
    for (uint64_t row = 0; row < ROWS; row++) {
        const uint64_t above = first + row * (row + 1) / 2, below = above + row + 1;
        for (uint64_t along = 0; along <= row; along++) {
            put_triangle(s, mirrored, above + along, below + along + 1, below + along);
            if (along < row)
                put_triangle(s, mirrored, above + along, above + along + 1, below + along + 1);
        }
    }
}

static void put_polygons(const solids *s)
{
    const uint64_t first_wall = s->vibrators, first_ball = first_wall + CORNERS * (uint64_t)s->walls;
    const uint64_t wall_ends = CORNERS * (uint64_t)s->walls, triangles = BALL_TRIANGLES * (uint64_t)s->balls;
    const uint64_t first_facet = first_ball + BALL_POINTS * (uint64_t)s->balls, facets = s->facets;
    rheo__vtp_begin_array(&s->vtp, (wall_ends + 3 * triangles + 3 * facets) * 8);
    for (uint64_t i = 0; i < wall_ends; i++)
        rheo__output_little(s->vtp.out, first_wall + i, 8);
    for (uint64_t ball = 0; ball < s->balls; ball++)
        for (int octant = 0; octant < OCTANTS; octant++)
            put_octant(s, octant, first_ball + ball * BALL_POINTS + (uint64_t)octant * FACE_POINTS);
    for (uint64_t i = 0; i < 3 * facets; i++)
        rheo__output_little(s->vtp.out, first_facet + i, 8);
    rheo__vtp_begin_array(&s->vtp, (s->walls + triangles + facets) * 8);
    for (uint64_t i = 1; i <= s->walls; i++)
        rheo__output_little(s->vtp.out, CORNERS * i, 8);
    for (uint64_t i = 1; i <= triangles + facets; i++)
        rheo__output_little(s->vtp.out, wall_ends + 3 * i, 8);
}

typedef enum column { KIND, INDEX, PANEL, COLUMNS } column;

/* Vertices come before polygons, whatever the kind. */
static void put_column(const solids *s, column c, uint32_t cells)
{
    enum { WALL, BALL, VIBRATOR, OBSTACLE };
    rheo__vtp_begin_array(&s->vtp, (uint64_t)cells * 4);
    for (uint32_t i = 0; i < s->vibrators; i++)
        rheo__output_little(s->vtp.out, c == KIND ? VIBRATOR : c == INDEX ? i : 0, 4);
    for (uint32_t i = 0; i < s->walls; i++)
        rheo__output_little(s->vtp.out, c == KIND ? WALL : c == INDEX ? i : 0, 4);
    for (uint32_t ball = 0; ball < s->balls; ball++)
        for (int i = 0; i < BALL_TRIANGLES; i++)
            rheo__output_little(s->vtp.out,
                                c == KIND    ? BALL
                                : c == INDEX ? ball
                                             : is_mirrored(i / FACE_TRIANGLES),
                                4);
    for (uint32_t i = 0; i < s->obstacles; i++)
        for (uint32_t left = rheo__obstacle_facets(s->world, i, NULL, NULL); left > 0; left--)
            rheo__output_little(s->vtp.out, c == KIND ? OBSTACLE : c == INDEX ? i : 0, 4);
}

enum { VECTORS = 2 };

/* The velocity or the spin of each cell's body; 0 of what does not move. */
static void put_vectors(const solids *s, bool spin, uint32_t cells)
{
    static const double NONE[3] = {0, 0, 0};
    rheo__vtp_begin_array(&s->vtp, (uint64_t)cells * 3 * sizeof(float));
    for (uint32_t i = 0; i < s->vibrators + s->walls; i++)
        put_point(s, NONE);
    for (uint32_t i = 0; i < s->balls; i++) {
        rheo_body ball = {.radius = 0};
        rheo_world_body(s->world, i, &ball);
        for (int k = 0; k < BALL_TRIANGLES; k++)
            put_point(s, spin ? ball.spin : ball.velocity);
    }
    for (uint32_t i = 0; i < s->obstacles; i++) {
        rheo_obstacle_state obstacle = {.velocity = {0}};
        rheo_world_obstacle(s->world, i, &obstacle);
        for (uint32_t left = rheo__obstacle_facets(s->world, i, NULL, NULL); left > 0; left--)
            put_point(s, spin ? obstacle.spin : obstacle.velocity);
    }
}

void rheo__write_solids(rheo__output *out, const rheo_world *world, const rheo_extent *extent)
{
    static const char *const NAMES[COLUMNS] = {"kind", "index", "panel"};
    solids s = {.world = world,
                .walls = rheo_world_definition(world)->walls.count,
                .balls = rheo_world_body_count(world),
                .vibrators = rheo_world_vibrator_count(world),
                .obstacles = rheo_world_obstacle_count(world),
                .bottom = extent->min[1]};
    double diagonal[3];
    for (int k = 0; k < 3; k++) {
        s.centre[k] = .5 * extent->min[k] + .5 * extent->max[k];
        diagonal[k] = .5 * extent->max[k] - .5 * extent->min[k];
    }
    s.half = rheo__view_length(diagonal);
    for (uint32_t i = 0; i < s.obstacles; i++)
        s.facets += rheo__obstacle_facets(world, i, NULL, NULL);
    const uint32_t points = s.vibrators + CORNERS * s.walls + BALL_POINTS * s.balls + 3 * s.facets;
    const uint32_t polygons = s.walls + BALL_TRIANGLES * s.balls + s.facets, cells = s.vibrators + polygons;
    s.vtp = rheo__vtp_begin(out, world, points, s.vibrators, 0, polygons);
    rheo__vtp_open(&s.vtp, "CellData", " Scalars=\"kind\"");
    for (int c = 0; c < COLUMNS; c++)
        rheo__vtp_declare(&s.vtp, RHEO_ELEMENT_U32, NAMES[c], 1, (uint64_t)cells * 4);
    for (int v = 0; v < VECTORS; v++)
        rheo__vtp_declare(&s.vtp, RHEO_ELEMENT_F32, v ? "spin" : "velocity", 3, (uint64_t)cells * 3 * sizeof(float));
    rheo__vtp_close(&s.vtp, "CellData");
    rheo__vtp_open(&s.vtp, "Points", "");
    rheo__vtp_declare(&s.vtp, RHEO_ELEMENT_F32, "position", 3, (uint64_t)points * 3 * sizeof(float));
    rheo__vtp_close(&s.vtp, "Points");
    rheo__vtp_declare_cells(&s.vtp, "Verts", s.vibrators, s.vibrators);
    rheo__vtp_declare_cells(
        &s.vtp, "Polys",
        CORNERS * (uint64_t)s.walls + 3 * (uint64_t)BALL_TRIANGLES * s.balls + 3 * (uint64_t)s.facets, polygons);
    rheo__vtp_begin_values(&s.vtp);
    for (int c = 0; c < COLUMNS; c++)
        put_column(&s, (column)c, cells);
    for (int v = 0; v < VECTORS; v++)
        put_vectors(&s, v == 1, cells);
    put_points(&s, points);
    rheo__vtp_progression(&s.vtp, 0, 1, s.vibrators, 8);
    rheo__vtp_progression(&s.vtp, 1, 1, s.vibrators, 8);
    put_polygons(&s);
    rheo__vtp_end(&s.vtp);
}
