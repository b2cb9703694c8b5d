/* Drawing for maps. */
#ifndef SRC_DRAW_H
#define SRC_DRAW_H

#include "drawn_plane.h"
#include "shadowbias/bias.h"

/* As shb_draw; with planes not NULL, the description's ids receive slopes (slopes.h) in the
 * finder's unit, and depths are raised as drawn_plane.h says. At equal depth the lower word of
 * slopes wins, as a signed number. The finder is asked by any thread.
 * combines not NULL: the description has a depth image and no second one, and the depth becomes
 * what this method's combine stage makes of two layers, the far depth where that is NaN. Any thread
 * calls the stage, too. */
shb_result shb_draw_for_map(shb_context *context, const shb_draw_desc *desc,
                            const shb_plane_finder *planes, const shb_bias *combines,
                            shb_draw_stats *stats);

#endif
