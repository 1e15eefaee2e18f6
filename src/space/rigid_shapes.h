/*
 * Distances from the shapes of obstacles (docs/model.md, Obstacles), in the frame of the shape: the origin is its centre.
 * All are computed in double by + - * / and square roots.
 */
#ifndef RHEO__SPACE_RIGID_SHAPES_H
#define RHEO__SPACE_RIGID_SHAPES_H

#include "core/error.h"
#include "core/strict.h"
#include "rheolog/world.h"

struct rheo__surface;

/* A shape, made once from its definition. */
typedef struct rheo__rigid {
    rheo_obstacle_shape shape;
    bool inside;                   /* the fluid is inside */
    double radius, half[3];        /* half: of the edges of a box; half[1]: of the length of a cylinder */
    double axis[3];                /* of a cylinder, a unit vector */
    double reach;                  /* largest distance of a point of the surface from the centre */
    double centre[3];              /* its centre minus the position of the definition */
    struct rheo__surface *surface; /* of a mesh (space/surface.h) */
} rheo__rigid;

/* Makes a shape of a valid obstacle. RHEO_ERROR_MEMORY; RHEO_ERROR_ARGUMENT for a bad mesh. */
rheo_result rheo__rigid_make(rheo__rigid *solid, const rheo_obstacle *obstacle, const rheo_allocator *allocator,
                             rheo_error *error);
void rheo__rigid_release(rheo__rigid *solid, const rheo_allocator *allocator);

/*
 * Distance of x from the surface, above 0 where the fluid is, and the unit vector along which it grows. A distance of
 * `within` or more may be returned as any number of at least `within`, with any normal.
 */
double rheo__rigid_distance(const rheo__rigid *solid, const double x[3], double within, double normal[3]);

/* Largest speed of a point of its surface. */
static inline double rheo__obstacle_speed(const rheo_obstacle *o, double reach)
{
    double v2 = 0, a2 = 0, w2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        v2 += o->velocity[axis] * o->velocity[axis];
        a2 += o->amplitude[axis] * o->amplitude[axis];
        w2 += o->spin[axis] * o->spin[axis];
    }
    return __builtin_sqrt(v2) + 6.283185307179586 * o->frequency * __builtin_sqrt(a2) + reach * __builtin_sqrt(w2);
}

typedef struct rheo__matrix {
    double row[3][3];
} rheo__matrix;

/* Rotation at step 0 as a unit quaternion w, x, y, z, and the matrix of a unit quaternion. */
void rheo__rigid_rotation(const rheo_obstacle *obstacle, double q[4]);
rheo__matrix rheo__rotation_matrix(const double q[4]);

/* x minus centre, turned back: coordinates in the frame of the shape. */
static inline void rheo__into_frame(const rheo__matrix *m, const double centre[3], const double x[3], double local[3])
{
    const double from[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
    for (int axis = 0; axis < 3; axis++)
        local[axis] = m->row[0][axis] * from[0] + m->row[1][axis] * from[1] + m->row[2][axis] * from[2];
}
/* Turns a vector of the frame of the shape. */
static inline void rheo__out_of_frame(const rheo__matrix *m, const double local[3], double v[3])
{
    for (int axis = 0; axis < 3; axis++)
        v[axis] = m->row[axis][0] * local[0] + m->row[axis][1] * local[1] + m->row[axis][2] * local[2];
}

#endif
