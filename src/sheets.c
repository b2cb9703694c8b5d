/* Where the front of a texel begins is a guess, the rest is proof: at the depth of the nearest
 * triangle at its centre, which the map tells. Triangles are laid front to back: each that begins
 * before the front's end joins the front, which may end later by it, and the others wait behind it.
 * (The order is of their nearest depths anywhere, and so a guess, too: where a triangle waited that
 * the front then reaches, the texel is not whole.) */
#include "strict.h"

#include "map.h"

#include "format.h"
#include "kernels/sheets.h"
#include "padded_rows.h"

enum { TILE = SHB_SHEET_TILE, PITCH = SHB_SHEET_PITCH, LANES = SHB_LIST_LANES };

/* The most that rounding of a point's coordinates may move it in the map, texels. */
#define MARGIN 0x1p-5

typedef struct sheet_job {
    const shb_map *map;
    const shb_light_mesh *mesh;
    const shb_sheet_bins *bins;
    const shb_sheet_kernels *kernels;
    shb_sheets *sheets;
} sheet_job;

/* X moves by (rounding x w + |X| rounding w) / w', where w' is the moved point's: at most 2^-10
 * smaller. */
shb_sheet_frame shb_sheet_frame_of(const shb_list_frame *list, double margin) {
    shb_sheet_frame frame = {.list = *list, .margin = margin};
    const double w = shb_list_row_rounding(list, 3);
    const double x = shb_list_row_rounding(list, 0) + (list->width + 1) * w;
    const double y = shb_list_row_rounding(list, 1) + (list->height + 1) * w;
    const double by_margin = (x > y ? x : y) * (1 + 0x1p-9) / margin;
    frame.least_w = by_margin > 0x1p10 * w ? by_margin : 0x1p10 * w;
    frame.reach = list->reach * (1 + 0x1p-22);
    return frame;
}

static void begin_tile(const sheet_job *job, size_t index, shb_sheet_tile *tile) {
    const shb_map *map = job->map;
    const uint32_t column = (uint32_t)(index % job->bins->tile_columns) * TILE;
    const uint32_t row = (uint32_t)(index / job->bins->tile_columns) * TILE;
    const uint32_t columns = map->info.width - column, rows = map->info.height - row;
    const bool reversed = map->info.view.reversed;
    tile->frame = &job->sheets->frame;
    tile->column = (int32_t)column;
    tile->row = (int32_t)row;
    tile->columns = columns < TILE ? (int32_t)columns : TILE;
    tile->rows = rows < TILE ? (int32_t)rows : TILE;
    for (int32_t k = 0; k < tile->rows; k++) {
        const char *texels =
            (const char *)map->depth.texels + (row + (size_t)k) * map->depth.stride;
        shb_format_load(map->info.format, reversed, (size_t)tile->columns,
                        texels + column * shb_format_size(map->info.format),
                        tile->front + k * PITCH);
    }
    job->kernels->begin(tile, shb_far_depth(reversed));
}

/* A triangle of which nothing is known but its box. */
static void break_box(shb_sheet_tile *tile, const shb_light_box *box) {
    for (int32_t row = 0; row < tile->rows; row++)
        for (int32_t i = 0; i < tile->columns; i++) {
            const int32_t x = tile->column + i, y = tile->row + row;
            if (x >= box->box.first_column && x <= box->box.last_column &&
                y >= box->box.first_row && y <= box->box.last_row)
                tile->state[row * PITCH + i] = SHB_SHEET_BROKEN;
        }
}

/* Triangles that wait for the kernel. */
typedef struct waiting {
    shb_list_corners corners;
    uint32_t ends[LANES];
    uint32_t count;
} waiting;

static void lay_waiting(const sheet_job *job, shb_sheet_tile *tile, waiting *w) {
    if (w->count)
        job->kernels->lay(tile, &w->corners, w->ends, w->count);
    w->count = 0;
}

static void add_triangle(const shb_light_mesh *mesh, uint32_t id, waiting *w) {
    shb_light_mesh_corners(mesh, id, w->count, &w->corners);
    w->ends[w->count] = 0;
    for (int k = 0; k < 3; k++)
        if (shb_light_mesh_beyond(mesh, id, k) == SHB_ID_NONE)
            w->ends[w->count] |= 1u << k;
    w->count++;
}

/* A triangle that begins behind all fronts, and all after it, change nothing of what is whole. */
static void make_tile(void *arg, size_t index) {
    enum { CHECKED = 64 };
    const sheet_job *job = arg;
    size_t count;
    const uint64_t *keys = shb_sheet_bin(job->bins, &job->mesh->frame, index, &count);
    shb_sheet_tile tile;
    waiting w = {.count = 0}; /* vectors are read as a whole */
    begin_tile(job, index, &tile);
    for (size_t i = 0; i < count; i++) {
        const uint32_t id = (uint32_t)keys[i];
        const shb_light_box *box = &job->bins->boxes[id];
        if (i % CHECKED == CHECKED - 1) {
            lay_waiting(job, &tile, &w);
            if (shb_list_level_depth(&job->mesh->frame, (double)(keys[i] >> 32)) >
                (double)job->kernels->farthest(&tile))
                break;
        }
        if (job->mesh->facing[id] == SHB_FACING_CUT)
            break_box(&tile, box);
        else
            add_triangle(job->mesh, id, &w);
        if (w.count == LANES)
            lay_waiting(job, &tile, &w);
    }
    lay_waiting(job, &tile, &w);
    for (int32_t row = 0; row < tile.rows; row++)
        job->kernels->end(&tile, row,
                          job->sheets->bounds + (size_t)(tile.row + row) * job->sheets->stride +
                              tile.column);
}

bool shb_sheets_create(const shb_map *map, shb_sheets *sheets) {
    *sheets =
        (shb_sheets){.width = map->info.width,
                     .height = map->info.height,
                     .stride = shb_padded_stride(map->info.width, sizeof(float)) / sizeof(float)};
    sheets->bounds =
        shb_alloc(map->context, sheets->height, sheets->stride * sizeof *sheets->bounds);
    return sheets->bounds != NULL;
}

void shb_sheets_destroy(const shb_context *context, shb_sheets *sheets) {
    shb_free(context, sheets->bounds);
}

void shb_sheets_find(shb_map *map, const shb_light_mesh *mesh, const shb_sheet_bins *bins) {
    shb_sheets *sheets = &map->occluders.sheets;
    sheet_job job = {map, mesh, bins, shb_sheet_kernels_of(map->context->isa), sheets};
    sheets->frame = shb_sheet_frame_of(&mesh->frame, MARGIN);
    shb_parallel_for(map->context, make_tile, &job, bins->tile_count);
}
