/* The thickening model of a world: for the files of this folder that know the model, and for tests. */
#ifndef RHEO__WORLD_MODEL_THICKENING_H
#define RHEO__WORLD_MODEL_THICKENING_H

#include "thickening/thickening.h"
#include "world/model.h"

extern const rheo__model_type rheo__model_thickening;

/* NULL if the world has another model. */
static inline rheo__thickening *rheo__thickening_of(const rheo_world *world)
{
    return world->type == &rheo__model_thickening ? world->model : NULL;
}

#endif
