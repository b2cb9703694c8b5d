#include "strict.h"

#include "pyramid.h"

#include "format.h"
#include "kernels/shade.h"

enum { SIDE = 1 << SHB_PYRAMID_SHIFT };

/* A level and what it is made of: cells of the given size, next to each other, as every second one
 * in rows and columns of the level before it; or the cells of texels. */
typedef struct build_work {
    const shb_map *map;
    const shb_pyramid_level *made, *from;
    uint32_t every;
    float size;
} build_work;

/* Texels of the rows of one row of cells, as canonical depth; those beyond the map are copies of
 * its last ones. */
enum { STRIP = 256 };
typedef float strip[SIDE][STRIP];

static void load_strip(const shb_map *map, uint32_t column, uint32_t row, strip texels) {
    const shb_map_info *info = &map->info;
    const char *start = (const char *)map->depth.texels + column * shb_format_size(info->format);
    const uint32_t columns = info->width - column < STRIP ? info->width - column : STRIP;
    for (uint32_t i = 0; i < SIDE; i++) {
        const uint32_t own = row + i < info->height ? row + i : info->height - 1;
        shb_format_load(info->format, info->view.reversed, columns,
                        start + (size_t)own * map->depth.stride, texels[i]);
        for (uint32_t k = columns; k < STRIP; k++)
            texels[i][k] = texels[i][columns - 1];
    }
}

static void build_texels_row(void *arg, size_t row) {
    const build_work *work = arg;
    const shb_map *map = work->map;
    const shb_pyramid_level *made = work->made;
    strip texels;
    for (uint32_t first = 0; first < made->columns; first += STRIP / SIDE) {
        const uint32_t left = made->columns - first;
        load_strip(map, first * SIDE, (uint32_t)row * SIDE, texels);
        map->context->shade_kernels->bound_cells(
            texels[0], STRIP, shb_far_depth(map->info.view.reversed),
            left < STRIP / SIDE ? left : STRIP / SIDE, made->cells + row * made->columns + first);
    }
}

static void build_row(void *arg, size_t row) {
    const build_work *work = arg;
    work->map->context->shade_kernels->join_cells(work->from, work->every, work->size,
                                                  (uint32_t)row, work->made);
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

void shb_pyramid_destroy(const shb_map *map, void *pyramid) {
    shb_free(map->context, pyramid);
}
