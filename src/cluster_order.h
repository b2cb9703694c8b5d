/* An order of a mesh's triangles in which neighbours follow each other. */
#ifndef SRC_CLUSTER_ORDER_H
#define SRC_CLUSTER_ORDER_H

#include "context.h"
#include "shadowbias/scene.h"

/* *order: the numbers of the mesh's triangles, to be released with shb_free, or NULL for the order
 * of the mesh, which is kept where its runs of SHB_CHUNK triangles are about as compact. false: out
 * of memory. */
bool shb_cluster_order(const shb_context *context, const shb_mesh *mesh, uint32_t **order);

#endif
