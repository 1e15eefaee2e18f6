/* The commands since the last step: a recorder writes them before it writes the step. */
#ifndef RHEO__WORLD_COMMAND_QUEUE_H
#define RHEO__WORLD_COMMAND_QUEUE_H

#include "world/world.h"

/* Copies a command and its arrays to the end of the queue, without counting it yet. NULL: no memory. */
rheo__command *rheo__command_queue_prepare(rheo_world *world, const rheo__command *command);
/* Counts the prepared command, or drops it. */
void rheo__command_queue_commit(rheo_world *world);
void rheo__command_queue_drop(rheo_world *world);
/* Frees the queue. */
void rheo__command_queue_release(rheo_world *world);

#endif
