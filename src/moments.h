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

/* Sides of boxes are odd and at most this long. */
#define SHB_MOMENT_SIZE_MAX 63

/* Moments of a box: mean, variance, and where there are four the third and fourth about the mean.
 */
enum { SHB_MOMENTS_MAX = 4 };

/* What is averaged at distance x: x itself for exponent 0, else exp(exponent * (x - 0.5)) with the
 * sign of the exponent. It grows with x in any case. */
float shb_moment_warp(float exponent, float distance);

typedef struct shb_moment_image {
    uint32_t width, height; /* of the map and a border of one texel */
    int count;              /* moments of a texel: 2 or 4 */
    float exponent;
    float *texels;
} shb_moment_image;

/* The box of size x size texels; outside the map distance is 1. Works on the context's threads; the
 * bits do not depend on their number. Sets exponent and count before the call. False: no memory. */
bool shb_moment_image_create(const shb_map *map, const shb_distance *distance, int size,
                             shb_moment_image *image);

/* NULL texels are ignored. */
void shb_moment_image_destroy(const shb_map *map, shb_moment_image *image);

size_t shb_moment_image_bytes(const shb_moment_image *image);

/* One array for each moment, filled up to whole vectors of lanes. */
typedef struct shb_moment_batch {
    SHB_ALIGN float at[SHB_MOMENTS_MAX][SHB_BATCH];
} shb_moment_batch;

/* The distributions at the four corners of a cell, and a place in it, 0 .. 1 from the left and from
 * the top. */
typedef struct shb_moment_corners {
    shb_moment_batch at[4]; /* row by row */
    SHB_ALIGN float x[SHB_BATCH], y[SHB_BATCH];
} shb_moment_corners;

/* 1 - f parts of a and f parts of b, into a. */
void shb_moment_mix(int count, size_t lanes, const float *restrict f, shb_moment_batch *restrict a,
                    const shb_moment_batch *restrict b);

/* The mixture at the place, into the first corner. */
void shb_moment_mix_corners(int count, size_t lanes, shb_moment_corners *corners);

/* The moments between the four texels around each fragment. Those of fragments outside the map mean
 * nothing. */
void shb_moment_image_sample(const shb_moment_image *image, const shb_receivers *receivers,
                             size_t count, shb_moment_batch *moments);

#endif
