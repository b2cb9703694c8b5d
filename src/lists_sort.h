/* Triangles in the order of their nearest depth. */
#ifndef SRC_LISTS_SORT_H
#define SRC_LISTS_SORT_H

#include <stddef.h>
#include <stdint.h>

typedef struct shb_list_key {
    uint32_t depth; /* ordered as the depth is */
    uint32_t id;
} shb_list_key;

/* Integers in the order of finite floats. */
uint32_t shb_list_depth_key(float depth);

/* Sorts by depth; keys of equal depth stay in order. spare holds as many. The result is in keys. */
void shb_list_sort(shb_list_key *keys, shb_list_key *spare, size_t count);

#endif
