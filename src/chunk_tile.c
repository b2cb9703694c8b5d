#include "strict.h"

#include "chunk_tile.h"

#include "chunk_bin.h"
#include "chunk_gather.h"
#include "chunk_whole.h"
#include "cluster_bin.h"
#include "kernels/shade.h"
#include "marks.h"
#include "scratch.h"
#include "tile_store.h"

#include <stdatomic.h>

/* Tiles are as wide as the target, so that memory is written in long runs, and as many rows high as
 * give this many samples (powers of two): less where each triangle fills much of a tile, so that it
 * stays in a second-level cache, more where tiles are copied to the target: they need a third-level
 * cache only, and the fewer they are, the fewer triangles are drawn in two of them. */
#define TILE_BITS 19
#define CACHED_TILE_BITS 17
#define COPIED_TILE_BITS 20
#define ROW_BITS_MIN 4

#define TILE_ROWS_MAX (SHB_SIZE_MAX >> ROW_BITS_MIN)

/* Each thread has this many tiles to take at least. */
#define TILES_PER_THREAD 4

/* More tiles than this cost more than they save. */
#define TILES_MAX 4096

/* Up to this many texels in all layers one thread draws straight through: they stay in a cache. So
 * do threads for as large a target where there is a triangle for every few texels, and one thread
 * for any target where there is one for every few texels of each layer. But not a few large
 * triangles one over the other: they would go through the whole map each. Clusters need not be
 * sorted into tiles one triangle after the other: one thread draws them in tiles where there are
 * ids, or many triangles in two layers, as more of these stays in a cache then. Threads merge no
 * larger layers than pay for clusters that lie in two tiles. */
#define WHOLE_TEXELS (2048u * 2048u)
#define WHOLE_TEXELS_OF_CLUSTERS (1024u * 1024u)
#define WHOLE_TEXELS_PER_TRIANGLE 4
#define WHOLE_TEXELS_PER_TRIANGLE_ALONE 20

typedef struct grid {
    bool whole;  /* the target is not cut into tiles */
    bool direct; /* tiles are drawn in the images themselves */
    bool few;    /* a few large triangles */
    shb_tile_shape shape;
} grid;

typedef struct tile_job {
    const shb_kernels *kernels;
    shb_format_store_fn *store;
    const shb_draw_desc *desc;
    const shb_geometry *geometry;
    const shb_target *target;
    const shb_chunks *chunks;
    grid grid;
    bool counts;
    uint8_t *marks; /* the target's, or NULL */
    shb_chunk_bins bins;
    shb_cluster_bins clusters;
    shb_layers *lanes; /* NULL when tiles are drawn directly */
    float *cells;      /* tile_cells of each lane */
    size_t tile_cells;
    float
        *depths; /* tile_depths of each lane, if the lanes are NULL and no image holds the depth */
    size_t tile_depths;
    uint16_t order[TILE_ROWS_MAX]; /* in which rows of tiles are begun */
    atomic_size_t next;            /* place in the order that nobody has taken */
    atomic_size_t drawn;           /* triangles of clusters */
} tile_job;

/* Bytes from one row of the image to the next. */
static size_t stride_of(const shb_draw_desc *desc, size_t stride) {
    return stride ? stride : (size_t)desc->width * 4;
}

/* The stride of the first image that is wanted. */
static size_t common_stride(const shb_draw_desc *desc) {
    return stride_of(desc, desc->depth.texels    ? desc->depth.stride
                           : desc->second.texels ? desc->second.stride
                                                 : desc->id_stride);
}

static bool is_layer(const shb_draw_desc *desc, const shb_depth_image *image) {
    return !image->texels || (image->format == SHB_FORMAT_FLOAT32 &&
                              stride_of(desc, image->stride) == common_stride(desc));
}

/* Kernels work on whole vectors inside of a tile and on one pitch for all layers. A depth that no
 * image holds takes memory by the pitch. */
static bool can_draw_directly(const shb_draw_desc *desc) {
    return desc->width % 16 == 0 && is_layer(desc, &desc->depth) && is_layer(desc, &desc->second) &&
           (!desc->ids || stride_of(desc, desc->id_stride) == common_stride(desc)) &&
           (desc->depth.texels || common_stride(desc) <= (size_t)desc->width * 8);
}

/* The least power of two that is not below the value. */
static int bits_of(uint32_t value) {
    int bits = 0;
    while (bits < 31 && 1u << bits < value)
        bits++;
    return bits;
}

static shb_tile_shape choose_shape(const shb_context *context, const shb_draw_desc *desc,
                                   int tile_bits) {
    const int column_bits = bits_of(desc->width < 16 ? 16 : desc->width);
    int row_bits = tile_bits - column_bits;
    while (context->threads > 1 && desc->height >> row_bits < TILES_PER_THREAD * context->threads &&
           row_bits > ROW_BITS_MIN)
        row_bits--;
    return (shb_tile_shape){column_bits, row_bits < ROW_BITS_MIN ? ROW_BITS_MIN : row_bits};
}

static shb_tile_shape square_shape(const shb_draw_desc *desc) {
    int bits = bits_of(desc->tile_size);
    while (((uint64_t)desc->width >> bits) * (desc->height >> bits) > TILES_MAX)
        bits++;
    return (shb_tile_shape){bits, bits};
}

/* True if going straight through the target beats cutting it into tiles. */
static bool suits_whole(const shb_context *context, const shb_draw_desc *desc,
                        const shb_geometry *geometry) {
    const uint64_t triangles = geometry->triangle_count;
    const uint32_t texels = desc->width * desc->height;
    const uint32_t layers = 1u + (desc->ids != NULL) + (desc->second.texels != NULL);
    if (context->threads == 1) {
        const bool small = texels <= WHOLE_TEXELS / layers;
        const bool dense = triangles >= layers * (texels / WHOLE_TEXELS_PER_TRIANGLE_ALONE);
        return geometry->vertex_count ? small || dense
                                      : !desc->ids && (small || (dense && layers == 1));
    }
    const uint32_t most = geometry->vertex_count ? WHOLE_TEXELS : WHOLE_TEXELS_OF_CLUSTERS;
    return texels <= most && triangles >= texels / WHOLE_TEXELS_PER_TRIANGLE;
}

static grid choose_grid(const shb_context *context, const shb_draw_desc *desc,
                        const shb_geometry *geometry, const shb_target *target) {
    const bool few = geometry->few;
    const bool direct = can_draw_directly(desc) && !target->combines;
    const int tile_bits = few ? CACHED_TILE_BITS : direct ? TILE_BITS : COPIED_TILE_BITS;
    return (grid){
        .direct = direct,
        .few = few,
        .whole = direct && !desc->tile_size && !few && suits_whole(context, desc, geometry),
        .shape = desc->tile_size ? square_shape(desc) : choose_shape(context, desc, tile_bits)};
}

static shb_samples tile_samples(const tile_job *job, size_t tile) {
    const shb_tile_shape shape = job->grid.shape;
    const int32_t left = (int32_t)(tile % job->bins.columns) << shape.column_bits;
    const int32_t top = (int32_t)(tile / job->bins.columns) << shape.row_bits;
    const int32_t right = left + (1 << shape.column_bits) - 1;
    const int32_t bottom = top + (1 << shape.row_bits) - 1;
    return shb_samples_intersect((shb_samples){left, top, right, bottom}, job->target->samples);
}

static void *texel_at(void *texels, size_t stride, const shb_samples *samples) {
    return texels ? (char *)texels + (size_t)samples->first_row * stride +
                        (size_t)samples->first_column * 4
                  : NULL;
}

static uint8_t *marks_at(const tile_job *job, const shb_samples *samples) {
    const size_t row = (size_t)samples->first_row / SHB_CELL;
    return job->marks ? job->marks + row * shb_marks_stride(job->desc->width) +
                            (size_t)samples->first_column / SHB_CELL
                      : NULL;
}

/* A tile's layers: parts of the images, or the lane's own. Where no image is to hold the depth, it
 * has the images' pitch all the same. */
static shb_layers layers_of(const tile_job *job, size_t lane, shb_samples samples) {
    const shb_draw_desc *desc = job->desc;
    float *const cells = job->cells ? job->cells + lane * job->tile_cells : NULL;
    if (!job->grid.direct) {
        shb_layers layers = job->lanes[lane];
        layers.samples = samples;
        layers.cells = cells;
        layers.marks = marks_at(job, &samples);
        layers.copied = true;
        return layers;
    }
    const size_t stride = common_stride(desc);
    return (shb_layers){
        .samples = samples,
        .pitch = stride / 4,
        .nearest = desc->depth.texels ? texel_at(desc->depth.texels, stride, &samples)
                                      : job->depths + lane * job->tile_depths,
        .second = texel_at(desc->second.texels, stride, &samples),
        .ids = texel_at(desc->ids, stride, &samples),
        .cells = cells,
        .marks = marks_at(job, &samples),
    };
}

static void draw_coded(const tile_job *job, const shb_layers *layers) {
    const shb_draw_instance *instance = NULL;
    for (size_t i = 0; i < job->chunks->coded_count; i++) {
        const shb_coded *coded = &job->chunks->coded[i];
        const shb_samples reached = shb_samples_intersect(coded->samples, layers->samples);
        if (shb_samples_are_empty(reached))
            continue;
        shb_marks_draw(job->marks, (ptrdiff_t)shb_marks_stride(job->desc->width), &reached);
        if (!instance || !shb_instance_has(instance, coded->id))
            instance = shb_geometry_instance(job->geometry, coded->id);
        shb_clip_position corners[3];
        shb_shape shape;
        shb_geometry_corners(instance, coded->id, corners);
        if (shb_shape_prepare(job->target, instance, corners, &shape) == SHB_OUTCOME_DRAWN)
            shb_layers_draw(layers, job->target, instance, &shape, coded->id);
    }
}

/* A block's triangles in the tile. */
static void draw_block(const tile_job *job, size_t block, size_t tile, shb_gatherer *gatherer) {
    const shb_chunk_bins *bins = &job->bins;
    const size_t tiles = (size_t)bins->columns * bins->rows;
    const uint16_t *ends = bins->ends + block * (tiles + 1);
    const shb_chunk *chunks = job->chunks->chunks + block * SHB_BLOCK_CHUNKS;
    const shb_binned *binned = bins->binned + block * SHB_BLOCK_CAPACITY;
    if (ends[tiles]) {
        for (uint32_t i = tile ? ends[tile - 1] : 0; i < ends[tile]; i++)
            shb_gather(gatherer, &chunks[binned[i] / SHB_CHUNK], binned[i] % SHB_CHUNK);
        return;
    }
    const size_t left = job->chunks->plain_count - block * SHB_BLOCK_CHUNKS;
    for (size_t i = 0; i < SHB_BLOCK_CHUNKS && i < left; i++)
        job->kernels->draw(&chunks[i], gatherer->tile);
}

static void draw_binned(const tile_job *job, size_t number, const shb_tile *tile) {
    shb_gatherer gatherer = {.kernels = job->kernels, .tile = tile, .nearest_first = job->grid.few};
    for (size_t block = 0; block < job->bins.blocks; block++)
        draw_block(job, block, number, &gatherer);
    shb_gather_flush(&gatherer);
}

/* The clusters that reach the tile. Returns how many of their triangles it owns. */
static size_t draw_clusters(const tile_job *job, size_t row, const shb_layers *layers,
                            const shb_tile *tile) {
    const shb_cluster_bins *clusters = &job->clusters;
    size_t drawn = 0;
    for (size_t i = row ? clusters->ends[row - 1] : 0; i < clusters->ends[row]; i++) {
        const shb_chunk *chunk = &job->chunks->chunks[clusters->chunks[i]];
        if (!shb_samples_are_empty(shb_samples_intersect(chunk->cluster.samples, layers->samples)))
            drawn += job->kernels->draw(chunk, tile);
    }
    return drawn;
}

static void draw_tile(tile_job *job, size_t lane, size_t number) {
    const shb_layers layers = layers_of(job, lane, tile_samples(job, number));
    const shb_tile tile = shb_layers_tile(&layers, job->desc, job->target, job->counts);
    if (layers.copied)
        shb_tile_begin_marks(&layers, job->desc->width);
    draw_binned(job, number, &tile);
    const size_t drawn = draw_clusters(job, number / job->bins.columns, &layers, &tile);
    atomic_fetch_add(&job->drawn, drawn);
    job->kernels->clear(&tile);
    draw_coded(job, &layers);
    shb_tile_store(&layers, job->desc, job->target, job->store);
}

/* A lane owns its layers and takes one row of tiles after the other until none is left. Threads
 * keep to rows of their own because what is prefetched at the end of a tile's row would be taken
 * from the thread that writes there: two threads side by side were slower than one. */
static void run_lane(void *arg, size_t index) {
    tile_job *job = arg;
    for (size_t place; (place = atomic_fetch_add(&job->next, 1)) < job->bins.rows;)
        for (size_t column = 0; column < job->bins.columns; column++)
            draw_tile(job, index, job->order[place] * job->bins.columns + column);
}

static size_t clusters_of(const tile_job *job, size_t row) {
    const size_t *ends = job->clusters.ends;
    return ends[row] - (row ? ends[row - 1] : 0);
}

/* Where threads share the rows, those with most clusters come first: at the end none waits long for
 * another. */
static void order_rows(tile_job *job, size_t lanes) {
    for (size_t row = 0; row < job->bins.rows; row++) {
        size_t place = row;
        for (; lanes > 1 && place > 0; place--) {
            if (clusters_of(job, job->order[place - 1]) >= clusters_of(job, row))
                break;
            job->order[place] = job->order[place - 1];
        }
        job->order[place] = (uint16_t)row;
    }
}

/* Room for the depth of as many rows for each lane, if no image holds it. */
static bool reserve_depths(shb_context *context, tile_job *job, size_t lanes, size_t rows) {
    if (!job->grid.direct || job->desc->depth.texels)
        return true;
    const size_t stride = common_stride(job->desc);
    job->depths = shb_buffer_reserve(context, &context->draw_scratch[SHB_SCRATCH_DEPTHS], lanes,
                                     rows * stride);
    job->tile_depths = rows * stride / 4;
    return job->depths != NULL;
}

static bool draw_tiles(shb_context *context, tile_job *job) {
    if (!shb_chunks_bin(context, job->target, job->chunks, job->grid.shape, &job->bins) ||
        !shb_clusters_bin(context, job->chunks, job->grid.shape.row_bits, job->bins.rows,
                          &job->clusters))
        return false;
    const size_t rows = job->bins.rows;
    const size_t lanes = rows < context->threads ? rows : context->threads;
    const shb_tile_shape shape = job->grid.shape;
    const size_t width = (size_t)1 << shape.column_bits, height = (size_t)1 << shape.row_bits;
    job->tile_cells = 2 * shb_cells_count(width, height);
    job->cells = shb_cells_reserve(context, lanes, width, height);
    if (!job->cells || !reserve_depths(context, job, lanes, height))
        return false;
    if (!job->grid.direct) {
        job->lanes = shb_layers_reserve(context, job->desc, job->target, lanes, width, height);
        if (!job->lanes)
            return false;
    }
    order_rows(job, lanes);
    atomic_init(&job->next, 0);
    atomic_init(&job->drawn, 0);
    shb_parallel_for(context, run_lane, job, lanes);
    job->bins.drawn += atomic_load(&job->drawn);
    return true;
}

static bool draw_whole(shb_context *context, tile_job *job) {
    if (!reserve_depths(context, job, 1, job->desc->height))
        return false;
    const shb_layers layers = layers_of(job, 0, job->target->samples);
    if (!shb_chunk_whole_draw(context, job->desc, job->target, job->chunks, &layers, job->counts,
                              &job->bins.drawn))
        return false;
    draw_coded(job, &layers);
    shb_tile_store(&layers, job->desc, job->target, job->store);
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
                    .store = context->shade_kernels->store,
                    .desc = desc,
                    .geometry = geometry,
                    .target = target,
                    .chunks = chunks,
                    .counts = stats != NULL,
                    .grid = choose_grid(context, desc, geometry, target)};
    if (!target->combines)
        job.marks = target->marks;
    else
        shb_marks_forget(target->marks, desc->width, desc->height);
    if (!(job.grid.whole ? draw_whole : draw_tiles)(context, &job))
        return false;
    if (stats)
        count_stats(&job, stats);
    return true;
}
