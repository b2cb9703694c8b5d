/* The points of a batch as the exact method asks about them: in double, with what is known of the
 * triangles that they lie on. */
#ifndef SRC_EXACT_POINTS_H
#define SRC_EXACT_POINTS_H

#include "map.h"

/* The double arithmetic that a point of weights is computed in leaves less than this of its size,
 * unless its triangle's corners lie more than 2^6 times as far from the origin. */
#define SHB_WEIGHTS_ROUNDING 0x1p-46

/* Of the sizes of a triangle's corners: what a host may have rounded away from a position. */
#define SHB_POSITION_SLACK 0x1p-18

/* And whatever their sizes: floats near 0 are this far apart. */
#define SHB_POSITION_STEP 0x1p-149

/* The scene that a map was drawn from. Vectors may read one double behind the vertices. */
typedef struct shb_drawn_mesh {
    size_t triangle_count;
    const uint32_t (*corners)[3];
    const double (*vertices)[3];
} shb_drawn_mesh;

typedef struct shb_exact_points {
    size_t count; /* up to whole groups of SHB_LIST_GROUP there are copies of the last one */
    SHB_ALIGN double x[SHB_BATCH];
    double y[SHB_BATCH];
    double z[SHB_BATCH];
    uint32_t own_ids[SHB_BATCH]; /* SHB_ID_NONE: not known */
    bool has_ids;
    bool are_exact; /* points that ids and weights name, instead of positions in float */
} shb_exact_points;

/* The positions, or the points that the ids and weights of a batch name: if these do not agree with
 * all positions but for rounding, the ids are those of another scene, and nobody knows. */
void shb_exact_points_of(const shb_map *map, size_t count, const shb_own_triangles *own,
                         const shb_receivers *receivers, shb_exact_points *points);

/* Adds a point of another batch, for which there is room; returns its number. */
static inline size_t shb_exact_points_add(const shb_exact_points *from, size_t i,
                                          shb_exact_points *to) {
    const size_t n = to->count++;
    to->x[n] = from->x[i];
    to->y[n] = from->y[i];
    to->z[n] = from->z[i];
    to->own_ids[n] = from->own_ids[i];
    return n;
}

/* The points of these numbers. */
void shb_exact_points_pick(const shb_exact_points *from, const uint16_t *numbers, size_t count,
                           shb_exact_points *to);

/* Checks a host's ids and weights for a map that is asked by the exact method, in the name of
 * caller. */
shb_result shb_own_triangles_check(const shb_map *map, const char *caller,
                                   const shb_points *points);

#endif
