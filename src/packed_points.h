/* A host's points without gaps, asked by the quick test batch by batch, or by the planes of a map;
 * those that the quick test leaves in doubt wait until there is a batch of them. */
#ifndef SRC_PACKED_POINTS_H
#define SRC_PACKED_POINTS_H

#include "quick_test.h"

typedef struct shb_packed_points {
    const shb_map *map;
    const shb_points *points;
    const shb_bias *bias;
    float *visibility;
    bool by_planes; /* the exact method: no point is left in doubt */
    shb_quick_bias quick;
    shb_quick_test test;
    size_t waiting;
    size_t numbers[SHB_BATCH];
    shb_receivers receivers;
} shb_packed_points;

/* False: neither test is for this map, method or filter (NULL: hard), or there are gaps. */
bool shb_packed_points_init(shb_packed_points *packed, const shb_map *map, const shb_points *points,
                            const shb_bias *bias, const shb_filter *filter, float *visibility);

/* Asks for the SHB_BATCH points from first on. False: nothing is done. */
bool shb_packed_points_ask(shb_packed_points *packed, size_t first);

/* Asks for what still waits. */
void shb_packed_points_end(shb_packed_points *packed);

#endif
