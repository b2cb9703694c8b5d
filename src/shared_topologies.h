/* The topologies that maps of a context use: maps that were drawn with the same scene share one. */
#ifndef SRC_SHARED_TOPOLOGIES_H
#define SRC_SHARED_TOPOLOGIES_H

#include "topology.h"

/* One that a map uses already, or a new one, for which known may be of use: see shb_topology_make.
 * False: out of memory, or too many triangles. For the one call at a time that a context serves. */
bool shb_topology_join(shb_context *context, const shb_scene *scene, const shb_topology *known,
                       shb_topology *topology);

/* To be called once for each that was joined; the last one frees it. *topology is empty then;
 * nothing happens if it was. The first keeps its memory in the context, and belongs to the call
 * that a context serves; the second may be called on any thread. */
void shb_topology_return(shb_context *context, shb_topology *topology);
void shb_topology_leave(shb_context *context, shb_topology *topology);

#endif
