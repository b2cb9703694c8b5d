/* The least depths of a map in cells of texels, of all sizes: what could be in front of a fragment
 * within a window (the hierarchical shadow map of Guennebaud, Barthe and Paulin 2006). */
#ifndef SRC_DEPTH_MINIMA_H
#define SRC_DEPTH_MINIMA_H

#include "map.h"

/* Cells of level k are 2^(k + SHB_MINIMA_SHIFT) texels wide and high; the last level is one cell.
 */
enum { SHB_MINIMA_SHIFT = 3, SHB_MINIMA_LEVELS = 12 };

typedef struct shb_depth_minima {
    int count; /* of levels */
    uint32_t columns[SHB_MINIMA_LEVELS], rows[SHB_MINIMA_LEVELS];
    float *cells[SHB_MINIMA_LEVELS]; /* canonical depths, not nearer than the near plane */
    size_t bytes;
} shb_depth_minima;

/* Works on the context's threads. False: no memory, and nothing to be destroyed. */
bool shb_depth_minima_create(const shb_map *map, shb_depth_minima *minima);

void shb_depth_minima_destroy(const shb_map *map, shb_depth_minima *minima);

/* A rectangle of texels inside the map, last ones included. */
typedef struct shb_texel_box {
    int32_t x0, y0, x1, y1;
} shb_texel_box;

/* No texel of the box is nearer than this. */
float shb_depth_minima_over(const shb_depth_minima *minima, const shb_texel_box *box);

#endif
