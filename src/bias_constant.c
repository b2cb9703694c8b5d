/* No bias and the constant bias: Williams, Casting curved shadows on curved surfaces, 1978. */
#include "strict.h"

#include "kernels/shade.h"
#include "stages.h"

shb_bias shb_bias_none(void) {
    return (shb_bias){.name = "none"};
}

void shb_constant_depth(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->constant(args);
}

shb_bias shb_bias_constant(float amount, shb_unit unit) {
    const bool scaled = unit == SHB_UNIT_TEXEL || unit == SHB_UNIT_WORLD;
    return (shb_bias){.name = "constant",
                      .depth = shb_constant_depth,
                      .needs = scaled ? SHB_NEEDS_SCALE : 0,
                      .params = {amount, (float)unit}};
}
