#include "strict.h"

#include "bin.h"

#include "scratch.h"
#include "starts.h"

#include <string.h>

#define TRIANGLES_PER_TASK 4096

/* Tiles that a triangle's box touches, both ends included; at most 16384 / 16 a side. */
typedef struct tile_range {
    uint16_t first_column, first_row, last_column, last_row;
} tile_range;

static const tile_range no_tiles = {1, 1, 0, 0};

typedef struct bin_job {
    const shb_geometry *geometry;
    const shb_target *target;
    uint32_t tile_size;
    tile_range *ranges;          /* one a triangle */
    shb_draw_stats *block_stats; /* one a task */
} bin_job;

static tile_range range_of(const bin_job *job, const shb_shape *shape) {
    const shb_samples seen = shb_samples_intersect(shape->samples, job->target->samples);
    return (tile_range){(uint16_t)((uint32_t)seen.first_column / job->tile_size),
                        (uint16_t)((uint32_t)seen.first_row / job->tile_size),
                        (uint16_t)((uint32_t)seen.last_column / job->tile_size),
                        (uint16_t)((uint32_t)seen.last_row / job->tile_size)};
}

static tile_range prepare_triangle(const bin_job *job, const shb_draw_instance *instance,
                                   uint64_t id, shb_draw_stats *stats) {
    shb_clip_position corners[3];
    shb_shape shape;
    shb_geometry_corners(instance, id, corners);
    const shb_outcome outcome = shb_shape_prepare(job->target, instance, corners, &shape);
    stats->not_finite += outcome == SHB_OUTCOME_NOT_FINITE;
    stats->culled += outcome == SHB_OUTCOME_CULLED;
    if (outcome != SHB_OUTCOME_DRAWN)
        return no_tiles;
    stats->drawn++;
    stats->clipped += shape.is_cut;
    return range_of(job, &shape);
}

static void prepare_block(void *arg, size_t index) {
    const bin_job *job = arg;
    const uint64_t first = (uint64_t)index * TRIANGLES_PER_TASK;
    const uint64_t left = job->geometry->triangle_count - first;
    const uint64_t end = first + (left < TRIANGLES_PER_TASK ? left : TRIANGLES_PER_TASK);
    const shb_draw_instance *instance = shb_geometry_instance(job->geometry, first);
    shb_draw_stats stats = {.triangles = end - first};
    for (uint64_t id = first; id < end; id++) {
        while (!shb_instance_has(instance, id))
            instance++;
        job->ranges[id] = prepare_triangle(job, instance, id, &stats);
    }
    job->block_stats[index] = stats;
}

static void sum_stats(const shb_draw_stats *blocks, uint64_t count, shb_draw_stats *sum) {
    *sum = (shb_draw_stats){0};
    for (uint64_t i = 0; i < count; i++) {
        sum->triangles += blocks[i].triangles;
        sum->not_finite += blocks[i].not_finite;
        sum->culled += blocks[i].culled;
        sum->clipped += blocks[i].clipped;
        sum->drawn += blocks[i].drawn;
    }
}

/* The length of every list, then the start of every list in its place. Returns the sum. */
static size_t find_starts(const bin_job *job, const shb_bins *bins, size_t *starts) {
    const size_t tiles = (size_t)bins->columns * bins->rows;
    memset(starts, 0, tiles * sizeof *starts);
    for (uint64_t id = 0; id < job->geometry->triangle_count; id++) {
        const tile_range range = job->ranges[id];
        for (uint32_t row = range.first_row; row <= range.last_row; row++)
            for (uint32_t column = range.first_column; column <= range.last_column; column++)
                starts[(size_t)row * bins->columns + column]++;
    }
    return shb_starts_of_lengths(tiles, starts);
}

/* Every id moves its tiles' cursors on, which end up at the ends of the lists. */
static void fill_lists(const bin_job *job, const shb_bins *bins, size_t *cursors, uint32_t *ids) {
    for (uint64_t id = 0; id < job->geometry->triangle_count; id++) {
        const tile_range range = job->ranges[id];
        for (uint32_t row = range.first_row; row <= range.last_row; row++)
            for (uint32_t column = range.first_column; column <= range.last_column; column++)
                ids[cursors[(size_t)row * bins->columns + column]++] = (uint32_t)id;
    }
}

bool shb_bin_triangles(shb_context *context, const shb_geometry *geometry, const shb_target *target,
                       uint32_t tile_size, shb_bins *bins, shb_draw_stats *stats) {
    shb_buffer *scratch = context->draw_scratch;
    bins->tile_size = tile_size;
    bins->columns = ((uint32_t)target->samples.last_column + tile_size) / tile_size;
    bins->rows = ((uint32_t)target->samples.last_row + tile_size) / tile_size;
    const uint64_t count = geometry->triangle_count;
    const uint64_t blocks = (count + TRIANGLES_PER_TASK - 1) / TRIANGLES_PER_TASK;
    tile_range *ranges =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_RANGES], count, sizeof *ranges);
    shb_draw_stats *block_stats =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_STATS], blocks, sizeof *block_stats);
    size_t *ends = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_ENDS],
                                      (size_t)bins->columns * bins->rows, sizeof *ends);
    if (!ranges || !block_stats || !ends)
        return false;
    bin_job job = {geometry, target, tile_size, ranges, block_stats};
    shb_parallel_for(context, prepare_block, &job, blocks);
    sum_stats(job.block_stats, blocks, stats);
    const size_t entries = find_starts(&job, bins, ends);
    uint32_t *ids = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_IDS], entries, sizeof *ids);
    if (!ids)
        return false;
    fill_lists(&job, bins, ends, ids);
    bins->ends = ends;
    bins->ids = ids;
    return true;
}
