/* What the rasterizer's kernels and the code around them hand to each other. Depth is canonical:
 * smaller is nearer. */
#ifndef SRC_KERNELS_RASTER_H
#define SRC_KERNELS_RASTER_H

#include "../clip.h"

/* Triangles are set up this many at a time. */
#define SHB_CHUNK 128

/* Edges of a box up to this many samples wide and high fit into 32 bits. */
#define SHB_SMALL 64

/* A vertex in window space, and a code that is 0 where it can be used as it is. All others are 0
 * where the code is not: such triangles are left to clipping. */
typedef struct shb_vertex {
    double x, y, z, code;
} shb_vertex;

/* What becomes of a mesh's vertices. */
typedef struct shb_transform_job {
    const double *clip_from_mesh; /* column-major, row z for canonical depth */
    const float *positions;
    size_t stride; /* in floats */
    size_t count;
    bool affine; /* w is 1 */
    double half_width, half_height;
    double plane_sign[5], plane_offset[5]; /* the five cut planes of clip.h, in their order */
    int plane_axis[5];
    shb_vertex *vertices;
} shb_transform_job;

/* Up to SHB_CHUNK triangles of one instance that follow each other. */
typedef struct shb_chunk {
    const shb_vertex *vertices; /* of the instance */
    const void *indices;        /* of the chunk's first triangle; NULL: first_vertex, ... */
    uint32_t index_size;
    uint32_t first_vertex;
    uint32_t count;
    uint32_t id; /* of the first triangle */
    bool keep_positive, keep_negative;
} shb_chunk;

/* A rectangle of the target, columns x0 .. x1 - 1 and rows y0 .. y1 - 1; x1 - x0 is a multiple of 16.
 * Texel (x, y) is depth[y * stride + x]. */
typedef struct shb_tile {
    float *depth;
    float *second; /* NULL: not wanted */
    uint32_t *ids; /* NULL: not wanted */
    ptrdiff_t stride;
    int32_t x0, y0, x1, y1;
} shb_tile;

/* What a look at a chunk finds: how many triangles face the right way and cover some of the target,
 * how many need clipping, and the box around the former. */
typedef struct shb_chunk_summary {
    int32_t x0, y0, x1, y1;
    uint32_t drawn, coded;
} shb_chunk_summary;

/* One implementation for each instruction set; all give the same bits. */
typedef struct shb_kernels {
    void (*transform)(const shb_transform_job *job);
    void (*summarize)(const shb_chunk *chunk, uint32_t width, uint32_t height,
                      shb_chunk_summary *summary);
    void (*draw)(const shb_chunk *chunk, const shb_tile *tile);
} shb_kernels;

extern const shb_kernels shb_kernels_sse2, shb_kernels_avx2, shb_kernels_avx512, shb_kernels_neon;

#endif
