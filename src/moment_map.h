/* What the filters that average distances share: the images they prepare, and their receivers. */
#ifndef SRC_MOMENT_MAP_H
#define SRC_MOMENT_MAP_H

#include "moments.h"

enum { SHB_MOMENT_IMAGES_MAX = 2 };

typedef struct shb_moment_map {
    shb_distance distance;
    int size;        /* of the boxes, texels */
    int image_count; /* of them, each with its count and exponent set */
    shb_moment_image images[SHB_MOMENT_IMAGES_MAX];
} shb_moment_map;

/* Makes the images of plan, whose distance is not set yet; for shb_filter.prepare and .release. */
shb_result shb_moment_map_prepare(const shb_map *map, const char *name, const shb_moment_map *plan,
                                  void **prepared, size_t *bytes);
void shb_moment_map_release(const shb_map *map, void *prepared);

/* SHB_ERROR_ARGUMENT unless a parameter of the filter lies within lo .. hi. */
shb_result shb_filter_check_param(const shb_map *map, const shb_filter *filter, const char *param,
                                  float value, float lo, float hi);

/* SHB_ERROR_ARGUMENT unless the filter's size is odd and not too large. */
shb_result shb_filter_check_size(const shb_map *map, const shb_filter *filter, float size);

/* The receiver planes at the fragments' own places. */
typedef struct shb_distance_batch {
    SHB_ALIGN float at[SHB_BATCH]; /* distance, 0 .. 1; 0 where the plane is NaN */
    SHB_ALIGN float error[SHB_BATCH];
} shb_distance_batch;

/* spread: how many standard deviations of the plane's own depth over the boxes the receiver is
 * taken nearer. */
void shb_moment_receivers(const shb_moment_map *moments, const shb_receivers *receivers,
                          float spread, size_t count, shb_distance_batch *distances);

/* Fragments outside the map and those that are not a number are lit. */
void shb_light_outside(const shb_filter_args *args);

/* An upper bound of the part of a distribution that lies at or beyond t, from its mean and
 * variance: Chebyshev's inequality on one side. 1 where t is NaN. */
static inline float shb_chebyshev(float t, float mean, float variance) {
    const float d = t - mean;
    return d > 0 ? variance / (variance + d * d) : 1;
}

/* What lies below bleeding becomes 0, and the rest spans 0 .. 1 again (Lauritzen 2007). */
static inline float shb_less_bleeding(float lit, float bleeding) {
    return lit > bleeding ? (lit - bleeding) / (1 - bleeding) : 0;
}

#endif
