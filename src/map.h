/* The inside of a shadow map. */
#ifndef SRC_MAP_H
#define SRC_MAP_H

#include "context.h"
#include "shadowbias/map.h"

/* What turns a world position into map coordinates, once per map, in double. */
typedef struct shb_projection {
    double row_x[4], row_y[4], row_z[4], row_w[4]; /* rows of clip_from_world */
    bool affine;                                   /* w is 1 everywhere: no division */
    /* The map's depth falls towards the light after multiplication by sign: 1, or -1 when reversed. */
    double sign;
    /* For a point with clip w: width of a texel = texel_scale * w, change of canonical depth per world
     * unit away from the light = depth_scale / w^2 (both with w = 1 when affine). */
    double texel_scale, depth_scale;
} shb_projection;

struct shb_map {
    shb_context *context;
    shb_map_info info;
    shb_projection projection;
    shb_depth_image depth;
    bool owned; /* texels were allocated by the map */
    /* what the depths are: the method's combine stage and culling */
    shb_combine_fn *combine;
    float combine_params[SHB_PARAMS_MAX];
    const void *combine_user;
    bool flipped;
};

#endif
