/* The planes of a scene's triangles in a light's map. The scene has passed the checks of drawing.
 */
#ifndef SRC_OCCLUDER_PLANES_H
#define SRC_OCCLUDER_PLANES_H

#include "map.h"
#include "shadowbias/scene.h"

/* One a triangle. */
void shb_occluder_planes_make(const shb_map *map, const shb_scene *scene, size_t count,
                              shb_occluder_plane *planes);

/* False: out of memory. */
bool shb_occluder_scratch_reserve(shb_context *context, size_t count,
                                  shb_occluder_scratch *scratch);

void shb_occluder_planes_make_seen(const shb_map *map, const shb_scene *scene, size_t count,
                                   const shb_occluder_scratch *scratch);

#endif
