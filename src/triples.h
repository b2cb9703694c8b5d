/* A host's vectors: three floats each, a stride of bytes apart; 0: without gaps. */
#ifndef SRC_TRIPLES_H
#define SRC_TRIPLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static inline size_t shb_triple_stride(size_t stride) {
    return stride ? stride : 3 * sizeof(float);
}

static inline const float *shb_triple_at(const float *triples, size_t stride, size_t index) {
    const char *bytes = (const char *)triples;
    return (const float *)(const void *)(bytes + index * shb_triple_stride(stride));
}

/* Whether triples may be so far apart. Below 12 bytes, as of strides counted in floats, they
 * overlap. */
static inline bool shb_is_triple_stride(size_t stride) {
    return stride % sizeof(float) == 0 && shb_triple_stride(stride) >= 3 * sizeof(float);
}

/* True if the last of count triples would end beyond what a pointer reaches. */
static inline bool shb_triples_overflow(size_t count, size_t stride) {
    return count && shb_triple_stride(stride) > (PTRDIFF_MAX - 3 * sizeof(float)) / count;
}

#endif
