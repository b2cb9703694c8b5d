/* The triangles of a scene as one mesh: vertices welded where their world positions are equal, and
 * which triangles meet at which edges. It does not depend on a light. */
#ifndef SRC_TOPOLOGY_H
#define SRC_TOPOLOGY_H

#include "context.h"
#include "shadowbias/scene.h"

/* What the buffers of a context's topology_scratch hold. */
enum {
    /* memory of the next topology */
    SHB_TOPOLOGY_CORNERS,
    SHB_TOPOLOGY_NEIGHBOURS,
    SHB_TOPOLOGY_POSITIONS,
    SHB_TOPOLOGY_KEPT, /* how many these are */
    /* while vertices are welded */
    SHB_TOPOLOGY_WORLD = SHB_TOPOLOGY_KEPT, /* positions, before it is known how many are left */
    SHB_TOPOLOGY_SLOTS,
    SHB_TOPOLOGY_WELDED,
    /* while edges are linked */
    SHB_TOPOLOGY_BUCKETS,
    SHB_TOPOLOGY_ENTRIES,
    SHB_TOPOLOGY_BUFFERS
};
_Static_assert(sizeof((shb_context *)0)->topology_scratch ==
                   SHB_TOPOLOGY_BUFFERS * sizeof(shb_buffer),
               "a buffer of the context for each name");

typedef struct shb_topology {
    size_t triangle_count, vertex_count;
    uint32_t (*corners)[3];    /* vertices of each triangle, by id */
    uint32_t (*neighbours)[3]; /* beyond the edge from corner k to the next: shb_neighbour_of. All
                                  SHB_TWIN: a triangle before this one has the same vertices */
    double (*positions)[3];    /* of the vertices, world */
    uint64_t key;              /* of the scene that it was made of */
    shb_buffer memory[SHB_TOPOLOGY_KEPT]; /* where all the above is */
} shb_topology;

#define SHB_TWIN 0xfffffffeu

static inline bool shb_topology_is_twin(const shb_topology *topology, size_t triangle) {
    return topology->neighbours[triangle][0] == SHB_TWIN;
}

/* The places of a triangle's corners in the order of their vertices' numbers. Its edges are ordered
 * by the corner that they lie opposite of: edge 0 from the second to the third, 1 from the first to
 * the third, 2 from the first to the second. So the edge from corner k to the next has the place of
 * corner k + 2. */
static inline void shb_order_corners(const uint32_t corners[3], uint32_t places[3]) {
    const uint32_t a = corners[0] > corners[1], b = corners[1] > corners[2];
    const uint32_t c = corners[0] > corners[2];
    places[0] = a + c;
    places[1] = 1 - a + b;
    places[2] = 2 - b - c;
}

/* A neighbour's id; which of its edges it shares, as an ordered edge; and whether both triangles
 * run along the edge in the same direction, so that one is wound the other way. SHB_ID_NONE: an
 * open edge, or one of more than two triangles. */
static inline uint32_t shb_neighbour_of(uint32_t neighbour) {
    return neighbour >> 3;
}
static inline uint32_t shb_neighbour_edge(uint32_t neighbour) {
    return neighbour & 3;
}
static inline bool shb_neighbour_is_turned(uint32_t neighbour) {
    return neighbour & 4;
}

/* A hash of a mesh's positions and indices. */
uint64_t shb_mesh_key(const shb_mesh *mesh);

/* A hash of everything that the topology depends on: transforms, positions, indices, those of a
 * mesh with clusters as they were then. Scenes that differ have equal ones once in 2^64. */
uint64_t shb_topology_key(const shb_scene *scene);

/* Fills the topology of a scene that has passed the checks of drawing. Where vertices have moved,
 * but those that were one are so still, the neighbours are those of known, which may be empty.
 * False: out of memory, or more than 2^29 - 1 triangles; *topology is empty then. */
bool shb_topology_make(shb_context *context, const shb_scene *scene, uint64_t key,
                       const shb_topology *known, shb_topology *topology);

/* Both leave *topology empty. The first keeps its memory in the context for the next one: only
 * where no other is made at the same time. */
void shb_topology_recycle(shb_context *context, shb_topology *topology);
void shb_topology_release(const shb_context *context, shb_topology *topology);

size_t shb_topology_bytes(const shb_topology *topology);

#endif
