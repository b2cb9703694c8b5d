/* The planes of triangles, from their corners in world units and the slope formula of
 * light_point.h: differences of corners lose nothing far from the origin, and triangles that reach
 * behind the light need no clipping. */
#include "strict.h"

#include "occluder_planes.h"

#include "half.h"
#include "kernels/shade.h"
#include "scene.h"

#include <string.h>

#define TRIANGLES_PER_TASK 4096

typedef struct plane_job {
    const shb_map *map;
    const shb_scene *scene;
    size_t count;
    const shb_occluder_scratch *scratch; /* NULL: all planes are wanted */
    shb_occluder_plane *planes;
} plane_job;

/* Triangles whose planes are found at the same time. */
typedef struct plane_chunk {
    shb_plane_corners corners;
    size_t count;
    size_t ids[SHB_PLANE_LANES];
} plane_chunk;

static void find_chunk(const plane_job *job, plane_chunk *chunk) {
    shb_occluder_plane planes[SHB_PLANE_LANES];
    job->map->context->shade_kernels->find_planes(job->map, chunk->count, &chunk->corners, planes);
    const double scale = 1 / job->map->occluders.slope_unit;
    for (size_t i = 0; i < chunk->count; i++) {
        job->planes[chunk->ids[i]] = planes[i];
        if (job->scratch)
            job->scratch->slopes[chunk->ids[i]] = (uint32_t)shb_half_of(planes[i].slope_x * scale) |
                                                  (uint32_t)shb_half_of(planes[i].slope_y * scale)
                                                      << 16;
    }
    chunk->count = 0;
}

/* transform NULL: the mesh is in the world as it is. */
static void add_triangle(const shb_mesh *mesh, const shb_mat4 *transform, uint32_t triangle,
                         plane_chunk *chunk) {
    uint32_t vertices[3];
    shb_mesh_triangle(mesh, triangle, vertices);
    for (int k = 0; k < 3; k++) {
        const float *p = shb_mesh_position(mesh, vertices[k]);
        shb_vec3 corner = {(double)p[0], (double)p[1], (double)p[2]};
        if (transform)
            corner = shb_mat4_transform_point(*transform, corner);
        chunk->corners.at[k][0][chunk->count] = corner.x;
        chunk->corners.at[k][1][chunk->count] = corner.y;
        chunk->corners.at[k][2][chunk->count] = corner.z;
    }
}

static bool is_wanted(const plane_job *job, size_t id) {
    return !job->scratch || atomic_load_explicit(&job->scratch->seen[id], memory_order_relaxed);
}

static void make_block(void *arg, size_t index) {
    const plane_job *job = arg;
    size_t id = index * TRIANGLES_PER_TASK;
    const size_t end = job->count - id < TRIANGLES_PER_TASK ? job->count : id + TRIANGLES_PER_TASK;
    plane_chunk chunk = {.count = 0};
    while (id < end) {
        uint32_t first;
        const shb_instance *instance =
            &job->scene->instances[shb_scene_instance_of(job->scene, (uint32_t)id, &first)];
        const shb_mat4 transform = shb_instance_transform(instance), still = shb_mat4_identity();
        const bool moves = memcmp(&transform, &still, sizeof still) != 0;
        const size_t instance_end = (size_t)first + instance->mesh->triangle_count;
        for (; id < end && id < instance_end; id++) {
            if (!is_wanted(job, id))
                continue;
            add_triangle(instance->mesh, moves ? &transform : NULL, (uint32_t)id - first, &chunk);
            chunk.ids[chunk.count++] = id;
            if (chunk.count == SHB_PLANE_LANES)
                find_chunk(job, &chunk);
        }
    }
    find_chunk(job, &chunk);
}

static void make_planes(plane_job *job) {
    shb_parallel_for(job->map->context, make_block, job,
                     (job->count + TRIANGLES_PER_TASK - 1) / TRIANGLES_PER_TASK);
}

void shb_occluder_planes_make(const shb_map *map, const shb_scene *scene, size_t count,
                              shb_occluder_plane *planes) {
    plane_job job = {map, scene, count, NULL, planes};
    make_planes(&job);
}

bool shb_occluder_scratch_reserve(shb_context *context, size_t count,
                                  shb_occluder_scratch *scratch) {
    shb_buffer *buffers = context->occluder_scratch;
    if (!shb_buffer_reserve(context, &buffers[0], count, sizeof *scratch->planes) ||
        !shb_buffer_reserve(context, &buffers[1], count, sizeof *scratch->slopes) ||
        !shb_buffer_reserve(context, &buffers[2], count, sizeof *scratch->seen))
        return false;
    *scratch = (shb_occluder_scratch){buffers[0].data, buffers[1].data, buffers[2].data};
    return true;
}

void shb_occluder_planes_make_seen(const shb_map *map, const shb_scene *scene, size_t count,
                                   const shb_occluder_scratch *scratch) {
    plane_job job = {map, scene, count, scratch, scratch->planes};
    make_planes(&job);
}
