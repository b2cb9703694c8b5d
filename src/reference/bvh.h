/* A bounding-volume hierarchy over triangles in double precision. */
#ifndef SRC_REFERENCE_BVH_H
#define SRC_REFERENCE_BVH_H

#include "../context.h"
#include "../ray.h"

/* One half of a node: a box and what it holds. */
typedef struct shb_bvh_child {
    float box[2][3]; /* lower and upper corner, rounded outwards */
    uint32_t first;  /* of the leaf's triangles, or the number of the node below */
    uint32_t count;  /* of the leaf's triangles; 0: there is a node below */
} shb_bvh_child;

typedef struct shb_bvh_node {
    shb_bvh_child children[2];
} shb_bvh_node;

typedef struct shb_bvh {
    shb_bvh_child root;
    shb_bvh_node *nodes;
    shb_triangle *triangles; /* in the order of the leaves */
    uint32_t count;          /* of triangles; nothing is in the hierarchy if 0 */
    uint32_t *slots;         /* where the triangle with an id is; SHB_ID_NONE: left out */
    uint32_t id_count;
} shb_bvh;

/* The depth of a tree: no path from the root passes more nodes. */
#define SHB_BVH_DEPTH 72

/* The largest number of triangles. */
#define SHB_BVH_TRIANGLES_MAX (1u << 30)

/* Builds the hierarchy; false: out of memory, *bvh is untouched then. Ids must be distinct and
 * below id_count. triangles is only read. */
bool shb_bvh_build(const shb_context *context, const shb_triangle *triangles, uint32_t count,
                   uint32_t id_count, shb_bvh *bvh);

void shb_bvh_free(const shb_context *context, shb_bvh *bvh);

/* The triangle with this id, or NULL. */
const shb_triangle *shb_bvh_find(const shb_bvh *bvh, uint32_t id);

/* True if a triangle other than own_id blocks the ray (traverse.c). */
bool shb_bvh_occluded(const shb_bvh *bvh, const shb_ray *ray, uint32_t own_id);

#endif
