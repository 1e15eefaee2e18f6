/*
 * The list of models. A model's number (rheo_model) is its index here; recordings store it, so new models go last.
 * The first model is the default.
 */
#ifndef RHEO__WORLD_MODEL_LIST_H
#define RHEO__WORLD_MODEL_LIST_H

#include "rheolog/world.h"

/* A test builds the library with more models: -D'RHEO__MORE_MODELS(X)=X(name)'. */
#ifndef RHEO__MORE_MODELS
#define RHEO__MORE_MODELS(X)
#endif
#define RHEO__MODELS(X) X(thickening) X(melting) RHEO__MORE_MODELS(X)

#define X(name) RHEO__INDEX_##name,
enum { RHEO__MODELS(X) };
#undef X
_Static_assert((int)RHEO__INDEX_thickening == (int)RHEO_MODEL_THICKENING &&
                   (int)RHEO__INDEX_melting == (int)RHEO_MODEL_MELTING,
               "a rheo_model is an index of the list");

#define RHEO__DEFAULT_MODEL ((rheo_model)0)
/* Set of the models whose fluid can settle before step 0 (scenes/scene.c). */
#define RHEO__MODELS_THAT_SETTLE (UINT32_C(1) << RHEO_MODEL_THICKENING)

#endif
