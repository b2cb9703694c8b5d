/* Boxes of texels by the exact method, where a map keeps planes: both conditions of a tap for whole
 * vectors of columns without a branch, which the hits of single rows would often mislead. */

#include "k_box_sheet.inl"

/* How the rows of boxes of WIDE fragments lie to them, counted from the first row. */
typedef struct row_ways {
    float drop[BOX_MAX][WIDE]; /* of a fragment's plane, as its ref and steps */
    float rising[BOX_MAX][WIDE], falling[BOX_MAX][WIDE];
} row_ways;

static inline ALWAYS_INLINE void find_row_ways(const box_batch *batch, const uint16_t *fragments,
                                               int n, row_ways *ways) {
    const shb_receivers *r = batch->receivers;
    const float unit = length_unit(batch->map);
    float first[WIDE], to_center[WIDE], step[WIDE], moved[WIDE];
    for (int lane = 0; lane < WIDE; lane++) {
        const size_t i = fragments[lane];
        first[lane] = (float)(batch->top[i] - r->texel_y[i]);
        to_center[lane] = r->to_center_y[i];
        step[lane] = r->step_y[i];
        moved[lane] = batch->mutual->moved_y[i];
    }
    for (int k = 0; k < n; k++) {
        const vf row = vf_load(first) + (float)k;
        const mutual_way way = mutual_way_of(vf_load(moved), vf_load(to_center) + row, unit);
        vf_store(ways->drop[k], row * vf_load(step));
        vf_store(ways->rising[k], way.rising);
        vf_store(ways->falling[k], way.falling);
    }
}

/* Shadowed taps of WIDE columns from start on; lane: of fragment i among those of ways. */
static inline ALWAYS_INLINE void find_shadowed_from(const box_batch *batch, size_t i,
                                                    const texel_box *b, const row_ways *ways,
                                                    size_t lane, int n, int start, bool reversed,
                                                    box_bits *shadowed) {
    const shb_receivers *r = batch->receivers;
    const mutual_lanes own = mutual_lanes_of_one(batch->mutual, i);
    const vf far_depth = vf_splat(shb_far_depth(reversed));
    const vf m = vf_load(columns_from_end + BOX_PITCH - n + start) + (float)(n + b->column);
    const vf plane = r->ref[i] + m * r->step_x[i];
    const mutual_way x = mutual_way_of(own.moved_x, r->to_center_x[i] + m, length_unit(batch->map));
    const char *texels = b->texels + (size_t)start * sizeof(float);
    const char *occluders = b->occluders + (size_t)start * sizeof(uint32_t);
    for (int k = 0; k < n; k++) {
        const vf depth = vf_load((const float *)(const void *)texels);
        const vf stored = reversed ? -depth : depth;
        const vf tap = vf_min(far_depth, plane + ways->drop[k][lane]);
        const mutual_way y = {vf_splat(ways->rising[k][lane]), vf_splat(ways->falling[k][lane])};
        vu slopes;
        memcpy(&slopes, occluders, sizeof slopes);
        const uint64_t bits =
            vi_bits((stored < tap) & passes_in_front(own.z, own.base, &x, &y, stored, slopes));
        shadowed->rows[k] = start ? shadowed->rows[k] | bits << start : bits;
        texels += b->stride;
        occluders += b->occluder_stride;
    }
}

/* Where the fragment's own texel lights it, it stands on a sheet that may light other taps. */
static inline ALWAYS_INLINE void find_shadowed(const box_batch *batch, size_t i, const texel_box *b,
                                               const row_ways *ways, size_t lane, int n,
                                               bool reversed, box_bits *shadowed) {
    uint64_t any = 0;
    for (int start = 0; start < n; start += WIDE)
        find_shadowed_from(batch, i, b, ways, lane, n, start, reversed, shadowed);
    for (int k = 0; k < n; k++)
        any |= shadowed->rows[k];
    if (any && !(shadowed->rows[-b->row] >> -b->column & 1))
        light_sheet(batch, i, b, reversed, shadowed);
}

static inline ALWAYS_INLINE int32_t count_bits(const box_bits *bits, int first, int end) {
    int32_t count = 0;
    for (int k = first; k < end; k++)
        count += __builtin_popcountll(bits->rows[k]);
    return count;
}

static inline ALWAYS_INLINE texel_box exact_box_in_place(const box_batch *batch, size_t i) {
    texel_box b = box_in_place(batch, i);
    b.occluders = (const char *)(shb_occluder_row(batch->map, batch->top[i]) + batch->left[i]);
    b.occluder_stride = batch->map->occluders.stride;
    return b;
}

/* The slopes of so many boxes are on their way from memory. */
#define BOXES_AHEAD 4

static inline ALWAYS_INLINE void prefetch_slopes(const box_batch *batch, size_t i, int n) {
    const texel_box b = exact_box_in_place(batch, i);
    for (int row = 0; row < n; row++)
        __builtin_prefetch(b.occluders + (size_t)row * b.occluder_stride);
}

static inline ALWAYS_INLINE double lit_rows(const box_bits *shadowed, int n, int first, int end,
                                            double right_weight) {
    int32_t left = 0, right = 0;
    for (int k = first; k < end; k++) {
        left += (int32_t)(shadowed->rows[k] & 1);
        right += (int32_t)(shadowed->rows[k] >> (n - 1) & 1);
    }
    return weigh_columns(left, right, count_bits(shadowed, first, end), n, end - first,
                         right_weight);
}

/* As weigh_box of k_box.inl. */
static inline ALWAYS_INLINE float lit_part(const box_batch *batch, size_t i,
                                           const box_bits *shadowed, int n) {
    const double right = last_weight(batch->receivers->to_center_x[i], n);
    const double bottom = last_weight(batch->receivers->to_center_y[i], n);
    const double above = lit_rows(shadowed, n, 0, 1, right);
    const double inner = lit_rows(shadowed, n, 1, n - 1, right);
    const double below = lit_rows(shadowed, n, n - 1, n, right);
    return weight_share(((1 - bottom) * above + bottom * below) + inner, n);
}

static inline ALWAYS_INLINE float lit_share(const box_batch *batch, size_t i, bool smooth,
                                            const box_bits *shadowed, int n) {
    return smooth ? lit_part(batch, i, shadowed, n) : box_share(n, count_bits(shadowed, 0, n));
}

/* Boxes of n x n texels in place, those of count fragments and more to fill the vectors. */
static inline ALWAYS_INLINE void ask_listed(const box_batch *batch, bool smooth,
                                            const uint16_t *fragments, size_t count, int n,
                                            bool reversed, float *visibility) {
    row_ways ways;
    for (size_t k = 0; k < count; k++) {
        const size_t i = fragments[k];
        const texel_box b = exact_box_in_place(batch, i);
        box_bits shadowed;
        if (k % WIDE == 0)
            find_row_ways(batch, fragments + k, n, &ways);
        prefetch_slopes(batch, fragments[k + BOXES_AHEAD], n);
        find_shadowed(batch, i, &b, &ways, k % WIDE, n, reversed, &shadowed);
        visibility[i] = lit_share(batch, i, smooth, &shadowed, n);
    }
}

/* Fragments in place that their own planes do not light in all taps; room for more of them. */
static size_t list_open_boxes(const box_batch *batch, size_t count, const float *visibility,
                              uint16_t *fragments) {
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        fragments[found] = (uint16_t)i;
        found += (batch->place[i] >= 0) & (visibility[i] != 1);
    }
    return found;
}

/* Takes the fragments with boxes of n texels in a row out of the list. */
static size_t list_of_size(const box_batch *batch, int n, uint16_t *open, size_t *open_count,
                           uint16_t *fragments) {
    size_t found = 0, left = 0;
    for (size_t k = 0; k < *open_count; k++) {
        const uint16_t i = open[k];
        fragments[found] = open[left] = i;
        found += batch->size[i] == n;
        left += batch->size[i] != n;
    }
    *open_count = left;
    return found;
}

static void ask_open_boxes(const box_batch *batch, bool smooth, size_t count, float *visibility) {
    uint16_t open[SHB_BATCH + 1], fragments[SHB_BATCH + SHB_LANES + BOXES_AHEAD];
    size_t left = list_open_boxes(batch, count, visibility, open);
    while (left) {
        const int n = batch->size[open[0]];
        const size_t found = list_of_size(batch, n, open, &left, fragments);
        for (size_t k = 0; k < SHB_LANES + BOXES_AHEAD; k++)
            fragments[found + k] = fragments[found - 1];
        if (batch->reversed)
            ask_listed(batch, smooth, fragments, found, n, true, visibility);
        else
            ask_listed(batch, smooth, fragments, found, n, false, visibility);
    }
}

static inline ALWAYS_INLINE float ask_copy(const box_batch *batch, bool smooth, size_t i,
                                           const texel_box *b, bool reversed) {
    const int n = batch->size[i];
    uint16_t fragments[WIDE];
    row_ways ways;
    box_bits shadowed;
    for (int lane = 0; lane < WIDE; lane++)
        fragments[lane] = (uint16_t)i;
    find_row_ways(batch, fragments, n, &ways);
    find_shadowed(batch, i, b, &ways, 0, n, reversed, &shadowed);
    return lit_share(batch, i, smooth, &shadowed, n);
}

/* In map formats that are not float, and where the map ends. */
static NEVER_INLINE float ask_plane_copy(box_batch *batch, bool smooth, size_t i) {
    texel_box b;
    if (!copy_box(batch, i, &b))
        return 1;
    return batch->reversed ? ask_copy(batch, smooth, i, &b, true)
                           : ask_copy(batch, smooth, i, &b, false);
}

/* Boxes whose texels all lie behind the fragment's plane are lit. */
static void ask_plane_boxes(box_batch *batch, bool smooth, size_t count, float *visibility) {
    count_inside(batch, count, visibility);
    ask_open_boxes(batch, smooth, count, visibility);
    for (size_t i = 0; i < count && !batch->all_inside; i++)
        if (batch->place[i] < 0)
            visibility[i] = ask_plane_copy(batch, smooth, i);
}
