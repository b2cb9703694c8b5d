/* What the rasterizer's kernels and the code around them hand to each other. Depth is canonical:
 * smaller is nearer. */
#ifndef SRC_KERNELS_RASTER_H
#define SRC_KERNELS_RASTER_H

#include "../drawn_plane.h"

/* Triangles are set up this many at a time. */
#define SHB_CHUNK SHB_PLANE_LANES

/* Vertices of a cluster: a byte reaches them all. */
#define SHB_CLUSTER_VERTICES 256

/* Edges of a box up to this many samples wide and high fit into 32 bits. */
#define SHB_SMALL 64

/* Tiles keep a bound of the farthest depth in each square of so many samples. */
#define SHB_CELL 16

/* Marks of cells: see marks.h. */
enum {
    SHB_MARK_DRAWN = 0,
    SHB_MARK_CLEAR = 1, /* the images are clear */
    SHB_MARK_LEFT = 2   /* a tile that is to be copied is clear, the images are not yet */
};

/* The bound of a cell where nothing has been cleared. */
#define SHB_NOT_CLEARED 4.0f

/* What keeps a vertex from being used as it is. */
enum {
    SHB_CODE_UNUSABLE = 1, /* behind the near plane, outside the guard band, or not finite */
    SHB_CODE_NOT_FINITE = 2,
    SHB_CODE_OUTSIDE = 4 | 8 | 16 | 32 /* one bit for each border of the target */
};

/* A vertex in window space, as it is and snapped. One that is not usable has SHB_UNUSABLE for its
 * snapped x and its code for its snapped y, and the rest means nothing: its triangles are left to
 * clipping. */
typedef struct shb_vertex {
    double x, y, z;
    int32_t snapped_x, snapped_y;
} shb_vertex;

/* Beyond all snapped coordinates, and so near that differences and boxes fit into 32 bits. */
#define SHB_UNUSABLE (1 << 26)

static inline uint32_t shb_vertex_code(const shb_vertex *vertex) {
    return vertex->snapped_x == SHB_UNUSABLE ? (uint32_t)vertex->snapped_y : 0;
}

/* Vertices of a mesh that are to be transformed. */
typedef struct shb_transform_job {
    const double *clip_from_mesh; /* column-major, row z for canonical depth */
    const float *positions[3];    /* the first x, y and z */
    size_t stride;                /* to the next ones, in floats */
    size_t count;
    bool affine; /* w is 1 */
    double half_width, half_height;
    const shb_clip_volume *volume;
    shb_vertex *vertices;
} shb_transform_job;

/* A cluster keeps the corners of so many triangles together: all first ones, then all second and
 * all third ones. Behind the last triangle follow some without extent. */
#define SHB_CORNERS_TOGETHER 16

static inline size_t shb_corner_place(uint32_t triangle, uint32_t corner) {
    const uint32_t run = triangle / SHB_CORNERS_TOGETHER;
    return (3 * run + corner) * SHB_CORNERS_TOGETHER + triangle % SHB_CORNERS_TOGETHER;
}

/* A cluster that a drawing has to look at. */
typedef struct shb_seen_cluster {
    const shb_target *target;
    const float *positions;        /* all x of the vertices, then all y and all z */
    const uint8_t *corners;        /* numbers of vertices, see shb_corner_place */
    uint32_t vertex_count, places; /* places: from the first x to the first y */
    bool may_be_coded;             /* some vertex may not be usable */
    bool is_small;                 /* all vertices are usable and near the origin */
    int32_t origin_x, origin_y;    /* a sample */
    shb_samples samples;           /* its usable triangles lie in them */
    float nearest;                 /* none of their samples is nearer */
} shb_seen_cluster;

/* Snapped coordinates in small clusters, less 256 * origin, are within +- this: pairs of 16 bits
 * hold their sums with 127 and -129, too. */
#define SHB_PAIR_REACH (INT16_MAX - 128)

/* Up to SHB_CHUNK triangles of one instance: those listed, or those that follow the first one. */
typedef struct shb_chunk {
    const shb_draw_instance *instance;
    const shb_vertex *vertices; /* of the instance; NULL: those of a cluster, to be transformed */
    const uint32_t *triangles;  /* numbers in the mesh, or NULL */
    uint32_t first;             /* number in the mesh */
    uint32_t count;
    shb_seen_cluster cluster; /* if there are no vertices yet */
} shb_chunk;

/* Puts the vertices of a chunk that is a cluster into window space. */
static inline shb_transform_job shb_cluster_job(const shb_chunk *chunk, shb_vertex *vertices) {
    const shb_seen_cluster *cluster = &chunk->cluster;
    const float *positions = cluster->positions;
    return (shb_transform_job){
        .clip_from_mesh = chunk->instance->clip_from_mesh.m,
        .positions = {positions, positions + cluster->places, positions + 2 * cluster->places},
        .stride = 1,
        .count = cluster->vertex_count,
        .affine = chunk->instance->affine,
        .half_width = cluster->target->half_width,
        .half_height = cluster->target->half_height,
        .volume = &cluster->target->volume,
        .vertices = vertices,
    };
}

/* A rectangle of the target, columns x0 .. x1 - 1 and rows y0 .. y1 - 1; x1 - x0 is a multiple of
 * 16, and columns from right on are not wanted but may be written. Texel (x, y) is element (y - y0)
 * * stride + x - x0. */
typedef struct shb_tile {
    float *depth;
    float *second;                  /* NULL: not wanted */
    uint32_t *ids;                  /* NULL: not wanted */
    const shb_plane_finder *planes; /* as in the target */
    ptrdiff_t stride;
    float far_depth;
    bool counts;         /* hidden triangles are to be counted, too */
    float *cells;        /* no sample of a cell is farther, SHB_NOT_CLEARED: it has no samples yet;
                            whole blocks of SHB_SMALL samples */
    float *second_cells; /* the same for the second layer */
    ptrdiff_t cell_stride;
    uint8_t *marks; /* as in the target, from the tile's first cell on */
    ptrdiff_t marks_stride;
    bool has_depth_image; /* otherwise marks say nothing of the depth */
    bool copied;          /* to the images, of which marks speak */
    int32_t x0, y0, right, x1, y1;
} shb_tile;

/* The cells of samples, counted from the first cell on, are drawn in. */
static inline void shb_marks_draw(uint8_t *marks, ptrdiff_t stride, const shb_samples *samples) {
    const int32_t last_row = samples->last_row / SHB_CELL;
    for (int32_t row = samples->first_row / SHB_CELL; marks && row <= last_row; row++)
        for (int32_t i = samples->first_column / SHB_CELL; i <= samples->last_column / SHB_CELL;
             i++)
            marks[row * stride + i] = SHB_MARK_DRAWN;
}

/* Tiles are 2^column_bits samples wide and 2^row_bits high. */
typedef struct shb_tile_shape {
    int column_bits, row_bits;
} shb_tile_shape;

/* The triangles of a chunk that are to be drawn, and the tiles that their boxes touch, both ends
 * included. */
typedef struct shb_chunk_ranges {
    uint32_t count;
    uint8_t triangle[SHB_CHUNK]; /* number in the chunk */
    uint16_t first_column[SHB_CHUNK], first_row[SHB_CHUNK];
    uint16_t last_column[SHB_CHUNK], last_row[SHB_CHUNK];
} shb_chunk_ranges;

/* One implementation for each instruction set; all give the same bits. */
typedef struct shb_kernels {
    /* True if a vertex is not usable. */
    bool (*transform)(const shb_transform_job *job);
    void (*find_tiles)(const shb_chunk *chunk, const shb_samples *target, shb_tile_shape shape,
                       shb_chunk_ranges *ranges);
    /* Returns how many triangles have their box in the tile, its first sample in the target
     * included; 0 for a cluster that lies behind what is drawn, unless the tile counts. */
    uint32_t (*draw)(const shb_chunk *chunk, const shb_tile *tile);
    /* Clears what no triangle has come near to. */
    void (*clear)(const shb_tile *tile);
} shb_kernels;

/* NULL: the scalar code. */
const shb_kernels *shb_kernels_of(shb_isa isa);

extern const shb_kernels shb_kernels_sse2, shb_kernels_avx2, shb_kernels_avx512, shb_kernels_neon;

#endif
