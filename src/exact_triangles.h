/* The exact method on maps that keep triangles. */
#ifndef SRC_EXACT_TRIANGLES_H
#define SRC_EXACT_TRIANGLES_H

#include "map.h"

/* One batch; receivers holds positions and normals. */
void shb_exact_ask_triangles(const shb_map *map, size_t lanes, const shb_receivers *receivers,
                             float *visibility);

#endif
