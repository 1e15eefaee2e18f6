/* The materials of a world (thickening/materials.h). */
#include "thickening/materials.h"

#include "core/strict.h"

static double own_or_main(double own, double of_main)
{
    return own < 0 ? of_main : own;
}

rheo_material rheo__material_of(const rheo_world_def *def, uint32_t number)
{
    rheo_material m = {.springs = {-1, -1, -1}, .history = {-1, -1}};
    if (number > 0)
        m = def->materials.list[number - 1];
    m.springs.stiffness = own_or_main(m.springs.stiffness, def->springs.stiffness);
    m.springs.plasticity = own_or_main(m.springs.plasticity, def->springs.plasticity);
    m.springs.yield_ratio = own_or_main(m.springs.yield_ratio, def->springs.yield_ratio);
    m.history.stiffness = own_or_main(m.history.stiffness, def->history.stiffness);
    m.history.onset = own_or_main(m.history.onset, def->history.onset);
    return m;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

rheo_material rheo__largest_of_materials(const rheo_world_def *def)
{
    rheo_material most = rheo__material_of(def, 0);
    for (uint32_t k = 1; k <= def->materials.count; k++) {
        const rheo_material m = rheo__material_of(def, k);
        most.springs.stiffness = larger(most.springs.stiffness, m.springs.stiffness);
        most.springs.plasticity = larger(most.springs.plasticity, m.springs.plasticity);
        most.springs.yield_ratio = larger(most.springs.yield_ratio, m.springs.yield_ratio);
        most.history.stiffness = larger(most.history.stiffness, m.history.stiffness);
        most.history.onset = larger(most.history.onset, m.history.onset);
    }
    return most;
}

void rheo__materials_make(rheo__material materials[RHEO__MATERIALS], const rheo_world_def *def)
{
    for (uint32_t k = 0; k <= def->materials.count; k++) {
        const rheo_material m = rheo__material_of(def, k);
        materials[k] = (rheo__material){(rheo_real)m.springs.stiffness, (rheo_real)m.springs.plasticity,
                                        (rheo_real)m.springs.yield_ratio, (rheo_real)m.history.stiffness,
                                        (rheo_real)m.history.onset};
    }
}
