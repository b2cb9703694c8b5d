#include "strict.h"

#include "layers.h"

#include "format.h"
#include "scratch.h"

#include <string.h>

/* An edge at the first sample of a box, with 256 divided out. */
typedef struct edge {
    int64_t value, per_column, per_row;
    int32_t from_y, to_y;
} edge;

static edge edge_at(const shb_shape *shape, size_t a, size_t b, shb_samples box) {
    const int64_t dx = (int64_t)shape->snapped_x[b] - shape->snapped_x[a];
    const int64_t dy = (int64_t)shape->snapped_y[b] - shape->snapped_y[a];
    const int64_t px = (int64_t)box.first_column * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
    const int64_t py = (int64_t)box.first_row * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
    const int64_t e = dx * (py - shape->snapped_y[a]) - dy * (px - shape->snapped_x[a]);
    const int64_t bias = dy < 0 ? 0 : -1;
    return (edge){(e + bias) >> 8, -dy, dx, shape->snapped_y[a], shape->snapped_y[b]};
}

/* What the edge adds to the winding number of the sample i columns and j rows from the first one.
 */
static int winding_of(const edge *e, int32_t py, int64_t i, int64_t j) {
    const bool starts_above = e->from_y <= py, ends_above = e->to_y <= py;
    const bool is_inside = e->value + e->per_row * j + e->per_column * i >= 0;
    if (!starts_above && ends_above)
        return is_inside;
    if (starts_above && !ends_above)
        return -!is_inside;
    return 0;
}

static bool is_covered(const edge *edges, size_t count, int32_t py, int64_t i, int64_t j) {
    int winding = 0;
    for (size_t k = 0; k < count; k++)
        winding += winding_of(&edges[k], py, i, j);
    return winding > 0;
}

/* SHB_ID_NONE is negative, so that no triangle replaces it at equal, that is at far, depth. */
static void put_sample(const shb_layers *layers, size_t at, float z, uint32_t id) {
    const float nearest = layers->nearest[at];
    const bool closer = z < nearest;
    if (layers->ids && (closer || (z == nearest && (int32_t)id < (int32_t)layers->ids[at])))
        layers->ids[at] = id;
    if (layers->second) {
        const float loser = closer ? nearest : z;
        if (loser < layers->second[at])
            layers->second[at] = loser;
    }
    if (closer)
        layers->nearest[at] = z;
}

void shb_layers_draw(const shb_layers *layers, const shb_target *target, const shb_shape *shape,
                     uint32_t id) {
    const shb_samples box = shb_samples_intersect(shape->samples, layers->samples);
    if (shb_samples_are_empty(box))
        return;
    const shb_plane plane = shb_plane_of(target, shape);
    edge edges[SHB_POLYGON_MAX];
    for (size_t i = 0; i < shape->count; i++)
        edges[i] = edge_at(shape, i, (i + 1) % shape->count, box);
    for (int32_t row = box.first_row; row <= box.last_row; row++) {
        const int32_t py = row * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
        const size_t line = (size_t)(row - layers->samples.first_row) * layers->pitch;
        for (int32_t column = box.first_column; column <= box.last_column; column++) {
            if (!is_covered(edges, shape->count, py, column - box.first_column,
                            row - box.first_row))
                continue;
            const float z = shb_plane_depth(&plane, column - shape->samples.first_column,
                                            row - shape->samples.first_row);
            put_sample(layers, line + (size_t)(column - layers->samples.first_column), z, id);
        }
    }
}

shb_layers *shb_layers_reserve(shb_context *context, const shb_draw_desc *desc, size_t count,
                               size_t pitch, size_t rows) {
    const bool has_second = desc->second.texels != NULL, has_ids = desc->ids != NULL;
    const size_t texels = pitch * rows, lane_texels = texels * (1u + has_second + has_ids);
    shb_buffer *scratch = context->draw_scratch;
    if (!shb_buffer_reserve(context, &scratch[SHB_SCRATCH_LANES], count, sizeof(shb_layers)) ||
        !shb_buffer_reserve(context, &scratch[SHB_SCRATCH_LAYERS], count, lane_texels * 4))
        return NULL;
    shb_layers *lanes = scratch[SHB_SCRATCH_LANES].data;
    float *layer = scratch[SHB_SCRATCH_LAYERS].data;
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
                        uint32_t width, bool reversed) {
    if (!image->texels)
        return;
    const size_t size = shb_format_size(image->format);
    const size_t stride = image->stride ? image->stride : width * size;
    char *texels = (char *)image->texels + (size_t)layers->samples.first_row * stride +
                   (size_t)layers->samples.first_column * size;
    if ((void *)texels == (const void *)layer && !reversed)
        return;
    for (size_t row = 0; row < rows_of(layers); row++)
        shb_format_store(image->format, reversed, columns_of(layers), layer + row * layers->pitch,
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

void shb_layers_store(const shb_layers *layers, const shb_draw_desc *desc) {
    const bool reversed = desc->view->reversed;
    store_depth(layers, layers->nearest, &desc->depth, desc->width, reversed);
    store_depth(layers, layers->second, &desc->second, desc->width, reversed);
    store_ids(layers, desc);
}
