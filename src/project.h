/* What the projection of batches needs to know of a map. */
#ifndef SRC_PROJECT_H
#define SRC_PROJECT_H

#include "quick_test.h"

/* Loops of a batch run over whole vectors of this many elements. */
#define SHB_LANES 16

static inline size_t shb_round_to_lanes(size_t count) {
    return (count + SHB_LANES - 1) / SHB_LANES * SHB_LANES;
}

/* Derives everything from the view, the light source and the size. SHB_ERROR_NUMBER when a scale is
 * not a positive finite number: the matrix is degenerate, or its depth does not grow away from the
 * light as view.reversed says. */
shb_result shb_projection_init(const shb_map_info *info, shb_projection *projection);

/* w at a distance of one from the light along its axis; under parallel rays, w everywhere. */
double shb_projection_w(const shb_projection *projection);

/* The rows of a view for a map of this size, texels. */
shb_light_rows shb_light_rows_of(const shb_view *view, double width, double height);

/* Places, and with_normals: normals, of the fragments with these ascending numbers, as a batch of
 * its own; the last one fills up the lanes. from: arrays, which to may hold. */
void shb_receivers_pick(const shb_quick_points *from, const uint16_t *numbers, size_t count,
                        bool with_normals, shb_receivers *to);

#endif
