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

/* Counts a triangle in its tiles, or writes its number where those counts have made room. */
static void bin_triangle(const bin_job *job, uint32_t id, size_t part, uint32_t *numbers) {
    const shb_list_box *box = &job->bins->boxes[id];
    if (shb_list_box_is_none(box))
        return;
    const size_t columns = job->loading->lists->tile_columns;
    const size_t last_row = box->last_row / SHB_LIST_TILE;
    const size_t last_column = box->last_column / SHB_LIST_TILE;
    for (size_t row = box->first_row / SHB_LIST_TILE; row <= last_row; row++)
        for (size_t column = box->first_column / SHB_LIST_TILE; column <= last_column; column++) {
            size_t *place = &job->bins->ends[(row * columns + column) * SHB_LIST_PARTS + part];
            if (numbers)
                numbers[*place] = id;
            ++*place;
        }
}

static void load_and_count(void *arg, size_t part) {
    const bin_job *job = arg;
    uint32_t begin, end;
    part_of(job, part, &begin, &end);
    shb_list_load_triangles(job->loading, begin, end, job->bins->boxes, job->bins->outlines);
    for (uint32_t id = begin; id < end; id++)
        bin_triangle(job, id, part, NULL);
}

static void write_numbers(void *arg, size_t part) {
    const bin_job *job = arg;
    uint32_t begin, end;
    part_of(job, part, &begin, &end);
    for (uint32_t id = begin; id < end; id++)
        bin_triangle(job, id, part, job->bins->numbers);
}

/* Counts to the places where each begins; returns the total. */
static size_t sum_up(shb_list_bins *bins) {
    size_t sum = 0;
    bins->largest = 0;
    for (size_t tile = 0; tile < bins->tiles; tile++) {
        const size_t first = sum;
        for (size_t part = 0; part < SHB_LIST_PARTS; part++) {
            size_t *count = &bins->ends[tile * SHB_LIST_PARTS + part];
            const size_t here = *count;
            *count = sum;
            sum += here;
        }
        bins->largest = sum - first > bins->largest ? sum - first : bins->largest;
    }
    return sum;
}

bool shb_list_bins_fill(const shb_list_loading *loading, shb_list_bins *bins) {
    shb_lists *lists = loading->lists;
    shb_buffer *scratch = lists->context->list_scratch;
    bins->tiles = (size_t)lists->tile_columns * lists->tile_rows;
    const size_t places = bins->tiles * SHB_LIST_PARTS;
    if (!shb_buffer_reserve(lists->context, &scratch[SHB_LIST_BOXES], lists->id_count,
                            sizeof *bins->boxes) ||
        (loading->names && !shb_buffer_reserve(lists->context, &scratch[SHB_LIST_OUTLINES],
                                               lists->id_count, sizeof *bins->outlines)) ||
        !shb_buffer_reserve(lists->context, &scratch[SHB_LIST_ENDS], places, sizeof *bins->ends))
        return false;
    bins->boxes = scratch[SHB_LIST_BOXES].data;
    bins->outlines = loading->names ? scratch[SHB_LIST_OUTLINES].data : NULL;
    bins->ends = scratch[SHB_LIST_ENDS].data;
    memset(bins->ends, 0, places * sizeof *bins->ends);
    bin_job job = {loading, bins};
    shb_parallel_for(lists->context, load_and_count, &job, SHB_LIST_PARTS);
    const size_t total = sum_up(bins);
    if (!shb_buffer_reserve(lists->context, &scratch[SHB_LIST_NUMBERS], total,
                            sizeof *bins->numbers))
        return false;
    bins->numbers = scratch[SHB_LIST_NUMBERS].data;
    shb_parallel_for(lists->context, write_numbers, &job, SHB_LIST_PARTS);
    return true;
}
