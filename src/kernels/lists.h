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

/* The most that rounding of a point's coordinates may move it in the map where it is told something
 * by sheets, texels. */
#define SHB_LIST_POINT_MARGIN 0x1p-8

/* More than corners are off by in the map where outlines are known, texels. */
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

/* What a triangle that covers a texel's sample adds to its sums, and one whose outline is not
 * known.
 */
#define SHB_LIST_SHEET_0 0x9e3779b9u
#define SHB_LIST_SHEET_1 0x85ebca6bu
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
    bool is_nearer[SHB_LIST_BLOCKS * SHB_LIST_BLOCKS]; /* of cells: texels in them have come to hide
                                                          more */
} shb_list_sheets;

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
    bool is_nearer;                                    /* some cells have become so since */
    bool is_hiding;                                    /* some cell hides what lies behind */
    int32_t lane_cells[SHB_LIST_LANES];                /* of a window, from its first one on */
    /* what is made, without the rim */
    shb_list_cell *cells;                        /* and one for the end */
    shb_list_entry *entries;                     /* as many as unsorted ones */
    float bounds[SHB_LIST_TILE * SHB_LIST_TILE]; /* with_sheets: of texels */
} shb_list_cover;

/* Points of a group that are asked about one triangle at the same time: this many from the first
 * on, one bit each. */
#define SHB_LIST_RUN 8

/* Points that ask at the same time: what each step of asking reads is on its way for all of them
 * while the step before is at work. */
#define SHB_LIST_POINTS 256

/* These, as the light sees them; the last one fills up SHB_LIST_LANES. */
typedef struct shb_list_group {
    size_t count;
    const double *world[3];
    SHB_ALIGN double x[SHB_LIST_POINTS];
    double y[SHB_LIST_POINTS], depth[SHB_LIST_POINTS];
    double inverse_w[SHB_LIST_POINTS];
    double scale[SHB_LIST_POINTS]; /* of the triangles' bounds: above 1 outside the scene */
    bool has_outside;              /* there is such a one */
    double least_size; /* of the points' largest coordinates by w, where that is positive */
    /* x, y and depth rounded, and what vectors may read */
    float about_x[SHB_LIST_POINTS + SHB_LIST_LANES];
    float about_y[SHB_LIST_POINTS + SHB_LIST_LANES];
    float about_depth[SHB_LIST_POINTS + SHB_LIST_LANES];
    int32_t texel[SHB_LIST_POINTS];                 /* row * 2^16 + column; -1: not in the view */
    int32_t cell[SHB_LIST_POINTS + SHB_LIST_LANES]; /* -1: none, nothing is near */
    bool has_own; /* it is known on which triangles the points lie */
    uint32_t own[SHB_LIST_POINTS + SHB_LIST_LANES]; /* these, and what vectors may read */
} shb_list_group;

/* Points of a group that follow each other in one cell, up to where the next ones begin. */
typedef struct shb_list_span {
    const shb_list_cell *cell;
    const shb_list_entry *entries; /* of the cell's tile */
    size_t first;
} shb_list_span;

/* As many of them as are asked at the same time. */
typedef struct shb_list_run {
    const shb_list_entry *entry, *end; /* that are left to ask */
    float depth;                       /* no open point's is greater but for rounding */
    uint8_t first;                     /* at most SHB_LIST_POINTS - SHB_LIST_RUN */
    uint8_t open; /* points from the first on that are not in shadow so far, one bit each */
} shb_list_run;

/* What a run asks about a triangle. Its bytes, from the lowest: which run; the first of its points;
 * which points ask, then those that the triangle blocks; then those that it may block: the ray has
 * to decide. They are one number because single bytes took a thirtieth of the time of asking. */
typedef struct shb_list_question {
    uint32_t triangle;
    uint32_t bytes;
} shb_list_question;

enum { SHB_LIST_ASKER = 0, SHB_LIST_FIRST = 8, SHB_LIST_ASKED = 16, SHB_LIST_DOUBT = 24 };

static inline uint32_t shb_list_byte(const shb_list_question *question, int shift) {
    return question->bytes >> shift & 0xff;
}

typedef struct shb_list_kernels {
    /* Finds where a group's vertices lie in the world and where the light sees them; adds them to
     * the extent. */
    void (*see)(const shb_list_frame *frame, const shb_mat4 *transform, shb_list_places *places,
                shb_list_vertex vertices[SHB_LIST_GROUP], shb_list_extent *extent);

    /* Prepares triangles, whose corners are at these vertices; names tell vertices apart by their
     * places in the world. Returns those, one bit each, that
     * have a corner in front of the near plane or too near to the light's own: what is written of
     * them is of no use. */
    uint32_t (*prepare)(const shb_list_frame *frame, const shb_list_vertex *vertices,
                        const uint64_t *names, const uint32_t *const corners[SHB_LIST_LANES],
                        shb_list_triangle triangles[SHB_LIST_LANES],
                        shb_list_box boxes[SHB_LIST_LANES], uint16_t levels[SHB_LIST_LANES],
                        shb_list_outline outlines[SHB_LIST_LANES]);

    /* Puts a tile's triangles into its cells. A triangle goes into a cell unless it misses the cell
     * for sure or begins there behind a triangle before it that covers the cell for sure. False if
     * there is no room for all the entries. */
    bool (*cover)(shb_list_cover *cover);

    /* Finds where the light sees the points, and their cells. Writes the numbers of those that do
     * not lie in the same cell as the one before; returns how many. */
    size_t (*locate)(const shb_list_frame *frame, const shb_list_grid *grid, shb_list_group *group,
                     int32_t changes[SHB_LIST_POINTS + SHB_LIST_LANES]);

    /* Makes runs of spans, behind which is one more for their end, and fetches their entries.
     * Points that their cells put into shadow have visibility 0 and are in no run. Returns how many
     * runs there are. */
    size_t (*start)(const shb_list_group *group, const shb_list_span *spans, size_t count,
                    shb_list_run runs[SHB_LIST_POINTS], float *visibility);

    /* Makes questions of the next SHB_LIST_STEP entries of each run, or as many as are left if
     * these are fewer: one for each that begins at the run's depth or before. There is room for
     * SHB_LIST_STEP of each. Returns how many. */
    size_t (*take)(shb_list_run *runs, size_t count, shb_list_question *questions);

    /* Answers questions by the bounds of rounding; rounding as in shb_list_points, of points whose
     * scale is 1. Nothing is asked of a point about its own triangle. Those that say something are
     * moved to the front; returns how many they are. */
    size_t (*answer)(const shb_list_frame *frame, const shb_list_triangle *triangles,
                     const shb_list_group *group, double rounding, shb_list_question *questions,
                     size_t count);
} shb_list_kernels;

/* Never NULL. */
const shb_list_kernels *shb_list_kernels_of(shb_isa isa);

extern const shb_list_kernels shb_list_kernels_scalar, shb_list_kernels_sse2, shb_list_kernels_avx2,
    shb_list_kernels_avx512, shb_list_kernels_neon;

#endif
