/* What the buffers of a context's draw_scratch hold. */
#ifndef SRC_SCRATCH_H
#define SRC_SCRATCH_H

enum {
    SHB_SCRATCH_INSTANCES, /* instances that have triangles */
    SHB_SCRATCH_RANGES,    /* tiles that each triangle reaches */
    SHB_SCRATCH_STATS,     /* statistics of each block of triangles */
    SHB_SCRATCH_ENDS,      /* end of each tile's list */
    SHB_SCRATCH_IDS,       /* the lists of all tiles */
    SHB_SCRATCH_LANES,     /* description of the tile that each lane draws */
    SHB_SCRATCH_LAYERS,    /* texels of these tiles */
    SHB_SCRATCH_CELLS,     /* bounds of their depth */
    SHB_SCRATCH_DEPTHS,    /* depth that is drawn beside ids, but not wanted */
    SHB_SCRATCH_VERTICES,  /* vertices in window space */
    SHB_SCRATCH_CHUNKS,
    SHB_SCRATCH_BINS,         /* where each tile's part of a block of chunks ends */
    SHB_SCRATCH_BINNED,       /* triangles of each block, sorted by tile */
    SHB_SCRATCH_CODED,        /* ids of triangles that clipping has to look at */
    SHB_SCRATCH_VIEWS,        /* instances as their clusters are looked at */
    SHB_SCRATCH_SEEN,         /* how many clusters each task kept */
    SHB_SCRATCH_SORTED,       /* clusters by depth */
    SHB_SCRATCH_CLUSTER_ENDS, /* end of each row's list of clusters */
    SHB_SCRATCH_CLUSTER_ROWS, /* the lists of all rows of tiles */
    SHB_SCRATCH_BUFFERS
};

#endif
