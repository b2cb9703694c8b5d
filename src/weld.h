/* Vertices of a scene that lie at one place in the world become one. */
#ifndef SRC_WELD_H
#define SRC_WELD_H

#include "topology.h"

/* Writes a topology's vertices and its corners, for which there is memory; positions are left in
 * the context's scratch. Vertices are numbered in the order of their first use. False: out of
 * memory. */
bool shb_weld_scene(shb_context *context, const shb_scene *scene, shb_topology *topology);

#endif
