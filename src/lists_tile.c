#include "lists_tile.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "level_sort.h"
#include "lists_scratch.h"

/* A tile has at least one cell for so many of its triangles, but no more cells than texels. With
 * one for four, lists in a map of 1024 take 1.05 to 1.3 times as long to build and nearly as long
 * to ask; with one for sixteen, those of a height field of 180 thousand triangles an eighth longer
 * to ask. */
enum { TRIANGLES_PER_CELL = 8 };

/* Room for entries that does for nearly every tile; where it does not, cells are larger. */
enum { ENTRIES = (1 << 17) + 320 }; /* no multiple of a page, so that arrays do not collide */

typedef struct tile_job {
    shb_lists *lists;
    const shb_list_bins *bins;
    size_t room;
    shb_list_cover *covers; /* of each lane */
    uint64_t *spare;        /* the largest tile's keys for each lane */
    atomic_size_t next_tile, next_entry;
} tile_job;

static size_t cells_of(int cell_bits) {
    const size_t side = SHB_LIST_TILE >> cell_bits;
    return side * side;
}

static int cell_bits_for(size_t triangles) {
    int bits = 0;
    while ((SHB_LIST_TILE >> (bits + 1)) >= SHB_LIST_BLOCK &&
           TRIANGLES_PER_CELL * cells_of(bits + 1) >= triangles)
        bits++;
    return bits;
}

size_t shb_list_tiles_divide(shb_lists *lists, const shb_list_bins *bins) {
    shb_list_tile *tiles = lists->tiles;
    size_t cells = 0;
    for (size_t i = 0; i < bins->tiles; i++) {
        size_t count;
        shb_list_bin(bins, i, &count);
        tiles[i] = (shb_list_tile){.first_cell = cells, .cell_bits = -1};
        if (count == 0)
            continue;
        tiles[i].cell_bits = lists->sheets.bounds ? SHB_LIST_BLOCK_BITS : cell_bits_for(count);
        cells += cells_of(tiles[i].cell_bits) + 1;
    }
    return cells;
}

/* Writes the bounds of a tile's texels; of those of a tile without triangles nothing is known. */
static void write_bounds(const shb_lists *lists, const shb_list_tile *tile,
                         const shb_list_cover *cover) {
    const shb_sheets *sheets = &lists->sheets;
    const uint32_t columns = sheets->width - cover->column, rows = sheets->height - cover->row;
    const uint32_t count = columns < SHB_LIST_TILE ? columns : SHB_LIST_TILE;
    for (uint32_t row = 0; row < rows && row < SHB_LIST_TILE; row++) {
        float *bounds = sheets->bounds + (cover->row + row) * sheets->stride + cover->column;
        if (tile->cell_bits >= 0)
            memcpy(bounds, cover->bounds + row * SHB_LIST_TILE, count * sizeof *bounds);
        else
            for (uint32_t column = 0; column < count; column++)
                bounds[column] = HUGE_VALF;
    }
}

/* Makes cells and entries of a tile that has triangles. */
static void cover_tile(tile_job *job, size_t number, shb_list_cover *cover, uint64_t *spare) {
    shb_lists *lists = job->lists;
    shb_list_tile *tile = &lists->tiles[number];
    const shb_list_kernels *kernels = shb_list_kernels_of(lists->context->isa);
    uint64_t *keys = shb_list_bin(job->bins, number, &cover->count);
    shb_sort_by_level(cover->count, keys, spare);
    cover->keys = keys;
    cover->cells = lists->cells + tile->first_cell;
    for (cover->cell_bits = tile->cell_bits; !kernels->cover(cover);)
        cover->cell_bits++;
    tile->cell_bits = cover->cell_bits;
    const size_t count = cover->unsorted.count;
    tile->first_entry = atomic_fetch_add(&job->next_entry, count);
    if (tile->first_entry <= job->room && count <= job->room - tile->first_entry)
        memcpy(lists->entries + tile->first_entry, cover->entries, count * sizeof *cover->entries);
}

static void fill_tile(tile_job *job, size_t number, shb_list_cover *cover, uint64_t *spare) {
    const shb_lists *lists = job->lists;
    cover->column = (uint32_t)(number % lists->tile_columns) * SHB_LIST_TILE;
    cover->row = (uint32_t)(number / lists->tile_columns) * SHB_LIST_TILE;
    if (lists->tiles[number].cell_bits >= 0)
        cover_tile(job, number, cover, spare);
    if (cover->with_sheets)
        write_bounds(lists, &lists->tiles[number], cover);
}

static void run_lane(void *arg, size_t lane) {
    tile_job *job = arg;
    for (size_t tile; (tile = atomic_fetch_add(&job->next_tile, 1)) < job->bins->tiles;)
        fill_tile(job, tile, &job->covers[lane], job->spare + lane * job->bins->largest);
}

/* Entries take two words each when they are sorted and three before. */
static void begin_cover(const tile_job *job, uint32_t *words, size_t capacity,
                        shb_list_cover *cover) {
    cover->triangles = job->lists->triangles;
    cover->frame = &job->lists->frame;
    cover->boxes = job->bins->shapes.boxes;
    cover->outlines = job->bins->shapes.outlines;
    cover->with_sheets = job->lists->sheets.bounds != NULL;
    cover->entries = (shb_list_entry *)words;
    cover->unsorted = (shb_list_unsorted){.triangles = words + 2 * capacity,
                                          .cells = words + 3 * capacity,
                                          .begins = (float *)(words + 4 * capacity),
                                          .capacity = capacity};
}

bool shb_list_tiles_fill(shb_lists *lists, const shb_list_bins *bins, size_t room,
                         size_t *entries) {
    shb_context *context = lists->context;
    shb_buffer *scratch = context->list_scratch;
    const size_t lanes = context->threads < bins->tiles ? context->threads : bins->tiles;
    /* The largest cells take as many entries as this at most, and what is written too much. */
    const size_t most = (bins->largest + 2) * SHB_LIST_LANES;
    const size_t capacity = most > ENTRIES ? most : ENTRIES;
    tile_job job = {.lists = lists, .bins = bins, .room = room};
    job.covers = shb_buffer_reserve(context, &scratch[SHB_LIST_COVERS], lanes, sizeof *job.covers);
    job.spare = shb_buffer_reserve(context, &scratch[SHB_LIST_SPARE], lanes,
                                   (bins->largest + 1) * sizeof *job.spare);
    uint32_t *words = shb_buffer_reserve(context, &scratch[SHB_LIST_UNSORTED], lanes,
                                         5 * capacity * sizeof *words);
    if (!job.covers || !job.spare || !words)
        return false;
    for (size_t i = 0; i < lanes; i++)
        begin_cover(&job, words + 5 * i * capacity, capacity, &job.covers[i]);
    atomic_init(&job.next_tile, 0);
    atomic_init(&job.next_entry, 0);
    shb_parallel_for(context, run_lane, &job, lanes);
    *entries = atomic_load(&job.next_entry);
    return true;
}
