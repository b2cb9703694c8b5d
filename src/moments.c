#include "strict.h"

#include "moments.h"

#include <string.h>

#include "depth_rows.h"
#include "exponential.h"

/* Texels of a row that are worked on at once. */
enum { SPAN = 256, SPAN_READ = SPAN + SHB_MOMENT_SIZE_MAX - 1 };

/* Moments of texels side by side. */
typedef struct moment_rows {
    float *mean, *variance, *third, *fourth;
} moment_rows;

typedef struct blur {
    const shb_map *map;
    const shb_distance *distance;
    const shb_moment_image *image;
    int size;
    float *rows; /* boxes of one row: for each row of the map, and for one outside of it, count
                    arrays of the image's width */
} blur;

float shb_moment_warp(float exponent, float distance) {
    if (exponent == 0)
        return distance;
    const float warped = shb_exponential(exponent * (distance - 0.5f));
    return exponent > 0 ? warped : -warped;
}

/* ---- along rows ---- */

/* The mean of size neighbours each, taken from the middle one on so that equal values give
 * themselves, and their moments about it. */
static void mix_neighbours(int size, bool four, size_t count, const float *restrict values,
                           const moment_rows *out) {
    float mean[SPAN] = {0}, variance[SPAN] = {0}, third[SPAN] = {0}, fourth[SPAN] = {0};
    const float parts = (float)size;
    const float *middle = values + size / 2;
    for (int k = 0; k < size; k++)
        for (size_t i = 0; i < count; i++)
            mean[i] += values[i + (size_t)k] - middle[i];
    for (size_t i = 0; i < count; i++)
        mean[i] = middle[i] + mean[i] / parts;
    for (int k = 0; k < size; k++)
        for (size_t i = 0; i < count; i++) {
            const float d = values[i + (size_t)k] - mean[i];
            variance[i] += d * d;
        }
    for (int k = 0; k < size && four; k++)
        for (size_t i = 0; i < count; i++) {
            const float d = values[i + (size_t)k] - mean[i], d2 = d * d;
            third[i] += d2 * d;
            fourth[i] += d2 * d2;
        }
    for (size_t i = 0; i < count; i++) {
        out->mean[i] = mean[i];
        out->variance[i] = variance[i] / parts;
    }
    for (size_t i = 0; i < count && four; i++) {
        out->third[i] = third[i] / parts;
        out->fourth[i] = fourth[i] / parts;
    }
}

static moment_rows rows_at(const blur *b, size_t y, size_t x) {
    const size_t width = b->image->width;
    float *row = b->rows + y * (size_t)b->image->count * width + x;
    const bool four = b->image->count == 4;
    return (moment_rows){row, row + width, four ? row + 2 * width : NULL,
                         four ? row + 3 * width : NULL};
}

static void blur_row(void *arg, size_t y) {
    const blur *b = arg;
    const int reach = b->size / 2 + 1;
    const size_t width = b->image->width;
    for (size_t x = 0; x < width; x += SPAN) {
        const size_t count = width - x < SPAN ? width - x : SPAN;
        const size_t read = count + (size_t)b->size - 1;
        float values[SPAN_READ];
        shb_depth_row(b->map, (int32_t)x - reach, (int32_t)y, read, values);
        for (size_t i = 0; i < read; i++)
            values[i] = shb_distance_at(b->distance, values[i]);
        for (size_t i = 0; i < read && b->image->exponent != 0; i++)
            values[i] = shb_moment_warp(b->image->exponent, values[i]);
        const moment_rows out = rows_at(b, y, x);
        mix_neighbours(b->size, b->image->count == 4, count, values, &out);
    }
}

/* ---- along columns ---- */

/* The boxes of one row that boxes around row y are made of. */
static void find_rows(const blur *b, size_t y, size_t x, moment_rows *rows) {
    const int64_t height = b->map->info.height;
    for (int k = 0; k < b->size; k++) {
        const int64_t row = (int64_t)y - b->size / 2 + k;
        rows[k] = rows_at(b, (size_t)(row >= 0 && row < height ? row : height), x);
    }
}

/* The mean of all means, as along rows. */
static void mix_means(int size, size_t count, const moment_rows *rows, float *restrict mean) {
    const float *middle = rows[size / 2].mean;
    for (size_t i = 0; i < count; i++)
        mean[i] = 0;
    for (int k = 0; k < size; k++) {
        const float *part = rows[k].mean;
        for (size_t i = 0; i < count; i++)
            mean[i] += part[i] - middle[i];
    }
    for (size_t i = 0; i < count; i++)
        mean[i] = middle[i] + mean[i] / (float)size;
}

static void mix_variances(int size, size_t count, const moment_rows *rows,
                          const float *restrict mean, float *restrict variance) {
    for (size_t i = 0; i < count; i++)
        variance[i] = 0;
    for (int k = 0; k < size; k++)
        for (size_t i = 0; i < count; i++) {
            const float d = rows[k].mean[i] - mean[i];
            variance[i] += rows[k].variance[i] + d * d;
        }
    for (size_t i = 0; i < count; i++)
        variance[i] /= (float)size;
}

/* With d from the common mean to the part's: E(x + d)^3 = third + 3 variance d + d^3, and E(x +
 * d)^4 = fourth + 4 third d + 6 variance d^2 + d^4. */
static void mix_higher(int size, size_t count, const moment_rows *rows, const float *restrict mean,
                       float *restrict third, float *restrict fourth) {
    for (size_t i = 0; i < count; i++)
        third[i] = fourth[i] = 0;
    for (int k = 0; k < size; k++) {
        const moment_rows part = rows[k];
        for (size_t i = 0; i < count; i++) {
            const float d = part.mean[i] - mean[i], d2 = d * d;
            third[i] += part.third[i] + d * (3 * part.variance[i] + d2);
            fourth[i] += part.fourth[i] + 4 * d * part.third[i] + d2 * (6 * part.variance[i] + d2);
        }
    }
    for (size_t i = 0; i < count; i++) {
        third[i] /= (float)size;
        fourth[i] /= (float)size;
    }
}

/* Row y of the image is that of row y - 1 of the map. */
static void blur_columns(void *arg, size_t y) {
    const blur *b = arg;
    const shb_moment_image *image = b->image;
    const int count = image->count;
    moment_rows rows[SHB_MOMENT_SIZE_MAX];
    float mixed[SHB_MOMENTS_MAX][SPAN];
    for (size_t x = 0; x < image->width; x += SPAN) {
        const size_t part = image->width - x < SPAN ? image->width - x : SPAN;
        find_rows(b, y - 1, x, rows);
        mix_means(b->size, part, rows, mixed[0]);
        mix_variances(b->size, part, rows, mixed[0], mixed[1]);
        if (count == 4)
            mix_higher(b->size, part, rows, mixed[0], mixed[2], mixed[3]);
        float *out = image->texels + (y * image->width + x) * (size_t)count;
        for (size_t i = 0; i < part; i++)
            for (int m = 0; m < count; m++)
                out[i * (size_t)count + (size_t)m] = mixed[m][i];
    }
}

/* ---- images ---- */

bool shb_moment_image_create(const shb_map *map, const shb_distance *distance, int size,
                             shb_moment_image *image) {
    const shb_context *context = map->context;
    image->width = map->info.width + 2;
    image->height = map->info.height + 2;
    const size_t row_bytes = (size_t)image->count * image->width * sizeof(float);
    blur b = {.map = map, .distance = distance, .image = image, .size = size};
    b.rows = shb_alloc(context, (size_t)map->info.height + 1, row_bytes);
    image->texels = shb_alloc(context, image->height, row_bytes);
    if (!b.rows || !image->texels) {
        shb_free(context, b.rows);
        shb_moment_image_destroy(map, image);
        return false;
    }
    shb_parallel_for(context, blur_row, &b, (size_t)map->info.height + 1);
    shb_parallel_for(context, blur_columns, &b, image->height);
    shb_free(context, b.rows);
    return true;
}

void shb_moment_image_destroy(const shb_map *map, shb_moment_image *image) {
    shb_free(map->context, image->texels);
    image->texels = NULL;
}

size_t shb_moment_image_bytes(const shb_moment_image *image) {
    return (size_t)image->count * image->width * image->height * sizeof(float);
}
