/* The exact method on maps that keep triangles. */
#ifndef SRC_EXACT_TRIANGLES_H
#define SRC_EXACT_TRIANGLES_H

#include "exact_points.h"
#include "kernels/lists.h"

/* Points that ask at the same time. The four samples around a point are what the four texels hold
 * whose centres are nearest: its own texel, the one beside it, the one above or below, and the one
 * beside that. */
typedef struct shb_walk_group {
    size_t count;
    const double *world[3];             /* of SHB_LIST_GROUP points */
    const uint32_t *own_ids;            /* the points' triangles */
    SHB_ALIGN double x[SHB_LIST_GROUP]; /* texels; negative: not in the view */
    double y[SHB_LIST_GROUP];
    uint32_t samples[4][SHB_LIST_GROUP]; /* triangles */
    /* One bit a point. The nearest sample's triangle covers the point's place, and lies in front of
     * it; or all sheets are known to be its own surface. */
    uint64_t in_front, joined;
} shb_walk_group;

/* What ways have found. */
#define SHB_WAY_GONE 1u       /* << sample: there is a way, no sample before holds its triangle */
#define SHB_WAY_OWN 16u       /* << sample: its way leads to the point's own surface */
#define SHB_WAY_IN_FRONT 256u /* one leads to a triangle in front of the point */
#define SHB_WAY_BEHIND 512u   /* or to one behind it */
#define SHB_WAY_EMPTY 1024u   /* a sample holds no triangle */

/* Points that their samples have left open: from each sample a way goes on. */
typedef struct shb_way_points {
    shb_exact_points points;
    size_t numbers[SHB_BATCH];
    SHB_ALIGN double x[SHB_BATCH]; /* texels */
    double y[SHB_BATCH];
    uint32_t samples[4][SHB_BATCH];
    uint32_t ends[4][SHB_BATCH]; /* triangles where ways have ended */
    uint32_t found[SHB_BATCH];
} shb_way_points;

/* Triangles of a walk, and how far it goes beyond both places, texels. */
#define SHB_WALK_MAX 256
#define SHB_WALK_REACH 2.0

#define SHB_WALK_CROWD 256

/* Walks of points that are to go on where ways have ended. */
typedef struct shb_walk_crowd {
    size_t count;
    double from_x[SHB_WALK_CROWD], from_y[SHB_WALK_CROWD]; /* where the ways began, texels */
    double to_x[SHB_WALK_CROWD], to_y[SHB_WALK_CROWD];     /* where the points are */
    uint32_t triangles[SHB_WALK_CROWD]; /* where the ways have ended, at or near the line */
    uint32_t points[SHB_WALK_CROWD];
    /* By point: a triangle in front of it was met; one that can be compared was met, or a walk
     * ended without being cut. */
    bool are_shadowed[SHB_BATCH], are_known[SHB_BATCH];
} shb_walk_crowd;

/* More than the sum of a point and a plane is off by for the rounding of the sum itself, as part of
 * what is summed up. */
#define SHB_PLANE_ROUNDING 0x1p-50

/* Positions and normals of all points, so many floats apart. */
typedef struct shb_walk_places {
    const float *position[3], *normal[3];
    size_t position_step, normal_step;
} shb_walk_places;

/* A point whose ways have all ended before they met anything; if walks are cut, too, planes tell.
 */
typedef struct shb_doubtful_point {
    uint32_t point;  /* of those that are left */
    uint32_t sample; /* the nearest one's triangle */
    double center[2];
} shb_doubtful_point;

/* What is left of points when ways have ended. */
typedef struct shb_left_points {
    shb_walk_crowd crowd;
    shb_exact_points points;
    size_t numbers[SHB_BATCH];
    size_t doubtful_count;
    shb_doubtful_point doubtful[SHB_BATCH];
} shb_left_points;

/* Points that are asked batch by batch. What a batch leaves open waits until there is enough of it
 * to go on side by side. */
typedef struct shb_triangle_points {
    const shb_map *map;
    shb_walk_places places;
    float *visibility;
    double rounding; /* of the positions, as in light_point.h */
    shb_way_points open;
    shb_left_points left;
} shb_triangle_points;

void shb_triangle_points_begin(const shb_map *map, const shb_walk_places *places, float *visibility,
                               shb_triangle_points *asked);

/* The points from number first on. */
void shb_triangle_points_ask(shb_triangle_points *asked, const shb_exact_points *points,
                             size_t first);

/* Answers what is still open. */
void shb_triangle_points_end(shb_triangle_points *asked);

#endif
