/* The loops of putting a tile's triangles into its cells. */

/* The most rows and columns of cells that a small triangle lies in. */
enum { LIST_SMALL = 3 };

/* Where a triangle lies in a tile, in cells. */
typedef struct list_cells {
    uint32_t first_column, last_column, first_row, last_row;
} list_cells;

static inline list_cells cells_between(int32_t first_column, int32_t first_row, int32_t columns,
                                       int32_t rows) {
    const uint32_t column = (uint32_t)first_column, row = (uint32_t)first_row;
    return (list_cells){column, column + (uint32_t)columns, row, row + (uint32_t)rows};
}

#include "k_list_batch.inl"
#include "k_list_sheet.inl"

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
                                                               int t, const list_cells *cells) {
    const size_t side = SHB_LIST_TILE >> cover->cell_bits, stride = side + SHB_LIST_BLOCK;
    const size_t cell = row * stride + column;
    const float left = (float)(int32_t)(column << cover->cell_bits);
    const float top = (float)(int32_t)(row << cover->cell_bits);
    const float size = (float)(1 << cover->cell_bits);
    const int32_t corner = (int32_t)(row * side + column);
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
        (slope_y * top + b->begin[t]) + 3 * size * (float_min(slope_x, 0) + float_min(slope_y, 0));
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
    const list_cells cells =
        cells_between(b->first_columns[t], b->first_rows[t], b->columns[t], b->rows[t]);
    const uint32_t blocks = blocks_of(&cells), phase = cells.first_column % SHB_LIST_BLOCK;
    for (uint32_t row = cells.first_row; row <= cells.last_row; row += SHB_LIST_BLOCK) {
        uint32_t open = blocks;
        if (blocks & (blocks - 1))
            open &= open_windows(cover, b, t, row, phase);
        for (; open; open &= open - 1) {
            const uint32_t block = (uint32_t)__builtin_ctz(open);
            cover_window(cover, with_sheets, block * SHB_LIST_BLOCK + phase, row, b, t, &cells);
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
        vi_store(b->small_columns + i, columns | ~is_small);
        small |= vi_bits(is_small) << i;
    }
    return small;
}

/* Puts WIDE triangles from lane i on into the cells at a place in their boxes. */
static inline void cover_cell_of_each(shb_list_cover *cover, const list_batch *b, int column,
                                      int row, int i) {
    const vi inside = (vi_load(b->small_columns + i) >= column) & (vi_load(b->rows + i) >= row);
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
    return true;
}

/* The largest of each four rows and columns from a place on. */
static inline void find_farthest_of_row(const float *far, size_t stride, size_t blocks,
                                        float out[SHB_LIST_BLOCKS + 1]) {
    float most[SHB_LIST_TILE];
    for (size_t i = 0; i < blocks * SHB_LIST_BLOCK; i++)
        most[i] = float_max(float_max(far[i], far[i + stride]),
                            float_max(far[i + 2 * stride], far[i + 3 * stride]));
    for (size_t i = 0; i < blocks; i++)
        out[i] = float_max(float_max(most[4 * i], most[4 * i + 1]),
                           float_max(most[4 * i + 2], most[4 * i + 3]));
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
                float_max(float_max(here[i], here[i + 1]), float_max(below[i], below[i + 1]));
    }
}

#include "k_list_waiting.inl"

/* Puts triangles that wait into the cells, LIST_LANES at a time, as long as there are so many or
 * more. False: no room for all the entries. */
static inline __attribute__((always_inline)) bool
cover_waiting(shb_list_cover *cover, bool with_sheets, size_t least, list_waiting *waiting) {
    size_t first = 0, left = waiting->count;
    while (left >= least) {
        list_batch batch;
        batch.count = left < LIST_LANES ? (int)left : LIST_LANES;
        batch.numbers = waiting->numbers + first;
        batch.first_columns = waiting->first_columns + first;
        batch.first_rows = waiting->first_rows + first;
        batch.columns = waiting->columns + first;
        batch.rows = waiting->rows + first;
        batch.nearest = waiting->nearest + first;
        if (!cover_batch(cover, with_sheets, &batch))
            return false;
        first += (size_t)batch.count;
        left -= (size_t)batch.count;
    }
    drop_waiting(waiting, first);
    return true;
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
    list_waiting waiting;
    bool hides = false;
    waiting.count = 0;
    empty_cells(cover);
    for (size_t k = 0; k < cover->count; k += LIST_SPELL) {
        if (with_sheets && k)
            find_far_cells(cover);
        if (cover->is_nearer) {
            find_farthest(cover);
            cover->is_nearer = false;
            hides = true;
        }
        const double level = (double)(cover->keys[k] >> 32);
        if (hides && is_hidden(cover, &tile, (float)shb_list_level_depth(cover->frame, level)))
            break;
        const size_t first = waiting.count;
        for (size_t i = k; i < k + LIST_SPELL && i < cover->count; i += LIST_LANES)
            wait_for(cover, hides, i, &waiting);
        fetch_waiting(cover, &waiting, first);
        fetch_boxes(cover, k + LIST_SPELL);
        if (!cover_waiting(cover, with_sheets, LIST_LANES, &waiting))
            return false;
    }
    if (!cover_waiting(cover, with_sheets, 1, &waiting))
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
