/* The exact method on maps that keep triangles. */
#ifndef SRC_EXACT_TRIANGLES_H
#define SRC_EXACT_TRIANGLES_H

#include "exact_points.h"
#include "kernels/lists.h"

/* Points that ask at the same time. The four samples around a point are what the four texels hold
 * whose centres are nearest: its own texel, the one beside it, the one above or below, and the one
 * beside that. */
typedef struct shb_walk_group {
    shb_list_group at;
    size_t count;
    /* The bounds of light_point.h, of the point's own rounding times the size of a coordinate, and
     * of calculation. */
    SHB_ALIGN double by_position[3][SHB_LIST_GROUP];
    double error_x[SHB_LIST_GROUP], error_y[SHB_LIST_GROUP], error_z[SHB_LIST_GROUP];
    int32_t beside[SHB_LIST_GROUP], above[SHB_LIST_GROUP]; /* to the other texels: -1 or 1 */
    uint32_t own_ids[SHB_LIST_GROUP];                      /* the points' triangles */
    uint32_t samples[4][SHB_LIST_GROUP];                   /* triangles */
    /* How far ways from the samples have come: there, or one triangle on. */
    uint32_t ends[4][SHB_LIST_GROUP];
    uint16_t numbers[SHB_LIST_GROUP]; /* of the points in the batch */
    /* One bit a point. The triangle where the first way has come covers the point's place, and lies
     * in front of it, is its own surface, or lies behind it; that is so and the other ways have
     * come to this triangle, too, or beside it. */
    uint64_t in_front, own, behind, joined;
} shb_walk_group;

/* One batch; receivers holds its positions and normals. */
void shb_exact_ask_triangles(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility);

#endif
