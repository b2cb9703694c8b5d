/* What filters make of a map before it is asked. */
#ifndef SRC_PREPARE_H
#define SRC_PREPARE_H

#include "map.h"

/* What was made of the map for the filter, or NULL. */
const void *shb_prepared_find(const shb_map *map, const shb_filter *filter);

/* What all of it takes. */
size_t shb_prepared_bytes(const shb_map *map);

/* The map has other depths now: nothing is found until it is prepared again, in the same memory.
 * What was outdated before is freed. */
void shb_prepared_outdate(shb_map *map);

/* Frees all of it. */
void shb_prepared_release(shb_map *map);

#endif
