#include "strict.h"

#include "cluster_sort.h"

#include "scratch.h"
#include "starts.h"

#include <math.h>
#include <string.h>

/* How often the boxes of all clusters have to cover the target: those of a single layer do once or
 * twice. */
#define LAYERS_MIN 3

/* Ranges of depth; in more of them what is near in the target would be far in memory. */
#define RANGES 8

typedef struct depth_range {
    float nearest, farthest;
} depth_range;

static bool are_layered(const shb_target *target, size_t count, const shb_chunk *chunks) {
    const uint64_t columns = (uint64_t)target->samples.last_column + 1;
    const uint64_t rows = (uint64_t)target->samples.last_row + 1;
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        const shb_samples *box = &chunks[i].cluster.samples;
        sum += (uint64_t)(box->last_column - box->first_column + 1) *
               (uint64_t)(box->last_row - box->first_row + 1);
    }
    return sum > LAYERS_MIN * columns * rows;
}

/* Of all clusters whose nearest depth is known. */
static depth_range range_of(size_t count, const shb_chunk *chunks) {
    depth_range range = {HUGE_VALF, -HUGE_VALF};
    for (size_t i = 0; i < count; i++) {
        const float depth = chunks[i].cluster.nearest;
        if (depth == -HUGE_VALF)
            continue;
        range.nearest = depth < range.nearest ? depth : range.nearest;
        range.farthest = depth > range.farthest ? depth : range.farthest;
    }
    return range;
}

/* The number of the range that holds a depth. */
static size_t number_of(depth_range range, float depth) {
    const float step = (range.farthest - range.nearest) / RANGES;
    const float number = (depth - range.nearest) / step;
    return !(number > 0) ? 0 : number < RANGES ? (size_t)number : RANGES - 1;
}

bool shb_clusters_sort(shb_context *context, const shb_target *target, size_t count,
                       shb_chunk *chunks) {
    if (!are_layered(target, count, chunks))
        return true;
    shb_chunk *sorted = shb_buffer_reserve(context, &context->draw_scratch[SHB_SCRATCH_SORTED],
                                           count, sizeof *sorted);
    if (!sorted)
        return false;
    size_t places[RANGES] = {0};
    const depth_range range = range_of(count, chunks);
    for (size_t i = 0; i < count; i++)
        places[number_of(range, chunks[i].cluster.nearest)]++;
    shb_starts_of_lengths(RANGES, places);
    for (size_t i = 0; i < count; i++)
        sorted[places[number_of(range, chunks[i].cluster.nearest)]++] = chunks[i];
    memcpy(chunks, sorted, count * sizeof *chunks);
    return true;
}
