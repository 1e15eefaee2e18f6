/* Memory through the world's allocator, with checked sizes and buffers that grow. */
#ifndef RHEO__CORE_MEMORY_H
#define RHEO__CORE_MEMORY_H

#include "rheolog/base.h"

/* Fills missing callbacks with malloc and free. */
rheo_allocator rheo__allocator_or_default(rheo_allocator allocator);

/*
 * Returns count x size bytes, zeroed (old contents must never become hidden state) and aligned to 64 bytes. NULL on
 * overflow or if there is no memory.
 */
void *rheo__allocate(const rheo_allocator *allocator, size_t count, size_t size);
void rheo__release(const rheo_allocator *allocator, void *memory); /* NULL is allowed */

/*
 * Makes room for `count` items in *memory and keeps the first `kept`. *capacity grows by at least half; if it is large,
 * by an eighth, or by 1/32 if nothing is kept. False: no memory, nothing changed.
 */
bool rheo__grow(const rheo_allocator *allocator, void **memory, size_t *capacity, size_t count, size_t kept,
                size_t size);

#endif
