/* A tile of lists while triangles are put into its cells. */
#ifndef SRC_KERNELS_LIST_COVER_H
#define SRC_KERNELS_LIST_COVER_H

#include "list_types.h"

/* Blocks of a tile's side where cells are single texels. */
#define SHB_LIST_BLOCKS (SHB_LIST_TILE / SHB_LIST_BLOCK)

/* A tile's cells while triangles are put into them, and a rim that vectors may reach. */
#define SHB_LIST_CELLS_MAX ((SHB_LIST_TILE + SHB_LIST_BLOCK) * (SHB_LIST_TILE + SHB_LIST_BLOCK))

/* Texels, four by four, while their sheets are made. */
typedef struct shb_list_block {
    SHB_ALIGN float far[SHB_LIST_LANES]; /* behind it all of a texel is in shadow */
    float begins[SHB_LIST_LANES], ends[SHB_LIST_LANES];
    int32_t sums[2][SHB_LIST_LANES]; /* of edges and samples */
    float behind[SHB_LIST_LANES];    /* where sheets begin that were made before */
} shb_list_block;

/* The sheets that are being made. */
typedef struct shb_list_sheets {
    shb_list_block blocks[SHB_LIST_BLOCKS * SHB_LIST_BLOCKS];
    bool is_nearer[SHB_LIST_BLOCKS * SHB_LIST_BLOCKS]; /* of cells: some of their texels hide more
                                                          than when far was found */
} shb_list_sheets;

/* Entries in the order of triangles, and the cell of each. */
typedef struct shb_list_unsorted {
    uint32_t *triangles, *cells;
    float *begins;
    size_t count, capacity;
} shb_list_unsorted;

/* One tile while triangles are put into its cells, which are kept row by row, with a rim of
 * SHB_LIST_BLOCK cells behind rows and behind the last one. */
typedef struct shb_list_cover {
    const shb_list_triangle *triangles;
    const shb_list_frame *frame;
    const shb_list_box *boxes;
    const shb_list_outline *outlines;
    const uint64_t *keys; /* triangles in the low halves, front to back by the levels above */
    size_t count;
    uint32_t column, row; /* of the tile's first texel */
    int cell_bits;        /* cells are squares of 2^cell_bits texels */
    bool with_sheets;     /* outlines are there, and the cells' sheets are wanted */
    shb_list_unsorted unsorted;
    float far[SHB_LIST_CELLS_MAX];                     /* behind it all of a cell is in shadow */
    shb_list_sheets sheets;                            /* with_sheets */
    float farthest[SHB_LIST_BLOCKS * SHB_LIST_BLOCKS]; /* of the cells of windows that begin in each
                                                          block, SHB_LIST_BLOCKS a row */
    bool is_nearer;                                    /* some cells hide more since then */
    bool is_hiding;                                    /* some cell hides what lies behind */
    int32_t lane_cells[SHB_LIST_LANES];                /* of a window, from its first one on */
    /* what is made, without the rim */
    shb_list_cell *cells;                        /* and one for the end */
    shb_list_entry *entries;                     /* as many as unsorted ones */
    float bounds[SHB_LIST_TILE * SHB_LIST_TILE]; /* with_sheets: of texels */
} shb_list_cover;

#endif
