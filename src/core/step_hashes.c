/* Hashes after the stages of a step (core/step_hashes.h). */
#include "core/step_hashes.h"

#include "core/field_sums.h"

/* Springs in blocks. With the marks of the same list, only springs that have come and gone change the sum of ends. */
static bool take_springs(rheo__step_hashes *h, const rheo__state *s)
{
    static rheo__sum_rest_lengths *const variants[] = RHEO__ALL_VARIANTS(sum_rest_lengths);
    const rheo__pairs *p = &s->springs.pairs;
    const rheo__fields both = RHEO__BIT(spring_ends) | RHEO__BIT(spring_rest_length);
    uint64_t *ends = &h->ends;
    if (!h->marked || h->exchanged != s->springs_exchanged) {
        const size_t words = rheo__hash_marks(p, p->blocks) * RHEO__BLOCK_ROWS;
        void *marks = h->marks;
        const bool grown = rheo__grow(&s->allocator, &marks, &h->capacity, words + 1, 0, sizeof *h->marks);
        h->marks = marks;
        if (!grown)
            return false;
        if (h->marked && (h->known & s->unchanged & RHEO__BIT(spring_ends))) {
            ends = NULL; /* the same springs in another list */
        } else {
            memset(h->marks, 0, words * sizeof *h->marks);
            h->ends = 0;
        }
        h->marked = true;
        h->exchanged = s->springs_exchanged;
    }
    const uint64_t lengths =
        s->spring_sums.made ? s->spring_sums.lengths : variants[rheo__simd_in_use()](&s->springs, h->marks, ends);
    h->hash[RHEO__FIELD_spring_ends] = rheo__hash_field(h->ends, 1, s->springs.count);
    h->hash[RHEO__FIELD_spring_rest_length] = rheo__hash_field(lengths, 1, s->springs.count);
    h->known |= both;
    return true;
}

void rheo__step_hashes_prepare(rheo__step_hashes *h, rheo__state *s, rheo__fields writes)
{
    const bool same_list = h->marked && h->exchanged == s->springs_exchanged;
    s->spring_sums = (rheo__spring_sums){
        .wanted = (writes & RHEO__BIT(spring_rest_length)) && same_list, .ends = &h->ends, .marks = h->marks};
}

bool rheo__step_hashes_take(rheo__step_hashes *h, const rheo__state *s, rheo__fields writes, uint64_t *hashes)
{
    const rheo__fields both = RHEO__BIT(spring_ends) | RHEO__BIT(spring_rest_length);
    const rheo__fields kept = h->known & s->unchanged;
    rheo__fields left = writes & ~kept;
    h->known &= ~left;
    if ((left & both) && s->springs.pairs.width == RHEO__BLOCK_ROWS) {
        if (!take_springs(h, s))
            return false;
        left &= ~both;
    }
    uint64_t taken[RHEO__FIELD_COUNT];
    rheo__state_hash_newest(s, left, taken);
    for (rheo__field_id f = 0, n = 0; f < RHEO__FIELD_COUNT; f++) {
        if (left >> f & 1)
            h->hash[f] = taken[n++];
        if (writes >> f & 1)
            *hashes++ = h->hash[f];
    }
    h->known |= writes;
    return true;
}
