#include "strict.h"

#include "level_sort.h"
#include "map.h"

#include <string.h>

/* Triangles are put into tiles in so many parts at the same time. */
enum { TILE = SHB_SHEET_TILE, PARTS = 16 };

bool shb_sheet_bins_reserve(shb_context *context, const shb_map_info *info, size_t triangle_count,
                            shb_sheet_bins *bins) {
    shb_buffer *scratch = context->sheet_scratch;
    *bins = (shb_sheet_bins){.triangle_count = triangle_count,
                             .tile_columns = (info->width + TILE - 1) / TILE};
    bins->tile_count = bins->tile_columns * ((info->height + TILE - 1) / TILE);
    bins->boxes =
        shb_buffer_reserve(context, &scratch[SHB_SHEET_BOXES], triangle_count, sizeof *bins->boxes);
    bins->ends = shb_buffer_reserve(context, &scratch[SHB_SHEET_ENDS], bins->tile_count,
                                    PARTS * sizeof *bins->ends);
    return bins->boxes && bins->ends;
}

/* The first triangle of a part. */
static size_t begin_of(const shb_sheet_bins *bins, size_t part) {
    return bins->triangle_count / PARTS * part + bins->triangle_count % PARTS * part / PARTS;
}

/* Counts the triangles of a part in all tiles, or writes them behind the ends, which it moves. */
static void put_part(const shb_sheet_bins *bins, size_t part, bool writes) {
    for (size_t id = begin_of(bins, part); id < begin_of(bins, part + 1); id++) {
        const shb_list_box *box = &bins->boxes[id].box;
        if (shb_list_box_is_none(box))
            continue;
        for (size_t row = box->first_row / TILE; row <= box->last_row / TILE; row++)
            for (size_t column = box->first_column / TILE; column <= box->last_column / TILE;
                 column++) {
                size_t *end = &bins->ends[(row * bins->tile_columns + column) * PARTS + part];
                if (writes)
                    bins->keys[*end] = id;
                ++*end;
            }
    }
}

static void count_part(void *arg, size_t part) {
    put_part(arg, part, false);
}

static void write_part(void *arg, size_t part) {
    put_part(arg, part, true);
}

bool shb_sheet_bins_fill(shb_context *context, shb_sheet_bins *bins) {
    const size_t parts = bins->tile_count * PARTS;
    memset(bins->ends, 0, parts * sizeof *bins->ends);
    shb_parallel_for(context, count_part, bins, PARTS);
    size_t all = 0;
    for (size_t i = 0; i < parts; i++) {
        const size_t count = bins->ends[i];
        bins->ends[i] = all;
        all += count;
    }
    shb_buffer *scratch = context->sheet_scratch;
    bins->keys = shb_buffer_reserve(context, &scratch[SHB_SHEET_KEYS], all, sizeof *bins->keys);
    bins->spare = shb_buffer_reserve(context, &scratch[SHB_SHEET_SPARE], all, sizeof *bins->spare);
    if (!bins->keys || !bins->spare)
        return false;
    shb_parallel_for(context, write_part, bins, PARTS);
    return true;
}

static uint64_t key_of(const shb_list_frame *frame, const shb_light_box *box, uint64_t id) {
    const double level = ((double)box->nearest - frame->level_origin) * frame->levels;
    const double limited = level < SHB_LIST_LEVELS - 1 ? level : SHB_LIST_LEVELS - 1;
    return (uint64_t)(limited > 0 ? limited : 0) << 32 | id;
}

const uint64_t *shb_sheet_bin(const shb_sheet_bins *bins, const shb_list_frame *frame, size_t tile,
                              size_t *count) {
    const size_t begin = tile ? bins->ends[tile * PARTS - 1] : 0;
    uint64_t *keys = bins->keys + begin;
    *count = bins->ends[(tile + 1) * PARTS - 1] - begin;
    for (size_t i = 0; i < *count; i++)
        keys[i] = key_of(frame, &bins->boxes[keys[i]], keys[i]);
    shb_sort_by_level(*count, keys, bins->spare + begin);
    return keys;
}
