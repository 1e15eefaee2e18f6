/* The parameters of the thickening model. */
#include "world/model_thickening.h"
#include "world/row_macros.h"

#define OWNER rheo_world_def
#define SCENE_ONLY false
#define MODELS (UINT32_C(1) << RHEO_MODEL_THICKENING)
static const rheo__parameter_row ROWS[] = {
#include "thickening/parameters.def"
};

#undef REAL
#undef INTEGER
#undef VECTOR
#undef WINDOW
#undef CHOICE
#undef OLD_NAME
#define REAL(...)
#define INTEGER(...)
#define VECTOR(...)
#define WINDOW(...)
#define CHOICE(...)
#define OLD_NAME(old, now) {#old, #now},
static const rheo__old_name OLD_NAMES[] = {
#include "thickening/parameters.def"
};

const rheo__parameter_rows rheo__thickening_parameters = {
    .row = ROWS,
    .count = sizeof ROWS / sizeof *ROWS,
    .old_name = OLD_NAMES,
    .old_name_count = sizeof OLD_NAMES / sizeof *OLD_NAMES,
};
