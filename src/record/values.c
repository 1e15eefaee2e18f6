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
    v->present |= RHEO__SET_OF(field);
    return RHEO_OK;
}

/* Takes all fields but springs, for which it makes room. */
static rheo_result take_values(rheo__values *v, const rheo__state *state, bool newest, rheo_error *error)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(state, f) || (rheo__in_rows(f) && !newest))
            continue;
        uint64_t rows = rheo__state_rows(state, f);
        rows = rheo__field_table[f].storage == RHEO__RING && rows > 1 ? 1 : rows;
        RHEO__TRY(rheo__values_resize(v, f, rows * rheo__state_items(state, f), error));
        for (uint64_t row = 0; rheo__field_table[f].storage != RHEO__SPRING && v->items[f] && row < rows; row++)
            rheo__state_read_row(state, f, row, (char *)v->data[f] + row * rheo__state_row_bytes(state, f));
    }
    return RHEO_OK;
}

static rheo_result no_memory_for_springs(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to sort the springs");
}

rheo_result rheo__values_take(rheo__values *v, const rheo__state *state, bool newest, rheo_error *error)
{
    RHEO__TRY(take_values(v, state, newest, error));
    /* Both fields of springs are sorted at once. */
    const bool taken = !rheo__state_has(state, RHEO__FIELD_spring_ends) ||
                       rheo__springs_read(&state->springs, &state->allocator, v->data[RHEO__FIELD_spring_ends],
                                          v->data[RHEO__FIELD_spring_rest_length]);
    return taken ? RHEO_OK : no_memory_for_springs(error);
}

rheo_result rheo__values_follow(rheo__values *v, const rheo__state *state, rheo__known_order *known,
                                rheo_error *error)
{
    RHEO__TRY(take_values(v, state, false, error));
    if (!rheo__state_has(state, RHEO__FIELD_spring_ends) || state->springs.count == 0)
        return RHEO_OK;
    if (!known->made || known->rewritten != state->rewritten || known->exchanged != state->springs_exchanged) {
        known->made = rheo__spring_order_make(&known->order, &state->springs, &state->allocator);
        known->rewritten = state->rewritten;
        known->exchanged = state->springs_exchanged;
        if (!known->made)
            return no_memory_for_springs(error);
    }
    rheo__springs_read_in(&state->springs, &known->order, v->data[RHEO__FIELD_spring_ends],
                          v->data[RHEO__FIELD_spring_rest_length]);
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
