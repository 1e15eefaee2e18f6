#define _GNU_SOURCE /* MAP_ANONYMOUS, MAP_NORESERVE */
#include "arena.h"

#include <sys/mman.h>

#include "support.h"

/* Each block has at least GUARD bytes behind it, which nobody may write. */
enum { HEADER = 32, UNIT = 16, GUARD = 16 };
#define GUARDED UINT32_C(0x6b7e6b7e)
_Static_assert(_Alignof(max_align_t) <= UNIT, "malloc promises no more than what is given");

struct arena arena;

typedef struct header {
    size_t room, bytes;
} header;

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t bytes);
void __real_free(void *memory);

static header *header_of(void *memory)
{
    return (header *)(void *)((char *)memory - HEADER);
}

static bool in_arena(const void *memory)
{
    return arena.start && (const char *)memory >= arena.start && (const char *)memory < arena.start + arena.size;
}

void fill(void *memory, size_t bytes, uint32_t word)
{
    char *to = memory;
    for (size_t i = 0; i + sizeof word <= bytes; i += sizeof word)
        memcpy(to + i, &word, sizeof word);
    memcpy(to + bytes / sizeof word * sizeof word, &word, bytes % sizeof word);
}

/* A block that is used again may be much longer than it has to be. */
static size_t guard_length(const header *h)
{
    const size_t behind = h->room - h->bytes;
    return behind < 2 * GUARD ? behind : 2 * GUARD;
}

static void put_guard(void *memory)
{
    const header *h = header_of(memory);
    fill((char *)memory + h->bytes, guard_length(h), GUARDED);
}

static bool guard_is_whole(void *memory)
{
    const header *h = header_of(memory);
    const char *guard = (char *)memory + h->bytes;
    for (size_t i = 0; i < guard_length(h); i++) {
        const uint32_t word = GUARDED;
        if (guard[i] != ((const char *)&word)[i % sizeof word])
            return false;
    }
    return true;
}

static uint64_t random_number(void)
{
    arena.random = arena.random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return arena.random >> 33;
}

static void *spare_block(size_t room)
{
    for (size_t i = arena.spares; i-- > 0;) {
        void *memory = arena.spare[i];
        if (header_of(memory)->room < room)
            continue;
        memmove(arena.spare + i, arena.spare + i + 1, (--arena.spares - i) * sizeof *arena.spare);
        arena.reused++;
        return memory;
    }
    return NULL;
}

static void *take(size_t bytes)
{
    const size_t room = (bytes + GUARD + HEADER + UNIT - 1) / UNIT * UNIT;
    char *memory = arena.order == ORDER_REUSED ? spare_block(room - HEADER) : NULL;
    if (!memory) {
        if (arena.order == ORDER_GAPS)
            arena.low += UNIT * (random_number() % 300) + (random_number() % 8 == 0 ? 65536 : 0);
        if (room > (size_t)(arena.high - arena.low)) {
            fprintf(stderr, "the arena is too small\n");
            abort();
        }
        if (arena.order == ORDER_DOWN)
            memory = arena.high -= room;
        else
            memory = arena.low, arena.low += room;
        memory += HEADER;
        header_of(memory)->room = room - HEADER;
    }
    header_of(memory)->bytes = bytes;
    fill(memory, bytes, arena.fresh);
    put_guard(memory);
    arena.live++;
    return memory;
}

static void give(void *memory)
{
    arena.overruns += !guard_is_whole(memory);
    fill(memory, header_of(memory)->bytes, arena.freed);
    arena.live--;
    if (arena.order == ORDER_REUSED && arena.spares < ARENA_MOST_FREE)
        arena.spare[arena.spares++] = memory;
}

void *__wrap_malloc(size_t bytes)
{
    if (arena.order == ORDER_PLAIN)
        return __real_malloc(bytes);
    arena.from_malloc++;
    return take(bytes);
}

void *__wrap_calloc(size_t count, size_t size)
{
    if (arena.order == ORDER_PLAIN)
        return __real_calloc(count, size);
    arena.from_malloc++;
    if (size && count > SIZE_MAX / 2 / size)
        return NULL;
    void *memory = take(count * size);
    memset(memory, 0, count * size);
    return memory;
}

void __wrap_free(void *memory)
{
    if (in_arena(memory))
        give(memory);
    else
        __real_free(memory);
}

/* Always moves the block. */
void *__wrap_realloc(void *memory, size_t bytes)
{
    if (arena.order == ORDER_PLAIN || (memory && !in_arena(memory)))
        return __real_realloc(memory, bytes);
    arena.from_malloc++;
    void *moved = take(bytes);
    if (memory) {
        size_t kept = header_of(memory)->bytes;
        memcpy(moved, memory, kept < bytes ? kept : bytes);
        give(memory);
        arena.moved++;
    }
    return moved;
}

void *world_allocate(size_t bytes, void *user)
{
    (void)user;
    arena.from_worlds++;
    return take(bytes);
}
void world_release(void *memory, void *user)
{
    (void)user;
    give(memory);
}

void arena_begin(memory_order order, uint32_t fresh, uint32_t freed, uint64_t seed)
{
    if (!arena.start) {
        arena.size = sizeof(void *) > 4 ? (size_t)1 << 30 : (size_t)1 << 28;
        void *start =
            mmap(NULL, arena.size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        assert_true(start != MAP_FAILED);
        arena.start = start;
    }
    arena.fresh = fresh;
    arena.freed = freed;
    arena.random = seed;
    arena.low = arena.start + UNIT; /* the least alignment allowed */
    arena.high = arena.start + arena.size - 3 * UNIT;
    arena.live = arena.from_malloc = arena.from_worlds = arena.moved = arena.reused = arena.spares = 0;
    arena.overruns = 0;
    arena.order = order;
}

void arena_end(void)
{
    arena.order = ORDER_PLAIN;
    assert_int_equal(arena.live, 0);     /* the library has released everything */
    assert_int_equal(arena.overruns, 0); /* and written nothing behind its blocks */
    assert_int_equal(madvise(arena.start, arena.size, MADV_DONTNEED), 0);
}
