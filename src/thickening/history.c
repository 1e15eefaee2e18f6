/* Stage history: the velocity at the end of the step becomes lag 0 of the ring (docs/model.md, 9). */
#include "thickening/thickening.h"

rheo_result rheo_stage_history(rheo_state *s, void *context)
{
    (void)context;
    rheo_ring_push(&s->ring, s->particles, s->velocity);
    if (*s->history_rows < s->ring.length)
        ++*s->history_rows;
    return RHEO_OK;
}
