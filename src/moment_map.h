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

/* The receiver is taken nearer by the standard deviation of its own plane over a kernel of this
 * square width, texels. */
void shb_moment_receivers(const shb_distance *distance, const shb_receivers *receivers,
                          const float *square_widths, size_t count, shb_distance_batch *distances);

/* Receivers and the moments around them, one batch for each image of the filter. */
typedef struct shb_moment_question {
    size_t count;
    const float *params; /* of the filter */
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

/* For shb_filter.filter, over images; steady: the receiver stays where it is. */
void shb_moment_map_visibility(const shb_filter_args *args, shb_moment_judge *judge, bool steady,
                               float bleeding);

/* Takes the bleeding away, and lights fragments outside the map and those that are not a number. */
void shb_moment_finish(const shb_filter_args *args, float bleeding, const float *lit);

/* An upper bound of the part of a distribution that lies at or beyond t, from its mean and
 * variance: Chebyshev's inequality on one side. 1 where t is NaN. */
static inline float shb_chebyshev(float t, float mean, float variance) {
    const float d = t - mean;
    return d > 0 ? variance / (variance + d * d) : 1;
}

/* The mean of what lies below t in a distribution that meets that bound: all of the rest lies at
 * mean - variance / d. */
static inline float shb_chebyshev_below(float t, float mean, float variance) {
    return mean - variance / (t - mean);
}

#endif
