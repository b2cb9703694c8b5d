/* The inside of a reference: the scene's triangles, ready for rays and for silhouettes. */
#ifndef SRC_REFERENCE_REFERENCE_H
#define SRC_REFERENCE_REFERENCE_H

#include "bvh.h"
#include "edges.h"
#include "shadowbias/reference.h"

struct shb_reference {
    shb_context *context;
    shb_bvh bvh;
    shb_edges edges;
};

#endif
