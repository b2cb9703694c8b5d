/* Triangles into the tiles of lists, in two passes: they are counted, then their keys written. */
#ifndef SRC_LISTS_BIN_H
#define SRC_LISTS_BIN_H

#include "lists_load.h"

/* Parts of all triangles that are worked on at the same time. */
#define SHB_LIST_PARTS 16

typedef struct shb_list_bins {
    size_t tiles;
    shb_list_shapes shapes;
    size_t *ends;   /* of part * tiles + tile, in keys */
    uint64_t *keys; /* by tile: levels above ids, which ascend in each tile */
    size_t largest; /* tile */
} shb_list_bins;

/* Loads all triangles and sorts them by tile. Everything but the lists' own lies in the context's
 * scratch; false: out of memory. */
bool shb_list_bins_fill(const shb_list_loading *loading, shb_list_bins *bins);

/* A tile's keys. */
static inline uint64_t *shb_list_bin(const shb_list_bins *bins, size_t tile, size_t *count) {
    const size_t *ends = bins->ends + (SHB_LIST_PARTS - 1) * bins->tiles;
    const size_t begin = tile ? ends[tile - 1] : 0;
    *count = ends[tile] - begin;
    return bins->keys + begin;
}

#endif
