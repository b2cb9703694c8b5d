/* What bounds a cluster's vertices and normals. */
#ifndef SRC_CLUSTER_BOUNDS_H
#define SRC_CLUSTER_BOUNDS_H

#include "clusters.h"

/* Fills in box, height and normals of a cluster whose counts are known; positions: all x of its
 * vertices, then, places on, all y and all z. */
void shb_cluster_bound(const float *positions, const uint8_t *corners, shb_cluster *cluster);

#endif
