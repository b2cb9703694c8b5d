/* One tile of the lists while they are built. */
#ifndef SRC_LISTS_TILE_H
#define SRC_LISTS_TILE_H

#include "lists.h"

typedef struct shb_list_tile {
    const shb_lists *lists;
    const shb_list_box *boxes; /* of the triangles */
    const uint32_t *numbers;   /* of the triangles that reach the tile, ascending */
    size_t count;
    uint32_t first_column, first_row;
} shb_list_tile;

/* Counts the entries of each texel of the tile. */
void shb_list_tile_count(const shb_list_tile *tile, uint32_t *counts);

/* Writes the entries: those of texel i from entries[next[i]] on; next moves behind them. */
void shb_list_tile_fill(const shb_list_tile *tile, uint32_t *next, uint32_t *entries);

#endif
