/* Meshes, instances and scenes: borrowed views of the host's own arrays; nothing is copied. */
#ifndef SHADOWBIAS_SCENE_H
#define SHADOWBIAS_SCENE_H

#include "shadowbias/math.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_clusters shb_clusters; /* clusters.h */

/* Triangles. Positions and normals are aligned to 4 bytes, indices to their own size. A triangle
 * with a vertex that is not finite after its transform is left out and counted; a triangle without
 * area covers nothing. */
typedef struct shb_mesh {
    const float *positions;       /* x, y, z of each vertex in mesh units */
    size_t position_stride;       /* bytes from one vertex to the next: a multiple of 4 that is at
                                     least 12; 0: 12 */
    const float *normals;         /* shading normals, or NULL; no bias method reads them */
    size_t normal_stride;         /* the same for normals */
    uint32_t vertex_count;        /* indices must be below it */
    const void *indices;          /* three for each triangle; NULL: vertices 0 1 2, 3 4 5, ... */
    uint32_t index_size;          /* bytes of an index: 2 or 4; 0: 4 */
    uint32_t triangle_count;      /* 0 draws nothing */
    const shb_clusters *clusters; /* made of this mesh for faster drawing, or NULL */
} shb_mesh;

typedef enum shb_cull {
    SHB_CULL_NONE = 0, /* thin sheets: both sides are drawn */
    SHB_CULL_BACK,     /* closed solids: only front faces are drawn */
    SHB_CULL_FRONT     /* only back faces are drawn */
} shb_cull;

typedef struct shb_instance {
    const shb_mesh *mesh;
    shb_mat4 world_from_mesh; /* last row 0 0 0 1; all zeros: the identity. Under a mirroring
                                 transform the winding is reversed: front faces stay front faces */
    shb_cull cull;
} shb_instance;

/* Triangle ids count through the instances in order: those of instance k start where the triangles
 * of instance k - 1 end. */
typedef struct shb_scene {
    const shb_instance *instances;
    size_t instance_count;
} shb_scene;

/* Checks every field, index and transform of the scene against the rules above: SHB_ERROR_ARGUMENT,
 * SHB_ERROR_SIZE, SHB_ERROR_NUMBER (transform). Drawing checks all but the indices, which take a
 * pass over them, and reads beyond the vertices if one is out of range: call this once for meshes
 * from a source you do not trust. It has no context to tell what is wrong. */
shb_result shb_scene_validate(const shb_scene *scene);

/* The number of triangles; 0 for a scene that drawing would refuse. */
uint64_t shb_scene_triangle_count(const shb_scene *scene);

/* The box around all finite vertices that a triangle uses, in world units; empty if there are none.
 * Errors as shb_scene_validate. */
shb_result shb_scene_bounds(const shb_scene *scene, shb_box *bounds);

/* The three corners of a triangle in world units, in mesh order: float position times transform, in
 * double. SHB_ERROR_ARGUMENT if the scene has no such id or an index of the triangle is out of
 * range, others as shb_scene_validate. Cost grows with the number of instances. */
shb_result shb_scene_triangle(const shb_scene *scene, uint32_t id, shb_vec3 corners[3]);

#ifdef __cplusplus
}
#endif

#endif
