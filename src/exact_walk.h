/* Walks over the mesh of a map's occluders, along a straight line of the map. */
#ifndef SRC_EXACT_WALK_H
#define SRC_EXACT_WALK_H

#include "map.h"

/* From a triangle seen at from to the triangle of the same sheet that covers to; SHB_ID_NONE if the
 * sheet ends on the way or turns round, or the way is longer than SHB_WALK_MAX triangles. A
 * triangle turns round if its third corner lies on the near side of the edge that leads to it: told
 * by places, whatever the winding. */
#define SHB_WALK_MAX 256
uint32_t shb_exact_walk(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]);

#endif
