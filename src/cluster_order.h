/* An order of a mesh's triangles in which neighbours follow each other. */
#ifndef SRC_CLUSTER_ORDER_H
#define SRC_CLUSTER_ORDER_H

#include "context.h"
#include "shadowbias/scene.h"

/* The numbers of the mesh's triangles so that runs of SHB_CHUNK are compact, to be released with
 * shb_free. NULL: out of memory. */
uint32_t *shb_cluster_order(const shb_context *context, const shb_mesh *mesh);

#endif
