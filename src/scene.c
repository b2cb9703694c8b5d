#include "strict.h"

#include "scene.h"

#include "clusters.h"
#include "context.h"
#include "matrix.h"

static bool is_all_zero(const shb_mat4 *a) {
    for (int i = 0; i < 16; i++)
        if (a->m[i] != 0)
            return false;
    return true;
}

shb_mat4 shb_instance_transform(const shb_instance *instance) {
    return is_all_zero(&instance->world_from_mesh) ? shb_mat4_identity()
                                                   : instance->world_from_mesh;
}

bool shb_transform_mirrors(const shb_mat4 *transform) {
    const double *m = transform->m;
    const shb_vec3 x = {m[0], m[1], m[2]}, y = {m[4], m[5], m[6]}, z = {m[8], m[9], m[10]};
    return shb_vec3_dot(x, shb_vec3_cross(y, z)) < 0;
}

static shb_result fail(const char **reason, shb_result result, const char *sentence) {
    *reason = sentence;
    return result;
}

static bool is_aligned(const void *pointer, size_t alignment) {
    return (uintptr_t)pointer % alignment == 0;
}

static shb_result check_indices(const shb_mesh *mesh, const char **reason) {
    const uint32_t size = mesh->index_size ? mesh->index_size : 4;
    if (size != 2 && size != 4)
        return fail(reason, SHB_ERROR_ARGUMENT, "mesh.index_size is neither 2 nor 4");
    if (!is_aligned(mesh->indices, size))
        return fail(reason, SHB_ERROR_ARGUMENT, "mesh.indices is not aligned to an index");
    if (mesh->triangle_count > PTRDIFF_MAX / (3 * (size_t)size))
        return fail(reason, SHB_ERROR_SIZE, "mesh.triangle_count overflows the address space");
    if (!mesh->indices && (uint64_t)mesh->triangle_count * 3 > mesh->vertex_count)
        return fail(reason, SHB_ERROR_ARGUMENT,
                    "mesh.vertex_count is below 3 * mesh.triangle_count and there are no indices");
    return SHB_OK;
}

shb_result shb_mesh_check(const shb_mesh *mesh, const char **reason) {
    if (mesh->triangle_count == 0)
        return SHB_OK;
    if (!mesh->positions)
        return fail(reason, SHB_ERROR_ARGUMENT, "mesh.positions is NULL");
    if (!is_aligned(mesh->positions, sizeof(float)) || !is_aligned(mesh->normals, sizeof(float)))
        return fail(reason, SHB_ERROR_ARGUMENT, "mesh.positions or normals is not aligned to 4");
    if (!shb_is_triple_stride(mesh->position_stride) || !shb_is_triple_stride(mesh->normal_stride))
        return fail(reason, SHB_ERROR_ARGUMENT,
                    "mesh.position_stride or normal_stride is no multiple of 4 or below 12");
    if (mesh->vertex_count == 0)
        return fail(reason, SHB_ERROR_SIZE, "mesh.vertex_count is 0 but there are triangles");
    if (shb_triples_overflow(mesh->vertex_count, mesh->position_stride) ||
        (mesh->normals && shb_triples_overflow(mesh->vertex_count, mesh->normal_stride)))
        return fail(reason, SHB_ERROR_SIZE, "mesh.vertex_count times a stride overflows");
    return check_indices(mesh, reason);
}

static shb_result check_clusters(const shb_mesh *mesh, const char **reason) {
    if (mesh->clusters && !shb_clusters_fit(mesh->clusters, mesh))
        return fail(reason, SHB_ERROR_ARGUMENT, "mesh.clusters were made of another mesh");
    return SHB_OK;
}

static shb_result check_instance(const shb_instance *instance, const char **reason) {
    const shb_mat4 transform = shb_instance_transform(instance);
    const double *m = transform.m;
    if (!shb_mat4_is_finite(&transform))
        return fail(reason, SHB_ERROR_NUMBER, "world_from_mesh is not finite");
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        return fail(reason, SHB_ERROR_ARGUMENT, "the last row of world_from_mesh is not 0 0 0 1");
    if ((unsigned)instance->cull > SHB_CULL_FRONT)
        return fail(reason, SHB_ERROR_ARGUMENT, "cull is out of range");
    if (!instance->mesh)
        return fail(reason, SHB_ERROR_ARGUMENT, "mesh is NULL");
    const shb_result result = shb_mesh_check(instance->mesh, reason);
    return result ? result : check_clusters(instance->mesh, reason);
}

shb_result shb_scene_check(const shb_context *context, const char *caller, const char *name,
                           const shb_scene *scene) {
    if (!scene)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: %s is NULL", caller, name);
    if (scene->instance_count && !scene->instances)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: %s.instances is NULL", caller, name);
    if (scene->instance_count > PTRDIFF_MAX / sizeof(shb_instance))
        return shb_fail(context, SHB_ERROR_SIZE,
                        "%s: %s.instance_count %zu overflows the address space", caller, name,
                        scene->instance_count);
    uint64_t triangles = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const char *reason = NULL;
        const shb_result result = check_instance(&scene->instances[i], &reason);
        if (result)
            return shb_fail(context, result, "%s: %s.instances[%zu]: %s", caller, name, i, reason);
        triangles += scene->instances[i].mesh->triangle_count;
        if (triangles > SHB_TRIANGLES_MAX)
            return shb_fail(context, SHB_ERROR_SIZE, "%s: %s has more than %u triangles", caller,
                            name, (unsigned)SHB_TRIANGLES_MAX);
    }
    return SHB_OK;
}

/* False if the triangle has an index that is out of range. */
static bool get_triangle(const shb_mesh *mesh, uint32_t triangle, uint32_t vertices[3]) {
    shb_mesh_triangle(mesh, triangle, vertices);
    return vertices[0] < mesh->vertex_count && vertices[1] < mesh->vertex_count &&
           vertices[2] < mesh->vertex_count;
}

static bool are_short_below(const uint16_t *indices, size_t count, uint32_t limit) {
    uint32_t outside = 0;
    for (size_t i = 0; i < count; i++)
        outside |= indices[i] >= limit;
    return !outside;
}

static bool are_below(const uint32_t *indices, size_t count, uint32_t limit) {
    uint32_t outside = 0;
    for (size_t i = 0; i < count; i++)
        outside |= indices[i] >= limit;
    return !outside;
}

bool shb_mesh_has_valid_indices(const shb_mesh *mesh) {
    const size_t count = mesh->indices ? 3 * (size_t)mesh->triangle_count : 0;
    return mesh->index_size == 2 ? are_short_below(mesh->indices, count, mesh->vertex_count)
                                 : are_below(mesh->indices, count, mesh->vertex_count);
}

shb_result shb_scene_check_indices(const shb_context *context, const char *caller,
                                   const shb_scene *scene) {
    for (size_t i = 0; i < scene->instance_count; i++)
        if (!shb_mesh_has_valid_indices(scene->instances[i].mesh))
            return shb_fail(context, SHB_ERROR_ARGUMENT,
                            "%s: scene.instances[%zu]: an index is not below mesh.vertex_count %u",
                            caller, i, (unsigned)scene->instances[i].mesh->vertex_count);
    return SHB_OK;
}

shb_result shb_scene_validate(const shb_scene *scene) {
    const shb_result result = shb_scene_check(NULL, "", "", scene);
    return result ? result : shb_scene_check_indices(NULL, "", scene);
}

uint64_t shb_scene_triangle_count(const shb_scene *scene) {
    if (shb_scene_check(NULL, "", "", scene))
        return 0;
    uint64_t count = 0;
    for (size_t i = 0; i < scene->instance_count; i++)
        count += scene->instances[i].mesh->triangle_count;
    return count;
}

size_t shb_scene_instance_of(const shb_scene *scene, uint32_t id, uint32_t *first) {
    size_t instance = 0;
    *first = 0;
    while (instance < scene->instance_count &&
           id - *first >= scene->instances[instance].mesh->triangle_count)
        *first += scene->instances[instance++].mesh->triangle_count;
    return instance;
}

shb_result shb_scene_triangle(const shb_scene *scene, uint32_t id, shb_vec3 corners[3]) {
    const shb_result result = shb_scene_check(NULL, "", "", scene);
    if (result)
        return result;
    if (!corners || id >= shb_scene_triangle_count(scene))
        return SHB_ERROR_ARGUMENT;
    uint32_t first, vertices[3];
    const shb_instance *instance = &scene->instances[shb_scene_instance_of(scene, id, &first)];
    if (!get_triangle(instance->mesh, id - first, vertices))
        return SHB_ERROR_ARGUMENT;
    const shb_mat4 transform = shb_instance_transform(instance);
    for (int i = 0; i < 3; i++)
        corners[i] = mat4_transform_point(&transform, shb_mesh_point(instance->mesh, vertices[i]));
    return SHB_OK;
}
