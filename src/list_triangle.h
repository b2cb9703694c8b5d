/* One triangle of the lists: the volume behind it that the light does not reach, as the light sees
 * it, each function with a bound of its rounding.
 *
 * A point has the light's coordinates X, Y (texels) and Z (canonical depth). The barycentric
 * weights of the three corners are linear in X and Y; floats do for them, because a point too near
 * to an edge is left to the ray. How far the point lies behind the triangle's plane is Z plus a
 * linear function, in double. */
#ifndef SRC_LIST_TRIANGLE_H
#define SRC_LIST_TRIANGLE_H

#include "lists_frame.h"

/* What decides for most points that the triangle does not block them: four functions x X + y Y +
 * one, Z added to the last one. */
enum { SHB_LIST_DEPTH = 3, SHB_LIST_FUNCTIONS = 4 };

typedef struct shb_list_triangle {
    /* The weights plus their margin: where one is negative the point lies outside. The last one:
     * less the nearest depth, rounded towards the light, in the order of levels. */
    SHB_ALIGN float x[SHB_LIST_FUNCTIONS];
    float y[SHB_LIST_FUNCTIONS];
    float one[SHB_LIST_FUNCTIONS];
    float margin; /* rounding of the weights. Infinite where nothing is known but the plane: a part
                     of the triangle lies in front of the near plane */
    float bound;  /* rounding of the distance behind the plane, where no weight plus margin is
                     negative; infinite where nothing is known: the light sees it edge-on */
    float clear;  /* the same for points of the scene that were rounded to floats */
} shb_list_triangle;

/* x, y, one: the distance behind is Z + x X + y Y + one. */
typedef struct shb_list_plane {
    double x, y, one;
} shb_list_plane;

static inline double shb_list_behind(const shb_list_plane *plane, double x, double y,
                                     double depth) {
    return ((plane->x * x + plane->y * y) + plane->one) + depth;
}

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
                           shb_list_triangle *triangle, shb_list_plane *plane, shb_list_box *box);

#endif
