/* Methods that shift what the map keeps instead of the fragment: the midpoint of the two nearest
 * layers (Woo, The shadow depth map revisited, 1992), the bounded midpoint (Weiskopf and Ertl,
 * Shadow mapping based on dual depth layers, 2003) and back faces (Wang and Molnar, Second-depth
 * shadow mapping, 1994). */
#include "strict.h"

#include "shadowbias/bias.h"

static void keep_midpoint(const shb_bias *bias, size_t count, const float *nearest,
                          const float *second, float *combined) {
    (void)bias;
    for (size_t i = 0; i < count; i++)
        combined[i] = nearest[i] + (second[i] - nearest[i]) * 0.5f;
}

shb_bias shb_bias_midpoint(void) {
    return (shb_bias){.name = "midpoint", .combine = keep_midpoint};
}

/* Equation 2 of the paper. */
static void keep_dual_layer(const shb_bias *bias, size_t count, const float *nearest,
                            const float *second, float *combined) {
    const float offset = bias->params[0];
    for (size_t i = 0; i < count; i++) {
        const float half = (second[i] - nearest[i]) * 0.5f;
        combined[i] = nearest[i] + (half < offset ? half : offset);
    }
}

shb_bias shb_bias_dual_layer(float offset) {
    return (shb_bias){.name = "dual-layer", .combine = keep_dual_layer, .params = {offset}};
}

shb_bias shb_bias_back_face(void) {
    return (shb_bias){.name = "back-face", .needs = SHB_NEEDS_FLIPPED};
}
