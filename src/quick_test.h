/* The hard test in float, for the fragments of a batch for which it is sure to say what the double
 * projection would: a visibility is one bit, and only near a texel's border or near the stored
 * depth does that bit depend on how coordinates are rounded. */
#ifndef SRC_QUICK_TEST_H
#define SRC_QUICK_TEST_H

#include "map.h"

/* A bias method that the test knows: the depth of the fragment, or of its plane at the texel's
 * centre, less epsilon[0] + epsilon[1] / w + epsilon[2] / w^2 (canonical depth). */
typedef struct shb_quick_bias {
    bool plane;
    double epsilon[3];
} shb_quick_bias;

/* Positions and normals of a batch. */
typedef struct shb_quick_points {
    const float *position[3], *normal[3]; /* those of x, y and z */
    /* A host's triples without gaps in place of arrays: a whole batch of them. What comes after it
     * is asked for meanwhile, as no processor would go on with the streams by itself: from these
     * places on, in arrays of as many elements, that of the answers last. */
    bool packed;
    const float *next_position, *next_normal;
    float *next_visibility;
} shb_quick_points;

/* Of arrays. */
static inline shb_quick_points shb_quick_points_of(const shb_receivers *r) {
    return (shb_quick_points){.position = {r->x, r->y, r->z},
                              .normal = {r->normal_x, r->normal_y, r->normal_z}};
}

/* Where the fragments of a batch lie, and the largest element of a normal. */
typedef struct shb_quick_extent {
    float least[3], most[3], normal;
} shb_quick_extent;

/* Row times (way from the origin, 1). */
typedef float shb_quick_row[4];

/* What fragments have in common that lie in a box. x and y are counted from the centre of the texel
 * (texel_x, texel_y) on, and z from depth on. */
typedef struct shb_quick_test {
    bool known;                /* else the next batch says where it is to be made for */
    float origin[3], reach[3]; /* of the box: its middle and half of its size */
    float normal;              /* the largest element of a normal */
    shb_quick_row x, y, z, w;
    int32_t texel_x, texel_y;
    float depth, farthest;
    float epsilon[3];
    /* A texel is sure where the coordinate lies nearer than this to its middle, and a comparison
     * where both sides differ by more than error. */
    float sure, error;
    /* The elements that a plane's slopes are made of, as in k_project.inl, and by what their
     * errors count: as 1 / n.xy, as the slopes over it, as the slopes; and how much that may be. */
    float xy[3], zy[3], xz[3], xw[3], yw[3], zw[3];
    float error_xy, error_other, error_slope, most_error;
} shb_quick_test;

/* False: the test does not know the method, or this map. */
bool shb_quick_bias_of(const shb_map *map, const shb_bias *bias, shb_quick_bias *quick);

/* For a batch, and others that lie near. False: nothing is sure there. */
bool shb_quick_test_of(const shb_map *map, const shb_quick_bias *bias,
                       const shb_quick_extent *extent, shb_quick_test *test);

#endif
