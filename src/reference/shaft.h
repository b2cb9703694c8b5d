/* All rays from a point to an area light at once: what lies outside of them blocks none of them. */
#ifndef SRC_REFERENCE_SHAFT_H
#define SRC_REFERENCE_SHAFT_H

#include "bvh.h"
#include "shadowbias/area.h"

/* A pyramid from the point through the corners of the light, made larger by what rounding may move
 * rays and triangles. */
typedef struct shb_shaft {
    double origin[3];
    double box[2][3];    /* around the rays */
    double planes[4][3]; /* inside: dot(plane, x - origin) >= -margin */
    double margins[4];
} shb_shaft;

/* Light and point must be finite. */
shb_shaft shb_shaft_of(const shb_bvh *bvh, const shb_area_light *area, shb_vec3 point);

/* The triangles that the shaft may meet, own_id left out; more than `most` of them: none are
 * written, and false. */
bool shb_shaft_gather(const shb_bvh *bvh, const shb_shaft *shaft, uint32_t own_id, uint32_t most,
                      const shb_triangle **triangles, uint32_t *count);

#endif
