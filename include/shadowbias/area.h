/* Lights with an extent: what truly reaches a point of them, by rays and by many shadow maps. */
#ifndef SHADOWBIAS_AREA_H
#define SHADOWBIAS_AREA_H

#include "shadowbias/reference.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The largest number of samples of an area light. */
#define SHB_AREA_SAMPLES_MAX 4096

/* A rectangle, parallelogram, disk or ellipse that sends the same light from every part of its
 * area: the points light.position + a * u + b * v with a and b in -1 .. 1, or a * a + b * b at most
 * 1 for a disk. If light.w is 0 these are directions to the light, and u and v are tangents of half
 * the angles over which it extends if light.position has the length 1. u and v may be zero: a light
 * without extent. */
typedef struct shb_area_light {
    shb_light_source light; /* the middle; world units, or a direction */
    shb_vec3 u, v;          /* half the extent; world units, or tangents */
    bool disk;
} shb_area_light;

typedef struct shb_area_points {
    size_t count;
    const shb_vec3 *positions;
    const shb_vec3 *normals; /* of any length; NULL: points are lit from both sides */
    const uint32_t *own_ids; /* triangles left out, as in shb_reference_occluded; NULL: none */
} shb_area_points;

/* visibility[i]: the part of the light that reaches points.positions[i], by rays in double to
 * samples (1 .. SHB_AREA_SAMPLES_MAX) points of it: lit rays / samples, rounded to float. The
 * samples are a stratified pattern (Hammersley's), shifted for each point by a hash of its
 * coordinates: the same point always gets the same answer. A sample behind the surface (its
 * direction makes more than a right angle with the normal) counts as dark; without normals the
 * surface is transparent for its own point, and a closed body shadows itself by its other
 * triangles. A point that is not finite, or lies on a sample, is lit by it; a normal that is zero
 * or not finite is none. One call at a time for a context. Errors: SHB_ERROR_ARGUMENT,
 * SHB_ERROR_NUMBER for a light that shb_reference_occluded refuses or an extent that is not finite,
 * SHB_ERROR_SIZE for samples out of range. */
shb_result shb_reference_area(const shb_reference *reference, const shb_area_light *area,
                              uint32_t samples, const shb_area_points *points, float *visibility);

/* What shb_area_visibility draws. */
typedef struct shb_area_desc {
    const shb_scene *scene;
    shb_area_light area;
    shb_map_desc map; /* its view: from anywhere on the light, a direction if the light is one */
    uint32_t samples; /* maps, 1 .. SHB_AREA_SAMPLES_MAX */
    const shb_bias *bias;
    const shb_filter *filter; /* NULL: hard */
} shb_area_desc;

/* The mean visibility of the points in maps from samples of the light (Heckbert and Herf 1997).
 * Each map looks as desc.map.view does, from its own place on the light, through a window around
 * those points that this view sees; near and far plane move with the light. A point outside of
 * desc.map.view is lit. Each map is drawn and asked on the context's threads and released before
 * the next; points.own is not read. Errors: those of shb_map_create, shb_map_draw and
 * shb_map_visibility, and of the light and the samples as above; SHB_ERROR_ARGUMENT if one of light
 * and view is a direction and the other is not. One call at a time for a context. */
shb_result shb_area_visibility(shb_context *context, const shb_area_desc *desc,
                               const shb_points *points, float *visibility);

#ifdef __cplusplus
}
#endif

#endif
