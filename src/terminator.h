/* Where points of smooth surfaces are asked about light: moved off their triangles, which turn away
 * from the light before the surface that the normals describe does. */
#ifndef SRC_TERMINATOR_H
#define SRC_TERMINATOR_H

#include "fragments.h"

/* Points of a batch, as in shb_fragments. */
typedef struct shb_lifted_points {
    SHB_ALIGN float x[SHB_BATCH];
    float y[SHB_BATCH];
    float z[SHB_BATCH];
} shb_lifted_points;

/* The way from a point of the triangle out to the smooth surface: the mean, by barycentric weights,
 * of the ways to its feet on the tangent planes of the corners, of those planes that it lies below
 * (Hanika 2021, Hacking the shadow terminator, Ray Tracing Gems II, chapter 4). */
shb_vec3 shb_terminator_way(const shb_surface_triangle *triangle, const double weights[3]);

/* Moves the points of a batch that the reader has just read. */
void shb_terminator_lift_batch(shb_fragment_reader *reader, size_t count,
                               const shb_fragments *fragments, shb_lifted_points *lifted);

#endif
