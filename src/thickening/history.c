/* Stage history: the velocity at the end of the step becomes lag 0 of the ring (docs/model.md, 9). */
#include "thickening/thickening.h"

rheo_result rheo_stage_history(rheo_state *s, void *context)
{
    const uint32_t rows = (uint32_t)*s->history_rows, more = rows < s->ring.length ? rows + 1 : rows;
    if (!rheo_thickening_remember(context, s, more))
        return RHEO_ERROR_MEMORY;
    rheo_ring_push(&s->ring, s->particles, s->velocity);
    *s->history_rows = more;
    return RHEO_OK;
}
