/* Clipping against the near plane and the guard band, in clip space and in double.
 *
 * The guard band holds the window coordinates -16384 .. 16384 on both axes. The target lies inside
 * it, and a coordinate snapped to 1/256 pixel stays within +-2^22. There is no far plane: what lies
 * beyond it loses the depth test against the far depth. */
#ifndef SRC_CLIP_H
#define SRC_CLIP_H

#include "transform.h"

#define SHB_GUARD_PIXELS 16384.0

/* Coordinates above this are as useless as infinite ones: products of three stay finite below it.
 */
#define SHB_CLIP_MAX 0x1p300

/* A w below this (zero, negative, or without a finite reciprocal) cannot be projected. */
#define SHB_W_MIN 0x1p-1022

#define SHB_CUT_PLANES 5
#define SHB_POLYGON_MAX (3 + SHB_CUT_PLANES)

/* Inside is sign * v[axis] + offset * w >= 0; sign is 1 or -1. */
typedef struct shb_clip_plane {
    int axis;
    double sign, offset;
} shb_clip_plane;

typedef struct shb_clip_volume {
    shb_clip_plane cut[SHB_CUT_PLANES]; /* near plane first, then the guard band */
    shb_clip_plane border[4];           /* of the target */
} shb_clip_volume;

typedef struct shb_polygon {
    size_t count;
    shb_clip_position corners[SHB_POLYGON_MAX];
} shb_polygon;

typedef enum shb_clip_outcome {
    SHB_CLIP_OUTSIDE, /* nothing is left that the target can see */
    SHB_CLIP_WHOLE,   /* the polygon is the triangle */
    SHB_CLIP_CUT
} shb_clip_outcome;

shb_clip_volume shb_clip_volume_of(uint32_t width, uint32_t height, bool reversed);

/* True if all coordinates are finite and of a usable size. */
bool shb_clip_is_finite(const shb_clip_position *position);

/* Clips a triangle of finite corners. Corners of the polygon keep the triangle's order and have a w
 * of at least SHB_W_MIN. */
shb_clip_outcome shb_clip_triangle(const shb_clip_volume *volume,
                                   const shb_clip_position corners[3], shb_polygon *polygon);

#endif
