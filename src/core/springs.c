/* Pairs and springs (core/springs.h). */
#include "core/springs.h"

#include <string.h>

bool rheo__pairs_reserve_rows(rheo__pairs *p, const rheo_allocator *allocator, uint32_t rows)
{
    if (rows <= p->row_capacity && p->start)
        return true;
    size_t wanted = rows + (size_t)rows / 4 + 1;
    uint32_t *id_of = rheo__allocate(allocator, wanted, sizeof *id_of);
    uint32_t *rank_of = rheo__allocate(allocator, wanted, sizeof *rank_of);
    uint32_t *start = rheo__allocate(allocator, wanted + 1, sizeof *start);
    if (!id_of || !rank_of || !start) {
        rheo__release(allocator, id_of);
        rheo__release(allocator, rank_of);
        rheo__release(allocator, start);
        return false;
    }
    if (p->rows) {
        memcpy(id_of, p->id_of, p->rows * sizeof *id_of);
        memcpy(rank_of, p->rank_of, p->rows * sizeof *rank_of);
        memcpy(start, p->start, (p->rows + (size_t)1) * sizeof *start);
    }
    rheo__release(allocator, p->id_of);
    rheo__release(allocator, p->rank_of);
    rheo__release(allocator, p->start);
    p->id_of = id_of;
    p->rank_of = rank_of;
    p->start = start;
    p->row_capacity = wanted;
    return true;
}

bool rheo__pairs_reserve(rheo__pairs *p, const rheo_allocator *allocator, size_t count, size_t kept)
{
    if (count <= p->capacity && p->partner)
        return true;
    if (count > UINT32_MAX) /* the starts of rows have 32 bits */
        return false;
    void *partner = p->partner;
    bool grown = rheo__grow(allocator, &partner, &p->capacity, count, kept, sizeof *p->partner);
    p->partner = partner;
    return grown;
}

void rheo__pairs_release(rheo__pairs *p, const rheo_allocator *allocator)
{
    rheo__release(allocator, p->id_of);
    rheo__release(allocator, p->rank_of);
    rheo__release(allocator, p->start);
    rheo__release(allocator, p->partner);
    memset(p, 0, sizeof *p);
}

bool rheo__springs_reserve(rheo__springs *s, const rheo_allocator *allocator, size_t count)
{
    void *rest_length = s->rest_length;
    bool grown = rheo__grow(allocator, &rest_length, &s->capacity, count, 0, sizeof *s->rest_length);
    s->rest_length = rest_length;
    return grown;
}

void rheo__springs_release(rheo__springs *s, const rheo_allocator *allocator)
{
    rheo__pairs_release(&s->pairs, allocator);
    rheo__release(allocator, s->rest_length);
    memset(s, 0, sizeof *s);
}

bool rheo__springs_set(rheo__springs *s, const rheo_allocator *allocator, uint32_t particles, size_t count,
                       const uint32_t *ends, const rheo_real *rest_length)
{
    rheo__pairs *p = &s->pairs;
    if (!rheo__pairs_reserve_rows(p, allocator, particles) || !rheo__pairs_reserve(p, allocator, count, 0) ||
        !rheo__springs_reserve(s, allocator, count))
        return false;
    p->rows = particles;
    size_t k = 0;
    for (uint32_t i = 0; i < particles; i++) {
        p->id_of[i] = p->rank_of[i] = i;
        p->start[i] = (uint32_t)k;
        for (; k < count && ends[2 * k] == i; k++) {
            p->partner[k] = ends[2 * k + 1];
            s->rest_length[k] = rest_length[k];
        }
    }
    p->start[particles] = (uint32_t)k;
    return true;
}

bool rheo__springs_ordered(uint32_t particles, size_t count, const uint32_t *ends)
{
    uint64_t before = 0; /* 0:0 is no spring */
    for (size_t k = 0; k < count; k++) {
        uint64_t pair = (uint64_t)ends[2 * k] << 32 | ends[2 * k + 1];
        if (ends[2 * k] >= ends[2 * k + 1] || ends[2 * k + 1] >= particles || pair <= before)
            return false;
        before = pair;
    }
    return true;
}

bool rheo__springs_read(const rheo__springs *s, const rheo_allocator *allocator, uint32_t *ends,
                        rheo_real *rest_length)
{
    const rheo__pairs *p = &s->pairs;
    if (rheo__pairs_count(p) == 0)
        return true;
    /*
     * Two passes of a stable counting sort, by larger and then by smaller id. `place` has the next index for each id,
     * `order` the springs by larger id.
     */
    size_t count = rheo__pairs_count(p);
    uint32_t *place = rheo__allocate(allocator, (size_t)p->rows + 1, sizeof *place);
    uint32_t *order = rheo__allocate(allocator, count, sizeof *order);
    uint32_t *ends_of = rheo__allocate(allocator, count, 2 * sizeof *ends_of);
    bool enough = place && order && ends_of;
    if (enough) {
        for (uint32_t i = 0, k = 0; i < p->rows; i++)
            for (; k < p->start[i + 1]; k++) {
                uint32_t a = p->id_of[i], b = p->id_of[p->partner[k]];
                ends_of[2 * k] = a < b ? a : b;
                ends_of[2 * k + 1] = a < b ? b : a;
            }
        for (size_t k = 0; k < count; k++)
            place[ends_of[2 * k + 1] + 1]++;
        for (uint32_t i = 0; i < p->rows; i++)
            place[i + 1] += place[i];
        for (size_t k = 0; k < count; k++)
            order[place[ends_of[2 * k + 1]]++] = (uint32_t)k;
        memset(place, 0, ((size_t)p->rows + 1) * sizeof *place);
        for (size_t k = 0; k < count; k++)
            place[ends_of[2 * k] + 1]++;
        for (uint32_t i = 0; i < p->rows; i++)
            place[i + 1] += place[i];
        for (size_t n = 0; n < count; n++) {
            uint32_t k = order[n], to = place[ends_of[2 * k]]++;
            if (ends) {
                ends[2 * (size_t)to] = ends_of[2 * k];
                ends[2 * (size_t)to + 1] = ends_of[2 * k + 1];
            }
            if (rest_length)
                rest_length[to] = s->rest_length[k];
        }
    }
    rheo__release(allocator, place);
    rheo__release(allocator, order);
    rheo__release(allocator, ends_of);
    return enough;
}

size_t rheo__springs_find(const rheo__springs *s, uint32_t a, uint32_t b)
{
    const rheo__pairs *p = &s->pairs;
    if (a >= p->rows || b >= p->rows || a == b)
        return SIZE_MAX;
    uint32_t i = p->rank_of[a], j = p->rank_of[b];
    if (i > j) {
        uint32_t swap = i;
        i = j;
        j = swap;
    }
    for (uint32_t k = p->start[i]; k < p->start[i + 1]; k++)
        if (p->partner[k] == j)
            return k;
    return SIZE_MAX;
}
