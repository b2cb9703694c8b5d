/* How many texels a light of some width spans as a fragment sees it.
 *
 * Let u = 1 / w, which is affine in the map's depth: depth = c - q u. A texel at the clip distance
 * w_b whose place in the map lies x texels from that of the fragment, at w_r, is t x w_b away from
 * the line between fragment and light in the texel's plane, t being a texel's width where w is 1.
 * The ray from the fragment past it meets the light's plane, where w is 0, in
 *     t x w_b w_r / (w_r - w_b) = t x / (u_b - u_r) = t q x / (depth_r - depth_b)
 * from the middle of the light. So a light of width L spans k (depth_r - depth_b) texels about the
 * fragment's place, k = L / (t q), and a texel lies at 0.5 + x / (k (depth_r - depth_b)) of it.
 * Under parallel rays, with L the width at the distance of one unit, the same follows at once. */
#ifndef SRC_LIGHT_SPAN_H
#define SRC_LIGHT_SPAN_H

#include "depth_minima.h"

typedef struct shb_light_span {
    float x, y;                  /* k of columns and rows */
    float near_depth, far_depth; /* canonical */
    shb_depth_minima minima;
} shb_light_span;

/* False: no memory. */
bool shb_light_span_create(const shb_map *map, float light_size, shb_light_span *span);

/* Reads the depths of the map. Works on the context's threads. */
void shb_light_span_fill(const shb_map *map, const shb_light_span *span);

void shb_light_span_destroy(const shb_map *map, shb_light_span *span);

/* What could stand between fragments and the light. */
typedef struct shb_light_windows {
    SHB_ALIGN float x[SHB_BATCH], y[SHB_BATCH]; /* the fragment's place in the map, texels */
    float depth[SHB_BATCH];   /* of its receiver plane there, not beyond the far plane */
    float nearest[SHB_BATCH]; /* no texel that could stand between is nearer; not less than depth if
                                 there is nothing, or the fragment lies outside the map, before the
                                 near plane or has no plane */
    int32_t x0[SHB_BATCH], y0[SHB_BATCH]; /* the texels of the map that the light spans for the */
    int32_t x1[SHB_BATCH], y1[SHB_BATCH]; /* nearest, last ones included */
} shb_light_windows;

#endif
