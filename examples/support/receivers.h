/* Looks into a question to a map: what a bias method made of the points. */
#ifndef EXAMPLES_RECEIVERS_H
#define EXAMPLES_RECEIVERS_H

#include "shadowbias/map.h"

/* The batch that a filter sees, with every array filled; points are at most SHB_BATCH and have
 * normals. The method must not ask occluders. Errors as shb_map_visibility. */
shb_result receivers_look(const shb_map *map, const shb_points *points, const shb_bias *bias,
                          shb_receivers *receivers);

#endif
