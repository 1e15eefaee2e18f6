/* The surface of the fluid, on which the ball is placed. */
#include "core/strict.h"
#include "scenes/making.h"

typedef struct bounds {
    double low[3], high[3];
} bounds;

static bounds bounds_of(const rheo_real *position, uint32_t count)
{
    bounds b;
    for (int axis = 0; axis < 3; axis++) {
        b.low[axis] = (double)position[axis];
        b.high[axis] = (double)position[axis];
        for (size_t i = 0; i < count; i++) {
            double x = (double)position[3 * i + (size_t)axis];
            b.low[axis] = x < b.low[axis] ? x : b.low[axis];
            b.high[axis] = x > b.high[axis] ? x : b.high[axis];
        }
    }
    return b;
}

/* The settled fluid below a ball. */
typedef struct surface {
    double height;         /* of the surface */
    double number_density; /* inside the fluid; 0: there is no inside */
} surface;

/*
 * A window of an axis: 0 outside, 1 inside, and a ramp as wide as the support at both ends. The ramp evens out the
 * layers that particles form along walls.
 */
typedef struct window {
    double low, high, ramp; /* middles of the ramps */
} window;

static double rise(double from_middle, double ramp)
{
    const double share = 0.5 + from_middle / ramp;
    return share < 0 ? 0 : share > 1 ? 1 : share;
}

static double weight(const window *w, double x)
{
    const double up = rise(x - w->low, w->ramp), down = rise(w->high - x, w->ramp);
    return up < down ? up : down;
}

/*
 * The level at which the fluid would end if its density were everywhere that of the upper half: below a surface of
 * particles, a mean height of the topmost ones would depend on how rough it is. False: too shallow or too narrow.
 */
static bool find_level(const rheo_real *position, uint32_t count, const bounds *b, double support, surface *found)
{
    enum { FEW = 64 };
    const double middle = 0.5 * (b->low[1] + b->high[1]);
    window inner[3];
    double area = 1, inside = 0, above = 0;
    for (int axis = 0; axis < 3; axis++) {
        inner[axis] =
            (window){axis == 1 ? middle : b->low[axis] + 1.5 * support, b->high[axis] - 1.5 * support, support};
        if (!(inner[axis].high - inner[axis].low >= support))
            return false;
        area *= axis == 1 ? 1 : inner[axis].high - inner[axis].low;
    }
    for (size_t i = 0; i < count; i++) {
        const double y = (double)position[3 * i + 1];
        const double column =
            weight(&inner[0], (double)position[3 * i]) * weight(&inner[2], (double)position[3 * i + 2]);
        inside += column * weight(&inner[1], y);
        above += column * rise(y - middle, support);
    }
    if (!(inside >= FEW))
        return false;
    found->number_density = inside / (area * (inner[1].high - inner[1].low));
    found->height = middle + above / (area * found->number_density);
    return true;
}

/* Of fluid that is no pool: the mean height of the highest particles of columns one support wide. False: no memory. */
static bool find_surface(const rheo_allocator *allocator, const rheo_real *position, uint32_t count, double support,
                         surface *found)
{
    *found = (surface){0, 0};
    if (count == 0)
        return true;
    bounds b = bounds_of(position, count);
    double wide = (b.high[0] - b.low[0]) / support, deep = (b.high[2] - b.low[2]) / support;
    if (!((wide + 1) * (deep + 1) <= 1024 + 16.0 * count)) { /* scattered particles have no surface */
        found->height = b.high[1];
        return true;
    }
    size_t columns_x = (size_t)wide + 1, columns = columns_x * ((size_t)deep + 1);
    double *top = rheo__allocate(allocator, columns, sizeof *top);
    uint8_t *filled = rheo__allocate(allocator, columns, 1);
    bool enough = top && filled;
    for (size_t i = 0; enough && i < count; i++) {
        size_t x = (size_t)(((double)position[3 * i] - b.low[0]) / support);
        size_t z = (size_t)(((double)position[3 * i + 2] - b.low[2]) / support);
        size_t column = z * columns_x + x;
        double y = (double)position[3 * i + 1];
        if (!filled[column] || y > top[column])
            top[column] = y;
        filled[column] = 1;
    }
    double sum = 0;
    size_t used = 0;
    for (size_t c = 0; enough && c < columns; c++)
        if (filled[c]) {
            sum += top[c];
            used++;
        }
    if (used)
        found->height = sum / (double)used;
    if (enough && used == columns)
        find_level(position, count, &b, support, found);
    rheo__release(allocator, top);
    rheo__release(allocator, filled);
    return enough;
}

rheo_result rheo__place_balls(const rheo_scene *scene, const rheo_allocator *allocator, rheo_world_def *def,
                              rheo_error *error)
{
    surface found;
    if (!(def->ball.radius > 0))
        return RHEO_OK;
    if (!find_surface(allocator, def->particles.position, def->particles.count, def->fluid.support, &found))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to find the surface of %u particles",
                          def->particles.count);
    if (def->fluid.number_density == 0)
        def->fluid.number_density = found.number_density;
    for (uint32_t i = 0; i <= def->balls.count; i++) {
        rheo_ball *ball = i ? &def->balls.list[i - 1] : &def->ball;
        const double clearance = rheo__ball_clearance(scene, i);
        if (clearance >= 0)
            ball->position[1] = found.height + clearance + ball->radius;
    }
    return RHEO_OK;
}
