/* Boxes by planes whose rows have at most ROW_BITS texels. Included once for each number. */

#include "k_box_sheet.inl"

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_LANES (sizeof(R(rows)) / sizeof(R(row)))

/* A set of texels of a box, row after row. */
typedef struct R(box_bits) {
    R(row) rows[ROW_BITS];
} R(box_bits);

/* So many boxes are asked at a time. */
#define BOXES (4096 / ROW_BITS)

typedef struct R(open_boxes) {
    int n;
    size_t count;
    size_t known; /* of the first ones taps are shadowed but for sheets; of the others in front */
    uint16_t fragments[BOXES];
    own_texel own[BOXES];
    R(box_bits) taps[BOXES];
} R(open_boxes);

/* Taps of WIDE columns from start on that are what is asked for: a new set of those IN_FRONT, or
 * what PASSING alone leaves of a set. lane: of fragment i among those of ways. */
static inline ALWAYS_INLINE void R(find_taps_from)(const box_batch *batch, size_t i,
                                                   const texel_box *b, const row_ways *ways,
                                                   size_t lane, int n, int start, bool reversed,
                                                   int asked, R(box_bits) * taps) {
    const shb_receivers *r = batch->receivers;
    const mutual_lanes own = mutual_lanes_of_one(batch->mutual, i);
    const vf far_depth = vf_splat(shb_far_depth(reversed));
    const vf m = vf_load(columns_from_end + BOX_PITCH - n + start) + (float)(n + b->column);
    const vf plane = r->ref[i] + m * r->step_x[i];
    const mutual_way x = mutual_way_of(own.moved_x, r->to_center_x[i] + m, step_unit(batch->map));
    const uint64_t others = ~((((uint64_t)1 << WIDE) - 1) << start);
    const char *texels = b->texels + (size_t)start * sizeof(float);
    const char *occluders = b->occluders + (size_t)start * sizeof(uint32_t);
    for (int k = 0; k < n; k++) {
        const vf depth = vf_load((const float *)(const void *)texels);
        const vf stored = reversed ? -depth : depth;
        vi found = vi_splat(-1);
        if (asked & IN_FRONT)
            found = stored < vf_min(far_depth, plane + ways->drop[k][lane]);
        if (asked & PASSING) {
            const mutual_way y = {vf_splat(ways->rising[k][lane]), vf_splat(ways->falling[k][lane]),
                                  vf_splat(ways->error[k][lane])};
            vu slopes;
            memcpy(&slopes, occluders, sizeof slopes);
            found &= passes_in_front(own.z, own.base, &x, &y, stored, slopes);
        }
        const uint64_t bits = (uint64_t)vi_bits(found) << start;
        if (!(asked & IN_FRONT))
            taps->rows[k] &= (R(row))(bits | others);
        else
            taps->rows[k] = (R(row))(start ? taps->rows[k] | bits : bits);
        texels += b->stride;
        occluders += b->occluder_stride;
    }
}

static inline ALWAYS_INLINE void R(find_taps)(const box_batch *batch, size_t i, const texel_box *b,
                                              const row_ways *ways, size_t lane, int n,
                                              bool reversed, int asked, R(box_bits) * taps) {
    if (ROW_BITS == 16 && asked & IN_FRONT)
        memset(taps, 0, sizeof *taps);
    R(find_taps_from)(batch, i, b, ways, lane, n, 0, reversed, asked, taps);
    for (int start = WIDE; start < n; start += WIDE)
        R(find_taps_from)(batch, i, b, ways, lane, n, start, reversed, asked, taps);
}

/* Adds a box. */
static inline ALWAYS_INLINE void R(open_box)(const box_batch *batch, size_t i, const texel_box *b,
                                             const row_ways *ways, size_t lane, bool reversed,
                                             int asked, R(open_boxes) * open) {
    const size_t at = open->count++;
    open->fragments[at] = (uint16_t)i;
    open->own[at] = own_texel_of(b, reversed);
    R(find_taps)(batch, i, b, ways, lane, open->n, reversed, asked, &open->taps[at]);
}

/* Of rows first .. end - 1. */
static inline ALWAYS_INLINE int32_t R(count_bits)(const R(box_bits) * bits, int first, int end) {
    int32_t count = 0;
    for (int k = first; k < end; k++)
        count += __builtin_popcountll(bits->rows[k]);
    return count;
}

static inline ALWAYS_INLINE int32_t R(count_all)(const R(box_bits) * bits, int n) {
    uint64_t words[4];
    if (ROW_BITS > 16)
        return R(count_bits)(bits, 0, n);
    memcpy(words, bits->rows, sizeof words);
    return (__builtin_popcountll(words[0]) + __builtin_popcountll(words[1])) +
           (__builtin_popcountll(words[2]) + __builtin_popcountll(words[3]));
}

static inline ALWAYS_INLINE bool R(has_bits)(const R(box_bits) * bits, int n) {
    uint64_t words[4], any = 0;
    for (int k = 0; ROW_BITS > 16 && k < n; k++)
        any |= bits->rows[k];
    memcpy(words, bits->rows, sizeof words);
    return ROW_BITS > 16 ? any != 0 : ((words[0] | words[1]) | (words[2] | words[3])) != 0;
}

static inline ALWAYS_INLINE double R(lit_rows)(const R(box_bits) * shadowed, int n, int first,
                                               int end, double right_weight) {
    int32_t left = 0, right = 0;
    for (int k = first; k < end; k++) {
        left += (int32_t)(shadowed->rows[k] & 1);
        right += (int32_t)(shadowed->rows[k] >> (n - 1) & 1);
    }
    return weigh_columns(left, right, R(count_bits)(shadowed, first, end), n, end - first,
                         right_weight);
}

/* As weigh_box of k_box.inl. */
static inline ALWAYS_INLINE float R(lit_part)(const box_batch *batch, size_t i,
                                              const R(box_bits) * shadowed, int n) {
    const double right = last_weight(batch->receivers->to_center_x[i], n);
    const double bottom = last_weight(batch->receivers->to_center_y[i], n);
    const double above = R(lit_rows)(shadowed, n, 0, 1, right);
    const double inner = R(lit_rows)(shadowed, n, 1, n - 1, right);
    const double below = R(lit_rows)(shadowed, n, n - 1, n, right);
    return weight_share(((1 - bottom) * above + bottom * below) + inner, n);
}

/* Of the boxes that have taps those where the fragment's own texel is none: it may stand on a sheet
 * that lights them. */
static inline ALWAYS_INLINE size_t R(list_on_sheets)(const box_batch *batch,
                                                     const R(open_boxes) * open, uint16_t *boxes) {
    size_t found = 0;
    for (size_t k = 0; k < open->count; k++) {
        const size_t i = open->fragments[k];
        const int32_t x = batch->receivers->texel_x[i] - batch->left[i];
        const int32_t y = batch->receivers->texel_y[i] - batch->top[i];
        boxes[found] = (uint16_t)k;
        found += R(has_bits)(&open->taps[k], open->n) & (size_t) ~(open->taps[k].rows[y] >> x);
    }
    return keep_standing(batch->mutual, open->fragments, open->own, boxes, found);
}

static NEVER_INLINE void R(leave_sheets)(const box_batch *batch, R(open_boxes) * open) {
    uint16_t boxes[BOXES + 1];
    R(sheet_rows) sheets;
    const size_t found = R(list_on_sheets)(batch, open, boxes);
    for (size_t first = 0; first < found; first += ROW_LANES) {
        const size_t count = found - first < ROW_LANES ? found - first : ROW_LANES;
        R(clear_sheets)(&sheets, open->n);
        for (size_t lane = 0; lane < count; lane++) {
            const size_t i = open->fragments[boxes[first + lane]];
            R(enter_sheet)
            (batch->map, batch->left[i], batch->top[i], batch->receivers->texel_x[i],
             batch->receivers->texel_y[i], open->n, lane, &sheets);
        }
        R(follow_sheets)(&sheets, count, open->n);
        for (size_t lane = 0; lane < count; lane++) {
            R(box_bits) *taps = &open->taps[boxes[first + lane]];
            for (int k = 0; k < open->n; k++)
                taps->rows[k] &= (R(row)) ~sheets.rows[1 + k].sheet[lane];
        }
    }
}

/* Of boxes in place whose taps are not known. */
static NEVER_INLINE void R(leave_passing)(const box_batch *batch, bool reversed,
                                          R(open_boxes) * open) {
    uint16_t boxes[BOXES + 1], fragments[BOXES + LIST_MARGIN];
    row_ways ways;
    size_t found = 0;
    for (size_t k = open->known; k < open->count; k++) {
        boxes[found] = (uint16_t)k;
        fragments[found] = open->fragments[k];
        found += R(has_bits)(&open->taps[k], open->n);
    }
    if (found == 0)
        return;
    fill_list(fragments, found);
    for (size_t k = 0; k < found; k++) {
        const texel_box b = exact_box_in_place(batch, fragments[k]);
        if (k % WIDE == 0)
            find_row_ways(batch, fragments + k, open->n, PASSING, &ways);
        prefetch_slopes(batch, fragments[k + BOXES_AHEAD], open->n);
        R(find_taps)
        (batch, fragments[k], &b, &ways, k % WIDE, open->n, reversed, PASSING,
         &open->taps[boxes[k]]);
    }
}

/* The taps that are left are shadowed. */
static NEVER_INLINE void R(finish_boxes)(const box_batch *batch, bool smooth, R(open_boxes) * open,
                                         float *visibility) {
    const int n = open->n;
    for (size_t k = 0; smooth && k < open->count; k++) {
        const size_t i = open->fragments[k];
        visibility[i] = R(lit_part)(batch, i, &open->taps[k], n);
    }
    for (size_t k = 0; !smooth && k < open->count; k++)
        visibility[open->fragments[k]] = box_share(n, R(count_all)(&open->taps[k], n));
    open->count = 0;
}

/* Boxes in place, those of count fragments and more to fill the vectors. */
static inline ALWAYS_INLINE void R(open_in_place)(const box_batch *batch, const uint16_t *fragments,
                                                  size_t count, bool reversed, int asked,
                                                  R(open_boxes) * open) {
    row_ways ways;
    for (size_t k = 0; k < count; k++) {
        const size_t i = fragments[k];
        const texel_box b = exact_box_in_place(batch, i);
        if (k % WIDE == 0)
            find_row_ways(batch, fragments + k, open->n, asked, &ways);
        if (asked & PASSING)
            prefetch_slopes(batch, fragments[k + BOXES_AHEAD], open->n);
        else
            prefetch_own_slopes(batch, fragments[k + BOXES_AHEAD]);
        R(open_box)(batch, i, &b, &ways, k % WIDE, reversed, asked, open);
    }
}

/* Those of n x n texels; puts the fragments in another order. */
static inline ALWAYS_INLINE void R(ask_listed)(const box_batch *batch, bool smooth,
                                               uint16_t *fragments, size_t count, int n,
                                               bool reversed, float *visibility) {
    R(open_boxes) open;
    open.n = n;
    open.count = 0;
    for (size_t first = 0; first < count; first += BOXES) {
        uint16_t *some = fragments + first;
        const size_t left = count - first, some_count = left < BOXES ? left : BOXES;
        open.known =
            n > SLOPES_FIRST ? put_hidden_first(batch, some, some_count, reversed) : some_count;
        R(open_in_place)(batch, some, open.known, reversed, IN_FRONT | PASSING, &open);
        R(open_in_place)
        (batch, some + open.known, some_count - open.known, reversed, IN_FRONT, &open);
        R(leave_sheets)(batch, &open);
        R(leave_passing)(batch, reversed, &open);
        R(finish_boxes)(batch, smooth, &open, visibility);
    }
}

/* Those of such rows that are not in place: in map formats that are not float, and where the map
 * ends. */
static NEVER_INLINE void R(ask_copies)(box_batch *batch, bool smooth, size_t count,
                                       float *visibility) {
    R(open_boxes) open;
    open.n = 0;
    open.count = 0;
    open.known = BOXES;
    for (size_t i = 0; i < count; i++) {
        const int n = batch->size[i];
        texel_box b;
        if (batch->place[i] >= 0 || row_bits_of(n) != ROW_BITS)
            continue;
        if (!copy_box(batch, i, &b)) {
            visibility[i] = 1;
            continue;
        }
        if (open.count == BOXES || open.n != n) {
            R(leave_sheets)(batch, &open);
            R(finish_boxes)(batch, smooth, &open, visibility);
        }
        uint16_t fragments[WIDE];
        row_ways ways;
        for (int lane = 0; lane < WIDE; lane++)
            fragments[lane] = (uint16_t)i;
        open.n = n;
        find_row_ways(batch, fragments, n, IN_FRONT | PASSING, &ways);
        R(open_box)(batch, i, &b, &ways, 0, batch->reversed, IN_FRONT | PASSING, &open);
    }
    R(leave_sheets)(batch, &open);
    R(finish_boxes)(batch, smooth, &open, visibility);
}

#undef BOXES
#undef ROW_LANES
#undef R
