/*
 * Keyframes: a complete state, as FILD chunks with the values of all fields, followed by the KEYF chunk that commits
 * them: numbers of items, the hash of every field, metrics, the parameters in force. A truncated keyframe has no KEYF
 * and is ignored.
 *
 * A loaded state is used only if it has the recorded hashes.
 */
#include "record/recording.h"

#include <stdlib.h>
#include <string.h>

#include "core/work.h"

static uint32_t index_of(const rheo__state *s, rheo__field_id field)
{
    return rheo__field_index(s->present, field);
}

static size_t row_values(const rheo__state *s, rheo__field_id field)
{
    return (size_t)rheo__state_items(s, field) * rheo__field_table[field].components;
}

/* Filled rows of the ring; 0 without one. */
static uint64_t ring_rows(const rheo__state *s)
{
    return s->present & RHEO__RING_FIELDS ? *s->history_rows : 0;
}

/* ---- Writing ---- */

static rheo_result write_flat(rheo__pieces_writer *pieces, const rheo__state *s, const rheo__values *values,
                              rheo_error *error)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (values->present >> f & 1)
            RHEO__TRY(rheo__pieces_put(pieces, index_of(s, f), 0, 0, values->data[f], row_values(s, f),
                                       rheo__element_size(rheo__field_table[f].element), error));
    return rheo__pieces_flush(pieces, error);
}

/* Writes several rows at a time: enough to read a ring in memory order, few enough to need little memory. */
static rheo_result write_rows(rheo__pieces_writer *pieces, const rheo__state *s, rheo__field_id f, rheo_error *error)
{
    enum { PORTION = 16 };
    if (!rheo__state_has(s, f) || s->particles == 0)
        return RHEO_OK;
    const size_t values = row_values(s, f);
    rheo_real *portion = malloc(PORTION * values * sizeof *portion);
    if (!portion)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write the history of a keyframe");
    rheo_result result = RHEO_OK;
    const uint32_t rows = (uint32_t)rheo__state_rows(s, f);
    for (uint32_t lag = 0; lag < rows && result == RHEO_OK; lag++) {
        if (lag % PORTION == 0)
            rheo__ring_read_rows(rheo__state_ring(s, f), s->particles, lag,
                                 rows - lag < PORTION ? rows - lag : PORTION, portion);
        result = rheo__pieces_put(pieces, index_of(s, f), lag, 0, portion + lag % PORTION * values, values,
                                  sizeof *portion, error);
    }
    free(portion);
    return result == RHEO_OK ? rheo__pieces_flush(pieces, error) : result;
}

static rheo_result write_fields(rheo__pieces_writer *pieces, const rheo_world *world, rheo_error *error)
{
    const rheo__state *s = &world->state;
    rheo__values values = {0};
    rheo_result result = rheo__values_take(&values, s, false, error);
    if (result == RHEO_OK)
        result = write_flat(pieces, s, &values, error);
    if (result == RHEO_OK) {
        /* Past velocities hardly compress: zlib would save a fifth, and make a keyframe cost nine times
         * as much. */
        pieces->compress = false;
        for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT && result == RHEO_OK; f++)
            if (rheo__in_rows(f))
                result = write_rows(pieces, s, f, error);
    }
    rheo__values_release(&values);
    rheo__bytes_release(&pieces->bytes);
    return result;
}

rheo_result rheo__keyframe_write(rheo__writer *writer, const rheo_world *world, rheo_error *error)
{
    const rheo__state *s = &world->state;
    rheo__pieces_writer pieces = {.writer = writer, .type = RHEO__FILD, .step = *s->step, .compress = true};
    RHEO__TRY(write_fields(&pieces, world, error));

    rheo__bytes bytes = {0};
    rheo__put_u64(&bytes, s->particles);
    rheo__put_u64(&bytes, s->bodies);
    rheo__put_u64(&bytes, s->vibrators);
    rheo__put_u64(&bytes, s->springs.count);
    rheo__put_u64(&bytes, ring_rows(s));
    rheo__put_u64(&bytes, pieces.chunks);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(s, f))
            rheo__put_u64(&bytes, rheo__state_hash_field(s, f));
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        rheo__put_f64(&bytes, rheo_world_metric(world, i));
    rheo__parameters_put(&bytes, &world->def);
    rheo_result result = rheo__chunk_write(writer, RHEO__KEYF, *s->step, &bytes, true, error);
    rheo__bytes_release(&bytes);
    return result;
}

/* ---- Reading ---- */

void rheo__keyframe_get(rheo__cursor *cursor, rheo__keyframe *k)
{
    k->particles = rheo__get_u64(cursor);
    k->bodies = rheo__get_u64(cursor);
    k->vibrators = rheo__get_u64(cursor);
    k->springs = rheo__get_u64(cursor);
    k->rows = rheo__get_u64(cursor);
    k->chunks = rheo__get_u64(cursor);
}

rheo_result rheo__keyframe_read(rheo_recording *r, const rheo__keyframe *k, uint64_t *hashes, double *metrics,
                                rheo_world_def *def, rheo_error *error)
{
    rheo__chunk chunk;
    bool truncated;
    rheo__keyframe ignored;
    RHEO__TRY(rheo__chunk_at(&r->reader, k->offset, &chunk, &truncated, error));
    RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    rheo__keyframe_get(&cursor, &ignored);
    for (uint32_t i = 0; i < r->head.field_count; i++) {
        uint64_t hash = rheo__get_u64(&cursor);
        if (hashes)
            hashes[i] = hash;
    }
    for (uint32_t i = 0; i < r->head.metric_count; i++) {
        double metric = rheo__get_f64(&cursor);
        if (metrics)
            metrics[i] = metric;
    }
    rheo_world_def read = r->head.def;
    const rheo_result result = rheo__parameters_get(&cursor, &read, error);
    r->head.def.history.curve = read.history.curve;
    r->head.def.history.curve_count = read.history.curve_count;
    RHEO__TRY(result);
    if (rheo__cursor_left(&cursor))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the keyframe at byte %llu cannot be read",
                          (unsigned long long)k->offset);
    if (def)
        *def = read;
    return RHEO_OK;
}

static uint64_t items_of(const rheo__keyframe *k, const rheo__state *s, rheo_location per)
{
    switch (per) {
    case RHEO_LOCATION_WORLD:
        return 1;
    case RHEO_LOCATION_PARTICLE:
        return k->particles;
    case RHEO_LOCATION_SPRING:
        return k->springs;
    case RHEO_LOCATION_BODY:
        return k->bodies;
    case RHEO_LOCATION_VIBRATOR:
        return k->vibrators;
    case RHEO_LOCATION_OBSTACLE:
        return s->obstacles;
    }
    return 0;
}

/* Parameters in a file may each be in range and still contradict each other. */
static rheo_result create_world(const rheo_world_def *def, uint32_t parts, rheo_world **world, rheo_error *error)
{
    rheo_error why;
    rheo_result result = rheo_world_def_check(def, &why);
    if (result == RHEO_OK)
        result = rheo__world_make(def, parts, world, &why);
    if (result == RHEO_OK)
        return RHEO_OK;
    return rheo__fail(error, result == RHEO_ERROR_ARGUMENT ? RHEO_ERROR_FORMAT : result,
                      "the recording cannot be loaded: %.400s", why.message);
}

static rheo__pieces_reader pieces_of(rheo_recording *r, const rheo__keyframe *k)
{
    return (rheo__pieces_reader){
        .reader = &r->reader, .type = RHEO__FILD, .step = k->step, .offset = k->start, .end = k->offset};
}

/* Reads the flat fields that `s` has. */
static rheo_result read_flat(rheo__pieces_reader *pieces, const rheo__keyframe *k, const rheo__state *s,
                             rheo__values *values, rheo_error *error)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        const rheo__field *field = &rheo__field_table[f];
        if (!rheo__state_has(s, f) || rheo__in_rows(f))
            continue;
        size_t element = rheo__element_size(field->element);
        uint64_t items = items_of(k, s, field->location);
        if (items > k->raw / (element * field->components))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the keyframe of step %llu is too short for its %s",
                              (unsigned long long)k->step, field->name);
        RHEO__TRY(rheo__values_resize(values, f, items, error));
        RHEO__TRY(rheo__pieces_get(pieces, index_of(s, f), 0, 0, values->data[f], (size_t)items * field->components,
                                   element, error));
    }
    return RHEO_OK;
}

static rheo_result fill_world(rheo_recording *r, const rheo__keyframe *k, rheo__pieces_reader *pieces,
                              const rheo__values *values, rheo_world *world, rheo_error *error)
{
    rheo__state *s = &world->state;
    uint64_t hashes[RHEO__FIELD_COUNT]; /* one for each field of the world */
    RHEO__TRY(rheo__keyframe_read(r, k, hashes, r->metrics, NULL, error));
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (values->present >> f & 1)
            rheo__state_write_row(s, f, 0, values->data[f]);
    if (*s->step != k->step || k->rows != ring_rows(s) || k->rows > s->ring.length)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the keyframe of step %llu contradicts itself",
                          (unsigned long long)k->step);
    if (k->rows && !rheo__world_reserve_history(world, k->rows))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the world of the recording");
    rheo__ring_fill(&s->ring, (uint32_t)k->rows);
    void *row = values->data[RHEO__FIELD_position]; /* already written to the world, and as large as a row */
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        for (uint64_t offset = 0; rheo__state_has(s, f) && rheo__in_rows(f) && offset < rheo__state_rows(s, f);
             offset++) {
            RHEO__TRY(rheo__pieces_get(pieces, index_of(s, f), (uint32_t)offset, 0, row, row_values(s, f),
                                       sizeof(rheo_real), error));
            rheo__state_write_row(s, f, offset, row);
        }
    RHEO__TRY(rheo__pieces_end(pieces, error));
    RHEO__TRY(rheo__world_check_state(world, true, error));
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(s, f) && rheo__state_hash_field(s, f) != hashes[index_of(s, f)])
            return rheo__fail(error, RHEO_ERROR_FORMAT,
                              "damaged: in the keyframe of step %llu %s does not have its hash",
                              (unsigned long long)k->step, rheo__field_table[f].name);
    if (!rheo__world_configure(world)) /* updates data derived from the state */
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the world of the recording");
    for (uint32_t i = 0; i < r->head.metric_count; i++)
        rheo__world_restore_metric(world, r->head.metrics[i].text, r->metrics[i]);
    return RHEO_OK;
}

static rheo_result load(rheo_recording *r, const rheo__keyframe *k, const rheo_allocator *allocator,
                        rheo__values *values, rheo__pieces_reader *pieces, rheo_world **world, rheo_error *error)
{
    rheo_world_def def;
    RHEO__TRY(rheo__keyframe_read(r, k, NULL, NULL, &def, error));
    if (allocator)
        def.allocator = *allocator;
    /* A world without particles tells which fields to read. */
    RHEO__TRY(create_world(&def, r->head.features, world, error));
    RHEO__TRY(rheo__head_check_world(&r->head, *world, error));
    RHEO__TRY(read_flat(pieces, k, &(*world)->state, values, error));
    if (k->particles > UINT32_MAX || k->springs > UINT32_MAX || k->bodies != (*world)->state.bodies ||
        k->vibrators != (*world)->state.vibrators)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the keyframe of step %llu contradicts its definition",
                          (unsigned long long)k->step);
    rheo_world_destroy(*world);
    *world = NULL; /* in case the next one cannot be created */
    def.particles.count = (uint32_t)k->particles;
    def.particles.position = values->data[RHEO__FIELD_position];
    def.particles.velocity = values->data[RHEO__FIELD_velocity];
    def.particles.spring_count = (uint32_t)k->springs;
    def.particles.spring_ends = values->data[RHEO__FIELD_spring_ends];
    def.particles.spring_rest_length = values->data[RHEO__FIELD_spring_rest_length];
    RHEO__TRY(create_world(&def, r->head.features, world, error));
    return fill_world(r, k, pieces, values, *world, error);
}

rheo_result rheo__keyframe_world(rheo_recording *r, const rheo__keyframe *k, const rheo_allocator *allocator,
                                 rheo_world **world, rheo_error *error)
{
    *world = NULL;
    rheo__work_state();
    RHEO__TRY(rheo__head_check_numbers(&r->head, error));
    rheo__values values = {0};
    rheo__pieces_reader pieces = pieces_of(r, k);
    rheo_result result = load(r, k, allocator, &values, &pieces, world, error);
    rheo__values_release(&values);
    rheo__bytes_release(&pieces.bytes);
    if (result != RHEO_OK) {
        rheo_world_destroy(*world);
        *world = NULL;
    }
    return result;
}

rheo_result rheo__keyframe_values(rheo_recording *r, const rheo__keyframe *k, const rheo_world *world,
                                  rheo__values *values, rheo_error *error)
{
    rheo__pieces_reader pieces = pieces_of(r, k);
    rheo_result result = read_flat(&pieces, k, &world->state, values, error);
    rheo__bytes_release(&pieces.bytes);
    return result;
}

/* Compares the stored values with a state that has the recorded hashes. */
static rheo_result compare_pieces(rheo__pieces_reader *pieces, const rheo__keyframe *k, const rheo__state *s,
                                  rheo__values *stored, rheo__values *own, rheo_error *error)
{
    bool same = true;
    RHEO__TRY(read_flat(pieces, k, s, stored, error));
    RHEO__TRY(rheo__values_take(own, s, false, error));
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (own->present >> f & 1)
            same = same && own->items[f] == stored->items[f] &&
                   memcmp(own->data[f], stored->data[f], rheo__state_row_bytes(s, f)) == 0;
    void *stored_row = stored->data[RHEO__FIELD_position], *own_row = own->data[RHEO__FIELD_position];
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        for (uint64_t offset = 0;
             same && rheo__state_has(s, f) && rheo__in_rows(f) && offset < rheo__state_rows(s, f); offset++) {
            RHEO__TRY(rheo__pieces_get(pieces, index_of(s, f), (uint32_t)offset, 0, stored_row, row_values(s, f),
                                       sizeof(rheo_real), error));
            rheo__state_read_row(s, f, offset, own_row);
            same = memcmp(stored_row, own_row, rheo__state_row_bytes(s, f)) == 0;
        }
    if (!same)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the keyframe of step %llu does not have its hashes",
                          (unsigned long long)k->step);
    return rheo__pieces_end(pieces, error);
}

rheo_result rheo__keyframe_compare(rheo_recording *r, const rheo__keyframe *k, const rheo_world *world,
                                   rheo__field_id *field, rheo_error *error)
{
    const rheo__state *s = &world->state;
    uint64_t hashes[RHEO__FIELD_COUNT];
    RHEO__TRY(rheo__keyframe_read(r, k, hashes, NULL, NULL, error));
    for (*field = 0; *field < RHEO__FIELD_COUNT; ++*field)
        if (rheo__state_has(s, *field) && rheo__state_hash_field(s, *field) != hashes[index_of(s, *field)])
            return RHEO_OK;
    if (k->rows != ring_rows(s))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the keyframe of step %llu contradicts itself",
                          (unsigned long long)k->step);
    rheo__values stored = {0}, own = {0};
    rheo__pieces_reader pieces = pieces_of(r, k);
    rheo_result result = compare_pieces(&pieces, k, s, &stored, &own, error);
    rheo__values_release(&stored);
    rheo__values_release(&own);
    rheo__bytes_release(&pieces.bytes);
    return result;
}

uint64_t rheo__keyframe_cost(uint64_t real_bytes, uint64_t rows, bool springs)
{
    return 2 * (3 * real_bytes * rows) + 8 * (6 * real_bytes + (springs ? 16 * (8 + real_bytes) : 0));
}
