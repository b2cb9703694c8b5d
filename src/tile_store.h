/* Storing the layers of a tile in the images, as far as the marks of its cells ask for it. */
#ifndef SRC_TILE_STORE_H
#define SRC_TILE_STORE_H

#include "layers.h"

/* No cell of a tile that is to be copied is drawn in yet; width: of the target. */
void shb_tile_begin_marks(const shb_layers *layers, uint32_t width);

/* Stores what is not clear in the images and in the layers. */
void shb_tile_store(const shb_layers *layers, const shb_draw_desc *desc, const shb_target *target,
                    shb_format_store_fn *store);

#endif
