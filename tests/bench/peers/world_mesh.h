/* A scene as one indexed mesh in world units, as other renderers take it. */
#ifndef PEERS_WORLD_MESH_H
#define PEERS_WORLD_MESH_H

#include "shadowbias/scene.h"

typedef struct world_mesh {
    float *positions; /* x, y, z of each vertex */
    float *normals;   /* the same; zero where the scene has none */
    uint32_t *indices;
    uint32_t vertex_count, triangle_count;
} world_mesh;

/* Triangles in the order of their ids. False when memory runs out; nothing is to be freed then. */
bool world_mesh_create(const shb_scene *scene, world_mesh *mesh);
void world_mesh_free(world_mesh *mesh);

#endif
