/*
 * The interface between a shape and the engine (fill.c). RHEO__SHAPES in rheolog/scene.h lists all shapes;
 * shape_NAME.c defines rheo__shape_NAME.
 */
#ifndef RHEO__SCENES_SHAPE_H
#define RHEO__SCENES_SHAPE_H

#include <stddef.h>

#include "rheolog/scene.h"
#include "scenes/lattice.h"

/* A shape and the spacing of its particles. */
typedef struct rheo__solid {
    const rheo_fill *fill;
    const void *data; /* result of open() */
    double spacing;   /* L */
} rheo__solid;

typedef struct rheo__shape {
    rheo_shape row;    /* name, meaning and members, which are public */
    double max_points; /* largest number of lattice points along an axis */
    /* Checks conditions other than the ranges of the members. May be NULL. */
    rheo_result (*check)(const rheo_fill *fill, rheo_error *error);
    /* Reads or builds data that the shape needs; fills with the same name share it. NULL, with close(): none. */
    rheo_result (*open)(const rheo_fill *fill, const rheo_allocator *allocator, void **data, rheo_error *error);
    void (*close)(const rheo_allocator *allocator, void *data);
    /* Extent along each axis, L. */
    void (*measure)(const rheo_fill *fill, const void *data, double size[3]);
    /* Lattice around the shape. `size` is in spacings. */
    rheo__lattice (*lattice)(const rheo__solid *solid, const double size[3]);
    /*
     * Passes the points inside the shape to `run`, z slowest, x fastest. NULL: all points of the lattice are inside.
     */
    rheo_result (*run)(const rheo__solid *solid, const rheo__lattice *lattice, rheo__run *run, void *user,
                       rheo_error *error);
} rheo__shape;

#define RHEO__DECLARE_SHAPE(KIND, name) extern const rheo__shape rheo__shape_##name;
RHEO__SHAPES(RHEO__DECLARE_SHAPE)
#undef RHEO__DECLARE_SHAPE

/* The shape of a kind, or NULL. */
const rheo__shape *rheo__shape_of(rheo_fill_kind kind);

/*
 * Lattice of a shape whose position is the middle of its underside, fill->position. The lowest points are half a
 * spacing above the underside; the lattice is centred along x and z, as in a block of the same size.
 */
rheo__lattice rheo__lattice_on_underside(const rheo__solid *solid, const double size[3]);

/* ---- Rows of members ---- */

/* Row of a member of rheo_fill. A number needs .minimum or .maximum; both are 0 by default. */
#define RHEO__MEMBER(name_, member_, type_, unit_, meaning_, ...)                                                 \
    {                                                                                                             \
        .name = name_, .type = type_, .unit = unit_, .meaning = meaning_, .offset = offsetof(rheo_fill, member_), \
        .size = sizeof((rheo_fill *)0)->member_, __VA_ARGS__                                                      \
    }
#define RHEO__FINITE .minimum = -1e30, .maximum = 1e30

/* Members of all shapes. They follow the shape's own members. */
#define RHEO__COMMON_MEMBERS                                                                                       \
    RHEO__MEMBER("velocity", velocity, RHEO_SHAPE_VECTOR, "L/T", "velocity of the particles", RHEO__FINITE),       \
        RHEO__MEMBER("jitter", jitter, RHEO_SHAPE_NUMBER, "spacing",                                               \
                     "largest random displacement of each coordinate", .maximum = 0.5),                            \
        RHEO__MEMBER("material", material, RHEO_SHAPE_TEXT, "", "name of their material; by default the main one", \
                     .needs = RHEO_SHAPE_NEEDS_MATERIALS),                                                         \
        RHEO__MEMBER("temperature", temperature, RHEO_SHAPE_PAIR, "K",                                             \
                     "temperature of the lowest and of the highest particle, linear in between", RHEO__FINITE,     \
                     .given = offsetof(rheo_fill, has_temperature), .needs = RHEO_SHAPE_NEEDS_TEMPERATURE),        \
        RHEO__MEMBER("hydrostatic", not_hydrostatic, RHEO_SHAPE_NEGATED_FLAG, "",                                  \
                     "whether densities begin as in a fluid at rest under gravity, or at the rest density",        \
                     .needs = RHEO_SHAPE_NEEDS_DENSITY)

#define RHEO__ROW(name_, meaning_, members_)                    \
    {                                                           \
        .name = name_, .meaning = meaning_, .member = members_, \
        .member_count = sizeof(members_) / sizeof *(members_)   \
    }

#endif
