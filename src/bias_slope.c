/* Slope-scaled bias: King, Shadow mapping algorithms, 2004; the polygon offset of OpenGL and
 * Direct3D, on the receiver's side. */
#include "strict.h"

#include "kernels/shade.h"

static void slope_depth(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->slope(args);
}

shb_bias shb_bias_slope(float factor, float units, float clamp) {
    return (shb_bias){.name = "slope",
                      .depth = slope_depth,
                      .needs = SHB_NEEDS_SLOPE,
                      .params = {factor, units, clamp}};
}
