#include "strict.h"

#include "pyramid.h"

#include "format.h"

#include <math.h>

enum { SIDE = 1 << SHB_PYRAMID_SHIFT };

/* Bounds that were calculated with slopes give way by this much of the numbers that went in: four
 * times what the rounding of a handful of operations can be. */
#define ROUNDING 0x1p-20f

static float min_of(float a, float b) {
    return a < b ? a : b;
}

static float max_of(float a, float b) {
    return a > b ? a : b;
}

/* The depths of one cell, row by row. */
typedef struct cell_texels {
    float depth[SIDE][SIDE];
    int columns, rows; /* fewer than SIDE at the map's right and lower border */
} cell_texels;

/* Level bounds. */
static shb_pyramid_cell flat_cell(const cell_texels *texels, float far_depth) {
    shb_pyramid_cell cell = {INFINITY, -INFINITY, 0, 0};
    for (int row = 0; row < texels->rows; row++)
        for (int i = 0; i < texels->columns; i++) {
            const float depth = texels->depth[row][i];
            const float bound = depth < far_depth ? depth : INFINITY;
            cell.nearest = min_of(cell.nearest, bound);
            cell.farthest = max_of(cell.farthest, bound);
        }
    return cell;
}

/* Slopes of a whole cell: the mean difference between its halves, which are SIDE / 2 apart. */
static void find_slopes(const cell_texels *texels, shb_pyramid_cell *cell) {
    float across[SIDE] = {0}, down[SIDE] = {0};
    for (int row = 0; row < SIDE; row++)
        for (int i = 0; i < SIDE; i++) {
            const float depth = texels->depth[row][i];
            across[i] += depth;
            down[i] += row < SIDE / 2 ? -depth : depth;
        }
    float sum_x = 0, sum_y = 0;
    for (int i = 0; i < SIDE; i++) {
        sum_x += i < SIDE / 2 ? -across[i] : across[i];
        sum_y += down[i];
    }
    const float pairs = SIDE * SIDE / 2 * (SIDE / 2);
    cell->slope_x = sum_x / pairs;
    cell->slope_y = sum_y / pairs;
}

static bool has_slopes(const shb_pyramid_cell *cell) {
    return cell->slope_x != 0 || cell->slope_y != 0;
}

/* False for a slope that is no number or beyond what receivers have. */
static bool is_usable(const shb_pyramid_cell *cell) {
    return fabsf(cell->slope_x) <= 1 && fabsf(cell->slope_y) <= 1;
}

static void widen(shb_pyramid_cell *cell, float size, float depth) {
    const float rise = size * (fabsf(cell->slope_x) + fabsf(cell->slope_y));
    const float rounding = ROUNDING * (depth + rise);
    cell->nearest -= rounding;
    cell->farthest += rounding;
}

/* Bounds along the mean slopes of a whole cell without empty texels. */
static shb_pyramid_cell sloped_cell(const cell_texels *texels, const shb_pyramid_cell *flat) {
    shb_pyramid_cell cell = {INFINITY, -INFINITY, 0, 0};
    find_slopes(texels, &cell);
    if (!is_usable(&cell))
        return *flat;
    float nearest[SIDE], farthest[SIDE];
    for (int i = 0; i < SIDE; i++) {
        nearest[i] = INFINITY;
        farthest[i] = -INFINITY;
    }
    for (int row = 0; row < SIDE; row++)
        for (int i = 0; i < SIDE; i++) {
            const float run = (float)i * cell.slope_x + (float)row * cell.slope_y;
            const float rest = texels->depth[row][i] - run;
            nearest[i] = min_of(nearest[i], rest);
            farthest[i] = max_of(farthest[i], rest);
        }
    for (int i = 0; i < SIDE; i++) {
        cell.nearest = min_of(cell.nearest, nearest[i]);
        cell.farthest = max_of(cell.farthest, farthest[i]);
    }
    widen(&cell, SIDE, max_of(fabsf(flat->nearest), fabsf(flat->farthest)));
    return cell;
}

/* The narrower one; the first where there is no telling. */
static shb_pyramid_cell narrower(const shb_pyramid_cell *a, const shb_pyramid_cell *b) {
    return b->farthest - b->nearest < a->farthest - a->nearest ? *b : *a;
}

static shb_pyramid_cell cell_of_texels(const cell_texels *texels, float far_depth) {
    const shb_pyramid_cell flat = flat_cell(texels, far_depth);
    const bool whole = texels->columns == SIDE && texels->rows == SIDE;
    if (!whole || !(flat.farthest < INFINITY))
        return flat;
    const shb_pyramid_cell sloped = sloped_cell(texels, &flat);
    return narrower(&flat, &sloped);
}

/* A level and what it is made of: cells of the given size, next to each other, as every second one
 * in rows and columns of the level before it; or the cells of texels. */
typedef struct build_work {
    const shb_map *map;
    const shb_pyramid_level *made, *from;
    uint32_t every;
    float size;
} build_work;

static void load_texels(const shb_map *map, uint32_t column, uint32_t row, cell_texels *texels) {
    const shb_map_info *info = &map->info;
    const size_t texel_size = shb_format_size(info->format);
    const char *start = (const char *)map->depth.texels + column * texel_size;
    texels->columns = info->width - column < SIDE ? (int)(info->width - column) : SIDE;
    texels->rows = info->height - row < SIDE ? (int)(info->height - row) : SIDE;
    for (int i = 0; i < texels->rows; i++)
        shb_format_load(info->format, info->view.reversed, (size_t)texels->columns,
                        start + (row + (size_t)i) * map->depth.stride, texels->depth[i]);
}

static void build_texels_row(void *arg, size_t row) {
    const build_work *work = arg;
    const shb_pyramid_level *level = work->made;
    const float far_depth = shb_far_depth(work->map->info.view.reversed);
    cell_texels texels;
    for (uint32_t i = 0; i < level->columns; i++) {
        load_texels(work->map, i * SIDE, (uint32_t)row * SIDE, &texels);
        level->cells[row * level->columns + i] = cell_of_texels(&texels, far_depth);
    }
}

/* Widens the bounds, which have their slopes, by those of a child that begins at (x, y). */
static void add_child(shb_pyramid_cell *cell, const shb_pyramid_cell *child, float x, float y,
                      float size) {
    if (child->nearest == INFINITY) { /* nothing but empty texels */
        cell->farthest = INFINITY;
        return;
    }
    const float more_x = (child->slope_x - cell->slope_x) * (size - 1);
    const float more_y = (child->slope_y - cell->slope_y) * (size - 1);
    const float run = x * cell->slope_x + y * cell->slope_y;
    shb_pyramid_cell moved = *child;
    moved.nearest = (child->nearest - run) + (min_of(more_x, 0) + min_of(more_y, 0));
    moved.farthest = (child->farthest - run) + (max_of(more_x, 0) + max_of(more_y, 0));
    if (has_slopes(cell) || has_slopes(child))
        widen(&moved, size, fabsf(child->nearest) + 2 * fabsf(run));
    cell->nearest = min_of(cell->nearest, moved.nearest);
    cell->farthest = max_of(cell->farthest, moved.farthest);
}

/* Four cells next to each other. */
typedef struct children {
    const shb_pyramid_cell *cells[4]; /* NULL beyond the map */
    float size;
} children;

static shb_pyramid_cell cell_of_children(const children *from, float slope_x, float slope_y) {
    shb_pyramid_cell cell = {INFINITY, -INFINITY, slope_x, slope_y};
    for (int k = 0; k < 4; k++)
        if (from->cells[k])
            add_child(&cell, from->cells[k], k & 1 ? from->size : 0, k & 2 ? from->size : 0,
                      from->size);
    return cell;
}

static shb_pyramid_cell merge(const children *from) {
    float slope_x = 0, slope_y = 0, count = 0;
    for (int k = 0; k < 4; k++)
        if (from->cells[k]) {
            slope_x += from->cells[k]->slope_x;
            slope_y += from->cells[k]->slope_y;
            count += 1;
        }
    const shb_pyramid_cell flat = cell_of_children(from, 0, 0);
    if (!(flat.farthest < INFINITY))
        return flat;
    const shb_pyramid_cell sloped = cell_of_children(from, slope_x / count, slope_y / count);
    return narrower(&flat, &sloped);
}

static void build_row(void *arg, size_t row) {
    const build_work *work = arg;
    const shb_pyramid_level *level = work->made, *from = work->from;
    for (uint32_t i = 0; i < level->columns; i++) {
        children quad = {.size = work->size};
        for (uint32_t k = 0; k < 4; k++) {
            const uint32_t x = work->every * (i + (k & 1));
            const uint32_t y = work->every * ((uint32_t)row + (k >> 1));
            if (x < from->columns && y < from->rows)
                quad.cells[k] = &from->cells[(size_t)y * from->columns + x];
        }
        level->cells[row * level->columns + i] = merge(&quad);
    }
}

/* The sizes of all levels; returns the number of their cells. */
static size_t measure(const shb_map *map, shb_pyramid *pyramid) {
    uint32_t columns = (map->info.width + SIDE - 1) / SIDE;
    uint32_t rows = (map->info.height + SIDE - 1) / SIDE;
    size_t cells = 0;
    for (;;) {
        pyramid->levels[pyramid->count++] = (shb_pyramid_level){NULL, columns, rows};
        cells += (size_t)columns * rows;
        if (columns == 1 && rows == 1)
            return cells;
        columns = (columns + 1) / 2;
        rows = (rows + 1) / 2;
    }
}

static void build(const shb_map *map, const shb_pyramid *pyramid, shb_pyramid_cell *finest) {
    shb_pyramid_level texels = pyramid->levels[0];
    texels.cells = finest;
    build_work work = {map, &texels, NULL, 1, SIDE};
    shb_parallel_for(map->context, build_texels_row, &work, texels.rows);
    work.from = &texels;
    for (int i = 0; i < pyramid->count; i++) {
        work.made = &pyramid->levels[i];
        shb_parallel_for(map->context, build_row, &work, work.made->rows);
        work.from = work.made;
        work.every = 2;
        work.size *= 2;
    }
}

shb_pyramid *shb_pyramid_create(const shb_map *map, size_t *bytes) {
    shb_pyramid made = {0};
    const size_t size = sizeof made + measure(map, &made) * sizeof(shb_pyramid_cell);
    const size_t finest_count = (size_t)made.levels[0].columns * made.levels[0].rows;
    shb_pyramid_cell *finest = shb_alloc(map->context, finest_count, sizeof *finest);
    shb_pyramid *pyramid = finest ? shb_alloc(map->context, 1, size) : NULL;
    if (pyramid) {
        shb_pyramid_cell *cells = (shb_pyramid_cell *)(void *)(pyramid + 1);
        for (int i = 0; i < made.count; i++) {
            made.levels[i].cells = cells;
            cells += (size_t)made.levels[i].columns * made.levels[i].rows;
        }
        *pyramid = made;
        build(map, pyramid, finest);
        *bytes = size;
    }
    shb_free(map->context, finest);
    return pyramid;
}

void shb_pyramid_destroy(const shb_map *map, shb_pyramid *pyramid) {
    shb_free(map->context, pyramid);
}
