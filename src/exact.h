/* The exact method: a batch of fragments against the occluders that a map keeps. */
#ifndef SRC_EXACT_H
#define SRC_EXACT_H

#include "light_point.h"

/* A fragment as its own plane and place in the map, everything with bounds. */
typedef struct shb_exact_fragment {
    shb_light_point point;
    shb_light_slopes slopes;
    double error; /* of the point against its own plane */
} shb_exact_fragment;

/* The occluder that a texel holds. */
typedef struct shb_exact_sample {
    double center_x, center_y, depth; /* never in front of the true plane at the centre */
    double slope_x, slope_y;
    double slope_error_x, slope_error_y;
} shb_exact_sample;

shb_exact_fragment shb_exact_fragment_of(const shb_light_rows *rows, const double position[3],
                                         const double normal[3]);

/* The test of mutual planes for one texel, the fragment's own or any other: the sample lies in
 * front of the fragment's plane at the texel's centre, and the fragment behind the sample's plane
 * at its own place. */
bool shb_exact_is_shadowed(const shb_exact_fragment *fragment, const shb_exact_sample *sample);

/* The function exact of the filter hard. */
void shb_exact_visibility(const shb_filter_args *args);

#endif
