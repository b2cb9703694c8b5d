/* The triangles of a scene as one mesh in the light's map: which triangles meet at which edges. */
#ifndef SRC_OCCLUDER_MESH_H
#define SRC_OCCLUDER_MESH_H

#include "map.h"
#include "shadowbias/scene.h"

/* Fills the mesh for a scene that has passed the checks of drawing; false: out of memory, or more
 * than 2^30 triangles; what was allocated is left in *mesh. */
bool shb_occluder_mesh_make(const shb_map *map, const shb_scene *scene, size_t count,
                            shb_occluder_mesh *mesh);
void shb_occluder_mesh_release(const shb_context *context, shb_occluder_mesh *mesh);

#endif
