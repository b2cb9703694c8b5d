/* A pyramid of bounds over the depths of a map: for each cell of texels two parallel planes between
 * which all of them lie. Slopes make the bounds of a lit surface as tight as the surface is flat;
 * without them nothing but surfaces at right angles to the light would be seen to be lit. */
#ifndef SRC_PYRAMID_H
#define SRC_PYRAMID_H

#include "map.h"

/* At the texel m columns and n rows from the cell's first one, canonical depth is at least nearest
 * + m * slope_x + n * slope_y, and at most as far from farthest. Texels that can block nothing,
 * which are at the far depth, beyond, or no number, count for farthest alone, as infinite. */
typedef struct shb_pyramid_cell {
    float nearest, farthest;
    float slope_x, slope_y;
} shb_pyramid_cell;

/* Cells of level k begin every 2^(k + SHB_PYRAMID_SHIFT) texels on each axis and are twice as wide
 * as that, so that each overlaps the next: four of them hold any rectangle of up to three steps,
 * and reach less than a step beyond it. The last level is one cell. */
#define SHB_PYRAMID_SHIFT 3
#define SHB_PYRAMID_LEVELS 12

typedef struct shb_pyramid_level {
    shb_pyramid_cell *cells; /* row by row */
    uint32_t columns, rows;
} shb_pyramid_level;

typedef struct shb_pyramid {
    int count;
    shb_pyramid_level levels[SHB_PYRAMID_LEVELS];
} shb_pyramid;

/* NULL: out of memory. bytes receives what it takes. */
shb_pyramid *shb_pyramid_create(const shb_map *map, size_t *bytes);

/* What pcss releases; NULL is ignored. */
void shb_pyramid_destroy(const shb_map *map, void *pyramid);

#endif
