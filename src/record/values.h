/*
 * A copy of a state in the order of ids: what is compared, and what is loaded into a world. Rings and modes are left
 * out; or the newest row of a ring stands for it, and modes are there row by row, each with an item a particle.
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
    uint32_t present; /* set of fields */
} rheo__values;

/* Room for so many items of a field. However many a file claims, what has room can be counted in a size_t. */
rheo_result rheo__values_resize(rheo__values *values, rheo__field_id field, uint64_t items, rheo_error *error);
rheo_result rheo__values_take(rheo__values *values, const rheo__state *state, bool newest, rheo_error *error);
void rheo__values_release(rheo__values *values);
void rheo__values_swap(rheo__values *a, rheo__values *b);

/* Fields are numbered in a file as a world has them (`present`): those that it does not have do not count. */
static inline uint32_t rheo__field_place(uint32_t present, rheo__field_id field)
{
    uint32_t place = 0;
    for (uint32_t before = present & ((UINT32_C(1) << field) - 1); before; before &= before - 1)
        place++;
    return place;
}

/*
 * Floating-point numbers as integers in the same order, so that neighbours differ by 1: what residuals and
 * distances in units in the last place are taken of. Its own inverse is rheo__unorder().
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
