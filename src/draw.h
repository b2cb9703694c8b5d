/* Drawing for maps. */
#ifndef SRC_DRAW_H
#define SRC_DRAW_H

#include "drawn_plane.h"

/* As shb_draw; with planes not NULL, the description's ids receive slopes, two halves over the
 * finder's unit, x in the lower one, and depths are raised as drawn_plane.h says. At equal depth
 * the lower pair of halves wins, as a signed number. The finder is asked by any thread. */
shb_result shb_draw_planes(shb_context *context, const shb_draw_desc *desc,
                           const shb_plane_finder *planes, shb_draw_stats *stats);

#endif
