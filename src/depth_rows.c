#include "strict.h"

#include "depth_rows.h"

#include <math.h>

#include "format.h"
#include "kernels/shade.h"

/* Rows of one task, and how many tasks the highest map has. */
enum { TASK_ROWS = 64, TASKS_MAX = SHB_SIZE_MAX / TASK_ROWS };

void shb_depth_row(const shb_map *map, int32_t x, int32_t y, size_t count, float *depths) {
    const float far_depth = shb_far_depth(map->info.view.reversed);
    SHB_ALIGN int32_t columns[SHB_BATCH], rows[SHB_BATCH];
    for (size_t first = 0; first < count; first += SHB_BATCH) {
        const size_t left = count - first, part = left < SHB_BATCH ? left : SHB_BATCH;
        for (size_t i = 0; i < part; i++) {
            columns[i] = x + (int32_t)(first + i);
            rows[i] = y;
        }
        map->context->shade_kernels->fetch(map, part, columns, rows, depths + first);
    }
    for (size_t i = 0; i < count; i++)
        depths[i] = depths[i] == depths[i] ? depths[i] : far_depth;
}

typedef struct range_task {
    const shb_map *map;
    float far_depth;
    shb_depth_range parts[TASKS_MAX];
} range_task;

static void widen(shb_depth_range *range, float far_depth, size_t count, const float *depths) {
    float nearest = range->nearest, farthest = range->farthest;
    for (size_t i = 0; i < count; i++) {
        const float depth = depths[i];
        const float seen = depth < far_depth ? depth : -HUGE_VALF;
        nearest = depth < nearest ? depth : nearest;
        farthest = seen > farthest ? seen : farthest;
    }
    *range = (shb_depth_range){nearest, farthest};
}

static void find_range(void *arg, size_t index) {
    range_task *task = arg;
    const uint32_t width = task->map->info.width, height = task->map->info.height;
    const uint32_t begin = (uint32_t)index * TASK_ROWS;
    const uint32_t end = begin + TASK_ROWS < height ? begin + TASK_ROWS : height;
    shb_depth_range range = {task->far_depth, -HUGE_VALF};
    for (uint32_t y = begin; y < end; y++)
        for (uint32_t x = 0; x < width; x += SHB_BATCH) {
            const size_t left = width - x, part = left < SHB_BATCH ? left : SHB_BATCH;
            float depths[SHB_BATCH];
            shb_depth_row(task->map, (int32_t)x, (int32_t)y, part, depths);
            widen(&range, task->far_depth, part, depths);
        }
    task->parts[index] = range;
}

shb_depth_range shb_depth_range_of(const shb_map *map) {
    const size_t tasks = (map->info.height + TASK_ROWS - 1) / TASK_ROWS;
    range_task task = {.map = map, .far_depth = shb_far_depth(map->info.view.reversed)};
    shb_parallel_for(map->context, find_range, &task, tasks);
    shb_depth_range range = {task.far_depth, -HUGE_VALF};
    for (size_t i = 0; i < tasks; i++) {
        const shb_depth_range *part = &task.parts[i];
        range.nearest = part->nearest < range.nearest ? part->nearest : range.nearest;
        range.farthest = part->farthest > range.farthest ? part->farthest : range.farthest;
    }
    if (range.nearest == task.far_depth)
        range.farthest = task.far_depth;
    return range;
}
