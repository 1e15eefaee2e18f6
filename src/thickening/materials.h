/*
 * The materials of a world (docs/model.md, Materials). Material 0 has the parameters springs.* and history.* of the
 * definition. A spring between two materials has the means of their parameters.
 */
#ifndef RHEO__THICKENING_MATERIALS_H
#define RHEO__THICKENING_MATERIALS_H

#include "rheolog/world.h"

/* A material by its number, with all its own parameters: those that it inherits are those of the main one. */
rheo_material rheo__material_of(const rheo_world_def *def, uint32_t number);
/* For each of their parameters the largest of all materials. */
rheo_material rheo__largest_of_materials(const rheo_world_def *def);

/* The parameters of a material in the number type of the state. */
typedef struct rheo__material {
    rheo_real k_min, plasticity, yield, k_hist, onset;
} rheo__material;

enum { RHEO__MATERIALS = RHEO_MAX_MATERIALS + 1 };

void rheo__materials_make(rheo__material materials[RHEO__MATERIALS], const rheo_world_def *def);

#endif
