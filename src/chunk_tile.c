#include "strict.h"

#include "chunk_tile.h"

#include "format.h"
#include "layers.h"
#include "scratch.h"

#include <stdatomic.h>
#include <string.h>

#define CHUNKS_PER_TASK 32

/* Depths of a tile of this size, with ids, fit into a second-level cache. */
#define TILE_SIZE 256

/* Up to this many texels one thread draws straight through: the map itself stays in a cache. */
#define SINGLE_TILE_TEXELS (2048u * 2048u)

typedef struct grid {
    uint32_t width, height; /* of a tile */
    uint32_t columns, rows;
    bool direct; /* tiles are drawn in the images themselves */
} grid;

typedef struct tile_job {
    const shb_kernels *kernels;
    const shb_draw_desc *desc;
    const shb_geometry *geometry;
    const shb_target *target;
    const shb_chunks *chunks;
    grid tiles;
    shb_chunk_summary *summaries;
    const uint64_t *ends; /* the list of tile t starts where that of tile t - 1 ends */
    const uint32_t *list; /* numbers of chunks */
    shb_layers *lanes;    /* NULL when tiles are drawn directly */
    atomic_size_t next;   /* tile that nobody has begun */
    uint64_t drawn;       /* by a single tile */
} tile_job;

static bool is_direct_depth(const shb_depth_image *image) {
    return image->format == SHB_FORMAT_FLOAT32;
}

/* Kernels work on whole vectors inside of a tile and on one pitch for all layers. */
static bool can_draw_directly(const shb_draw_desc *desc) {
    const size_t row = (size_t)desc->width * 4;
    const size_t stride = desc->depth.stride ? desc->depth.stride : row;
    const size_t second_stride = desc->second.stride ? desc->second.stride : row;
    const size_t id_stride = desc->id_stride ? desc->id_stride : row;
    return desc->width % 16 == 0 && desc->depth.texels && is_direct_depth(&desc->depth) &&
           (!desc->second.texels ||
            (is_direct_depth(&desc->second) && second_stride == stride)) &&
           (!desc->ids || id_stride == stride);
}

static grid choose_grid(const shb_context *context, const shb_draw_desc *desc) {
    grid made = {.width = TILE_SIZE, .height = TILE_SIZE, .direct = can_draw_directly(desc)};
    if (desc->tile_size)
        made.width = made.height = desc->tile_size;
    else if (made.direct && context->threads == 1 &&
             desc->width * desc->height <= SINGLE_TILE_TEXELS) {
        made.width = desc->width;
        made.height = desc->height;
    }
    made.columns = (desc->width + made.width - 1) / made.width;
    made.rows = (desc->height + made.height - 1) / made.height;
    return made;
}

static shb_samples tile_samples(const tile_job *job, size_t tile) {
    const grid *tiles = &job->tiles;
    const int32_t left = (int32_t)(tile % tiles->columns * tiles->width);
    const int32_t top = (int32_t)(tile / tiles->columns * tiles->height);
    return shb_samples_intersect((shb_samples){left, top, left + (int32_t)tiles->width - 1,
                                               top + (int32_t)tiles->height - 1},
                                 job->target->samples);
}

static void summarize_block(void *arg, size_t index) {
    const tile_job *job = arg;
    const size_t first = index * CHUNKS_PER_TASK, left = job->chunks->count - first;
    const size_t end = first + (left < CHUNKS_PER_TASK ? left : CHUNKS_PER_TASK);
    for (size_t i = first; i < end; i++)
        job->kernels->summarize(&job->chunks->chunks[i], job->desc->width, job->desc->height,
                                &job->summaries[i]);
}

/* The tiles that a chunk's box touches, cut to the target. */
static shb_samples tiles_of(const tile_job *job, const shb_chunk_summary *summary) {
    const shb_samples box = shb_samples_intersect(
        (shb_samples){summary->x0, summary->y0, summary->x1 - 1, summary->y1 - 1},
        job->target->samples);
    const int32_t width = (int32_t)job->tiles.width, height = (int32_t)job->tiles.height;
    return (shb_samples){box.first_column / width, box.first_row / height,
                         box.last_column / width, box.last_row / height};
}

/* The length of every list, then the start of every list in its place. Returns the sum. */
static uint64_t find_starts(const tile_job *job, uint64_t *starts) {
    const size_t tiles = (size_t)job->tiles.columns * job->tiles.rows;
    memset(starts, 0, tiles * sizeof *starts);
    for (size_t i = 0; i < job->chunks->count; i++) {
        if (job->summaries[i].drawn == 0)
            continue;
        const shb_samples range = tiles_of(job, &job->summaries[i]);
        for (int32_t row = range.first_row; row <= range.last_row; row++)
            for (int32_t column = range.first_column; column <= range.last_column; column++)
                starts[(size_t)row * job->tiles.columns + (size_t)column]++;
    }
    uint64_t sum = 0;
    for (size_t tile = 0; tile < tiles; tile++) {
        const uint64_t length = starts[tile];
        starts[tile] = sum;
        sum += length;
    }
    return sum;
}

/* Every chunk moves its tiles' cursors on, which end up at the ends of the lists. */
static void fill_lists(const tile_job *job, uint64_t *cursors, uint32_t *list) {
    for (size_t i = 0; i < job->chunks->count; i++) {
        if (job->summaries[i].drawn == 0)
            continue;
        const shb_samples range = tiles_of(job, &job->summaries[i]);
        for (int32_t row = range.first_row; row <= range.last_row; row++)
            for (int32_t column = range.first_column; column <= range.last_column; column++)
                list[cursors[(size_t)row * job->tiles.columns + (size_t)column]++] = (uint32_t)i;
    }
}

static bool bin_chunks(shb_context *context, tile_job *job) {
    shb_buffer *scratch = context->draw_scratch;
    const size_t count = job->chunks->count;
    const size_t tiles = (size_t)job->tiles.columns * job->tiles.rows;
    if (!shb_buffer_reserve(context, &scratch[SHB_SCRATCH_SUMMARIES], count,
                            sizeof *job->summaries) ||
        !shb_buffer_reserve(context, &scratch[SHB_SCRATCH_ENDS], tiles, sizeof *job->ends))
        return false;
    job->summaries = scratch[SHB_SCRATCH_SUMMARIES].data;
    shb_parallel_for(context, summarize_block, job, (count + CHUNKS_PER_TASK - 1) / CHUNKS_PER_TASK);
    for (size_t i = 0; i < count; i++)
        job->drawn += job->summaries[i].drawn;
    uint64_t *ends = scratch[SHB_SCRATCH_ENDS].data;
    const uint64_t entries = find_starts(job, ends);
    if (!shb_buffer_reserve(context, &scratch[SHB_SCRATCH_IDS], entries, sizeof *job->list))
        return false;
    fill_lists(job, ends, scratch[SHB_SCRATCH_IDS].data);
    job->ends = ends;
    job->list = scratch[SHB_SCRATCH_IDS].data;
    return true;
}

static void *texel_at(void *texels, size_t stride, const shb_samples *samples) {
    return texels ? (char *)texels + (size_t)samples->first_row * stride +
                        (size_t)samples->first_column * 4
                  : NULL;
}

/* A tile's layers: parts of the images, or the lane's own. */
static shb_layers layers_of(const tile_job *job, size_t lane, shb_samples samples) {
    const shb_draw_desc *desc = job->desc;
    if (!job->tiles.direct) {
        shb_layers layers = job->lanes[lane];
        layers.samples = samples;
        return layers;
    }
    const size_t stride = desc->depth.stride ? desc->depth.stride : (size_t)desc->width * 4;
    return (shb_layers){
        .samples = samples,
        .pitch = stride / 4,
        .nearest = texel_at(desc->depth.texels, stride, &samples),
        .second = texel_at(desc->second.texels, stride, &samples),
        .ids = texel_at(desc->ids, stride, &samples),
    };
}

static void draw_coded(const tile_job *job, const shb_layers *layers) {
    const shb_draw_instance *instance = NULL;
    for (size_t i = 0; i < job->chunks->coded_count; i++) {
        const shb_coded *coded = &job->chunks->coded[i];
        if (shb_samples_are_empty(shb_samples_intersect(coded->samples, layers->samples)))
            continue;
        if (!instance || !shb_instance_has(instance, coded->id))
            instance = shb_geometry_instance(job->geometry, coded->id);
        shb_clip_position corners[3];
        shb_shape shape;
        shb_geometry_corners(instance, coded->id, corners);
        if (shb_shape_prepare(job->target, instance, corners, &shape) == SHB_OUTCOME_DRAWN)
            shb_layers_draw(layers, job->target, &shape, coded->id);
    }
}

static void draw_tile(tile_job *job, size_t lane, size_t tile) {
    const shb_layers layers = layers_of(job, lane, tile_samples(job, tile));
    const shb_samples *samples = &layers.samples;
    const int32_t width = samples->last_column - samples->first_column + 1;
    const shb_tile target = {
        .depth = layers.nearest,
        .second = layers.second,
        .ids = layers.ids,
        .stride = (ptrdiff_t)layers.pitch,
        .x0 = samples->first_column,
        .y0 = samples->first_row,
        .right = samples->last_column + 1,
        .x1 = samples->first_column + (width + 15) / 16 * 16,
        .y1 = samples->last_row + 1,
    };
    shb_layers_clear(&layers, job->desc->view->reversed);
    if (job->ends) {
        for (uint64_t i = tile ? job->ends[tile - 1] : 0; i < job->ends[tile]; i++)
            job->kernels->draw(&job->chunks->chunks[job->list[i]], &target);
    } else {
        for (size_t i = 0; i < job->chunks->count; i++)
            job->drawn += job->kernels->draw(&job->chunks->chunks[i], &target);
    }
    draw_coded(job, &layers);
    shb_layers_store(&layers, job->desc);
}

/* A lane owns its layers and takes tile after tile until none is left. */
static void run_lane(void *arg, size_t index) {
    tile_job *job = arg;
    const size_t tiles = (size_t)job->tiles.columns * job->tiles.rows;
    for (size_t tile; (tile = atomic_fetch_add(&job->next, 1)) < tiles;)
        draw_tile(job, index, tile);
}

static void count_stats(const tile_job *job, shb_draw_stats *stats) {
    *stats = (shb_draw_stats){.triangles = job->geometry->triangle_count,
                              .not_finite = job->chunks->not_finite,
                              .drawn = job->drawn + job->chunks->coded_count};
    for (size_t i = 0; i < job->chunks->coded_count; i++)
        stats->clipped += job->chunks->coded[i].is_cut;
    stats->culled = stats->triangles - stats->not_finite - stats->drawn;
}

bool shb_chunk_tiles_draw(shb_context *context, const shb_draw_desc *desc,
                          const shb_geometry *geometry, const shb_target *target,
                          const shb_chunks *chunks, shb_draw_stats *stats) {
    tile_job job = {.kernels = context->kernels,
                    .desc = desc,
                    .geometry = geometry,
                    .target = target,
                    .chunks = chunks,
                    .tiles = choose_grid(context, desc)};
    const size_t tiles = (size_t)job.tiles.columns * job.tiles.rows;
    const size_t lanes = tiles < context->threads ? tiles : context->threads;
    if (tiles > 1 && !bin_chunks(context, &job))
        return false;
    if (!job.tiles.direct) {
        job.lanes = shb_layers_reserve(context, desc, lanes, (job.tiles.width + 15) / 16 * 16,
                                       job.tiles.height);
        if (!job.lanes)
            return false;
    }
    atomic_init(&job.next, 0);
    shb_parallel_for(context, run_lane, &job, lanes);
    count_stats(&job, stats);
    return true;
}
