/* Cells of a pyramid, WIDE of them next to each other. */

#define CELL_SIDE (1 << SHB_PYRAMID_SHIFT)

/* Bounds that were calculated with slopes give way by this much of the numbers that went in:
 * several times what the rounding of a handful of operations can be. */
#define CELL_ROUNDING 0x1p-20f

typedef struct wide_cells {
    vf nearest, farthest;
    vf slope_x, slope_y;
} wide_cells;

static inline ALWAYS_INLINE wide_cells read_cells(const shb_pyramid_level *level, vi row,
                                                  vi column) {
    vf parts[4];
    vf_read_quads(&level->cells->nearest, (vu)(row * (int32_t)level->columns + column) * 4, parts);
    return (wide_cells){parts[0], parts[1], parts[2], parts[3]};
}

/* The first count of them. */
static inline ALWAYS_INLINE void write_cells(const wide_cells *cells, size_t count,
                                             shb_pyramid_cell *to) {
    const vf parts[4] = {cells->nearest, cells->farthest, cells->slope_x, cells->slope_y};
    shb_pyramid_cell written[WIDE];
    vf_write_quads(written, sizeof *written, parts);
    memcpy(to, written, (count < WIDE ? count : WIDE) * sizeof *to);
}

/* b where it is narrower; not where there is no telling. */
static inline ALWAYS_INLINE wide_cells narrower_cells(const wide_cells *a, const wide_cells *b) {
    const vi narrower = (b->farthest - b->nearest) < (a->farthest - a->nearest);
    return (wide_cells){
        vf_where(narrower, b->nearest, a->nearest), vf_where(narrower, b->farthest, a->farthest),
        vf_where(narrower, b->slope_x, a->slope_x), vf_where(narrower, b->slope_y, a->slope_y)};
}

/* Bounds of the texels' depths along these slopes. */
static inline ALWAYS_INLINE wide_cells bound_texels(vf texels[CELL_SIDE][CELL_SIDE], vf slope_x,
                                                    vf slope_y) {
    wide_cells cells = {vf_splat(INFINITY), vf_splat(-INFINITY), slope_x, slope_y};
    for (int row = 0; row < CELL_SIDE; row++)
        for (int column = 0; column < CELL_SIDE; column++) {
            const vf run = (float)column * slope_x + (float)row * slope_y;
            const vf depth = texels[row][column] - run;
            cells.nearest = vf_min(depth, cells.nearest);
            cells.farthest = vf_max(depth, cells.farthest);
        }
    return cells;
}

/* Slopes of a cell: the mean difference between its halves, which lie half of its side apart. 0
 * where that is no number, as in cells with empty texels, or beyond what receivers have. */
static inline ALWAYS_INLINE vf usable_slope(vf difference) {
    const float pairs = CELL_SIDE * CELL_SIDE / 2 * (CELL_SIDE / 2);
    const vf slope = difference / pairs;
    return vf_keep(vf_abs(slope) <= 1, slope);
}

/* Cells of texels from a place on, whose rows lie pitch floats apart. */
static inline ALWAYS_INLINE wide_cells cells_of_texels(const float *depths, size_t pitch,
                                                       float far_depth) {
    const vu begin = (vu)vi_numbers() * CELL_SIDE;
    vf texels[CELL_SIDE][CELL_SIDE], across = {0}, down = {0};
    for (int row = 0; row < CELL_SIDE; row++) {
        for (int column = 0; column < CELL_SIDE; column += 4)
            vf_read_quads(depths + (size_t)row * pitch + column, begin, texels[row] + column);
        for (int column = 0; column < CELL_SIDE; column++) {
            vf *texel = &texels[row][column];
            *texel = vf_where(*texel < far_depth, *texel, vf_splat(INFINITY));
            across += column < CELL_SIDE / 2 ? -*texel : *texel;
            down += row < CELL_SIDE / 2 ? -*texel : *texel;
        }
    }
    const vf slope_x = usable_slope(across), slope_y = usable_slope(down);
    const wide_cells flat = bound_texels(texels, vf_splat(0), vf_splat(0));
    wide_cells sloped = bound_texels(texels, slope_x, slope_y);
    const vf rise = CELL_SIDE * (vf_abs(slope_x) + vf_abs(slope_y));
    const vf rounding =
        CELL_ROUNDING * (vf_max(vf_abs(flat.nearest), vf_abs(flat.farthest)) + rise);
    sloped.nearest -= rounding;
    sloped.farthest += rounding;
    return narrower_cells(&flat, &sloped);
}

static void bound_cells(const float *depths, size_t pitch, float far_depth, size_t count,
                        shb_pyramid_cell *cells) {
    for (size_t i = 0; i < count; i += WIDE) {
        const wide_cells made = cells_of_texels(depths + i * CELL_SIDE, pitch, far_depth);
        write_cells(&made, count - i, cells + i);
    }
}

/* Four cells, of this size, and how far the right and the lower ones lie from the others. */
typedef struct cells_to_join {
    wide_cells cells[4];
    vf right, down;
    float size;
} cells_to_join;

/* Bounds of all four along these slopes. Empty cells, whose bounds are infinite, widen no nearest
 * one. */
static inline ALWAYS_INLINE wide_cells join_along(const cells_to_join *from, vf slope_x,
                                                  vf slope_y) {
    const vf zero = vf_splat(0);
    wide_cells joined = {vf_splat(INFINITY), vf_splat(-INFINITY), slope_x, slope_y};
    for (int k = 0; k < 4; k++) {
        const wide_cells *cell = &from->cells[k];
        const vf more_x = (cell->slope_x - slope_x) * (from->size - 1);
        const vf more_y = (cell->slope_y - slope_y) * (from->size - 1);
        const vf run =
            (k & 1 ? from->right * slope_x : zero) + (k & 2 ? from->down * slope_y : zero);
        const vf low = vf_min(more_x, zero) + vf_min(more_y, zero);
        const vf high = vf_max(more_x, zero) + vf_max(more_y, zero);
        const vf rise =
            (vf_abs(slope_x) + vf_abs(slope_y)) + (vf_abs(cell->slope_x) + vf_abs(cell->slope_y));
        const vf depth = vf_keep(cell->nearest < INFINITY, vf_abs(cell->nearest));
        const vf rounding = vf_keep(rise > 0, CELL_ROUNDING * (depth + 2 * from->size * rise));
        joined.nearest = vf_min(((cell->nearest - run) + low) - rounding, joined.nearest);
        joined.farthest = vf_max(((cell->farthest - run) + high) + rounding, joined.farthest);
    }
    return joined;
}

/* Along the mean slopes, or level. */
static inline ALWAYS_INLINE wide_cells join_neighbours(const cells_to_join *from) {
    const wide_cells *cells = from->cells;
    const vf slope_x =
        ((cells[0].slope_x + cells[1].slope_x) + cells[2].slope_x) + cells[3].slope_x;
    const vf slope_y =
        ((cells[0].slope_y + cells[1].slope_y) + cells[2].slope_y) + cells[3].slope_y;
    const wide_cells flat = join_along(from, vf_splat(0), vf_splat(0));
    const wide_cells sloped = join_along(from, slope_x * 0.25f, slope_y * 0.25f);
    return narrower_cells(&flat, &sloped);
}

/* The one that lies so many cells further, or beyond the last of count cells the same one. */
static inline ALWAYS_INLINE vi next_cell(vi cell, uint32_t every, uint32_t count) {
    const vi next = cell + (int32_t)every;
    return cell + ((next - cell) & (next < (int32_t)count));
}

static void join_cells(const shb_pyramid_level *from, uint32_t every, float size, uint32_t row,
                       const shb_pyramid_level *made) {
    const vi up = vi_splat((int32_t)(every * row)), down = next_cell(up, every, from->rows);
    shb_pyramid_cell *cells = made->cells + (size_t)row * made->columns;
    for (uint32_t i = 0; i < made->columns; i += WIDE) {
        const vi wanted = (vi_numbers() + (int32_t)i) * (int32_t)every;
        const vi last = vi_splat((int32_t)from->columns - 1), beyond = wanted > last;
        const vi left = (last & beyond) | (wanted & ~beyond);
        const vi right = next_cell(left, every, from->columns);
        const cells_to_join four = {{read_cells(from, up, left), read_cells(from, up, right),
                                     read_cells(from, down, left), read_cells(from, down, right)},
                                    vf_keep(right != left, vf_splat(size)),
                                    vf_keep(down != up, vf_splat(size)),
                                    size};
        const wide_cells joined = join_neighbours(&four);
        write_cells(&joined, made->columns - i, cells + i);
    }
}
