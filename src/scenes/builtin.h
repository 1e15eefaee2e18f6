/* Built-in scenes: a table for each model. builtin.c finds a scene in them. */
#ifndef RHEO__SCENES_BUILTIN_H
#define RHEO__SCENES_BUILTIN_H

#include "rheolog/scene.h"

typedef struct rheo__builtin {
    const char *name, *about;
    void (*make)(rheo_scene *scene); /* completes a default scene of the model */
} rheo__builtin;

typedef struct rheo__builtins {
    rheo_model model;
    const rheo__builtin *scene;
    size_t count;
} rheo__builtins;

extern const rheo__builtins rheo__builtin_thickening, rheo__builtin_melting;

#endif
