/*
 * A copy of a state in the order of ids: what is compared, and what is loaded into a world. Rings and modes are left
 * out; or the newest row of a ring stands for it, and modes are there row by row, each with an item a particle.
 */
#ifndef RHEO_RECORD_VALUES_H
#define RHEO_RECORD_VALUES_H

#include "core/error.h"
#include "core/real.h"
#include "core/state.h"

typedef struct rheo_values {
    void *data[RHEO_FIELD_COUNT]; /* from malloc */
    size_t capacity[RHEO_FIELD_COUNT];
    size_t items[RHEO_FIELD_COUNT];
    uint32_t present; /* set of fields */
} rheo_values;

/* Room for so many items of a field. However many a file claims, what has room can be counted in a size_t. */
rheo_result rheo_values_resize(rheo_values *values, rheo_field_id field, uint64_t items, rheo_error *error);
rheo_result rheo_values_take(rheo_values *values, const rheo_state *state, bool newest, rheo_error *error);
void rheo_values_release(rheo_values *values);
void rheo_values_swap(rheo_values *a, rheo_values *b);

/* Fields are numbered in a file as a world has them (`present`): those that it does not have do not count. */
static inline uint32_t rheo_field_place(uint32_t present, rheo_field_id field)
{
    uint32_t place = 0;
    for (uint32_t before = present & ((UINT32_C(1) << field) - 1); before; before &= before - 1)
        place++;
    return place;
}

/*
 * Floating-point numbers as integers in the same order, so that neighbours differ by 1: what residuals and
 * distances in units in the last place are taken of. Its own inverse is rheo_unorder().
 */
static inline rheo_real_bits rheo_order(rheo_real value)
{
    rheo_real_bits bits;
    __builtin_memcpy(&bits, &value, sizeof bits);
    rheo_real_bits sign = (rheo_real_bits)1 << (8 * sizeof bits - 1);
    return bits & sign ? (rheo_real_bits)~bits : (rheo_real_bits)(bits | sign);
}
static inline rheo_real rheo_unorder(rheo_real_bits order)
{
    rheo_real_bits sign = (rheo_real_bits)1 << (8 * sizeof order - 1);
    rheo_real_bits bits = order & sign ? (rheo_real_bits)(order & ~sign) : (rheo_real_bits)~order;
    rheo_real value;
    __builtin_memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
