/* The exact method on maps that keep triangles. */
#ifndef SRC_EXACT_TRIANGLES_H
#define SRC_EXACT_TRIANGLES_H

#include "exact_points.h"
#include "kernels/lists.h"

/* Points that ask at the same time. The four samples around a point are what the four texels hold
 * whose centres are nearest: above left, above, left and the last one, by reading order. */
typedef struct shb_walk_group {
    shb_list_group at;
    size_t count;
    const uint32_t *own_ids; /* of the points' triangles */
    /* The bounds of light_point.h, of the point's own rounding over the size of a coordinate, and
     * of calculation. */
    SHB_ALIGN double by_position[SHB_LIST_GROUP];
    double error_x[SHB_LIST_GROUP], error_y[SHB_LIST_GROUP], error_z[SHB_LIST_GROUP];
    uint32_t samples[4][SHB_LIST_GROUP];               /* triangles */
    int32_t left[SHB_LIST_GROUP], top[SHB_LIST_GROUP]; /* texel of the first sample */
    uint8_t nearest[SHB_LIST_GROUP]; /* number of the sample of the point's own texel */
    /* One bit a point. The nearest sample's triangle covers its place, and lies in front of it, is
     * its own surface, or lies behind it; all samples hold that triangle, or others that go on
     * beyond its edges; the point is one of the group's and lies inside the map. */
    uint64_t in_front, own, behind, joined, inside;
} shb_walk_group;

/* One batch; receivers holds its positions and normals. */
void shb_exact_ask_triangles(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility);

#endif
