/*
 * Numbers moved by one unit in the last place, with seeded signs (record/same.h). The numbers of a type are paired, each
 * with its neighbour above or below, as a seeded bit says, and a move exchanges the numbers of a pair. So the same move
 * again undoes itself, and the values before need not be kept.
 */
#include "record/same.h"

#include <stdlib.h>

/* SplitMix64: a good hash of its argument. */
static uint64_t mix(uint64_t x)
{
    x += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

/* Zero is exact, and so small a number could change its sign: they are not moved, nor is what would become one. */
static bool is_normal(rheo_real value)
{
    const rheo_real least = RHEO_DOUBLE ? (rheo_real)0x1p-1000 : (rheo_real)0x1p-120F;
    return (value >= least || value <= -least) && value - value == 0;
}

void rheo__same_move(rheo_real *values, size_t count, uint64_t seed, uint64_t stream)
{
    const uint64_t start = mix(mix(seed) ^ stream);
    uint64_t bits = 0;
    for (size_t i = 0; i < count; i++, bits >>= 1) {
        if (i % 64 == 0)
            bits = mix(start + i / 64);
        const rheo__real_bits shift = (rheo__real_bits)(bits & 1), order = rheo__order(values[i]);
        const rheo_real moved = rheo__unorder((rheo__real_bits)(((order + shift) ^ 1) - shift));
        if (is_normal(values[i]) && is_normal(moved))
            values[i] = moved;
    }
}

/* ---- A state ---- */

/* Rows of a ring that are moved: older ones have little weight. */
enum { MOVED_ROWS = 8 };

/* Numbers that the next step computes with. Those of the neighbour list only say when it was made. */
static bool is_moved(rheo__field_id f)
{
    return rheo__field_table[f].element == RHEO__ELEMENT_REAL && f != RHEO__FIELD_start_position &&
           f != RHEO__FIELD_list_position && f != RHEO__FIELD_list_margin;
}

static rheo_result no_memory(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to move a state by rounding");
}

static rheo_result move_rows(rheo__state *s, rheo__field_id f, uint64_t seed, rheo_error *error)
{
    const size_t values = (size_t)rheo__state_items(s, f) * rheo__field_table[f].components;
    uint64_t rows = rheo__state_rows(s, f);
    if (rheo__field_table[f].storage == RHEO__RING && rows > MOVED_ROWS)
        rows = MOVED_ROWS;
    rheo_real *row = malloc(values * sizeof *row + 1);
    if (!row)
        return no_memory(error);
    for (uint64_t i = 0; values && i < rows; i++) {
        rheo__state_read_row(s, f, i, row);
        rheo__same_move(row, values, seed, (uint64_t)f << 32 | (i + 1));
        rheo__state_write_row(s, f, i, row);
    }
    free(row);
    return RHEO_OK;
}

static rheo_result move_springs(rheo__state *s, uint64_t seed, rheo_error *error)
{
    const size_t count = s->springs.count;
    uint32_t *ends = malloc(2 * count * sizeof *ends + 1);
    rheo_real *rest = malloc(count * sizeof *rest + 1);
    bool done = ends && rest && rheo__springs_read(&s->springs, &s->allocator, ends, rest);
    if (done) {
        rheo__same_move(rest, count, seed, (uint64_t)RHEO__FIELD_spring_rest_length << 32);
        done = rheo__springs_set(&s->springs, &s->allocator, s->particles, count, ends, rest);
        s->rewritten++;
    }
    free(ends);
    free(rest);
    return done ? RHEO_OK : no_memory(error);
}

rheo_result rheo__same_move_state(rheo_world *world, uint64_t seed, rheo_error *error)
{
    rheo__state *s = &world->state;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(s, f) || !is_moved(f) || rheo__field_table[f].storage == RHEO__SPRING)
            continue;
        if (rheo__in_rows(f)) {
            RHEO__TRY(move_rows(s, f, seed, error));
            continue;
        }
        const size_t count = (size_t)rheo__state_items(s, f) * rheo__field_table[f].components;
        rheo__same_move(rheo__state_values(s, f), count, seed, (uint64_t)f << 32);
        s->rewritten++;
    }
    return rheo__state_has(s, RHEO__FIELD_spring_ends) && s->springs.count ? move_springs(s, seed, error) : RHEO_OK;
}
