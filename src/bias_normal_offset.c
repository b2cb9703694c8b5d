/* Normal offset: Holbert, Saying goodbye to shadow acne, 2011. The point moves far enough along its
 * normal to clear the part of a texel that its plane spans, which grows with the sine. */
#include "strict.h"

#include "kernels/shade.h"

static void normal_offset(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->normal_offset(args);
}

static void normal_offset_depth(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->normal_offset_depth(args);
}

shb_bias shb_bias_normal_offset(float texels, float depth) {
    return (shb_bias){.name = "normal-offset",
                      .offset = normal_offset,
                      .depth = normal_offset_depth,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE,
                      .params = {texels, depth}};
}
