/* The loops of finding the sheets of a tile's texels while its triangles go into cells.
 *
 * Triangles come front to back, and those that a texel has met so far are its sheet. Of these it
 * keeps a sum of 64 bits: every triangle adds the name of each of its edges that may meet the
 * texel, with the sign of the side on which it lies, and a number of its own kind if it covers the
 * texel's sample. So two triangles on either side of an edge take each other's share away, and a
 * sum that is that of one sample says, but for names that happen to add up, once in 2^64: where a
 * way from the sample to any other ray of the texel passes an edge, as many triangles begin there
 * as end, and the sheet covers all of the texel exactly once. That is (b) and (c) of sheets.h,
 * without knowing which triangles are neighbours. (Edges are told apart by the places of their
 * vertices in the world, so a mesh need not share them; one that is only nearly met stays open.)
 *
 * What lies behind such a sheet is hidden, so all of the texel is in shadow behind its end, and all
 * of a cell behind the farthest end in it, which cuts the lists of closed meshes by half. Whatever
 * begins before that went into the texel, too: it did, or it began behind an end that was no
 * nearer. If the sum is still that of one sample when all triangles are in, and they all end before
 * it, they are the front of sheets.h and the texel is whole. A triangle that ends before all of a
 * closed sheet begins a new one, behind which that lies.
 *
 * All of it holds for texels that are larger by the frame's rim. A sample that an edge passes too
 * closely, and triangles whose outline is not known, leave a number that nothing takes away.
 *
 * Texels are looked at by blocks of four by four, which lie in memory one after the other. */

/* Corners of a block's texels, from its own; and their numbers, from 1 on, in each byte. */
static const SHB_ALIGN float block_x[LIST_LANES] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
static const SHB_ALIGN float block_y[LIST_LANES] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
#define FOUR_TIMES(a, b, c, d) (a) * 0x01010101, (b)*0x01010101, (c)*0x01010101, (d)*0x01010101
static const SHB_ALIGN int32_t block_columns[LIST_LANES] = {
    FOUR_TIMES(1, 2, 3, 4), FOUR_TIMES(1, 2, 3, 4), FOUR_TIMES(1, 2, 3, 4), FOUR_TIMES(1, 2, 3, 4)};
static const SHB_ALIGN int32_t block_rows[LIST_LANES] = {
    FOUR_TIMES(1, 1, 1, 1), FOUR_TIMES(2, 2, 2, 2), FOUR_TIMES(3, 3, 3, 3), FOUR_TIMES(4, 4, 4, 4)};
#undef FOUR_TIMES

#define BEYOND 0x80u

/* BEYOND in each byte: it is less than the first or more than the last. All are below 128. */
static inline vi bytes_beyond(vi bytes, int32_t first, int32_t last) {
    typedef int8_t list_bytes __attribute__((vector_size(4 * WIDE)));
    return (vi)((list_bytes)bytes - (list_bytes)vi_splat(first)) |
           (vi)((list_bytes)vi_splat(last) - (list_bytes)bytes);
}

/* Texels whose sums are those of one sheet. */
static inline vm closed_texels(vm texels, vi sum_0, vi sum_1) {
    const vm first = vm_equal(texels, sum_0, vi_splat((int32_t)SHB_LIST_SHEET_0));
    return vm_equal(first, sum_1, vi_splat((int32_t)SHB_LIST_SHEET_1));
}

/* Adds a triangle to the sheets of those texels of a block that it enters. A closed sheet makes
 * room for a triangle that ends before all of it. True if some texels may hide more now. */
static inline bool add_to_block(const list_batch *b, uint32_t t, uint32_t column, uint32_t row,
                                shb_list_block *block) {
    const float left = (float)(int32_t)(4 * column), top = (float)(int32_t)(4 * row);
    uint32_t hiding = 0;
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vf x = left + vf_load(block_x + i), y = top + vf_load(block_y + i);
        const vi columns = (int32_t)(column * 0x04040404) + vi_load(block_columns + i);
        const vi rows = (int32_t)(row * 0x04040404) + vi_load(block_rows + i);
        const vi beyond = bytes_beyond(columns, b->first_column[t], b->last_column[t]) |
                          bytes_beyond(rows, b->first_row[t], b->last_row[t]);
        vf weights[3];
        for (int k = 0; k < 3; k++)
            weights[k] = (b->x[k][t] * x + b->y[k][t] * y) + b->met[k][t];
        const vf depth = b->slope_x[t] * x + b->slope_y[t] * y;
        const vf begin = vf_max(depth + b->texel_begin[t], vf_splat(b->nearest[t]));
        const vf end = depth + b->texel_end[t];
        const vf before = vf_load(block->far + i);
        const vf most = vf_min(vf_min(weights[0], weights[1]), weights[2]);
        const vm near = vm_and(vm_not_above(vf_splat(0), most), vm_not_above(begin, before));
        const vm enters = vm_clear(near, beyond, BEYOND << 24);

        const vf sample = vf_min(vf_min(weights[0] + b->sample[0][t], weights[1] + b->sample[1][t]),
                                 weights[2] + b->sample[2][t]);
        const vm covers = vm_not_above(vf_splat(0), sample);
        const vm doubtful = vm_below(covers, sample, vf_splat(b->sure[t]));
        vi added_0 = vm_keep(covers, vi_splat(b->covers[0][t]));
        vi added_1 = vm_keep(covers, vi_splat(b->covers[1][t]));
        added_1 = vm_add(doubtful, added_1, vi_splat((int32_t)SHB_LIST_UNKNOWN_1));
        vm hides = vm_below(enters, end, before);
        for (int k = 0; k < 3; k++) {
            const vm passed = vm_less(weights[k], vf_splat(b->passed[k][t]));
            const vm meets = vm_clear(passed, beyond, BEYOND << 8 * k);
            added_0 = vm_add(meets, added_0, vi_splat(b->edges[k][0][t]));
            added_1 = vm_add(meets, added_1, vi_splat(b->edges[k][1][t]));
            hides = vm_without(hides, passed);
        }

        vi sum_0 = vi_load(block->sums[0] + i), sum_1 = vi_load(block->sums[1] + i);
        vf first = vf_load(block->begins + i), last = vf_load(block->ends + i);
        const vm renews = vm_below(closed_texels(enters, sum_0, sum_1), end, first);
        if (vm_bits(renews)) {
            vf_store(block->behind + i, vf_pick(renews, first, vf_load(block->behind + i)));
            first = vf_pick(renews, vf_splat(HUGE_VALF), first);
            last = vf_pick(renews, vf_splat(-HUGE_VALF), last);
            sum_0 = vi_pick(renews, vi_splat(0), sum_0);
            sum_1 = vi_pick(renews, vi_splat(0), sum_1);
        }
        sum_0 = vm_add(enters, sum_0, added_0);
        sum_1 = vm_add(enters, sum_1, added_1);
        first = vf_pick(enters, vf_min(first, begin), first);
        last = vf_pick(enters, vf_max(last, end), last);
        vi_store(block->sums[0] + i, sum_0);
        vi_store(block->sums[1] + i, sum_1);
        vf_store(block->begins + i, first);
        vf_store(block->ends + i, last);

        const vm closed = closed_texels(enters, sum_0, sum_1);
        const vf far = vf_pick(hides, end, before);
        vf_store(block->far + i, vf_pick(closed, vf_min(last, far), far));
        hiding |= vm_bits(closed) | vm_bits(hides);
    }
    return hiding != 0;
}

/* Blocks of a cell's side. */
static inline uint32_t blocks_of_cell(const shb_list_cover *cover) {
    return 1u << (cover->cell_bits - SHB_LIST_BLOCK_BITS);
}

/* Adds triangles of a batch to the sheets of the cells that have these entries, in which triangles
 * are numbers in the batch until then. A cell has side by side blocks. */
static inline __attribute__((always_inline)) void
add_entries(shb_list_cover *cover, const list_batch *b, size_t begin, uint32_t side) {
    const shb_list_unsorted *entries = &cover->unsorted;
    const uint32_t columns = SHB_LIST_BLOCKS / side;
    shb_list_sheets *sheets = &cover->sheets;
    for (size_t i = begin; i < entries->count; i++) {
        const uint32_t cell = entries->cells[i], t = entries->triangles[i];
        const uint32_t column = cell % columns * side, row = cell / columns * side;
        bool is_nearer = false;
        for (uint32_t y = row; y < row + side; y++)
            for (uint32_t x = column; x < column + side; x++)
                is_nearer |= add_to_block(b, t, x, y, &sheets->blocks[y * SHB_LIST_BLOCKS + x]);
        sheets->is_nearer[cell] |= is_nearer;
        entries->triangles[i] = b->numbers[t];
    }
}

/* Nearly all cells are single blocks. */
static inline void add_to_sheets(shb_list_cover *cover, const list_batch *b, size_t begin) {
    const uint32_t side = blocks_of_cell(cover);
    if (side == 1)
        add_entries(cover, b, begin, 1);
    else
        add_entries(cover, b, begin, side);
}

static inline float farthest_of_cell(const shb_list_cover *cover, uint32_t column, uint32_t row) {
    const uint32_t side = blocks_of_cell(cover);
    vf most = vf_splat(-HUGE_VALF);
    for (uint32_t y = row * side; y < (row + 1) * side; y++)
        for (uint32_t x = column * side; x < (column + 1) * side; x++)
            for (int i = 0; i < LIST_LANES; i += WIDE)
                most = vf_max(most, vf_load(cover->sheets.blocks[y * SHB_LIST_BLOCKS + x].far + i));
    return -vf_least(-most);
}

/* Cells hide what all of their texels do. */
static void find_far_cells(shb_list_cover *cover) {
    const uint32_t columns = SHB_LIST_BLOCKS / blocks_of_cell(cover);
    bool *is_nearer = cover->sheets.is_nearer;
    for (uint32_t cell = 0; cell < columns * columns; cell++) {
        if (!is_nearer[cell])
            continue;
        const uint32_t column = cell % columns, row = cell / columns;
        float *far = &cover->far[row * (columns + SHB_LIST_BLOCK) + column];
        *far = float_min(*far, farthest_of_cell(cover, column, row));
        is_nearer[cell] = false;
        cover->is_nearer = true;
    }
}

static void empty_sheets(shb_list_sheets *sheets) {
    memset(sheets->is_nearer, 0, sizeof sheets->is_nearer);
    for (size_t n = 0; n < SHB_LIST_BLOCKS * SHB_LIST_BLOCKS; n++) {
        shb_list_block *block = &sheets->blocks[n];
        memset(block->sums, 0, sizeof block->sums);
        for (int i = 0; i < LIST_LANES; i++) {
            block->far[i] = HUGE_VALF;
            block->begins[i] = HUGE_VALF;
            block->ends[i] = -HUGE_VALF;
            block->behind[i] = HUGE_VALF;
        }
    }
}

/* What sheets.h says of the texels. */
static void put_bounds(shb_list_cover *cover) {
    for (size_t n = 0; n < SHB_LIST_BLOCKS * SHB_LIST_BLOCKS; n++) {
        const shb_list_block *restrict block = &cover->sheets.blocks[n];
        float *bounds = cover->bounds + n / SHB_LIST_BLOCKS * SHB_LIST_BLOCK * SHB_LIST_TILE +
                        n % SHB_LIST_BLOCKS * SHB_LIST_BLOCK;
        SHB_ALIGN uint32_t bits[LIST_LANES];
        memcpy(bits, block->far, sizeof bits);
        for (int i = 0; i < LIST_LANES; i++) {
            const int is_whole = (block->sums[0][i] == (int32_t)SHB_LIST_SHEET_0) &
                                 (block->sums[1][i] == (int32_t)SHB_LIST_SHEET_1) &
                                 (block->ends[i] <= block->far[i]) &
                                 (block->far[i] < block->behind[i]);
            bits[i] = (bits[i] & ~1u) | (uint32_t)is_whole;
        }
        for (size_t row = 0; row < SHB_LIST_BLOCK; row++)
            memcpy(bounds + row * SHB_LIST_TILE, bits + row * SHB_LIST_BLOCK,
                   SHB_LIST_BLOCK * sizeof *bits);
    }
}
