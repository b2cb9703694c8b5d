/* The test of mutual planes in float: what a map's fragments have in common. */
#ifndef SRC_QUICK_PLANES_H
#define SRC_QUICK_PLANES_H

struct shb_map;

/* Names as in quick_planes.c. */
typedef struct shb_quick_planes {
    float xy[3], zy[3], xz[3], xw[3], yw[3], zw[3]; /* X x Y, Z x Y, ... */
    float middle_x, middle_y;                       /* of the map, texels */
    float moved;                                    /* R by sum |n_i P_i| / w^2 */
    float error, depth_error;                       /* E by nu, and by nu and |d| */
    float beta;
    float farthest;              /* psi from which on nothing is surely shadowed */
    float steep, steep_by_place; /* what D has to be above: plain, by nu psi */
    float own, own_by_normal, own_by_place, own_by_w; /* U: plain, by nu, nu psi, nu psi / w */
    float step_unit;                                  /* of the steps of slopes in k_slopes.inl */
    float occluder_by_place, occluder_by_slope;       /* V: by psi, psi and slopes */
    float diagonal; /* what depth changes by on a texel at 45 degrees to the light, times w */
} shb_quick_planes;

/* Of a map that keeps planes, whose slope unit is known. Where its numbers leave the range that
 * floats are good for, nothing is sure. */
shb_quick_planes shb_quick_planes_of(const struct shb_map *map);

#endif
