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
    placed->count = scene->instance_count;
    placed->instances =
        shb_buffer_reserve(context, &context->occluder_scratch[SHB_OCCLUDER_INSTANCES],
                           placed->count, sizeof *placed->instances);
    if (!placed->instances)
        return false;
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

/* The instance of a triangle. */
static const shb_placed_instance *instance_of(const shb_placed_scene *placed, size_t id) {
    size_t low = 0, high = placed->count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        *(placed->instances[middle].first <= id ? &low : &high) = middle;
    }
    return &placed->instances[low];
}

static void fill_lanes(size_t count, shb_plane_corners *corners) {
    for (size_t lane = count; lane % SHB_PLANE_VECTOR; lane++)
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                corners->at[k][axis][lane] = corners->at[k][axis][count - 1];
}

static void find_drawn(const shb_plane_finder *finder, const shb_draw_instance *instance,
                       size_t count, shb_plane_corners *corners, shb_found_planes *planes) {
    const shb_map *map = ((const shb_drawn_planes *)finder)->map;
    fill_lanes(count, corners);
    map->context->shade_kernels->find_planes(
        map, instance->moves ? &instance->world_from_mesh : NULL, count, corners, planes);
}

shb_drawn_planes shb_drawn_planes_of(const shb_map *map) {
    return (shb_drawn_planes){{find_drawn, map->occluders.slope_unit}, map};
}

/* Planes of the instance's triangles from id on. */
static void find_run(const shb_map *map, const shb_placed_instance *instance, size_t id,
                     size_t count, shb_occluder_plane *planes, shb_world_plane *world_planes) {
    shb_plane_corners corners = {0};
    shb_found_planes found;
    shb_found_world_planes world;
    for (size_t i = 0; i < count; i++)
        shb_plane_corners_set(&corners, i, instance->mesh, (uint32_t)(id + i - instance->first));
    fill_lanes(count, &corners);
    map->context->shade_kernels->find_world_planes(
        map, instance->moves ? &instance->transform : NULL, count, &corners, &found, &world);
    for (size_t i = 0; i < count; i++) {
        planes[i] =
            (shb_occluder_plane){found.z[i], found.slope_x[i], found.slope_y[i], found.error[i]};
        world_planes[i] = (shb_world_plane){
            {world.normal[0][i], world.normal[1][i], world.normal[2][i]}, world.offset[i]};
    }
}

typedef struct plane_job {
    const shb_map *map;
    const shb_placed_scene *placed;
    size_t count;
    shb_occluder_plane *planes;
    shb_world_plane *world_planes;
} plane_job;

static void make_block(void *arg, size_t index) {
    const plane_job *job = arg;
    const size_t first = index * TRIANGLES_PER_TASK, left = job->count - first;
    const size_t end = first + (left < TRIANGLES_PER_TASK ? left : TRIANGLES_PER_TASK);
    for (size_t id = first, run; id < end; id += run) {
        const shb_placed_instance *instance = instance_of(job->placed, id);
        const size_t last = instance->first + instance->mesh->triangle_count;
        run = (last < end ? last : end) - id;
        run = run < SHB_PLANE_LANES ? run : SHB_PLANE_LANES;
        find_run(job->map, instance, id, run, job->planes + id, job->world_planes + id);
    }
}

void shb_occluder_planes_make(const shb_map *map, const shb_placed_scene *placed, size_t count,
                              shb_occluder_plane *planes, shb_world_plane *world_planes) {
    plane_job job = {map, placed, count, planes, world_planes};
    shb_parallel_for(map->context, make_block, &job,
                     (count + TRIANGLES_PER_TASK - 1) / TRIANGLES_PER_TASK);
}
