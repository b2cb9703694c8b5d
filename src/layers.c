#include "strict.h"

#include "layers.h"

#include "padded_rows.h"
#include "scratch.h"
#include "shadowbias/bias.h"
#include "slopes.h"

#include <string.h>

/* Samples of a row that are drawn at a time. */
#define RUN_SAMPLES 256

static void merge_depths(size_t count, const float *restrict z, float *restrict nearest) {
    for (size_t i = 0; i < count; i++)
        nearest[i] = z[i] < nearest[i] ? z[i] : nearest[i];
}

/* SHB_ID_NONE is negative, so that no triangle replaces it at equal, that is at far, depth. */
static void merge_ids(size_t count, const float *restrict z, const float *restrict nearest,
                      int32_t id, int32_t *restrict ids) {
    for (size_t i = 0; i < count; i++) {
        const int32_t equal = id < ids[i] ? id : ids[i];
        const int32_t closer = z[i] < nearest[i] ? id : ids[i];
        ids[i] = z[i] == nearest[i] ? equal : closer;
    }
}

static void merge_second(size_t count, const float *restrict z, const float *restrict nearest,
                         float *restrict second) {
    for (size_t i = 0; i < count; i++) {
        const float loser = z[i] < nearest[i] ? nearest[i] : z[i];
        second[i] = loser < second[i] ? loser : second[i];
    }
}

/* At most RUN_SAMPLES samples of a row, from the one at column and row on. */
static void draw_run(const shb_layers *layers, const shb_plane *plane, const shb_shape *shape,
                     bool is_raised, int32_t row, int32_t column, size_t count, uint32_t id) {
    float z[RUN_SAMPLES];
    (is_raised ? shb_plane_raised_depths : shb_plane_depths)(
        plane, column - shape->samples.first_column, row - shape->samples.first_row, count, z);
    const size_t at = (size_t)(row - layers->samples.first_row) * layers->pitch +
                      (size_t)(column - layers->samples.first_column);
    if (layers->ids)
        merge_ids(count, z, layers->nearest + at, (int32_t)id,
                  (int32_t *)(void *)(layers->ids + at));
    if (layers->second)
        merge_second(count, z, layers->nearest + at, layers->second + at);
    merge_depths(count, z, layers->nearest + at);
}

/* The bound of the shape's own plane. */
static double bound_of(const shb_corner_errors *errors, const shb_shape *shape,
                       const shb_plane *plane, int32_t width, int32_t height) {
    const double *x = shape->X, *y = shape->Y, *z = shape->Z;
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    const double farther = z[1] > z[2] ? z[1] : z[2], hi = z[0] > farther ? z[0] : farther;
    return shape->is_cut
               ? HUGE_VAL
               : shb_plane_bound(errors, area, plane->lo, hi, width, height, plane->gx, plane->gy);
}

/* Makes the triangle's plane what is drawn of it, and returns its slopes. */
static uint32_t take_plane(const shb_plane_finder *finder, const shb_draw_instance *instance,
                           const shb_shape *shape, uint32_t id, shb_plane *plane) {
    const shb_samples *box = &shape->samples;
    const int32_t width = box->last_column - box->first_column + 1;
    const int32_t height = box->last_row - box->first_row + 1;
    double bound = bound_of(&instance->corner_errors, shape, plane, width, height);
    if (bound == HUGE_VAL) {
        shb_plane_corners corners;
        shb_found_planes found;
        shb_plane_corners_set(&corners, 0, instance->mesh,
                              (uint32_t)(id - instance->first_triangle));
        finder->find(finder, instance, 1, &corners, &found);
        bound = shb_plane_take(&found, 0, box->first_column, box->first_row, plane);
    }
    shb_plane_raise(bound, width, height, plane);
    return shb_slopes_of(plane->gx / finder->slope_unit, plane->gy / finder->slope_unit);
}

void shb_layers_draw(const shb_layers *layers, const shb_target *target,
                     const shb_draw_instance *instance, const shb_shape *shape, uint32_t id) {
    const shb_samples box = shb_samples_intersect(shape->samples, layers->samples);
    if (shb_samples_are_empty(box))
        return;
    shb_plane plane = shb_plane_of(target, shape);
    if (target->planes)
        id = take_plane(target->planes, instance, shape, id, &plane);
    const shb_cover cover = shb_cover_of(shape, box);
    for (int32_t row = box.first_row; row <= box.last_row; row++) {
        shb_run runs[SHB_RUNS_MAX];
        const size_t count = shb_cover_row(&cover, row, runs);
        for (size_t i = 0; i < count; i++)
            for (int32_t first = runs[i].first; first < runs[i].end; first += RUN_SAMPLES) {
                const int32_t left = runs[i].end - first;
                draw_run(layers, &plane, shape, target->planes != NULL, row, first,
                         (size_t)(left < RUN_SAMPLES ? left : RUN_SAMPLES), id);
            }
    }
}

shb_layers *shb_layers_reserve(shb_context *context, const shb_draw_desc *desc,
                               const shb_target *target, size_t count, size_t columns,
                               size_t rows) {
    const size_t pitch = shb_padded_stride(columns, sizeof(float)) / sizeof(float);
    const bool has_second = desc->second.texels || target->combines, has_ids = desc->ids != NULL;
    const size_t texels = pitch * rows, lane_texels = texels * (1u + has_second + has_ids);
    shb_buffer *scratch = context->draw_scratch;
    shb_layers *lanes =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_LANES], count, sizeof *lanes);
    float *layer = shb_buffer_reserve(context, &scratch[SHB_SCRATCH_LAYERS], count,
                                      lane_texels * sizeof *layer);
    if (!lanes || !layer)
        return NULL;
    for (size_t i = 0; i < count; i++, layer += lane_texels)
        lanes[i] = (shb_layers){
            .pitch = pitch,
            .nearest = layer,
            .second = has_second ? layer + texels : NULL,
            .ids = has_ids ? (uint32_t *)(void *)(layer + texels * (1u + has_second)) : NULL,
        };
    return lanes;
}

static size_t columns_of(const shb_layers *layers) {
    return (size_t)(layers->samples.last_column - layers->samples.first_column + 1);
}

static size_t rows_of(const shb_layers *layers) {
    return (size_t)(layers->samples.last_row - layers->samples.first_row + 1);
}

static void clear_layer(const shb_layers *layers, float *layer, float far_depth) {
    const size_t columns = columns_of(layers), rows = rows_of(layers);
    for (size_t row = 0; row < rows; row++)
        for (size_t i = 0; i < columns; i++)
            layer[row * layers->pitch + i] = far_depth;
}

void shb_layers_clear(const shb_layers *layers, bool reversed) {
    clear_layer(layers, layers->nearest, shb_far_depth(reversed));
    if (layers->second)
        clear_layer(layers, layers->second, shb_far_depth(reversed));
    if (layers->ids)
        for (size_t row = 0; row < rows_of(layers); row++)
            memset(layers->ids + row * layers->pitch, 0xff, columns_of(layers) * sizeof(uint32_t));
}

static void store_depth(const shb_layers *layers, const float *layer, const shb_depth_image *image,
                        uint32_t width, bool reversed, shb_format_store_fn *store) {
    if (!image->texels)
        return;
    const size_t size = shb_format_size(image->format);
    const size_t stride = image->stride ? image->stride : width * size;
    char *texels = (char *)image->texels + (size_t)layers->samples.first_row * stride +
                   (size_t)layers->samples.first_column * size;
    if ((void *)texels == (const void *)layer && !reversed)
        return;
    for (size_t row = 0; row < rows_of(layers); row++)
        store(image->format, reversed, columns_of(layers), layer + row * layers->pitch,
              texels + row * stride);
}

static void store_ids(const shb_layers *layers, const shb_draw_desc *desc) {
    if (!desc->ids)
        return;
    const size_t stride = desc->id_stride ? desc->id_stride : desc->width * sizeof(uint32_t);
    char *ids = (char *)desc->ids + (size_t)layers->samples.first_row * stride +
                (size_t)layers->samples.first_column * sizeof(uint32_t);
    if ((void *)ids == (const void *)layers->ids)
        return;
    for (size_t row = 0; row < rows_of(layers); row++)
        memcpy(ids + row * stride, layers->ids + row * layers->pitch,
               columns_of(layers) * sizeof(uint32_t));
}

static void replace_nan(size_t count, float value, float *depths) {
    for (size_t i = 0; i < count; i++)
        depths[i] = depths[i] == depths[i] ? depths[i] : value;
}

/* Makes of the two layers what the method keeps. */
static void combine(const shb_layers *layers, const shb_bias *bias, bool reversed) {
    const size_t columns = columns_of(layers), rows = rows_of(layers);
    for (size_t row = 0; row < rows; row++) {
        float *nearest = layers->nearest + row * layers->pitch;
        bias->combine(bias, columns, nearest, layers->second + row * layers->pitch, nearest);
        replace_nan(columns, shb_far_depth(reversed), nearest);
    }
}

void shb_layers_store(const shb_layers *layers, const shb_draw_desc *desc, const shb_target *target,
                      shb_format_store_fn *store) {
    const bool reversed = desc->view->reversed;
    if (target->combines)
        combine(layers, target->combines, reversed);
    store_depth(layers, layers->nearest, &desc->depth, desc->width, reversed, store);
    store_depth(layers, layers->second, &desc->second, desc->width, reversed, store);
    store_ids(layers, desc);
}
