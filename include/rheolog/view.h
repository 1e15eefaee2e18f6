/*
 * Looking at worlds: the free surface of a fluid as a triangle mesh, and files for ParaView, renderers and tables.
 * Nothing here changes a world. The same world gives the same bytes on any machine. docs/pictures.md shows the use.
 */
#ifndef RHEOLOG_VIEW_H
#define RHEOLOG_VIEW_H

#include "rheolog/world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- The free surface ---- */

/** How a surface is made. */
typedef struct rheo_surface_options {
    double isovalue;   /**< of chi, between 0 and 1, both excluded; 0.5: half of what there is inside of a fluid */
    double resolution; /**< cells of the grid in a smoothing length; 0.5..8; 2. Triangles go by its square */
} rheo_surface_options;

/** 0.5 and 2. */
RHEO_API rheo_surface_options rheo_default_surface_options(void);

/** Particles that have a surface. */
typedef struct rheo_surface_particles {
    uint32_t count;
    const rheo_real *position; /**< count x 3, L, finite */
    const rheo_real *volume;   /**< count, L^3, >= 0: mass/density; NULL: spacing^3 each */
    const rheo_real *value;    /**< count, finite: what vertices shall have too, a temperature say; NULL: nothing */
    double spacing;            /**< L, > 0; of no account where volumes are given */
    double smoothing_length;   /**< h of the kernel, whose support is 3 h, L; > 0 */
} rheo_surface_particles;

/**
 * A closed surface: every edge is run through by two triangles, once in each direction. Seen from outside the fluid,
 * the vertices of a triangle are anticlockwise. No vertices and no triangles where no fluid is dense enough.
 */
typedef struct rheo_surface {
    uint32_t vertices, triangles;
    float *position;    /**< vertices x 3, L */
    float *normal;      /**< vertices x 3: unit vectors out of the fluid, from the gradient of chi */
    float *value;       /**< vertices: mean of the particles' values, by their parts in chi; NULL if they have none */
    uint32_t *triangle; /**< triangles x 3 vertices */
    uint32_t left_out;  /**< particles so far out that a float cannot tell the cells there: 2^23 from the origin */
    rheo_allocator allocator;
} rheo_surface;

/**
 * The surface where chi(x) = sum over particles of volume W(x - x_j, h) is the isovalue; W is the quintic spline. chi
 * is 1 inside of a fluid and falls to 0 outside; a particle alone comes to 0.18 where h is the spacing. Memory goes
 * by the space that fluid is in, wherever it is. RHEO_ERROR_ARGUMENT for an option out of its range, values that are
 * not finite, a negative volume; RHEO_ERROR_UNSUPPORTED for more than 2^31 - 1 vertices or triangles;
 * RHEO_ERROR_MEMORY; RHEO_ERROR_ENVIRONMENT. *surface is then empty. `allocator` may be NULL.
 */
RHEO_API rheo_result rheo_surface_make(const rheo_surface_particles *particles, const rheo_surface_options *options,
                                       const rheo_allocator *allocator, rheo_surface *surface, rheo_error *error);
/**
 * The same of a world. Volumes are mass/density where it has a density (melting) and spacing^3 where it has not; h is
 * the smoothing length of melting, or the spacing; the values are temperatures, if it has them.
 */
RHEO_API rheo_result rheo_world_surface(const rheo_world *world, const rheo_surface_options *options,
                                        const rheo_allocator *allocator, rheo_surface *surface, rheo_error *error);
/** Releases the arrays; one that is all zero is allowed. */
RHEO_API void rheo_surface_release(rheo_surface *surface);

/* ---- Files ---- */

typedef enum rheo_export_format {
    RHEO_EXPORT_VTP = 0, /**< particles with all that they have, for ParaView: VTK XML PolyData */
    RHEO_EXPORT_PLY,     /**< the surface, binary: vertices, normals, temperatures and their colours */
    RHEO_EXPORT_OBJ,     /**< the surface as text: vertices and normals */
    RHEO_EXPORT_POV,     /**< a scene for POV-Ray: surface, ball, floor, light and camera */
    RHEO_EXPORT_CSV,     /**< particles with all that they have, a line each */
} rheo_export_format;

/** "vtp", "ply", ...: the name of a format and how its files end; NULL past the last. */
RHEO_API const char *rheo_export_format_name(uint32_t format);
/** Whether it shows the surface, or the particles. */
RHEO_API bool rheo_export_has_surface(rheo_export_format format);

/** What a picture shows, so that all pictures of a film can show the same. */
typedef struct rheo_extent {
    double min[3], max[3];   /**< a box, L */
    double coldest, hottest; /**< K: what is painted blue and red */
} rheo_extent;

/**
 * The box around particles and ball, and the range of temperatures (0 and 1 if there are none). A few particles that
 * are far from all others (six standard deviations) do not count, nor does a ball that far out.
 */
RHEO_API rheo_extent rheo_world_extent(const rheo_world *world);
/** The smallest that holds both. */
RHEO_API rheo_extent rheo_extent_of_both(const rheo_extent *a, const rheo_extent *b);

typedef struct rheo_export_options {
    rheo_surface_options surface;
    const rheo_extent *extent; /**< of camera and colours; NULL: of the world itself */
    bool force;                /**< replace an existing file */
} rheo_export_options;

/** What was written. */
typedef struct rheo_exported {
    uint32_t particles, vertices,
        triangles;     /**< those in the file: of surfaces no particles, of particles no others */
    uint32_t left_out; /**< as in rheo_surface */
} rheo_exported;

/**
 * Writes a world as it is to a file, beside it and renamed. Numbers are written such that they read back to the same
 * bits, in every locale. RHEO_ERROR_FILE if it exists (without force) or cannot be written; else as
 * rheo_surface_make(). `exported` may be NULL.
 */
RHEO_API rheo_result rheo_world_export(const rheo_world *world, rheo_export_format format, const char *path,
                                       const rheo_export_options *options, rheo_exported *exported,
                                       rheo_error *error);
/** Writes a ParaView collection (.pvd): `count` files, named as seen from its folder, and their times. */
RHEO_API rheo_result rheo_export_collection(const char *path, size_t count, const char *const *files,
                                            const double *times, bool force, rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
