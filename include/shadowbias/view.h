/* Views: where a camera or a light stands and what it sees.
 *
 * The matrix is the definition of a light: its rays are the lines that share one (x / w, y / w),
 * and its position is the null vector of the rows x, y and w (a point, or a direction if that lies
 * at infinity). So map and shadow test can never disagree on where the light is. */
#ifndef SHADOWBIAS_VIEW_H
#define SHADOWBIAS_VIEW_H

#include "shadowbias/math.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_view {
    shb_mat4 clip_from_world;
    bool reversed; /* depth 1 at the near plane, 0 at the far plane: a light at infinity lies on the
                      side where depth is nearest */
} shb_view;

/* Perspective camera; arguments as in shb_mat4_look_at and shb_mat4_perspective. SHB_ERROR_ARGUMENT
 * if they are out of range or eye equals target, SHB_ERROR_NUMBER if one is not finite (the far
 * distance may be infinite) or so large or small that the matrix has no inverse in double. */
shb_result shb_view_perspective(shb_vec3 eye, shb_vec3 target, shb_vec3 up, double vertical_angle,
                                double aspect, double near_distance, double far_distance,
                                bool reversed, shb_view *view);

/* Orthographic camera; half sizes above 0 and distances in world units, near < far, also behind the
 * eye; all of them finite. Errors as above. */
shb_result shb_view_orthographic(shb_vec3 eye, shb_vec3 target, shb_vec3 up, double half_width,
                                 double half_height, double near_distance, double far_distance,
                                 bool reversed, shb_view *view);

/* A directional light over the bounds: a square orthographic frustum that holds the box, with a
 * margin of two texels. to_light points from the scene to the light. The frustum's size is rounded
 * up and its origin snapped to whole texels, so that small moves of the box leave the texel grid
 * where it is in the world (no crawling edges). A box without width gets a thin frustum of some
 * size. map_size in texels, 8 .. SHB_SIZE_MAX, or SHB_ERROR_SIZE. SHB_ERROR_ARGUMENT for an empty
 * box or a zero direction, SHB_ERROR_NUMBER for a number that is not finite or too large. */
shb_result shb_view_fit_directional(shb_vec3 to_light, shb_box bounds, uint32_t map_size,
                                    bool reversed, shb_view *view);

/* A spot light at position that sees the whole box: looks at the box's centre, the opening angle
 * and the near and far distances are the smallest that hold the box, with a margin of two texels.
 * SHB_ERROR_ARGUMENT if the position lies inside the box or so close that the opening angle would
 * exceed 170 degrees: use shb_view_perspective then. Other errors as shb_view_fit_directional. */
shb_result shb_view_fit_spot(shb_vec3 position, shb_box bounds, uint32_t map_size, bool reversed,
                             shb_view *view);

/* The light of a view. w is 1 for a point, in world units, and 0 for a direction at infinity, then
 * of unit length and pointing to the light. SHB_ERROR_NUMBER when the matrix is singular. */
typedef struct shb_light_source {
    shb_vec3 position;
    double w;
} shb_light_source;

shb_result shb_view_light_source(const shb_view *view, shb_light_source *source);

#ifdef __cplusplus
}
#endif

#endif
