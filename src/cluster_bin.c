#include "strict.h"

#include "cluster_bin.h"

#include "scratch.h"
#include "starts.h"

#include <string.h>

/* The length of every list, then the start of every list in its place. Returns the sum. */
static size_t find_starts(const shb_chunks *chunks, int row_bits, size_t rows, size_t *starts) {
    memset(starts, 0, rows * sizeof *starts);
    for (size_t i = chunks->plain_count; i < chunks->count; i++) {
        const shb_samples *samples = &chunks->chunks[i].cluster.samples;
        for (int32_t row = samples->first_row >> row_bits; row <= samples->last_row >> row_bits;
             row++)
            starts[row]++;
    }
    return shb_starts_of_lengths(rows, starts);
}

/* Every cluster moves its rows' cursors on, which end up at the ends of the lists. */
static void fill(const shb_chunks *chunks, int row_bits, size_t *cursors, uint32_t *listed) {
    for (size_t i = chunks->plain_count; i < chunks->count; i++) {
        const shb_samples *samples = &chunks->chunks[i].cluster.samples;
        for (int32_t row = samples->first_row >> row_bits; row <= samples->last_row >> row_bits;
             row++)
            listed[cursors[row]++] = (uint32_t)i;
    }
}

bool shb_clusters_bin(shb_context *context, const shb_chunks *chunks, int row_bits, size_t rows,
                      shb_cluster_bins *bins) {
    shb_buffer *scratch = context->draw_scratch;
    size_t *ends =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_CLUSTER_ENDS], rows, sizeof *ends);
    if (!ends)
        return false;
    const size_t entries = find_starts(chunks, row_bits, rows, ends);
    uint32_t *listed =
        shb_buffer_reserve(context, &scratch[SHB_SCRATCH_CLUSTER_ROWS], entries, sizeof *listed);
    if (!listed)
        return false;
    fill(chunks, row_bits, ends, listed);
    *bins = (shb_cluster_bins){ends, listed};
    return true;
}
