/* Rays from fragments to a light, and whether a triangle stands in their way. */
#ifndef SRC_RAY_H
#define SRC_RAY_H

#include "shadowbias/view.h"

/* A triangle in world units. */
typedef struct shb_triangle {
    double corners[3][3];
    uint32_t id;
} shb_triangle;

typedef struct shb_ray {
    double origin[3], direction[3];
    double limit;    /* parameter of the light: 1 for a point, infinite for a direction */
    double rounding; /* of the origin, relative to its coordinates, beside double's; first 0 */
    int axis[3];     /* axis[2]: the one that the ray follows most; axis[0], axis[1]: the others */
    double shear[2]; /* direction along axis[0], axis[1] per direction along axis[2] */
} shb_ray;

/* The ray from a point to the light; false if the point is not finite or is the light itself. */
bool shb_ray_to_light(const shb_light_source *light, shb_vec3 point, shb_ray *ray);

/* True if the line of the ray meets the triangle, edges and corners included. A triangle seen
 * edge-on is missed: its neighbours hold the same edges. */
bool shb_ray_line_meets(const shb_ray *ray, const shb_triangle *triangle);

/* True if the ray meets the triangle between its origin and the light, and farther from both than
 * the rounding of inputs and distance. own: the triangle that the origin was computed on, or NULL.
 */
bool shb_ray_is_blocked(const shb_ray *ray, const shb_triangle *triangle, const shb_triangle *own);

#endif
