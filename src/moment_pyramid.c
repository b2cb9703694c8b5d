#include "strict.h"

#include "moment_pyramid.h"

#include "kernels/moments.h"
#include "project.h"

/* Boxes lie a quarter of their width apart, the smallest ones a texel. */
static int spacing_shift(int level) {
    return level > 1 ? level - 1 : 0;
}

typedef struct level_task {
    const shb_map *map;
    const shb_moment_kernels *kernels;
    const shb_distance *distance;
    const shb_moment_pyramid *pyramid;
    int level;
} level_task;

/* Each box of the finest level is centred between four texels. */
static void build_finest_row(const level_task *task, uint32_t y) {
    enum { SPAN = SHB_BATCH };
    const shb_moment_level *level = &task->pyramid->levels[0];
    const int moments = task->pyramid->count;
    float row[SPAN + SHB_LANES] = {0}, below[SPAN + SHB_LANES] = {0};
    for (uint32_t x = 0; x < level->columns; x += SPAN) {
        const uint32_t left = level->columns - x, count = left < SPAN ? left : SPAN;
        shb_moment_values(task->map, task->distance, task->pyramid->exponent, (int32_t)x - 1,
                          (int32_t)y - 1, count + 1, row);
        shb_moment_values(task->map, task->distance, task->pyramid->exponent, (int32_t)x - 1,
                          (int32_t)y, count + 1, below);
        float *boxes = level->boxes + ((size_t)y * level->columns + x) * (size_t)moments;
        task->kernels->join_texels(moments, count, row, below, boxes);
    }
}

static void build_row(void *arg, size_t y) {
    const level_task *task = arg;
    if (task->level == 0)
        build_finest_row(task, (uint32_t)y);
    else
        task->kernels->join_boxes(task->pyramid, task->level, (uint32_t)y);
}

/* Boxes of a level along an axis: up to the last one that is not all outside the map. */
static uint32_t boxes_along(uint32_t size, int level) {
    const int shift = spacing_shift(level);
    return ((size + (1u << shift) - 1) >> shift) + 2;
}

/* A box of b texels has the second moment (b^2 - 1) / 12, and a mixture of two that lie s apart
 * adds s^2 / 4 at most. */
static float square_width_of(int level) {
    const float box = (float)(2 << level), spacing = (float)(1 << spacing_shift(level));
    return box * box - 1 + 3 * spacing * spacing;
}

/* Sizes of all levels; returns how many boxes they take. */
static uint32_t plan_levels(const shb_map_info *info, shb_moment_pyramid *pyramid) {
    const uint32_t size = info->width > info->height ? info->width : info->height;
    uint32_t boxes = 0;
    pyramid->level_count = 0;
    do {
        const int k = pyramid->level_count++;
        shb_moment_level *level = &pyramid->levels[k];
        level->columns = boxes_along(info->width, k);
        level->rows = boxes_along(info->height, k);
        pyramid->firsts[k] = boxes;
        pyramid->square_widths[k] = square_width_of(k);
        boxes += level->columns * level->rows;
    } while (1u << pyramid->level_count < size);
    return boxes;
}

bool shb_moment_pyramid_create(const shb_map *map, shb_moment_pyramid *pyramid) {
    const size_t moments = (size_t)pyramid->count;
    const size_t floats = plan_levels(&map->info, pyramid) * moments;
    pyramid->boxes = shb_alloc(map->context, floats, sizeof *pyramid->boxes);
    if (!pyramid->boxes)
        return false;
    pyramid->bytes = floats * sizeof *pyramid->boxes;
    pyramid->far = shb_moment_warp(pyramid->exponent, 1);
    for (int k = 0; k < pyramid->level_count; k++)
        pyramid->levels[k].boxes = pyramid->boxes + pyramid->firsts[k] * moments;
    return true;
}

void shb_moment_pyramid_fill(const shb_map *map, const shb_distance *distance,
                             shb_moment_pyramid *pyramid) {
    level_task task = {map, shb_moment_kernels_of(map->context->isa), distance, pyramid, 0};
    for (; task.level < pyramid->level_count; task.level++)
        shb_parallel_for(map->context, build_row, &task, pyramid->levels[task.level].rows);
}

void shb_moment_pyramid_destroy(const shb_map *map, shb_moment_pyramid *pyramid) {
    shb_free(map->context, pyramid->boxes);
}
