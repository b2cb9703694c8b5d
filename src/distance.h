/* Canonical depth as a distance from the light that grows evenly, 0 .. 1, for filters that average
 * depths.
 *
 * Let y be canonical depth counted back from the far plane: 1 at the near plane, 0 at the far one.
 * A central projection has depth = A - B / w, so 1 / w is affine in y, and
 *     distance = (w - w_near) / (w_far - w_near) = (1 - y) / (1 + k y),  k = w_far / w_near - 1.
 * A parallel projection is the same with k = 0. The range ends at the far plane, or, for a central
 * projection, at twice the largest w that the map holds if that is nearer: a far plane may lie at
 * infinity. What lies beyond counts as lying there. */
#ifndef SRC_DISTANCE_H
#define SRC_DISTANCE_H

#include "map.h"

typedef struct shb_distance {
    float far_depth;       /* canonical */
    float end;             /* y where the range ends */
    float scale;           /* 1 / (1 - end) */
    float ratio;           /* k of the range */
    float relative, fixed; /* error of a stored depth: relative * |depth| + fixed */
} shb_distance;

/* Reads the depths of the map. */
shb_distance shb_distance_of(const shb_map *map);

/* y in the range: 1 at its begin, 0 at its end. NaN is at its begin. */
static inline float shb_distance_left(const shb_distance *distance, float depth) {
    const float y = ((distance->far_depth - depth) - distance->end) * distance->scale;
    const float at_most = y < 1 ? y : 1;
    return at_most > 0 ? at_most : 0;
}

static inline float shb_distance_at(const shb_distance *distance, float depth) {
    const float y = shb_distance_left(distance, depth);
    return (1 - y) / (1 + distance->ratio * y);
}

/* The depth at a distance of 0 .. 1. */
static inline float shb_distance_to_depth(const shb_distance *distance, float at) {
    const float y = (1 - at) / (1 + distance->ratio * at);
    return distance->far_depth - (y / distance->scale + distance->end);
}

/* How far rounding and the map's format may move the distance at a depth: the error of the depth
 * times the derivative of the distance, and the rounding of that itself. */
static inline float shb_distance_error(const shb_distance *distance, float depth) {
    const float size = depth < 0 ? -depth : depth;
    const float error = distance->relative * (size < 1 ? size : 1) + distance->fixed;
    const float below = 1 + distance->ratio * shb_distance_left(distance, depth);
    return error * (distance->scale * (1 + distance->ratio) / (below * below)) + 0x1p-22f;
}

#endif
