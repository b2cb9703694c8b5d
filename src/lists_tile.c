#include "lists_tile.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "level_sort.h"
#include "lists_scratch.h"

/* A tile has at least a cell for so many of its triangles, as long as it has fewer than texels.
 * With one for four, lists in a map of 1024 take 1.05 to 1.3 times as long to build and nearly as
 * long to ask; with one for sixteen, those of a height field of 180 thousand triangles an eighth
 * longer to ask. */
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

bool shb_list_tiles_fill(shb_lists *lists, const shb_list_bins *bins, size_t room,
                         size_t *entries) {
    shb_context *context = lists->context;
    shb_buffer *scratch = context->list_scratch;
    const size_t lanes = context->threads < bins->tiles ? context->threads : bins->tiles;
    /* The largest cells take as many entries as this at most, and what is written too much. */
    const size_t most = (bins->largest + 2) * SHB_LIST_LANES;
    const size_t room_of_lane = most > ENTRIES ? most : ENTRIES;
    if (!shb_buffer_reserve(context, &scratch[SHB_LIST_COVERS], lanes, sizeof(shb_list_cover)) ||
        !shb_buffer_reserve(context, &scratch[SHB_LIST_SPARE], lanes,
                            (bins->largest + 1) * sizeof(uint64_t)) ||
        !shb_buffer_reserve(context, &scratch[SHB_LIST_UNSORTED], lanes * 5,
                            room_of_lane * sizeof(uint32_t)))
        return false;
    tile_job job = {.lists = lists,
                    .bins = bins,
                    .room = room,
                    .covers = scratch[SHB_LIST_COVERS].data,
                    .spare = scratch[SHB_LIST_SPARE].data};
    for (size_t i = 0; i < lanes; i++) {
        job.covers[i].triangles = lists->triangles;
        job.covers[i].frame = &lists->frame;
        job.covers[i].boxes = bins->shapes.boxes;
        job.covers[i].outlines = bins->shapes.outlines;
        job.covers[i].with_sheets = lists->sheets.bounds != NULL;
        uint32_t *memory = (uint32_t *)scratch[SHB_LIST_UNSORTED].data + 5 * i * room_of_lane;
        job.covers[i].entries = (shb_list_entry *)memory;
        job.covers[i].unsorted = (shb_list_unsorted){
            .triangles = memory + 2 * room_of_lane,
            .cells = memory + 3 * room_of_lane,
            .begins = (float *)(memory + 4 * room_of_lane),
            .capacity = room_of_lane,
        };
    }
    atomic_init(&job.next_tile, 0);
    atomic_init(&job.next_entry, 0);
    shb_parallel_for(context, run_lane, &job, lanes);
    *entries = atomic_load(&job.next_entry);
    return true;
}
