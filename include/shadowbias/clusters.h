/* Clusters: a mesh prepared once so that drawing it can leave out large parts unseen.
 *
 * A cluster is up to 128 neighbouring triangles with their own copies of their vertices, a box, and
 * bounds of their normals in 26 directions. Drawing skips whole clusters that lie outside the view,
 * face the wrong way or lie behind what is drawn already (the nearest come first where there are
 * many layers), transforms the vertices of the others within the first-level cache, and drops
 * triangles that cover no sample a vector at a time. Statistics, where they are asked for, still
 * count all triangles. */
#ifndef SHADOWBIAS_CLUSTERS_H
#define SHADOWBIAS_CLUSTERS_H

#include "shadowbias/context.h"
#include "shadowbias/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Prepares a mesh. What is drawn does not change in a single bit, ids and statistics included. This
 * takes about 0.3 to 0.5 us and 20 bytes a triangle (50 bytes if triangles share no vertices). Set
 * shb_mesh.clusters, of this mesh or a copy of it, to have them used: its positions and indices
 * must not change as long as they are, or what is drawn is a mixture. mesh.clusters is ignored
 * here. Errors: SHB_ERROR_ARGUMENT (a mesh that breaks the rules of scene.h, an index out of
 * range), SHB_ERROR_SIZE, SHB_ERROR_MEMORY. One call at a time for a context. Clusters are never
 * written again: any number of drawings, in any contexts, may use them at once. */
shb_result shb_clusters_create(shb_context *context, const shb_mesh *mesh, shb_clusters **clusters);

/* Before its context is destroyed; NULL is ignored. */
void shb_clusters_destroy(shb_clusters *clusters);

#ifdef __cplusplus
}
#endif

#endif
