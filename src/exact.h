/* The exact method: a batch of fragments against the occluders that a map keeps. */
#ifndef SRC_EXACT_H
#define SRC_EXACT_H

#include "light_point.h"

/* What an element of a host's normal may be off by: four roundings of a unit vector in float. */
#define SHB_NORMAL_ERROR 0x1p-22

/* What snapping moves a corner by on either axis, in texels, and its rounding. */
#define SHB_SNAPPED_TEXELS (0x1p-9 * (1 + 0x1p-10))

#include "mutual_planes.inl"

/* A fragment as its own plane and place in the map, everything with bounds. */
typedef struct shb_exact_fragment {
    shb_light_point point;
    shb_light_slopes slopes;
    double error; /* of the point against its own plane */
} shb_exact_fragment;

static inline shb_exact_fragment shb_exact_fragment_of(const shb_light_rows *rows,
                                                       const double position[3],
                                                       const double normal[3]) {
    shb_exact_fragment fragment;
    fragment.point = shb_light_point_at(rows, position, SHB_FLOAT_ROUNDING);
    fragment.slopes = shb_exact_slopes_of(rows, &fragment.point, normal);
    fragment.error = shb_exact_error_of(&fragment.point, &fragment.slopes);
    return fragment;
}

/* The test of mutual planes for one texel, the fragment's own or any other: the sample lies in
 * front of the fragment's plane at the texel's centre, and the fragment behind the sample's plane
 * at its own place. */
static inline bool shb_exact_is_shadowed(const shb_exact_fragment *fragment,
                                         const shb_exact_sample *sample) {
    return shb_exact_shadowed_bits(&fragment->point, &fragment->slopes, fragment->error, sample) !=
           0;
}

/* The function exact of the filter hard. */
void shb_exact_visibility(const shb_filter_args *args);

/* True: the method asks occluders and the filter, or hard for NULL, is shb_exact_visibility. */
bool shb_exact_is_hard(const shb_bias *bias, const shb_filter *filter);

#endif
