/* How far rows of texels lie apart in memory. */
#ifndef SRC_PADDED_ROWS_H
#define SRC_PADDED_ROWS_H

#include <stddef.h>

/* Bytes from one row to the next. Rows start on cache lines, and one line of padding keeps the rows
 * of a power-of-two image from competing for the same cache sets. */
static inline size_t shb_padded_stride(size_t columns, size_t texel_size) {
    return (columns * texel_size + 63) / 64 * 64 + 64;
}

#endif
