/* The next whole batch of a host's points. Its memory is prefetched while the batch before is
 * worked on, as no processor does that for so many streams by itself: a few lines at a time, since
 * too many requests hold up all that follows. */
#ifndef SRC_NEXT_BATCH_H
#define SRC_NEXT_BATCH_H

#include "shadowbias/bias.h"

#include <stddef.h>

typedef struct shb_next_batch {
    const char *positions, *normals; /* normals: NULL if nobody reads them */
    size_t position_stride, normal_stride;
    float *visibility; /* a store that waits for its line holds up all stores behind it */
} shb_next_batch;

/* In a line of 64 bytes. */
#define SHB_LINE_FLOATS 16

static inline void shb_prefetch_elements(const char *base, size_t stride, size_t first) {
    const size_t line = 64, step = stride > line ? stride : line;
    for (size_t i = 0; i < SHB_LINE_FLOATS * stride; i += step)
        __builtin_prefetch(base + first * stride + i);
}

/* Asks for SHB_LINE_FLOATS elements from the first of such a line on. next: NULL for nothing. */
static inline void shb_prefetch_next(const shb_next_batch *next, size_t first) {
    if (!next)
        return;
    shb_prefetch_elements(next->positions, next->position_stride, first);
    if (next->normals)
        shb_prefetch_elements(next->normals, next->normal_stride, first);
    __builtin_prefetch(next->visibility + first, 1);
}

static inline void shb_prefetch_whole(const shb_next_batch *next) {
    for (size_t i = 0; i < SHB_BATCH; i += SHB_LINE_FLOATS)
        shb_prefetch_next(next, i);
}

#endif
