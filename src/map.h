/* The inside of a shadow map. */
#ifndef SRC_MAP_H
#define SRC_MAP_H

#include "context.h"
#include "shadowbias/map.h"

/* What turns a world position into map coordinates, once per map, in double. */
typedef struct shb_projection {
    double row_x[4], row_y[4], row_z[4], row_w[4]; /* rows of clip_from_world */
    bool affine;                                   /* w is 1 everywhere: no division */
    double width, height;                          /* of the map, texels */
    /* The map's depth falls towards the light after multiplication by sign: 1, or -1 when reversed.
     */
    double sign;
    /* The light: a point, or a unit direction towards it when light_w is 0. */
    double light[3], light_w;
    /* For a point with clip w: width of a texel = texel_scale * w, change of canonical depth per
     * world unit away from the light = depth_scale / w^2. */
    double texel_scale, depth_scale;
    /* Cross products of the rows' first three elements, which the slopes of a plane are made of. */
    double x_cross_y[3], x_cross_w[3], y_cross_w[3], z_cross_y[3], z_cross_w[3], x_cross_z[3];
} shb_projection;

struct shb_map {
    shb_context *context;
    shb_map_info info;
    shb_projection projection;
    shb_depth_image depth;
    bool owned;    /* texels were allocated by the map */
    bool empty;    /* owned and not drawn yet: serves every method */
    bool measures; /* scene_scale is that of what is drawn */
    /* what the depths are: the method's combine stage and culling */
    shb_combine_fn *combine;
    float combine_params[SHB_PARAMS_MAX];
    const void *combine_user;
    bool flipped;
};

/* Makes the map hold what the method draws into it. */
void shb_map_set_method(shb_map *map, const shb_bias *bias);

#endif
