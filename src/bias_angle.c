/* Bias weighted by the angle between normal and light: Gautron, Marvie and Briand, Method for
 * generating shadows in an image, EP 2411967, claims 1 to 3. */
#include "strict.h"

#include "kernels/shade.h"

static void angle_depth(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->angle(args);
}

shb_bias shb_bias_angle(float base, float limit) {
    return (shb_bias){.name = "angle",
                      .depth = angle_depth,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE,
                      .params = {base, limit}};
}
