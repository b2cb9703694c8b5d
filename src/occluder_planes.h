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

/* Finds the planes of triangles while a map that keeps them is drawn. */
typedef struct shb_drawn_planes {
    shb_plane_finder finder;
    const shb_map *map;
} shb_drawn_planes;

shb_drawn_planes shb_drawn_planes_of(const shb_map *map);

/* One a triangle of the scene. */
void shb_occluder_planes_make(const shb_map *map, const shb_placed_scene *placed, size_t count,
                              shb_occluder_plane *planes, shb_world_plane *world_planes);

#endif
