/* The clusters that a drawing has to look at. */
#ifndef SRC_CLUSTER_LIST_H
#define SRC_CLUSTER_LIST_H

#include "chunk.h"

/* Lists a chunk for each cluster of the geometry that the target may see, in their order or
 * nearest first; chunks has room for all. *doubtful: for some of them clipping has to be asked.
 * false: out of memory. */
bool shb_clusters_list(shb_context *context, const shb_geometry *geometry, const shb_target *target,
                       shb_chunk *chunks, size_t *count, bool *doubtful);

#endif
