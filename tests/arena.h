/*
 * Memory in a chosen order and with chosen contents. The linker leads all calls for memory of the test program and of
 * the library in it here (--wrap=malloc, ...); the arena answers them unless the order is ORDER_PLAIN.
 */
#ifndef RHEO__TESTS_ARENA_H
#define RHEO__TESTS_ARENA_H

#include <stddef.h>
#include <stdint.h>

typedef enum memory_order {
    ORDER_PLAIN,  /* the C library's */
    ORDER_UP,     /* each block after the last */
    ORDER_DOWN,   /* each block before the last */
    ORDER_GAPS,   /* random distances and alignments, of those that malloc may give */
    ORDER_REUSED, /* the block that was given back last and is large enough */
} memory_order;

enum { ARENA_MOST_FREE = 1 << 16 };

struct arena {
    memory_order order;
    uint32_t fresh, freed; /* words that memory is filled with */
    char *start, *low, *high;
    size_t size;
    uint64_t random;
    size_t live, from_malloc, from_worlds, moved, reused; /* counts */
    void *spare[ARENA_MOST_FREE];
    size_t spares;
};

extern struct arena arena;

/* Calls for memory of the test and the library. */
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t bytes);
void __wrap_free(void *memory);

/* Fills memory with copies of a word. */
void fill(void *memory, size_t bytes, uint32_t word);

/* An allocator of worlds. */
void *world_allocate(size_t bytes, void *user);
void world_release(void *memory, void *user);

/* Fresh memory is filled with the word `fresh`, released memory with `freed`. */
void arena_begin(memory_order order, uint32_t fresh, uint32_t freed, uint64_t seed);
/* Fails unless the library has released everything. */
void arena_end(void);

#endif
