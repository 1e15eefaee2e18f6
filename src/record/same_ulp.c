/* Numbers moved by one unit in the last place, with seeded signs (record/same.h). */
#include "record/same.h"

/* SplitMix64: a good hash of its argument. */
static uint64_t mix(uint64_t x)
{
    x += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

void rheo__same_move(rheo_real *values, size_t count, uint64_t seed, uint64_t stream, bool back)
{
    const uint64_t start = mix(mix(seed) ^ stream);
    uint64_t signs = 0;
    for (size_t i = 0; i < count; i++, signs >>= 1) {
        if (i % 64 == 0)
            signs = mix(start + i / 64);
        const bool up = (signs & 1) != (uint64_t)back;
        values[i] = rheo__unorder((rheo__real_bits)(up ? rheo__order(values[i]) + 1 : rheo__order(values[i]) - 1));
    }
}
