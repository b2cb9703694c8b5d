/* The reference as an object, and visibility of points. */
#include "../strict.h"

#include "reference.h"

#include "../scene.h"

static bool load_triangle(const shb_mesh *mesh, const shb_mat4 *transform, uint32_t number,
                          shb_triangle *triangle) {
    uint32_t vertices[3];
    shb_mesh_triangle(mesh, number, vertices);
    for (int k = 0; k < 3; k++) {
        const shb_vec3 world = mat4_transform_point(transform, shb_mesh_point(mesh, vertices[k]));
        if (!vec3_is_finite(world))
            return false;
        triangle->corners[k][0] = world.x;
        triangle->corners[k][1] = world.y;
        triangle->corners[k][2] = world.z;
    }
    return true;
}

/* Writes the triangles that are finite; returns their number. */
static uint32_t load_triangles(const shb_scene *scene, shb_triangle *triangles) {
    uint32_t loaded = 0, id = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const shb_mesh *mesh = scene->instances[i].mesh;
        const shb_mat4 transform = shb_instance_transform(&scene->instances[i]);
        for (uint32_t number = 0; number < mesh->triangle_count; number++, id++) {
            triangles[loaded].id = id;
            loaded += load_triangle(mesh, &transform, number, &triangles[loaded]);
        }
    }
    return loaded;
}

static bool build_reference(const shb_scene *scene, uint32_t id_count, shb_reference *reference) {
    const shb_context *context = reference->context;
    shb_triangle *triangles = shb_alloc(context, id_count, sizeof *triangles);
    if (!triangles)
        return false;
    const uint32_t count = load_triangles(scene, triangles);
    const bool built = shb_bvh_build(context, triangles, count, id_count, &reference->bvh);
    shb_free(context, triangles);
    if (!built)
        return false;
    if (!shb_edges_build(context, reference->bvh.triangles, count, &reference->edges)) {
        shb_bvh_free(context, &reference->bvh);
        return false;
    }
    return true;
}

static shb_result check_scene(const shb_context *context, const shb_scene *scene) {
    shb_result result = shb_scene_check(context, "shb_reference_create", "scene", scene);
    if (!result)
        result = shb_scene_check_indices(context, "shb_reference_create", scene);
    if (result)
        return result;
    const uint64_t count = shb_scene_triangle_count(scene);
    if (count > SHB_BVH_TRIANGLES_MAX)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_reference_create: scene has %llu triangles, more than %lu",
                        (unsigned long long)count, (unsigned long)SHB_BVH_TRIANGLES_MAX);
    return SHB_OK;
}

shb_result shb_reference_create(shb_context *context, const shb_scene *scene,
                                shb_reference **reference) {
    if (!context)
        return SHB_ERROR_ARGUMENT;
    if (!reference)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_reference_create: reference is NULL");
    const shb_result result = check_scene(context, scene);
    if (result)
        return result;
    const uint32_t id_count = (uint32_t)shb_scene_triangle_count(scene);
    shb_reference *made = shb_alloc(context, 1, sizeof *made);
    if (made)
        *made = (shb_reference){.context = context};
    if (!made || !build_reference(scene, id_count, made)) {
        shb_free(context, made);
        return shb_fail(context, SHB_ERROR_MEMORY,
                        "shb_reference_create: no memory for %lu triangles",
                        (unsigned long)id_count);
    }
    *reference = made;
    return SHB_OK;
}

void shb_reference_destroy(shb_reference *reference) {
    if (!reference)
        return;
    const shb_context *context = reference->context;
    shb_bvh_free(context, &reference->bvh);
    shb_edges_free(context, &reference->edges);
    shb_free(context, reference);
}

/* Rays that one task follows. */
enum { RAYS = 256 };

typedef struct query {
    const shb_reference *reference;
    const shb_light_source *light;
    size_t count;
    const shb_vec3 *points;
    const uint32_t *own_ids;
    uint8_t *occluded;
} query;

static void follow_rays(void *arg, size_t index) {
    const query *q = arg;
    const size_t begin = index * RAYS;
    const size_t end = q->count - begin < RAYS ? q->count : begin + RAYS;
    for (size_t i = begin; i < end; i++) {
        const uint32_t own_id = q->own_ids ? q->own_ids[i] : SHB_ID_NONE;
        shb_ray ray;
        q->occluded[i] = shb_ray_to_light(q->light, q->points[i], &ray) &&
                         shb_bvh_occluded(&q->reference->bvh, &ray, own_id);
    }
}

static bool is_light(const shb_light_source *light) {
    const shb_vec3 p = light->position;
    const bool is_zero = p.x == 0 && p.y == 0 && p.z == 0;
    return vec3_is_finite(p) && (light->w == 1 || (light->w == 0 && !is_zero));
}

shb_result shb_reference_occluded(const shb_reference *reference, const shb_light_source *light,
                                  size_t count, const shb_vec3 *points, const uint32_t *own_ids,
                                  uint8_t *occluded) {
    if (!reference)
        return SHB_ERROR_ARGUMENT;
    const shb_context *context = reference->context;
    if (!light || (count && (!points || !occluded)))
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_reference_occluded: %s is NULL",
                        !light    ? "light"
                        : !points ? "points"
                                  : "occluded");
    if (!is_light(light))
        return shb_fail(context, SHB_ERROR_NUMBER,
                        "shb_reference_occluded: light (%g, %g, %g), w %g is neither a point nor "
                        "a direction",
                        light->position.x, light->position.y, light->position.z, light->w);
    query q = {reference, light, count, points, own_ids, occluded};
    if (count)
        shb_parallel_for(context, follow_rays, &q, (count - 1) / RAYS + 1);
    return SHB_OK;
}
