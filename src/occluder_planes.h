/* The planes of a scene's triangles in a light's map. */
#ifndef SRC_OCCLUDER_PLANES_H
#define SRC_OCCLUDER_PLANES_H

#include "map.h"
#include "shadowbias/scene.h"

/* One a triangle of the scene, which has passed the checks of drawing. */
void shb_occluder_planes_make(const shb_map *map, const shb_scene *scene, size_t count,
                              shb_occluder_plane *planes);

#endif
