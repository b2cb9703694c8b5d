/* What lists are made of, and what they are made from. */
#ifndef SRC_KERNELS_LIST_TYPES_H
#define SRC_KERNELS_LIST_TYPES_H

#include "../list_triangle.h"

/* Triangles that are prepared at the same time; also the cells of a block, four by four. */
#define SHB_LIST_LANES 16

/* The side of a tile in texels, and the least number of its cells on a side. */
#define SHB_LIST_TILE_BITS 6
#define SHB_LIST_TILE (1 << SHB_LIST_TILE_BITS)
#define SHB_LIST_BLOCK_BITS 2
#define SHB_LIST_BLOCK (1 << SHB_LIST_BLOCK_BITS)

/* A vertex as the light sees it. */
typedef struct shb_list_vertex {
    double x, y, z;
    double inverse_w; /* 0: in front of the near plane; NaN: not finite, has no triangles */
} shb_list_vertex;

/* Vertices, or points of a map of triangles, that are looked at together. */
#define SHB_LIST_GROUP 64

/* A group's vertices in their mesh's and in the world's coordinates. */
typedef struct shb_list_places {
    SHB_ALIGN float mesh[3][SHB_LIST_GROUP];
    double world[3][SHB_LIST_GROUP];
} shb_list_places;

/* Sheets answer points that rounding of their coordinates moves by no more than this in the map,
 * texels. */
#define SHB_LIST_POINT_MARGIN 0x1p-8

/* Corners of known outlines are off by less than this in the map, texels. */
#define SHB_LIST_CORNER 0x1p-10

/* A triangle's outline in the map, as the light sees it, for the proof that triangles together
 * cover a texel (k_list_sheet.inl). Edge k lies opposite to corner k. */
typedef struct shb_list_outline {
    SHB_ALIGN float x[3]; /* corners, texels */
    float y[3];
    uint32_t edges[3][2]; /* what each edge adds to the sums of the texels that it meets: the
                             triangle on its other side takes it away again */
    uint32_t is_known;    /* 0: it is too thin to tell which way it faces, or cut; corners say in
                             which texels it may lie */
} shb_list_outline;

/* What a triangle that covers a texel's sample adds to its two sums. */
#define SHB_LIST_SHEET_0 0x9e3779b9u
#define SHB_LIST_SHEET_1 0x85ebca6bu

/* What one whose outline is not known adds to the second sum. */
#define SHB_LIST_UNKNOWN_1 0x27d4eb2fu

/* Corners of triangles, lane by lane. */
typedef struct shb_list_corners {
    SHB_ALIGN double x[3][SHB_LIST_LANES];
    double y[3][SHB_LIST_LANES], z[3][SHB_LIST_LANES], inverse_w[3][SHB_LIST_LANES];
} shb_list_corners;

/* A triangle of a cell. */
typedef struct shb_list_entry {
    uint32_t triangle;
    float begin; /* no depth of the triangle in the cell is less */
} shb_list_entry;

/* Entries are looked at this many at a time; so many more may be read behind the last one. */
#define SHB_LIST_STEP 8

/* A tile of a map. */
typedef struct shb_list_tile {
    size_t first_cell, first_entry;
    int cell_bits; /* cells are squares of 2^cell_bits texels; negative: no triangle is near */
} shb_list_tile;

/* Tiles row by row. */
typedef struct shb_list_grid {
    const shb_list_tile *tiles;
    uint32_t columns;
} shb_list_grid;

/* A cell of a tile. */
typedef struct shb_list_cell {
    uint32_t start; /* of its entries, among the tile's; the next cell's is their end */
    float far;      /* points of the scene behind it are in shadow */
} shb_list_cell;

#endif
