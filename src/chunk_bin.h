/* Which triangles of the chunks reach which tile.
 *
 * Chunks are binned in blocks of SHB_BLOCK_CHUNKS, each on its own: a block's triangles are sorted
 * by tile, in rising order of ids within a tile. A block of large triangles, which touch so many
 * tiles that its list would overflow, stays unsorted: all of its chunks are offered to every tile.
 */
#ifndef SRC_CHUNK_BIN_H
#define SRC_CHUNK_BIN_H

#include "chunk.h"

#define SHB_BLOCK_CHUNKS 16

/* A triangle in its block: number of the chunk in the block * SHB_CHUNK + number in the chunk. */
typedef uint16_t shb_binned;

typedef struct shb_chunk_bins {
    size_t blocks;
    uint32_t columns, rows; /* of tiles */
    const uint16_t *ends;   /* blocks * (tiles + 1); the last one of a block is 1 if it is sorted */
    const shb_binned *binned; /* SHB_BLOCK_CAPACITY for each block */
    uint64_t drawn;           /* triangles in all blocks */
} shb_chunk_bins;

#define SHB_BLOCK_CAPACITY (4 * SHB_BLOCK_CHUNKS * SHB_CHUNK)

/* Bins all chunks but clusters into tiles of the shape; false: out of memory. */
bool shb_chunks_bin(shb_context *context, const shb_target *target, const shb_chunks *chunks,
                    shb_tile_shape shape, shb_chunk_bins *bins);

#endif
