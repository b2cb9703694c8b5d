#include "strict.h"

#include "pyramid.h"

#include "floats4.h"
#include "format.h"

#include <math.h>
#include <string.h>

enum { SIDE = 1 << SHB_PYRAMID_SHIFT };

/* Bounds that were calculated with slopes give way by this much of the numbers that went in:
 * floats4 times what the rounding of a handful of operations can be. */
#define ROUNDING 0x1p-20f

/* A strip of texels, the rows of one row of cells, as canonical depth. */
enum { STRIP = 256 };
typedef struct strip {
    float depth[SIDE][STRIP];
    int columns, rows; /* rows: fewer than SIDE at the map's lower border */
} strip;

/* Level bounds of a cell of the strip. */
static shb_pyramid_cell flat_cell(const strip *texels, int column, int columns, float far_depth) {
    shb_pyramid_cell cell = {INFINITY, -INFINITY, 0, 0};
    for (int row = 0; row < texels->rows; row++)
        for (int i = 0; i < columns; i++) {
            const float depth = texels->depth[row][column + i];
            const float bound = depth < far_depth ? depth : INFINITY;
            cell.nearest = min_of(cell.nearest, bound);
            cell.farthest = max_of(cell.farthest, bound);
        }
    return cell;
}

/* What is gathered over the rows of a whole cell: bounds, the sums of its left and right half, and
 * the lower half's depths less those of the upper one. */
typedef struct cell_sums {
    floats4 nearest, farthest;
    floats4 left, right, down;
} cell_sums;

static cell_sums sum_rows(const strip *texels, int column, float far_depth) {
    const floats4 far_depths = splat4(far_depth), infinite = splat4(INFINITY);
    cell_sums sums = {.nearest = infinite, .farthest = splat4(-INFINITY)};
    for (int row = 0; row < SIDE; row++) {
        const floats4 left = load4(texels->depth[row] + column);
        const floats4 right = load4(texels->depth[row] + column + SIDE / 2);
        const floats4 bound_left = choose4(left < far_depths, left, infinite);
        const floats4 bound_right = choose4(right < far_depths, right, infinite);
        sums.nearest = min4(min4(bound_left, bound_right), sums.nearest);
        sums.farthest = max4(max4(bound_left, bound_right), sums.farthest);
        sums.left += left;
        sums.right += right;
        sums.down += row < SIDE / 2 ? -(left + right) : left + right;
    }
    return sums;
}

static void reduce(floats4 nearest, floats4 farthest, shb_pyramid_cell *cell) {
    cell->nearest = min_of(min_of(nearest[0], nearest[1]), min_of(nearest[2], nearest[3]));
    cell->farthest = max_of(max_of(farthest[0], farthest[1]), max_of(farthest[2], farthest[3]));
}

/* Slopes of a whole cell: the mean difference between its halves, which are SIDE / 2 apart. */
static void find_slopes(const cell_sums *sums, shb_pyramid_cell *cell) {
    const float pairs = SIDE * SIDE / 2 * (SIDE / 2);
    cell->slope_x = sum4(sums->right - sums->left) / pairs;
    cell->slope_y = sum4(sums->down) / pairs;
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

/* Bounds of a whole cell without empty texels along its slopes. */
static void find_bounds(const strip *texels, int column, shb_pyramid_cell *cell) {
    const floats4 columns = {0, 1, 2, 3};
    const floats4 run_left = columns * cell->slope_x;
    const floats4 run_right = (columns + SIDE / 2) * cell->slope_x;
    floats4 nearest = splat4(INFINITY), farthest = splat4(-INFINITY);
    for (int row = 0; row < SIDE; row++) {
        const float down = (float)row * cell->slope_y;
        const floats4 left = load4(texels->depth[row] + column) - (run_left + down);
        const floats4 right = load4(texels->depth[row] + column + SIDE / 2) - (run_right + down);
        nearest = min4(min4(left, right), nearest);
        farthest = max4(max4(left, right), farthest);
    }
    reduce(nearest, farthest, cell);
}

/* The narrower one; the first where there is no telling. */
static shb_pyramid_cell narrower(const shb_pyramid_cell *a, const shb_pyramid_cell *b) {
    return b->farthest - b->nearest < a->farthest - a->nearest ? *b : *a;
}

static shb_pyramid_cell whole_cell(const strip *texels, int column, float far_depth) {
    const cell_sums sums = sum_rows(texels, column, far_depth);
    shb_pyramid_cell flat = {0}, sloped = {0};
    reduce(sums.nearest, sums.farthest, &flat);
    find_slopes(&sums, &sloped);
    if (!(flat.farthest < INFINITY) || !is_usable(&sloped))
        return flat;
    find_bounds(texels, column, &sloped);
    widen(&sloped, SIDE, max_of(fabsf(flat.nearest), fabsf(flat.farthest)));
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

static void load_strip(const shb_map *map, uint32_t column, uint32_t row, strip *texels) {
    const shb_map_info *info = &map->info;
    const char *start = (const char *)map->depth.texels + column * shb_format_size(info->format);
    texels->columns = info->width - column < STRIP ? (int)(info->width - column) : STRIP;
    texels->rows = info->height - row < SIDE ? (int)(info->height - row) : SIDE;
    for (int i = 0; i < texels->rows; i++)
        shb_format_load(info->format, info->view.reversed, (size_t)texels->columns,
                        start + (row + (size_t)i) * map->depth.stride, texels->depth[i]);
}

static void build_texels_row(void *arg, size_t row) {
    const build_work *work = arg;
    const shb_map *map = work->map;
    const float far_depth = shb_far_depth(map->info.view.reversed);
    shb_pyramid_cell *cell = work->made->cells + row * work->made->columns;
    strip texels;
    for (uint32_t first = 0; first < map->info.width; first += STRIP) {
        load_strip(map, first, (uint32_t)row * SIDE, &texels);
        for (int i = 0; i < texels.columns; i += SIDE) {
            const int columns = texels.columns - i < SIDE ? texels.columns - i : SIDE;
            *cell++ = columns == SIDE && texels.rows == SIDE
                          ? whole_cell(&texels, i, far_depth)
                          : flat_cell(&texels, i, columns, far_depth);
        }
    }
}

/* Cells next to each other, lane by lane; beyond the map the one before stands in. */
typedef struct four_cells {
    floats4 nearest, farthest, slope_x, slope_y;
    floats4 x, y; /* where they begin */
    float size;
} four_cells;

static four_cells load_cells(const build_work *work, uint32_t column, uint32_t row) {
    const shb_pyramid_level *from = work->from;
    const bool right = work->every * (column + 1) < from->columns;
    const bool below = work->every * (row + 1) < from->rows;
    const shb_pyramid_cell *a =
        &from->cells[(size_t)work->every * row * from->columns + work->every * column];
    const shb_pyramid_cell *b = a + (right ? work->every : 0);
    const size_t down = below ? (size_t)work->every * from->columns : 0;
    const shb_pyramid_cell *c = a + down, *d = b + down;
    const float x = right ? work->size : 0, y = below ? work->size : 0;
    return (four_cells){.nearest = {a->nearest, b->nearest, c->nearest, d->nearest},
                        .farthest = {a->farthest, b->farthest, c->farthest, d->farthest},
                        .slope_x = {a->slope_x, b->slope_x, c->slope_x, d->slope_x},
                        .slope_y = {a->slope_y, b->slope_y, c->slope_y, d->slope_y},
                        .x = {0, x, 0, x},
                        .y = {0, 0, y, y},
                        .size = work->size};
}

static inline floats4 abs4(floats4 v) {
    return max4(v, -v);
}

/* Bounds of all four along these slopes. Empty cells, whose bounds are infinite, widen no nearest
 * one. */
static shb_pyramid_cell merge_along(const four_cells *cells, float slope_x, float slope_y) {
    const floats4 zero = splat4(0);
    const floats4 more_x = (cells->slope_x - slope_x) * (cells->size - 1);
    const floats4 more_y = (cells->slope_y - slope_y) * (cells->size - 1);
    const floats4 run = cells->x * slope_x + cells->y * slope_y;
    const floats4 low = min4(more_x, zero) + min4(more_y, zero);
    const floats4 high = max4(more_x, zero) + max4(more_y, zero);
    const floats4 rise =
        (fabsf(slope_x) + fabsf(slope_y)) + (abs4(cells->slope_x) + abs4(cells->slope_y));
    const floats4 depth = choose4(cells->nearest < INFINITY, abs4(cells->nearest), zero);
    const floats4 size = depth + 2 * cells->size * rise;
    const floats4 rounding = choose4(rise > 0, ROUNDING * size, zero);
    shb_pyramid_cell merged = {.slope_x = slope_x, .slope_y = slope_y};
    reduce(((cells->nearest - run) + low) - rounding, ((cells->farthest - run) + high) + rounding,
           &merged);
    return merged;
}

/* Along the mean slopes, or level. */
static shb_pyramid_cell merge(const four_cells *cells) {
    const shb_pyramid_cell flat = merge_along(cells, 0, 0);
    if (!(flat.farthest < INFINITY))
        return flat;
    const shb_pyramid_cell sloped =
        merge_along(cells, sum4(cells->slope_x) / 4, sum4(cells->slope_y) / 4);
    return narrower(&flat, &sloped);
}

static void build_row(void *arg, size_t row) {
    const build_work *work = arg;
    const shb_pyramid_level *level = work->made;
    for (uint32_t i = 0; i < level->columns; i++) {
        const four_cells cells = load_cells(work, i, (uint32_t)row);
        level->cells[row * level->columns + i] = merge(&cells);
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
