/*
 * A stage: a name, a function over the state, and the fields it writes. A stage reads the state and arrays that
 * earlier stages of the same step derived; it leaves every field in the order of ids. Only the loop over the
 * stages (world/step.c) takes times and hashes and handles failures.
 */
#ifndef RHEO__CORE_STAGE_H
#define RHEO__CORE_STAGE_H

#include "core/simd.h"
#include "core/state.h"

/* Returns RHEO_OK, RHEO_ERROR_MEMORY, or RHEO_ERROR_STATE with state->refusal if the step cannot be made. */
typedef rheo_result rheo__stage_function(rheo__state *state, void *context);

/*
 * Arrays that a stage derives for later stages of the same step. They are not state, so a stage must not read one
 * that no earlier stage of the list derives.
 */
#define RHEO__DERIVED_ARRAYS(X)                               \
    X(pairs)      /* within the support, in rank order */     \
    X(rows)       /* all neighbours of each particle */       \
    X(derivative) /* D^q x */                                 \
    X(stiffness)  /* K of pairs */                            \
    X(pressures)                                              \
    X(wall_friction)                                          \
    X(substep)         /* duration of a substep */            \
    X(contacts)        /* of particles with walls */          \
    X(ranked_velocity) /* velocities and densities by rank */ \
    X(ranked_temperature)                                     \
    X(gradients)  /* shear rates and factors of pairs */      \
    X(rates)      /* of density, temperature and position */  \
    X(multiplier) /* of particles, by history */

typedef enum rheo__derived_array {
#define X(name) RHEO__DERIVED_##name,
    RHEO__DERIVED_ARRAYS(X)
#undef X
        RHEO__DERIVED_COUNT
} rheo__derived_array;

#define RHEO__DERIVED(name) (UINT32_C(1) << RHEO__DERIVED_##name)
_Static_assert(RHEO__DERIVED_COUNT <= 32, "sets of derived arrays are 32-bit masks");

typedef struct rheo__stage {
    const char *name;
    rheo__stage_function *run;
    void *context; /* of the stage's folder */
    rheo__fields writes;
    uint32_t reads;   /* set of derived arrays */
    uint32_t derives; /* set of derived arrays */
} rheo__stage;

/* Fields that cannot be undone. The stage that writes them is the last of the list and runs once. */
#define RHEO__HISTORY (RHEO__RING_FIELDS | RHEO__BIT(history_modes))

/* The first stage that reads an array derived by no earlier one; `count` if there is none. */
static inline uint32_t rheo__stages_first_premature(const rheo__stage *stage, uint32_t count)
{
    uint32_t derived = 0, index = 0;
    for (; index < count && !(stage[index].reads & ~derived); index++)
        derived |= stage[index].derives;
    return index;
}

/*
 * For the rows of a model's stages.def. The model's header declares the stages; a SIMD stage has variants too. One
 * file of the model defines each SIMD stage as a call of the variant in use. The row END_SUBSTEPS() is no stage: it
 * calls rheo__world_end_substeps() in the list of a world, and nothing elsewhere.
 */
#define RHEO__DECLARE_STAGE(name) rheo__stage_function rheo__stage_##name;
#define RHEO__DECLARE_SIMD_STAGE(name) \
    RHEO__DECLARE_STAGE(name)          \
    RHEO__DECLARE_VARIANTS(rheo__stage_function, stage_##name)
#define RHEO__DEFINE_SIMD_STAGE(name)                                                     \
    rheo_result rheo__stage_##name(rheo__state *s, void *context)                         \
    {                                                                                     \
        static rheo__stage_function *const variants[] = RHEO__ALL_VARIANTS(stage_##name); \
        if (s->account)                                                                   \
            return rheo__stage_##name##_account(s, context);                              \
        return variants[rheo__simd_in_use()](s, context);                                 \
    }

#endif
