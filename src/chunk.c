#include "strict.h"

#include "chunk.h"

#include "cluster_list.h"
#include "scene.h"
#include "scratch.h"

#include <stdatomic.h>
#include <string.h>

#define VERTICES_PER_TASK 4096
#define CHUNKS_PER_TASK 32

typedef struct chunk_job {
    const shb_kernels *kernels;
    const shb_geometry *geometry;
    const shb_target *target;
    shb_vertex *vertices;
    atomic_bool any_coded; /* some vertex is not usable */
    const shb_chunk *chunks;
    size_t chunk_count;
    shb_coded *coded; /* SHB_CHUNK for each chunk, filled from the front of each task's part */
    struct task_count {
        size_t coded;
        uint64_t not_finite;
    } * counts; /* one a task */
} chunk_job;

/* The vertices first .. first + count - 1 of an instance. */
static void transform_run(chunk_job *job, const shb_draw_instance *instance, uint64_t first,
                          uint64_t count) {
    const shb_mesh *mesh = instance->mesh;
    const size_t stride = mesh->position_stride ? mesh->position_stride / sizeof(float) : 3;
    const float *positions = mesh->positions + first * stride;
    const shb_transform_job run = {
        .clip_from_mesh = instance->clip_from_mesh.m,
        .positions = {positions, positions + 1, positions + 2},
        .stride = stride,
        .count = count,
        .affine = instance->affine,
        .half_width = job->target->half_width,
        .half_height = job->target->half_height,
        .volume = &job->target->volume,
        .vertices = job->vertices + instance->first_vertex + first,
    };
    if (job->kernels->transform(&run))
        atomic_store_explicit(&job->any_coded, true, memory_order_relaxed);
}

static void transform_block(void *arg, size_t index) {
    chunk_job *job = arg;
    uint64_t first = (uint64_t)index * VERTICES_PER_TASK;
    const uint64_t left = job->geometry->vertex_count - first;
    const uint64_t end = first + (left < VERTICES_PER_TASK ? left : VERTICES_PER_TASK);
    const shb_draw_instance *instance = shb_geometry_instance_of_vertex(job->geometry, first);
    for (; first < end; instance++) {
        const uint64_t instance_end = instance->first_vertex + shb_instance_vertices(instance);
        const uint64_t run_end = instance_end < end ? instance_end : end;
        transform_run(job, instance, first - instance->first_vertex, run_end - first);
        first = run_end;
    }
}

static size_t count_chunks(const shb_geometry *geometry) {
    size_t count = 0;
    for (size_t i = 0; i < geometry->instance_count; i++)
        if (!geometry->instances[i].clusters)
            count +=
                ((size_t)geometry->instances[i].mesh->triangle_count + SHB_CHUNK - 1) / SHB_CHUNK;
    return count;
}

static void list_chunks(const shb_geometry *geometry, const shb_vertex *vertices,
                        shb_chunk *chunks) {
    for (size_t i = 0; i < geometry->instance_count; i++) {
        const shb_draw_instance *instance = &geometry->instances[i];
        const shb_mesh *mesh = instance->mesh;
        for (uint32_t first = 0; first < mesh->triangle_count && !instance->clusters;
             first += SHB_CHUNK) {
            const uint32_t left = mesh->triangle_count - first;
            *chunks++ = (shb_chunk){.instance = instance,
                                    .vertices = vertices + instance->first_vertex,
                                    .first = first,
                                    .count = left < SHB_CHUNK ? left : SHB_CHUNK};
        }
    }
}

/* The vertices of a triangle of the chunk, as numbers of those given. */
static void find_corners(const shb_chunk *chunk, uint32_t i, uint32_t corners[3]) {
    if (chunk->vertices)
        shb_mesh_triangle(chunk->instance->mesh, chunk->first + i, corners);
    else
        for (uint32_t k = 0; k < 3; k++)
            corners[k] = chunk->cluster.corners[shb_corner_place(i, k)];
}

/* Prepares the triangles of a chunk that the kernels leave out. */
static void look_at_coded(const chunk_job *job, const shb_chunk *chunk, const shb_vertex *vertices,
                          struct task_count *counts, shb_coded *coded) {
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t corner[3];
        const uint32_t id = (uint32_t)chunk->instance->first_triangle +
                            (chunk->triangles ? chunk->triangles[i] : chunk->first + i);
        find_corners(chunk, i, corner);
        const shb_vertex *a = &vertices[corner[0]], *b = &vertices[corner[1]];
        const shb_vertex *c = &vertices[corner[2]];
        const uint32_t code[3] = {shb_vertex_code(a), shb_vertex_code(b), shb_vertex_code(c)};
        const uint32_t any = code[0] | code[1] | code[2], all = code[0] & code[1] & code[2];
        if (any & SHB_CODE_NOT_FINITE) {
            counts->not_finite++;
            continue;
        }
        if (!(any & SHB_CODE_UNUSABLE) || (all & SHB_CODE_OUTSIDE))
            continue;
        shb_clip_position corners[3];
        shb_shape shape;
        shb_geometry_corners(chunk->instance, id, corners);
        if (shb_shape_prepare(job->target, chunk->instance, corners, &shape) == SHB_OUTCOME_DRAWN)
            coded[counts->coded++] = (shb_coded){id, shape.is_cut, shape.samples};
    }
}

/* A cluster's vertices are transformed for the purpose, and once more by those who draw it. */
static void look_at_cluster(const chunk_job *job, const shb_chunk *chunk, struct task_count *counts,
                            shb_coded *coded) {
    shb_vertex vertices[SHB_CLUSTER_VERTICES];
    const shb_transform_job run = shb_cluster_job(chunk, vertices);
    if (job->kernels->transform(&run))
        look_at_coded(job, chunk, vertices, counts, coded);
}

static void look_at_block(void *arg, size_t index) {
    chunk_job *job = arg;
    const size_t first = index * CHUNKS_PER_TASK, left = job->chunk_count - first;
    const size_t end = first + (left < CHUNKS_PER_TASK ? left : CHUNKS_PER_TASK);
    struct task_count counts = {0};
    for (size_t i = first; i < end; i++) {
        const shb_chunk *chunk = &job->chunks[i];
        if (chunk->vertices)
            look_at_coded(job, chunk, chunk->vertices, &counts, job->coded + first * SHB_CHUNK);
        else if (chunk->cluster.may_be_coded)
            look_at_cluster(job, chunk, &counts, job->coded + first * SHB_CHUNK);
    }
    job->counts[index] = counts;
}

/* Fills the list of coded triangles; false: out of memory. */
static bool list_coded(shb_context *context, chunk_job *job, shb_chunks *chunks) {
    const size_t tasks = (job->chunk_count + CHUNKS_PER_TASK - 1) / CHUNKS_PER_TASK;
    shb_buffer *scratch = context->draw_scratch;
    job->coded = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_CODED], job->chunk_count,
                                    SHB_CHUNK * sizeof *job->coded);
    job->counts =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_STATS], tasks, sizeof *job->counts);
    if (!job->coded || !job->counts)
        return false;
    shb_parallel_for(context, look_at_block, job, tasks);
    for (size_t i = 0; i < tasks; i++) {
        memmove(job->coded + chunks->coded_count, job->coded + i * CHUNKS_PER_TASK * SHB_CHUNK,
                job->counts[i].coded * sizeof(shb_coded));
        chunks->coded_count += job->counts[i].coded;
        chunks->not_finite += job->counts[i].not_finite;
    }
    chunks->coded = job->coded;
    return true;
}

bool shb_chunks_prepare(shb_context *context, const shb_geometry *geometry,
                        const shb_target *target, shb_chunks *chunks) {
    shb_buffer *scratch = context->draw_scratch;
    const size_t plain = count_chunks(geometry);
    shb_vertex *vertices = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_VERTICES],
                                              geometry->vertex_count, sizeof *vertices);
    shb_chunk *listed = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_CHUNKS],
                                           plain + geometry->cluster_count, sizeof *listed);
    if (!vertices || !listed)
        return false;
    chunk_job job = {.kernels = context->kernels,
                     .geometry = geometry,
                     .target = target,
                     .vertices = vertices,
                     .chunks = listed};
    atomic_init(&job.any_coded, false);
    const uint64_t blocks = (geometry->vertex_count + VERTICES_PER_TASK - 1) / VERTICES_PER_TASK;
    shb_parallel_for(context, transform_block, &job, blocks);
    list_chunks(geometry, job.vertices, listed);
    bool doubtful = false;
    size_t seen;
    if (!shb_clusters_list(context, geometry, target, listed + plain, &seen, &doubtful))
        return false;
    job.chunk_count = plain + seen;
    *chunks = (shb_chunks){.chunks = job.chunks, .count = job.chunk_count, .plain_count = plain};
    return !(doubtful || atomic_load(&job.any_coded)) || list_coded(context, &job, chunks);
}
