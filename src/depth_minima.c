#include "strict.h"

#include "depth_minima.h"

#include "depth_rows.h"

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
    float *cells = level->minima->cells[0] + row * columns;
    for (uint32_t column = 0; column < columns; column++)
        cells[column] = near_depth + 1;
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
    for (uint32_t y = 0; y < m->rows[level]; y++)
        for (uint32_t x = 0; x < m->columns[level]; x++) {
            const float *first = m->cells[level - 1] + (size_t)2 * y * columns + 2 * x;
            const size_t right = 2 * x + 1 < columns ? 1 : 0;
            const size_t below = 2 * y + 1 < rows ? columns : 0;
            m->cells[level][y * m->columns[level] + x] =
                nearer(nearer(first[0], first[right]), nearer(first[below], first[below + right]));
        }
}

bool shb_depth_minima_create(const shb_map *map, shb_depth_minima *minima) {
    shb_depth_minima made = {0};
    uint32_t columns = map->info.width, rows = map->info.height;
    size_t offsets[SHB_MINIMA_LEVELS], total = 0;
    for (int shift = SHB_MINIMA_SHIFT; made.count == 0 || columns * rows > 1; shift = 1) {
        columns = (columns + (1u << shift) - 1) >> shift;
        rows = (rows + (1u << shift) - 1) >> shift;
        made.columns[made.count] = columns;
        made.rows[made.count] = rows;
        offsets[made.count++] = total;
        total += (size_t)columns * rows;
    }
    float *cells = shb_alloc(map->context, total, sizeof *cells);
    if (!cells)
        return false;
    for (int level = 0; level < made.count; level++)
        made.cells[level] = cells + offsets[level];
    made.bytes = total * sizeof *cells;
    first_level first = {map, &made};
    shb_parallel_for(map->context, find_cells, &first, made.rows[0]);
    for (int level = 1; level < made.count; level++)
        join_cells(&made, level);
    *minima = made;
    return true;
}

void shb_depth_minima_destroy(const shb_map *map, shb_depth_minima *minima) {
    shb_free(map->context, minima->cells[0]);
}

float shb_depth_minima_over(const shb_depth_minima *minima, const shb_texel_box *box) {
    int level = 0, shift = SHB_MINIMA_SHIFT;
    while ((box->x1 >> shift) - (box->x0 >> shift) > 1 ||
           (box->y1 >> shift) - (box->y0 >> shift) > 1) {
        level++;
        shift++;
    }
    const float *cells = minima->cells[level];
    const size_t columns = minima->columns[level];
    const size_t top = (size_t)(box->y0 >> shift) * columns;
    const size_t bottom = (size_t)(box->y1 >> shift) * columns;
    const size_t left = (size_t)(box->x0 >> shift), right = (size_t)(box->x1 >> shift);
    return nearer(nearer(cells[top + left], cells[top + right]),
                  nearer(cells[bottom + left], cells[bottom + right]));
}
