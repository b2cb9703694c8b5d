/* Drawing the whole target at once: each thread draws its share of the chunks into layers of its
 * own, which are then merged. It pays where there are many small triangles for the size of the
 * target. */
#ifndef SRC_CHUNK_WHOLE_H
#define SRC_CHUNK_WHOLE_H

#include "cells.h"
#include "chunk.h"
#include "layers.h"

/* The part of the target that the layers hold, for the kernels. Nothing of it is cleared yet. */
shb_tile shb_layers_tile(const shb_layers *layers, const shb_draw_desc *desc,
                         const shb_target *target, bool counts);

/* Clears layers, which are those of the whole target and part of its images, and draws all chunks
 * into them. Adds how many triangles were drawn to *drawn, hidden ones if counts is set. false: out
 * of memory, the images are untouched. */
bool shb_chunk_whole_draw(shb_context *context, const shb_draw_desc *desc, const shb_target *target,
                          const shb_chunks *chunks, const shb_layers *layers, bool counts,
                          uint64_t *drawn);

#endif
