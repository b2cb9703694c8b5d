/* A wrapped map of given depths, in any format, and single questions to it. */
#ifndef TESTS_SUPPORT_DEPTH_MAP_H
#define TESTS_SUPPORT_DEPTH_MAP_H

#include "shadowbias/map.h"

typedef struct depth_map {
    shb_context *context;
    shb_map *map;
    void *texels;
} depth_map;

/* depths: width * height parts of the way from the near depth to the far depth, 0 .. 1, row by row.
 * They are rounded to the format, away from the light. */
depth_map depth_map_open(const shb_context_desc *context, const shb_map_desc *desc,
                         const float *depths);

/* The same seen by a spot or a directional light over the box from -1 to 1, of scale 3, for one
 * thread of an instruction set; desc names size and format. */
depth_map depth_map_open_lit(shb_isa isa, bool spot, bool reversed, shb_map_desc desc,
                             const float *depths);

void depth_map_close(depth_map *opened);

/* Prepares the filter, which must succeed. */
void depth_map_prepare(const depth_map *asked, const shb_filter *filter);

/* The visibility of one point without a normal, by its own depth. */
double depth_map_ask(const depth_map *asked, const shb_filter *filter, double x, double y,
                     double z);

#endif
