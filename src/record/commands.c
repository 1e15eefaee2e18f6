/*
 * Commands in a recording: INPT chunks, one a command, before the STEP that they were given before. Many new
 * particles are cut into several commands, which comes to the same: ids follow on.
 */
#include <stdlib.h>

#include "record/recording.h"

enum { MOST_PARTICLES = RHEO_PIECE / (6 * sizeof(rheo_real)) };

static rheo_result write_input(rheo_writer *writer, uint64_t step, rheo_bytes *bytes, uint32_t *chunks,
                               rheo_error *error)
{
    rheo_result result = rheo_chunk_write(writer, RHEO_INPT, step, bytes, true, error);
    rheo_bytes_release(bytes);
    ++*chunks;
    return result;
}

static void put3(rheo_bytes *bytes, const double v[3])
{
    for (int axis = 0; axis < 3; axis++)
        rheo_put_f64(bytes, v[axis]);
}

rheo_result rheo_command_write(rheo_writer *writer, uint64_t step, const rheo_command *command, uint32_t *chunks,
                               rheo_error *error)
{
    rheo_bytes bytes = {0};
    if (command->kind == RHEO_COMMAND_ADD_PARTICLES) {
        for (size_t first = 0; first < command->count; first += MOST_PARTICLES) {
            size_t left = command->count - first, count = left < MOST_PARTICLES ? left : MOST_PARTICLES;
            rheo_put_u32(&bytes, (uint32_t)command->kind);
            rheo_put_u32(&bytes, (uint32_t)count);
            rheo_put_planes(&bytes, command->position + 3 * first, 3 * count, sizeof(rheo_real));
            rheo_put_planes(&bytes, command->velocity + 3 * first, 3 * count, sizeof(rheo_real));
            RHEO_TRY(write_input(writer, step, &bytes, chunks, error));
        }
        return RHEO_OK;
    }
    rheo_put_u32(&bytes, (uint32_t)command->kind);
    switch (command->kind) {
    case RHEO_COMMAND_SET:
        rheo_put_text(&bytes, command->path);
        rheo_put_text(&bytes, command->value);
        break;
    case RHEO_COMMAND_PUSH_BODY:
        rheo_put_u32(&bytes, command->index);
        rheo_put_u32(&bytes, command->has_point);
        put3(&bytes, command->vector);
        if (command->has_point)
            put3(&bytes, command->point);
        break;
    case RHEO_COMMAND_MOVE_SOURCE:
        rheo_put_u32(&bytes, command->index);
        rheo_put_f64(&bytes, command->vector[0]);
        rheo_put_f64(&bytes, command->vector[1]);
        break;
    case RHEO_COMMAND_ADD_PARTICLES:
        break;
    }
    return write_input(writer, step, &bytes, chunks, error);
}

static void get3(rheo_cursor *cursor, double v[3])
{
    for (int axis = 0; axis < 3; axis++)
        v[axis] = rheo_get_f64(cursor);
}

static void get_command(rheo_cursor *cursor, rheo_command *c)
{
    c->kind = (rheo_command_kind)rheo_get_u32(cursor);
    switch (c->kind) {
    case RHEO_COMMAND_SET:
        rheo_get_text(cursor, c->path, sizeof c->path);
        rheo_get_text(cursor, c->value, sizeof c->value);
        return;
    case RHEO_COMMAND_PUSH_BODY:
        c->index = rheo_get_u32(cursor);
        c->has_point = rheo_get_u32(cursor);
        get3(cursor, c->vector);
        if (c->has_point)
            get3(cursor, c->point);
        return;
    case RHEO_COMMAND_MOVE_SOURCE:
        c->index = rheo_get_u32(cursor);
        c->vector[0] = rheo_get_f64(cursor);
        c->vector[1] = rheo_get_f64(cursor);
        return;
    case RHEO_COMMAND_ADD_PARTICLES:
        c->count = rheo_get_u32(cursor);
        if (c->count > rheo_cursor_left(cursor) / (6 * sizeof(rheo_real)))
            break;
        size_t values = 3 * (size_t)c->count;
        c->position = malloc(values * sizeof *c->position + 1);
        c->velocity = malloc(values * sizeof *c->velocity + 1);
        if (c->position && c->velocity) {
            rheo_get_planes(cursor, c->position, values, sizeof *c->position);
            rheo_get_planes(cursor, c->velocity, values, sizeof *c->velocity);
        }
        return;
    }
    cursor->failed = true;
}

rheo_result rheo_command_apply(rheo_cursor *cursor, rheo_world *world, rheo_error *error)
{
    rheo_command c = {0};
    rheo_error why;
    rheo_result result;
    unsigned long long step = rheo_world_step_count(world) + 1;
    get_command(cursor, &c);
    if (cursor->failed || rheo_cursor_left(cursor))
        result = rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu cannot be read", step);
    else if (c.kind == RHEO_COMMAND_ADD_PARTICLES && (!c.position || !c.velocity))
        result = rheo_fail(error, RHEO_ERROR_MEMORY, "no memory for a command before step %llu", step);
    else if ((result = rheo_world_command(world, &c, &why)) != RHEO_OK)
        result = rheo_fail(error, result == RHEO_ERROR_MEMORY ? result : RHEO_ERROR_FORMAT,
                           "a command recorded before step %llu cannot be given again: %.400s", step, why.message);
    free(c.position);
    free(c.velocity);
    return result;
}

rheo_result rheo_command_define(rheo_cursor *cursor, uint64_t step, rheo_world_def *def, bool *moves,
                                rheo_error *error)
{
    rheo_command c = {0};
    get_command(cursor, &c);
    free(c.position);
    free(c.velocity);
    if (cursor->failed || rheo_cursor_left(cursor))
        return rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu cannot be read",
                         (unsigned long long)step);
    *moves = *moves || c.kind == RHEO_COMMAND_ADD_PARTICLES;
    if (c.kind == RHEO_COMMAND_SET)
        return rheo_world_def_set(def, c.path, c.value, error) == RHEO_OK
                   ? RHEO_OK
                   : rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu sets %s to %.60s",
                               (unsigned long long)step, c.path, c.value);
    return RHEO_OK;
}
