/* The layers of a rectangle of the target while triangles are drawn into it, and the scalar way of
 * drawing a triangle: the reference for the kernels, and the way of all triangles that are cut. */
#ifndef SRC_LAYERS_H
#define SRC_LAYERS_H

#include "cover.h"
#include "drawn_plane.h"
#include "format.h"

/* Depths are canonical. Sample (column, row) is element (row - samples.first_row) * pitch + column
 * - samples.first_column of each array. */
typedef struct shb_layers {
    shb_samples samples;
    size_t pitch;
    float *nearest;
    float *second;  /* NULL: not wanted */
    uint32_t *ids;  /* or slopes, as the target says; NULL: not wanted */
    float *cells;   /* for the kernels: bounds of the depth in squares of SHB_CELL samples */
    uint8_t *marks; /* as in the target, from the first cell on; NULL: not known */
    bool copied;    /* to the images, of which these are no parts */
} shb_layers;

/* Layers of columns * rows samples for each of count lanes, in the context's scratch, with what the
 * description and the target want; their samples are for the caller to choose. NULL: out of memory.
 */
shb_layers *shb_layers_reserve(shb_context *context, const shb_draw_desc *desc,
                               const shb_target *target, size_t count, size_t columns, size_t rows);

/* Far depths and no ids. */
void shb_layers_clear(const shb_layers *layers, bool reversed);

/* Merges a drawn shape, of a triangle of the instance. The order of shapes does not matter: at each
 * sample the lowest (depth, id) is the nearest layer, the next depth is the second. */
void shb_layers_draw(const shb_layers *layers, const shb_target *target,
                     const shb_draw_instance *instance, const shb_shape *shape, uint32_t id);

/* Stores the samples in the images that the description wants, except where a layer is the image;
 * where the target combines two layers, the first one is lost. */
void shb_layers_store(const shb_layers *layers, const shb_draw_desc *desc, const shb_target *target,
                      shb_format_store_fn *store);

#endif
