/* Percentage-closer soft shadows over moments of distance (Yang, Dong, Feng, Seidel and Kautz 2010;
 * Peters, Muenstermann, Wetzstein and Klein 2017): the moments of one kernel tell how far away its
 * blockers are, those of a second one, as wide as their penumbra, how much light gets through. */
#ifndef SRC_MOMENT_SOFT_H
#define SRC_MOMENT_SOFT_H

#include "light_span.h"
#include "moment_map.h"
#include "moment_pyramid.h"

typedef struct shb_moment_soft {
    shb_distance distance;
    shb_light_span span;
    int image_count; /* of pyramids, each with its count and exponent set */
    shb_moment_pyramid images[SHB_MOMENT_IMAGES_MAX];
} shb_moment_soft;

/* Reads the light's size, the first parameter, and makes the pyramids of plan; for
 * shb_filter.prepare and .release. */
shb_result shb_moment_soft_prepare(const shb_map *map, const shb_filter *filter,
                                   const shb_moment_soft *plan, void **prepared, size_t *bytes);
void shb_moment_soft_release(const shb_map *map, void *prepared);

/* For shb_filter.filter. */
void shb_moment_soft_visibility(const shb_filter_args *args, shb_moment_judge *judge,
                                float bleeding);

#endif
