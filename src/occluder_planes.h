/* The planes of a scene's triangles in a light's map. The scene has passed the checks of drawing.
 */
#ifndef SRC_OCCLUDER_PLANES_H
#define SRC_OCCLUDER_PLANES_H

#include "map.h"
#include "shadowbias/scene.h"

/* An instance of a scene, for its triangles' corners in the world. */
typedef struct shb_placed_instance {
    const shb_mesh *mesh;
    size_t first; /* triangle's id */
    bool moves;   /* by transform; otherwise the mesh is in the world as it is */
    shb_mat4 transform;
} shb_placed_instance;

/* False: out of memory. */
bool shb_placed_scene_make(shb_context *context, const shb_scene *scene, shb_placed_scene *placed);

/* Makes a finder for the scene; false: out of memory. */
bool shb_drawn_planes_make(const shb_map *map, const shb_scene *scene, shb_occluder_data *made);

/* Planes of count triangles: those of the ids, or with ids NULL from the first one on. */
void shb_occluder_planes_find(const shb_map *map, const shb_placed_scene *placed,
                              const uint32_t *ids, size_t first, size_t count,
                              shb_occluder_plane *planes);

/* One a triangle of the scene. */
void shb_occluder_planes_make(const shb_map *map, const shb_placed_scene *placed, size_t count,
                              shb_occluder_plane *planes);

#endif
