/* Drawing tile by tile from chunks, by the kernels: the fast path of shb_draw. */
#ifndef SRC_CHUNK_TILE_H
#define SRC_CHUNK_TILE_H

#include "chunk.h"

/* Draws all tiles on the context's threads; stats may be NULL; false: out of memory, the images are
 * untouched. */
bool shb_chunk_tiles_draw(shb_context *context, const shb_draw_desc *desc,
                          const shb_geometry *geometry, const shb_target *target,
                          const shb_chunks *chunks, shb_draw_stats *stats);

#endif
