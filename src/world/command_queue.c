/* The commands since the last step (world/command_queue.h). */
#include "world/command_queue.h"

#include <string.h>

static void release_command(rheo_world *w, rheo__command *c)
{
    rheo__release(&w->def.allocator, c->position);
    rheo__release(&w->def.allocator, c->velocity);
}

rheo__command *rheo__command_queue_prepare(rheo_world *w, const rheo__command *command)
{
    const rheo_allocator *allocator = &w->def.allocator;
    void *commands = w->command;
    if (!rheo__grow(allocator, &commands, &w->command_capacity, w->command_count + 1, w->command_count,
                    sizeof *w->command))
        return NULL;
    w->command = commands;
    rheo__command *copy = &w->command[w->command_count];
    *copy = *command;
    copy->position = copy->velocity = NULL;
    if (command->kind != RHEO_COMMAND_ADD_PARTICLES)
        return copy;
    const size_t values = 3 * (size_t)command->count;
    copy->position = rheo__allocate(allocator, values + 1, sizeof *copy->position);
    copy->velocity = rheo__allocate(allocator, values + 1, sizeof *copy->velocity);
    if (!copy->position || !copy->velocity) {
        release_command(w, copy);
        return NULL;
    }
    if (values)
        memcpy(copy->position, command->position, values * sizeof *copy->position);
    if (values && command->velocity)
        memcpy(copy->velocity, command->velocity, values * sizeof *copy->velocity);
    return copy;
}

void rheo__command_queue_commit(rheo_world *w)
{
    w->command_count++;
}

void rheo__command_queue_drop(rheo_world *w)
{
    release_command(w, &w->command[w->command_count]);
}

const rheo__command *rheo__world_commands(const rheo_world *w, size_t *count)
{
    *count = w->command_count;
    return w->command;
}

void rheo__world_forget_commands(rheo_world *w)
{
    for (size_t i = 0; i < w->command_count; i++)
        release_command(w, &w->command[i]);
    w->command_count = 0;
}

void rheo__command_queue_release(rheo_world *w)
{
    rheo__world_forget_commands(w);
    rheo__release(&w->def.allocator, w->command);
}
