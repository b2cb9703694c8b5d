/* Texel cone: a texel is seen from the light as a cone, and the point moves along its normal by the
 * most that the surface inside the cone can rise above it, the texel's radius times the sine. As
 * shadow_normal_offset of Blender's EEVEE, whose factors are these: 1.16 = 1 / cos(0.534), as its
 * normals may be turned by so much when they are stored, and 0.195, found by eye, for neighbouring
 * polygons. */
#include "strict.h"

#include "kernels/shade.h"

static void texel_cone_offset(const shb_bias_args *args) {
    shb_stage_kernels(args->kernels)->texel_cone(args);
}

shb_bias shb_bias_texel_cone(void) {
    return (shb_bias){.name = "texel-cone",
                      .offset = texel_cone_offset,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE};
}
