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
    uint32_t firsts[SHB_MINIMA_LEVELS]; /* where a level begins in cells */
    float *cells;                       /* canonical depths, not nearer than the near plane */
    size_t bytes;
} shb_depth_minima;

/* False: no memory. */
bool shb_depth_minima_create(const shb_map *map, shb_depth_minima *minima);

/* Works on the context's threads. */
void shb_depth_minima_fill(const shb_map *map, const shb_depth_minima *minima);

void shb_depth_minima_destroy(const shb_map *map, shb_depth_minima *minima);

#endif
