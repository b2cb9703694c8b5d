/* One triangle of the lists: the volume behind it that the light does not reach, as the light sees
 * it, each function with a bound of its rounding.
 *
 * A point has the light's coordinates X, Y (texels) and Z (canonical depth). The barycentric
 * weights of the second and third corner are linear in X and Y; floats do for them, because a point
 * too near to an edge is left to the ray. How far the point lies behind the triangle's plane is Z
 * plus a linear function, in double. */
#ifndef SRC_LIST_TRIANGLE_H
#define SRC_LIST_TRIANGLE_H

#include "lists_frame.h"

typedef struct shb_list_triangle {
    SHB_ALIGN double plane[3]; /* x, y, one: distance behind = Z + x X + y Y + one */
    float u[3], v[3];          /* x, y, one: the weights; that of the first corner is 1 - u - v */
    float margin;  /* rounding of the weights. Infinite where nothing is known but the plane: a part
                      of the triangle lies in front of the near plane */
    float bound;   /* rounding of the distance where no weight is below -margin; infinite where
                      nothing is known: the light sees the triangle edge-on */
    float clear;   /* the same for points of the scene that were rounded to floats */
    float nearest; /* depth, rounded towards the light; in the order of levels */
} shb_list_triangle;

/* Where the light sees a triangle: an outward bound. Texels, both ends included; none if the last
 * row is before the first. level: of its nearest depth. */
typedef struct shb_list_box {
    uint16_t first_column, first_row, last_column, last_row, level;
} shb_list_box;

static const shb_list_box SHB_LIST_BOX_NONE = {.first_row = 1};

static inline bool shb_list_box_is_none(const shb_list_box *box) {
    return box->last_row < box->first_row;
}

/* Prepares a triangle that has a corner in front of the near plane, or one that cannot be
 * projected. */
void shb_list_triangle_cut(const shb_list_frame *frame, const double corners[3][3],
                           shb_list_triangle *triangle, shb_list_box *box);

#endif
