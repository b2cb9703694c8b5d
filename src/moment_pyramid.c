#include "strict.h"

#include "moment_pyramid.h"

#include "depth_rows.h"
#include "project.h"

/* Boxes lie a quarter of their width apart, the smallest ones a texel. */
static int spacing_shift(int level) {
    return level > 1 ? level - 1 : 0;
}

/* ---- building ---- */

typedef struct level_task {
    const shb_map *map;
    const shb_distance *distance;
    const shb_moment_pyramid *pyramid;
    int level;
} level_task;

static float warped_far(const shb_moment_pyramid *pyramid) {
    return shb_moment_warp(pyramid->exponent, 1);
}

/* Texels are boxes without spread: those before and behind count corners of row y. */
static void read_texels(const level_task *task, int32_t x, int32_t y, size_t count,
                        shb_moment_batch *left, shb_moment_batch *right) {
    float values[SHB_BATCH + 1];
    shb_depth_row(task->map, x - 1, y, count + 1, values);
    for (size_t i = 0; i <= count; i++)
        values[i] =
            shb_moment_warp(task->pyramid->exponent, shb_distance_at(task->distance, values[i]));
    for (size_t i = 0; i < count; i++) {
        left->at[0][i] = values[i];
        right->at[0][i] = values[i + 1];
        for (int m = 1; m < task->pyramid->count; m++)
            left->at[m][i] = right->at[m][i] = 0;
    }
}

/* Every step-th box of row y of a level. What the level does not hold lies outside the map. */
static void read_boxes(const shb_moment_pyramid *pyramid, const shb_moment_level *level,
                       int64_t column, int64_t y, int step, size_t count, shb_moment_batch *out) {
    const int moments = pyramid->count;
    const bool has_row = y >= 0 && y < level->rows;
    for (size_t i = 0; i < count; i++, column += step) {
        if (!has_row || column < 0 || column >= level->columns) {
            out->at[0][i] = warped_far(pyramid);
            for (int m = 1; m < moments; m++)
                out->at[m][i] = 0;
            continue;
        }
        const float *box =
            level->boxes + ((size_t)y * level->columns + (size_t)column) * (size_t)moments;
        for (int m = 0; m < moments; m++)
            out->at[m][i] = box[m];
    }
}

/* The four boxes of half the width that each of count boxes is made of. */
static void read_quarters(const level_task *task, uint32_t x, uint32_t y, size_t count,
                          shb_moment_corners *out) {
    if (task->level == 0) {
        read_texels(task, (int32_t)x, (int32_t)y - 1, count, &out->at[0], &out->at[1]);
        read_texels(task, (int32_t)x, (int32_t)y, count, &out->at[2], &out->at[3]);
        return;
    }
    const shb_moment_level *finer = &task->pyramid->levels[task->level - 1];
    const int step = 1 << (spacing_shift(task->level) - spacing_shift(task->level - 1));
    const int reach = task->level > 1 ? 2 : 1;
    for (int k = 0; k < 4; k++)
        read_boxes(task->pyramid, finer, (int64_t)x * step + (k & 1 ? reach : -reach),
                   (int64_t)y * step + (k >> 1 ? reach : -reach), step, count, &out->at[k]);
}

static void build_row(void *arg, size_t y) {
    const level_task *task = arg;
    const shb_moment_level *level = &task->pyramid->levels[task->level];
    const size_t moments = (size_t)task->pyramid->count;
    shb_moment_corners quarters;
    for (size_t i = 0; i < SHB_BATCH; i++)
        quarters.x[i] = quarters.y[i] = 0.5f;
    for (uint32_t x = 0; x < level->columns; x += SHB_BATCH) {
        const size_t left = level->columns - x, count = left < SHB_BATCH ? left : SHB_BATCH;
        read_quarters(task, x, (uint32_t)y, count, &quarters);
        shb_moment_mix_corners(task->pyramid->count, count, &quarters);
        float *out = level->boxes + (y * level->columns + x) * moments;
        for (size_t i = 0; i < count; i++)
            for (size_t m = 0; m < moments; m++)
                out[i * moments + m] = quarters.at[0].at[m][i];
    }
}

/* Boxes of a level along an axis: up to the last one that is not all outside the map. */
static uint32_t boxes_along(uint32_t size, int level) {
    const int shift = spacing_shift(level);
    return ((size + (1u << shift) - 1) >> shift) + 2;
}

/* Sizes of all levels; returns how many floats they take. */
static size_t plan_levels(const shb_map_info *info, shb_moment_pyramid *pyramid) {
    const uint32_t size = info->width > info->height ? info->width : info->height;
    size_t boxes = 0;
    pyramid->level_count = 0;
    do {
        const int k = pyramid->level_count++;
        shb_moment_level *level = &pyramid->levels[k];
        level->columns = boxes_along(info->width, k);
        level->rows = boxes_along(info->height, k);
        boxes += (size_t)level->columns * level->rows;
    } while (1u << pyramid->level_count < size);
    return boxes * (size_t)pyramid->count;
}

bool shb_moment_pyramid_create(const shb_map *map, const shb_distance *distance,
                               shb_moment_pyramid *pyramid) {
    const size_t floats = plan_levels(&map->info, pyramid);
    float *boxes = shb_alloc(map->context, floats, sizeof *boxes);
    if (!boxes)
        return false;
    pyramid->bytes = floats * sizeof *boxes;
    for (int k = 0; k < pyramid->level_count; k++) {
        shb_moment_level *level = &pyramid->levels[k];
        level->boxes = boxes;
        boxes += (size_t)level->columns * level->rows * (size_t)pyramid->count;
        level_task task = {map, distance, pyramid, k};
        shb_parallel_for(map->context, build_row, &task, level->rows);
    }
    return true;
}

void shb_moment_pyramid_destroy(const shb_map *map, shb_moment_pyramid *pyramid) {
    shb_free(map->context, pyramid->levels[0].boxes);
}

/* ---- asking ---- */

/* A box of b texels has the second moment (b^2 - 1) / 12, and a mixture of two that lie s apart
 * adds s^2 / 4 at most. */
static float square_width_of(int level) {
    const float box = (float)(2 << level), spacing = (float)(1 << spacing_shift(level));
    return box * box - 1 + 3 * spacing * spacing;
}

float shb_moment_pyramid_least(void) {
    return square_width_of(0);
}

float shb_moment_pyramid_most(const shb_moment_pyramid *pyramid) {
    return square_width_of(pyramid->level_count - 1);
}

/* The finer level of each kernel, and how many parts of the coarser one it takes. */
typedef struct level_choice {
    int32_t level[SHB_BATCH];
    SHB_ALIGN float coarser[SHB_BATCH];
} level_choice;

static void choose_levels(const shb_moment_pyramid *pyramid, const float *square_widths,
                          size_t lanes, level_choice *out) {
    const int last = pyramid->level_count - 1;
    for (size_t i = 0; i < lanes; i++) {
        int level = 0;
        while (level < last - 1 && square_widths[i] > square_width_of(level + 1))
            level++;
        const float finer = square_width_of(level);
        out->level[i] = level;
        out->coarser[i] =
            last ? (square_widths[i] - finer) / (square_width_of(level + 1) - finer) : 0;
    }
}

/* A place along an axis, between two boxes of a level. */
static uint32_t place_between(int32_t texel, float to_center, uint32_t size, int level,
                              float *between) {
    const int shift = spacing_shift(level);
    const uint32_t at_least = texel > 0 ? (uint32_t)texel : 0;
    const uint32_t inside = at_least < size ? at_least : size - 1;
    const uint32_t box = inside >> shift;
    *between = ((float)(inside - (box << shift)) + (0.5f - to_center)) / (float)(1 << shift);
    return box;
}

static void read_level(const shb_map_info *info, const shb_moment_pyramid *pyramid,
                       const shb_receivers *r, const level_choice *choice, int coarser,
                       size_t lanes, shb_moment_corners *out) {
    const size_t moments = (size_t)pyramid->count;
    for (size_t i = 0; i < lanes; i++) {
        const int k = choice->level[i] + coarser;
        const shb_moment_level *level = &pyramid->levels[k];
        const size_t column =
            place_between(r->texel_x[i], r->to_center_x[i], info->width, k, &out->x[i]);
        const size_t row =
            place_between(r->texel_y[i], r->to_center_y[i], info->height, k, &out->y[i]);
        const float *first = level->boxes + (row * level->columns + column) * moments;
        const float *below = first + level->columns * moments;
        for (size_t m = 0; m < moments; m++) {
            out->at[0].at[m][i] = first[m];
            out->at[1].at[m][i] = first[m + moments];
            out->at[2].at[m][i] = below[m];
            out->at[3].at[m][i] = below[m + moments];
        }
    }
}

void shb_moment_pyramid_sample(const shb_moment_pyramid *pyramid, const shb_map_info *info,
                               const shb_receivers *receivers, const float *square_widths,
                               size_t count, shb_moment_batch *moments) {
    const size_t lanes = shb_round_to_lanes(count);
    level_choice choice;
    shb_moment_corners read;
    choose_levels(pyramid, square_widths, lanes, &choice);
    read_level(info, pyramid, receivers, &choice, 0, lanes, &read);
    shb_moment_mix_corners(pyramid->count, lanes, &read);
    *moments = read.at[0];
    if (pyramid->level_count == 1)
        return;
    read_level(info, pyramid, receivers, &choice, 1, lanes, &read);
    shb_moment_mix_corners(pyramid->count, lanes, &read);
    shb_moment_mix(pyramid->count, lanes, choice.coarser, moments, &read.at[0]);
}
