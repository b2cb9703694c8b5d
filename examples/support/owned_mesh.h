/* A triangle mesh that owns its arrays and grows: what the OBJ reader and the built-in scenes make.
 */
#ifndef EXAMPLES_OWNED_MESH_H
#define EXAMPLES_OWNED_MESH_H

#include "shadowbias/scene.h"

/* Zero-initialised is an empty mesh. */
typedef struct owned_mesh {
    float *positions;  /* x, y, z of each vertex */
    float *normals;    /* the same; NULL when the vertices have none */
    uint32_t *indices; /* three a triangle */
    uint32_t vertex_count, triangle_count;
    uint32_t vertex_capacity, triangle_capacity;
    bool failed; /* memory ran out: the mesh is incomplete */
} owned_mesh;

/* Adds a vertex and returns its index. normal is NULL for all vertices of a mesh or for none. */
uint32_t owned_mesh_add_vertex(owned_mesh *mesh, const float position[3], const float normal[3]);

void owned_mesh_add_triangle(owned_mesh *mesh, uint32_t a, uint32_t b, uint32_t c);

/* The library's view of the mesh, valid until the mesh grows or is freed. */
shb_mesh owned_mesh_view(const owned_mesh *mesh);

/* Leaves an empty mesh. */
void owned_mesh_free(owned_mesh *mesh);

#endif
