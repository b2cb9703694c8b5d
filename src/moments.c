#include "strict.h"

#include "moments.h"

#include "depth_rows.h"
#include "kernels/moments.h"

/* Rows of an image that one task makes; the boxes of the rows between two tasks are made twice. */
enum { TASK_ROWS = 256 };

typedef struct blur {
    const shb_map *map;
    const shb_moment_kernels *kernels;
    const shb_distance *distance;
    const shb_moment_image *image;
    int size;
    uint32_t tasks_across;
} blur;

/* A stretch of columns, and the boxes of one row of it that make the next row of the image. */
typedef struct strip {
    uint32_t x, count;
    float boxes[SHB_MOMENT_SIZE_MAX][SHB_MOMENTS_MAX][SHB_MOMENT_SPAN];
} strip;

void shb_moment_values(const shb_map *map, const shb_distance *distance, float exponent, int32_t x,
                       int32_t y, size_t count, float *values) {
    shb_depth_row(map, x, y, count, values);
    shb_moment_kernels_of(map->context->isa)->warp(distance, exponent, count, values);
}

/* Row y of the map. */
static void blur_row(const blur *b, strip *s, int32_t y, int place) {
    const int32_t left = (int32_t)s->x - b->size / 2 - 1;
    float values[SHB_MOMENT_READ];
    shb_moment_values(b->map, b->distance, b->image->exponent, left, y,
                      s->count + (size_t)b->size - 1, values);
    b->kernels->mix_neighbours(b->image->count, b->size, s->count, values, s->boxes[place]);
}

/* Row y of the image is that of row y - 1 of the map; next is the place of the oldest row. */
static void write_row(const blur *b, const strip *s, uint32_t y, int next) {
    const shb_moment_image *image = b->image;
    const shb_moment_row *rows[SHB_MOMENT_SIZE_MAX];
    for (int k = 0; k < b->size; k++)
        rows[k] = s->boxes[(next + k) % b->size];
    b->kernels->mix_rows(image->count, b->size, s->count, rows,
                         image->texels + ((size_t)y * image->width + s->x) * (size_t)image->count);
}

static void blur_block(void *arg, size_t index) {
    const blur *b = arg;
    const uint32_t top = (uint32_t)index / b->tasks_across * TASK_ROWS;
    const uint32_t left = b->image->height - top, rows = left < TASK_ROWS ? left : TASK_ROWS;
    strip s;
    s.x = (uint32_t)index % b->tasks_across * SHB_MOMENT_SPAN;
    s.count = b->image->width - s.x < SHB_MOMENT_SPAN ? b->image->width - s.x : SHB_MOMENT_SPAN;
    const int32_t first = (int32_t)top - 1 - b->size / 2;
    for (int k = 0; k < b->size - 1; k++)
        blur_row(b, &s, first + k, k);
    for (uint32_t row = 0; row < rows; row++) {
        const int newest = ((int)row + b->size - 1) % b->size;
        blur_row(b, &s, first + (int32_t)row + b->size - 1, newest);
        write_row(b, &s, top + row, (newest + 1) % b->size);
    }
}

bool shb_moment_image_create(const shb_map *map, shb_moment_image *image) {
    image->width = map->info.width + 2;
    image->height = map->info.height + 2;
    image->texels = shb_alloc(map->context, image->height,
                              (size_t)image->count * image->width * sizeof *image->texels);
    return image->texels != NULL;
}

void shb_moment_image_fill(const shb_map *map, const shb_distance *distance, int size,
                           shb_moment_image *image) {
    const blur b = {.map = map,
                    .kernels = shb_moment_kernels_of(map->context->isa),
                    .distance = distance,
                    .image = image,
                    .size = size,
                    .tasks_across = (image->width + SHB_MOMENT_SPAN - 1) / SHB_MOMENT_SPAN};
    const uint32_t tasks_down = (image->height + TASK_ROWS - 1) / TASK_ROWS;
    shb_parallel_for(map->context, blur_block, (void *)&b, (size_t)b.tasks_across * tasks_down);
}

void shb_moment_image_destroy(const shb_map *map, shb_moment_image *image) {
    shb_free(map->context, image->texels);
    image->texels = NULL;
}

size_t shb_moment_image_bytes(const shb_moment_image *image) {
    return (size_t)image->count * image->width * image->height * sizeof(float);
}
