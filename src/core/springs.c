/* Pairs and springs (core/springs.h). */
#include "core/springs.h"

#include <assert.h>
#include <string.h>

#include "core/hash.h"

bool rheo__pairs_reserve_rows(rheo__pairs *p, const rheo_allocator *allocator, uint32_t rows)
{
    if (rows <= p->row_capacity && p->start)
        return true;
    /* A list that has grown once may grow again. */
    size_t wanted = rows + (p->start ? (size_t)rows / 4 : 0) + 1;
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

bool rheo__pairs_reserve_images(rheo__pairs *p, const rheo_allocator *allocator, uint32_t images)
{
    if (!images)
        return true;
    void *image = p->image;
    const bool grown = rheo__grow(allocator, &image, &p->image_capacity, images, 0, sizeof *p->image);
    p->image = image;
    p->images = grown ? images : 0;
    return grown;
}

void rheo__pairs_forget_images(rheo__pairs *p)
{
    for (size_t k = 0; p->images && k < rheo__pairs_entries(p); k++)
        p->partner[k] = RHEO__POINT_VALUES * rheo__pairs_partner(p, k);
    p->images = 0;
}

void rheo__pairs_release(rheo__pairs *p, const rheo_allocator *allocator)
{
    rheo__release(allocator, p->image);
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
    rheo__release(allocator, s->key);
    memset(s, 0, sizeof *s);
}

static bool reserve_keys(rheo__springs *s, const rheo_allocator *allocator, size_t rows)
{
    void *key = s->key;
    const bool grown = rheo__grow(allocator, &key, &s->key_capacity, rows + 1, 0, sizeof *s->key);
    s->key = key;
    return grown;
}

bool rheo__springs_set(rheo__springs *s, const rheo_allocator *allocator, uint32_t particles, size_t count,
                       const uint32_t *ends, const rheo_real *rest_length)
{
    enum { WIDTH = RHEO__BLOCK_ROWS };
    rheo__pairs *p = &s->pairs;
    if (!rheo__pairs_reserve_rows(p, allocator, particles))
        return false;
    uint32_t *length = rheo__allocate(allocator, (size_t)particles + WIDTH, sizeof *length);
    if (!length)
        return false;
    for (size_t k = 0; k < 2 * count; k++)
        length[ends[k]]++;
    size_t entries = 0;
    for (uint32_t i = 0; i < particles; i += WIDTH) {
        uint32_t longest = 0;
        for (uint32_t lane = 0; lane < WIDTH; lane++)
            longest = length[i + lane] > longest ? length[i + lane] : longest;
        entries += longest;
    }
    const bool enough = rheo__pairs_reserve(p, allocator, entries * WIDTH + 1, 0) &&
                        rheo__springs_reserve(s, allocator, entries * WIDTH + 1) &&
                        reserve_keys(s, allocator, (size_t)particles + WIDTH);
    if (enough) {
        rheo__pairs_shape(p, particles, WIDTH);
        s->count = count;
        entries = 0;
        for (uint32_t b = 0; b < p->blocks; b++) {
            uint32_t longest = 0;
            for (uint32_t i = b * WIDTH; i < (b + 1) * WIDTH; i++)
                longest = length[i] > longest ? length[i] : longest;
            p->start[b] = (uint32_t)entries;
            for (size_t k = entries * WIDTH; k < (entries + longest) * WIDTH; k++) {
                p->partner[k] = RHEO__POINT_VALUES * rheo__pairs_idle(p);
                s->rest_length[k] = -1;
            }
            entries += longest;
        }
        p->start[p->blocks] = (uint32_t)entries;
        memset(length, 0, ((size_t)particles + WIDTH) * sizeof *length);
        /* The springs ascend, so each row gets its lower partners first, and all of them in ascending order. */
        for (size_t k = 0; k < count; k++)
            for (size_t end = 0; end < 2; end++) {
                const uint32_t own = ends[2 * k + end];
                const size_t to = rheo__pairs_first(p, own) + (size_t)length[own]++ * WIDTH;
                p->partner[to] = RHEO__POINT_VALUES * ends[2 * k + 1 - end];
                s->rest_length[to] = rest_length[k];
            }
        for (uint32_t i = 0; i < particles; i++)
            p->id_of[i] = p->rank_of[i] = i;
    }
    rheo__release(allocator, length);
    return enough && rheo__springs_make_keys(s, allocator);
}

bool rheo__springs_make_keys(rheo__springs *s, const rheo_allocator *allocator)
{
    const rheo__pairs *p = &s->pairs;
    /* Idle rows and the partner of idle entries have keys, too; they are not used. */
    if (!reserve_keys(s, allocator, (size_t)rheo__pairs_idle(p) + 1))
        return false;
    for (uint32_t i = 0; i < p->rows; i++)
        s->key[i] = rheo__hash_key(p->id_of[i]);
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

/* The ends of the pair of an entry of row i. False: the pair is that of the row of its other end, or idle. */
static inline bool pair_at(const rheo__pairs *p, uint32_t i, size_t entry, uint64_t *ends)
{
    const uint32_t j = rheo__pairs_partner(p, entry), own = p->id_of[i], other = p->id_of[j < p->rows ? j : i];
    const uint32_t small = own < other ? own : other, large = own < other ? other : own;
    *ends = (uint64_t)small << 32 | large;
    return (j > i) & (j < p->rows);
}

/* Sorts the few pairs of one smaller id. */
static void sort_pairs(rheo__ordered_pair *pair, size_t count)
{
    for (size_t n = 1; n < count; n++) {
        const rheo__ordered_pair moved = pair[n];
        size_t to = n;
        for (; to > 0 && pair[to - 1].ends > moved.ends; to--)
            pair[to] = pair[to - 1];
        pair[to] = moved;
    }
}

bool rheo__spring_order_make(rheo__spring_order *order, const rheo__springs *s, const rheo_allocator *allocator)
{
    const rheo__pairs *p = &s->pairs;
    uint32_t *place = rheo__allocate(allocator, (size_t)p->rows + 1, sizeof *place);
    uint64_t ends;
    order->count = 0;
    if (!place)
        return false;
    for (uint32_t i = 0; i < p->rows; i++)
        for (size_t k = rheo__pairs_first(p, i), end = rheo__pairs_end(p, i); k < end; k += p->width) {
            const bool own = pair_at(p, i, k, &ends);
            place[(ends >> 32) + 1] += own;
        }
    for (uint32_t i = 0; i < p->rows; i++)
        place[i + 1] += place[i];
    const size_t count = place[p->rows];
    void *pair = order->pair;
    const bool grown = rheo__grow(allocator, &pair, &order->capacity, count + 1, 0, sizeof *order->pair);
    order->pair = pair;
    if (grown) {
        order->count = count;
        for (uint32_t i = 0; i < p->rows; i++)
            for (size_t k = rheo__pairs_first(p, i), end = rheo__pairs_end(p, i); k < end; k += p->width) {
                /* Without a branch, which would be mispredicted: other pairs go behind the last one. */
                const bool own = pair_at(p, i, k, &ends);
                uint32_t *to = &place[ends >> 32];
                order->pair[own ? *to : count] = (rheo__ordered_pair){ends, (uint32_t)k};
                *to += own;
            }
        /* place[i] has become the end of the pairs of i. */
        for (uint32_t i = 0, first = 0; i < p->rows; first = place[i++])
            sort_pairs(order->pair + first, place[i] - first);
    }
    rheo__release(allocator, place);
    return grown;
}

void rheo__spring_order_release(rheo__spring_order *order, const rheo_allocator *allocator)
{
    rheo__release(allocator, order->pair);
    *order = (rheo__spring_order){0};
}

void rheo__springs_read_in(const rheo__springs *s, const rheo__spring_order *order, uint32_t *ends,
                           rheo_real *rest_length)
{
    size_t n = 0;
    for (size_t k = 0; k < order->count; k++) {
        const rheo_real length = s->rest_length[order->pair[k].entry];
        if (!(length >= 0))
            continue;
        if (ends) {
            ends[2 * n] = (uint32_t)(order->pair[k].ends >> 32);
            ends[2 * n + 1] = (uint32_t)order->pair[k].ends;
        }
        if (rest_length)
            rest_length[n] = length;
        n++;
    }
    assert(n == s->count);
}

bool rheo__springs_read(const rheo__springs *s, const rheo_allocator *allocator, uint32_t *ends,
                        rheo_real *rest_length)
{
    if (s->count == 0)
        return true;
    rheo__spring_order order = {0};
    const bool enough = rheo__spring_order_make(&order, s, allocator);
    if (enough)
        rheo__springs_read_in(s, &order, ends, rest_length);
    rheo__spring_order_release(&order, allocator);
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
    for (size_t k = rheo__pairs_first(p, i); k < rheo__pairs_end(p, i); k += p->width)
        if (rheo__pairs_partner(p, k) == j && s->rest_length[k] >= 0)
            return k;
    return SIZE_MAX;
}
