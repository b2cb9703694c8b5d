/* The stages of built-in methods that other parts of the library know by their address. */
#ifndef SRC_STAGES_H
#define SRC_STAGES_H

#include "shadowbias/filter.h"

shb_bias_fn shb_constant_depth, shb_receiver_plane_depth, shb_adaptive_depth;
shb_filter_fn shb_hard_test;

/* True if the filter is pcf over boxes that reach as far to each side of a point's own texel,
 * wherever in it the point lies. */
bool shb_pcf_is_centered(const shb_filter *filter);

/* The world length that Dou et al. take off: scene scale times K. */
static inline float shb_world_epsilon(const shb_map_info *map, const shb_bias *bias) {
    const float own_scale = bias->params[1];
    const float scene_scale = own_scale == 0 ? (float)map->scene_scale : own_scale;
    return scene_scale * bias->params[0];
}

#endif
