/* Slope-scaled bias: King, Shadow mapping algorithms, 2004; the polygon offset of OpenGL and
 * Direct3D, on the receiver's side. */
#include "strict.h"

#include "bias_stages.h"

#include <float.h>

static inline float magnitude(float value) {
    return value < 0 ? -value : value;
}

static void slope_depth(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float factor = args->bias->params[0];
    const float constant = args->bias->params[1] * 0x1p-24f;
    const float clamp = args->bias->params[2] == 0 ? FLT_MAX : args->bias->params[2];
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++) {
        const float x = magnitude(r->slope_x[i]), y = magnitude(r->slope_y[i]);
        const float offset = factor * (x > y ? x : y) + constant;
        shb_write_flat(r, i, offset < clamp ? offset : clamp);
    }
}

shb_bias shb_bias_slope(float factor, float units, float clamp) {
    return (shb_bias){.name = "slope",
                      .depth = slope_depth,
                      .needs = SHB_NEEDS_SLOPE,
                      .params = {factor, units, clamp}};
}
