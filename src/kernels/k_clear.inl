/* Clearing where triangles are about to be drawn: memory is written while it is in a cache. */

/* Cells of a row that are cleared together: long runs of memory are written faster, but in a tile
 * that is larger than caches, which only many small triangles have, they have left these before
 * something is drawn in them. */
#define CLEAR_CELLS 64
#define CLEAR_CELLS_LARGE 4
#define LARGE_TEXELS (2048 * 2048)

static int32_t clear_run(const shb_tile *tile) {
    const bool large = (tile->x1 - tile->x0) * (tile->y1 - tile->y0) > LARGE_TEXELS;
    return large ? CLEAR_CELLS_LARGE : CLEAR_CELLS;
}

static void fill_far(int32_t columns, int32_t rows, ptrdiff_t stride, float far_depth,
                     float *texels) {
    for (int32_t row = 0; row < rows; row++, texels += stride)
        for (int32_t i = 0; i < columns; i++)
            texels[i] = far_depth;
}

/* Clears count cells of which the first one has this place in the tile. known: the images are clear
 * there. */
static void clear_layers(const shb_tile *tile, int32_t column, int32_t row, int32_t count,
                         bool known) {
    const int32_t x = column * SHB_CELL, y = row * SHB_CELL;
    const int32_t columns = MIN(count * SHB_CELL, tile->x1 - tile->x0 - x);
    const int32_t rows = MIN(SHB_CELL, tile->y1 - tile->y0 - y);
    const ptrdiff_t at = y * tile->stride + x;
    if (!known || !tile->has_depth_image)
        fill_far(columns, rows, tile->stride, tile->far_depth, tile->depth + at);
    if (tile->second && !known)
        fill_far(columns, rows, tile->stride, tile->far_depth, tile->second + at);
    for (int32_t j = 0; tile->ids && !known && j < rows; j++)
        memset(tile->ids + at + j * tile->stride, 0xff, (size_t)columns * sizeof *tile->ids);
}

/* The same for cells that have marks, which are all clear then. */
static void clear_marked(const shb_tile *tile, int32_t column, int32_t row, int32_t count) {
    uint8_t *const marks = tile->marks + row * tile->marks_stride + column;
    for (int32_t i = 0, end; i < count; i = end) {
        const uint8_t mark = marks[i];
        for (end = i; end < count && marks[end] == mark; end++)
            marks[end] = SHB_MARK_CLEAR;
        clear_layers(tile, column + i, row, end - i, mark == SHB_MARK_CLEAR);
    }
}

/* The same with the bounds of the cells. */
static void clear_cells(const shb_tile *tile, int32_t column, int32_t row, int32_t count) {
    const ptrdiff_t first = row * tile->cell_stride + column;
    if (tile->marks && !tile->copied)
        clear_marked(tile, column, row, MIN(count, (tile->x1 - tile->x0) / SHB_CELL - column));
    else
        clear_layers(tile, column, row, count, false);
    fill_far(count, 1, 0, tile->far_depth, tile->cells + first);
    if (tile->second)
        fill_far(count, 1, 0, tile->far_depth, tile->second_cells + first);
}

/* Clears what is not yet cleared of the rectangle's cells and of those beside them. */
static void clear_reached(const shb_tile *tile, const sample_rectangle *reached) {
    const int32_t first_row = (reached->top - tile->y0) / SHB_CELL;
    const int32_t last_row = (reached->bottom - 1 - tile->y0) / SHB_CELL;
    const int32_t left = (reached->left - tile->x0) / SHB_CELL;
    const int32_t run = clear_run(tile), first = left - left % run;
    const int32_t last = (reached->right - 1 - tile->x0) / SHB_CELL;
    const int32_t stride = (int32_t)tile->cell_stride;
    for (int32_t row = first_row; row <= last_row; row++) {
        const float *cells = tile->cells + row * tile->cell_stride;
        for (int32_t column = first; column <= last; column += run) {
            const int32_t start = column;
            while (column <= last && cells[column] == SHB_NOT_CLEARED)
                column += run;
            if (column > start)
                clear_cells(tile, start, row, MIN(column, stride) - start);
        }
    }
}

/* The same for triangles that are to be drawn there. */
static void reach(const shb_tile *tile, const sample_rectangle *reached) {
    clear_reached(tile, reached);
    shb_marks_draw(tile->marks, tile->marks_stride,
                   &(shb_samples){reached->left - tile->x0, reached->top - tile->y0,
                                  reached->right - 1 - tile->x0, reached->bottom - 1 - tile->y0});
}

static void clear(const shb_tile *tile) {
    clear_reached(tile, &(sample_rectangle){tile->x0, tile->y0, tile->x1, tile->y1});
}
