/*
 * A stage: a name, a function over the state, and the fields it writes. A stage reads the state and arrays that earlier
 * stages of the same step derived; it leaves every field in the order of ids. The loop over the stages (world/step.c)
 * alone does timing, hashing and failing.
 */
#ifndef RHEO__CORE_STAGE_H
#define RHEO__CORE_STAGE_H

#include "core/simd.h"
#include "core/state.h"

/* Returns RHEO_OK, RHEO_ERROR_MEMORY, or RHEO_ERROR_STATE with state->refusal if the step cannot be made. */
typedef rheo_result rheo__stage_function(rheo__state *state, void *context);

typedef struct rheo__stage {
    const char *name;
    rheo__stage_function *run;
    void *context;   /* of the stage's folder */
    uint32_t writes; /* set of fields */
} rheo__stage;

/*
 * SIMD stages. A model has one list of them, an X-macro of names: RHEO__DECLARE_SIMD_STAGE declares each stage and its
 * variants; RHEO__DEFINE_SIMD_STAGE, in one file, defines each stage as a call of the variant in use. To add one: write
 * its file, name it in the model's list, and add the file to simd_names in meson.build.
 */
#define RHEO__DECLARE_SIMD_STAGE(name)       \
    rheo__stage_function rheo__stage_##name; \
    RHEO__DECLARE_VARIANTS(rheo__stage_function, stage_##name)

#define RHEO__DEFINE_SIMD_STAGE(name)                                                     \
    rheo_result rheo__stage_##name(rheo__state *s, void *context)                         \
    {                                                                                     \
        static rheo__stage_function *const variants[] = RHEO__ALL_VARIANTS(stage_##name); \
        return variants[rheo__simd_in_use()](s, context);                                 \
    }

#endif
