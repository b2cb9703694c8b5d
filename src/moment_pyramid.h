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
    int level_count;
    shb_moment_level levels[SHB_MOMENT_LEVELS];
    size_t bytes;
} shb_moment_pyramid;

/* Levels up to the one whose boxes are as wide as the map. Outside the map distance is 1. Works on
 * the context's threads; the bits do not depend on their number. Set exponent and count before the
 * call. False: no memory. */
bool shb_moment_pyramid_create(const shb_map *map, const shb_distance *distance,
                               shb_moment_pyramid *pyramid);

void shb_moment_pyramid_destroy(const shb_map *map, shb_moment_pyramid *pyramid);

/* Squares of widths of kernels, texels. On each axis a kernel has at most the second moment of a
 * box of its width w, w^2 / 12. */
float shb_moment_pyramid_least(void);
float shb_moment_pyramid_most(const shb_moment_pyramid *pyramid);

/* The moments of a kernel around each fragment; square_widths lie between least and most. Those of
 * fragments outside the map mean nothing. */
void shb_moment_pyramid_sample(const shb_moment_pyramid *pyramid, const shb_map_info *info,
                               const shb_receivers *receivers, const float *square_widths,
                               size_t count, shb_moment_batch *moments);

#endif
