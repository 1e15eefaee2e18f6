/*
 * Memory in a chosen order and with chosen contents. The linker redirects all memory calls of the test program and
 * its copy of the library to this arena (--wrap=malloc, ...). The arena answers them unless the order is ORDER_PLAIN.
 */
#ifndef RHEO__TESTS_ARENA_H
#define RHEO__TESTS_ARENA_H

#include <stddef.h>
#include <stdint.h>

typedef enum memory_order {
    ORDER_PLAIN,  /* the C library's order */
    ORDER_UP,     /* ascending addresses */
    ORDER_DOWN,   /* descending addresses */
    ORDER_GAPS,   /* random gaps and alignments that malloc may produce */
    ORDER_REUSED, /* the last released block that is large enough */
} memory_order;

enum { ARENA_MOST_FREE = 1 << 16 };

struct arena {
    memory_order order;
    uint32_t fresh, freed; /* words that fill new and released memory */
    char *start, *low, *high;
    size_t size;
    uint64_t random;
    size_t live, from_malloc, from_worlds, moved, reused; /* counts */
    size_t overruns; /* blocks that were released with bytes behind them changed */
    void *spare[ARENA_MOST_FREE];
    size_t spares;
};

extern struct arena arena;

/* Memory calls of the test and the library. */
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t bytes);
void __wrap_free(void *memory);

/* Fills memory with copies of a word. */
void fill(void *memory, size_t bytes, uint32_t word);

/* Allocator functions of worlds. */
void *world_allocate(size_t bytes, void *user);
void world_release(void *memory, void *user);

/* New memory is filled with the word `fresh`, released memory with `freed`. */
void arena_begin(memory_order order, uint32_t fresh, uint32_t freed, uint64_t seed);
/* Fails unless the library has released everything, and has written nothing behind its blocks. */
void arena_end(void);

#endif
