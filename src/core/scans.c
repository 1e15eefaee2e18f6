/* The scans of core/scans.h. */
#include "core/scans.h"

#include "core/lane_points.h"

#define EXPONENT ((rheo__real_bits)(RHEO_DOUBLE ? UINT64_C(0x7FF0000000000000) : UINT64_C(0x7F800000)))

/* NaN and infinity have the largest exponent. */
bool RHEO__VARIANT(any_not_finite)(const rheo_real *value, size_t count)
{
    rheo__mask any = {0};
    size_t i = 0;
    for (; i + RHEO__LANES <= count; i += RHEO__LANES) {
        rheo__bits bits;
        memcpy(&bits, value + i, sizeof bits);
        any |= rheo__mask_filled((rheo__mask)((bits & EXPONENT) == EXPONENT));
    }
    for (; i < count; i++) {
        rheo__real_bits bits;
        memcpy(&bits, value + i, sizeof bits);
        if ((bits & EXPONENT) == EXPONENT)
            return true;
    }
    return rheo__lanes_any(any);
}

rheo_real RHEO__VARIANT(largest_length2)(const rheo_real *triple, size_t count)
{
    rheo__lanes lanes = rheo__lanes_all(0);
    size_t i = 0;
    for (; i + RHEO__LANES <= count; i += RHEO__LANES) {
        const rheo__lanes3 v = rheo__lanes_load_triples(triple + 3 * i);
        lanes = rheo__lanes_max(v.x * v.x + v.y * v.y + v.z * v.z, lanes);
    }
    rheo_real largest = 0;
    for (; i < count; i++)
        largest = rheo__max(rheo__length2(triple[3 * i], triple[3 * i + 1], triple[3 * i + 2]), largest);
    for (int lane = 0; lane < RHEO__LANES; lane++)
        largest = rheo__max(RHEO__LANE(lanes, lane), largest);
    return largest;
}
