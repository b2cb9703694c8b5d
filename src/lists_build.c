/* Building lists: corners to the world, triangles to the light, sorted front to back and binned
 * into tiles; the tiles count their entries, and write them when the places are known. */
#include "strict.h"

#include "lists.h"

#include <math.h>
#include <string.h>

#include "lists_sort.h"
#include "lists_tile.h"
#include "scene.h"

/* Triangles of a task. */
enum { RUN = 1024 };

/* Triangles that are fetched before they are used: in the order of depth they are far apart. */
enum { AHEAD = 8 };

/* Parts of all triangles that are binned at the same time. */
enum { BIN_PARTS = 16 };

enum { TILE_TEXELS = SHB_LIST_TILE * SHB_LIST_TILE };

typedef struct build {
    shb_context *context;
    const shb_scene *scene;
    shb_lists *lists;
    double *reaches; /* of each run of ids */
    /* by id */
    shb_list_box *source_boxes;
    shb_list_key *keys, *spare_keys; /* what the view does not see has the id SHB_ID_NONE */
    /* by nearest depth */
    shb_list_box *boxes;
    /* bins: numbers of triangles by tile, in each tile by part */
    size_t tiles;
    size_t *bin_ends; /* of tile * BIN_PARTS + part */
    uint32_t *numbers;
    size_t *tile_starts; /* of each tile's entries; one more for the end of the last */
} build;

static void run_of(size_t index, uint32_t count, uint32_t *begin, uint32_t *end) {
    *begin = (uint32_t)(index * RUN);
    *end = count - *begin < RUN ? count : *begin + RUN;
}

static void load_corner(const shb_mat4 *transform, const float *p, double corner[3]) {
    const shb_vec3 position = {(double)p[0], (double)p[1], (double)p[2]};
    const shb_vec3 world = shb_mat4_transform_point(*transform, position);
    corner[0] = world.x;
    corner[1] = world.y;
    corner[2] = world.z;
}

static bool is_finite(const shb_triangle *triangle) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (!isfinite(triangle->corners[k][i]))
                return false;
    return true;
}

static double reach_of(const shb_triangle *triangle, double reach) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            reach = fabs(triangle->corners[k][i]) > reach ? fabs(triangle->corners[k][i]) : reach;
    return reach;
}

static void load_run(void *arg, size_t index) {
    const build *b = arg;
    uint32_t id, end, first;
    run_of(index, b->lists->id_count, &id, &end);
    size_t number = shb_scene_instance_of(b->scene, id, &first);
    double reach = 0;
    while (id < end) {
        const shb_instance *instance = &b->scene->instances[number++];
        const shb_mat4 transform = shb_instance_transform(instance);
        const uint32_t after = first + instance->mesh->triangle_count;
        for (; id < end && id < after; id++) {
            shb_triangle *triangle = &b->lists->source[id];
            uint32_t vertices[3];
            shb_mesh_triangle(instance->mesh, id - first, vertices);
            for (int k = 0; k < 3; k++)
                load_corner(&transform, shb_mesh_position(instance->mesh, vertices[k]),
                            triangle->corners[k]);
            triangle->id = is_finite(triangle) ? id : SHB_ID_NONE;
            if (triangle->id == id)
                reach = reach_of(triangle, reach);
        }
        first = after;
    }
    b->reaches[index] = reach;
}

static void bound_run(void *arg, size_t index) {
    const build *b = arg;
    uint32_t begin, end;
    run_of(index, b->lists->id_count, &begin, &end);
    for (uint32_t id = begin; id < end; id++) {
        const shb_triangle *triangle = &b->lists->source[id];
        float nearest;
        const bool seen =
            triangle->id == id && shb_list_triangle_bounds(&b->lists->frame, triangle->corners,
                                                           &b->source_boxes[id], &nearest);
        b->keys[id] =
            seen ? (shb_list_key){shb_list_depth_key(nearest), id} : (shb_list_key){0, SHB_ID_NONE};
    }
}

/* Drops what the view does not see, and sorts. */
static void order_triangles(build *b) {
    uint32_t kept = 0;
    for (uint32_t id = 0; id < b->lists->id_count; id++) {
        if (b->keys[id].id != SHB_ID_NONE)
            b->keys[kept++] = b->keys[id];
    }
    b->lists->count = kept;
    shb_list_sort(b->keys, b->spare_keys, kept);
}

static float depth_of_key(uint32_t key) {
    const uint32_t bits = key & 0x80000000u ? key & 0x7fffffffu : ~key;
    float depth;
    memcpy(&depth, &bits, sizeof depth);
    return depth;
}

static void fetch_source(const build *b, uint32_t id) {
    const char *triangle = (const char *)&b->lists->source[id];
    __builtin_prefetch(triangle);
    __builtin_prefetch(triangle + sizeof(shb_triangle) - 1);
    __builtin_prefetch(&b->source_boxes[id]);
}

static void prepare_run(void *arg, size_t index) {
    const build *b = arg;
    shb_lists *lists = b->lists;
    uint32_t begin, end;
    run_of(index, lists->count, &begin, &end);
    for (uint32_t i = begin; i < end; i++) {
        const shb_list_key key = b->keys[i];
        if (i + AHEAD < end)
            fetch_source(b, b->keys[i + AHEAD].id);
        b->boxes[i] = b->source_boxes[key.id];
        shb_list_triangle_prepare(&lists->frame, &lists->source[key.id], &b->boxes[i],
                                  depth_of_key(key.depth), &lists->triangles[i]);
    }
}

/* Counts the triangles of a part by tile, or writes their numbers where those counts have made
 * room.
 */
static void bin_part(const build *b, size_t part) {
    const size_t columns = b->lists->tile_columns;
    const uint64_t count = b->lists->count;
    const uint32_t begin = (uint32_t)(count * part / BIN_PARTS);
    const uint32_t end = (uint32_t)(count * (part + 1) / BIN_PARTS);
    for (uint32_t i = begin; i < end; i++) {
        const shb_list_box *box = &b->boxes[i];
        const size_t last_row = box->last_row / SHB_LIST_TILE;
        const size_t last_column = box->last_column / SHB_LIST_TILE;
        for (size_t row = box->first_row / SHB_LIST_TILE; row <= last_row; row++)
            for (size_t column = box->first_column / SHB_LIST_TILE; column <= last_column;
                 column++) {
                size_t *place = &b->bin_ends[(row * columns + column) * BIN_PARTS + part];
                if (b->numbers)
                    b->numbers[*place] = i;
                ++*place;
            }
    }
}

static void bin_part_task(void *arg, size_t part) {
    bin_part(arg, part);
}

/* Counts to the places where each begins; returns the total. */
static size_t sum_up(size_t *counts, size_t count) {
    size_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t here = counts[i];
        counts[i] = sum;
        sum += here;
    }
    return sum;
}

static bool bin_triangles(build *b) {
    const size_t bins = b->tiles * BIN_PARTS;
    b->bin_ends = shb_alloc(b->context, bins, sizeof *b->bin_ends);
    if (!b->bin_ends)
        return false;
    memset(b->bin_ends, 0, bins * sizeof *b->bin_ends);
    shb_parallel_for(b->context, bin_part_task, b, BIN_PARTS);
    const size_t total = sum_up(b->bin_ends, bins);
    b->numbers = shb_alloc(b->context, total, sizeof *b->numbers);
    if (!b->numbers)
        return false;
    shb_parallel_for(b->context, bin_part_task, b, BIN_PARTS);
    return true;
}

static shb_list_tile tile_of(const build *b, size_t index) {
    const size_t begin = index ? b->bin_ends[index * BIN_PARTS - 1] : 0;
    return (shb_list_tile){.lists = b->lists,
                           .boxes = b->boxes,
                           .numbers = b->numbers + begin,
                           .count = b->bin_ends[(index + 1) * BIN_PARTS - 1] - begin,
                           .first_column =
                               (uint32_t)(index % b->lists->tile_columns) * SHB_LIST_TILE,
                           .first_row = (uint32_t)(index / b->lists->tile_columns) * SHB_LIST_TILE};
}

static void count_tile(void *arg, size_t index) {
    const build *b = arg;
    const shb_list_tile tile = tile_of(b, index);
    uint32_t *counts = b->lists->starts + index * TILE_TEXELS;
    memset(counts, 0, TILE_TEXELS * sizeof *counts);
    shb_list_tile_count(&tile, counts);
    size_t sum = 0;
    for (size_t i = 0; i < TILE_TEXELS; i++)
        sum += counts[i];
    b->tile_starts[index] = sum;
}

static void fill_tile(void *arg, size_t index) {
    const build *b = arg;
    const shb_list_tile tile = tile_of(b, index);
    uint32_t *starts = b->lists->starts + index * TILE_TEXELS;
    uint32_t next[TILE_TEXELS];
    uint32_t sum = (uint32_t)b->tile_starts[index];
    for (size_t i = 0; i < TILE_TEXELS; i++) {
        const uint32_t count = starts[i];
        starts[i] = next[i] = sum;
        sum += count;
    }
    shb_list_tile_fill(&tile, next, b->lists->entries);
}

/* Frees what belongs to one size of the lists. */
static void drop_size(build *b) {
    shb_lists *lists = b->lists;
    void *const memory[] = {lists->starts, lists->entries, lists->triangles, b->boxes,
                            b->bin_ends,   b->numbers,     b->tile_starts};
    for (size_t i = 0; i < sizeof memory / sizeof *memory; i++)
        shb_free(b->context, memory[i]);
    lists->starts = lists->entries = NULL;
    lists->triangles = NULL;
    b->boxes = NULL;
    b->bin_ends = b->tile_starts = NULL;
    b->numbers = NULL;
}

static size_t runs_of(uint32_t count) {
    return ((size_t)count + RUN - 1) / RUN;
}

static bool prepare_triangles(build *b) {
    shb_lists *lists = b->lists;
    shb_parallel_for(b->context, bound_run, b, runs_of(lists->id_count));
    order_triangles(b);
    lists->triangles = shb_alloc(b->context, lists->count, sizeof *lists->triangles);
    b->boxes = shb_alloc(b->context, lists->count, sizeof *b->boxes);
    if (!lists->triangles || !b->boxes)
        return false;
    shb_parallel_for(b->context, prepare_run, b, runs_of(lists->count));
    return true;
}

/* Counts the entries of all texels; their number goes to *entries. */
static bool count_entries(build *b, size_t *entries) {
    b->lists->starts = shb_alloc(b->context, b->tiles * TILE_TEXELS + 1, sizeof(uint32_t));
    b->tile_starts = shb_alloc(b->context, b->tiles, sizeof *b->tile_starts);
    if (!b->lists->starts || !b->tile_starts)
        return false;
    shb_parallel_for(b->context, count_tile, b, b->tiles);
    *entries = sum_up(b->tile_starts, b->tiles);
    return true;
}

static bool fill_entries(build *b, size_t entries) {
    b->lists->entries = shb_alloc(b->context, entries, sizeof(uint32_t));
    if (!b->lists->entries)
        return false;
    shb_parallel_for(b->context, fill_tile, b, b->tiles);
    b->lists->starts[b->tiles * TILE_TEXELS] = (uint32_t)entries;
    return true;
}

static size_t memory_of(const build *b, size_t entries) {
    const shb_lists *lists = b->lists;
    return sizeof *lists + (b->tiles * TILE_TEXELS + 1 + entries) * sizeof(uint32_t) +
           lists->count * sizeof *lists->triangles + lists->id_count * sizeof *lists->source;
}

typedef enum outcome { FITS, TOO_LARGE, NO_MEMORY } outcome;

static outcome build_size(build *b, size_t memory_cap) {
    shb_lists *lists = b->lists;
    lists->tile_columns = (lists->width + SHB_LIST_TILE - 1) / SHB_LIST_TILE;
    lists->tile_rows = (lists->height + SHB_LIST_TILE - 1) / SHB_LIST_TILE;
    b->tiles = (size_t)lists->tile_columns * lists->tile_rows;
    size_t entries;
    if (!prepare_triangles(b) || !bin_triangles(b) || !count_entries(b, &entries))
        return NO_MEMORY;
    lists->memory_bytes = memory_of(b, entries);
    if (entries > UINT32_MAX || (memory_cap && lists->memory_bytes > memory_cap))
        return TOO_LARGE;
    return fill_entries(b, entries) ? FITS : NO_MEMORY;
}

static bool load_source(build *b, double *reach) {
    const uint32_t count = b->lists->id_count;
    const size_t runs = runs_of(count);
    b->lists->source = shb_alloc(b->context, count, sizeof *b->lists->source);
    b->reaches = shb_alloc(b->context, runs, sizeof *b->reaches);
    b->source_boxes = shb_alloc(b->context, count, sizeof *b->source_boxes);
    b->keys = shb_alloc(b->context, count, sizeof *b->keys);
    b->spare_keys = shb_alloc(b->context, count, sizeof *b->spare_keys);
    if (!b->lists->source || !b->reaches || !b->source_boxes || !b->keys || !b->spare_keys)
        return false;
    shb_parallel_for(b->context, load_run, b, runs);
    *reach = 0;
    for (size_t i = 0; i < runs; i++)
        *reach = b->reaches[i] > *reach ? b->reaches[i] : *reach;
    return true;
}

static void drop_source(build *b) {
    void *const memory[] = {b->reaches, b->source_boxes, b->keys, b->spare_keys};
    for (size_t i = 0; i < sizeof memory / sizeof *memory; i++)
        shb_free(b->context, memory[i]);
}

static uint32_t half_of(uint32_t size) {
    return size > 1 ? size / 2 : 1;
}

static shb_result no_memory(const build *b, const char *caller) {
    return shb_fail(b->context, SHB_ERROR_MEMORY, "%s: no memory for lists of %lu triangles",
                    caller, (unsigned long)b->lists->id_count);
}

/* Builds at the largest size that fits. */
static shb_result build_lists(build *b, const char *caller, const shb_view *view,
                              size_t memory_cap) {
    shb_lists *lists = b->lists;
    double reach;
    if (!load_source(b, &reach))
        return no_memory(b, caller);
    for (;;) {
        const shb_result result =
            shb_list_frame_init(view, lists->width, lists->height, reach, &lists->frame);
        if (result)
            return shb_fail(b->context, result, "%s: the view has no light", caller);
        const outcome found = build_size(b, memory_cap);
        if (found == FITS)
            return SHB_OK;
        if (found == NO_MEMORY)
            return no_memory(b, caller);
        if (lists->width == 1 && lists->height == 1)
            return shb_fail(b->context, SHB_ERROR_SIZE,
                            "%s: lists of one texel take %zu bytes, more than the cap of %zu",
                            caller, lists->memory_bytes, memory_cap);
        drop_size(b);
        lists->width = half_of(lists->width);
        lists->height = half_of(lists->height);
    }
}

shb_result shb_lists_build(shb_context *context, const char *caller, const shb_view *view,
                           uint32_t width, uint32_t height, const shb_scene *scene,
                           size_t memory_cap, shb_lists **lists) {
    shb_lists *made = shb_alloc(context, 1, sizeof *made);
    if (!made)
        return shb_fail(context, SHB_ERROR_MEMORY, "%s: no memory for lists", caller);
    *made = (shb_lists){.context = context,
                        .width = width,
                        .height = height,
                        .id_count = (uint32_t)shb_scene_triangle_count(scene)};
    build b = {.context = context, .scene = scene, .lists = made};
    const shb_result result = build_lists(&b, caller, view, memory_cap);
    if (result) {
        drop_size(&b);
        shb_free(context, made->source);
        shb_free(context, made);
    } else {
        shb_free(context, b.boxes);
        shb_free(context, b.bin_ends);
        shb_free(context, b.numbers);
        shb_free(context, b.tile_starts);
        *lists = made;
    }
    drop_source(&b);
    return result;
}

void shb_lists_destroy(shb_lists *lists) {
    if (!lists)
        return;
    const shb_context *context = lists->context;
    shb_free(context, lists->starts);
    shb_free(context, lists->entries);
    shb_free(context, lists->triangles);
    shb_free(context, lists->source);
    shb_free(context, lists);
}
