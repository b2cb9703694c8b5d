/* Filling the tiles of lists. */
#ifndef SRC_LISTS_TILE_H
#define SRC_LISTS_TILE_H

#include "lists_bin.h"

/* Divides the tiles into cells: the more triangles, the more, and into blocks where sheets are
 * wanted. Returns the number of all cells. */
size_t shb_list_tiles_divide(shb_lists *lists, const shb_list_bins *bins);

/* Fills the tiles' cells and entries. *entries receives how many there are: all of them are written
 * if the lists have room for so many, otherwise nothing is of use. False: out of memory. */
bool shb_list_tiles_fill(shb_lists *lists, const shb_list_bins *bins, size_t room, size_t *entries);

#endif
