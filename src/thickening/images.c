/*
 * Images in periodic space (space/period.h, docs/model.md): what a pass over pairs reads of a partner is copied from a
 * particle to its images, at a position that is whole periods away. Images are read like particles, and written only
 * here.
 */
#include "thickening/thickening.h"

void rheo__images_of_points(rheo__thickening *t)
{
    const rheo__period *period = t->period;
    const rheo__pairs *p = t->pairs;
    if (!period->axes)
        return;
    for (uint32_t i = 0; i < p->rows; i++) {
        rheo__point *x = &t->point[i].at;
        x->x = period->length[0] > 0 ? rheo__period_round(x->x, period->limit[0]) : x->x;
        x->y = period->length[1] > 0 ? rheo__period_round(x->y, period->limit[1]) : x->y;
        x->z = period->length[2] > 0 ? rheo__period_round(x->z, period->limit[2]) : x->z;
    }
    rheo__wide_point *image = t->point + rheo__pairs_idle(p) + 1;
    for (uint32_t k = 0; k < p->images; k++) {
        const int8_t *shift = p->image[k].shift;
        image[k] = t->point[p->image[k].home];
        image[k].at.x += shift[0] * period->length[0];
        image[k].at.y += shift[1] * period->length[1];
        image[k].at.z += shift[2] * period->length[2];
    }
}

void rheo__images_of_pressures(rheo__thickening *t)
{
    const rheo__pairs *p = t->pairs;
    rheo__wide_point *image = t->point + rheo__pairs_idle(p) + 1;
    for (uint32_t k = 0; k < p->images; k++) {
        image[k].at.w = t->point[p->image[k].home].at.w;
        image[k].more = t->point[p->image[k].home].more;
    }
}

void rheo__images_of_vectors(const rheo__pairs *p, rheo__point *value)
{
    for (uint32_t k = 0; k < p->images; k++)
        value[rheo__pairs_idle(p) + 1 + k] = value[p->image[k].home];
}

void rheo__images_of_numbers(const rheo__pairs *p, rheo_real *value)
{
    for (uint32_t k = 0; k < p->images; k++)
        value[rheo__pairs_idle(p) + 1 + k] = value[p->image[k].home];
}
