/* Area lights: how much of them truly reaches a point, by rays and by many shadow maps. */
#ifndef SHADOWBIAS_AREA_H
#define SHADOWBIAS_AREA_H

#include "shadowbias/reference.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The largest number of samples of an area light. */
#define SHB_AREA_SAMPLES_MAX 4096

/* A parallelogram or ellipse that sends the same light from every part of its area: the points
 * light.position + a * u + b * v with a and b in -1 .. 1 or, for a disk, a * a + b * b at most 1.
 * If light.w is 0 these are directions to the light; with light.position of length 1, u and v at
 * right angles to it are tangents of half the angle that the light extends over. u and v may be
 * zero: a light without extent. */
typedef struct shb_area_light {
    shb_light_source light; /* the centre; world units, or a direction */
    shb_vec3 u, v;          /* half the extent; world units, or tangents */
    bool disk;              /* the ellipse in the parallelogram */
} shb_area_light;

typedef struct shb_area_points {
    size_t count;
    const shb_vec3 *positions;
    const shb_vec3 *normals; /* of any length; NULL: points take light from both sides */
    const uint32_t *own_ids; /* triangles left out, as in shb_reference_occluded; NULL: none */
} shb_area_points;

/* visibility[i]: the part of the light that reaches points.positions[i], by rays in double
 * precision to samples (1 .. SHB_AREA_SAMPLES_MAX) points of it: lit rays / samples, rounded to
 * float. The samples are a Hammersley pattern, shifted for each point by a hash of its coordinates:
 * the same point always gets the same answer. A sample behind the surface (more than a right angle
 * from the normal) counts as dark; without normals a point's own triangle does not hide the samples
 * behind it, only other triangles do. A point that is not finite is lit, and so is one that lies on
 * a sample, by this sample; a normal that is zero or not finite counts as none. One call at a time
 * for a context. Errors: SHB_ERROR_ARGUMENT, SHB_ERROR_NUMBER for a light that
 * shb_reference_occluded refuses or an extent that is not finite, SHB_ERROR_SIZE for samples out of
 * range. */
shb_result shb_reference_area(const shb_reference *reference, const shb_area_light *area,
                              uint32_t samples, const shb_area_points *points, float *visibility);

/* What shb_area_visibility draws. */
typedef struct shb_area_desc {
    const shb_scene *scene;
    shb_area_light area;
    shb_map_desc map; /* its view: from anywhere on the light; directional if the light is */
    uint32_t samples; /* maps, 1 .. SHB_AREA_SAMPLES_MAX */
    const shb_bias *bias;
    const shb_filter *filter; /* NULL: hard */
} shb_area_desc;

/* visibility[i]: the mean visibility of point i in maps drawn from samples of the light (Heckbert
 * and Herf 1997). Each map has the view desc.map.view moved to its own sample, near and far plane
 * included, with a window fitted around those points that desc.map.view sees; all others are lit.
 * One map after the other is drawn, asked and destroyed, on the context's threads; points.own is
 * not read. Errors: those of shb_map_create, shb_map_draw, shb_map_prepare and shb_map_visibility,
 * and of the light and the samples as above; SHB_ERROR_ARGUMENT if only one of light and view is
 * directional. One call at a time for a context. */
shb_result shb_area_visibility(shb_context *context, const shb_area_desc *desc,
                               const shb_points *points, float *visibility);

#ifdef __cplusplus
}
#endif

#endif
