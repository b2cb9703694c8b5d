/* Triangles of a tile in order of their levels of depth. */
#ifndef SRC_LEVEL_SORT_H
#define SRC_LEVEL_SORT_H

#include <stddef.h>
#include <stdint.h>

/* Sorts keys of a level below 2^16, in the bits from 32 on, and an id, in those below; ids rise.
 * spare: as many. */
void shb_sort_by_level(size_t count, uint64_t *keys, uint64_t *spare);

#endif
