/* What the filters that average distances share: the images they prepare, and their receivers. */
#ifndef SRC_MOMENT_MAP_H
#define SRC_MOMENT_MAP_H

#include "moments.h"

typedef struct shb_moment_map {
    shb_distance distance;
    int size;        /* of the boxes, texels */
    int image_count; /* of them, each with its count and exponent set */
    shb_moment_image images[SHB_MOMENT_IMAGES_MAX];
} shb_moment_map;

/* Makes the images of plan, whose distance is not set yet; for shb_filter.prepare and .release. */
shb_result shb_moment_map_prepare(const shb_map *map, const shb_filter *filter,
                                  const shb_moment_map *plan, void **prepared, size_t *bytes);
void shb_moment_map_release(const shb_map *map, void *prepared);

/* SHB_ERROR_ARGUMENT unless the filter's size is odd and not too large. */
shb_result shb_filter_check_size(const shb_map *map, const shb_filter *filter, float size);

/* For shb_filter.filter, over images; steady: the receiver stays where it is. */
void shb_moment_map_visibility(const shb_filter_args *args, shb_moment_judge *judge, bool steady,
                               float bleeding);

/* Takes the bleeding away, and lights fragments outside the map and those that are not a number. */
void shb_moment_finish(const shb_filter_args *args, float bleeding, const float *lit);

#endif
