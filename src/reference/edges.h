/* The edges of a triangle mesh whose vertices are welded where their positions are equal. */
#ifndef SRC_REFERENCE_EDGES_H
#define SRC_REFERENCE_EDGES_H

#include "../context.h"
#include "../ray.h"

/* Half-edge 3 * t + k runs from corner k of triangle t to the next corner; the last corner is
 * opposite to it. Triangles without area have no half-edges here. */
typedef struct shb_edges {
    uint32_t *heads; /* one half-edge of each edge */
    uint32_t count;  /* of edges */
    uint32_t *next;  /* by half-edge: another one of the same edge, or SHB_ID_NONE */
} shb_edges;

/* Finds the edges; false: out of memory, *edges is untouched then. At most 2^30 triangles. */
bool shb_edges_build(const shb_context *context, const shb_triangle *triangles, uint32_t count,
                     shb_edges *edges);

void shb_edges_free(const shb_context *context, shb_edges *edges);

#endif
