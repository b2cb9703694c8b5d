/* The order in which clusters are drawn. */
#ifndef SRC_CLUSTER_SORT_H
#define SRC_CLUSTER_SORT_H

#include "context.h"
#include "kernels/raster.h"

/* Where clusters lie one over the other in many layers those that are nearest come first, so that
 * what they hide need not be drawn. It is a rough order, which leaves neighbours together. false:
 * out of memory. */
bool shb_clusters_sort(shb_context *context, const shb_target *target, size_t count,
                       shb_chunk *chunks);

#endif
