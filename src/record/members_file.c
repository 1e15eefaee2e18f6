/* MEMB, the members in a golden recording (docs/format.md), and how they get there. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "record/members.h"
#include "record/replace.h"

rheo_result rheo__members_write(rheo__writer *writer, const rheo__members *m, rheo_error *error)
{
    rheo__bytes bytes = {0};
    rheo__put_text(&bytes, m->build);
    rheo__put_u64(&bytes, m->seed);
    rheo__put_f64(&bytes, m->moved);
    rheo__put_u32(&bytes, m->count);
    rheo__put_u32(&bytes, m->values);
    for (uint32_t i = 0; i < m->values; i++) {
        const rheo__member_value *v = &m->value[i];
        rheo__put_text(&bytes, v->metric);
        rheo__put_u32(&bytes, (uint32_t)v->kind);
        rheo__put_u64(&bytes, v->from);
        rheo__put_u64(&bytes, v->to);
        rheo__put_f64(&bytes, v->level);
        rheo__put_f64(&bytes, v->counts);
        for (uint32_t k = 0; k < m->count; k++)
            rheo__put_f64(&bytes, m->result[i * (size_t)m->count + k]);
    }
    rheo_result result = rheo__chunk_write(writer, RHEO__MEMB, 0, &bytes, true, error);
    rheo__bytes_release(&bytes);
    return result;
}

/* A number that can be ranked. */
static bool is_number(double x)
{
    return x - x == 0;
}

static bool get_value(rheo__cursor *cursor, rheo__members *m, uint32_t i)
{
    rheo__member_value *v = &m->value[i];
    bool right = true;
    rheo__get_exact_text(cursor, v->metric, sizeof v->metric);
    const uint32_t kind = rheo__get_u32(cursor);
    v->kind = (rheo__member_kind)kind;
    v->from = rheo__get_u64(cursor);
    v->to = rheo__get_u64(cursor);
    v->level = rheo__get_f64(cursor);
    v->counts = rheo__get_f64(cursor);
    for (uint32_t k = 0; k < m->count; k++) {
        m->result[i * (size_t)m->count + k] = rheo__get_f64(cursor);
        right = right && is_number(m->result[i * (size_t)m->count + k]);
    }
    return right && !cursor->failed && kind < RHEO__MEMBER_KINDS && v->from < v->to && is_number(v->level) &&
           v->counts >= 0 && is_number(v->counts);
}

static rheo_result damaged(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: its members cannot be read");
}

rheo_result rheo__members_get(rheo__cursor *cursor, rheo__members **members, rheo_error *error)
{
    rheo__members m = {0};
    rheo__get_text(cursor, m.build, sizeof m.build);
    m.seed = rheo__get_u64(cursor);
    m.moved = rheo__get_f64(cursor);
    m.count = rheo__get_u32(cursor);
    m.values = rheo__get_u32(cursor);
    if (cursor->failed || m.count < RHEO_LEAST_SAME_MEMBERS || m.count > RHEO_MOST_SAME_MEMBERS ||
        m.values > RHEO__MEMBER_VALUES || !(m.moved >= 0 && m.moved <= 1))
        return damaged(error);
    m.value = calloc(m.values + (size_t)1, sizeof *m.value);
    m.result = calloc(m.values * (size_t)m.count + 1, sizeof *m.result);
    rheo__members *made = malloc(sizeof *made);
    bool right = m.value && m.result && made;
    rheo_result result =
        right ? RHEO_OK : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the members of the recording");
    for (uint32_t i = 0; right && i < m.values; i++)
        right = get_value(cursor, &m, i);
    if (result == RHEO_OK && (!right || rheo__cursor_left(cursor)))
        result = damaged(error);
    if (result == RHEO_OK) {
        *made = m;
        *members = made;
    } else {
        rheo__members_release(&m);
        free(made);
    }
    return result;
}

void rheo__members_destroy(rheo__members *members)
{
    if (members)
        rheo__members_release(members);
    free(members);
}

uint32_t rheo_recording_member_count(const rheo_recording *r)
{
    return r->members ? r->members->count : 0;
}

/* ---- Keeping them ---- */

typedef struct kept {
    rheo_recording *recording;
    const rheo__members *members;
    const char *path;
} kept;

/* The recording with these members in the place of those that it has. */
static rheo_result write_kept(rheo__writer *to, const void *user, rheo_error *error)
{
    const kept *k = user;
    rheo_recording *r = k->recording;
    const uint64_t start = r->members ? r->members_start : r->head_end, end = r->members ? r->members_end : start;
    RHEO__TRY(rheo__recording_copy(r, 0, start, to, error));
    RHEO__TRY(rheo__members_write(to, k->members, error));
    const uint64_t moved = to->written - end;
    rheo__keep_mode(k->path, to);
    RHEO__TRY(rheo__recording_copy(r, end, r->end, to, error));
    for (uint32_t i = 0; i < r->blessing_count; i++)
        RHEO__TRY(rheo__blessing_write(to, r->last_step, &r->blessings[i], error));
    return rheo__recording_copy_end(r, moved, to, error);
}

static rheo_result keep(const char *path, const rheo__found *found, uint32_t count, uint64_t seed, rheo_error *error)
{
    rheo_verification v;
    RHEO__TRY(rheo_verify(path, &v, error));
    if (v.verdict != RHEO_SAME)
        return rheo__fail(error, v.verdict == RHEO_DIFFERS ? RHEO_ERROR_DIFFERS : RHEO_ERROR_FORMAT,
                          "members must be of the program that made the recording, and this build does not verify "
                          "%.200s: %.240s",
                          path, v.message);
    rheo_recording *r;
    rheo_error why;
    RHEO__TRY(rheo_recording_open(path, &r, error));
    rheo__members members = {0};
    rheo_result result = rheo__in_file(path, rheo__members_make(r, count, seed, &members, &why), &why, error);
    if (result == RHEO_OK)
        result = rheo__write_beside(path, found, write_kept, &(kept){r, &members, path}, error);
    rheo__members_release(&members);
    rheo_recording_close(r);
    return result;
}

rheo_result rheo_same_keep_members(const char *path, uint32_t members, uint64_t seed, rheo_error *error)
{
    if (members < RHEO_LEAST_SAME_MEMBERS || members > RHEO_MOST_SAME_MEMBERS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "members is %u; it must be %d to %d", members,
                          RHEO_LEAST_SAME_MEMBERS, RHEO_MOST_SAME_MEMBERS);
    rheo__found found = {.file = fopen(path, "rb")};
    if (!found.file)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot read %.300s: %s", path, strerror(errno));
    rheo_result result = rheo__is_replaceable(path, error);
    if (result == RHEO_OK)
        result = keep(path, &found, members, seed, error);
    fclose(found.file);
    return result;
}
