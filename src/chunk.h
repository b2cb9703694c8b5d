/* A scene cut into chunks for the kernels: vertices transformed once each, triangles in runs of
 * SHB_CHUNK; clusters that the view may see; and triangles that clipping has to look at in a list
 * of their own. */
#ifndef SRC_CHUNK_H
#define SRC_CHUNK_H

#include "kernels/raster.h"
#include "setup.h"

/* A triangle that one of its vertices keeps from the kernels, and that is drawn all the same. */
typedef struct shb_coded {
    uint32_t id;
    bool is_cut;
    shb_samples samples;
} shb_coded;

typedef struct shb_chunks {
    const shb_chunk *chunks;
    size_t count;
    size_t plain_count; /* the first ones; clusters follow */
    const shb_coded *coded;
    size_t coded_count;
    uint64_t not_finite;
} shb_chunks;

/* Everything lies in the context's scratch; false: out of memory. */
bool shb_chunks_prepare(shb_context *context, const shb_geometry *geometry,
                        const shb_target *target, shb_chunks *chunks);

#endif
