/* What the functions that read a camera's frame refuse. */
#ifndef SRC_FRAME_H
#define SRC_FRAME_H

#include "shadowbias/shade.h"

/* Checks all of the frame but its view's matrix and the indices of its meshes. Failures are logged
 * in the name of caller, whose description has the frame as a field of that name. */
shb_result shb_frame_check(const shb_context *context, const char *caller, const shb_frame *frame);

#endif
