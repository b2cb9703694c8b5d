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

/* Works on the context's threads. False: no memory, and nothing to be destroyed. */
bool shb_light_span_create(const shb_map *map, float light_size, shb_light_span *span);
void shb_light_span_destroy(const shb_map *map, shb_light_span *span);

/* A fragment's place in the map, texels, and the canonical depth of its receiver plane there, not
 * beyond the far plane. */
typedef struct shb_light_place {
    float x, y, depth;
} shb_light_place;

/* False for a fragment that is lit because it lies outside the map, before the near plane or has no
 * plane. */
bool shb_light_place_of(const shb_map *map, const shb_light_span *span,
                        const shb_receivers *receivers, size_t index, shb_light_place *place);

/* The texels of the map that the light spans for a blocker so much nearer than the fragment. */
shb_texel_box shb_light_span_box(const shb_map *map, const shb_light_span *span,
                                 const shb_light_place *place, float nearer_by);

/* The least depth of all that could stand between fragment and light; not less than the fragment's
 * if there is nothing. */
float shb_light_span_nearest(const shb_map *map, const shb_light_span *span,
                             const shb_light_place *place);

#endif
