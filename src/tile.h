/* Drawing tile by tile, one triangle after the other: the scalar code that every instruction set
 * has to agree with. */
#ifndef SRC_TILE_H
#define SRC_TILE_H

#include "bin.h"

/* Draws all tiles on the context's threads; false: out of memory, the images are untouched. */
bool shb_tiles_draw(shb_context *context, const shb_draw_desc *desc, const shb_geometry *geometry,
                    const shb_target *target, const shb_bins *bins);

#endif
