/* One triangle of the lists: the volume behind it that the light does not reach, bounded by the
 * planes through the light and its edges and by its own plane, each with a bound of its rounding.
 *
 * A point has the light's coordinates X, Y (texels) and Z (canonical depth). Three edge functions
 * x X + y Y + one are positive inside and have the unit texels: |x| + |y| = 1. The fourth function
 * is Z minus the depth of the triangle's plane at (X, Y). */
#ifndef SRC_LIST_TRIANGLE_H
#define SRC_LIST_TRIANGLE_H

#include "reference/ray.h"
#include "shadowbias/scene.h"

/* Elements of the four functions. */
enum { SHB_LIST_DEPTH = 3, SHB_LIST_FUNCTIONS = 4 };

typedef struct shb_list_triangle {
    SHB_ALIGN double x[SHB_LIST_FUNCTIONS];
    double y[SHB_LIST_FUNCTIONS];
    double one[SHB_LIST_FUNCTIONS];
    /* Rounding of the functions at points within the largest coordinate of the scene that project
     * into the triangle's box. Infinite where nothing is known: a triangle seen edge-on. */
    float edge_bound, depth_bound;
    float normal[3]; /* sizes: change of depth function times w per world unit */
    float nearest;   /* depth, rounded towards the light */
    uint32_t id;
    uint32_t crosses_near; /* a part lies in front of the near plane */
} shb_list_triangle;

/* How points become X, Y, Z: rows for X w, Y w, Z w and w. */
typedef struct shb_list_frame {
    double rows[4][4];
    double near_depth;    /* canonical */
    double width, height; /* texels */
    shb_light_source light;
    double reach;     /* the largest coordinate of the scene */
    double errors[4]; /* bounds of the rounding of the rows' products, and of rays' drift */
} shb_list_frame;

/* A frame of a view for scenes whose coordinates are no larger than reach; SHB_ERROR_NUMBER if the
 * view has no light. */
shb_result shb_list_frame_init(const shb_view *view, uint32_t width, uint32_t height, double reach,
                               shb_list_frame *frame);

/* A row's product with a point. */
static inline double shb_list_row(const double row[4], double x, double y, double z) {
    return ((row[0] * x + row[1] * y) + row[2] * z) + row[3];
}

/* Where the light sees a triangle: an outward bound. Texels, both ends included. */
typedef struct shb_list_box {
    uint16_t first_column, first_row, last_column, last_row;
} shb_list_box;

/* Box and nearest depth of what lies behind the near plane; false if the view sees none of it or
 * the triangle has no area. */
bool shb_list_triangle_bounds(const shb_list_frame *frame, const double corners[3][3],
                              shb_list_box *box, float *nearest);

void shb_list_triangle_prepare(const shb_list_frame *frame, const shb_triangle *world,
                               const shb_list_box *box, float nearest, shb_list_triangle *triangle);

#endif
