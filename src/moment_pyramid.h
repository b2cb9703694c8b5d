/* Moments of distance over boxes of all sizes: what filters look up whose kernels differ from
 * fragment to fragment.
 *
 * A summed-area table gives any box, but by the difference of sums over the whole map: those of
 * fourth powers, or of exponentials, take more bits than floats or doubles have to spare. Boxes
 * that are mixed from smaller ones (moments.h) lose nothing, and take no more memory: those of 2^k
 * texels lie a quarter of their width apart. A kernel is a mixture of two sizes. */
#ifndef SRC_MOMENT_PYRAMID_H
#define SRC_MOMENT_PYRAMID_H

#include "moments.h"

/* Level k has boxes of 2^(k + 1) texels; the last one is as wide as the largest map. */
enum { SHB_MOMENT_LEVELS = 14 };

typedef struct shb_moment_level {
    float *boxes; /* row by row; the first is centred on the map's corner */
    uint32_t columns, rows;
} shb_moment_level;

typedef struct shb_moment_pyramid {
    int count;      /* moments of a box: 2 or 4 */
    float exponent; /* shb_moment_warp */
    float far;      /* what is averaged outside the map */
    int level_count;
    shb_moment_level levels[SHB_MOMENT_LEVELS];
    uint32_t firsts[SHB_MOMENT_LEVELS];     /* where a level begins, boxes */
    float square_widths[SHB_MOMENT_LEVELS]; /* of the kernels of a level alone, texels */
    float *boxes;                           /* of all levels */
    size_t bytes;
} shb_moment_pyramid;

/* Levels up to the one whose boxes are as wide as the map; exponent and count are set. False: no
 * memory. */
bool shb_moment_pyramid_create(const shb_map *map, shb_moment_pyramid *pyramid);

/* Outside the map distance is 1. Works on the context's threads; the bits do not depend on their
 * number. */
void shb_moment_pyramid_fill(const shb_map *map, const shb_distance *distance,
                             shb_moment_pyramid *pyramid);

void shb_moment_pyramid_destroy(const shb_map *map, shb_moment_pyramid *pyramid);

/* Squares of widths of kernels, texels. On each axis a kernel has at most the second moment of a
 * box of its width w, w^2 / 12. */
static inline float shb_moment_pyramid_least(const shb_moment_pyramid *pyramid) {
    return pyramid->square_widths[0];
}
static inline float shb_moment_pyramid_most(const shb_moment_pyramid *pyramid) {
    return pyramid->square_widths[pyramid->level_count - 1];
}

#endif
