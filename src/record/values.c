/* Copies of a state in the order of ids (record/values.h). */
#include "record/values.h"

#include <stdlib.h>
#include <string.h>

rheo_result rheo__values_resize(rheo__values *v, rheo__field_id field, uint64_t items, rheo_error *error)
{
    const rheo__field *f = &rheo__field_table[field];
    size_t size = rheo__element_size(f->element) * f->components;
    if (items > v->capacity[field] || !v->data[field]) {
        uint64_t wanted = items + items / 4 + 1;
        void *data = items <= SIZE_MAX / 2 && wanted <= SIZE_MAX / size
                         ? realloc(v->data[field], (size_t)wanted * size)
                         : NULL;
        if (!data)
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for %s of a state of the recording", f->name);
        v->data[field] = data;
        v->capacity[field] = (size_t)wanted;
    }
    v->items[field] = (size_t)items;
    v->present |= UINT32_C(1) << field;
    return RHEO_OK;
}

rheo_result rheo__values_take(rheo__values *v, const rheo__state *state, bool newest, rheo_error *error)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(state, f) || (rheo__in_rows(f) && !newest))
            continue;
        uint64_t rows = rheo__state_rows(state, f);
        rows = rheo__field_table[f].storage == RHEO__RING && rows > 1 ? 1 : rows;
        RHEO__TRY(rheo__values_resize(v, f, rows * rheo__state_items(state, f), error));
        /* Both fields of springs are sorted at once, below. */
        for (uint64_t row = 0; rheo__field_table[f].storage != RHEO__SPRING && v->items[f] && row < rows; row++)
            rheo__state_read_row(state, f, row, (char *)v->data[f] + row * rheo__state_row_bytes(state, f));
    }
    if (rheo__state_has(state, RHEO__FIELD_spring_ends) &&
        !rheo__springs_read(&state->springs, &state->allocator, v->data[RHEO__FIELD_spring_ends],
                            v->data[RHEO__FIELD_spring_rest_length]))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to sort the springs");
    return RHEO_OK;
}

void rheo__values_release(rheo__values *v)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        free(v->data[f]);
    memset(v, 0, sizeof *v);
}

void rheo__values_swap(rheo__values *a, rheo__values *b)
{
    rheo__values swap = *a;
    *a = *b;
    *b = swap;
}
