/* The loops of putting a tile's triangles into its cells.
 *
 * Sheets. Triangles go into a cell front to back, and those that went into it so far are its sheet.
 * Of these a cell keeps a sum of 64 bits: every triangle adds the name of each of its edges that
 * may meet the cell, with the sign of the side on which it lies, and a number of its own kind if it
 * covers the cell's sample. So two triangles on either side of an edge take each other's share
 * away, and a sum that is that of one sample says, but for names that happen to add up, once in
 * 2^64: where a way from the sample to any other ray of the cell passes an edge, as many triangles
 * begin there as end, and the sheet covers all of the cell exactly once. That is (b) and (c) of
 * sheets.h, without knowing which triangles are neighbours. (Edges are told apart by the places of
 * their vertices in the world, so a mesh need not share them; one that is only nearly met stays
 * open.)
 *
 * What lies behind such a sheet is hidden, so all of the cell is in shadow behind its end, which
 * cuts the lists of closed meshes by half. Whatever begins before that went into the cell, too: it
 * did, or it began behind an end that was no nearer. If the sum is still that of one sample when
 * all triangles are in, and they all end before it, they are the front of sheets.h and the cell is
 * whole. A triangle that ends before all of a closed sheet begins a new one, behind which that
 * lies.
 *
 * All of it holds for cells that are larger by LIST_RIM. A sample that an edge passes too closely,
 * and triangles whose outline is not known, leave a number that nothing takes away. */

#include "lane_masks.h"

/* Cells are taken as larger by a rim, in texels: what rounding to floats may move a point by, and
 * corners. */
#define LIST_RIM ((float)(SHB_LIST_POINT_MARGIN + 2 * LIST_CORNER))

/* Where triangles are counted, in a cell's size from its corner: where no edge passes by because a
 * mesh and the map are aligned. */
#define LIST_SAMPLE_X 0x1.1p-1f
#define LIST_SAMPLE_Y 0x1.bp-2f

/* Four floats: an element for each weight, or for the edge where it is 0. */
typedef float list_f4 __attribute__((vector_size(16)));
typedef int32_t list_i4 __attribute__((vector_size(16)));

static inline list_f4 f4_load(const float *p) {
    list_f4 v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline list_f4 f4_abs(list_f4 v) {
    return (list_f4)((list_i4)v & 0x7fffffff);
}

static inline list_f4 f4_positive(list_f4 v) {
    return (list_f4)((list_i4)v & (v > 0));
}

/* Linear functions over a tile, from its corner: the weights at the best corner of a cell, which
 * are negative where the triangle misses the cell for sure; what their worst corner has less, and
 * what the cell's sample has; the boxes of edges, by the corners of cells that meet them; and
 * depths at which the triangle begins and ends in a cell. */
typedef struct cell_functions {
    list_f4 x, y, best, worst, sample;
    list_f4 middle_x, middle_y, reach_x, reach_y;
    float slope_x, slope_y, begin, end;
    float nearest, sure;            /* the least weights at a sample that is covered for sure */
    int32_t edges[3][2], covers[2]; /* what they add to the sums */
} cell_functions;

static inline void put_edge_boxes(const shb_list_outline *outline, float column, float row,
                                  float size, cell_functions *f) {
    const list_f4 x = f4_load(outline->x) - column, y = f4_load(outline->y) - row;
    const list_f4 x_0 = __builtin_shufflevector(x, x, 1, 2, 0, 3);
    const list_f4 x_1 = __builtin_shufflevector(x, x, 2, 0, 1, 3);
    const list_f4 y_0 = __builtin_shufflevector(y, y, 1, 2, 0, 3);
    const list_f4 y_1 = __builtin_shufflevector(y, y, 2, 0, 1, 3);
    const float around = 0.5f * size + LIST_RIM + 0x1p-21f * (column + row);
    const list_f4 width = f4_abs(x_1 - x_0), height = f4_abs(y_1 - y_0);
    const list_f4 middle_x = 0.5f * (x_0 + x_1), middle_y = 0.5f * (y_0 + y_1);
    f->middle_x = middle_x - 0.5f * size;
    f->middle_y = middle_y - 0.5f * size;
    f->reach_x = (0.5f * width + around) + 0x1p-20f * (width + f4_abs(middle_x));
    f->reach_y = (0.5f * height + around) + 0x1p-20f * (height + f4_abs(middle_y));
    memcpy(f->edges, outline->edges, sizeof f->edges);
    f->covers[0] = (int32_t)SHB_LIST_SHEET_0;
    f->covers[1] = (int32_t)SHB_LIST_SHEET_1;
    if (outline->is_known)
        return;
    memset(f->edges, 0, sizeof f->edges);
    f->covers[0] = 0;
    f->covers[1] = (int32_t)SHB_LIST_UNKNOWN_1;
    f->sample = f->sample * 0 + HUGE_VALF;
}

static inline void put_cell_functions(const shb_list_cover *cover, bool with_sheets,
                                      uint32_t number, float nearest, cell_functions *f) {
    const shb_list_triangle *t = &cover->triangles[number];
    const float column = (float)cover->column, row = (float)cover->row;
    const float size = (float)(1 << cover->cell_bits), rim = with_sheets ? LIST_RIM : 0;
    f->x = (list_f4){-(t->u[0] + t->v[0]), t->u[0], t->v[0], 0};
    f->y = (list_f4){-(t->u[1] + t->v[1]), t->u[1], t->v[1], 0};
    const list_f4 first = {(t->rest - t->u[2]) - t->v[2], t->u[2], t->v[2], 0};
    const list_f4 one = ((f->x * column + f->y * row) + first) + t->margin;
    const list_f4 sizes = f4_abs(f->x) + f4_abs(f->y),
                  across = f4_positive(f->x) + f4_positive(f->y);
    f->best = one + (size * across + rim * sizes);
    f->worst = -(size + 2 * rim) * sizes - 4 * t->margin;
    f->sample = size * ((LIST_SAMPLE_X * f->x + LIST_SAMPLE_Y * f->y) - across) - rim * sizes;
    f->sure = 4 * t->margin;
    if (with_sheets)
        put_edge_boxes(&cover->outlines[number], column, row, size, f);
    const double depth = -shb_list_behind(t, (double)cover->column, (double)cover->row, 0);
    const float z = (float)depth, x = (float)-t->plane[0], y = (float)-t->plane[1];
    const float steep = fabsf(x) + fabsf(y);
    const float rounding = 0x1p-20f * (fabsf(z) + SHB_LIST_TILE * steep) + rim * steep;
    f->slope_x = x;
    f->slope_y = y;
    f->begin = z + size * (list_minf(x, 0) + list_minf(y, 0)) - rounding - t->clear;
    f->end = z + size * (list_maxf(x, 0) + list_maxf(y, 0)) + rounding + t->clear;
    f->nearest = nearest;
}

static inline uint32_t first_block(uint32_t texel, uint32_t tile, int bits) {
    return (texel > tile ? texel - tile : 0) >> bits;
}

static inline uint32_t last_block(uint32_t texel, uint32_t tile, int bits) {
    const uint32_t last = texel - tile;
    return (last < SHB_LIST_TILE ? last : SHB_LIST_TILE - 1) >> bits;
}

/* Blocks of a row that have cells which do not hide a depth, one bit each. */
static inline uint32_t open_blocks(const shb_list_cover *cover, uint32_t row, float depth) {
    const float *farthest = cover->farthest + (size_t)row * SHB_LIST_BLOCKS;
    uint32_t hidden = 0;
    for (int i = 0; i < SHB_LIST_BLOCKS; i += WIDE)
        hidden |= vi_bits(depth > vf_load(farthest + i)) << i;
    return ~hidden;
}

static inline float largest_of_block(const float *values) {
#if WIDE == 16
    return _mm512_reduce_max_ps(_mm512_loadu_ps(values));
#else
    vf most = vf_load(values);
    for (int i = WIDE; i < LIST_LANES; i += WIDE)
        most = vf_max(most, vf_load(values + i));
    float largest = most[0];
    for (int i = 1; i < WIDE; i++)
        largest = list_maxf(largest, most[i]);
    return largest;
#endif
}

/* Cells of those of a mask that an edge may meet: its line does, and its box. */
static inline vm meets_edge(const cell_functions *f, int k, vm cells, vf x, vf y, vf worst) {
    const vf off_x = vf_abs(x - f->middle_x[k]) - f->reach_x[k];
    const vf off_y = vf_abs(y - f->middle_y[k]) - f->reach_y[k];
    return vm_below(cells, vf_max(vf_max(off_x, off_y), worst), vf_splat(0));
}

/* Cells whose sums are those of one sheet. */
static inline vm closed_cells(vm cells, vi sum_0, vi sum_1) {
    const vm first = vm_equal(cells, sum_0, vi_splat((int32_t)SHB_LIST_SHEET_0));
    return vm_equal(first, sum_1, vi_splat((int32_t)SHB_LIST_SHEET_1));
}

/* Adds a triangle to the sheets of the cells that it enters. Returns the cells that are closed, and
 * where their sheets end. A closed sheet makes room for a triangle that ends before all of it. */
static inline vm add_to_sheets(const cell_functions *f, vm enters, const vf at[2],
                               const vf weights[3], vf begin, vf end, shb_list_sheets *sheets,
                               int i, vf *sheet_end) {
    vi sum_0 = vi_load(sheets->sums[0] + i), sum_1 = vi_load(sheets->sums[1] + i);
    vf last = vf_load(sheets->ends + i), first = vf_load(sheets->begins + i);
    const vm renews = vm_below(closed_cells(enters, sum_0, sum_1), end, first);
    if (vm_bits(renews)) {
        vf_store(sheets->behind + i, vf_pick(renews, first, vf_load(sheets->behind + i)));
        first = vf_pick(renews, vf_splat(HUGE_VALF), first);
        last = vf_pick(renews, vf_splat(-HUGE_VALF), last);
        sum_0 = vi_pick(renews, vi_splat(0), sum_0);
        sum_1 = vi_pick(renews, vi_splat(0), sum_1);
    }
    const vf sample = vf_min(vf_min(weights[0] + f->sample[0], weights[1] + f->sample[1]),
                             weights[2] + f->sample[2]);
    const vm covers = vm_and(enters, vm_not_above(vf_splat(0), sample));
    sum_0 = vm_add(covers, sum_0, vi_splat(f->covers[0]));
    sum_1 = vm_add(covers, sum_1, vi_splat(f->covers[1]));
    const vm doubtful = vm_below(covers, sample, vf_splat(f->sure));
    if (vm_bits(doubtful))
        sum_1 = vm_add(doubtful, sum_1, vi_splat((int32_t)SHB_LIST_UNKNOWN_1));
    for (int k = 0; k < 3; k++) {
        const vm meets = meets_edge(f, k, enters, at[0], at[1], weights[k] + f->worst[k]);
        sum_0 = vm_add(meets, sum_0, vi_splat(f->edges[k][0]));
        sum_1 = vm_add(meets, sum_1, vi_splat(f->edges[k][1]));
    }
    last = vf_pick(enters, vf_max(last, end), last);
    first = vf_pick(enters, vf_min(first, begin), first);
    vi_store(sheets->sums[0] + i, sum_0);
    vi_store(sheets->sums[1] + i, sum_1);
    vf_store(sheets->ends + i, last);
    vf_store(sheets->begins + i, first);
    *sheet_end = last;
    return closed_cells(enters, sum_0, sum_1);
}

/* The cells of a block that a triangle goes into, one bit each, and the least depth of the triangle
 * in each. */
static inline uint32_t cover_block(const shb_list_cover *cover, bool with_sheets,
                                   const cell_functions *f, uint32_t column, uint32_t row,
                                   shb_list_block *block, shb_list_sheets *sheets,
                                   float begins[LIST_LANES]) {
    static const SHB_ALIGN float lane_x[LIST_LANES] = {0, 1, 2, 3, 0, 1, 2, 3,
                                                       0, 1, 2, 3, 0, 1, 2, 3};
    static const SHB_ALIGN float lane_y[LIST_LANES] = {0, 0, 0, 0, 1, 1, 1, 1,
                                                       2, 2, 2, 2, 3, 3, 3, 3};
    const float left = (float)(int32_t)(column << (cover->cell_bits + 2));
    const float top = (float)(int32_t)(row << (cover->cell_bits + 2));
    const float size = (float)(1 << cover->cell_bits);
    uint32_t bits = 0;
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vf at[2] = {left + size * vf_load(lane_x + i), top + size * vf_load(lane_y + i)};
        vf weights[3];
        for (int k = 0; k < 3; k++)
            weights[k] = (f->x[k] * at[0] + f->y[k] * at[1]) + f->best[k];
        const vf depth = f->slope_x * at[0] + f->slope_y * at[1];
        const vf begin = vf_max(depth + f->begin, vf_splat(f->nearest)), end = depth + f->end;
        const vf before = vf_load(block->far + i);
        const vf most = vf_min(vf_min(weights[0], weights[1]), weights[2]);
        const vm enters = vm_and(vm_not_above(vf_splat(0), most), vm_not_above(begin, before));
        const vf least = vf_min(vf_min(weights[0] + f->worst[0], weights[1] + f->worst[1]),
                                weights[2] + f->worst[2]);
        const vm hides = vm_below(vm_not_above(vf_splat(0), least), end, before);
        vf far = vf_pick(hides, end, before), sheet_end;
        vf_store(begins + i, begin);
        vi_store(block->counts + i, vm_add(enters, vi_load(block->counts + i), vi_splat(1)));
        bits |= vm_bits(enters) << i;
        if (with_sheets && vm_bits(enters)) {
            const vm closed =
                add_to_sheets(f, enters, at, weights, begin, end, sheets, i, &sheet_end);
            far = vf_pick(closed, vf_min(sheet_end, far), far);
        }
        vf_store(block->far + i, far);
    }
    return bits;
}

/* Appends entries of a block's cells; the room for all of them is there. Returns how many. */
static inline size_t append_entries(const shb_list_unsorted *entries, size_t end, uint32_t number,
                                    uint32_t cell, uint32_t bits, const float *begins) {
#if WIDE == 16
    const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const __m512i cells = _mm512_add_epi32(lanes, _mm512_set1_epi32((int32_t)cell));
    _mm512_storeu_si512(entries->cells + end, _mm512_maskz_compress_epi32((__mmask16)bits, cells));
    _mm512_storeu_ps(entries->begins + end,
                     _mm512_maskz_compress_ps((__mmask16)bits, _mm512_loadu_ps(begins)));
    _mm512_storeu_si512(entries->triangles + end, _mm512_set1_epi32((int32_t)number));
    return (size_t)__builtin_popcount(bits);
#else
    size_t count = end;
    for (; bits; bits &= bits - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(bits);
        entries->triangles[count] = number;
        entries->begins[count] = begins[lane];
        entries->cells[count++] = cell + lane;
    }
    return count - end;
#endif
}

/* Where a triangle lies in a tile, in blocks. */
typedef struct list_blocks {
    uint32_t columns; /* one bit each */
    uint32_t first_row, last_row;
} list_blocks;

static inline list_blocks blocks_of(const shb_list_cover *cover, const shb_list_box *box) {
    const int bits = cover->cell_bits + 2; /* texels of a block's side */
    const uint32_t first_column = first_block(box->first_column, cover->column, bits);
    const uint32_t last_column = last_block(box->last_column, cover->column, bits);
    return (list_blocks){(2u << last_column) - (1u << first_column),
                         first_block(box->first_row, cover->row, bits),
                         last_block(box->last_row, cover->row, bits)};
}

/* True if all cells of all blocks that a triangle reaches hide it. */
static inline bool is_hidden(const shb_list_cover *cover, const list_blocks *blocks,
                             float nearest) {
    uint32_t open = 0;
    for (uint32_t row = blocks->first_row; row <= blocks->last_row; row++)
        open |= open_blocks(cover, row, nearest);
    return !(open & blocks->columns);
}

static inline void cover_blocks(shb_list_cover *cover, bool with_sheets, const list_blocks *blocks,
                                bool hides, uint32_t number, const cell_functions *f) {
    SHB_ALIGN float begins[LIST_LANES];
    size_t count = cover->entries.count;
    for (uint32_t row = blocks->first_row; row <= blocks->last_row; row++) {
        uint32_t open = blocks->columns;
        if (hides)
            open &= open_blocks(cover, row, f->nearest);
        for (; open; open &= open - 1) {
            const uint32_t column = (uint32_t)__builtin_ctz(open);
            const uint32_t block = row * (SHB_LIST_BLOCKS >> cover->cell_bits) + column;
            const uint32_t cell = block * LIST_LANES;
            const uint32_t bits = cover_block(cover, with_sheets, f, column, row,
                                              &cover->blocks[block], &cover->sheets[block], begins);
            count += append_entries(&cover->entries, count, number, cell, bits, begins);
        }
    }
    cover->entries.count = count;
}

/* Finds how far the cells of each block let triangles be seen; true if some block hides any. */
static bool find_farthest(shb_list_cover *cover) {
    const uint32_t blocks = SHB_LIST_BLOCKS >> cover->cell_bits;
    bool hides = false;
    for (uint32_t row = 0; row < blocks; row++)
        for (uint32_t column = 0; column < blocks; column++) {
            const float farthest = largest_of_block(cover->blocks[row * blocks + column].far);
            cover->farthest[row * SHB_LIST_BLOCKS + column] = farthest;
            hides |= farthest < HUGE_VALF;
        }
    return hides;
}

/* LIST_AHEAD: triangles that are fetched before they are used; LIST_SPELL: triangles after which
 * blocks are looked at anew. */
enum { LIST_AHEAD = 8, LIST_SPELL = 128 };

static inline void fetch_covered(const shb_list_cover *cover, uint32_t number) {
    __builtin_prefetch(&cover->triangles[number]);
    if (cover->with_sheets)
        __builtin_prefetch(&cover->outlines[number]);
}

static inline bool cover_by(shb_list_cover *cover, bool with_sheets) {
    const size_t blocks = SHB_LIST_BLOCKS >> cover->cell_bits;
    const size_t room = (blocks * blocks + 1) * LIST_LANES; /* for one triangle */
    bool hides = false;
    for (size_t k = 0; k < cover->count; k++) {
        if (k + LIST_AHEAD < cover->count)
            fetch_covered(cover, (uint32_t)cover->keys[k + LIST_AHEAD]);
        if (cover->entries.capacity - cover->entries.count < room)
            return false;
        if (k % LIST_SPELL == LIST_SPELL - 1)
            hides = find_farthest(cover);
        const uint32_t number = (uint32_t)cover->keys[k];
        const float nearest =
            (float)shb_list_level_depth(cover->frame, (double)(cover->keys[k] >> 32));
        const list_blocks reached = blocks_of(cover, &cover->boxes[number]);
        if (hides && is_hidden(cover, &reached, nearest))
            continue;
        cell_functions f;
        put_cell_functions(cover, with_sheets, number, nearest, &f);
        cover_blocks(cover, with_sheets, &reached, hides, number, &f);
    }
    return true;
}

static bool cover_cells(shb_list_cover *cover) {
    return cover->with_sheets ? cover_by(cover, true) : cover_by(cover, false);
}
