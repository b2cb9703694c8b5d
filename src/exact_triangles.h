/* The exact method on maps that keep triangles. */
#ifndef SRC_EXACT_TRIANGLES_H
#define SRC_EXACT_TRIANGLES_H

#include "exact_points.h"

/* One batch; receivers holds its positions and normals. */
void shb_exact_ask_triangles(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility);

#endif
