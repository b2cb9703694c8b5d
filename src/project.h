/* Projection of a batch: world positions and planes as the light's map sees them. Every function
 * runs over the count rounded up to whole vectors, without a branch or a call in its loop. */
#ifndef SRC_PROJECT_H
#define SRC_PROJECT_H

#include "map.h"

/* Loops of a batch run over whole vectors of this many elements. */
#define SHB_LANES 16

static inline size_t shb_round_to_lanes(size_t count) {
    return (count + SHB_LANES - 1) / SHB_LANES * SHB_LANES;
}

/* Points in the light's normalised coordinates. A point that has none, behind the light or not
 * finite, has NaN for x and y, 0 for z and 1 for w. */
typedef struct shb_ndc {
    SHB_ALIGN double x[SHB_BATCH];
    double y[SHB_BATCH];
    double z[SHB_BATCH];
    double w[SHB_BATCH]; /* clip w */
} shb_ndc;

/* Derives everything from the view, the light source and the size. SHB_ERROR_NUMBER when a scale is
 * not a positive finite number: the matrix is degenerate, or its depth does not grow away from the
 * light as view.reversed says. */
shb_result shb_projection_init(const shb_map_info *info, shb_projection *projection);

/* Positions to normalised coordinates. */
void shb_project_points(const shb_projection *projection, size_t count,
                        const shb_receivers *receivers, shb_ndc *ndc);

/* SHB_NEEDS_SCALE: texel_size and depth_per_world. */
void shb_project_scales(const shb_projection *projection, size_t count, const shb_ndc *ndc,
                        shb_receivers *receivers);

/* SHB_NEEDS_SLOPE: the slopes of the planes through the points; either side's normal does. */
void shb_project_slopes(const shb_projection *projection, size_t count, const shb_ndc *ndc,
                        shb_receivers *receivers);

/* SHB_NEEDS_NORMAL: turns the normals to the light's side, replaces unusable ones by the direction
 * to the light, and writes the cosine. */
void shb_project_normals(const shb_projection *projection, size_t count, shb_receivers *receivers);

/* Normalised coordinates to texels and canonical depth. */
void shb_project_texels(const shb_projection *projection, size_t count, const shb_ndc *ndc,
                        shb_receivers *receivers);

#endif
