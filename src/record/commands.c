/*
 * Commands in a recording: one INPT chunk for each, before the STEP that follows them. A command that adds many
 * particles is divided into several; the result is the same, since ids continue.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
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
    if (command->kind == RHEO_COMMAND_ADD_PARTICLES) {
        for (size_t first = 0; first < command->count; first += MOST_PARTICLES) {
            size_t left = command->count - first, count = left < MOST_PARTICLES ? left : MOST_PARTICLES;
            rheo__put_u32(&bytes, (uint32_t)command->kind);
            rheo__put_u32(&bytes, (uint32_t)count);
            rheo__put_planes(&bytes, command->position + 3 * first, 3 * count, sizeof(rheo_real));
            rheo__put_planes(&bytes, command->velocity + 3 * first, 3 * count, sizeof(rheo_real));
            if (command->index) /* the main material is not named, as before there were others */
                rheo__put_u32(&bytes, command->index);
            RHEO__TRY(write_input(writer, step, &bytes, chunks, error));
        }
        return RHEO_OK;
    }
    rheo__put_u32(&bytes, (uint32_t)command->kind);
    switch (command->kind) {
    case RHEO_COMMAND_SET:
        rheo__put_text(&bytes, command->path);
        rheo__put_text(&bytes, command->value);
        break;
    case RHEO_COMMAND_PUSH_BODY:
        rheo__put_u32(&bytes, command->index);
        rheo__put_u32(&bytes, command->has_point);
        put3(&bytes, command->vector);
        if (command->has_point)
            put3(&bytes, command->point);
        break;
    case RHEO_COMMAND_MOVE_VIBRATOR:
        rheo__put_u32(&bytes, command->index);
        rheo__put_f64(&bytes, command->vector[0]);
        rheo__put_f64(&bytes, command->vector[1]);
        break;
    case RHEO_COMMAND_ADD_PARTICLES:
        break;
    }
    return write_input(writer, step, &bytes, chunks, error);
}

static void get3(rheo__cursor *cursor, double v[3])
{
    for (int axis = 0; axis < 3; axis++)
        v[axis] = rheo__get_f64(cursor);
}

/* Reads a command of a recording with reals of this size, which the positions and velocities have too. */
static void get_command(rheo__cursor *cursor, size_t real_bytes, rheo__command *c)
{
    c->kind = (rheo_command_kind)rheo__get_u32(cursor);
    switch (c->kind) {
    case RHEO_COMMAND_SET:
        rheo__get_exact_text(cursor, c->path, sizeof c->path);
        rheo__get_exact_text(cursor, c->value, sizeof c->value);
        return;
    case RHEO_COMMAND_PUSH_BODY:
        c->index = rheo__get_u32(cursor);
        c->has_point = rheo__get_u32(cursor);
        get3(cursor, c->vector);
        if (c->has_point)
            get3(cursor, c->point);
        return;
    case RHEO_COMMAND_MOVE_VIBRATOR:
        c->index = rheo__get_u32(cursor);
        c->vector[0] = rheo__get_f64(cursor);
        c->vector[1] = rheo__get_f64(cursor);
        return;
    case RHEO_COMMAND_ADD_PARTICLES:
        c->count = rheo__get_u32(cursor);
        if (c->count > rheo__cursor_left(cursor) / (6 * real_bytes))
            break;
        size_t values = 3 * (size_t)c->count;
        c->position = malloc(values * real_bytes + 1);
        c->velocity = malloc(values * real_bytes + 1);
        if (c->position && c->velocity) {
            rheo__get_planes(cursor, c->position, values, real_bytes);
            rheo__get_planes(cursor, c->velocity, values, real_bytes);
        }
        if (rheo__cursor_left(cursor))
            c->index = rheo__get_u32(cursor);
        return;
    }
    cursor->failed = true;
}

/* Whether particles of the command could not be read because there was no memory for them. */
static bool lacks_memory(const rheo__command *c, const rheo__cursor *cursor)
{
    return c->kind == RHEO_COMMAND_ADD_PARTICLES && !cursor->failed && (!c->position || !c->velocity);
}

rheo_result rheo__command_apply(rheo__cursor *cursor, rheo_world *world, rheo_error *error)
{
    rheo__command c = {0};
    rheo_error why;
    rheo_result result;
    unsigned long long step = rheo_world_step_count(world) + 1;
    get_command(cursor, sizeof(rheo_real), &c);
    if (lacks_memory(&c, cursor))
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a command before step %llu", step);
    else if (cursor->failed || rheo__cursor_left(cursor))
        result = rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu cannot be read", step);
    else if ((result = rheo__world_command(world, &c, &why)) != RHEO_OK)
        result = rheo__fail(error, result == RHEO_ERROR_MEMORY ? result : RHEO_ERROR_FORMAT,
                            "a command recorded before step %llu cannot be given again: %.400s", step, why.message);
    free(c.position);
    free(c.velocity);
    return result;
}

/* ---- In words ---- */

static double real_at(const void *values, size_t index, size_t real_bytes)
{
    float small;
    double large;
    if (real_bytes == sizeof large)
        memcpy(&large, (const char *)values + index * sizeof large, sizeof large);
    else
        memcpy(&small, (const char *)values + index * sizeof small, sizeof small);
    return real_bytes == sizeof large ? large : (double)small;
}

/* The box around the particles; all 0 if there are none. */
static void box_of(const rheo__command *c, size_t real_bytes, double min[3], double max[3])
{
    for (size_t i = 0; i < 3 * (size_t)c->count; i++) {
        const double x = real_at(c->position, i, real_bytes);
        min[i % 3] = i < 3 || x < min[i % 3] ? x : min[i % 3];
        max[i % 3] = i < 3 || x > max[i % 3] ? x : max[i % 3];
    }
}

/* Three numbers of at most 31 letters, two commas with blanks, and brackets. */
enum { VECTOR_TEXT = 3 * 31 + 6 + 1 };

static const char *vector_text(const double v[3], char text[VECTOR_TEXT])
{
    char number[3][32];
    for (int axis = 0; axis < 3; axis++)
        rheo__text_brief(v[axis], 6, false, number[axis]);
    snprintf(text, VECTOR_TEXT, "[%s, %s, %s]", number[0], number[1], number[2]);
    return text;
}

static void tell_particles(rheo_command *c)
{
    char min[VECTOR_TEXT], max[VECTOR_TEXT], of[32] = "";
    vector_text(c->min, min);
    vector_text(c->max, max);
    if (c->index)
        snprintf(of, sizeof of, " of material %u", c->index);
    if (c->count == 1)
        snprintf(c->text, sizeof c->text, "1 particle%s was added at %s", of, min);
    else if (c->count)
        snprintf(c->text, sizeof c->text, "%u particles%s were added between %s and %s", c->count, of, min, max);
    else
        snprintf(c->text, sizeof c->text, "0 particles were added");
}

static void tell(rheo_command *c)
{
    char vector[VECTOR_TEXT], point[VECTOR_TEXT], x[32], z[32], ball[24];
    switch (c->kind) {
    case RHEO_COMMAND_SET:
        snprintf(c->text, sizeof c->text, "%s was set to %s", c->path, c->value);
        return;
    case RHEO_COMMAND_PUSH_BODY:
        snprintf(ball, sizeof ball, c->index ? "ball %u" : "the ball", c->index + 1);
        snprintf(c->text, sizeof c->text, "%s was pushed by impulse %s%s%s", ball, vector_text(c->vector, vector),
                 c->has_point ? " at " : "", c->has_point ? vector_text(c->point, point) : "");
        return;
    case RHEO_COMMAND_ADD_PARTICLES:
        tell_particles(c);
        return;
    case RHEO_COMMAND_MOVE_VIBRATOR:
        snprintf(c->text, sizeof c->text, "vibrator %u was moved to x %s, z %s", c->index,
                 rheo__text_brief(c->vector[0], 6, false, x), rheo__text_brief(c->vector[1], 6, false, z));
        return;
    }
}

rheo_result rheo__command_describe(rheo__cursor *cursor, uint64_t step, size_t real_bytes, rheo_command *command,
                                   rheo_error *error)
{
    rheo__command c = {0};
    get_command(cursor, real_bytes, &c);
    rheo_result result = RHEO_OK;
    if (lacks_memory(&c, cursor))
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a command before step %llu",
                            (unsigned long long)step);
    else if (cursor->failed || rheo__cursor_left(cursor))
        result = rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu cannot be read",
                            (unsigned long long)step);
    if (result == RHEO_OK) {
        *command = (rheo_command){.step = step,
                                  .kind = c.kind,
                                  .index = c.index,
                                  .count = c.count,
                                  .vector = {c.vector[0], c.vector[1], c.vector[2]},
                                  .has_point = c.has_point,
                                  .point = {c.point[0], c.point[1], c.point[2]}};
        memcpy(command->path, c.path, sizeof command->path);
        memcpy(command->value, c.value, sizeof command->value);
        rheo__text_make_printable(command->path);
        rheo__text_make_printable(command->value);
        box_of(&c, real_bytes, command->min, command->max);
        tell(command);
    }
    free(c.position);
    free(c.velocity);
    return result;
}

/* ---- The commands of a recording ---- */

uint64_t rheo_recording_command_count(const rheo_recording *r)
{
    return r->command_count + r->failed.inputs;
}

/* Finds the step of a command; *first is the index of the first command of that step. */
static const rheo__step_chunks *step_of(const rheo_recording *r, uint64_t index, uint64_t *step, uint64_t *first)
{
    if (index >= r->command_count) {
        *step = r->failure.step;
        *first = r->command_count;
        return &r->failed;
    }
    size_t low = 0, high = r->commanded_count; /* commanded[low].first <= index < commanded[high].first */
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        *(r->commanded[middle].first <= index ? &low : &high) = middle;
    }
    *step = r->first_step + 1 + r->commanded[low].step;
    *first = r->commanded[low].first;
    return &r->steps[r->commanded[low].step];
}

rheo_result rheo_recording_command(rheo_recording *r, uint64_t index, rheo_command *command, rheo_error *error)
{
    if (index >= rheo_recording_command_count(r))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no command %llu in the recording; it has %llu",
                          (unsigned long long)index, (unsigned long long)rheo_recording_command_count(r));
    uint64_t step, first;
    const rheo__step_chunks *chunks = step_of(r, index, &step, &first);
    uint64_t offset = chunks->start;
    bool more;
    if (r->next_command == index && index > first) /* they are mostly read one after another */
        offset = r->next_offset;
    else
        for (uint64_t i = first; i < index; i++)
            RHEO__TRY(rheo__recording_next_command(r, chunks, step, &offset, &more, error));
    RHEO__TRY(rheo__recording_next_command(r, chunks, step, &offset, &more, error));
    if (!more)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu is missing",
                          (unsigned long long)step);
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    RHEO__TRY(rheo__command_describe(&cursor, step, r->head.real_bytes, command, error));
    r->next_command = index + 1;
    r->next_offset = offset;
    return RHEO_OK;
}
