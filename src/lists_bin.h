/* Triangles into the tiles of lists, in two passes: their numbers are counted, then written. */
#ifndef SRC_LISTS_BIN_H
#define SRC_LISTS_BIN_H

#include "lists_load.h"

/* Parts of all triangles that are worked on at the same time. */
#define SHB_LIST_PARTS 16

typedef struct shb_list_bins {
    size_t tiles;
    shb_list_box *boxes;        /* by id */
    shb_list_outline *outlines; /* NULL: none are wanted */
    size_t *ends;               /* of tile * SHB_LIST_PARTS + part, in numbers */
    uint32_t *numbers;          /* ids by tile, in each tile ascending */
    size_t largest;             /* tile */
} shb_list_bins;

/* Loads all triangles and sorts them by tile. Everything but the lists' own lies in the context's
 * scratch; false: out of memory. */
bool shb_list_bins_fill(const shb_list_loading *loading, shb_list_bins *bins);

/* A tile's triangles. */
static inline const uint32_t *shb_list_bin(const shb_list_bins *bins, size_t tile, size_t *count) {
    const size_t begin = tile ? bins->ends[tile * SHB_LIST_PARTS - 1] : 0;
    *count = bins->ends[(tile + 1) * SHB_LIST_PARTS - 1] - begin;
    return bins->numbers + begin;
}

#endif
