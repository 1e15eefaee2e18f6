/*
 * Views of a world: the free surface of a fluid as a triangle mesh, and files for ParaView, renderers and tables.
 * Nothing here changes a world. One world gives the same bytes on every machine. docs/pictures.md has examples.
 */
#ifndef RHEOLOG_VIEW_H
#define RHEOLOG_VIEW_H

#include "rheolog/world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- The free surface ---- */

/** Options of a surface. */
typedef struct rheo_surface_options {
    /** Value of chi at the surface; chi is 1 inside a fluid and 0 outside. Range above 0 and below 1, default 0.5. */
    double isovalue;
    /**
     * Cells of the grid per smoothing length. Range 0.5 to 8, default 2. The number of triangles grows as its
     * square.
     */
    double resolution;
} rheo_surface_options;

/** Default options. */
RHEO_API rheo_surface_options rheo_default_surface_options(void);

/** Particles of a surface. */
typedef struct rheo_surface_particles {
    /** Number of particles. */
    uint32_t count;
    /** Positions, count x 3. Unit L. Finite. */
    const rheo_real *position;
    /** Volumes mass / density, count. Unit L^3. Range >= 0. NULL: spacing^3 each. */
    const rheo_real *volume;
    /** Values that vertices get too, such as temperatures, count. Any unit. Finite. NULL: none. */
    const rheo_real *value;
    /** Distance of the particles. Unit L. Range 1e-12 to 1e12. Ignored if volumes are given. */
    double spacing;
    /** Smoothing length h of the kernel W, whose support is 3 h. Unit L. Range 1e-12 to 1e12. */
    double smoothing_length;
} rheo_surface_particles;

/**
 * A closed surface: two triangles share every edge, and run through it in opposite directions. Seen from outside the
 * fluid, the vertices of a triangle are anticlockwise. Where no fluid is dense enough there are no triangles.
 */
typedef struct rheo_surface {
    /** Number of vertices. */
    uint32_t vertices;
    /** Number of triangles. */
    uint32_t triangles;
    /** Positions, vertices x 3. Unit L. */
    float *position;
    /** Unit normals out of the fluid, vertices x 3: the direction of -grad chi. */
    float *normal;
    /** Means of the particles' values, weighted by their parts of chi, one per vertex; NULL without values. */
    float *value;
    /** Indices of vertices, triangles x 3. */
    uint32_t *triangle;
    /** Particles left out: at more than 2^23 cells from the origin a float cannot resolve a cell. */
    uint32_t left_out;
    /** Allocator of the arrays. */
    rheo_allocator allocator;
} rheo_surface;

/**
 * Makes the isosurface of chi(x) = sum over j of V_j W(|x - x_j|, h), W the quintic spline. chi is 1 inside a fluid
 * and falls to 0 outside; at a single particle with h equal to the spacing it is 0.18. Memory is proportional to
 * the volume that the fluid occupies, not to its extent. `allocator` may be NULL.
 *
 * RHEO_ERROR_ARGUMENT for an option out of range, values that are not finite or a negative volume;
 * RHEO_ERROR_UNSUPPORTED for more than 2^31 - 1 vertices or triangles; RHEO_ERROR_MEMORY; RHEO_ERROR_ENVIRONMENT.
 * After an error *surface is empty.
 */
RHEO_API rheo_result rheo_surface_make(const rheo_surface_particles *particles, const rheo_surface_options *options,
                                       const rheo_allocator *allocator, rheo_surface *surface, rheo_error *error);
/**
 * Makes the surface of a world. The volume of a particle is mass / density if particles have densities (melting),
 * else spacing^3. h is the smoothing length (melting) or the spacing. The values are the temperatures, if there are
 * any. Arguments and errors as for rheo_surface_make().
 */
RHEO_API rheo_result rheo_world_surface(const rheo_world *world, const rheo_surface_options *options,
                                        const rheo_allocator *allocator, rheo_surface *surface, rheo_error *error);
/** Releases the arrays. A surface that is all zero is allowed. */
RHEO_API void rheo_surface_release(rheo_surface *surface);

/* ---- Files ---- */

/** File formats. */
typedef enum rheo_export_format {
    /** Particles with all their fields and quantities (rheo_world_quantity()), for ParaView: VTK XML PolyData. */
    RHEO_EXPORT_VTP = 0,
    /** Surface, binary: vertices, normals, the values of `colour` and their colours. */
    RHEO_EXPORT_PLY,
    /** Surface, text: vertices, of a given `colour` with red, green and blue behind their coordinates, and normals. */
    RHEO_EXPORT_OBJ,
    /** Scene for POV-Ray: surface, ball, floor, lights and camera. */
    RHEO_EXPORT_POV,
    /** Particles with all their fields and quantities, one line each. */
    RHEO_EXPORT_CSV,
    /** Springs as lines, with length, rest length, stretch, history rate, stiffness and kappa: VTK XML PolyData. */
    RHEO_EXPORT_SPRINGS,
    /** Balls as spheres, walls as squares, vibrators as points and obstacles as triangles: VTK XML PolyData. */
    RHEO_EXPORT_SOLIDS,
    /** Surface, with normals and the values of `colour`: VTK XML PolyData. */
    RHEO_EXPORT_SURFACE,
} rheo_export_format;

/** Name of a format: "vtp", "springs", ...; NULL past the last. */
RHEO_API const char *rheo_export_format_name(uint32_t format);
/** Ending of its files, which is the name, but "vtp" for springs, solids and surface; NULL past the last format. */
RHEO_API const char *rheo_export_format_ending(uint32_t format);
/** Whether a format contains the surface; the others contain particles, springs or solids. False past the last. */
RHEO_API bool rheo_export_has_surface(rheo_export_format format);

/** Region and temperatures of a picture. All pictures of a film use one. */
typedef struct rheo_extent {
    /** Lower corner of a box. Unit L. */
    double min[3];
    /** Upper corner of the box. Unit L. */
    double max[3];
    /** Temperature that is painted blue. Unit K. */
    double coldest;
    /** Temperature that is painted red. Unit K. */
    double hottest;
} rheo_extent;

/**
 * Box around particles and ball, and the range of temperatures (0 to 1 if there are none). A few particles far from
 * all others (six standard deviations) are ignored, and so is a ball that far away.
 */
RHEO_API rheo_extent rheo_world_extent(const rheo_world *world);
/** Smallest extent that contains both. */
RHEO_API rheo_extent rheo_extent_of_both(const rheo_extent *a, const rheo_extent *b);

/** Options of a file. */
typedef struct rheo_export_options {
    /** Options of its surface. */
    rheo_surface_options surface;
    /** Region for the camera and range of the temperatures; NULL: those of the world. */
    const rheo_extent *extent;
    /** Replace an existing file. */
    bool force;
    /**
     * The vertices of the surface have the values of this, interpolated by the kernel, and their colours: a quantity or a
     * field as in rheo_picture_options, of a vector the length; "none": no values. NULL, the default: the temperature in a
     * world with temperatures, painted from blue to red; else none.
     */
    const char *colour;
    /** Values with the first and the last colour of `colour`, as in rheo_picture_options. */
    const double *range;
    /**
     * Turns the axes so that z is up: (x, y, z) is written as (x, -z, y), which stays right-handed. Positions, velocities
     * and all other vectors, normals, spins, and the camera and lights of a scene are turned.
     */
    bool z_up;
} rheo_export_options;

/** Contents of a written file. */
typedef struct rheo_exported {
    /** Number of particles in the file; 0 in formats with the surface. */
    uint32_t particles;
    /** Number of vertices in the file; 0 in formats without the surface. */
    uint32_t vertices;
    /** Number of triangles in the file; 0 in formats without the surface. */
    uint32_t triangles;
    /** Particles left out of the surface, as in rheo_surface. */
    uint32_t left_out;
} rheo_exported;

/**
 * Writes a world to a file, under a temporary name that is renamed at the end. Numbers read back to the same bits, in
 * every locale. `exported` may be NULL. RHEO_ERROR_ARGUMENT if there is no such format, or if the file exists
 * (without `force`) or is no regular file; RHEO_ERROR_FILE if it cannot be written; otherwise as for
 * rheo_surface_make(). A link stays: the file that it leads to is replaced.
 */
RHEO_API rheo_result rheo_world_export(const rheo_world *world, rheo_export_format format, const char *path,
                                       const rheo_export_options *options, rheo_exported *exported,
                                       rheo_error *error);
/**
 * Writes a ParaView collection (.pvd) of `count` files, named relative to the folder of the collection, with their
 * times in T. RHEO_ERROR_ARGUMENT and RHEO_ERROR_FILE as for rheo_world_export(); RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_export_collection(const char *path, size_t count, const char *const *files,
                                            const double *times, bool force, rheo_error *error);

/**
 * Writes bytes that the caller made, such as an encoded picture, to a file in the same way. RHEO_ERROR_ARGUMENT and
 * RHEO_ERROR_FILE as for rheo_world_export(); RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_export_bytes(const char *path, const void *bytes, size_t size, bool force,
                                       rheo_error *error);

/* ---- Pictures ---- */

/** Pixels of a picture in each direction, at least and at most. */
enum {
    /** The least number of pixels. */
    RHEO_PICTURE_MIN = 16,
    /** The largest number of pixels. */
    RHEO_PICTURE_MAX = 4096
};

/** How the camera of a picture looks at its region. */
typedef struct rheo_camera {
    /** Direction in which it looks; its length does not count. Default (-0.42, -0.5, -1): from above, in front and right. */
    double direction[3];
    /** Point in the middle of the picture. Unit L. NULL, the default: the middle of the region. */
    const double *target;
    /** 1, the default: the picture contains the whole region; 2: everything is twice as large. Range 0.01 to 1000. */
    double zoom;
    /** Parallel lines stay parallel: the eye is 64 times as far away as usual. Default false. */
    bool parallel;
} rheo_camera;

/** The default camera. */
RHEO_API rheo_camera rheo_default_camera(void);

/** Options of a picture. */
typedef struct rheo_picture_options {
    /** Width. Unit pixels. Range RHEO_PICTURE_MIN to RHEO_PICTURE_MAX, default 1280. */
    uint32_t width;
    /** Height. Unit pixels. The same range, default 720. */
    uint32_t height;
    /** Region that the camera shows; NULL: that of the world. */
    const rheo_extent *extent;
    /**
     * The colours show this: a quantity (rheo_world_quantity()), a field with one number per particle, or the length of a
     * vector field. "none": one colour. NULL, the default: "temperature" in a world with temperatures, else "speed".
     */
    const char *colour;
    /**
     * Another state of the same particles. The colours then show the absolute difference of the two states. `colour` NULL
     * then means "position", so they show distances. NULL, the default: none.
     */
    const rheo_world *other;
    /** Values with the first and the last colour, ascending, within 1e30; NULL: rheo_world_colour_range(). */
    const double *range;
    /** Draws the free surface, with these options; NULL, the default: particles as spheres. */
    const rheo_surface_options *surface;
    /** Draws no colour scale, and writes no step and time. */
    bool without_captions;
    /** NULL: the default camera. */
    const rheo_camera *camera;
} rheo_picture_options;

/** Default options. */
RHEO_API rheo_picture_options rheo_default_picture_options(void);
/**
 * Draws a world: the fluid, the ball with its panels, walls whose unit normal has y > 0.5 as floors, and vibrators as
 * studs on the floor below them. `rgb` receives
 * 3 bytes for each pixel, red, green and blue in sRGB, row by row from the top. One world gives the same bytes on every
 * machine.
 *
 * RHEO_ERROR_ARGUMENT for an option out of range, a colour that a world does not have, or another number of particles
 * in `other`; RHEO_ERROR_MEMORY;
 * RHEO_ERROR_ENVIRONMENT; otherwise as for rheo_surface_make().
 */
RHEO_API rheo_result rheo_world_render(const rheo_world *world, const rheo_picture_options *options,
                                       unsigned char *rgb, rheo_error *error);
/**
 * A range for the colours: all finite values of `colour`, or of its difference from `other`, without the smallest and the
 * largest hundredth, so that a few particles do not take all colours. If no others differ, all values; 0 and 1 if there
 * are none. Errors as for rheo_world_render().
 */
RHEO_API rheo_result rheo_world_colour_range(const rheo_world *world, const rheo_picture_options *options,
                                             double range[2], rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
