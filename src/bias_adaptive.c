/* Adaptive bias: Dou et al., Adaptive depth bias for shadow maps, 2014; with the epsilon of Ehm et
 * al., Adaptive depth bias for soft shadows, 2015.
 *
 * The potential occluder of a fragment, where the light ray through the texel's centre meets the
 * fragment's tangent plane, has the depth of that plane run to the texel's centre: a plane of the
 * world stays a plane in a planar map. The delta bias of Ehm et al. is the plane's slope. */
#include "strict.h"

#include "bias_stages.h"

/* The world length that the paper takes off: scene scale times K. */
static float world_epsilon(const shb_bias_args *args) {
    const float own_scale = args->bias->params[1];
    const float scene_scale = own_scale == 0 ? (float)args->map->scene_scale : own_scale;
    return scene_scale * args->bias->params[0];
}

static void adaptive_depth(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float epsilon = world_epsilon(args);
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++)
        shb_write_plane(r, i, r->depth_per_world[i] * epsilon);
}

shb_bias shb_bias_adaptive(float k, float scene_scale) {
    return (shb_bias){.name = "adaptive",
                      .depth = adaptive_depth,
                      .needs = SHB_NEEDS_SLOPE | SHB_NEEDS_SCALE,
                      .params = {k, scene_scale}};
}

static void adaptive_soft_depth(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float epsilon = world_epsilon(args);
    const float threshold = args->bias->params[2];
    shb_receivers *restrict r = args->receivers;
    for (size_t i = 0; i < lanes; i++) {
        const float steep = 1 / (r->cosine[i] * r->cosine[i]);
        const float factor = steep < threshold ? steep : threshold;
        shb_write_plane(r, i, r->depth_per_world[i] * epsilon * factor);
    }
}

shb_bias shb_bias_adaptive_soft(float k, float scene_scale, float threshold) {
    return (shb_bias){.name = "adaptive-soft",
                      .depth = adaptive_soft_depth,
                      .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SLOPE | SHB_NEEDS_SCALE,
                      .params = {k, scene_scale, threshold}};
}
