/* The planes of triangles, from their corners in world units and the slope formula of
 * light_point.h: differences of corners lose nothing far from the origin, and triangles that reach
 * behind the light need no clipping. */
#include "strict.h"

#include "occluder_planes.h"

#include "kernels/shade.h"
#include "scene.h"

#include <string.h>

#define TRIANGLES_PER_TASK 4096

bool shb_placed_scene_make(shb_context *context, const shb_scene *scene, shb_placed_scene *placed) {
    shb_buffer *buffer = &context->occluder_scratch[SHB_OCCLUDER_INSTANCES];
    if (!shb_buffer_reserve(context, buffer, scene->instance_count, sizeof *placed->instances))
        return false;
    *placed = (shb_placed_scene){buffer->data, scene->instance_count};
    const shb_mat4 still = shb_mat4_identity();
    size_t first = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const shb_mesh *mesh = scene->instances[i].mesh;
        const shb_mat4 transform = shb_instance_transform(&scene->instances[i]);
        placed->instances[i] =
            (shb_placed_instance){.mesh = mesh,
                                  .first = first,
                                  .moves = memcmp(&transform, &still, sizeof still) != 0,
                                  .transform = transform};
        first += mesh->triangle_count;
    }
    return true;
}

static bool has_triangle(const shb_placed_instance *instance, size_t id) {
    return id >= instance->first && id - instance->first < instance->mesh->triangle_count;
}

/* The instance of a triangle. */
static const shb_placed_instance *instance_of(const shb_placed_scene *placed, size_t id) {
    size_t low = 0, high = placed->count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        *(placed->instances[middle].first <= id ? &low : &high) = middle;
    }
    return &placed->instances[low];
}

static void write_corners(const shb_placed_instance *instance, size_t id, size_t lane,
                          shb_plane_corners *corners) {
    uint32_t vertices[3];
    shb_mesh_triangle(instance->mesh, (uint32_t)(id - instance->first), vertices);
    for (int k = 0; k < 3; k++) {
        const float *p = shb_mesh_position(instance->mesh, vertices[k]);
        shb_vec3 corner = {(double)p[0], (double)p[1], (double)p[2]};
        if (instance->moves)
            corner = shb_mat4_transform_point(instance->transform, corner);
        corners->at[k][0][lane] = corner.x;
        corners->at[k][1][lane] = corner.y;
        corners->at[k][2][lane] = corner.z;
    }
}

void shb_occluder_planes_find(const shb_map *map, const shb_placed_scene *placed,
                              const uint32_t *ids, size_t first, size_t count,
                              shb_occluder_plane *planes) {
    const shb_shade_kernels *kernels = map->context->shade_kernels;
    const shb_placed_instance *instance = placed->instances;
    shb_plane_corners corners = {0};
    for (size_t i = 0, lanes; i < count; i += lanes) {
        lanes = count - i < SHB_PLANE_LANES ? count - i : SHB_PLANE_LANES;
        for (size_t lane = 0; lane < lanes; lane++) {
            const size_t id = ids ? ids[i + lane] : first + i + lane;
            if (!has_triangle(instance, id))
                instance = instance_of(placed, id);
            write_corners(instance, id, lane, &corners);
        }
        kernels->find_planes(map, lanes, &corners, planes + i);
    }
}

static void find_drawn(const shb_plane_finder *finder, size_t count, const uint32_t *ids,
                       shb_occluder_plane *planes) {
    const shb_drawn_planes *drawn = (const shb_drawn_planes *)finder;
    shb_occluder_planes_find(drawn->map, &drawn->placed, ids, 0, count, planes);
}

bool shb_drawn_planes_make(const shb_map *map, const shb_scene *scene, shb_occluder_data *made) {
    made->drawn = (shb_drawn_planes){.finder = {find_drawn, made->slope_unit}, .map = map};
    made->drawn_bytes = scene->instance_count * sizeof(shb_placed_instance);
    return shb_placed_scene_make(map->context, scene, &made->drawn.placed);
}

typedef struct plane_job {
    const shb_map *map;
    const shb_placed_scene *placed;
    size_t count;
    shb_occluder_plane *planes;
} plane_job;

static void make_block(void *arg, size_t index) {
    const plane_job *job = arg;
    const size_t first = index * TRIANGLES_PER_TASK, left = job->count - first;
    const size_t count = left < TRIANGLES_PER_TASK ? left : TRIANGLES_PER_TASK;
    shb_occluder_planes_find(job->map, job->placed, NULL, first, count, job->planes + first);
}

void shb_occluder_planes_make(const shb_map *map, const shb_placed_scene *placed, size_t count,
                              shb_occluder_plane *planes) {
    plane_job job = {map, placed, count, planes};
    shb_parallel_for(map->context, make_block, &job,
                     (count + TRIANGLES_PER_TASK - 1) / TRIANGLES_PER_TASK);
}
