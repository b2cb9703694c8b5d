/* The inside of clusters. */
#ifndef SRC_CLUSTERS_H
#define SRC_CLUSTERS_H

#include "kernels/raster.h"
#include "shadowbias/clusters.h"

/* Vertices of a cluster take a multiple of so many places. */
#define SHB_CLUSTER_PADDING 8

/* The directions whose three numbers are -1, 0 or 1. */
#define SHB_DIRECTIONS 27

static inline int shb_direction(int x, int y, int z) {
    return (9 * x + 3 * y + z) + SHB_DIRECTIONS / 2;
}

/* A product with a unit normal, up to sqrt(3), fits into a byte. */
#define SHB_NORMAL_UNIT 64

/* A box in mesh units and bounds of the unit normals. What is said of normals holds for all
 * triangles that have two edges. */
typedef struct shb_cluster {
    float lo[3], hi[3]; /* of the vertices; lo[0] is NaN if one of them is not finite */
    float height; /* no triangle is less high over its longest edge; 0: normals are not known */
    int8_t largest[SHB_DIRECTIONS]; /* no normal has a larger product with the direction, in
                                       SHB_NORMAL_UNITs */
    uint32_t first_triangle;
    uint64_t first_vertex; /* a place */
    uint64_t first_corner; /* the same of corners */
    uint16_t triangle_count, vertex_count;
} shb_cluster;

struct shb_clusters {
    const shb_context *context;            /* whose memory it is */
    uint32_t vertex_count, triangle_count; /* of the mesh */
    uint64_t key;                          /* of the mesh, see topology.h */
    size_t count;
    shb_cluster *clusters;
    float *positions;    /* of each cluster all x, all y, all z: three for a place */
    uint8_t *corners;    /* numbers in the cluster, see shb_corner_place */
    uint32_t *triangles; /* their numbers in the mesh */
};

/* Places of the cluster's vertices. */
static inline size_t shb_cluster_places(uint32_t vertex_count) {
    return (vertex_count + SHB_CLUSTER_PADDING - 1) / SHB_CLUSTER_PADDING * SHB_CLUSTER_PADDING;
}

/* Places of the triangles' corners. */
static inline size_t shb_corner_places(uint32_t triangle_count) {
    return 3 * ((triangle_count + SHB_CORNERS_TOGETHER - 1) / SHB_CORNERS_TOGETHER *
                SHB_CORNERS_TOGETHER);
}

/* True if the clusters can be those of the mesh: it has as many vertices and triangles. */
bool shb_clusters_fit(const shb_clusters *clusters, const shb_mesh *mesh);

#endif
