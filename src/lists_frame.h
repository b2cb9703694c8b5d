/* How the world becomes texels and canonical depth for the lists, with bounds of the rounding. */
#ifndef SRC_LISTS_FRAME_H
#define SRC_LISTS_FRAME_H

#include "shadowbias/view.h"

#include <math.h>

/* How points become X, Y (texels) and Z (canonical depth): rows for X w, Y w, Z w and w. */
typedef struct shb_list_frame {
    double rows[4][4];
    double near_depth;    /* canonical */
    double width, height; /* texels */
    double rim;           /* cells are made larger by it on all sides, texels */
    shb_light_source light;
    double reach;     /* the largest coordinate of the scene */
    double errors[4]; /* bounds of the rounding of the rows' products, and of rays' drift */
    /* Depths are put in order by their level: (depth - level_origin) * levels, cut off at 0 and
     * SHB_LIST_LEVELS - 1; level_size = 1 / levels. */
    double level_origin, levels, level_size;
    double rounding_z, rounding_w; /* how much z w and w may change where a point of the scene is
                                      rounded to floats */
} shb_list_frame;

#define SHB_LIST_LEVELS 65536

/* What is known of a scene's vertices before triangles are prepared. */
typedef struct shb_list_extent {
    double reach; /* the largest coordinate */
    double nearest,
        farthest; /* depths of those behind the near plane; nearest above farthest: none */
} shb_list_extent;

/* Of no vertices. */
shb_list_extent shb_list_extent_none(void);

/* A vertex at p whose depth is z; is_seen: behind the near plane. */
void shb_list_extent_add(shb_list_extent *extent, const double p[3], double z, bool is_seen);

/* The rows of a view; SHB_ERROR_NUMBER if it has no light. */
shb_result shb_list_frame_init(const shb_view *view, uint32_t width, uint32_t height,
                               shb_list_frame *frame);

/* Errors and levels for a scene whose parts have these extents. */
void shb_list_frame_fit(shb_list_frame *frame, size_t count, const shb_list_extent extents[]);

/* How much a row's product with a point of the scene may change where that is rounded to floats. */
double shb_list_row_rounding(const shb_list_frame *frame, int row);

/* A row's product with a point. */
static inline double shb_list_row(const double row[4], double x, double y, double z) {
    return ((row[0] * x + row[1] * y) + row[2] * z) + row[3];
}

/* A bound of the depths of a level: grows with it, and is not above any of them. What the near
 * plane cuts may begin before all vertices that lie behind it, and so before the origin of levels.
 */
static inline double shb_list_level_depth(const shb_list_frame *frame, double level) {
    const double depth = frame->level_origin + (level - 1) * frame->level_size;
    const double bound = depth - 0x1p-22 * fabs(depth);
    return level < 1 ? -HUGE_VAL : bound;
}

#endif
