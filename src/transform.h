/* Vertices to clip space.
 *
 * The matrix clip_from_world * world_from_mesh is multiplied in double, once per instance. Row r of
 * a vertex is ((m[r] * x + m[4 + r] * y) + m[8 + r] * z) + m[12 + r] in double, in this order.
 *
 * From here on depth is canonical: smaller is nearer. For a reversed view the matrix's row z is
 * negated, which mirrors every later rounding exactly. Far is then 0 instead of 1. */
#ifndef SRC_TRANSFORM_H
#define SRC_TRANSFORM_H

#include "context.h"
#include "shadowbias/raster.h"

/* x, y, canonical z, w. */
typedef struct shb_clip_position {
    double v[4];
} shb_clip_position;

/* What a usable corner's window coordinates may be off by: pixels, and depth by z and by z_part of
 * its size. Not below any of it; infinite or NaN where nothing is known. */
typedef struct shb_corner_errors {
    double x, y, z, z_part;
} shb_corner_errors;

/* An instance that has triangles. Its vertices, triangles and clusters are runs of the drawing's
 * ones. */
typedef struct shb_draw_instance {
    const shb_mesh *mesh;
    const shb_clusters *clusters; /* drawn in place of the mesh's vertices; NULL: none */
    shb_mat4 world_from_mesh, clip_from_mesh;
    bool moves;                      /* the mesh is not in the world as it is */
    bool affine;                     /* w is 1 */
    shb_corner_errors corner_errors; /* where planes are drawn */
    uint64_t first_vertex;
    uint64_t first_triangle; /* its id */
    uint64_t first_cluster;
    bool keep_positive; /* draw triangles whose window area, y down, is positive */
    bool keep_negative;
} shb_draw_instance;

/* A scene as one drawing sees it. */
typedef struct shb_geometry {
    const shb_draw_instance *instances;
    size_t instance_count;
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t cluster_count;
    bool few; /* a few triangles that may be large ones, one over the other */
} shb_geometry;

struct shb_target;

/* Lists the instances of a checked scene in the context's scratch; false: out of memory. */
bool shb_geometry_prepare(shb_context *context, const shb_draw_desc *desc,
                          const struct shb_target *target, shb_geometry *geometry);

/* The instance of a triangle; the id must be below the triangle count. */
const shb_draw_instance *shb_geometry_instance(const shb_geometry *geometry, uint64_t id);

/* The instance of a vertex of the drawing. */
const shb_draw_instance *shb_geometry_instance_of_vertex(const shb_geometry *geometry,
                                                         uint64_t vertex);

/* The instance of a cluster of the drawing. */
const shb_draw_instance *shb_geometry_instance_of_cluster(const shb_geometry *geometry,
                                                          uint64_t cluster);

/* The vertices that the instance has in the drawing. */
uint64_t shb_instance_vertices(const shb_draw_instance *instance);

/* True if the triangle belongs to this instance. */
static inline bool shb_instance_has(const shb_draw_instance *instance, uint64_t id) {
    return id - instance->first_triangle < instance->mesh->triangle_count;
}

/* The corners of a triangle of the instance, in mesh order. */
void shb_geometry_corners(const shb_draw_instance *instance, uint64_t id,
                          shb_clip_position corners[3]);

#endif
