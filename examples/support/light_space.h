/* A map's space in double: texels to the right and down, and canonical depth, in which planes stay
 * planes. For tools that check what the library answers. */
#ifndef EXAMPLES_LIGHT_SPACE_H
#define EXAMPLES_LIGHT_SPACE_H

#include "shadowbias/bias.h"

typedef struct light_space {
    shb_mat4 clip_from_world, world_from_clip;
    double width, height; /* texels */
    bool reversed;
} light_space;

typedef struct light_point {
    double x, y;  /* texels; row 0 is the top one */
    double depth; /* smaller is nearer, 0 .. 1, or -1 .. 0 of a reversed map */
} light_point;

/* depth = x * per_x + y * per_y + at_origin; not finite for a plane that holds light rays. */
typedef struct light_plane {
    double per_x, per_y, at_origin;
} light_plane;

shb_result light_space_create(const shb_map_info *info, light_space *space);

/* A point in front of the light. */
light_point light_space_project(const light_space *space, shb_vec3 point);
shb_vec3 light_space_unproject(const light_space *space, light_point point);

light_plane light_space_plane(const light_space *space, const shb_vec3 corners[3]);
double light_plane_at(const light_plane *plane, double x, double y);

#endif
