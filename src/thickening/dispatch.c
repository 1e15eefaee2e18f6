/* Calls of SIMD functions, passed on to the variant in use (core/stage.h). */
#include "thickening/thickening.h"

#define STAGE(...)
#define SIMD_STAGE(name, function, ...) RHEO__DEFINE_SIMD_STAGE(function)
#define SOLIDS_STAGE(...)
#define END_SUBSTEPS()
#include "thickening/stages.def"

void rheo__remember(rheo__state *s, const rheo__thickening *t, uint64_t rows)
{
    static rheo__remember_function *const variants[] = RHEO__ALL_VARIANTS(remember_modes);
    if (t->def->history.kind != RHEO_HISTORY_WINDOW)
        variants[rheo__simd_in_use()](s, t, rows);
    if (s->ring.length)
        rheo__ring_push(&s->ring, s->particles, rheo__history_of_lengths(t->def) ? s->position : s->velocity);
    else
        rheo__ring_write(&s->modes, s->particles, 0, s->velocity);
}
