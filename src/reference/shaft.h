/* All rays from a point to an area light at once: what can block some of them, and what blocks all.
 */
#ifndef SRC_REFERENCE_SHAFT_H
#define SRC_REFERENCE_SHAFT_H

#include "bvh.h"
#include "shadowbias/area.h"

/* A pyramid from the point through the corners of the light. Its margins cover what rounding may
 * move rays and triangles. */
typedef struct shb_shaft {
    double origin[3];
    double directions[4][3]; /* from the point to the corners */
    double extent;           /* the largest size of an element of a direction or a light's corner */
    double box[2][3];        /* around the rays */
    double planes[4][3];     /* inside: dot(plane, x - origin) >= -margin */
    double margins[4];
} shb_shaft;

/* A triangle that some rays may meet. A ray that does not lie clearly on different sides of the
 * planes through the point and two of its edges may meet it. */
typedef struct shb_shaft_blocker {
    const shb_triangle *triangle;
    double planes[3][3];
    double margin; /* a smaller product of a plane and a ray tells nothing */
} shb_shaft_blocker;

/* Light and point must be finite. */
shb_shaft shb_shaft_of(const shb_bvh *bvh, const shb_area_light *area, shb_vec3 point);

/* The triangles that the shaft may meet, own_id left out; false: there are more than `most`. */
bool shb_shaft_gather(const shb_bvh *bvh, const shb_shaft *shaft, uint32_t own_id, uint32_t most,
                      shb_shaft_blocker *blockers, uint32_t *count);

/* True if a ray of the shaft in this direction passes the triangle for sure. */
bool shb_shaft_blocker_is_missed(const shb_shaft_blocker *blocker, const double direction[3]);

/* True if the line of every ray of the shaft meets the triangle for sure. */
bool shb_shaft_is_covered(const shb_shaft *shaft, const shb_shaft_blocker *blocker);

/* True if all of the light lies before the plane through the point, for sure. */
bool shb_shaft_is_before(const shb_shaft *shaft, shb_vec3 normal);

#endif
