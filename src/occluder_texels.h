/* The texels of a map that keeps planes: ids of triangles become depths and slopes. */
#ifndef SRC_OCCLUDER_TEXELS_H
#define SRC_OCCLUDER_TEXELS_H

#include "map.h"
#include "shadowbias/scene.h"

/* False: out of memory. */
bool shb_texel_scratch_reserve(const shb_map *map, const shb_scene *scene,
                               shb_texel_scratch *scratch);

/* Depths and slopes take the place of ids in a map that was drawn; texels without a triangle stay
 * as they are. */
void shb_occluder_texels_resolve(shb_map *map, const shb_texel_scratch *scratch);

#endif
