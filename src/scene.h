/* What drawing, shading and the reference share about scenes. */
#ifndef SRC_SCENE_H
#define SRC_SCENE_H

#include "shadowbias/context.h"
#include "shadowbias/scene.h"
#include "triples.h"
#include "vector.h"

/* The instance's transform with all zeros read as the identity. */
shb_mat4 shb_instance_transform(const shb_instance *instance);

/* True if the transform mirrors (its determinant is negative). */
bool shb_transform_mirrors(const shb_mat4 *transform);

/* The checks of one mesh, clusters and the values of indices aside. Returns SHB_OK or the error,
 * with a static sentence about it in *reason. */
shb_result shb_mesh_check(const shb_mesh *mesh, const char **reason);

bool shb_mesh_has_valid_indices(const shb_mesh *mesh);

/* The checks of drawing: everything but the values of indices. Tells the context's log what is
 * wrong, in the name of the caller, with what it calls the scene; context NULL: silent. */
shb_result shb_scene_check(const shb_context *context, const char *caller, const char *name,
                           const shb_scene *scene);

/* The same for the values of indices, in a scene that has passed the other checks. */
shb_result shb_scene_check_indices(const shb_context *context, const char *caller,
                                   const shb_scene *scene);

/* The vertex indices of triangle number triangle of the mesh. */
static inline void shb_mesh_triangle(const shb_mesh *mesh, uint32_t triangle,
                                     uint32_t vertices[3]) {
    const size_t first = 3 * (size_t)triangle;
    for (size_t i = 0; i < 3; i++) {
        if (!mesh->indices)
            vertices[i] = (uint32_t)(first + i);
        else if (mesh->index_size == 2)
            vertices[i] = ((const uint16_t *)mesh->indices)[first + i];
        else
            vertices[i] = ((const uint32_t *)mesh->indices)[first + i];
    }
}

/* Position of a vertex. */
static inline const float *shb_mesh_position(const shb_mesh *mesh, uint32_t vertex) {
    return shb_triple_at(mesh->positions, mesh->position_stride, vertex);
}

/* The same in double. */
static inline shb_vec3 shb_mesh_point(const shb_mesh *mesh, uint32_t vertex) {
    return vec3_from_floats(shb_mesh_position(mesh, vertex));
}

/* Normal of a vertex; the mesh must have normals. */
static inline const float *shb_mesh_normal(const shb_mesh *mesh, uint32_t vertex) {
    return shb_triple_at(mesh->normals, mesh->normal_stride, vertex);
}

/* Finds the instance of a triangle id: the instance's number, and in *first the id of its first
 * triangle; the number of instances if the scene has no such triangle. */
size_t shb_scene_instance_of(const shb_scene *scene, uint32_t id, uint32_t *first);

#endif
