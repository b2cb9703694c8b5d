/* Receiver plane bias: Isidoro, Shadow mapping: GPU-based tips and techniques, 2006; from the exact
 * plane of the fragment instead of screen-space derivatives. */
#include "strict.h"

#include "kernels/shade.h"
#include "stages.h"

void shb_receiver_plane_depth(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->receiver_plane(args);
}

shb_bias shb_bias_receiver_plane(float epsilon) {
    return (shb_bias){.name = "receiver-plane",
                      .depth = shb_receiver_plane_depth,
                      .needs = SHB_NEEDS_SLOPE,
                      .params = {epsilon}};
}
