/* Normal offset: Holbert, Saying goodbye to shadow acne, 2011. The point moves far enough along its
 * normal to clear the part of a texel that its plane spans, which grows with the sine. */
#include "strict.h"

#include "bias_stages.h"

#include <math.h>

static void normal_offset(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float texels = args->bias->params[0];
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++) {
        const float sine = sqrtf(1 - r->cosine[i] * r->cosine[i]);
        shb_move_along_normal(r, i, texels * r->texel_size[i] * sine);
    }
}

static void normal_offset_depth(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float depth = args->bias->params[1];
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++)
        shb_write_flat(r, i, depth);
}

shb_bias shb_bias_normal_offset(float texels, float depth) {
    return (shb_bias){.name = "normal-offset",
                      .offset = normal_offset,
                      .depth = normal_offset_depth,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE,
                      .params = {texels, depth}};
}
