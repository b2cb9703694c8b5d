/* What drawing, shading and the reference share about scenes. */
#ifndef SRC_SCENE_H
#define SRC_SCENE_H

#include "shadowbias/scene.h"

/* The instance's transform with all zeros read as the identity. */
shb_mat4 shb_instance_transform(const shb_instance *instance);

/* True if the transform mirrors (its determinant is negative). */
bool shb_transform_mirrors(const shb_mat4 *transform);

/* The checks of drawing: everything but the values of indices. Returns SHB_OK or the error, with a
 * static sentence about it in *reason. */
shb_result shb_scene_check(const shb_scene *scene, const char **reason);

/* The vertex indices of triangle number triangle of the mesh. */
void shb_mesh_triangle(const shb_mesh *mesh, uint32_t triangle, uint32_t vertices[3]);

/* Position of a vertex. */
const float *shb_mesh_position(const shb_mesh *mesh, uint32_t vertex);

/* Normal of a vertex; the mesh must have normals. */
const float *shb_mesh_normal(const shb_mesh *mesh, uint32_t vertex);

/* Finds the instance of a triangle id: the instance's number, and in *first the id of its first
 * triangle. The id must be below the triangle count. */
size_t shb_scene_instance_of(const shb_scene *scene, uint32_t id, uint32_t *first);

#endif
