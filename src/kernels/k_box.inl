/* Boxes of texels, LANES of a row at a time. Included once for each width of the wide types. */

#define W(name) SHB_JOIN(name, LANES)

/* So many boxes are counted for one look at what they have in common. */
#define BOX_LANES (LANES < 4 ? 4 : LANES)

/* What a box's taps are made of. The taps of a reversed map are compared as it stores depth,
 * everything negated. */
typedef struct W(box_taps) {
    W(wf) ref, step_x, step_y, far_depth;
} W(box_taps);

static inline ALWAYS_INLINE W(box_taps)
    W(box_taps_of)(const box_batch *batch, size_t i, tap_kind kind, bool reversed) {
    return (W(box_taps)){
        .ref = W(wf_splat)(batch->ref[i]),
        .step_x = W(wf_splat)(kind == TAPS_FLAT ? 0 : batch->step_x[i]),
        .step_y = W(wf_splat)(batch->step_y[i]),
        .far_depth = W(wf_splat)(shb_far_depth(reversed)),
    };
}

static inline ALWAYS_INLINE W(wf) W(limit_tap)(W(wf) far_depth, W(wf) tap, bool reversed) {
    return reversed ? W(wf_max)(far_depth, tap) : W(wf_min)(far_depth, tap);
}

/* Shadowed taps in rows first .. end - 1 of LANES columns from start on, column by column. The
 * order of operations is that of shb_tap_depth. */
static inline ALWAYS_INLINE W(wi)
    W(count_rows)(const texel_box *b, const W(box_taps) * taps, int n, int start, int first,
                  int end, tap_kind kind, bool reversed) {
    const W(wf) columns = W(wf_add)(W(wf_load)(columns_from_end + BOX_PITCH - n + start),
                                    W(wf_splat)((float)(n + b->column)));
    const W(wf) plane = W(wf_add)(taps->ref, W(wf_mul)(columns, taps->step_x));
    W(wi) count = W(wi_splat)(0);
    for (int row = first; row < end; row++) {
        const char *texels = b->texels + (size_t)row * b->stride;
        W(wf) tap = plane;
        if (kind == TAPS_PLANE || kind == TAPS_NEAR)
            tap = W(wf_add)(plane, W(wf_mul)(W(wf_splat)((float)(b->row + row)), taps->step_y));
        else if (kind == TAPS_GIVEN)
            tap = W(wf_load)(b->given + row * BOX_PITCH + start);
        if (kind == TAPS_PLANE || kind == TAPS_GIVEN)
            tap = W(limit_tap)(taps->far_depth, tap, reversed);
        const W(wf) stored = W(wf_load)((const float *)(const void *)texels + start);
        count =
            reversed ? W(wi_count_less)(count, tap, stored) : W(wi_count_less)(count, stored, tap);
    }
    return count;
}

/* Shadowed taps in all rows of 2 * LANES columns from start on, TAPS_FLAT, both halves added. The
 * loop stays one: unrolled, sums are put off until there are no registers for what they add.
 * Narrow vectors, which want more of these loops, are faster by count_rows. */
static inline ALWAYS_INLINE W(wi) W(count_flat_pair)(const texel_box *b, const W(box_taps) * taps,
                                                     int n, int start, bool reversed) {
    const float *from_end = columns_from_end + BOX_PITCH - n + start;
    const W(wf) zero = W(wf_splat)(0);
    const W(wf) left = W(wf_add)(taps->ref, W(wf_mul)(W(wf_load)(from_end), zero));
    const W(wf) right = W(wf_add)(taps->ref, W(wf_mul)(W(wf_load)(from_end + LANES), zero));
    W(wi) count = W(wi_splat)(0), more = count;
#pragma GCC unroll 1
    for (int row = 0; row < n; row++) {
        const char *texels = b->texels + (size_t)row * b->stride;
        const W(wf) stored = W(wf_load)((const float *)(const void *)texels + start);
        const W(wf) beside = W(wf_load)((const float *)(const void *)texels + start + LANES);
        count = reversed ? W(wi_count_less)(count, left, stored)
                         : W(wi_count_less)(count, stored, left);
        more = reversed ? W(wi_count_less)(more, right, beside)
                        : W(wi_count_less)(more, beside, right);
    }
    return W(wi_add)(count, more);
}

static inline ALWAYS_INLINE W(wi) W(count_box)(const box_batch *batch, size_t i, const texel_box *b,
                                               int n, tap_kind kind, bool reversed) {
    const W(box_taps) taps = W(box_taps_of)(batch, i, kind, reversed);
    W(wi) count = W(wi_splat)(0);
    int start = 0;
    for (; kind == TAPS_FLAT && LANES >= 8 && n - start > LANES; start += 2 * LANES)
        count = W(wi_add)(count, W(count_flat_pair)(b, &taps, n, start, reversed));
    for (; start < n; start += LANES)
        count = W(wi_add)(count, W(count_rows)(b, &taps, n, start, 0, n, kind, reversed));
    return count;
}

/* Lit taps in rows first .. end - 1, those of the outer columns by their weights. */
static inline ALWAYS_INLINE double W(weigh_rows)(const texel_box *b, const W(box_taps) * taps,
                                                 int n, int first, int end, double right_weight,
                                                 tap_kind kind, bool reversed) {
    SHB_ALIGN int32_t columns[BOX_PITCH];
    int32_t shadowed = 0;
    int start = 0;
    do {
        const W(wi) count = W(count_rows)(b, taps, n, start, first, end, kind, reversed);
        W(wi_store)(columns + start, count);
        shadowed += W(wi_sum)(count);
    } while ((start += LANES) < n);
    return weigh_columns(columns[0], columns[n - 1], shadowed, n, end - first, right_weight);
}

static inline ALWAYS_INLINE double W(weigh_box)(const box_batch *batch, size_t i,
                                                const texel_box *b, int n, tap_kind kind,
                                                bool reversed) {
    const W(box_taps) taps = W(box_taps_of)(batch, i, kind, reversed);
    const double right = last_weight(batch->receivers->to_center_x[i], n);
    const double bottom = last_weight(batch->receivers->to_center_y[i], n);
    const double above = W(weigh_rows)(b, &taps, n, 0, 1, right, kind, reversed);
    const double inner = W(weigh_rows)(b, &taps, n, 1, n - 1, right, kind, reversed);
    const double below = W(weigh_rows)(b, &taps, n, n - 1, n, right, kind, reversed);
    return ((1 - bottom) * above + bottom * below) + inner;
}

/* Shadowed taps of fragment i, whose box is at this place, column by column. */
static inline ALWAYS_INLINE W(wi) W(count_at)(const box_batch *batch, size_t i, int32_t place,
                                              int n, tap_kind kind, bool reversed) {
    texel_box b = {.texels = (const char *)((const float *)batch->map->depth.texels + place),
                   .stride = batch->map->depth.stride,
                   .column = -(n / 2), /* constants where n is one */
                   .row = -(n / 2)};
    if (n % 2 == 0) {
        b.column = batch->left[i] - batch->receivers->texel_x[i];
        b.row = batch->top[i] - batch->receivers->texel_y[i];
    }
    return W(count_box)(batch, i, &b, n, kind, reversed);
}

static inline ALWAYS_INLINE W(wi_pair)
    W(count_two)(const box_batch *batch, size_t i, const int32_t *places, int n, tap_kind kind,
                 bool reversed) {
    const W(wi) one = W(count_at)(batch, i, places[0], n, kind, reversed);
    const W(wi) other = W(count_at)(batch, i + 1, places[1], n, kind, reversed);
    return W(wi_pair_of)(one, other);
}

/* Shadowed taps of BOX_LANES fragments from i on, whose boxes are at these places. by_twos: two
 * boxes side by side want no more registers than there are. Compilers put sums off to where they
 * are used, so the loop over others stays one. */
static inline ALWAYS_INLINE void W(count_group)(const box_batch *batch, size_t i,
                                                const int32_t *places, int n, bool by_twos,
                                                tap_kind kind, bool reversed, int32_t *shadowed) {
#pragma GCC unroll 1
    for (size_t k = 0; k < BOX_LANES && by_twos; k += 4) {
        const W(wi_pair) first = W(count_two)(batch, i + k, places + k, n, kind, reversed);
        const W(wi_pair) last = W(count_two)(batch, i + k + 2, places + k + 2, n, kind, reversed);
        W(wi_store_sums)(shadowed + k, first, last);
    }
    if (by_twos)
        return;
    W(wi) counts[BOX_LANES];
#pragma GCC unroll 1
    for (size_t k = 0; k < BOX_LANES; k++)
        counts[k] = W(count_at)(batch, i + k, places[k], n, kind, reversed);
    for (size_t k = 0; k < BOX_LANES; k += 4) {
        const W(wi_pair) first = W(wi_pair_of)(counts[k], counts[k + 1]);
        const W(wi_pair) last = W(wi_pair_of)(counts[k + 2], counts[k + 3]);
        W(wi_store_sums)(shadowed + k, first, last);
    }
}

/* Shadowed taps of BOX_LANES fragments from i on. whole: the boxes of all of them are read in
 * place. */
static inline ALWAYS_INLINE void W(count_lanes)(const box_run *run, size_t i, bool whole, int n,
                                                bool by_twos, tap_kind kind, bool reversed,
                                                int32_t *shadowed) {
    const box_batch *batch = run->batch;
    const int32_t *places = batch->place + i;
    int32_t readable[BOX_LANES];
    if (!whole) {
        if (!readable_places(run, i, BOX_LANES, readable)) {
            memset(shadowed, 0, BOX_LANES * sizeof *shadowed);
            return;
        }
        places = readable;
    }
    if (kind == TAPS_PLANE && !any_set(batch->limited + i, BOX_LANES))
        W(count_group)(batch, i, places, n, by_twos, TAPS_NEAR, reversed, shadowed);
    else
        W(count_group)(batch, i, places, n, by_twos, kind, reversed, shadowed);
}

/* Boxes that lie in the map, whose texels are floats; what others get means nothing. */
static inline ALWAYS_INLINE void W(count_in_place)(const box_run *run, int n, bool by_twos,
                                                   tap_kind kind, bool reversed,
                                                   float *restrict visibility) {
    const box_batch *batch = run->batch;
    const bool whole = batch->same_size && batch->all_inside;
    const int width = (n + LANES - 1) / LANES * LANES;
    const double share = 1 / (double)(n * n);
    SHB_ALIGN int32_t shadowed[SHB_BATCH];
    for (size_t i = 0; i < PREFETCHED_BOXES; i += BOX_LANES)
        prefetch_boxes(run, run->first + i, BOX_LANES, width);
    for (size_t i = run->first; i < run->end; i += BOX_LANES) {
        prefetch_boxes(run, i + PREFETCHED_BOXES, BOX_LANES, width);
        W(count_lanes)(run, i, whole, n, by_twos, kind, reversed, shadowed + i);
    }
    for (size_t i = run->first; i < run->end; i++) {
        const float lit = (float)(share * (n * n - shadowed[i]));
        visibility[i] = batch->size[i] == n ? lit : visibility[i];
    }
}

#undef BOX_LANES
#undef W
