/* A mesh lit from straight above and seen from nearly there: scenes whose errors are known by hand.
 */
#ifndef TESTS_SUPPORT_OVERHEAD_H
#define TESTS_SUPPORT_OVERHEAD_H

#include "measure.h"

/* The light sees -1 .. 1 in x and z, and heights from 2, at depth 0, to -2, at depth 1. */
#define OVERHEAD_RANGE 4.0

typedef struct overhead {
    shb_context *context;
    example_scene *scene;
    measure_frame frame;
    shb_map_desc map;
} overhead;

/* Takes the meshes. The camera looks through what is unseen, which casts shadows all the same;
 * NULL: nothing is. */
void overhead_open(overhead *o, owned_mesh *seen, owned_mesh *unseen, uint32_t map_size);
void overhead_close(overhead *o);

/* The width of a texel in world units. */
double overhead_texel(const overhead *o);

#endif
