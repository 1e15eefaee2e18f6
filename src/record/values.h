/*
 * A copy of a state in the order of ids, to compare it or to load it into a world. Rings and modes are omitted, or
 * included as the newest row of the ring and all rows of the modes, each with one item per particle.
 */
#ifndef RHEO__RECORD_VALUES_H
#define RHEO__RECORD_VALUES_H

#include "core/error.h"
#include "core/real.h"
#include "core/state.h"

typedef struct rheo__values {
    void *data[RHEO__FIELD_COUNT]; /* from malloc */
    size_t capacity[RHEO__FIELD_COUNT];
    size_t items[RHEO__FIELD_COUNT];
    rheo__fields present;
} rheo__values;

/* Makes room for `count` items of a field; fails with RHEO_ERROR_MEMORY where a size_t would overflow. */
rheo_result rheo__values_resize(rheo__values *values, rheo__field_id field, uint64_t items, rheo_error *error);
rheo_result rheo__values_take(rheo__values *values, const rheo__state *state, bool newest, rheo_error *error);

/* Order of the springs of a state that is taken after every step, sorted again only when the list has changed. */
typedef struct rheo__known_order {
    rheo__spring_order order;
    bool made;
    uint64_t rewritten, exchanged; /* members of the state when it was made */
} rheo__known_order;

/* rheo__values_take() without the newest rows of the history. */
rheo_result rheo__values_follow(rheo__values *values, const rheo__state *state, rheo__known_order *known,
                                rheo_error *error);
void rheo__values_release(rheo__values *values);
void rheo__values_swap(rheo__values *a, rheo__values *b);

/* Number of a field in a file: its index among the fields that the world has (`present`). */
static inline uint32_t rheo__field_index(rheo__fields present, rheo__field_id field)
{
    uint32_t index = 0;
    for (rheo__fields before = present & (RHEO__SET_OF(field) - 1); before; before &= before - 1)
        index++;
    return index;
}

/*
 * Floating-point numbers as integers in the same order, so that neighbours differ by 1: for residuals and distances
 * in units in the last place. rheo__unorder() is the inverse.
 */
static inline rheo__real_bits rheo__order(rheo_real value)
{
    rheo__real_bits bits;
    __builtin_memcpy(&bits, &value, sizeof bits);
    rheo__real_bits sign = (rheo__real_bits)1 << (8 * sizeof bits - 1);
    return bits & sign ? (rheo__real_bits)~bits : (rheo__real_bits)(bits | sign);
}
static inline rheo_real rheo__unorder(rheo__real_bits order)
{
    rheo__real_bits sign = (rheo__real_bits)1 << (8 * sizeof order - 1);
    rheo__real_bits bits = order & sign ? (rheo__real_bits)(order & ~sign) : (rheo__real_bits)~order;
    rheo_real value;
    __builtin_memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
