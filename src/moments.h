/* Images of the moments of distance over a box of texels around each one: what variance,
 * exponential variance and moment maps are made of.
 *
 * Moments are kept about their own mean. Boxes are mixed, by rows, by columns and between the
 * texels around a fragment, by moving the moments of each part to the common mean: all even terms
 * are sums of what is positive, and nothing is lost to the difference of large numbers. So floats
 * hold what raw moments need doubles for. */
#ifndef SRC_MOMENTS_H
#define SRC_MOMENTS_H

#include "distance.h"
#include "exponential.h"

/* Sides of boxes are odd and at most this long. */
#define SHB_MOMENT_SIZE_MAX 63

/* Moments of a box: mean, variance, and where there are four the third and fourth about the mean.
 */
enum { SHB_MOMENTS_MAX = 4 };

/* What is averaged at distance x: x itself for exponent 0, else exp(exponent * (x - 0.5)) with the
 * sign of the exponent. It grows with x in any case. */
static inline float shb_moment_warp(float exponent, float distance) {
    if (exponent == 0)
        return distance;
    const float warped = shb_exponential(exponent * (distance - 0.5f));
    return exponent > 0 ? warped : -warped;
}

/* That of count texels of a row. */
void shb_moment_values(const shb_map *map, const shb_distance *distance, float exponent, int32_t x,
                       int32_t y, size_t count, float *values);

typedef struct shb_moment_image {
    uint32_t width, height; /* of the map and a border of one texel */
    int count;              /* moments of a texel: 2 or 4 */
    float exponent;
    float *texels;
} shb_moment_image;

/* The texels of an image for the map, whose exponent and count are set. False: no memory. */
bool shb_moment_image_create(const shb_map *map, shb_moment_image *image);

/* The box of size x size texels; outside the map distance is 1. Works on the context's threads; the
 * bits do not depend on their number. */
void shb_moment_image_fill(const shb_map *map, const shb_distance *distance, int size,
                           shb_moment_image *image);

/* NULL texels are ignored. */
void shb_moment_image_destroy(const shb_map *map, shb_moment_image *image);

size_t shb_moment_image_bytes(const shb_moment_image *image);

/* One array for each moment, filled up to whole vectors of lanes. */
typedef struct shb_moment_batch {
    SHB_ALIGN float at[SHB_MOMENTS_MAX][SHB_BATCH];
} shb_moment_batch;

/* Of one filter. */
enum { SHB_MOMENT_IMAGES_MAX = 2 };

/* The receiver planes at the fragments' own places. */
typedef struct shb_distance_batch {
    SHB_ALIGN float at[SHB_BATCH]; /* distance, 0 .. 1; 0 where the plane is NaN */
    SHB_ALIGN float error[SHB_BATCH];
} shb_distance_batch;

/* Receivers and the moments around them, one batch for each image of the filter. */
typedef struct shb_moment_question {
    size_t count;
    const float *exponents; /* of the images */
    const shb_distance_batch *receiver;
    const shb_moment_batch *images;
} shb_moment_question;

typedef struct shb_moment_answer {
    SHB_ALIGN float lit[SHB_BATCH]; /* an upper bound of what does not lie in front */
    float blocker[SHB_BATCH]; /* a mean distance of what does, 0 .. 1; means nothing where all is
                                 lit */
} shb_moment_answer;

/* What a filter makes of moments. */
typedef void shb_moment_judge(const shb_moment_question *question, shb_moment_answer *answer);

#endif
