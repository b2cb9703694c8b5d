/* A grid over a map's texels that finds the silhouette edges near a fragment. */
#ifndef SRC_REFERENCE_EDGE_GRID_H
#define SRC_REFERENCE_EDGE_GRID_H

#include "silhouette.h"

typedef struct shb_edge_grid {
    shb_silhouette_edge *edges;
    size_t edge_count;
    uint32_t cell_size; /* texels */
    uint32_t columns, rows;
    size_t *starts;    /* by cell, row by row: its first entry; one more: the end of the last */
    uint32_t *entries; /* numbers of the edges within a texel of the cell */
} shb_edge_grid;

/* A fragment as silhouettes see it. */
typedef struct shb_edge_receiver {
    double x, y;        /* texel coordinates, inside the map */
    double position[3]; /* world */
    double normal[3];   /* unit, to the light's side */
    double reach;       /* the largest world coordinate of its triangle */
} shb_edge_receiver;

/* Collects and sorts the edges; false: out of memory, *grid is untouched then. */
bool shb_edge_grid_build(const shb_context *context, const shb_triangle *triangles,
                         const shb_edges *edges, const shb_map_info *map, shb_edge_grid *grid);

void shb_edge_grid_free(const shb_context *context, shb_edge_grid *grid);

/* True if an edge passes within a texel along both axes, on the light's side of the receiver's
 * plane. An edge that touches the plane as closely as float positions can tell is not there. */
bool shb_edge_grid_is_near(const shb_edge_grid *grid, const shb_edge_receiver *receiver);

#endif
