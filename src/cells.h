/* Bounds of the farthest depth in each SHB_CELL by SHB_CELL samples of a tile, for either layer, by
 * which the kernels leave out what lies behind. */
#ifndef SRC_CELLS_H
#define SRC_CELLS_H

#include "kernels/raster.h"

/* Cells of a row of a tile that is width samples wide, up to a whole block. */
size_t shb_cells_stride(size_t width);

/* All cells of such a tile. */
size_t shb_cells_count(size_t width, size_t height);

/* Room for the cells of count tiles in the context's scratch, those of both layers one after the
 * other; NULL: out of memory. */
float *shb_cells_reserve(shb_context *context, size_t count, size_t width, size_t height);

/* Nothing is cleared yet. */
void shb_cells_reset(const shb_tile *tile);

#endif
