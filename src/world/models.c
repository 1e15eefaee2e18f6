/* The list of models. A model's number (rheo_model) is its index here; recordings store it, so new models go last. */
#include "world/model.h"

/* A test builds the library with more models: -D'RHEO__MORE_MODELS(X)=X(name)'. */
#ifndef RHEO__MORE_MODELS
#define RHEO__MORE_MODELS(X)
#endif
#define RHEO__MODELS(X) X(thickening) X(melting) RHEO__MORE_MODELS(X)

#define X(name) extern const rheo__model_type rheo__model_##name;
RHEO__MODELS(X)
#undef X

static const rheo__model_type *const list[] = {
#define X(name) &rheo__model_##name,
    RHEO__MODELS(X)
#undef X
};
enum { COUNT = sizeof list / sizeof *list };

const rheo__model_type *rheo__model(rheo_model model)
{
    return (uint32_t)model < COUNT ? list[model] : NULL;
}

uint32_t rheo_model_count(void)
{
    return COUNT;
}

const char *rheo_model_name(rheo_model model)
{
    return (uint32_t)model < COUNT ? list[model]->name : NULL;
}
