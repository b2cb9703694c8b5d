#include "owned_mesh.h"

#include <stdlib.h>
#include <string.h>

/* The array with room for count elements, or as it was, and the mesh has failed. */
static void *grow(owned_mesh *mesh, void *array, size_t count, size_t size) {
    void *grown = realloc(array, count * size);
    mesh->failed |= !grown;
    return grown ? grown : array;
}

/* Twice the capacity, within 32 bits. */
static uint32_t next_capacity(uint32_t capacity) {
    if (capacity < 64)
        return 64;
    return capacity > UINT32_MAX / 2 ? UINT32_MAX : 2 * capacity;
}

static bool reserve_vertex(owned_mesh *mesh, bool with_normals) {
    if (mesh->failed || mesh->vertex_count < mesh->vertex_capacity)
        return !mesh->failed;
    const uint32_t capacity = next_capacity(mesh->vertex_capacity);
    mesh->failed = mesh->vertex_count == UINT32_MAX;
    mesh->positions = grow(mesh, mesh->positions, capacity, 3 * sizeof(float));
    if (with_normals)
        mesh->normals = grow(mesh, mesh->normals, capacity, 3 * sizeof(float));
    mesh->vertex_capacity = capacity;
    return !mesh->failed;
}

uint32_t owned_mesh_add_vertex(owned_mesh *mesh, const float position[3], const float normal[3]) {
    if (!reserve_vertex(mesh, normal != NULL))
        return 0;
    memcpy(mesh->positions + 3 * (size_t)mesh->vertex_count, position, 3 * sizeof(float));
    if (normal)
        memcpy(mesh->normals + 3 * (size_t)mesh->vertex_count, normal, 3 * sizeof(float));
    return mesh->vertex_count++;
}

static bool reserve_triangle(owned_mesh *mesh) {
    if (mesh->failed || mesh->triangle_count < mesh->triangle_capacity)
        return !mesh->failed;
    const uint32_t capacity = next_capacity(mesh->triangle_capacity);
    mesh->failed = mesh->triangle_count >= SHB_TRIANGLES_MAX;
    mesh->indices = grow(mesh, mesh->indices, capacity, 3 * sizeof(uint32_t));
    mesh->triangle_capacity = capacity;
    return !mesh->failed;
}

void owned_mesh_add_triangle(owned_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
    if (!reserve_triangle(mesh))
        return;
    uint32_t *indices = mesh->indices + 3 * (size_t)mesh->triangle_count++;
    indices[0] = a;
    indices[1] = b;
    indices[2] = c;
}

shb_mesh owned_mesh_view(const owned_mesh *mesh) {
    return (shb_mesh){.positions = mesh->positions,
                      .normals = mesh->normals,
                      .vertex_count = mesh->vertex_count,
                      .indices = mesh->indices,
                      .triangle_count = mesh->triangle_count};
}

void owned_mesh_free(owned_mesh *mesh) {
    free(mesh->positions);
    free(mesh->normals);
    free(mesh->indices);
    *mesh = (owned_mesh){0};
}
