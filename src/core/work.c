/*
 * The work of this thread. The counts belong to the thread, not to a recording, because an answer may take several players
 * and recordings.
 */
#include "core/work.h"

#include "core/strict.h"
#include "rheolog/base.h"

static _Thread_local rheo_work work;

rheo_work rheo_work_done(void)
{
    return work;
}

void rheo__work_step(void)
{
    work.steps++;
}

void rheo__work_state(void)
{
    work.states++;
}
