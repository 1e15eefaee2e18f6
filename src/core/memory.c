/*
 * Memory through the world's allocator. Blocks are aligned to a cache line, which an allocator callback need not
 * guarantee; the address from the callback is stored in front of the block.
 */
#define _DEFAULT_SOURCE 1 /* madvise() */
#include "core/memory.h"

#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

enum { ALIGNMENT = 64 };

/*
 * Asks for large pages, for blocks of two or more. Stages read the partners of a particle all over a large array; with
 * small pages they would wait for page tables.
 */
static void ask_for_large_pages(void *block, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    const size_t page = (size_t)1 << 21;
    const uintptr_t start = (uintptr_t)block, first = (start + page - 1) & ~(page - 1),
                    end = (start + bytes) & ~(page - 1);
    if (bytes >= 2 * page)
        madvise((char *)block + (first - start), end - first, MADV_HUGEPAGE); /* only a hint: it may fail */
#else
    (void)block;
    (void)bytes;
#endif
}

static void *default_allocate(size_t bytes, void *user)
{
    (void)user;
    void *block = malloc(bytes);
    if (block)
        ask_for_large_pages(block, bytes);
    return block;
}

static void default_release(void *memory, void *user)
{
    (void)user;
    free(memory);
}

rheo_allocator rheo__allocator_or_default(rheo_allocator allocator)
{
    if (!allocator.allocate || !allocator.release)
        allocator = (rheo_allocator){default_allocate, default_release, NULL};
    return allocator;
}

void *rheo__allocate(const rheo_allocator *allocator, size_t count, size_t size)
{
    size_t overhead = ALIGNMENT + sizeof(void *);
    if (size != 0 && count > (SIZE_MAX - overhead) / size)
        return NULL;
    size_t bytes = count * size;
    char *raw = allocator->allocate(bytes + overhead, allocator->user);
    if (!raw)
        return NULL;
    uintptr_t start = ((uintptr_t)raw + overhead) & ~(uintptr_t)(ALIGNMENT - 1);
    char *block = raw + (start - (uintptr_t)raw);
    memcpy(block - sizeof raw, &raw, sizeof raw);
    memset(block, 0, bytes);
    return block;
}

void rheo__release(const rheo_allocator *allocator, void *memory)
{
    if (!memory)
        return;
    char *raw;
    memcpy(&raw, (char *)memory - sizeof raw, sizeof raw);
    allocator->release(raw, allocator->user);
}

/* Above this size, spare room costs more than growing again; least where nothing is kept, so that nothing is copied. */
#define RHEO__LARGE ((size_t)1 << 16)

bool rheo__grow(const rheo_allocator *allocator, void **memory, size_t *capacity, size_t count, size_t kept,
                size_t size)
{
    if (count <= *capacity && *memory)
        return true;
    size_t wanted = *capacity + *capacity / (*capacity * size <= RHEO__LARGE ? 2 : kept ? 8 : 32);
    if (wanted < count)
        wanted = count;
    void *larger = rheo__allocate(allocator, wanted, size);
    if (!larger)
        return false;
    if (kept && *memory)
        memcpy(larger, *memory, kept * size);
    rheo__release(allocator, *memory);
    *memory = larger;
    *capacity = wanted;
    return true;
}
