/* The mesh of a scene as a light sees it: where its vertices are in the map, and which way its
 * triangles face. */
#ifndef SRC_LIGHT_MESH_H
#define SRC_LIGHT_MESH_H

#include "kernels/lists.h"
#include "shadowbias/map.h"
#include "topology.h"

/* Which way a triangle is wound in the map, as far as rounding can tell. */
enum {
    SHB_FACING_UNKNOWN = 0, /* edge-on, or without area */
    SHB_FACING_CUT = 2      /* not all of it lies behind the near plane: facing is unknown */
    /* 1 and -1: the sign of its area */
};

/* A triangle as walks see it, in one cache line. Its corners are in the order of their vertices'
 * numbers, so that both triangles of an edge run along it in the same direction. */
typedef struct shb_walk_triangle {
    SHB_ALIGN double x[3]; /* texels */
    double y[3];
    uint32_t beyond[3]; /* its ordered edges, as the topology's neighbours */
    uint32_t marks;
} shb_walk_triangle;

#define SHB_CORNER_SEEN 1u  /* << corner: it is finite and lies behind the near plane */
#define SHB_EDGE_JOINED 16u /* << edge: shb_light_mesh_beyond has something there */

typedef struct shb_light_mesh {
    const shb_topology *topology;
    shb_list_frame frame;
    /* in the context's scratch while a scene is drawn: */
    shb_list_vertex *vertices;
    int8_t *facing; /* by id */
    /* NULL, or what walks need, by id: */
    const shb_walk_triangle *triangles;
} shb_light_mesh;

/* Where the light sees a triangle, up to a texel beyond it, and its nearest depth, rounded towards
 * the light. A twin is seen nowhere. */
typedef struct shb_light_box {
    shb_list_box box;
    float nearest;
} shb_light_box;

/* The mesh as the light of a map sees it. triangles and boxes: NULL, or one a triangle, to be
 * filled. False: out of memory. */
bool shb_light_mesh_make(shb_context *context, const shb_map_info *info,
                         const shb_topology *topology, shb_walk_triangle *triangles,
                         shb_light_box *boxes, shb_light_mesh *mesh);

/* Writes the corners of a triangle. */
void shb_light_mesh_corners(const shb_light_mesh *mesh, uint32_t id, uint32_t lane,
                            shb_list_corners *out);

/* The triangle beyond the edge from corner k to the next, if the light sees it on the other side of
 * that edge; else SHB_ID_NONE: the mesh ends there, or turns round. Two triangles lie on different
 * sides of their edge if they are wound alike along it and face alike, or neither. */
static inline uint32_t shb_light_mesh_beyond(const shb_light_mesh *mesh, uint32_t triangle, int k) {
    const uint32_t neighbour = mesh->topology->neighbours[triangle][k];
    if (neighbour >= SHB_TWIN)
        return SHB_ID_NONE;
    const uint32_t id = shb_neighbour_of(neighbour);
    const int facing = mesh->facing[triangle], other = mesh->facing[id];
    const int expected = shb_neighbour_is_turned(neighbour) ? -1 : 1;
    return facing * other == expected ? id : SHB_ID_NONE;
}

#endif
