/* Tells the caller how far a task of many steps is, and asks whether to go on. */
#ifndef RHEO__PROGRESS_H
#define RHEO__PROGRESS_H

#include "core/error.h"

/*
 * Calls the receiver of this thread, if there is one, after step `done` of `total` of a task. RHEO_ERROR_STOPPED if it
 * wants the task to end.
 */
rheo_result rheo__progress(const char *task, uint64_t done, uint64_t total, rheo_error *error);

#endif
