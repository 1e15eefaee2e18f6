/*
 * The parts of making a world from a scene: warnings about its particles and parameters, settling, and the place of
 * the ball.
 */
#ifndef RHEO__SCENES_MAKING_H
#define RHEO__SCENES_MAKING_H

#include "scenes/fill.h"
#include "world/measure.h"
#include "world/model.h"

/* ---- Warnings ---- */

/* Takes warnings: keeps them in a list, passes them on to a log, and keeps the first reason to refuse the scene. */
typedef struct rheo__warnings {
    rheo_warning *list;
    size_t capacity, count; /* count: of all */
    rheo_log log;
    bool refusals_only; /* nobody reads the others: those that take long and refuse nothing are not looked for */
    char refusal[sizeof((rheo_warning *)NULL)->text]; /* "": none */
} rheo__warnings;

/* A warning about nothing in particular, for initialisers. */
rheo_warning rheo__warning_of(rheo_warning_kind kind);
/* Takes a warning with this text. */
void rheo__warn(rheo__warnings *warnings, rheo_warning warning, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* RHEO_ERROR_ARGUMENT if a warning refuses the scene. */
rheo_result rheo__refuse(const rheo__warnings *warnings, rheo_error *error);

/*
 * Examines parameters, shapes and walls, and the balls at them. The particles of *def are those of the filling, not yet
 * settled. RHEO_ERROR_MEMORY.
 */
rheo_result rheo__check_filled(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings,
                               rheo_error *error);
/* The part of it that concerns the distances of particles (scenes/overlap.c). */
rheo_result rheo__check_overlaps(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings,
                                 rheo_error *error);
/* The part of it that compares the density with that at rest (scenes/crowding.c). */
void rheo__check_crowding(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings);
/* Examines balls at their places (scenes/check_balls.c): their size and the walls; then particles of *def, and other balls. */
void rheo__check_balls_at_walls(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings);
void rheo__check_balls(const rheo__filling *filling, const rheo_world_def *def, rheo__warnings *warnings);
/* The part of it that concerns emitters (scenes/check_emitters.c). */
void rheo__check_emitters(const rheo_world_def *def, rheo__warnings *warnings);

/* Speed with which the fastest ball arrives at the fluid, after its fall; 0 without a ball (scenes/preflight.c). */
double rheo__arrival_speed(const rheo__filling *filling, const rheo_world_def *def);

/* ---- Advice (scenes/cure.c) ---- */

/* rheo__condition_of() for a scene, whose definition is *def, with only the advice that helps this scene. */
bool rheo__condition_of_scene(const rheo_scene *scene, const rheo_world_def *def, rheo__known_speeds speeds,
                              uint32_t row, rheo__condition *condition);
/* Whether the scene can be made with `set`, "step=0.01", as well. */
bool rheo__scene_bears(const rheo_scene *scene, const char *set);

/* ---- Making ---- */

/* Clearance of the ball with this index. */
static inline double rheo__ball_clearance(const rheo_scene *scene, uint32_t index)
{
    return index ? scene->balls.clearance[index - 1] : scene->ball.clearance;
}
/* Distance from a wall, negative behind it. n: its unit normal. */
double rheo__wall_distance(const rheo_wall *wall, const double x[3], double n[3]);

/* Checks all parameters, and sets *def to the definition at the scene's resolution. */
rheo_result rheo__scene_check_parameters(const rheo_scene *scene, rheo_world_def *def, rheo_error *error);

/* Lets the particles of *def settle; *settled is their world. Warns of a settling that blew up or did not end. */
rheo_result rheo__settle(const rheo_scene *scene, const rheo_world_def *def, rheo__warnings *warnings,
                         rheo_world **settled, rheo_error *error);
/*
 * Sets the heights of balls above the particles of *def, if the scene gives their clearance, and their number density,
 * if the definition gives none.
 */
rheo_result rheo__place_balls(const rheo_scene *scene, const rheo_allocator *allocator, rheo_world_def *def,
                              rheo_error *error);

#endif
