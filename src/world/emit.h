/* Emission at the beginning of a step. */
#ifndef RHEO__WORLD_EMIT_H
#define RHEO__WORLD_EMIT_H

#include "world/world.h"

/* Adds the layers that are due; world->emission takes them back. RHEO_ERROR_MEMORY: nothing has changed. */
rheo_result rheo__emit(rheo_world *world, rheo_error *error);
/* Takes back what the current step emitted. */
void rheo__take_emission_back(rheo_world *world);

#endif
