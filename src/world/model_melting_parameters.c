/* The parameters of the melting model. */
#include "world/model_melting.h"
#include "world/row_macros.h"

#define OWNER rheo_world_def
#define SCENE_ONLY false
#define MODELS (UINT32_C(1) << RHEO_MODEL_MELTING)
static const rheo__parameter_row ROWS[] = {
#include "melting/parameters.def"
};

#undef REAL
#undef INTEGER
#undef CHOICE
#undef DEFAULT
#define REAL(...)
#define INTEGER(...)
#define CHOICE(...)
#define DEFAULT(member, ...) {#member, {__VA_ARGS__}},
static const rheo__parameter_default DEFAULTS[] = {
#include "melting/parameters.def"
};

#undef DEFAULT
#undef OLD_NAME
#define DEFAULT(...)
#define OLD_NAME(old, now) {#old, #now},
static const rheo__old_name OLD_NAMES[] = {
#include "melting/parameters.def"
};

const rheo__parameter_rows rheo__melting_parameters = {
    .row = ROWS,
    .count = sizeof ROWS / sizeof *ROWS,
    .other_default = DEFAULTS,
    .other_default_count = sizeof DEFAULTS / sizeof *DEFAULTS,
    .old_name = OLD_NAMES,
    .old_name_count = sizeof OLD_NAMES / sizeof *OLD_NAMES,
};
