/* The loops of building lists, one implementation for each instruction set; all give the same bits.
 */
#ifndef SRC_KERNELS_LISTS_H
#define SRC_KERNELS_LISTS_H

#include "../context.h"
#include "../list_triangle.h"

/* Triangles that are prepared at the same time; also the cells of a block, four by four. */
#define SHB_LIST_LANES 16

/* The side of a tile in texels, and the least number of its cells on a side. */
#define SHB_LIST_TILE_BITS 6
#define SHB_LIST_TILE (1 << SHB_LIST_TILE_BITS)
#define SHB_LIST_BLOCK 4

/* A vertex as the light sees it. */
typedef struct shb_list_vertex {
    double x, y, z;
    double inverse_w; /* 0: in front of the near plane; NaN: not finite, has no triangles */
} shb_list_vertex;

/* Corners of triangles that lie behind the near plane and well in front of the light's own. */
typedef struct shb_list_corners {
    SHB_ALIGN double x[3][SHB_LIST_LANES];
    double y[3][SHB_LIST_LANES], z[3][SHB_LIST_LANES], inverse_w[3][SHB_LIST_LANES];
} shb_list_corners;

/* An entry before entries are sorted by cell. */
typedef struct shb_list_pair {
    uint32_t triangle, cell;
} shb_list_pair;

/* One tile while triangles are put into its cells. Cells are kept block by block, row by row in
 * both. */
typedef struct shb_list_cover {
    const shb_list_triangle *triangles;
    const shb_list_plane *planes;
    const shb_list_box *boxes;
    const uint64_t *keys; /* triangles in the low halves, front to back */
    size_t count;
    uint32_t column, row;                           /* of the tile's first texel */
    int cell_bits;                                  /* cells are squares of 2^cell_bits texels */
    float far[SHB_LIST_TILE * SHB_LIST_TILE];       /* behind it all of a cell is in shadow */
    uint32_t counts[SHB_LIST_TILE * SHB_LIST_TILE]; /* entries */
    shb_list_pair *pairs;
    size_t pair_count, pair_capacity;
} shb_list_cover;

/* Points that ask at the same time, as the light sees them. */
#define SHB_LIST_GROUP 64

typedef struct shb_list_group {
    const double *world[3];
    SHB_ALIGN double x[SHB_LIST_GROUP];
    double y[SHB_LIST_GROUP], depth[SHB_LIST_GROUP];
    double inverse_w[SHB_LIST_GROUP];
    double scale[SHB_LIST_GROUP]; /* of the triangles' bounds: above 1 outside the scene */
    int32_t column[SHB_LIST_GROUP], row[SHB_LIST_GROUP]; /* texel; column -1: not in the view */
} shb_list_group;

typedef struct shb_list_kernels {
    /* Prepares triangles of whole corners. */
    void (*prepare)(const shb_list_frame *frame, const shb_list_corners *corners,
                    shb_list_triangle triangles[SHB_LIST_LANES],
                    shb_list_plane planes[SHB_LIST_LANES], shb_list_box boxes[SHB_LIST_LANES]);

    /* Puts a tile's triangles into its cells. A triangle goes into a cell unless it misses the cell
     * for sure or begins there behind a triangle before it that covers the cell for sure. False if
     * there is no room for all the pairs. */
    bool (*cover)(shb_list_cover *cover);

    /* Finds where the light sees the points. */
    void (*locate)(const shb_list_frame *frame, shb_list_group *group);
} shb_list_kernels;

/* Never NULL. */
const shb_list_kernels *shb_list_kernels_of(shb_isa isa);

extern const shb_list_kernels shb_list_kernels_scalar, shb_list_kernels_sse2, shb_list_kernels_avx2,
    shb_list_kernels_avx512, shb_list_kernels_neon;

#endif
