#include "strict.h"

#include "chunk_bin.h"

#include "scratch.h"

#include <string.h>

typedef struct bin_job {
    const shb_kernels *kernels;
    const shb_chunks *chunks;
    const shb_target *target;
    shb_tile_shape shape;
    uint32_t columns;
    size_t tiles;
    uint16_t *ends;
    shb_binned *binned;
    uint32_t *drawn; /* one a block */
} bin_job;

/* The tile ranges of a block's triangles. */
typedef struct block_ranges {
    size_t chunk_count;
    shb_chunk_ranges chunks[SHB_BLOCK_CHUNKS];
} block_ranges;

static void find_ranges(const bin_job *job, size_t block, block_ranges *ranges) {
    const size_t first = block * SHB_BLOCK_CHUNKS, left = job->chunks->plain_count - first;
    ranges->chunk_count = left < SHB_BLOCK_CHUNKS ? left : SHB_BLOCK_CHUNKS;
    for (size_t i = 0; i < ranges->chunk_count; i++)
        job->kernels->find_tiles(&job->chunks->chunks[first + i], &job->target->samples, job->shape,
                                 &ranges->chunks[i]);
}

/* The triangles of the block, and how often they touch a tile. */
static uint64_t count_touches(const block_ranges *ranges, uint32_t *drawn) {
    uint64_t touches = 0;
    *drawn = 0;
    for (size_t i = 0; i < ranges->chunk_count; i++) {
        const shb_chunk_ranges *chunk = &ranges->chunks[i];
        for (uint32_t k = 0; k < chunk->count; k++)
            touches += (1u + chunk->last_column[k] - chunk->first_column[k]) *
                       (1u + chunk->last_row[k] - chunk->first_row[k]);
        *drawn += chunk->count;
    }
    return touches;
}

static void count_tiles(const bin_job *job, const block_ranges *ranges, uint16_t *counts) {
    for (size_t i = 0; i < ranges->chunk_count; i++) {
        const shb_chunk_ranges *chunk = &ranges->chunks[i];
        for (uint32_t k = 0; k < chunk->count; k++)
            for (size_t row = chunk->first_row[k]; row <= chunk->last_row[k]; row++)
                for (size_t column = chunk->first_column[k]; column <= chunk->last_column[k];
                     column++)
                    counts[row * job->columns + column]++;
    }
}

/* Every triangle moves its tiles' cursors on, which end up at the ends of the parts. */
static void fill(const bin_job *job, const block_ranges *ranges, uint16_t *cursors,
                 shb_binned *binned) {
    for (size_t i = 0; i < ranges->chunk_count; i++) {
        const shb_chunk_ranges *chunk = &ranges->chunks[i];
        for (uint32_t k = 0; k < chunk->count; k++)
            for (size_t row = chunk->first_row[k]; row <= chunk->last_row[k]; row++)
                for (size_t column = chunk->first_column[k]; column <= chunk->last_column[k];
                     column++)
                    binned[cursors[row * job->columns + column]++] =
                        (shb_binned)(i * SHB_CHUNK + chunk->triangle[k]);
    }
}

static void bin_block(void *arg, size_t index) {
    const bin_job *job = arg;
    uint16_t *ends = job->ends + index * (job->tiles + 1);
    block_ranges ranges;
    find_ranges(job, index, &ranges);
    const bool sorted = count_touches(&ranges, &job->drawn[index]) <= SHB_BLOCK_CAPACITY;
    ends[job->tiles] = sorted;
    if (!sorted)
        return;
    memset(ends, 0, job->tiles * sizeof *ends);
    count_tiles(job, &ranges, ends);
    uint16_t sum = 0;
    for (size_t tile = 0; tile < job->tiles; tile++) {
        const uint16_t count = ends[tile];
        ends[tile] = sum;
        sum = (uint16_t)(sum + count);
    }
    fill(job, &ranges, ends, job->binned + index * SHB_BLOCK_CAPACITY);
}

bool shb_chunks_bin(shb_context *context, const shb_target *target, const shb_chunks *chunks,
                    shb_tile_shape shape, shb_chunk_bins *bins) {
    const size_t blocks = (chunks->plain_count + SHB_BLOCK_CHUNKS - 1) / SHB_BLOCK_CHUNKS;
    bins->columns = ((uint32_t)target->samples.last_column >> shape.column_bits) + 1;
    bins->rows = ((uint32_t)target->samples.last_row >> shape.row_bits) + 1;
    const size_t tiles = (size_t)bins->columns * bins->rows;
    shb_buffer *scratch = context->draw_scratch;
    uint16_t *ends =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_BINS], blocks, (tiles + 1) * sizeof *ends);
    shb_binned *binned = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_BINNED], blocks,
                                            SHB_BLOCK_CAPACITY * sizeof *binned);
    uint32_t *drawn =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_STATS], blocks, sizeof *drawn);
    if (!ends || !binned || !drawn)
        return false;
    bin_job job = {.kernels = context->kernels,
                   .chunks = chunks,
                   .target = target,
                   .shape = shape,
                   .columns = bins->columns,
                   .tiles = tiles,
                   .ends = ends,
                   .binned = binned,
                   .drawn = drawn};
    shb_parallel_for(context, bin_block, &job, blocks);
    bins->blocks = blocks;
    bins->ends = job.ends;
    bins->binned = job.binned;
    bins->drawn = 0;
    for (size_t i = 0; i < blocks; i++)
        bins->drawn += job.drawn[i];
    return true;
}
