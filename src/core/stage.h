/*
 * A stage: a name, a function over the state, and the fields it writes. A stage reads the state and what earlier
 * stages of the same step derived, and leaves every field in the order of ids. The loop over the stages
 * (world/step.c) is the only place that knows about timing, hashing and failing.
 */
#ifndef RHEO__CORE_STAGE_H
#define RHEO__CORE_STAGE_H

#include "core/state.h"

typedef struct rheo__stage {
    const char *name;
    /* RHEO_OK, RHEO_ERROR_MEMORY, or RHEO_ERROR_STATE with state->refusal: the step cannot be made. */
    rheo_result (*run)(rheo__state *state, void *context);
    void *context;   /* of the stage's folder */
    uint32_t writes; /* set of fields */
} rheo__stage;

#endif
