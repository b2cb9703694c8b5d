#include "strict.h"

#include "chunk_gather.h"

#include "scene.h"

/* The depth of the corner that is nearest. */
static double nearest_depth(const shb_chunk *chunk, uint32_t triangle) {
    uint32_t corner[3];
    shb_mesh_triangle(chunk->instance->mesh, triangle, corner);
    double nearest = chunk->vertices[corner[0]].z;
    for (int k = 1; k < 3; k++) {
        const double z = chunk->vertices[corner[k]].z;
        nearest = z < nearest ? z : nearest;
    }
    return nearest;
}

/* By insertion: there are few of them. */
static void sort_by_depth(const shb_chunk *chunk, uint32_t triangles[SHB_CHUNK]) {
    double depths[SHB_CHUNK];
    for (uint32_t i = 0; i < chunk->count; i++) {
        const uint32_t triangle = triangles[i];
        const double depth = nearest_depth(chunk, triangle);
        uint32_t at = i;
        for (; at > 0 && depth < depths[at - 1]; at--) {
            depths[at] = depths[at - 1];
            triangles[at] = triangles[at - 1];
        }
        depths[at] = depth;
        triangles[at] = triangle;
    }
}

void shb_gather_flush(shb_gatherer *gatherer) {
    shb_chunk *chunk = &gatherer->chunk;
    chunk->triangles = gatherer->triangles;
    if (chunk->count && gatherer->nearest_first)
        sort_by_depth(chunk, gatherer->triangles);
    if (chunk->count)
        gatherer->kernels->draw(chunk, gatherer->tile);
    chunk->count = 0;
}

void shb_gather(shb_gatherer *gatherer, const shb_chunk *from, uint32_t t) {
    shb_chunk *chunk = &gatherer->chunk;
    if (chunk->count == SHB_CHUNK || chunk->instance != from->instance) {
        shb_gather_flush(gatherer);
        chunk->instance = from->instance;
        chunk->vertices = from->vertices;
    }
    gatherer->triangles[chunk->count++] = from->first + t;
}
