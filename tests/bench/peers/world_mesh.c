#include "world_mesh.h"

#include <stdlib.h>
#include <string.h>

static bool is_identity(const shb_mat4 *matrix) {
    static const shb_mat4 zero = {{0}};
    return memcmp(matrix, &zero, sizeof zero) == 0;
}

/* w is 1 for positions and 0 for normals, whose lengths do not matter here. */
static void transform(const shb_mat4 *matrix, const float *from, double w, float *to) {
    for (int row = 0; row < 3; row++)
        to[row] =
            is_identity(matrix)
                ? from[row]
                : (float)(matrix->m[row] * (double)from[0] + matrix->m[4 + row] * (double)from[1] +
                          matrix->m[8 + row] * (double)from[2] + matrix->m[12 + row] * w);
}

static const float *element(const float *base, size_t stride, uint32_t index) {
    return (const float *)(const void *)((const char *)base + (stride ? stride : 12) * index);
}

static uint32_t index_of(const shb_mesh *mesh, size_t i) {
    if (!mesh->indices)
        return (uint32_t)i;
    return mesh->index_size == 2 ? ((const uint16_t *)mesh->indices)[i]
                                 : ((const uint32_t *)mesh->indices)[i];
}

static void add_instance(const shb_instance *instance, world_mesh *mesh) {
    const shb_mesh *from = instance->mesh;
    for (uint32_t i = 0; i < from->vertex_count; i++) {
        const size_t to = 3 * (size_t)(mesh->vertex_count + i);
        transform(&instance->world_from_mesh, element(from->positions, from->position_stride, i), 1,
                  mesh->positions + to);
        if (from->normals)
            transform(&instance->world_from_mesh, element(from->normals, from->normal_stride, i), 0,
                      mesh->normals + to);
    }
    for (size_t i = 0; i < 3 * (size_t)from->triangle_count; i++)
        mesh->indices[3 * (size_t)mesh->triangle_count + i] =
            mesh->vertex_count + index_of(from, i);
    mesh->vertex_count += from->vertex_count;
    mesh->triangle_count += from->triangle_count;
}

bool world_mesh_create(const shb_scene *scene, world_mesh *mesh) {
    size_t vertices = 0, triangles = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        vertices += scene->instances[i].mesh->vertex_count;
        triangles += scene->instances[i].mesh->triangle_count;
    }
    *mesh = (world_mesh){.positions = malloc(12 * vertices + 16), /* readers take 16 bytes */
                         .normals = calloc(vertices + 1, 12),
                         .indices = malloc(12 * triangles + 1)};
    if (!mesh->positions || !mesh->normals || !mesh->indices) {
        world_mesh_free(mesh);
        return false;
    }
    for (size_t i = 0; i < scene->instance_count; i++)
        add_instance(&scene->instances[i], mesh);
    return true;
}

void world_mesh_free(world_mesh *mesh) {
    free(mesh->positions);
    free(mesh->normals);
    free(mesh->indices);
    *mesh = (world_mesh){0};
}
