#include "strict.h"

#include "transform.h"

#include "clusters.h"
#include "corner_errors.h"
#include "scene.h"
#include "scratch.h"

#include <stddef.h>

#define FEW_TRIANGLES 1024
#define FEW_TRIANGLES_TEXELS (512u * 512u)

/* A front face is counter-clockwise with y up, so its area is negative with y down. */
static void choose_faces(const shb_instance *instance, bool flip, bool mirrors,
                         shb_draw_instance *drawn) {
    const bool drops_back = instance->cull == (flip ? SHB_CULL_FRONT : SHB_CULL_BACK);
    const bool drops_front = instance->cull == (flip ? SHB_CULL_BACK : SHB_CULL_FRONT);
    drawn->keep_negative = mirrors ? !drops_back : !drops_front;
    drawn->keep_positive = mirrors ? !drops_front : !drops_back;
}

static shb_mat4 canonical_clip_from_mesh(const shb_view *view, const shb_mat4 *world_from_mesh) {
    shb_mat4 product = shb_mat4_multiply(view->clip_from_world, *world_from_mesh);
    if (view->reversed)
        for (int column = 0; column < 4; column++)
            product.m[4 * column + 2] = -product.m[4 * column + 2];
    return product;
}

static bool is_affine(const shb_mat4 *matrix) {
    const double *m = matrix->m;
    return m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1;
}

static bool are_few(const shb_draw_desc *desc) {
    uint64_t triangles = 0;
    for (size_t i = 0; i < desc->scene->instance_count; i++)
        triangles += desc->scene->instances[i].mesh->triangle_count;
    return triangles <= FEW_TRIANGLES && desc->width * desc->height > FEW_TRIANGLES_TEXELS;
}

/* The scalar code draws meshes alone. So do the kernels a few large triangles, which are sorted. */
static void collect_instances(const shb_draw_desc *desc, const shb_target *target,
                              bool with_kernels, shb_draw_instance *instances,
                              shb_geometry *geometry) {
    *geometry = (shb_geometry){.instances = instances, .few = are_few(desc)};
    const bool with_clusters = with_kernels && !geometry->few;
    const shb_mat4 still = shb_mat4_identity();
    for (size_t i = 0; i < desc->scene->instance_count; i++) {
        const shb_instance *instance = &desc->scene->instances[i];
        if (instance->mesh->triangle_count == 0)
            continue;
        const shb_mat4 world_from_mesh = shb_instance_transform(instance);
        shb_draw_instance *drawn = &instances[geometry->instance_count++];
        drawn->mesh = instance->mesh;
        drawn->clusters = with_clusters ? instance->mesh->clusters : NULL;
        drawn->world_from_mesh = world_from_mesh;
        drawn->moves = memcmp(&world_from_mesh, &still, sizeof still) != 0;
        drawn->clip_from_mesh = canonical_clip_from_mesh(desc->view, &world_from_mesh);
        drawn->affine = is_affine(&drawn->clip_from_mesh);
        if (target->planes)
            drawn->corner_errors = shb_corner_errors_of(target, desc->view, drawn);
        drawn->first_vertex = geometry->vertex_count;
        drawn->first_cluster = geometry->cluster_count;
        drawn->first_triangle = geometry->triangle_count;
        choose_faces(instance, desc->flip_culling, shb_transform_mirrors(&world_from_mesh), drawn);
        geometry->vertex_count += shb_instance_vertices(drawn);
        geometry->cluster_count += drawn->clusters ? drawn->clusters->count : 0;
        geometry->triangle_count += instance->mesh->triangle_count;
    }
}

static void transform_vertex(const double m[16], const float *p, double v[4]) {
    const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
    for (int row = 0; row < 4; row++)
        v[row] = ((m[row] * x + m[4 + row] * y) + m[8 + row] * z) + m[12 + row];
}

bool shb_geometry_prepare(shb_context *context, const shb_draw_desc *desc, const shb_target *target,
                          shb_geometry *geometry) {
    shb_draw_instance *instances =
        shb_buffer_reserve(context, &context->draw_scratch[SHB_SCRATCH_INSTANCES],
                           desc->scene->instance_count, sizeof *instances);
    if (instances)
        collect_instances(desc, target, context->kernels != NULL, instances, geometry);
    return instances != NULL;
}

/* The last instance whose first vertex, triangle or cluster, the member at this offset, is at or
 * before the number: those without any share their first one with the next instance. */
static const shb_draw_instance *find_instance(const shb_geometry *geometry, size_t member,
                                              uint64_t number) {
    size_t lo = 0, hi = geometry->instance_count;
    while (hi - lo > 1) {
        const size_t middle = lo + (hi - lo) / 2;
        const void *first = (const char *)&geometry->instances[middle] + member;
        if (*(const uint64_t *)first <= number)
            lo = middle;
        else
            hi = middle;
    }
    return &geometry->instances[lo];
}

const shb_draw_instance *shb_geometry_instance(const shb_geometry *geometry, uint64_t id) {
    return find_instance(geometry, offsetof(shb_draw_instance, first_triangle), id);
}

const shb_draw_instance *shb_geometry_instance_of_vertex(const shb_geometry *geometry,
                                                         uint64_t vertex) {
    return find_instance(geometry, offsetof(shb_draw_instance, first_vertex), vertex);
}

const shb_draw_instance *shb_geometry_instance_of_cluster(const shb_geometry *geometry,
                                                          uint64_t cluster) {
    return find_instance(geometry, offsetof(shb_draw_instance, first_cluster), cluster);
}

uint64_t shb_instance_vertices(const shb_draw_instance *instance) {
    return instance->clusters ? 0 : instance->mesh->vertex_count;
}

void shb_geometry_corners(const shb_draw_instance *instance, uint64_t id,
                          shb_clip_position corners[3]) {
    uint32_t vertices[3];
    shb_mesh_triangle(instance->mesh, (uint32_t)(id - instance->first_triangle), vertices);
    for (int i = 0; i < 3; i++)
        transform_vertex(instance->clip_from_mesh.m, shb_mesh_position(instance->mesh, vertices[i]),
                         corners[i].v);
}
