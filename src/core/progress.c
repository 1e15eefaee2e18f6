/*
 * Progress of tasks of many steps. The receiver belongs to the thread, not to a world or recording, because tasks are
 * nested (blessing verifies, verifying reads), and some have neither yet (settling).
 */
#include "core/progress.h"

#include "core/strict.h"

static _Thread_local rheo_progress receiver;

rheo_progress rheo_use_progress(rheo_progress progress)
{
    const rheo_progress before = receiver;
    receiver = progress;
    return before;
}

rheo_result rheo__progress(const char *task, uint64_t done, uint64_t total, rheo_error *error)
{
    if (!receiver.report || receiver.report(task, done, total, receiver.user))
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_STOPPED, "stopped while %s: %llu of %llu done", task,
                      (unsigned long long)done, (unsigned long long)total);
}
