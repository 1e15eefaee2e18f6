/* The types of the models, in the order of the list (world/model_list.h). */
#include "world/model_list.h"
#include "world/model.h"

#define X(name) extern const rheo__model_type rheo__model_##name;
RHEO__MODELS(X)
#undef X

static const rheo__model_type *const list[] = {
#define X(name) &rheo__model_##name,
    RHEO__MODELS(X)
#undef X
};
enum { COUNT = sizeof list / sizeof *list };

_Static_assert(COUNT <= 32, "sets of models are 32-bit masks");

const rheo__model_type *rheo__model(rheo_model model)
{
    return (uint32_t)model < COUNT ? list[model] : NULL;
}

const rheo__parameter_rows *rheo__model_parameters(rheo_model model)
{
    const rheo__model_type *type = rheo__model(model);
    return type ? type->parameters : NULL;
}

uint32_t rheo_model_count(void)
{
    return COUNT;
}

const char *rheo_model_name(rheo_model model)
{
    return (uint32_t)model < COUNT ? list[model]->name : NULL;
}
