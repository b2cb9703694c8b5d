/* The loops of putting a tile's triangles into its cells. */

/* Where a texel's triangles are counted, from its corner: where no edge passes by because a mesh
 * and the map are aligned. */
#define LIST_SAMPLE_X 0x1.1p-1f
#define LIST_SAMPLE_Y 0x1.bp-2f

/* The most rows and columns of cells that a small triangle lies in. */
enum { LIST_SMALL = 3 };

/* Where a triangle lies in a tile, in cells. */
typedef struct list_cells {
    uint32_t first_column, last_column, first_row, last_row;
} list_cells;

/* Triangles that are put into cells one after the other, as linear functions over the tile, from
 * its corner: the weights at the best corner of a cell, which are negative where the triangle
 * misses the cell for sure; what they gain for each cell that a window is larger, and what their
 * worst corner has less; and depths at which the triangle begins and ends in a cell. */
typedef struct list_batch {
    SHB_ALIGN float x[3][LIST_LANES];
    float y[3][LIST_LANES], best[3][LIST_LANES], more[3][LIST_LANES], worst[3][LIST_LANES];
    float slope_x[LIST_LANES], slope_y[LIST_LANES], begin[LIST_LANES], end[LIST_LANES];
    float nearest[LIST_LANES];
    /* The same of texels, for sheets: the weights at their best corner, and below what an edge's
     * line may pass them; what their sample has more, and where that is surely covered. */
    float met[3][LIST_LANES], passed[3][LIST_LANES], sample[3][LIST_LANES], sure[LIST_LANES];
    float texel_begin[LIST_LANES], texel_end[LIST_LANES];
    /* numbers of texels, from 1 on: a byte for the box of each edge, the uppermost for all */
    int32_t first_column[LIST_LANES], last_column[LIST_LANES];
    int32_t first_row[LIST_LANES], last_row[LIST_LANES];
    int32_t edges[3][2][LIST_LANES], covers[2][LIST_LANES]; /* what they add to the sums */
    int count;
    uint32_t numbers[LIST_LANES];
    list_cells cells[LIST_LANES];
    int32_t first_columns[LIST_LANES], first_rows[LIST_LANES];
    int32_t columns[LIST_LANES], rows[LIST_LANES]; /* behind the first one; -1 when triangles that
                                                      are not small have been left out */
} list_batch;

/* Words of records, WIDE lanes of each four. */
static inline void read_words(const float *records, int lane, uint32_t word, vf out[4]) {
    vf_read_quads(records + (size_t)lane * 16, (vu)vi_numbers() * 16 + word, out);
}

static inline vf positive(vf v) {
    return vf_max(v, vf_splat(0));
}

/* The weights of WIDE triangles from lane i on. */
static inline void put_weights(const shb_list_cover *cover, bool with_sheets, float rim,
                               const float *records, int i, list_batch *b) {
    const float column = (float)cover->column, row = (float)cover->row;
    const float size = (float)(1 << cover->cell_bits);
    vf u[4], v[4], rest[4]; /* the first word of v comes with u */
    read_words(records, i, offsetof(shb_list_triangle, u) / 4, u);
    read_words(records, i, offsetof(shb_list_triangle, v) / 4, v);
    read_words(records, i, offsetof(shb_list_triangle, rest) / 4, rest);
    const vf margin = rest[1];
    const vf x[3] = {-(u[0] + v[0]), u[0], v[0]}, y[3] = {-(u[1] + v[1]), u[1], v[1]};
    const vf first[3] = {(rest[0] - u[2]) - v[2], u[2], v[2]};
    for (int k = 0; k < 3; k++) {
        const vf one = ((x[k] * column + y[k] * row) + first[k]) + margin;
        const vf sizes = vf_abs(x[k]) + vf_abs(y[k]);
        const vf across = positive(x[k]) + positive(y[k]);
        vf_store(b->x[k] + i, x[k]);
        vf_store(b->y[k] + i, y[k]);
        vf_store(b->best[k] + i, one + (size * across + rim * sizes));
        vf_store(b->more[k] + i, size * across);
        vf_store(b->worst[k] + i, -(size + 2 * rim) * sizes - 4 * margin);
        if (with_sheets) {
            vf_store(b->met[k] + i, one + (across + rim * sizes));
            vf_store(b->passed[k] + i, (1 + 2 * rim) * sizes + 4 * margin);
            vf_store(b->sample[k] + i,
                     ((LIST_SAMPLE_X * x[k] + LIST_SAMPLE_Y * y[k]) - across) - rim * sizes);
        }
    }
    vf_store(b->sure + i, 4 * margin);
}

/* Depths of all lanes. */
static inline void put_cell_depths(const shb_list_cover *cover, bool with_sheets, float rim,
                                   list_batch *b) {
    const float size = (float)(1 << cover->cell_bits);
    SHB_ALIGN float z[LIST_LANES], clear[LIST_LANES];
    for (int i = 0; i < LIST_LANES; i++) {
        const shb_list_triangle *t = &cover->triangles[b->numbers[i]];
        z[i] = (float)-shb_list_behind(t, (double)cover->column, (double)cover->row, 0);
        b->slope_x[i] = (float)-t->plane[0];
        b->slope_y[i] = (float)-t->plane[1];
        clear[i] = t->clear;
    }
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vf x = vf_load(b->slope_x + i), y = vf_load(b->slope_y + i), at = vf_load(z + i);
        const vf steep = vf_abs(x) + vf_abs(y), none = vf_splat(0);
        const vf rounding =
            (0x1p-20f * (vf_abs(at) + SHB_LIST_TILE * steep) + rim * steep) + vf_load(clear + i);
        vf_store(b->begin + i, (at + size * (vf_min(x, none) + vf_min(y, none))) - rounding);
        vf_store(b->end + i, (at + size * (vf_max(x, none) + vf_max(y, none))) + rounding);
        if (with_sheets) {
            vf_store(b->texel_begin + i, (at + (vf_min(x, none) + vf_min(y, none))) - rounding);
            vf_store(b->texel_end + i, (at + (vf_max(x, none) + vf_max(y, none))) + rounding);
        }
    }
}

/* The texels that the boxes of edges reach, of columns or rows. */
static inline void put_reach(const vf middle[3], const vf reach[3], int32_t *first, int32_t *last) {
    const vf none = vf_splat(0), all = vf_splat(SHB_LIST_TILE + 1);
    vf lo = all, hi = none;
    vi firsts = {0}, lasts = {0};
    for (int k = 0; k < 4; k++) {
        const vf from = k < 3 ? vf_min(vf_max((middle[k] - reach[k]) + 1.5f, none), all) : lo;
        const vf to = k < 3 ? vf_min(vf_max((middle[k] + reach[k]) + 0.5f, none), all) : hi;
        firsts |= __builtin_convertvector(from, vi) << 8 * k;
        lasts |= __builtin_convertvector(to, vi) << 8 * k;
        lo = vf_min(lo, from);
        hi = vf_max(hi, to);
    }
    vi_store(first, firsts);
    vi_store(last, lasts);
}

/* What WIDE triangles from lane i on add to sheets, and where. */
static inline void put_outlines_of(const shb_list_cover *cover, const float *records, int i,
                                   list_batch *b) {
    const float column = (float)cover->column, row = (float)cover->row;
    const float around = 0.5f + (float)cover->frame->rim + 0x1p-21f * (column + row);
    vf places[8], edges[8], middle_x[3], middle_y[3], reach_x[3], reach_y[3];
    read_words(records, i, 0, places);
    read_words(records, i, 4, places + 4);
    read_words(records, i, 6, edges);
    read_words(records, i, 10, edges + 4); /* two of edges, and is_known */
    const vi known = -(vi)edges[6];
    for (int k = 0; k < 3; k++) {
        const vf x_0 = places[(k + 1) % 3] - column, x_1 = places[(k + 2) % 3] - column;
        const vf y_0 = places[3 + (k + 1) % 3] - row, y_1 = places[3 + (k + 2) % 3] - row;
        const vf width = vf_abs(x_1 - x_0), height = vf_abs(y_1 - y_0);
        middle_x[k] = 0.5f * (x_0 + x_1);
        middle_y[k] = 0.5f * (y_0 + y_1);
        reach_x[k] = (0.5f * width + around) + 0x1p-20f * (width + vf_abs(middle_x[k]));
        reach_y[k] = (0.5f * height + around) + 0x1p-20f * (height + vf_abs(middle_y[k]));
        vi_store(b->edges[k][0] + i, (vi)edges[2 * k] & known);
        vi_store(b->edges[k][1] + i, (vi)edges[2 * k + 1] & known);
        vf_store(b->sample[k] + i, vf_where(known, vf_load(b->sample[k] + i), vf_splat(HUGE_VALF)));
    }
    put_reach(middle_x, reach_x, b->first_column + i, b->last_column + i);
    put_reach(middle_y, reach_y, b->first_row + i, b->last_row + i);
    vi_store(b->covers[0] + i, vi_splat((int32_t)SHB_LIST_SHEET_0) & known);
    vi_store(b->covers[1] + i, (vi_splat((int32_t)SHB_LIST_SHEET_1) & known) |
                                   (vi_splat((int32_t)SHB_LIST_UNKNOWN_1) & ~known));
}

/* Makes the functions of a batch whose numbers are there. */
static void put_functions(const shb_list_cover *cover, bool with_sheets, list_batch *b) {
    SHB_ALIGN float records[LIST_LANES * 16];
    const float rim = with_sheets ? (float)cover->frame->rim : 0;
    for (int i = b->count; i < LIST_LANES; i++)
        b->numbers[i] = b->numbers[0];
    for (int i = 0; i < LIST_LANES; i++)
        memcpy(records + 16 * i, &cover->triangles[b->numbers[i]], sizeof *cover->triangles);
    for (int i = 0; i < LIST_LANES; i += WIDE)
        put_weights(cover, with_sheets, rim, records, i, b);
    put_cell_depths(cover, with_sheets, rim, b);
    if (!with_sheets)
        return;
    for (int i = 0; i < LIST_LANES; i++)
        memcpy(records + 16 * i, &cover->outlines[b->numbers[i]], sizeof *cover->outlines);
    for (int i = 0; i < LIST_LANES; i += WIDE)
        put_outlines_of(cover, records, i, b);
}

#include "k_list_sheet.inl"

static inline uint32_t first_cell(uint32_t texel, uint32_t tile, int bits) {
    return (texel > tile ? texel - tile : 0) >> bits;
}

static inline uint32_t last_cell(uint32_t texel, uint32_t tile, int bits) {
    const uint32_t last = texel - tile;
    return (last < SHB_LIST_TILE ? last : SHB_LIST_TILE - 1) >> bits;
}

/* Blocks of a row, one bit each, such that a window that begins there has cells which do not hide a
 * depth. */
static inline uint32_t open_blocks(const shb_list_cover *cover, uint32_t row, float depth) {
    const float *farthest = cover->farthest + (size_t)row * SHB_LIST_BLOCKS;
    uint32_t hidden = 0;
    for (int i = 0; i < SHB_LIST_BLOCKS; i += WIDE)
        hidden |= vi_bits(depth > vf_load(farthest + i)) << i;
    return ~hidden;
}

/* Appends entries of WIDE cells of a window; the room for all of them is there. Returns how many.
 */
static inline size_t append_entries(const shb_list_unsorted *entries, size_t end, uint32_t number,
                                    vi cells, uint32_t bits, vf begins) {
    vi_append((int32_t *)entries->cells, end, cells, bits);
    vi_append((int32_t *)(void *)entries->begins, end, (vi)begins, bits);
    vi_store((int32_t *)entries->triangles + end, vi_splat((int32_t)number));
    return (size_t)__builtin_popcount(bits);
}

/* Puts a triangle into the cells of the window of four by four from a column and a row on. */
static inline __attribute__((always_inline)) void cover_window(shb_list_cover *cover,
                                                               bool with_sheets, uint32_t column,
                                                               uint32_t row, const list_batch *b,
                                                               int t) {
    const size_t side = SHB_LIST_TILE >> cover->cell_bits, stride = side + SHB_LIST_BLOCK;
    const size_t cell = row * stride + column;
    const float left = (float)(int32_t)(column << cover->cell_bits);
    const float top = (float)(int32_t)(row << cover->cell_bits);
    const float size = (float)(1 << cover->cell_bits);
    const int32_t corner = (int32_t)(row * side + column);
    const list_cells *cells = &b->cells[t];
    const vf last_x = vf_splat((float)(int32_t)(cells->last_column << cover->cell_bits));
    const vf last_y = vf_splat((float)(int32_t)(cells->last_row << cover->cell_bits));
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vf at[2] = {left + size * vf_load(block_x + i), top + size * vf_load(block_y + i)};
        vf weights[3];
        for (int k = 0; k < 3; k++)
            weights[k] = (b->x[k][t] * at[0] + b->y[k][t] * at[1]) + b->best[k][t];
        const vf depth = b->slope_x[t] * at[0] + b->slope_y[t] * at[1];
        const vf begin = vf_max(depth + b->begin[t], vf_splat(b->nearest[t]));
        const vf end = depth + b->end[t];
        const vf before = vf_load_square(cover->far + cell, stride, i);
        const vf most = vf_min(vf_min(weights[0], weights[1]), weights[2]);
        const vm near = vm_and(vm_not_above(at[0], last_x), vm_not_above(at[1], last_y));
        const vm meets = vm_and(near, vm_not_above(vf_splat(0), most));
        const vm enters = vm_and(meets, vm_not_above(begin, before));
        const vf least = vf_min(vf_min(weights[0] + b->worst[0][t], weights[1] + b->worst[1][t]),
                                weights[2] + b->worst[2][t]);
        const vm hides = vm_below(vm_not_above(vf_splat(0), least), end, before);
        const uint32_t bits = vm_bits(enters);
        const uint32_t hiding = vm_bits(hides);
        if (hiding) {
            vf_store_square(cover->far + cell, stride, i, vf_pick(hides, end, before));
            cover->is_nearer = cover->is_hiding = true;
        }
        cover->unsorted.count += append_entries(
            &cover->unsorted, cover->unsorted.count, with_sheets ? (uint32_t)t : b->numbers[t],
            corner + vi_load(cover->lane_cells + i), bits, begin);
    }
}

static inline list_cells cells_of_box(const shb_list_cover *cover, const shb_list_box *box) {
    const int bits = cover->cell_bits;
    return (list_cells){first_cell(box->first_column, cover->column, bits),
                        last_cell(box->last_column, cover->column, bits),
                        first_cell(box->first_row, cover->row, bits),
                        last_cell(box->last_row, cover->row, bits)};
}

/* The blocks in which the windows of a row begin that together hold a triangle's columns. */
static inline uint32_t blocks_of(const list_cells *cells) {
    const uint32_t first = cells->first_column / SHB_LIST_BLOCK;
    const uint32_t last = first + (cells->last_column - cells->first_column) / SHB_LIST_BLOCK;
    return (2u << last) - (1u << first);
}

/* True if all cells of all windows that hold a triangle hide it. */
static inline bool is_hidden(const shb_list_cover *cover, const list_cells *cells, float nearest) {
    uint32_t open = 0;
    for (uint32_t row = cells->first_row; row <= cells->last_row; row += SHB_LIST_BLOCK)
        open |= open_blocks(cover, row / SHB_LIST_BLOCK, nearest);
    return !(open & blocks_of(cells));
}

/* Windows of a row, one bit for the block in which each begins, that the triangle may meet before
 * all their cells hide it. */
static inline uint32_t open_windows(const shb_list_cover *cover, const list_batch *b, int t,
                                    uint32_t row, uint32_t phase) {
    static const SHB_ALIGN float numbers[SHB_LIST_BLOCKS] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                             8, 9, 10, 11, 12, 13, 14, 15};
    const float size = (float)(1 << cover->cell_bits);
    const float top = (float)(int32_t)(row << cover->cell_bits),
                left = (float)(int32_t)phase * size;
    const float *farthest = cover->farthest + (size_t)(row / SHB_LIST_BLOCK) * SHB_LIST_BLOCKS;
    const float slope_x = b->slope_x[t], slope_y = b->slope_y[t];
    const float nearest =
        (slope_y * top + b->begin[t]) + 3 * size * (list_minf(slope_x, 0) + list_minf(slope_y, 0));
    uint32_t open = 0;
    for (int i = 0; i < SHB_LIST_BLOCKS; i += WIDE) {
        const vf x = left + (SHB_LIST_BLOCK * size) * vf_load(numbers + i);
        vf weights[3];
        for (int k = 0; k < 3; k++)
            weights[k] = b->x[k][t] * x + ((b->y[k][t] * top + b->best[k][t]) + 3 * b->more[k][t]);
        const vf most = vf_min(vf_min(weights[0], weights[1]), weights[2]);
        const vm meets = vm_not_above(vf_splat(0), most);
        open |= vm_bits(vm_and(meets, vm_not_above(slope_x * x + nearest, vf_load(farthest + i))))
                << i;
    }
    return open;
}

/* The windows begin at the triangle's first cell, so that most triangles need one. */
static inline __attribute__((always_inline)) void
cover_windows(shb_list_cover *cover, bool with_sheets, const list_batch *b, int t) {
    const list_cells *cells = &b->cells[t];
    const uint32_t blocks = blocks_of(cells), phase = cells->first_column % SHB_LIST_BLOCK;
    for (uint32_t row = cells->first_row; row <= cells->last_row; row += SHB_LIST_BLOCK) {
        uint32_t open = blocks;
        if (blocks & (blocks - 1))
            open &= open_windows(cover, b, t, row, phase);
        for (; open; open &= open - 1) {
            const uint32_t block = (uint32_t)__builtin_ctz(open);
            cover_window(cover, with_sheets, block * SHB_LIST_BLOCK + phase, row, b, t);
        }
    }
}

/* Leaves the triangles of a batch that are small, one bit each: they lie in few cells, and there is
 * no room for one in them. */
static inline uint32_t keep_small(list_batch *b) {
    uint32_t small = 0;
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vi columns = vi_load(b->columns + i), rows = vi_load(b->rows + i);
        const vf worst =
            (vf_load(b->worst[0] + i) + vf_load(b->worst[1] + i)) + vf_load(b->worst[2] + i);
        const vi is_small = (columns < LIST_SMALL) & (rows < LIST_SMALL) & (worst < -2) &
                            (vi_numbers() + i < b->count);
        vi_store(b->columns + i, columns | ~is_small);
        vi_store(b->rows + i, rows | ~is_small);
        small |= vi_bits(is_small) << i;
    }
    return small;
}

/* Puts WIDE triangles from lane i on into the cells at a place in their boxes. */
static inline void cover_cell_of_each(shb_list_cover *cover, const list_batch *b, int column,
                                      int row, int i) {
    const vi inside = (vi_load(b->columns + i) >= column) & (vi_load(b->rows + i) >= row);
    if (!vi_any(inside))
        return;
    const vi columns = (inside & vi_load(b->first_columns + i)) + column;
    const vi rows = (inside & vi_load(b->first_rows + i)) + row;
    const float size = (float)(1 << cover->cell_bits);
    const vf x = size * __builtin_convertvector(columns, vf);
    const vf y = size * __builtin_convertvector(rows, vf);
    vf weights[3];
    for (int k = 0; k < 3; k++)
        weights[k] =
            (vf_load(b->x[k] + i) * x + vf_load(b->y[k] + i) * y) + vf_load(b->best[k] + i);
    const vf depth = vf_load(b->slope_x + i) * x + vf_load(b->slope_y + i) * y;
    const vf begin = vf_max(depth + vf_load(b->begin + i), vf_load(b->nearest + i));
    const vf most = vf_min(vf_min(weights[0], weights[1]), weights[2]);
    const int bits_of_side = SHB_LIST_TILE_BITS - cover->cell_bits;
    const int stride = (1 << bits_of_side) + SHB_LIST_BLOCK;
    vi enters = inside & (most >= 0);
    if (cover->is_hiding)
        enters &= begin <= vf_gather(cover->far, rows * stride + columns);
    const uint32_t bits = vi_bits(enters);
    shb_list_unsorted *entries = &cover->unsorted;
    vi_append((int32_t *)entries->cells, entries->count, (rows << bits_of_side) + columns, bits);
    vi_append((int32_t *)(void *)entries->begins, entries->count, (vi)begin, bits);
    vi_append((int32_t *)entries->triangles, entries->count,
              vi_load((const int32_t *)b->numbers + i), bits);
    entries->count += (size_t)__builtin_popcount(bits);
}

/* Puts the small triangles of a batch into the cells, all of them at the same time. */
static inline void cover_small(shb_list_cover *cover, const list_batch *b) {
    for (int row = 0; row < LIST_SMALL; row++)
        for (int column = 0; column < LIST_SMALL; column++)
            for (int i = 0; i < LIST_LANES; i += WIDE)
                cover_cell_of_each(cover, b, column, row, i);
}

/* Puts a batch into the cells. False: no room for all the entries. */
static inline __attribute__((always_inline)) bool cover_batch(shb_list_cover *cover,
                                                              bool with_sheets, list_batch *b) {
    const size_t blocks = SHB_LIST_BLOCKS >> cover->cell_bits;
    const size_t room = (blocks * blocks + 1) * LIST_LANES; /* for one triangle */
    const size_t room_for_small = (size_t)b->count * LIST_SMALL * LIST_SMALL + LIST_LANES;
    if (b->count == 0)
        return true;
    const size_t begin = cover->unsorted.count;
    put_functions(cover, with_sheets, b);
    uint32_t others = (1u << b->count) - 1;
    if (!with_sheets) {
        if (cover->unsorted.capacity - cover->unsorted.count < room_for_small)
            return false;
        others &= ~keep_small(b);
        cover_small(cover, b);
    }
    for (; others; others &= others - 1) {
        const int t = __builtin_ctz(others);
        if (cover->unsorted.capacity - cover->unsorted.count < room)
            return false;
        cover_windows(cover, with_sheets, b, t);
    }
    if (with_sheets)
        add_to_sheets(cover, b, begin);
    b->count = 0;
    return true;
}

/* The largest of each four rows and columns from a place on. */
static inline void find_farthest_of_row(const float *far, size_t stride, size_t blocks,
                                        float out[SHB_LIST_BLOCKS + 1]) {
    float most[SHB_LIST_TILE];
    for (size_t i = 0; i < blocks * SHB_LIST_BLOCK; i++)
        most[i] = list_maxf(list_maxf(far[i], far[i + stride]),
                            list_maxf(far[i + 2 * stride], far[i + 3 * stride]));
    for (size_t i = 0; i < blocks; i++)
        out[i] = list_maxf(list_maxf(most[4 * i], most[4 * i + 1]),
                           list_maxf(most[4 * i + 2], most[4 * i + 3]));
    for (size_t i = blocks; i <= SHB_LIST_BLOCKS; i++)
        out[i] = -HUGE_VALF;
}

/* Finds how far the cells of windows that begin in each block let triangles be seen. */
static void find_farthest(shb_list_cover *cover) {
    const size_t blocks = SHB_LIST_BLOCKS >> cover->cell_bits;
    const size_t stride = blocks * SHB_LIST_BLOCK + SHB_LIST_BLOCK;
    float rows[2][SHB_LIST_BLOCKS + 1];
    for (size_t i = 0; i <= SHB_LIST_BLOCKS; i++)
        rows[blocks & 1][i] = -HUGE_VALF;
    for (size_t row = blocks; row-- > 0;) {
        float *here = rows[row & 1];
        const float *below = rows[~row & 1];
        float *farthest = cover->farthest + row * SHB_LIST_BLOCKS;
        find_farthest_of_row(cover->far + row * SHB_LIST_BLOCK * stride, stride, blocks, here);
        for (size_t i = 0; i < SHB_LIST_BLOCKS; i++)
            farthest[i] =
                list_maxf(list_maxf(here[i], here[i + 1]), list_maxf(below[i], below[i + 1]));
    }
}

/* LIST_AHEAD: triangles that are fetched before they are used; LIST_SPELL: triangles after which
 * blocks are looked at anew, and the rest is left if all of them hide it. */
enum { LIST_AHEAD = 32, LIST_SPELL = 64 };

static inline void fetch_covered(const shb_list_cover *cover, uint32_t number) {
    __builtin_prefetch(&cover->triangles[number]);
    __builtin_prefetch(&cover->boxes[number]);
    if (cover->with_sheets)
        __builtin_prefetch(&cover->outlines[number]);
}

/* Nothing enters the rim of cells that windows reach beyond the tile. */
static void empty_cells(shb_list_cover *cover) {
    const size_t side = SHB_LIST_TILE >> cover->cell_bits, stride = side + SHB_LIST_BLOCK;
    cover->unsorted.count = 0;
    cover->is_nearer = cover->is_hiding = false;
    for (int i = 0; i < LIST_LANES; i++)
        cover->lane_cells[i] = i / 4 * (int32_t)side + i % 4;
    for (size_t row = 0; row < stride; row++)
        for (size_t i = 0; i < stride; i++)
            cover->far[row * stride + i] = row < side && i < side ? HUGE_VALF : -HUGE_VALF;
    for (size_t i = 0; i < SHB_LIST_BLOCKS * SHB_LIST_BLOCKS; i++)
        cover->farthest[i] = HUGE_VALF;
    if (cover->with_sheets)
        empty_sheets(&cover->sheets);
}

/* Entries from the order of triangles to that of cells. */
static void sort_entries(shb_list_cover *cover) {
    const size_t side = SHB_LIST_TILE >> cover->cell_bits, stride = side + SHB_LIST_BLOCK;
    const shb_list_unsorted *made = &cover->unsorted;
    uint32_t next[SHB_LIST_TILE * SHB_LIST_TILE], sum = 0;
    memset(next, 0, side * side * sizeof *next);
    for (size_t i = 0; i < made->count; i++)
        next[made->cells[i]]++;
    for (size_t row = 0; row < side; row++)
        for (size_t i = row * side; i < (row + 1) * side; i++) {
            const uint32_t count = next[i];
            next[i] = sum;
            cover->cells[i] = (shb_list_cell){sum, cover->far[row * stride + i - row * side]};
            sum += count;
        }
    cover->cells[side * side] = (shb_list_cell){.start = sum};
    for (size_t i = 0; i < made->count; i++)
        cover->entries[next[made->cells[i]]++] =
            (shb_list_entry){made->triangles[i], made->begins[i]};
}

static inline __attribute__((always_inline)) bool cover_by(shb_list_cover *cover,
                                                           bool with_sheets) {
    const uint32_t last = (uint32_t)(SHB_LIST_TILE >> cover->cell_bits) - 1;
    const list_cells tile = {0, last, 0, last};
    list_batch batch;
    bool hides = false;
    batch.count = 0;
    empty_cells(cover);
    for (size_t k = 0; k < cover->count; k++) {
        if (k + LIST_AHEAD < cover->count)
            fetch_covered(cover, (uint32_t)cover->keys[k + LIST_AHEAD]);
        const uint32_t number = (uint32_t)cover->keys[k];
        const float nearest =
            (float)shb_list_level_depth(cover->frame, (double)(cover->keys[k] >> 32));
        if (k % LIST_SPELL == LIST_SPELL - 1) {
            if (with_sheets)
                find_far_cells(cover);
            if (cover->is_nearer) {
                find_farthest(cover);
                cover->is_nearer = false;
                hides = true;
            }
            if (hides && is_hidden(cover, &tile, nearest))
                break;
        }
        const list_cells cells = cells_of_box(cover, &cover->boxes[number]);
        if (hides && is_hidden(cover, &cells, nearest))
            continue;
        batch.numbers[batch.count] = number;
        batch.nearest[batch.count] = nearest;
        batch.first_columns[batch.count] = (int32_t)cells.first_column;
        batch.first_rows[batch.count] = (int32_t)cells.first_row;
        batch.columns[batch.count] = (int32_t)(cells.last_column - cells.first_column);
        batch.rows[batch.count] = (int32_t)(cells.last_row - cells.first_row);
        batch.cells[batch.count++] = cells;
        if (batch.count == LIST_LANES && !cover_batch(cover, with_sheets, &batch))
            return false;
    }
    if (!cover_batch(cover, with_sheets, &batch))
        return false;
    if (with_sheets)
        find_far_cells(cover);
    sort_entries(cover);
    if (with_sheets)
        put_bounds(cover);
    return true;
}

static bool cover_cells(shb_list_cover *cover) {
    return cover->with_sheets ? cover_by(cover, true) : cover_by(cover, false);
}
