#include "strict.h"

#include "chunk.h"

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

static bool is_affine(const shb_mat4 *matrix) {
    const double *m = matrix->m;
    return m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1;
}

/* The vertices first .. first + count - 1 of an instance. */
static void transform_run(chunk_job *job, const shb_draw_instance *instance, uint64_t first,
                          uint64_t count) {
    const shb_mesh *mesh = instance->mesh;
    const size_t stride = mesh->position_stride ? mesh->position_stride / sizeof(float) : 3;
    const shb_transform_job run = {
        .clip_from_mesh = instance->clip_from_mesh.m,
        .positions = mesh->positions + first * stride,
        .stride = stride,
        .count = count,
        .affine = is_affine(&instance->clip_from_mesh),
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
        const uint64_t instance_end = instance->first_vertex + instance->mesh->vertex_count;
        const uint64_t run_end = instance_end < end ? instance_end : end;
        transform_run(job, instance, first - instance->first_vertex, run_end - first);
        first = run_end;
    }
}

static size_t count_chunks(const shb_geometry *geometry) {
    size_t count = 0;
    for (size_t i = 0; i < geometry->instance_count; i++)
        count += ((size_t)geometry->instances[i].mesh->triangle_count + SHB_CHUNK - 1) / SHB_CHUNK;
    return count;
}

static void list_chunks(const shb_geometry *geometry, const shb_vertex *vertices,
                        shb_chunk *chunks) {
    for (size_t i = 0; i < geometry->instance_count; i++) {
        const shb_draw_instance *instance = &geometry->instances[i];
        const shb_mesh *mesh = instance->mesh;
        for (uint32_t first = 0; first < mesh->triangle_count; first += SHB_CHUNK) {
            const uint32_t left = mesh->triangle_count - first;
            *chunks++ = (shb_chunk){.instance = instance,
                                    .vertices = vertices + instance->first_vertex,
                                    .first = first,
                                    .count = left < SHB_CHUNK ? left : SHB_CHUNK};
        }
    }
}

/* Prepares the triangles of a chunk that the kernels leave out. */
static void look_at_coded(const chunk_job *job, const shb_chunk *chunk, struct task_count *counts,
                          shb_coded *coded) {
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t corner[3];
        const uint32_t id = (uint32_t)chunk->instance->first_triangle + chunk->first + i;
        shb_mesh_triangle(chunk->instance->mesh, chunk->first + i, corner);
        const shb_vertex *a = &chunk->vertices[corner[0]], *b = &chunk->vertices[corner[1]];
        const shb_vertex *c = &chunk->vertices[corner[2]];
        const uint64_t any = a->code | b->code | c->code, all = a->code & b->code & c->code;
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

static void look_at_block(void *arg, size_t index) {
    chunk_job *job = arg;
    const size_t first = index * CHUNKS_PER_TASK, left = job->chunk_count - first;
    const size_t end = first + (left < CHUNKS_PER_TASK ? left : CHUNKS_PER_TASK);
    struct task_count counts = {0};
    for (size_t i = first; i < end; i++)
        look_at_coded(job, &job->chunks[i], &counts, job->coded + first * SHB_CHUNK);
    job->counts[index] = counts;
}

/* Fills the list of coded triangles; false: out of memory. */
static bool list_coded(shb_context *context, chunk_job *job, shb_chunks *chunks) {
    const size_t tasks = (job->chunk_count + CHUNKS_PER_TASK - 1) / CHUNKS_PER_TASK;
    shb_buffer *scratch = context->draw_scratch;
    if (!shb_buffer_reserve(context, &scratch[SHB_SCRATCH_CODED], job->chunk_count,
                            SHB_CHUNK * sizeof(shb_coded)) ||
        !shb_buffer_reserve(context, &scratch[SHB_SCRATCH_STATS], tasks, sizeof *job->counts))
        return false;
    job->coded = scratch[SHB_SCRATCH_CODED].data;
    job->counts = scratch[SHB_SCRATCH_STATS].data;
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
    const size_t count = count_chunks(geometry);
    if (!shb_buffer_reserve(context, &scratch[SHB_SCRATCH_VERTICES], geometry->vertex_count,
                            sizeof(shb_vertex)) ||
        !shb_buffer_reserve(context, &scratch[SHB_SCRATCH_CHUNKS], count, sizeof(shb_chunk)))
        return false;
    chunk_job job = {.kernels = context->kernels,
                     .geometry = geometry,
                     .target = target,
                     .vertices = scratch[SHB_SCRATCH_VERTICES].data,
                     .chunks = scratch[SHB_SCRATCH_CHUNKS].data,
                     .chunk_count = count};
    atomic_init(&job.any_coded, false);
    const uint64_t blocks = (geometry->vertex_count + VERTICES_PER_TASK - 1) / VERTICES_PER_TASK;
    shb_parallel_for(context, transform_block, &job, blocks);
    list_chunks(geometry, job.vertices, scratch[SHB_SCRATCH_CHUNKS].data);
    *chunks = (shb_chunks){.chunks = job.chunks, .count = count};
    return !atomic_load(&job.any_coded) || list_coded(context, &job, chunks);
}
