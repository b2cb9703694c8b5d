#include "strict.h"

#include "tile.h"

#include "kernels/shade.h"
#include "layers.h"

#include <stdatomic.h>

typedef struct tile_job {
    const shb_draw_desc *desc;
    const shb_geometry *geometry;
    const shb_target *target;
    const shb_bins *bins;
    shb_layers *lanes;
    shb_format_store_fn *store;
    atomic_size_t next; /* tile that nobody has begun */
} tile_job;

static void draw_list(const tile_job *job, const shb_layers *layers, size_t tile) {
    const size_t first = tile ? job->bins->ends[tile - 1] : 0, end = job->bins->ends[tile];
    if (first == end)
        return;
    const shb_draw_instance *instance = shb_geometry_instance(job->geometry, job->bins->ids[first]);
    for (size_t i = first; i < end; i++) {
        const uint32_t id = job->bins->ids[i];
        while (!shb_instance_has(instance, id))
            instance++;
        shb_clip_position corners[3];
        shb_shape shape;
        shb_geometry_corners(instance, id, corners);
        if (shb_shape_prepare(job->target, instance, corners, &shape) == SHB_OUTCOME_DRAWN)
            shb_layers_draw(layers, job->target, instance, &shape, id);
    }
}

static void draw_tile(const tile_job *job, shb_layers *layers, size_t tile) {
    const int32_t size = (int32_t)job->bins->tile_size;
    const int32_t left = (int32_t)(tile % job->bins->columns) * size;
    const int32_t top = (int32_t)(tile / job->bins->columns) * size;
    layers->samples = shb_samples_intersect(
        (shb_samples){left, top, left + size - 1, top + size - 1}, job->target->samples);
    shb_layers_clear(layers, job->desc->view->reversed);
    draw_list(job, layers, tile);
    shb_layers_store(layers, job->desc, job->target, job->store);
}

/* A lane owns its layers and takes tile after tile until none is left. */
static void run_lane(void *arg, size_t index) {
    tile_job *job = arg;
    const size_t tiles = (size_t)job->bins->columns * job->bins->rows;
    for (size_t tile; (tile = atomic_fetch_add(&job->next, 1)) < tiles;)
        draw_tile(job, &job->lanes[index], tile);
}

bool shb_tiles_draw(shb_context *context, const shb_draw_desc *desc, const shb_geometry *geometry,
                    const shb_target *target, const shb_bins *bins) {
    tile_job job = {.desc = desc,
                    .geometry = geometry,
                    .target = target,
                    .bins = bins,
                    .store = context->shade_kernels->store};
    const size_t tiles = (size_t)bins->columns * bins->rows;
    const size_t lanes = tiles < context->threads ? tiles : context->threads;
    job.lanes = shb_layers_reserve(context, desc, target, lanes, bins->tile_size, bins->tile_size);
    if (!job.lanes)
        return false;
    atomic_init(&job.next, 0);
    shb_parallel_for(context, run_lane, &job, lanes);
    return true;
}
