/*
 * Commands in a recording: one INPT chunk for each, before the STEP that follows them. A command that adds many
 * particles is divided into several; the result is the same, since ids continue.
 */
#include <stdlib.h>

#include "record/recording.h"

enum { MOST_PARTICLES = RHEO__PIECE / (6 * sizeof(rheo_real)) };

static rheo_result write_input(rheo__writer *writer, uint64_t step, rheo__bytes *bytes, uint32_t *chunks,
                               rheo_error *error)
{
    rheo_result result = rheo__chunk_write(writer, RHEO__INPT, step, bytes, true, error);
    rheo__bytes_release(bytes);
    ++*chunks;
    return result;
}

static void put3(rheo__bytes *bytes, const double v[3])
{
    for (int axis = 0; axis < 3; axis++)
        rheo__put_f64(bytes, v[axis]);
}

rheo_result rheo__command_write(rheo__writer *writer, uint64_t step, const rheo__command *command, uint32_t *chunks,
                                rheo_error *error)
{
    rheo__bytes bytes = {0};
    if (command->kind == RHEO__COMMAND_ADD_PARTICLES) {
        for (size_t first = 0; first < command->count; first += MOST_PARTICLES) {
            size_t left = command->count - first, count = left < MOST_PARTICLES ? left : MOST_PARTICLES;
            rheo__put_u32(&bytes, (uint32_t)command->kind);
            rheo__put_u32(&bytes, (uint32_t)count);
            rheo__put_planes(&bytes, command->position + 3 * first, 3 * count, sizeof(rheo_real));
            rheo__put_planes(&bytes, command->velocity + 3 * first, 3 * count, sizeof(rheo_real));
            RHEO__TRY(write_input(writer, step, &bytes, chunks, error));
        }
        return RHEO_OK;
    }
    rheo__put_u32(&bytes, (uint32_t)command->kind);
    switch (command->kind) {
    case RHEO__COMMAND_SET:
        rheo__put_text(&bytes, command->path);
        rheo__put_text(&bytes, command->value);
        break;
    case RHEO__COMMAND_PUSH_BODY:
        rheo__put_u32(&bytes, command->index);
        rheo__put_u32(&bytes, command->has_point);
        put3(&bytes, command->vector);
        if (command->has_point)
            put3(&bytes, command->point);
        break;
    case RHEO__COMMAND_MOVE_VIBRATOR:
        rheo__put_u32(&bytes, command->index);
        rheo__put_f64(&bytes, command->vector[0]);
        rheo__put_f64(&bytes, command->vector[1]);
        break;
    case RHEO__COMMAND_ADD_PARTICLES:
        break;
    }
    return write_input(writer, step, &bytes, chunks, error);
}

static void get3(rheo__cursor *cursor, double v[3])
{
    for (int axis = 0; axis < 3; axis++)
        v[axis] = rheo__get_f64(cursor);
}

static void get_command(rheo__cursor *cursor, rheo__command *c)
{
    c->kind = (rheo__command_kind)rheo__get_u32(cursor);
    switch (c->kind) {
    case RHEO__COMMAND_SET:
        rheo__get_text(cursor, c->path, sizeof c->path);
        rheo__get_text(cursor, c->value, sizeof c->value);
        return;
    case RHEO__COMMAND_PUSH_BODY:
        c->index = rheo__get_u32(cursor);
        c->has_point = rheo__get_u32(cursor);
        get3(cursor, c->vector);
        if (c->has_point)
            get3(cursor, c->point);
        return;
    case RHEO__COMMAND_MOVE_VIBRATOR:
        c->index = rheo__get_u32(cursor);
        c->vector[0] = rheo__get_f64(cursor);
        c->vector[1] = rheo__get_f64(cursor);
        return;
    case RHEO__COMMAND_ADD_PARTICLES:
        c->count = rheo__get_u32(cursor);
        if (c->count > rheo__cursor_left(cursor) / (6 * sizeof(rheo_real)))
            break;
        size_t values = 3 * (size_t)c->count;
        c->position = malloc(values * sizeof *c->position + 1);
        c->velocity = malloc(values * sizeof *c->velocity + 1);
        if (c->position && c->velocity) {
            rheo__get_planes(cursor, c->position, values, sizeof *c->position);
            rheo__get_planes(cursor, c->velocity, values, sizeof *c->velocity);
        }
        return;
    }
    cursor->failed = true;
}

rheo_result rheo__command_apply(rheo__cursor *cursor, rheo_world *world, rheo_error *error)
{
    rheo__command c = {0};
    rheo_error why;
    rheo_result result;
    unsigned long long step = rheo_world_step_count(world) + 1;
    get_command(cursor, &c);
    if (cursor->failed || rheo__cursor_left(cursor))
        result = rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu cannot be read", step);
    else if (c.kind == RHEO__COMMAND_ADD_PARTICLES && (!c.position || !c.velocity))
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a command before step %llu", step);
    else if ((result = rheo__world_command(world, &c, &why)) != RHEO_OK)
        result = rheo__fail(error, result == RHEO_ERROR_MEMORY ? result : RHEO_ERROR_FORMAT,
                            "a command recorded before step %llu cannot be given again: %.400s", step, why.message);
    free(c.position);
    free(c.velocity);
    return result;
}

rheo_result rheo__command_define(rheo__cursor *cursor, uint64_t step, rheo_world_def *def, bool *moves,
                                 rheo_error *error)
{
    rheo__command c = {0};
    get_command(cursor, &c);
    free(c.position);
    free(c.velocity);
    if (cursor->failed || rheo__cursor_left(cursor))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu cannot be read",
                          (unsigned long long)step);
    *moves = *moves || c.kind == RHEO__COMMAND_ADD_PARTICLES;
    if (c.kind == RHEO__COMMAND_SET)
        return rheo_world_def_set(def, c.path, c.value, error) == RHEO_OK
                   ? RHEO_OK
                   : rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu sets %s to %.60s",
                                (unsigned long long)step, c.path, c.value);
    return RHEO_OK;
}
