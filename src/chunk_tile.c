#include "strict.h"

#include "chunk_tile.h"

#include "chunk_bin.h"
#include "chunk_whole.h"

#include <stdatomic.h>

/* Depths of a tile of this size, with ids, fit into a second-level cache. */
#define TILE_BITS 8

/* More tiles than this cost more than they save. */
#define TILES_MAX 4096

/* Up to this many texels in all layers one thread draws straight through: they stay in a cache. So
 * do threads for as large a target where there is a triangle for every few texels. */
#define WHOLE_TEXELS (2048u * 2048u)
#define WHOLE_TEXELS_PER_TRIANGLE 4

/* But not a few large triangles one over the other: they would go through the whole map each. */
#define FEW_TRIANGLES 1024
#define FEW_TRIANGLES_TEXELS (512u * 512u)

typedef struct grid {
    bool whole;    /* the target is not cut into tiles */
    bool direct;   /* tiles are drawn in the images themselves */
    int tile_bits; /* tiles are squares of 2^tile_bits samples */
} grid;

typedef struct tile_job {
    const shb_kernels *kernels;
    const shb_draw_desc *desc;
    const shb_geometry *geometry;
    const shb_target *target;
    const shb_chunks *chunks;
    grid grid;
    shb_chunk_bins bins;
    shb_layers *lanes;  /* NULL when tiles are drawn directly */
    atomic_size_t next; /* row of tiles that nobody has begun */
} tile_job;

/* Kernels work on whole vectors inside of a tile and on one pitch for all layers. */
static bool can_draw_directly(const shb_draw_desc *desc) {
    const size_t row = (size_t)desc->width * 4;
    const size_t stride = desc->depth.stride ? desc->depth.stride : row;
    const size_t second_stride = desc->second.stride ? desc->second.stride : row;
    const size_t id_stride = desc->id_stride ? desc->id_stride : row;
    return desc->width % 16 == 0 && desc->depth.texels &&
           desc->depth.format == SHB_FORMAT_FLOAT32 &&
           (!desc->second.texels ||
            (desc->second.format == SHB_FORMAT_FLOAT32 && second_stride == stride)) &&
           (!desc->ids || id_stride == stride);
}

static grid choose_grid(const shb_context *context, const shb_draw_desc *desc,
                        const shb_geometry *geometry) {
    const uint32_t texels = desc->width * desc->height;
    const bool few = geometry->triangle_count <= FEW_TRIANGLES && texels > FEW_TRIANGLES_TEXELS;
    grid made = {.direct = can_draw_directly(desc), .tile_bits = TILE_BITS};
    const bool many = geometry->triangle_count >= texels / WHOLE_TEXELS_PER_TRIANGLE;
    const uint32_t layers = 1u + (desc->ids != NULL) + (desc->second.texels != NULL);
    const bool cached = context->threads == 1 && texels <= WHOLE_TEXELS / layers;
    made.whole =
        made.direct && !desc->tile_size && !few && texels <= WHOLE_TEXELS && (cached || many);
    if (desc->tile_size)
        for (made.tile_bits = 4; desc->tile_size >> made.tile_bits != 1; made.tile_bits++)
            continue;
    while (((uint64_t)desc->width >> made.tile_bits) * (desc->height >> made.tile_bits) > TILES_MAX)
        made.tile_bits++;
    return made;
}

static shb_samples tile_samples(const tile_job *job, size_t tile) {
    const int32_t left = (int32_t)(tile % job->bins.columns) << job->grid.tile_bits;
    const int32_t top = (int32_t)(tile / job->bins.columns) << job->grid.tile_bits;
    const int32_t last = (1 << job->grid.tile_bits) - 1;
    return shb_samples_intersect((shb_samples){left, top, left + last, top + last},
                                 job->target->samples);
}

static void *texel_at(void *texels, size_t stride, const shb_samples *samples) {
    return texels ? (char *)texels + (size_t)samples->first_row * stride +
                        (size_t)samples->first_column * 4
                  : NULL;
}

/* A tile's layers: parts of the images, or the lane's own. */
static shb_layers layers_of(const tile_job *job, size_t lane, shb_samples samples) {
    const shb_draw_desc *desc = job->desc;
    if (!job->grid.direct) {
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

/* Gathers triangles of one instance until a chunk is full. */
typedef struct gatherer {
    const shb_kernels *kernels;
    const shb_tile *tile;
    shb_chunk chunk;
    uint32_t triangles[SHB_CHUNK];
} gatherer;

static void flush(gatherer *gathered) {
    if (gathered->chunk.count)
        gathered->kernels->draw(&gathered->chunk, gathered->tile);
    gathered->chunk.count = 0;
}

static void gather(gatherer *gathered, const shb_chunk *from, uint32_t t) {
    if (gathered->chunk.count == SHB_CHUNK || gathered->chunk.instance != from->instance) {
        flush(gathered);
        gathered->chunk.instance = from->instance;
        gathered->chunk.vertices = from->vertices;
    }
    gathered->triangles[gathered->chunk.count++] = from->first + t;
}

/* A block's triangles in the tile. */
static void draw_block(const tile_job *job, size_t block, size_t tile, gatherer *gathered) {
    const shb_chunk_bins *bins = &job->bins;
    const size_t tiles = (size_t)bins->columns * bins->rows;
    const uint16_t *ends = bins->ends + block * (tiles + 1);
    const shb_chunk *chunks = job->chunks->chunks + block * SHB_BLOCK_CHUNKS;
    const shb_binned *binned = bins->binned + block * SHB_BLOCK_CAPACITY;
    if (ends[tiles]) {
        for (uint32_t i = tile ? ends[tile - 1] : 0; i < ends[tile]; i++)
            gather(gathered, &chunks[binned[i] / SHB_CHUNK], binned[i] % SHB_CHUNK);
        return;
    }
    const size_t left = job->chunks->count - block * SHB_BLOCK_CHUNKS;
    for (size_t i = 0; i < SHB_BLOCK_CHUNKS && i < left; i++)
        job->kernels->draw(&chunks[i], gathered->tile);
}

static void draw_binned(const tile_job *job, size_t number, const shb_tile *tile) {
    gatherer gathered = {.kernels = job->kernels, .tile = tile};
    gathered.chunk.triangles = gathered.triangles;
    for (size_t block = 0; block < job->bins.blocks; block++)
        draw_block(job, block, number, &gathered);
    flush(&gathered);
}

static void draw_tile(tile_job *job, size_t lane, size_t number) {
    const shb_layers layers = layers_of(job, lane, tile_samples(job, number));
    const shb_tile tile = shb_layers_tile(&layers);
    shb_layers_clear(&layers, job->desc->view->reversed);
    draw_binned(job, number, &tile);
    draw_coded(job, &layers);
    shb_layers_store(&layers, job->desc);
}

/* A lane owns its layers and takes one row of tiles after the other until none is left. Threads
 * keep to rows of their own because what is prefetched at the end of a tile's row would be taken
 * from the thread that writes there: two threads side by side were slower than one. */
static void run_lane(void *arg, size_t index) {
    tile_job *job = arg;
    for (size_t row; (row = atomic_fetch_add(&job->next, 1)) < job->bins.rows;)
        for (size_t column = 0; column < job->bins.columns; column++)
            draw_tile(job, index, row * job->bins.columns + column);
}

static bool draw_tiles(shb_context *context, tile_job *job) {
    if (!shb_chunks_bin(context, job->target, job->chunks, job->grid.tile_bits, &job->bins))
        return false;
    const size_t rows = job->bins.rows;
    const size_t lanes = rows < context->threads ? rows : context->threads;
    if (!job->grid.direct) {
        const size_t size = (size_t)1 << job->grid.tile_bits;
        job->lanes = shb_layers_reserve(context, job->desc, lanes, size, size);
        if (!job->lanes)
            return false;
    }
    atomic_init(&job->next, 0);
    shb_parallel_for(context, run_lane, job, lanes);
    return true;
}

static bool draw_whole(shb_context *context, tile_job *job) {
    const shb_layers layers = layers_of(job, 0, job->target->samples);
    if (!shb_chunk_whole_draw(context, job->desc, job->chunks, &layers, &job->bins.drawn))
        return false;
    draw_coded(job, &layers);
    shb_layers_store(&layers, job->desc);
    return true;
}

static void count_stats(const tile_job *job, shb_draw_stats *stats) {
    *stats = (shb_draw_stats){.triangles = job->geometry->triangle_count,
                              .not_finite = job->chunks->not_finite,
                              .drawn = job->bins.drawn + job->chunks->coded_count};
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
                    .grid = choose_grid(context, desc, geometry)};
    if (!(job.grid.whole ? draw_whole : draw_tiles)(context, &job))
        return false;
    count_stats(&job, stats);
    return true;
}
