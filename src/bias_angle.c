/* Bias weighted by the angle between normal and light: Gautron, Marvie and Briand, Method for
 * generating shadows in an image, EP 2411967, claims 1 to 3. */
#include "strict.h"

#include "bias_stages.h"

static void angle_depth(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float scene_scale = (float)args->map->scene_scale;
    const float base = args->bias->params[0] * scene_scale;
    const float limit = args->bias->params[1] * scene_scale;
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++) {
        const float distance = base / r->cosine[i];
        shb_write_flat(r, i, (distance < limit ? distance : limit) * r->depth_per_world[i]);
    }
}

shb_bias shb_bias_angle(float base, float limit) {
    return (shb_bias){.name = "angle",
                      .depth = angle_depth,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE,
                      .params = {base, limit}};
}
