/* The melting model of a world: for the files of this folder that know the model, and for tests. */
#ifndef RHEO__WORLD_MODEL_MELTING_H
#define RHEO__WORLD_MODEL_MELTING_H

#include "melting/melting.h"
#include "world/model.h"

/* Marks the features of this model's worlds; recordings store it. */
enum { RHEO__FEATURE_MELTING = 256 };

extern const rheo__model_type rheo__model_melting;

/* NULL if the world has another model. */
static inline rheo__melting *rheo__melting_of(const rheo_world *world)
{
    return world->type == &rheo__model_melting ? world->model : NULL;
}

#endif
