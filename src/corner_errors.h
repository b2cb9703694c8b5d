/* How far rounding moves the corners of triangles in the window. */
#ifndef SRC_CORNER_ERRORS_H
#define SRC_CORNER_ERRORS_H

#include "setup.h"

/* Of an instance whose matrices are known. */
shb_corner_errors shb_corner_errors_of(const shb_target *target, const shb_view *view,
                                       const shb_draw_instance *instance);

#endif
