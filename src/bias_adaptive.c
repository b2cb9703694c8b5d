/* Adaptive bias: Dou et al., Adaptive depth bias for shadow maps, 2014; with the epsilon of Ehm et
 * al., Adaptive depth bias for soft shadows, 2015.
 *
 * The potential occluder of a fragment, where the light ray through the texel's centre meets the
 * fragment's tangent plane, has the depth of that plane run to the texel's centre: a plane of the
 * world stays a plane in a planar map. The delta bias of Ehm et al. is the plane's slope. */
#include "strict.h"

#include "kernels/shade.h"
#include "stages.h"

void shb_adaptive_depth(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->adaptive(args);
}

shb_bias shb_bias_adaptive(float k, float scene_scale) {
    return (shb_bias){.name = "adaptive",
                      .depth = shb_adaptive_depth,
                      .needs = SHB_NEEDS_SLOPE | SHB_NEEDS_SCALE,
                      .params = {k, scene_scale}};
}

static void adaptive_soft_depth(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->adaptive_soft(args);
}

shb_bias shb_bias_adaptive_soft(float k, float scene_scale, float threshold) {
    return (shb_bias){.name = "adaptive-soft",
                      .depth = adaptive_soft_depth,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SLOPE | SHB_NEEDS_SCALE,
                      .params = {k, scene_scale, threshold}};
}
