/* The depths of a map row by row, for what filters prepare. */
#ifndef SRC_DEPTH_ROWS_H
#define SRC_DEPTH_ROWS_H

#include "map.h"

/* Canonical depths of count texels of row y from column x on; the far depth outside the map and
 * where the map holds NaN. */
void shb_depth_row(const shb_map *map, int32_t x, int32_t y, size_t count, float *depths);

/* The least and the largest canonical depth nearer than the far depth; both are the far depth when
 * the map holds none. Works on the context's threads. */
typedef struct shb_depth_range {
    float nearest, farthest;
} shb_depth_range;

shb_depth_range shb_depth_range_of(const shb_map *map);

#endif
