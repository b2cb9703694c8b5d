#include "strict.h"

#include "tile.h"

#include "format.h"
#include "plane.h"
#include "scratch.h"

#include <stdatomic.h>
#include <string.h>

/* The layers of one tile, each tile_size * tile_size, rows of tile_size. */
typedef struct tile_layers {
    shb_samples samples; /* of the target */
    uint32_t pitch;
    float *nearest;
    float *second; /* NULL: not wanted */
    uint32_t *ids; /* of the nearest; NULL: neither ids nor the second layer are wanted */
} tile_layers;

typedef struct tile_job {
    const shb_draw_desc *desc;
    const shb_geometry *geometry;
    const shb_target *target;
    const shb_bins *bins;
    tile_layers *lanes;
    atomic_size_t next; /* tile that nobody has begun */
} tile_job;

/* An edge at the first sample of a box, with 256 divided out. */
typedef struct edge {
    int64_t value, per_column, per_row;
} edge;

static edge edge_at(const shb_shape *shape, size_t a, size_t b, shb_samples box) {
    const int64_t dx = (int64_t)shape->snapped_x[b] - shape->snapped_x[a];
    const int64_t dy = (int64_t)shape->snapped_y[b] - shape->snapped_y[a];
    const int64_t px = (int64_t)box.first_column * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
    const int64_t py = (int64_t)box.first_row * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
    const int64_t e = dx * (py - shape->snapped_y[a]) - dy * (px - shape->snapped_x[a]);
    const bool is_top_left = dy < 0 || (dy == 0 && dx > 0);
    return (edge){(e - (is_top_left ? 0 : 1)) >> 8, -dy, dx};
}

/* The order of (depth, id): ids rise, so an equal depth loses. A triangle whose fan overlaps itself
 * must not become its own second layer; its depth at a sample is always the same. */
static void put_sample(const tile_layers *layers, size_t at, float z, uint32_t id) {
    if (z < layers->nearest[at]) {
        if (layers->second)
            layers->second[at] = layers->nearest[at];
        layers->nearest[at] = z;
        if (layers->ids)
            layers->ids[at] = id;
    } else if (layers->second && z < layers->second[at] && layers->ids[at] != id) {
        layers->second[at] = z;
    }
}

/* One triangle of the shape's fan within the box. */
static void draw_fan_triangle(const tile_layers *layers, const shb_shape *shape,
                              const shb_plane *plane, const size_t corners[3], shb_samples box,
                              uint32_t id) {
    const edge a = edge_at(shape, corners[0], corners[1], box);
    const edge b = edge_at(shape, corners[1], corners[2], box);
    const edge c = edge_at(shape, corners[2], corners[0], box);
    for (int32_t row = box.first_row; row <= box.last_row; row++) {
        const int64_t j = row - box.first_row;
        const size_t line = (size_t)(row - layers->samples.first_row) * layers->pitch;
        for (int32_t column = box.first_column; column <= box.last_column; column++) {
            const int64_t i = column - box.first_column;
            const bool covered = a.value + a.per_row * j + a.per_column * i >= 0 &&
                                 b.value + b.per_row * j + b.per_column * i >= 0 &&
                                 c.value + c.per_row * j + c.per_column * i >= 0;
            if (covered)
                put_sample(layers, line + (size_t)(column - layers->samples.first_column),
                           shb_plane_depth(plane, column - shape->samples.first_column,
                                           row - shape->samples.first_row),
                           id);
        }
    }
}

static void draw_shape(const tile_layers *layers, const shb_target *target, const shb_shape *shape,
                       uint32_t id) {
    const shb_samples box = shb_samples_intersect(shape->samples, layers->samples);
    if (shb_samples_are_empty(box))
        return;
    const shb_plane plane = shb_plane_of(target, shape);
    for (size_t i = 1; i + 1 < shape->count; i++) {
        const size_t corners[3] = {shape->apex, (shape->apex + i) % shape->count,
                                   (shape->apex + i + 1) % shape->count};
        draw_fan_triangle(layers, shape, &plane, corners, box, id);
    }
}

static void draw_list(const tile_job *job, const tile_layers *layers, size_t tile) {
    const uint64_t first = tile ? job->bins->ends[tile - 1] : 0, end = job->bins->ends[tile];
    if (first == end)
        return;
    const shb_draw_instance *instance = shb_geometry_instance(job->geometry, job->bins->ids[first]);
    for (uint64_t i = first; i < end; i++) {
        const uint32_t id = job->bins->ids[i];
        while (!shb_instance_has(instance, id))
            instance++;
        shb_clip_position corners[3];
        shb_shape shape;
        shb_geometry_corners(job->geometry, instance, id, corners);
        if (shb_shape_prepare(job->target, instance, corners, &shape) == SHB_OUTCOME_DRAWN)
            draw_shape(layers, job->target, &shape, id);
    }
}

static void clear_layers(const tile_layers *layers, bool reversed) {
    const size_t count = (size_t)layers->pitch * layers->pitch;
    const float far_depth = shb_far_depth(reversed);
    for (size_t i = 0; i < count; i++)
        layers->nearest[i] = far_depth;
    for (size_t i = 0; i < count && layers->second; i++)
        layers->second[i] = far_depth;
    for (size_t i = 0; i < count && layers->ids; i++)
        layers->ids[i] = SHB_ID_NONE;
}

static void store_depth(const tile_layers *layers, const float *layer, const shb_depth_image *image,
                        uint32_t width, bool reversed) {
    if (!image->texels)
        return;
    const size_t size = shb_format_size(image->format);
    const size_t stride = image->stride ? image->stride : width * size;
    const shb_samples box = layers->samples;
    const size_t count = (size_t)(box.last_column - box.first_column + 1);
    for (int32_t row = box.first_row; row <= box.last_row; row++)
        shb_format_store(
            image->format, reversed, count, layer + (size_t)(row - box.first_row) * layers->pitch,
            (char *)image->texels + (size_t)row * stride + (size_t)box.first_column * size);
}

static void store_ids(const tile_layers *layers, const shb_draw_desc *desc) {
    if (!desc->ids)
        return;
    const size_t stride = desc->id_stride ? desc->id_stride : desc->width * sizeof(uint32_t);
    const shb_samples box = layers->samples;
    const size_t count = (size_t)(box.last_column - box.first_column + 1);
    for (int32_t row = box.first_row; row <= box.last_row; row++)
        memcpy(
            (char *)desc->ids + (size_t)row * stride + (size_t)box.first_column * sizeof(uint32_t),
            layers->ids + (size_t)(row - box.first_row) * layers->pitch, count * sizeof(uint32_t));
}

static void draw_tile(const tile_job *job, tile_layers *layers, size_t tile) {
    const shb_draw_desc *desc = job->desc;
    const int32_t size = (int32_t)job->bins->tile_size;
    const int32_t left = (int32_t)(tile % job->bins->columns) * size;
    const int32_t top = (int32_t)(tile / job->bins->columns) * size;
    layers->samples = shb_samples_intersect(
        (shb_samples){left, top, left + size - 1, top + size - 1}, job->target->samples);
    clear_layers(layers, desc->view->reversed);
    draw_list(job, layers, tile);
    store_depth(layers, layers->nearest, &desc->depth, desc->width, desc->view->reversed);
    store_depth(layers, layers->second, &desc->second, desc->width, desc->view->reversed);
    store_ids(layers, desc);
}

/* A lane owns its layers and takes tile after tile until none is left. */
static void run_lane(void *arg, size_t index) {
    tile_job *job = arg;
    const size_t tiles = (size_t)job->bins->columns * job->bins->rows;
    for (size_t tile; (tile = atomic_fetch_add(&job->next, 1)) < tiles;)
        draw_tile(job, &job->lanes[index], tile);
}

/* One block of scratch: the lanes' descriptions, then the layers of each. */
static bool prepare_lanes(shb_context *context, tile_job *job, size_t lanes) {
    const bool has_second = job->desc->second.texels != NULL;
    const bool has_ids = has_second || job->desc->ids;
    const size_t texels = (size_t)job->bins->tile_size * job->bins->tile_size;
    const size_t lane_texels = texels * (1u + has_second + has_ids);
    shb_buffer *scratch = context->draw_scratch;
    if (!shb_buffer_reserve(context, &scratch[SHB_SCRATCH_LANES], lanes, sizeof(tile_layers)) ||
        !shb_buffer_reserve(context, &scratch[SHB_SCRATCH_LAYERS], lanes, lane_texels * 4))
        return false;
    job->lanes = scratch[SHB_SCRATCH_LANES].data;
    float *layer = scratch[SHB_SCRATCH_LAYERS].data;
    for (size_t i = 0; i < lanes; i++, layer += lane_texels)
        job->lanes[i] = (tile_layers){
            .pitch = job->bins->tile_size,
            .nearest = layer,
            .second = has_second ? layer + texels : NULL,
            .ids = has_ids ? (uint32_t *)(void *)(layer + texels * (1u + has_second)) : NULL,
        };
    return true;
}

bool shb_tiles_draw(shb_context *context, const shb_draw_desc *desc, const shb_geometry *geometry,
                    const shb_target *target, const shb_bins *bins) {
    tile_job job = {.desc = desc, .geometry = geometry, .target = target, .bins = bins};
    const size_t tiles = (size_t)bins->columns * bins->rows;
    const size_t lanes = tiles < context->threads ? tiles : context->threads;
    if (!prepare_lanes(context, &job, lanes))
        return false;
    atomic_init(&job.next, 0);
    shb_parallel_for(context, run_lane, &job, lanes);
    return true;
}
