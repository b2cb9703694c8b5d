/* Building lists: vertices to the world and to the light, triangles prepared and sorted by tile,
 * and each tile's triangles, front to back, put into its cells. */
#include "strict.h"

#include "lists.h"

#include <string.h>

#include "lists_tile.h"
#include "padded_rows.h"

typedef struct build {
    shb_context *context;
    const shb_lists_desc *desc;
    shb_lists *lists;
    size_t vertex_count;
    size_t entries;
} build;

typedef enum outcome { FITS, TOO_LARGE, NO_MEMORY } outcome;

static void *reserve(const build *b, size_t number, size_t count, size_t size) {
    return shb_buffer_reserve(b->context, &b->context->list_scratch[number], count, size);
}

/* What does not depend on the size. */
static bool reserve_scene(build *b) {
    shb_lists *lists = b->lists;
    lists->triangles = reserve(b, SHB_LIST_TRIANGLES, lists->id_count, sizeof *lists->triangles);
    lists->corners = reserve(b, SHB_LIST_CORNERS, lists->id_count, sizeof *lists->corners);
    lists->vertices = reserve(b, SHB_LIST_WORLD, b->vertex_count + 1, sizeof *lists->vertices);
    return lists->triangles && lists->corners && lists->vertices;
}

static bool load(build *b, shb_list_bins *bins) {
    const size_t runs = shb_list_vertex_runs(b->vertex_count);
    const bool with_sheets = b->desc->with_sheets;
    const shb_list_loading loading = {
        .lists = b->lists,
        .scene = b->desc->scene,
        .vertices = reserve(b, SHB_LIST_VERTICES, b->vertex_count, sizeof(shb_list_vertex)),
        .names = with_sheets ? reserve(b, SHB_LIST_NAMES, b->vertex_count, sizeof(uint64_t)) : NULL,
        .vertex_count = b->vertex_count,
        .extents = reserve(b, SHB_LIST_EXTENTS, runs, sizeof(shb_list_extent)),
    };
    if (!loading.vertices || (with_sheets && !loading.names) || !loading.extents)
        return false;
    shb_list_load_vertices(&loading);
    return shb_list_bins_fill(&loading, bins);
}

/* Fills the tiles, once more where there turned out to be more entries than there was room for. */
static bool fill(build *b, const shb_list_bins *bins) {
    shb_lists *lists = b->lists;
    const shb_buffer *entries = &b->context->list_scratch[SHB_LIST_ENTRIES];
    for (b->entries = 0;;) {
        const size_t wanted = b->entries + b->entries / 8 + SHB_LIST_STEP;
        lists->entries = reserve(b, SHB_LIST_ENTRIES, wanted, sizeof *lists->entries);
        if (!lists->entries)
            return false;
        const size_t room = entries->size / sizeof *lists->entries - SHB_LIST_STEP;
        if (!shb_list_tiles_fill(lists, bins, room, &b->entries))
            return false;
        if (b->entries <= room)
            break;
    }
    memset(lists->entries + b->entries, 0, SHB_LIST_STEP * sizeof *lists->entries);
    return true;
}

static size_t memory_of(const build *b, size_t tiles, size_t cells) {
    const shb_lists *lists = b->lists;
    return sizeof *lists + tiles * sizeof *lists->tiles + cells * sizeof *lists->cells +
           b->entries * sizeof *lists->entries +
           lists->id_count * (sizeof *lists->triangles + sizeof *lists->corners) +
           b->vertex_count * sizeof *lists->vertices +
           lists->sheets.stride * lists->sheets.height * sizeof *lists->sheets.bounds;
}

/* Rows have a cache line more than they need: vectors may read behind them. */
static bool reserve_sheets(build *b) {
    shb_lists *lists = b->lists;
    shb_sheets *sheets = &lists->sheets;
    if (!b->desc->with_sheets)
        return true;
    sheets->width = lists->width;
    sheets->height = lists->height;
    sheets->stride = shb_padded_stride(lists->width, sizeof(float)) / sizeof(float);
    sheets->bounds =
        reserve(b, SHB_LIST_BOUNDS, lists->height, sheets->stride * sizeof *sheets->bounds);
    return sheets->bounds != NULL;
}

static outcome build_size(build *b) {
    shb_lists *lists = b->lists;
    const size_t cap = b->desc->memory_cap;
    lists->tile_columns = (lists->width + SHB_LIST_TILE - 1) / SHB_LIST_TILE;
    lists->tile_rows = (lists->height + SHB_LIST_TILE - 1) / SHB_LIST_TILE;
    const size_t tiles = (size_t)lists->tile_columns * lists->tile_rows;
    shb_list_bins bins;
    lists->tiles = reserve(b, SHB_LIST_TILES, tiles, sizeof *lists->tiles);
    if (!lists->tiles || !reserve_sheets(b) || !load(b, &bins))
        return NO_MEMORY;
    lists->sheets.frame = shb_sheet_frame_of(&lists->frame, SHB_LIST_POINT_MARGIN);
    const size_t cells = shb_list_tiles_divide(lists, &bins);
    lists->cells = reserve(b, SHB_LIST_CELLS, cells, sizeof *lists->cells);
    if (!lists->cells || !fill(b, &bins))
        return NO_MEMORY;
    lists->memory_bytes = memory_of(b, tiles, cells);
    return cap && lists->memory_bytes > cap ? TOO_LARGE : FITS;
}

static uint32_t half_of(uint32_t size) {
    return size > 1 ? size / 2 : 1;
}

static shb_result no_memory(const build *b) {
    return shb_fail(b->context, SHB_ERROR_MEMORY, "%s: no memory for lists of %lu triangles",
                    b->desc->caller, (unsigned long)b->lists->id_count);
}

/* Builds at the largest size that fits. */
static shb_result build_lists(build *b) {
    const shb_lists_desc *desc = b->desc;
    shb_lists *lists = b->lists;
    b->vertex_count = shb_list_vertex_count(desc->scene);
    if (b->vertex_count > UINT32_MAX)
        return shb_fail(b->context, SHB_ERROR_SIZE, "%s: lists cannot hold %zu vertices",
                        desc->caller, b->vertex_count);
    if (!reserve_scene(b))
        return no_memory(b);
    for (;;) {
        const shb_result result =
            shb_list_frame_init(desc->view, lists->width, lists->height, &lists->frame);
        if (result)
            return shb_fail(b->context, result, "%s: the view has no light", desc->caller);
        if (desc->with_sheets)
            lists->frame.rim = SHB_LIST_POINT_MARGIN + 2 * SHB_LIST_CORNER;
        const outcome found = build_size(b);
        if (found == FITS)
            return SHB_OK;
        if (found == NO_MEMORY)
            return no_memory(b);
        if (lists->width == 1 && lists->height == 1)
            return shb_fail(b->context, SHB_ERROR_MEMORY,
                            "%s: lists of one texel take %zu bytes, desc.occluder_memory is %zu",
                            desc->caller, lists->memory_bytes, desc->memory_cap);
        lists->width = half_of(lists->width);
        lists->height = half_of(lists->height);
    }
}

shb_result shb_lists_build(shb_context *context, const shb_lists_desc *desc, shb_lists **lists) {
    shb_lists *made = shb_alloc(context, 1, sizeof *made);
    if (!made)
        return shb_fail(context, SHB_ERROR_MEMORY, "%s: no memory for lists", desc->caller);
    *made = (shb_lists){.context = context,
                        .width = desc->width,
                        .height = desc->height,
                        .id_count = (uint32_t)shb_scene_triangle_count(desc->scene)};
    build b = {.context = context, .desc = desc, .lists = made};
    const shb_result result = build_lists(&b);
    if (result) {
        shb_free(context, made);
        return result;
    }
    shb_buffers_move(SHB_LIST_KEPT, context->list_scratch, made->memory);
    *lists = made;
    return SHB_OK;
}

void shb_lists_recycle(shb_lists *lists) {
    if (!lists)
        return;
    shb_context *context = lists->context;
    for (size_t i = 0; i < SHB_LIST_KEPT; i++) {
        shb_buffer *kept = &context->list_scratch[i];
        if (kept->size >= lists->memory[i].size)
            continue;
        const shb_buffer smaller = *kept;
        *kept = lists->memory[i];
        lists->memory[i] = smaller;
    }
    shb_lists_destroy(lists);
}

void shb_lists_destroy(shb_lists *lists) {
    if (!lists)
        return;
    shb_buffers_free(lists->context, SHB_LIST_KEPT, lists->memory);
    shb_free(lists->context, lists);
}

shb_triangle shb_lists_triangle(const shb_lists *lists, uint32_t id) {
    shb_triangle triangle = {.id = id};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            triangle.corners[k][i] = lists->vertices[lists->corners[id][k]][i];
    return triangle;
}
