/* Which triangles reach which tile: for every tile a list of ids in rising order. */
#ifndef SRC_BIN_H
#define SRC_BIN_H

#include "setup.h"

typedef struct shb_bins {
    uint32_t tile_size;
    uint32_t columns, rows; /* of tiles */
    const size_t *ends;     /* the list of tile t starts where that of tile t - 1 ends */
    const uint32_t *ids;
} shb_bins;

/* Prepares every triangle once, counts what became of it and fills the lists in the context's
 * scratch; false: out of memory. */
bool shb_bin_triangles(shb_context *context, const shb_geometry *geometry, const shb_target *target,
                       uint32_t tile_size, shb_bins *bins, shb_draw_stats *stats);

#endif
