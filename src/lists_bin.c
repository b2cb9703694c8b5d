#include "lists_bin.h"

#include <string.h>

#include "lists_scratch.h"

typedef struct bin_job {
    const shb_list_loading *loading;
    shb_list_bins *bins;
} bin_job;

static void part_of(const bin_job *job, size_t part, uint32_t *begin, uint32_t *end) {
    const uint64_t count = job->loading->lists->id_count;
    *begin = (uint32_t)(count * part / SHB_LIST_PARTS);
    *end = (uint32_t)(count * (part + 1) / SHB_LIST_PARTS);
}

static inline void put(const shb_list_bins *bins, size_t *end, uint64_t key, bool writes) {
    if (writes)
        bins->keys[*end] = key;
    ++*end;
}

/* Counts the triangles of a part in their tiles, or writes their keys where those counts have made
 * room. Nearly all lie in one tile. */
static inline void bin_part(const bin_job *job, size_t part, bool writes) {
    const size_t columns = job->loading->lists->tile_columns;
    const shb_list_bins *bins = job->bins;
    size_t *ends = bins->ends + part * bins->tiles;
    uint32_t id, end;
    part_of(job, part, &id, &end);
    for (; id < end; id++) {
        const shb_list_box *box = &bins->shapes.boxes[id];
        const uint64_t key = writes ? (uint64_t)bins->shapes.levels[id] << 32 | id : 0;
        const int rows = box->first_row ^ box->last_row;
        const int across = box->first_column ^ box->last_column;
        size_t row = box->first_row / SHB_LIST_TILE, column = box->first_column / SHB_LIST_TILE;
        if ((rows | across) < SHB_LIST_TILE) {
            put(bins, &ends[row * columns + column], key, writes);
            continue;
        }
        for (; row <= box->last_row / SHB_LIST_TILE; row++)
            for (size_t i = column; i <= box->last_column / SHB_LIST_TILE; i++)
                put(bins, &ends[row * columns + i], key, writes);
    }
}

static void load_and_count(void *arg, size_t part) {
    const bin_job *job = arg;
    uint32_t begin, end;
    part_of(job, part, &begin, &end);
    shb_list_load_triangles(job->loading, begin, end, &job->bins->shapes);
    bin_part(job, part, false);
}

static void write_keys(void *arg, size_t part) {
    bin_part(arg, part, true);
}

/* Counts to the places where each begins; returns the total. */
static size_t sum_up(shb_list_bins *bins) {
    size_t sum = 0;
    bins->largest = 0;
    for (size_t tile = 0; tile < bins->tiles; tile++) {
        const size_t first = sum;
        for (size_t part = 0; part < SHB_LIST_PARTS; part++) {
            size_t *count = &bins->ends[part * bins->tiles + tile];
            const size_t here = *count;
            *count = sum;
            sum += here;
        }
        bins->largest = sum - first > bins->largest ? sum - first : bins->largest;
    }
    return sum;
}

/* Vectors read a box more than there are. */
static bool reserve_shapes(const shb_list_loading *loading, shb_list_shapes *shapes) {
    const shb_context *context = loading->lists->context;
    shb_buffer *scratch = loading->lists->context->list_scratch;
    const size_t count = loading->lists->id_count;
    *shapes =
        (shb_list_shapes){.boxes = shb_buffer_reserve(context, &scratch[SHB_LIST_BOXES], count + 1,
                                                      sizeof *shapes->boxes),
                          .levels = shb_buffer_reserve(context, &scratch[SHB_LIST_TRIANGLE_LEVELS],
                                                       count, sizeof *shapes->levels)};
    if (loading->names)
        shapes->outlines = shb_buffer_reserve(context, &scratch[SHB_LIST_OUTLINES], count,
                                              sizeof *shapes->outlines);
    return shapes->boxes && shapes->levels && (shapes->outlines || !loading->names);
}

bool shb_list_bins_fill(const shb_list_loading *loading, shb_list_bins *bins) {
    shb_lists *lists = loading->lists;
    shb_buffer *scratch = lists->context->list_scratch;
    bins->tiles = (size_t)lists->tile_columns * lists->tile_rows;
    const size_t places = bins->tiles * SHB_LIST_PARTS;
    bins->ends =
        shb_buffer_reserve(lists->context, &scratch[SHB_LIST_ENDS], places, sizeof *bins->ends);
    if (!bins->ends || !reserve_shapes(loading, &bins->shapes))
        return false;
    memset(bins->ends, 0, places * sizeof *bins->ends);
    bin_job job = {loading, bins};
    shb_parallel_for(lists->context, load_and_count, &job, SHB_LIST_PARTS);
    const size_t total = sum_up(bins);
    bins->keys =
        shb_buffer_reserve(lists->context, &scratch[SHB_LIST_KEYS], total, sizeof *bins->keys);
    if (!bins->keys)
        return false;
    shb_parallel_for(lists->context, write_keys, &job, SHB_LIST_PARTS);
    return true;
}
