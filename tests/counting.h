/* An allocator that counts the bytes in use. */
#ifndef RHEO__TESTS_COUNTING_H
#define RHEO__TESTS_COUNTING_H

#include <stdlib.h>

static size_t bytes_in_use, most_bytes_in_use;

static void *count_allocate(size_t bytes, void *user)
{
    (void)user;
    size_t *block = malloc(bytes + 16);
    if (!block)
        return NULL;
    *block = bytes;
    bytes_in_use += bytes;
    most_bytes_in_use = bytes_in_use > most_bytes_in_use ? bytes_in_use : most_bytes_in_use;
    return (char *)block + 16;
}

static void count_release(void *memory, void *user)
{
    (void)user;
    if (!memory)
        return;
    size_t *block = (size_t *)(void *)((char *)memory - 16);
    bytes_in_use -= *block;
    free(block);
}

#endif
