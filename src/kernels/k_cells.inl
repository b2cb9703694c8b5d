/* Large triangles go through the tile in blocks of 4 by 4 cells, both aligned to the tile. Each
 * cell is skipped, drawn without edges or drawn with them. It is skipped if the triangle does not
 * touch it or lies behind everything in it: the tile keeps a bound of each cell's farthest depth,
 * lowered by the triangles that cover the whole cell, and one of the second layer: of two triangles
 * that cover the cell no second depth is beyond the farther one. Triangles within a few cells are
 * left out if they lie behind all of them, where there is no second layer. */

#define BLOCK_CELLS (SHB_SMALL / SHB_CELL)

/* What becomes of a cell. */
enum { CELL_SKIPPED, CELL_CROSSED, CELL_COVERED };

/* Cells of a block, a bit for each, row after row. */
typedef struct block_cells {
    uint64_t crossed, covered;
} block_cells;

#define ALL_CELLS 0xffff

/* What loops over samples ask of a tile: stores into texels could change the tile itself. */
typedef struct tile_texels {
    float *depth, *second;
    uint32_t *ids;
    ptrdiff_t stride;
} tile_texels;

static inline tile_texels texels_of(const shb_tile *tile) {
    return (tile_texels){tile->depth, tile->second, tile->ids, tile->stride};
}

/* The depth that the triangle has at the sample i columns and j rows from its box's first one. It
 * rises or falls all the way along rows and columns, rounding included. */
static inline __attribute__((always_inline)) float
depth_at(const chunk_planes *planes, int t, int layers, bool plain, int32_t i, int32_t j) {
    if (plain) {
        const float z =
            (planes->depth[t] + planes->depth_y[t] * (float)j) + planes->depth_x[t] * (float)i;
        return layers & LAYER_PLANES ? planes->anchor[t] + z : z;
    }
    const double z = (planes->base[t] + planes->step_y[t] * j) + planes->step_x[t] * i;
    const double above = z > planes->lo[t] ? z : planes->lo[t];
    return (float)(above < planes->hi[t] ? above : planes->hi[t]);
}

/* The bounds of the block's cells, of the last layer that is wanted. */
static void load_farthest(const shb_tile *tile, int layers, int32_t left, int32_t top,
                          float farthest[BLOCK_CELLS * BLOCK_CELLS]) {
    const float *cells = (layers & LAYER_SECOND ? tile->second_cells : tile->cells) +
                         (top - tile->y0) / SHB_CELL * tile->cell_stride +
                         (left - tile->x0) / SHB_CELL;
    for (int row = 0; row < BLOCK_CELLS; row++)
        for (int column = 0; column < BLOCK_CELLS; column++)
            farthest[row * BLOCK_CELLS + column] = cells[row * tile->cell_stride + column];
}

/* True if the triangle lies behind everything in the cells of a part of its box. Of second layers
 * too few are to pay for the question. */
static inline __attribute__((always_inline)) bool
is_part_hidden(const shb_tile *tile, int layers, const chunk_boxes *boxes,
               const chunk_planes *planes, int t, bool plain, const sample_rectangle *part) {
    const int32_t near_x = planes->step_x[t] < 0 ? part->right - 1 : part->left;
    const int32_t near_y = planes->step_y[t] < 0 ? part->bottom - 1 : part->top;
    const float nearest =
        depth_at(planes, t, layers, plain, near_x - boxes->x[t], near_y - boxes->y[t]);
    const int32_t first = (part->left - tile->x0) / SHB_CELL;
    const int32_t last = (part->right - 1 - tile->x0) / SHB_CELL;
    const int32_t last_row = (part->bottom - 1 - tile->y0) / SHB_CELL;
    for (int32_t row = (part->top - tile->y0) / SHB_CELL; row <= last_row; row++)
        for (int32_t column = first; column <= last; column++)
            if (!(tile->cells[row * tile->cell_stride + column] < nearest))
                return false;
    return true;
}

/* Cells that no edge rejects, and those that no edge crosses. */
static void find_covered(const block_edges *edges, int32_t states[BLOCK_CELLS * BLOCK_CELLS]) {
    int32_t highest[3], lowest[3];
    for (int k = 0; k < 3; k++) {
        const int32_t across = edges->step_x[k] * (SHB_CELL - 1);
        const int32_t down = edges->step_y[k] * (SHB_CELL - 1);
        highest[k] = edges->value[k] + MAX(across, 0) + MAX(down, 0);
        lowest[k] = edges->value[k] + MIN(across, 0) + MIN(down, 0);
    }
    for (int c = 0; c < BLOCK_CELLS * BLOCK_CELLS; c++) {
        const int32_t i = c % BLOCK_CELLS * SHB_CELL, j = c / BLOCK_CELLS * SHB_CELL;
        int32_t rejected = 0, crossed = 0;
        for (int k = 0; k < 3; k++) {
            const int32_t step = edges->step_x[k] * i + edges->step_y[k] * j;
            rejected |= highest[k] + step;
            crossed |= lowest[k] + step;
        }
        const int32_t touched = crossed < 0 ? CELL_CROSSED : CELL_COVERED;
        states[c] = rejected < 0 ? CELL_SKIPPED : touched;
    }
}

/* Looks at the cells of the block that starts i columns and j rows from the box's first sample. At
 * equal depth an id may still win. */
static inline __attribute__((always_inline)) block_cells
find_cells(const chunk_planes *planes, int t, int layers, bool plain, const block_edges *edges,
           int32_t i, int32_t j, const float farthest[BLOCK_CELLS * BLOCK_CELLS]) {
    int32_t states[BLOCK_CELLS * BLOCK_CELLS];
    uint8_t narrow[64] = {0};
    find_covered(edges, states);
    const int32_t near_i = i + (planes->step_x[t] < 0 ? SHB_CELL - 1 : 0);
    const int32_t near_j = j + (planes->step_y[t] < 0 ? SHB_CELL - 1 : 0);
    for (int c = 0; c < BLOCK_CELLS * BLOCK_CELLS; c++) {
        const float nearest =
            depth_at(planes, t, layers, plain, near_i + c % BLOCK_CELLS * SHB_CELL,
                     near_j + c / BLOCK_CELLS * SHB_CELL);
        const int32_t at_equal = nearest == farthest[c] && !(layers & LAYER_IDS) ? 0 : states[c];
        states[c] = nearest > farthest[c] ? 0 : at_equal;
    }
    for (int c = 0; c < BLOCK_CELLS * BLOCK_CELLS; c++)
        narrow[c] = (uint8_t)states[c];
    return (block_cells){wide_equal_bytes(narrow, CELL_CROSSED),
                         wide_equal_bytes(narrow, CELL_COVERED)};
}

/* Lowers the bounds of count by count cells that the triangle covers; (x, y) is their first sample.
 */
static inline __attribute__((always_inline)) void
lower_bounds(const shb_tile *tile, int layers, const chunk_boxes *boxes, const chunk_planes *planes,
             int t, bool plain, int32_t x, int32_t y, int32_t count) {
    ptrdiff_t first = (y - tile->y0) / SHB_CELL * tile->cell_stride + (x - tile->x0) / SHB_CELL;
    const int32_t far_i = x - boxes->x[t] + (planes->step_x[t] < 0 ? 0 : SHB_CELL - 1);
    const int32_t far_j = y - boxes->y[t] + (planes->step_y[t] < 0 ? 0 : SHB_CELL - 1);
    for (int32_t row = 0; row < count; row++, first += tile->cell_stride)
        for (int32_t column = 0; column < count; column++) {
            const float farthest = depth_at(planes, t, layers, plain, far_i + column * SHB_CELL,
                                            far_j + row * SHB_CELL);
            float *cell = tile->cells + first + column;
            if (layers & LAYER_SECOND) {
                float *second = tile->second_cells + first + column;
                *second = MIN(*second, MAX(farthest, *cell));
            }
            *cell = MIN(farthest, *cell);
        }
}
