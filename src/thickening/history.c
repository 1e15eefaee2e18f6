/*
 * Stage history: the velocity at the end of the step, or with history.of length the position, becomes the newest of the
 * memory, lag 0 of a ring (docs/model.md, 9). The newest velocity that counted until now enters the sums of a memory of modes
 * (history_modes.c).
 */
#include "thickening/thickening.h"

rheo_result rheo__stage_history(rheo__state *s, void *context)
{
    const uint64_t rows = *s->history_rows, more = rheo__rows_after(s, rows);
    if (!rheo__thickening_remember(context, s, more))
        return RHEO_ERROR_MEMORY;
    rheo__remember(s, context, rows);
    *s->history_rows = more;
    return RHEO_OK;
}
