/* Texel cone: a texel is seen from the light as a cone, and the point moves along its normal by the
 * most that the surface inside the cone can rise above it, with a share for filters. What renderers
 * use today. */
#include "strict.h"

#include "bias_stages.h"

#include <math.h>

static void texel_cone_offset(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float half_diagonal = 0.70710678f; /* of a texel of width 1 */
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++) {
        const float sine = sqrtf(1 - r->cosine[i] * r->cosine[i]);
        const float radius = half_diagonal * r->texel_size[i];
        shb_move_along_normal(r, i, radius * (1.16f * sine + 0.195f));
    }
}

shb_bias shb_bias_texel_cone(void) {
    return (shb_bias){.name = "texel-cone",
                      .offset = texel_cone_offset,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE};
}
