/* The loops of finding and asking front sheets, one implementation for each instruction set; all
 * give the same bits. */
#ifndef SRC_KERNELS_SHEETS_H
#define SRC_KERNELS_SHEETS_H

#include "../light_mesh.h"
#include "../sheets.h"

/* Elements to a row of a tile: vectors may write behind it. */
#define SHB_SHEET_PITCH (SHB_SHEET_TILE + 16)

/* What a triangle of the front adds to a texel: it covers the point where triangles are counted; or
 * it has an edge there with nothing beyond it. */
enum { SHB_SHEET_COVERED = 1, SHB_SHEET_BROKEN = 2 };

/* A tile while triangles are laid over it. */
typedef struct shb_sheet_tile {
    const shb_sheet_frame *frame;
    int32_t column, row; /* of its first texel */
    int32_t columns, rows;
    SHB_ALIGN float front[SHB_SHEET_TILE * SHB_SHEET_PITCH]; /* where the front ends */
    float next[SHB_SHEET_TILE * SHB_SHEET_PITCH];            /* where something behind it begins */
    float far[SHB_SHEET_TILE * SHB_SHEET_PITCH];             /* behind it all is in shadow */
    int32_t state[SHB_SHEET_TILE * SHB_SHEET_PITCH];         /* a sum of SHB_SHEET_*: 1 is of use */
} shb_sheet_tile;

typedef struct shb_sheet_kernels {
    /* Boxes and facing of whole triangles. */
    void (*look)(const shb_list_frame *frame, const shb_list_corners *corners,
                 shb_light_box boxes[SHB_LIST_LANES], int8_t facing[SHB_LIST_LANES]);

    /* Makes a tile of its texels' depths, which are in front. */
    void (*begin)(shb_sheet_tile *tile, float far_depth);

    /* Lays count whole triangles over a tile that their boxes meet. ends: bit k of a triangle: its
     * edge from corner k to the next has nothing beyond it. */
    void (*lay)(shb_sheet_tile *tile, const shb_list_corners *corners,
                const uint32_t ends[SHB_LIST_LANES], uint32_t count);

    /* No front ends behind this depth. */
    float (*farthest)(const shb_sheet_tile *tile);

    /* Writes the bounds of a row of texels, SHB_SHEET_TILE of them. */
    void (*end)(const shb_sheet_tile *tile, int32_t row, float *bounds);

    /* answers[i], SHB_LIGHT_*, for a batch of points; loops run over the count rounded up to whole
     * vectors. */
    void (*ask)(const shb_sheets *sheets, size_t count, const float *x, const float *y,
                const float *z, int32_t *answers);
} shb_sheet_kernels;

/* Never NULL. */
const shb_sheet_kernels *shb_sheet_kernels_of(shb_isa isa);

extern const shb_sheet_kernels shb_sheet_kernels_scalar, shb_sheet_kernels_sse2,
    shb_sheet_kernels_avx2, shb_sheet_kernels_avx512, shb_sheet_kernels_neon;

#endif
