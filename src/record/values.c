/* Copies of a state in the order of ids (record/values.h). */
#include "record/values.h"

#include <stdlib.h>
#include <string.h>

rheo_result rheo_values_resize(rheo_values *v, rheo_field_id field, uint64_t items, rheo_error *error)
{
    const rheo_field *f = &rheo_field_table[field];
    size_t size = rheo_element_size(f->element) * f->components;
    if (items > v->capacity[field] || !v->data[field]) {
        uint64_t wanted = items + items / 4 + 1;
        void *data = items <= SIZE_MAX / 2 && wanted <= SIZE_MAX / size
                         ? realloc(v->data[field], (size_t)wanted * size)
                         : NULL;
        if (!data)
            return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory for %s of a state of the recording", f->name);
        v->data[field] = data;
        v->capacity[field] = (size_t)wanted;
    }
    v->items[field] = (size_t)items;
    v->present |= UINT32_C(1) << field;
    return RHEO_OK;
}

rheo_result rheo_values_take(rheo_values *v, const rheo_state *state, bool newest, rheo_error *error)
{
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++) {
        if (!rheo_state_has(state, f) || (rheo_in_rows(f) && !newest))
            continue;
        uint64_t rows = rheo_state_rows(state, f);
        rows = rheo_field_table[f].storage == RHEO_RING && rows > 1 ? 1 : rows;
        RHEO_TRY(rheo_values_resize(v, f, rows * rheo_state_items(state, f), error));
        /* Both fields of springs are sorted at once, below. */
        for (uint64_t row = 0; rheo_field_table[f].storage != RHEO_SPRING && v->items[f] && row < rows; row++)
            rheo_state_read_row(state, f, row, (char *)v->data[f] + row * rheo_state_row_bytes(state, f));
    }
    if (rheo_state_has(state, RHEO_FIELD_spring_ends) &&
        !rheo_springs_read(&state->springs, &state->allocator, v->data[RHEO_FIELD_spring_ends],
                           v->data[RHEO_FIELD_spring_rest_length]))
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory to sort the springs");
    return RHEO_OK;
}

void rheo_values_release(rheo_values *v)
{
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++)
        free(v->data[f]);
    memset(v, 0, sizeof *v);
}

void rheo_values_swap(rheo_values *a, rheo_values *b)
{
    rheo_values swap = *a;
    *a = *b;
    *b = swap;
}
