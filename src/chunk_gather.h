/* Triangles from many chunks, gathered into full ones for a tile. */
#ifndef SRC_CHUNK_GATHER_H
#define SRC_CHUNK_GATHER_H

#include "kernels/raster.h"

typedef struct shb_gatherer {
    const shb_kernels *kernels;
    const shb_tile *tile;
    bool nearest_first; /* draw each full chunk in this order: large triangles hide others then */
    shb_chunk chunk;
    uint32_t triangles[SHB_CHUNK];
} shb_gatherer;

/* Adds triangle number t of a chunk and draws what is full. */
void shb_gather(shb_gatherer *gatherer, const shb_chunk *from, uint32_t t);

/* Draws what is left. */
void shb_gather_flush(shb_gatherer *gatherer);

#endif
