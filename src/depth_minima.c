#include "strict.h"

#include "depth_minima.h"

#include "depth_rows.h"
#include "format.h"

typedef struct first_level {
    const shb_map *map;
    const shb_depth_minima *minima;
} first_level;

static float nearer(float a, float b) {
    return a < b ? a : b;
}

/* One row of cells. */
static void find_cells(void *arg, size_t row) {
    enum { CELL = 1 << SHB_MINIMA_SHIFT };
    const first_level *level = arg;
    const shb_map *map = level->map;
    const float near_depth = map->info.view.reversed ? -1.0f : 0.0f;
    const uint32_t columns = level->minima->columns[0];
    float *cells = level->minima->cells + row * columns;
    for (uint32_t column = 0; column < columns; column++)
        cells[column] = shb_far_depth(map->info.view.reversed);
    for (int32_t y = (int32_t)row * CELL; y < (int32_t)(row + 1) * CELL; y++)
        for (uint32_t column = 0; column < columns; column += SHB_BATCH / CELL) {
            float depths[SHB_BATCH];
            shb_depth_row(map, (int32_t)column * CELL, y, SHB_BATCH, depths);
            for (uint32_t i = 0; i < SHB_BATCH && column + i / CELL < columns; i++) {
                const float depth = depths[i] > near_depth ? depths[i] : near_depth;
                cells[column + i / CELL] = nearer(cells[column + i / CELL], depth);
            }
        }
}

/* The least of four cells of the level before, fewer at its ends. */
static void join_cells(const shb_depth_minima *m, int level) {
    const uint32_t columns = m->columns[level - 1], rows = m->rows[level - 1];
    const float *from = m->cells + m->firsts[level - 1];
    float *to = m->cells + m->firsts[level];
    for (uint32_t y = 0; y < m->rows[level]; y++)
        for (uint32_t x = 0; x < m->columns[level]; x++) {
            const float *first = from + (size_t)2 * y * columns + 2 * x;
            const size_t right = 2 * x + 1 < columns ? 1 : 0;
            const size_t below = 2 * y + 1 < rows ? columns : 0;
            to[y * m->columns[level] + x] =
                nearer(nearer(first[0], first[right]), nearer(first[below], first[below + right]));
        }
}

bool shb_depth_minima_create(const shb_map *map, shb_depth_minima *minima) {
    uint32_t columns = map->info.width, rows = map->info.height, total = 0;
    *minima = (shb_depth_minima){0};
    for (int shift = SHB_MINIMA_SHIFT; minima->count == 0 || columns * rows > 1; shift = 1) {
        const int level = minima->count++;
        columns = (columns + (1u << shift) - 1) >> shift;
        rows = (rows + (1u << shift) - 1) >> shift;
        minima->columns[level] = columns;
        minima->rows[level] = rows;
        minima->firsts[level] = total;
        total += columns * rows;
    }
    minima->bytes = total * sizeof *minima->cells;
    minima->cells = shb_alloc(map->context, total, sizeof *minima->cells);
    return minima->cells != NULL;
}

void shb_depth_minima_fill(const shb_map *map, const shb_depth_minima *minima) {
    first_level first = {map, minima};
    shb_parallel_for(map->context, find_cells, &first, minima->rows[0]);
    for (int level = 1; level < minima->count; level++)
        join_cells(minima, level);
}

void shb_depth_minima_destroy(const shb_map *map, shb_depth_minima *minima) {
    shb_free(map->context, minima->cells);
}
