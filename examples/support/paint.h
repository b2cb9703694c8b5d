/* How the pictures of scenes are coloured. */
#ifndef EXAMPLES_PAINT_H
#define EXAMPLES_PAINT_H

#include "shadowbias/shade.h"

/* Lambert under all lights and a sky, in the colours of the scene's surfaces.
 * user: the example_scene. */
void paint_scene(const shb_shade_args *args);

#endif
