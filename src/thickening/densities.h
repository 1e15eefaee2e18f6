/* Diagnostics of density, which all schemes have. */
#ifndef RHEO__THICKENING_DENSITIES_H
#define RHEO__THICKENING_DENSITIES_H

#include "thickening/thickening.h"

/* Four sums, so that additions do not wait for each other. */
static inline void rheo__note_densities(rheo__thickening *t)
{
    const rheo__pairs *pairs = t->pairs;
    const rheo_real rest_density = (rheo_real)t->def->fluid.rest_density;
    enum { SUMS = 4 };
    double above[SUMS] = {0};
    rheo_real largest = 0;
    uint32_t densest = pairs->rows;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        above[i % SUMS] += (double)rheo__max(t->density[i] - rest_density, 0);
        if (t->density[i] > largest) {
            largest = t->density[i];
            densest = i;
        }
    }
    double scale = rest_density > 0 ? 1 / (double)rest_density : 0;
    t->diagnostics.density_error =
        pairs->rows ? ((above[0] + above[1]) + (above[2] + above[3])) * scale / pairs->rows : 0;
    t->diagnostics.largest_density = (double)largest * scale;
    t->diagnostics.densest_particle = densest < pairs->rows ? (double)pairs->id_of[densest] : -1;
}

#endif
