/* What the built-in methods share. */
#ifndef SRC_BIAS_STAGES_H
#define SRC_BIAS_STAGES_H

#include "project.h"
#include "shadowbias/bias.h"

/* Writes ref = depth - epsilon and no steps. */
static inline void shb_write_flat(shb_receivers *receivers, size_t i, float epsilon) {
    receivers->ref[i] = receivers->depth[i] - epsilon;
    receivers->step_x[i] = 0;
    receivers->step_y[i] = 0;
}

/* Writes the plane through the fragment: run to the texel's centre, less epsilon. */
static inline void shb_write_plane(shb_receivers *receivers, size_t i, float epsilon) {
    const float slope_x = receivers->slope_x[i], slope_y = receivers->slope_y[i];
    const float run = slope_x * receivers->to_center_x[i] + slope_y * receivers->to_center_y[i];
    receivers->ref[i] = (receivers->depth[i] + run) - epsilon;
    receivers->step_x[i] = slope_x;
    receivers->step_y[i] = slope_y;
}

/* Moves the point along its normal, world units. */
static inline void shb_move_along_normal(shb_receivers *receivers, size_t i, float distance) {
    receivers->x[i] += distance * receivers->normal_x[i];
    receivers->y[i] += distance * receivers->normal_y[i];
    receivers->z[i] += distance * receivers->normal_z[i];
}

#endif
