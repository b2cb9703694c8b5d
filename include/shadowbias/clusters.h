/* Clusters: a mesh prepared once so that parts of it need not be looked at when it is drawn.
 *
 * Up to 128 neighbouring triangles with their own copies of their vertices, a box, and bounds of
 * their normals in 26 directions. Drawing leaves out whole clusters that the view cannot see, that
 * face the wrong way or that lie behind what is drawn already, nearest ones first where there are
 * many layers (those behind are still counted where statistics are asked for), and transforms the
 * vertices of the rest where they stay in a first-level cache. Triangles that cover no sample are
 * dropped by whole vectors before anything else is known of them. */
#ifndef SHADOWBIAS_CLUSTERS_H
#define SHADOWBIAS_CLUSTERS_H

#include "shadowbias/context.h"
#include "shadowbias/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Prepares a mesh. What is drawn does not change in a single bit, ids and statistics included. The
 * mesh is read now, which takes some 0.3 to 0.5 us a triangle; the clusters take some 20 bytes a
 * triangle, 50 if no triangles share vertices. Hand them to drawing in the field clusters of this
 * mesh or of a copy of it: positions and indices must stay the same as long as they are used, or
 * what is drawn is a mixture. mesh.clusters itself is ignored here. Errors: SHB_ERROR_ARGUMENT (a
 * mesh that breaks the rules of scene.h, an index out of range), SHB_ERROR_SIZE, SHB_ERROR_MEMORY;
 * *clusters is untouched then. One call at a time for a context; clusters are never written again,
 * so that any number of drawings, of any contexts, may use them at once. */
shb_result shb_clusters_create(shb_context *context, const shb_mesh *mesh, shb_clusters **clusters);

/* Before its context is destroyed; NULL is ignored. */
void shb_clusters_destroy(shb_clusters *clusters);

#ifdef __cplusplus
}
#endif

#endif
