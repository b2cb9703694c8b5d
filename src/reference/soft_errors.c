/* Differences between soft shadows and the truth. */
#include "../strict.h"

#include "shadowbias/reference.h"

#include <math.h>

enum { WINDOW = 8 };

/* The stabilising constants (k L)^2 for values of the range L = 1. */
#define MEAN_CONSTANT (0.01 * 0.01)
#define VARIANCE_CONSTANT (0.03 * 0.03)

typedef struct frame {
    uint32_t width, height;
    const float *truth, *visibility;
    const uint8_t *mask;
} frame;

static bool counts(const frame *f, size_t pixel) {
    return !f->mask || f->mask[pixel];
}

/* False: a value is not finite. */
static bool sum_differences(const frame *f, shb_soft_errors *errors) {
    const size_t pixel_count = (size_t)f->width * f->height;
    double squares = 0, sizes = 0;
    for (size_t i = 0; i < pixel_count; i++) {
        if (!counts(f, i))
            continue;
        if (!isfinite(f->truth[i]) || !isfinite(f->visibility[i]))
            return false;
        const double difference = fabs((double)f->visibility[i] - (double)f->truth[i]);
        squares += difference * difference;
        sizes += difference;
        errors->largest = difference > errors->largest ? difference : errors->largest;
        errors->fragments++;
    }
    if (errors->fragments) {
        errors->rms = sqrt(squares / (double)errors->fragments);
        errors->mean = sizes / (double)errors->fragments;
    }
    return true;
}

/* What a window is made of. */
typedef struct moments {
    double count, m, n, mm, nn, mn;
} moments;

static double similarity_of(const moments *sums) {
    const double m = sums->m / sums->count, n = sums->n / sums->count;
    const double variance_m = sums->mm / sums->count - m * m;
    const double variance_n = sums->nn / sums->count - n * n;
    const double covariance = sums->mn / sums->count - m * n;
    return (2 * m * n + MEAN_CONSTANT) * (2 * covariance + VARIANCE_CONSTANT) /
           ((m * m + n * n + MEAN_CONSTANT) * (variance_m + variance_n + VARIANCE_CONSTANT));
}

static moments sum_window(const frame *f, size_t column, size_t row, size_t width, size_t height) {
    moments sums = {0};
    for (size_t j = row; j < row + height; j++)
        for (size_t i = column; i < column + width; i++) {
            const size_t pixel = j * f->width + i;
            if (!counts(f, pixel))
                continue;
            const double m = (double)f->truth[pixel], n = (double)f->visibility[pixel];
            sums.count += 1;
            sums.m += m;
            sums.n += n;
            sums.mm += m * m;
            sums.nn += n * n;
            sums.mn += m * n;
        }
    return sums;
}

static double mean_similarity(const frame *f) {
    const size_t width = f->width < WINDOW ? f->width : WINDOW;
    const size_t height = f->height < WINDOW ? f->height : WINDOW;
    double sum = 0, weight = 0;
    for (size_t row = 0; row + height <= f->height; row++)
        for (size_t column = 0; column + width <= f->width; column++) {
            const moments sums = sum_window(f, column, row, width, height);
            if (sums.count > 0)
                sum += sums.count * similarity_of(&sums);
            weight += sums.count;
        }
    return weight > 0 ? sum / weight : 1;
}

shb_result shb_soft_errors_measure(uint32_t width, uint32_t height, const float *truth,
                                   const float *visibility, const uint8_t *mask,
                                   shb_soft_errors *errors) {
    if (!truth || !visibility || !errors)
        return SHB_ERROR_ARGUMENT;
    if (width == 0 || height == 0)
        return SHB_ERROR_SIZE;
    const frame f = {width, height, truth, visibility, mask};
    shb_soft_errors measured = {0};
    if (!sum_differences(&f, &measured))
        return SHB_ERROR_NUMBER;
    measured.similarity = mean_similarity(&f);
    *errors = measured;
    return SHB_OK;
}
