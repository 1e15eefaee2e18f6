/*
 * Hashes of fields after the stages of a step. Most of the work of hashing is spared: a field that a stage left
 * unchanged keeps its hash, and the sum of spring ends changes only by the springs that have come and gone.
 */
#ifndef RHEO__CORE_STEP_HASHES_H
#define RHEO__CORE_STEP_HASHES_H

#include "core/real.h"
#include "core/state.h"

typedef struct rheo__step_hashes {
    uint64_t hash[RHEO__FIELD_COUNT];
    rheo__fields known; /* fields that still have this hash */
    uint64_t rewritten; /* state->rewritten when they had */
    /* Springs in blocks: marks of the springs (core/hash.h), the list that they belong to, and the sum of their ends. */
    rheo__real_bits *marks;
    size_t capacity;
    bool marked;
    uint64_t exchanged, ends;
} rheo__step_hashes;

/* Nothing is known any more. */
static inline void rheo__step_hashes_forget(rheo__step_hashes *h)
{
    h->known = 0;
    h->marked = false;
}

/* Forgets everything if values may have been set other than by stages whose hashes were taken. */
static inline void rheo__step_hashes_begin(rheo__step_hashes *h, const rheo__state *s, bool continued)
{
    if (!continued || h->rewritten != s->rewritten)
        rheo__step_hashes_forget(h);
    h->rewritten = s->rewritten;
}

/* Before a stage that writes these fields: asks it for the sums of hashes that it can make. */
void rheo__step_hashes_prepare(rheo__step_hashes *h, rheo__state *s, rheo__fields writes);
/*
 * The hashes of rheo__state_hash_newest() after a stage that writes these fields, of which it left s->unchanged as
 * they were. False: no memory.
 */
bool rheo__step_hashes_take(rheo__step_hashes *h, const rheo__state *s, rheo__fields writes, uint64_t *hashes);

#endif
