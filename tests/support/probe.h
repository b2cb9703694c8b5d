/* Looks into a question to a map: what a bias method made of one fragment. */
#ifndef TESTS_SUPPORT_PROBE_H
#define TESTS_SUPPORT_PROBE_H

#include "shadowbias/map.h"

/* One element of every array of shb_receivers. */
typedef struct probe {
    double x, y, z;
    double normal_x, normal_y, normal_z, cosine;
    double texel_size, depth_per_world;
    int texel_x, texel_y;
    double to_center_x, to_center_y, depth;
    double slope_x, slope_y;
    double ref, step_x, step_y;
} probe;

typedef struct probe_light {
    shb_view view;
    uint32_t width, height;
    double scene_scale;
} probe_light;

/* Asks an empty map of the light, 64 x 64 texels at most, by a filter that keeps the receivers.
 * What the method does not need is filled in as well. */
probe probe_fragment(const probe_light *light, const shb_bias *bias, shb_vec3 point,
                     shb_vec3 normal);

/* A view from its rows. */
shb_view probe_view(const double rows[4][4], bool reversed);

/* Width 2, height 2 about the z axis, looking down: depth (4 - z) / 8, or its complement to 1. */
shb_view probe_orthographic(bool reversed);

/* A spot at (0, 0, 4) looking down with a right angle: w = 4 - z, near 1, far 3, and so
 * depth 1.5 - 1.5 / w, or its complement. */
shb_view probe_perspective(bool reversed);

#endif
