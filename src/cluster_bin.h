/* Which clusters reach which row of tiles. */
#ifndef SRC_CLUSTER_BIN_H
#define SRC_CLUSTER_BIN_H

#include "chunk.h"

typedef struct shb_cluster_bins {
    const size_t *ends;     /* of each row's list */
    const uint32_t *chunks; /* the lists of all rows: numbers of chunks, rising */
} shb_cluster_bins;

/* Bins the chunks that are clusters into rows of tiles of 2^row_bits samples. false: out of memory.
 */
bool shb_clusters_bin(shb_context *context, const shb_chunks *chunks, int row_bits, size_t rows,
                      shb_cluster_bins *bins);

#endif
