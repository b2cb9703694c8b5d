/* An exclusive prefix sum: the first step of every counting sort. */
#ifndef SRC_STARTS_H
#define SRC_STARTS_H

#include <stddef.h>

/* The lengths of lists that follow each other become the places where they start; returns the sum.
 */
static inline size_t shb_starts_of_lengths(size_t count, size_t *lengths) {
    size_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t length = lengths[i];
        lengths[i] = sum;
        sum += length;
    }
    return sum;
}

#endif
