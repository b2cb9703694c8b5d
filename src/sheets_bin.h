/* Triangles into the tiles of sheets, front to back. */
#ifndef SRC_SHEETS_BIN_H
#define SRC_SHEETS_BIN_H

#include "light_mesh.h"

/* Tiles of this many texels on a side. */
#define SHB_SHEET_TILE 64

/* What the buffers of a context's sheet_scratch hold. */
enum {
    SHB_SHEET_BOXES,
    SHB_SHEET_ENDS,
    SHB_SHEET_KEYS,
    SHB_SHEET_SPARE,
    SHB_SHEET_VERTICES, /* of a light's mesh while a scene is drawn, as the rest */
    SHB_SHEET_FACING,
    SHB_SHEET_EXTENTS
};

typedef struct shb_sheet_bins {
    size_t triangle_count;
    size_t tile_columns, tile_count;
    shb_light_box *boxes;   /* by id */
    size_t *ends;           /* of the keys of each tile and part of the triangles */
    uint64_t *keys, *spare; /* ids in the low halves; as much room again */
} shb_sheet_bins;

/* Reserves boxes, for shb_light_mesh_make to fill; then puts the triangles into the tiles that
 * their boxes meet. All of it lies in the context's scratch. False: out of memory. */
bool shb_sheet_bins_reserve(shb_context *context, const shb_map_info *info, size_t triangle_count,
                            shb_sheet_bins *bins);
bool shb_sheet_bins_fill(shb_context *context, shb_sheet_bins *bins);

/* The triangles that meet a tile, in the low halves of keys, in the order of their nearest depths
 * as far as frame has levels for them. Any thread, any tile. */
const uint64_t *shb_sheet_bin(const shb_sheet_bins *bins, const shb_list_frame *frame, size_t tile,
                              size_t *count);

#endif
