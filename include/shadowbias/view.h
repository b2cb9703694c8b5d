/* Views: where a camera or a light stands and what it sees.
 *
 * The matrix defines the light: its rays are the lines of equal (x / w, y / w), and its position is
 * the null vector of the rows x, y and w (a point, or a direction if that lies at infinity). So map
 * and shadow test cannot disagree on where the light is.
 *
 * A matrix of your own fits if its clip depth runs from 0 to 1 (1 to 0 when reversed) and clip y is
 * +w in row 0 of the image. A row-major matrix for row vectors has the same 16 numbers in the same
 * order as the column-major one for column vectors: copy them as they stand. What is left to do,
 * row r (x, y, z, w: 0 .. 3) being the elements m[r], m[4 + r], m[8 + r] and m[12 + r]:
 * - Direct3D, Metal: nothing. Their front faces are clockwise, though, unless told otherwise.
 * - OpenGL, whose clip depth is -1 .. 1 unless glClipControl says 0 .. 1: row z becomes the mean of
 *   the rows z and w. To wrap what glReadPixels gives, bottom row first, row y is negated.
 * - Vulkan, whose y points down unless the viewport's height is negative: row y is negated.
 * Nothing tells a wrong row y or z from a right one. Drawing with a y that points down exchanges
 * front and back faces.
 *
 * The near plane may be tilted against the map, as long as depth grows along every ray; filters
 * that reckon with distances (those that are prepared) take it for parallel to the map. */
#ifndef SHADOWBIAS_VIEW_H
#define SHADOWBIAS_VIEW_H

#include "shadowbias/math.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_view {
    shb_mat4 clip_from_world;
    bool reversed; /* depth is 1 at the near plane and 0 at the far plane; this also tells which way
                      a directional light shines */
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

/* The view of a directional light over a box: a square orthographic frustum that holds the box with
 * a margin of two texels. to_light points from the scene to the light, of any length but 0. The
 * frustum's size is rounded up and its origin snapped to whole texels, so that the texel grid stays
 * where it is in the world when the box moves a little (no crawling edges). A box without extent
 * gets a frustum all the same. map_size in texels, 8 .. SHB_SIZE_MAX, or SHB_ERROR_SIZE.
 * SHB_ERROR_ARGUMENT for an empty box or a zero direction, SHB_ERROR_NUMBER for a number that is
 * not finite or too large. */
shb_result shb_view_fit_directional(shb_vec3 to_light, shb_box bounds, uint32_t map_size,
                                    bool reversed, shb_view *view);

/* The view of a spot light at position that looks at the centre of a box, with the smallest opening
 * angle and depth range that hold the box with a margin of two texels. SHB_ERROR_ARGUMENT if the
 * position lies inside the box or so close that the opening angle would exceed 170 degrees: use
 * shb_view_perspective then. Other errors as shb_view_fit_directional. */
shb_result shb_view_fit_spot(shb_vec3 position, shb_box bounds, uint32_t map_size, bool reversed,
                             shb_view *view);

/* Where a light is: at a point (w is 1; world units), or in a direction at infinity (w is 0; the
 * position points to the light). */
typedef struct shb_light_source {
    shb_vec3 position;
    double w;
} shb_light_source;

/* The light of a view; directions have unit length. SHB_ERROR_NUMBER: singular or not finite. */
shb_result shb_view_light_source(const shb_view *view, shb_light_source *source);

#ifdef __cplusplus
}
#endif

#endif
