#include "strict.h"

#include "shadowbias/view.h"

#include "larger.h"
#include "matrix.h"
#include "vector.h"

#include <math.h>

#define MARGIN_TEXELS 2.0

/* Frusta no thinner than this, relative to the distance that coordinates must resolve. */
#define THINNEST 0x1p-32

static const shb_vec3 no_up = {0, 0, 0};

/* A view that has no inverse or no light is one of numbers too large or too small for doubles. */
static shb_result finish(shb_mat4 clip_from_eye, shb_mat4 eye_from_world, bool reversed,
                         shb_view *view) {
    const shb_view made = {shb_mat4_multiply(clip_from_eye, eye_from_world), reversed};
    shb_mat4 inverse;
    shb_light_source light;
    if (shb_mat4_inverse(made.clip_from_world, &inverse) != SHB_OK ||
        shb_view_light_source(&made, &light) != SHB_OK)
        return SHB_ERROR_NUMBER;
    *view = made;
    return SHB_OK;
}

static shb_result check_camera(shb_vec3 eye, shb_vec3 target, shb_vec3 up, const shb_view *view) {
    if (!view)
        return SHB_ERROR_ARGUMENT;
    if (!vec3_is_finite(eye) || !vec3_is_finite(target) || !vec3_is_finite(up))
        return SHB_ERROR_NUMBER;
    if (eye.x == target.x && eye.y == target.y && eye.z == target.z)
        return SHB_ERROR_ARGUMENT;
    return SHB_OK;
}

shb_result shb_view_perspective(shb_vec3 eye, shb_vec3 target, shb_vec3 up, double vertical_angle,
                                double aspect, double near_distance, double far_distance,
                                bool reversed, shb_view *view) {
    const shb_result result = check_camera(eye, target, up, view);
    if (result)
        return result;
    if (!isfinite(vertical_angle) || !isfinite(aspect) || !isfinite(near_distance) ||
        isnan(far_distance))
        return SHB_ERROR_NUMBER;
    const double pi = 0x1.921fb54442d18p1;
    if (!(vertical_angle > 0 && vertical_angle < pi && aspect > 0 && near_distance > 0 &&
          near_distance < far_distance))
        return SHB_ERROR_ARGUMENT;
    return finish(
        shb_mat4_perspective(vertical_angle, aspect, near_distance, far_distance, reversed),
        shb_mat4_look_at(eye, target, up), reversed, view);
}

shb_result shb_view_orthographic(shb_vec3 eye, shb_vec3 target, shb_vec3 up, double half_width,
                                 double half_height, double near_distance, double far_distance,
                                 bool reversed, shb_view *view) {
    const shb_result result = check_camera(eye, target, up, view);
    if (result)
        return result;
    if (!isfinite(half_width) || !isfinite(half_height) || !isfinite(near_distance) ||
        !isfinite(far_distance))
        return SHB_ERROR_NUMBER;
    if (!(half_width > 0 && half_height > 0 && near_distance < far_distance))
        return SHB_ERROR_ARGUMENT;
    return finish(
        shb_mat4_orthographic(half_width, half_height, near_distance, far_distance, reversed),
        shb_mat4_look_at(eye, target, up), reversed, view);
}

static shb_result check_fit(shb_vec3 light, shb_box bounds, uint32_t map_size,
                            const shb_view *view) {
    if (!view)
        return SHB_ERROR_ARGUMENT;
    if (bounds.lo.x > bounds.hi.x || bounds.lo.y > bounds.hi.y || bounds.lo.z > bounds.hi.z)
        return SHB_ERROR_ARGUMENT;
    if (!vec3_is_finite(light) || !vec3_is_finite(bounds.lo) || !vec3_is_finite(bounds.hi))
        return SHB_ERROR_NUMBER;
    if (map_size < 8 || map_size > SHB_SIZE_MAX)
        return SHB_ERROR_SIZE;
    return SHB_OK;
}

static double largest_size(shb_vec3 a) {
    return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z)));
}

static shb_vec3 box_centre(shb_box box) {
    return shb_vec3_add(shb_vec3_scale(box.lo, 0.5), shb_vec3_scale(box.hi, 0.5));
}

/* The half extent of a box along row 0 .. 2 of a rotation, from the box's half extents. */
static double extent_along(const shb_mat4 *rotation, int row, shb_vec3 half) {
    return fabs(rotation->m[row]) * half.x + fabs(rotation->m[4 + row]) * half.y +
           fabs(rotation->m[8 + row]) * half.z;
}

/* Up to the next of 16 steps in each octave, so that small changes seldom show. */
static double round_up_size(double size) {
    int exponent;
    const double mantissa = frexp(size, &exponent);
    return ldexp(ceil(mantissa * 32) / 32, exponent);
}

/* Axes and texel size depend on the direction and the size of the box alone, and the centre moves
 * in whole texels from the world's origin: that is what keeps the grid in place. */
shb_result shb_view_fit_directional(shb_vec3 to_light, shb_box bounds, uint32_t map_size,
                                    bool reversed, shb_view *view) {
    const shb_result result = check_fit(to_light, bounds, map_size, view);
    if (result)
        return result;
    if (largest_size(to_light) == 0)
        return SHB_ERROR_ARGUMENT;
    const shb_mat4 rotation =
        shb_mat4_look_along((shb_vec3){0, 0, 0}, shb_vec3_scale(to_light, -1), no_up);
    const shb_vec3 half =
        shb_vec3_subtract(shb_vec3_scale(bounds.hi, 0.5), shb_vec3_scale(bounds.lo, 0.5));
    const shb_vec3 centre = shb_mat4_transform_point(rotation, box_centre(bounds));

    double radius = larger(extent_along(&rotation, 0, half), extent_along(&rotation, 1, half));
    radius = larger(radius, THINNEST * largest_size(centre));
    if (radius == 0)
        radius = 1;
    /* Snapping moves the frustum by up to half a texel. */
    const double texels = (double)map_size;
    const double size = round_up_size(2 * radius * (texels / (texels - 2 * MARGIN_TEXELS - 1)));
    const double texel = size / texels;
    const double x = floor(centre.x / texel + 0.5) * texel;
    const double y = floor(centre.y / texel + 0.5) * texel;
    const double depth = extent_along(&rotation, 2, half) + MARGIN_TEXELS * texel;
    const shb_mat4 projection = shb_mat4_orthographic(0.5 * size, 0.5 * size, -centre.z - depth,
                                                      -centre.z + depth, reversed);
    return finish(shb_mat4_multiply(projection, shb_mat4_translation(-x, -y, 0)), rotation,
                  reversed, view);
}

/* What a box looks like from a point: half opening (a tangent) and the distances along the axis. */
typedef struct box_appearance {
    double tangent, nearest, farthest;
} box_appearance;

static box_appearance look_at_box(const shb_mat4 *eye_from_world, shb_box box) {
    box_appearance seen = {0, HUGE_VAL, 0};
    for (int corner = 0; corner < 8; corner++) {
        const shb_vec3 world = {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                corner & 4 ? box.hi.z : box.lo.z};
        const shb_vec3 p = shb_mat4_transform_point(*eye_from_world, world);
        const double distance = -p.z;
        seen.nearest = distance < seen.nearest ? distance : seen.nearest;
        seen.farthest = larger(seen.farthest, distance);
        seen.tangent = larger(seen.tangent, larger(fabs(p.x), fabs(p.y)) / distance);
    }
    return seen;
}

shb_result shb_view_fit_spot(shb_vec3 position, shb_box bounds, uint32_t map_size, bool reversed,
                             shb_view *view) {
    const shb_result result = check_fit(position, bounds, map_size, view);
    if (result)
        return result;
    const shb_mat4 eye_from_world = shb_mat4_look_at(position, box_centre(bounds), no_up);
    const box_appearance seen = look_at_box(&eye_from_world, bounds);
    const double texels = (double)map_size;
    const double reach =
        larger(largest_size(position), larger(largest_size(bounds.lo), largest_size(bounds.hi)));
    const double thinnest = THINNEST * larger(reach / seen.nearest, 1);
    const double tangent = larger(seen.tangent, thinnest) * (texels / (texels - 2 * MARGIN_TEXELS));
    const double widest = 11.430052302761343; /* tan 85 degrees */
    /* Seen from inside, a box has a corner beside or behind the eye. */
    if (!(seen.nearest > 0 && tangent <= widest))
        return SHB_ERROR_ARGUMENT;
    /* Two texels in depth as well, as a part of the distance, but never down to the light. */
    const double margin = MARGIN_TEXELS * 2 * tangent / texels;
    const double near_distance = seen.nearest * (1 - (margin < 0.5 ? margin : 0.5));
    const double far_distance = seen.farthest * (1 + margin);
    return finish(shb_mat4_frustum(tangent, tangent, near_distance, far_distance, reversed),
                  eye_from_world, reversed, view);
}

shb_result shb_view_light_source(const shb_view *view, shb_light_source *source) {
    if (!view || !source)
        return SHB_ERROR_ARGUMENT;
    if (!shb_mat4_is_finite(&view->clip_from_world))
        return SHB_ERROR_NUMBER;
    /* Along the null vector only the depth row changes: by the determinant. */
    double null_vector[4];
    const double change = shb_mat4_cofactors(&view->clip_from_world, 2, null_vector);
    if (change == 0)
        return SHB_ERROR_NUMBER;
    const shb_vec3 axis = {null_vector[0], null_vector[1], null_vector[2]};
    const double w = null_vector[3];
    shb_light_source found;
    if (w != 0) {
        found = (shb_light_source){{axis.x / w, axis.y / w, axis.z / w}, 1};
    } else {
        const bool towards_light = (change < 0) != view->reversed;
        found =
            (shb_light_source){shb_vec3_scale(shb_vec3_normalize(axis), towards_light ? 1 : -1), 0};
    }
    if (!vec3_is_finite(found.position))
        return SHB_ERROR_NUMBER;
    *source = found;
    return SHB_OK;
}
