/* What a map keeps of its occluders, and the planes all of it is made of. */
#ifndef SRC_OCCLUDERS_H
#define SRC_OCCLUDERS_H

#include "map.h"
#include "shadowbias/scene.h"

/* Reserves what does not depend on a scene; false: out of memory. */
bool shb_occluders_create(shb_map *map);
void shb_occluders_destroy(shb_map *map);

/* What is prepared for a scene before it is drawn; keeps: for the exact method, too. False: out of
 * memory, the map keeps what it held. */
bool shb_occluders_prepare(const shb_map *map, const shb_scene *scene, bool keeps,
                           shb_occluder_data *made);

/* Takes over what was prepared, after depths and ids (in the map's occluder texels) were drawn. */
void shb_occluders_finish(shb_map *map, bool keeps, const shb_occluder_data *made);

/* Frees what was prepared and is not taken over. */
void shb_occluders_release(const shb_map *map, const shb_occluder_data *made);

static inline uint32_t *shb_occluder_row(const shb_map *map, int32_t row) {
    return (uint32_t *)(void *)((char *)map->occluders.texels +
                                (size_t)row * map->occluders.stride);
}

/* The plane's depth at a place of the map. */
static inline double shb_occluder_depth(const shb_occluder_plane *plane, double x, double y) {
    return (plane->z + plane->slope_x * x) + plane->slope_y * y;
}

#endif
