/* One triangle of the lists: the volume behind it that the light does not reach, as the light sees
 * it, each function with a bound of its rounding.
 *
 * A point has the light's coordinates X, Y (texels) and Z (canonical depth). The barycentric
 * weights of the three corners are linear in X and Y; functions of floats do for them, because a
 * point too near to an edge is left to the ray. How far the point lies behind the triangle's plane
 * is Z plus a linear function, in double. */
#ifndef SRC_LIST_TRIANGLE_H
#define SRC_LIST_TRIANGLE_H

#include "lists_frame.h"

/* Added to bounds of depths: more than is lost where depths, and slopes times the texels of a tile,
 * are so small that floats have no finer steps. */
#define SHB_LIST_LEAST_BOUND 0x1p-136

/* One cache line: all that most questions read. */
typedef struct shb_list_triangle {
    /* x, y, one: the distance behind the plane is Z + x X + y Y + one */
    SHB_ALIGN double plane[3];
    /* x, y, one of the second and third corner's weights plus their margin; where one is negative
     * the point lies outside */
    float u[3], v[3];
    float rest;   /* less both: the first corner's weight plus the margin */
    float margin; /* rounding of the weights. Infinite where nothing is known but the plane: a part
                     of the triangle lies in front of the near plane */
    float bound;  /* rounding of the distance behind the plane, where no weight plus margin is
                     negative; infinite where nothing is known: the light sees it edge-on */
    float clear;  /* the same for points of the scene that were rounded to floats */
} shb_list_triangle;

static inline double shb_list_behind(const shb_list_triangle *t, double x, double y, double depth) {
    return ((t->plane[0] * x + t->plane[1] * y) + t->plane[2]) + depth;
}

/* How much each coordinate of a point changes its distance behind the plane, before the division by
 * w. */
static inline void shb_list_changes(const shb_list_frame *frame, const shb_list_triangle *t,
                                    double changes[3]) {
    const double(*rows)[4] = frame->rows;
    for (int i = 0; i < 3; i++)
        changes[i] = fabs((rows[2][i] + t->plane[0] * rows[0][i]) +
                          (t->plane[1] * rows[1][i] + t->plane[2] * rows[3][i]));
}

/* Where the light sees a triangle: an outward bound. Texels, both ends included; none if the last
 * row is before the first, which is the last of all then. */
typedef struct shb_list_box {
    uint16_t first_column, first_row, last_column, last_row;
} shb_list_box;

static const shb_list_box SHB_LIST_BOX_NONE = {.first_row = UINT16_MAX};

static inline bool shb_list_box_is_none(const shb_list_box *box) {
    return box->last_row < box->first_row;
}

/* Prepares a triangle that has a corner in front of the near plane, or one that cannot be
 * projected. Returns the level of its nearest depth. */
uint16_t shb_list_triangle_cut(const shb_list_frame *frame, const double corners[3][3],
                               shb_list_triangle *triangle, shb_list_box *box);

#endif
