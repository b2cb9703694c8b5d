#include "strict.h"

#include "cluster_list.h"

#include "cluster_cull.h"
#include "cluster_sort.h"
#include "scratch.h"

#include <string.h>

#define CLUSTERS_PER_TASK 256

typedef struct list_job {
    const shb_geometry *geometry;
    const shb_target *target;
    const shb_cluster_view *views; /* one an instance */
    shb_chunk *chunks;
    struct task_seen {
        size_t count;
        bool doubtful;
    } * seen; /* one a task */
} list_job;

static shb_chunk chunk_of(const shb_draw_instance *instance, const shb_cluster *cluster,
                          const shb_seen_cluster *seen) {
    const shb_clusters *clusters = instance->clusters;
    shb_chunk chunk = {.instance = instance,
                       .triangles = clusters->triangles + cluster->first_triangle,
                       .count = cluster->triangle_count,
                       .cluster = *seen};
    chunk.cluster.positions = clusters->positions + 3 * cluster->first_vertex;
    chunk.cluster.corners = clusters->corners + cluster->first_corner;
    chunk.cluster.vertex_count = cluster->vertex_count;
    chunk.cluster.places = (uint32_t)shb_cluster_places(cluster->vertex_count);
    return chunk;
}

/* Lists what is seen of a run of the instance's clusters. */
static void list_run(const list_job *job, const shb_draw_instance *instance, uint64_t first,
                     uint64_t count, shb_chunk *chunks, struct task_seen *seen) {
    const shb_cluster_view *view = &job->views[instance - job->geometry->instances];
    const shb_cluster *clusters = instance->clusters->clusters + first;
    for (uint64_t i = 0; i < count; i++) {
        shb_seen_cluster looked = {.target = job->target};
        const shb_cluster_fate fate = shb_cluster_look(view, &clusters[i], &looked);
        if (fate == SHB_CLUSTER_DROPPED)
            continue;
        looked.may_be_coded = fate == SHB_CLUSTER_DOUBTFUL;
        chunks[seen->count++] = chunk_of(instance, &clusters[i], &looked);
        seen->doubtful |= fate == SHB_CLUSTER_DOUBTFUL;
    }
}

static void list_block(void *arg, size_t index) {
    const list_job *job = arg;
    uint64_t first = (uint64_t)index * CLUSTERS_PER_TASK;
    shb_chunk *chunks = job->chunks + first;
    const uint64_t left = job->geometry->cluster_count - first;
    const uint64_t end = first + (left < CLUSTERS_PER_TASK ? left : CLUSTERS_PER_TASK);
    const shb_draw_instance *instance = shb_geometry_instance_of_cluster(job->geometry, first);
    struct task_seen seen = {0};
    for (; first < end; instance++) {
        if (!instance->clusters)
            continue;
        const uint64_t instance_end = instance->first_cluster + instance->clusters->count;
        const uint64_t run_end = instance_end < end ? instance_end : end;
        list_run(job, instance, first - instance->first_cluster, run_end - first, chunks, &seen);
        first = run_end;
    }
    job->seen[index] = seen;
}

bool shb_clusters_list(shb_context *context, const shb_geometry *geometry, const shb_target *target,
                       shb_chunk *chunks, size_t *count, bool *doubtful) {
    *count = 0;
    if (geometry->cluster_count == 0)
        return true;
    const size_t tasks =
        (size_t)((geometry->cluster_count + CLUSTERS_PER_TASK - 1) / CLUSTERS_PER_TASK);
    shb_buffer *scratch = context->draw_scratch;
    shb_cluster_view *views = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_VIEWS],
                                                 geometry->instance_count, sizeof *views);
    struct task_seen *seen =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_SEEN], tasks, sizeof *seen);
    if (!views || !seen)
        return false;
    for (size_t i = 0; i < geometry->instance_count; i++)
        if (geometry->instances[i].clusters)
            views[i] = shb_cluster_view_of(&geometry->instances[i], target);
    list_job job = {geometry, target, views, chunks, seen};
    shb_parallel_for(context, list_block, &job, tasks);
    for (size_t i = 0; i < tasks; i++) {
        memmove(chunks + *count, chunks + i * CLUSTERS_PER_TASK,
                job.seen[i].count * sizeof *chunks);
        *count += job.seen[i].count;
        *doubtful |= job.seen[i].doubtful;
    }
    return shb_clusters_sort(context, target, *count, chunks);
}
