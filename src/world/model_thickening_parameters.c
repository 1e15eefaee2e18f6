/* The parameters of the thickening model. */
#include "world/model_thickening.h"
#include "world/row_macros.h"

#define OWNER rheo_world_def
#define SCENE_ONLY false
#define MODELS (UINT32_C(1) << RHEO_MODEL_THICKENING)
static const rheo__parameter_row ROWS[] = {
#include "thickening/parameters.def"
};

const rheo__parameter_rows rheo__thickening_parameters = {
    .row = ROWS,
    .count = sizeof ROWS / sizeof *ROWS,
};
