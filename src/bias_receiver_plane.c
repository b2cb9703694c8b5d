/* Receiver plane bias: Isidoro, Shadow mapping: GPU-based tips and techniques, 2006; from the exact
 * plane of the fragment instead of screen-space derivatives. */
#include "strict.h"

#include "bias_stages.h"

static void receiver_plane_depth(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float epsilon = args->bias->params[0];
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++)
        shb_write_plane(r, i, epsilon);
}

shb_bias shb_bias_receiver_plane(float epsilon) {
    return (shb_bias){.name = "receiver-plane",
                      .depth = receiver_plane_depth,
                      .needs = SHB_NEEDS_SLOPE,
                      .params = {epsilon}};
}
