/* The triangles of a scene as one mesh: vertices welded where their world positions are equal, and
 * which triangles meet at which edges. It does not depend on a light. */
#ifndef SRC_TOPOLOGY_H
#define SRC_TOPOLOGY_H

#include "context.h"
#include "shadowbias/scene.h"

typedef struct shb_topology {
    size_t triangle_count, vertex_count;
    uint32_t (*corners)[3];    /* vertices of each triangle, by id */
    uint32_t (*neighbours)[3]; /* beyond the edge from corner k to the next: shb_neighbour_of. All
                                  SHB_TWIN: a triangle before this one has the same vertices */
    double (*positions)[3];    /* of the vertices, world */
    uint64_t key;              /* of the scene that it was made of */
} shb_topology;

#define SHB_TWIN 0xfffffffeu

static inline bool shb_topology_is_twin(const shb_topology *topology, size_t triangle) {
    return topology->neighbours[triangle][0] == SHB_TWIN;
}

/* A neighbour's id, and whether both triangles run along the edge in the same direction, so that
 * one is wound the other way; SHB_ID_NONE: an open edge, or one of more than two triangles. */
static inline uint32_t shb_neighbour_of(uint32_t neighbour) {
    return neighbour >> 1;
}
static inline bool shb_neighbour_is_turned(uint32_t neighbour) {
    return neighbour & 1;
}

/* A hash of everything that the topology depends on: transforms, positions, indices. Scenes that
 * differ have equal ones once in 2^64. */
uint64_t shb_topology_key(const shb_scene *scene);

/* Fills the topology of a scene that has passed the checks of drawing; false: out of memory, or
 * more than 2^30 triangles; *topology is empty then. */
bool shb_topology_make(const shb_context *context, const shb_scene *scene, uint64_t key,
                       shb_topology *topology);
void shb_topology_release(const shb_context *context, shb_topology *topology);

size_t shb_topology_bytes(const shb_topology *topology);

#endif
