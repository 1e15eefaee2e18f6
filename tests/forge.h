/*
 * Takes recordings apart into chunks with inflated payloads, and writes them again with matching lengths, check sums,
 * index and, on request, hashes. A test or fuzzer can thus change the contents of a recording, so that a reader must
 * refuse the contents themselves. Not every test uses every function.
 */
#ifndef RHEO__TESTS_FORGE_H
#define RHEO__TESTS_FORGE_H

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "core/hash.h"
#include "record/recording.h"

#define FORGE __attribute__((unused)) static

typedef struct forged_chunk {
    uint32_t type, flags;
    uint64_t step;
    uint8_t *data; /* inflated payload, from malloc */
    size_t size;
} forged_chunk;

enum { FORGE_MOST = 256 };

typedef struct forged {
    forged_chunk chunk[FORGE_MOST];
    size_t count;
} forged;

FORGE uint64_t forge_get(const uint8_t *from, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)from[i] << (8 * i);
    return value;
}

FORGE void forge_put(uint8_t *to, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> (8 * i));
}

FORGE void forge_release(forged *f)
{
    for (size_t i = 0; i < f->count; i++)
        free(f->chunk[i].data);
    f->count = 0;
}

/* Inserts a chunk ahead of `place`, with a copy of the payload. False if there are too many. */
FORGE bool forge_insert(forged *f, size_t place, uint32_t type, uint32_t flags, uint64_t step, const void *data,
                        size_t size)
{
    if (f->count == FORGE_MOST)
        return false;
    memmove(f->chunk + place + 1, f->chunk + place, (f->count - place) * sizeof *f->chunk);
    f->count++;
    f->chunk[place] = (forged_chunk){type, flags, step, malloc(size + 1), size};
    if (size)
        memcpy(f->chunk[place].data, data, size);
    return true;
}

FORGE void forge_remove(forged *f, size_t place)
{
    free(f->chunk[place].data);
    f->count--;
    memmove(f->chunk + place, f->chunk + place + 1, (f->count - place) * sizeof *f->chunk);
}

/* Splits bytes into chunks of at most `most` bytes in total, as long as they look like chunks. Ignores check sums. */
FORGE void forge_open(forged *f, const uint8_t *bytes, size_t size, size_t most)
{
    f->count = 0;
    for (size_t at = 8; at + 36 <= size && f->count < FORGE_MOST;) {
        uint64_t stored = forge_get(bytes + at + 16, 8), raw = forge_get(bytes + at + 24, 8);
        uint32_t flags = (uint32_t)forge_get(bytes + at + 4, 4);
        if (stored > size - at - 36 || raw > most)
            return;
        most -= (size_t)raw;
        uint8_t *data = malloc((size_t)raw + 1);
        uLongf got = (uLongf)raw;
        if (!(flags & RHEO__CHUNK_ZLIB) && raw == stored)
            memcpy(data, bytes + at + 32, (size_t)raw);
        else if (!(flags & RHEO__CHUNK_ZLIB) || uncompress(data, &got, bytes + at + 32, (uLong)stored) != Z_OK ||
                 got != raw) {
            free(data);
            return;
        }
        f->chunk[f->count++] = (forged_chunk){(uint32_t)forge_get(bytes + at, 4), flags, forge_get(bytes + at + 8, 8),
                                              data, (size_t)raw};
        at += 36 + (size_t)stored;
    }
}

/*
 * Writes the chunks, compressed if their flags say so and it helps. `index`: adds a matching index. Returns 0 if
 * there is not enough room.
 */
FORGE size_t forge_write(forged *f, bool index, uint8_t *to, size_t room)
{
    size_t at = 8, start = 0, entries = 0;
    bool pending = false, indexed = false;
    uint8_t entry[24 * FORGE_MOST];
    if (room < at)
        return 0;
    memcpy(to, rheo__magic, 8);
    for (size_t i = 0; i < f->count; i++) {
        forged_chunk *c = &f->chunk[i];
        if (c->type == RHEO__INDX && index) {
            c->data = realloc(c->data, indexed ? 1 : entries + 1);
            c->size = indexed ? 0 : entries;
            memcpy(c->data, entry, c->size);
            indexed = true;
        }
        uLongf stored = (uLongf)c->size;
        uint32_t flags = c->flags & ~(uint32_t)RHEO__CHUNK_ZLIB;
        if (c->flags & RHEO__CHUNK_ZLIB) {
            uLongf bound = compressBound(stored);
            uint8_t *smaller = malloc(bound);
            if (compress2(smaller, &bound, c->data, stored, 1) == Z_OK && bound < stored && at + 36 + bound <= room) {
                memcpy(to + at + 32, smaller, bound);
                stored = bound;
                flags |= RHEO__CHUNK_ZLIB;
            }
            free(smaller);
        }
        if (room - at < 36 || room - at - 36 < stored)
            return 0;
        if (!(flags & RHEO__CHUNK_ZLIB))
            memcpy(to + at + 32, c->data, c->size);
        forge_put(to + at, c->type, 4);
        forge_put(to + at + 4, flags, 4);
        forge_put(to + at + 8, c->step, 8);
        forge_put(to + at + 16, stored, 8);
        forge_put(to + at + 24, c->size, 8);
        forge_put(to + at + 32 + stored, crc32(0, to + at, (uInt)(32 + stored)), 4);
        if (!pending)
            start = at;
        at += 36 + stored;
        if (c->type == RHEO__KEYF) {
            forge_put(entry + entries, c->step, 8);
            forge_put(entry + entries + 8, start, 8);
            forge_put(entry + entries + 16, at, 8);
            entries += 24;
        }
        bool piece = c->type == RHEO__FILD || c->type == RHEO__STAT || c->type == RHEO__INPT;
        pending = piece || (pending && c->type != RHEO__KEYF && c->type != RHEO__STEP && c->type != RHEO__FAIL);
    }
    return at;
}

/* The n-th chunk of a type, or NULL. */
FORGE forged_chunk *forge_find(forged *f, uint32_t type, size_t n)
{
    for (size_t i = 0; i < f->count; i++)
        if (f->chunk[i].type == type && n-- == 0)
            return &f->chunk[i];
    return NULL;
}

/* Sets the first number of a parameter in the n-th keyframe. False if there is no such keyframe or parameter. */
FORGE bool forge_parameter(forged *f, size_t n, const char *name, double value)
{
    forged_chunk *c = forge_find(f, RHEO__KEYF, n);
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (size_t at = 0; c && at + strlen(name) + 12 <= c->size; at++)
        if (memcmp(c->data + at, name, strlen(name)) == 0) {
            forge_put(c->data + at + strlen(name) + 4, bits, 8);
            return true;
        }
    return false;
}

/* ---- Hashes ---- */

typedef struct forged_field {
    char name[32];
    uint32_t element, components, location, storage;
    uint64_t items, sum, rows; /* sum of the hash */
    uint8_t *values;           /* values of part 0, little-endian */
    size_t size;
} forged_field;

/* Adds a row's words to the sum of its field. */
FORGE void forge_row(forged_field *field, uint64_t lag, const uint8_t *values, size_t size)
{
    for (size_t at = 0; at < size; at += 8)
        field->sum += rheo__hash_word(lag, at / 8, forge_get(values + at, size - at < 8 ? size - at : 8));
}

/* Reads the pieces of a keyframe up to the first invalid one. */
FORGE void forge_pieces(forged_field *fields, uint32_t count, const forged_chunk *c)
{
    rheo__cursor cursor = {c->data, c->size, 0, false};
    while (rheo__cursor_left(&cursor) >= 24) {
        uint32_t f = rheo__get_u32(&cursor), part = rheo__get_u32(&cursor);
        uint64_t first = rheo__get_u64(&cursor), n = rheo__get_u64(&cursor);
        if (f >= count || fields[f].element > 3)
            return;
        size_t element = fields[f].element % 2 ? 8 : 4; /* float, double, u32, u64 */
        if (n > rheo__cursor_left(&cursor) / element || first > 1 << 20)
            return;
        uint8_t *bytes = calloc((size_t)n + 1, element);
        for (size_t plane = 0; plane < element; plane++)
            for (size_t i = 0; i < n; i++)
                bytes[i * element + plane] = cursor.data[cursor.offset + plane * (size_t)n + i];
        cursor.offset += (size_t)n * element;
        size_t from = (size_t)first * element, size = (size_t)n * element;
        if (fields[f].storage == RHEO__RING || fields[f].storage == RHEO__MODES) { /* rows in one piece only */
            forge_row(&fields[f], part, bytes, size);
            fields[f].rows = part + (uint64_t)1;
        } else if (from == fields[f].size) {
            fields[f].values = realloc(fields[f].values, from + size + 1);
            memcpy(fields[f].values + from, bytes, size);
            fields[f].size += size;
        }
        free(bytes);
    }
}

/* Sets the hashes of every keyframe to those of its values. */
FORGE void forge_hashes(forged *f)
{
    rheo__head head;
    rheo_error ignored;
    forged_field fields[64];
    if (f->count == 0)
        return;
    rheo__cursor in_head = {f->chunk[0].data, f->chunk[0].size, 0, false};
    if (f->chunk[0].type != RHEO__HEAD || rheo__head_get(&in_head, &head, &ignored) != RHEO_OK)
        return;
    for (size_t k = 0, first = 0; k < f->count; k++) {
        forged_chunk *c = &f->chunk[k];
        if (c->type != RHEO__KEYF)
            continue;
        rheo__cursor layout = {head.layout.data, head.layout.size, 0, false};
        uint32_t count = rheo__get_u32(&layout);
        rheo__cursor counts = {c->data, c->size, 0, false};
        uint64_t items[5];
        items[RHEO_LOCATION_WORLD] = 1;
        items[RHEO_LOCATION_PARTICLE] = rheo__get_u64(&counts);
        items[RHEO_LOCATION_BODY] = rheo__get_u64(&counts);
        items[RHEO_LOCATION_VIBRATOR] = rheo__get_u64(&counts);
        items[RHEO_LOCATION_SPRING] = rheo__get_u64(&counts);
        for (uint32_t i = 0; i < count; i++) {
            fields[i] = (forged_field){.rows = 0};
            rheo__get_text(&layout, fields[i].name, sizeof fields[i].name);
            fields[i].element = rheo__get_u32(&layout);
            fields[i].components = rheo__get_u32(&layout);
            fields[i].location = rheo__get_u32(&layout);
            fields[i].storage = rheo__get_u32(&layout);
            fields[i].items = fields[i].location < 5 ? items[fields[i].location] : 0;
        }
        for (; first < k; first++)
            if (f->chunk[first].type == RHEO__FILD)
                forge_pieces(fields, count, &f->chunk[first]);
        const forged_field *ends = NULL;
        for (uint32_t i = 0; i < count && 48 + 8 * (size_t)i + 8 <= c->size; i++) {
            forged_field *field = &fields[i];
            if (strcmp(field->name, "spring_ends") == 0)
                ends = field;
            if (field->storage == RHEO__FLAT) {
                field->rows = 1;
                forge_row(field, 0, field->values, field->size);
            } else if (field->storage == RHEO__SPRING && ends) {
                size_t real = head.real_bytes;
                field->rows = 1;
                for (size_t s = 0; 8 * s + 8 <= ends->size && (field == ends || real * s + real <= field->size);
                     s++) {
                    const uint64_t a = rheo__hash_key((uint32_t)forge_get(ends->values + 8 * s, 4)),
                                   b = rheo__hash_key((uint32_t)forge_get(ends->values + 8 * s + 4, 4));
                    field->sum +=
                        field == ends
                            ? a * b
                            : (a + b) * rheo__hash_length((rheo__real_bits)forge_get(field->values + real * s, real));
                }
            }
            forge_put(c->data + 48 + 8 * (size_t)i, rheo__hash_field(field->sum, field->rows, field->items), 8);
        }
        for (uint32_t i = 0; i < count; i++)
            free(fields[i].values);
    }
    rheo__head_release(&head);
}

/* Sets the hashes of every step and of the end mark to those of a simulation. `bytes` is the recording. */
FORGE void forge_steps(forged *f, const uint8_t *bytes, size_t size)
{
    rheo_recording *r;
    rheo_world *world;
    rheo_error ignored;
    if (rheo_recording_open_memory(bytes, size, &r, &ignored) != RHEO_OK)
        return;
    if (rheo_recording_world(r, r->first_step, NULL, &world, &ignored) == RHEO_OK) {
        bool going = true;
        for (size_t i = 0; i < r->step_count && going; i++) {
            forged_chunk *c = forge_find(f, RHEO__STEP, i);
            going =
                c && rheo__recording_command(r, &r->steps[i], r->first_step + 1 + i, world, &ignored) == RHEO_OK &&
                rheo__world_step_traced(world, NULL, 0, &ignored) == RHEO_OK && c->size >= 8 + 8 * world->trace.count;
            for (size_t n = 0; going && n < world->trace.count; n++)
                forge_put(c->data + 8 + 8 * n, world->trace.hash[n], 8);
        }
        forged_chunk *done = forge_find(f, RHEO__DONE, 0);
        if (going && done && done->size == 28)
            forge_put(done->data + 16, rheo_world_hash(world), 8);
        rheo_world_destroy(world);
    }
    rheo_recording_close(r);
}

#endif
