/* Boxes of texels, LANES of a row at a time. Included once for each width of the wide types. */

#define W(name) SHB_JOIN(name, LANES)

/* The taps of a reversed map are compared as it stores them, everything negated. */
static inline ALWAYS_INLINE W(wf) W(limit_tap)(W(wf) far_depth, W(wf) tap, bool reversed) {
    return reversed ? W(wf_max)(far_depth, tap) : W(wf_min)(far_depth, tap);
}

static inline ALWAYS_INLINE W(wi)
    W(count_taps)(W(wi) count, const float *stored, W(wf) tap, bool reversed) {
    const W(wf) texels = W(wf_load)(stored);
    return reversed ? W(wi_count_less)(count, tap, texels) : W(wi_count_less)(count, texels, tap);
}

/* Columns of a box from the fragment's own one on, from column start of the box; NaN beyond it. */
static inline ALWAYS_INLINE W(wf) W(box_columns)(const box *b, int n, int start) {
    const W(wf) from_end = W(wf_load)(columns_from_end + BOX_PITCH - n + start);
    return W(wf_add)(from_end, W(wf_splat)((float)(n + b->column)));
}

/* The plane of fragment i over LANES columns of its box, in its own row. */
static inline ALWAYS_INLINE W(wf)
    W(box_plane)(const box_batch *batch, size_t i, W(wf) columns, tap_kind kind, bool reversed) {
    const float sign = reversed ? -1.0f : 1.0f;
    const float step_x = kind == TAPS_FLAT ? 0.0f : sign * batch->receivers->step_x[i];
    return W(wf_add)(W(wf_splat)(sign * batch->receivers->ref[i]),
                     W(wf_mul)(columns, W(wf_splat)(step_x)));
}

/* Shadowed taps in rows first .. end - 1 of LANES columns from start on, column by column. */
static inline ALWAYS_INLINE W(wi)
    W(count_rows)(const box_batch *batch, size_t i, const box *b, int n, int start, int first,
                  int end, tap_kind kind, bool reversed) {
    const float sign = reversed ? -1.0f : 1.0f;
    const W(wf) far_depth = W(wf_splat)(batch->far_stored);
    const W(wf) plane = W(box_plane)(batch, i, W(box_columns)(b, n, start), kind, reversed);
    const W(wf) flat = W(limit_tap)(far_depth, plane, reversed);
    const W(wf) step_y = W(wf_splat)(sign * batch->receivers->step_y[i]);
    W(wi) count = W(wi_splat)(0);
    for (int row = first; row < end; row++) {
        const char *texels = b->texels + (size_t)row * b->stride;
        W(wf) tap = flat;
        if (kind == TAPS_PLANE) {
            const W(wf) down = W(wf_mul)(W(wf_splat)((float)(b->row + row)), step_y);
            tap = W(limit_tap)(far_depth, W(wf_add)(plane, down), reversed);
        } else if (kind == TAPS_GIVEN) {
            tap = W(wf_load)(batch->given + row * BOX_PITCH + start);
            tap = W(limit_tap)(far_depth, tap, reversed);
        }
        count = W(count_taps)(count, (const float *)(const void *)texels + start, tap, reversed);
    }
    return count;
}

static inline ALWAYS_INLINE void W(count_boxes)(box_batch *batch, size_t first, size_t end, int n,
                                                tap_kind kind, bool reversed) {
    for (size_t i = first; i < end; i++) {
        box b;
        batch->shadowed[i] = 0;
        if (!find_box(batch, i, n, (n + LANES - 1) / LANES * LANES, &b))
            continue;
        if (kind == TAPS_GIVEN)
            give_taps(batch, i, &b, n);
        W(wi) count = W(count_rows)(batch, i, &b, n, 0, 0, n, kind, reversed);
        for (int start = LANES; start < n; start += LANES)
            count = W(wi_add)(count, W(count_rows)(batch, i, &b, n, start, 0, n, kind, reversed));
        batch->shadowed[i] = W(wi_sum)(count);
    }
}

/* Shadowed taps of fragments whose boxes have n columns and rows. */
static inline ALWAYS_INLINE void W(count_run)(box_batch *batch, size_t first, size_t end, int n,
                                              tap_kind kind) {
    if (batch->reversed)
        W(count_boxes)(batch, first, end, n, kind, true);
    else
        W(count_boxes)(batch, first, end, n, kind, false);
}

/* Lit taps in rows first .. end - 1, those of the outer columns by their weights. */
static inline ALWAYS_INLINE double W(weigh_rows)(const box_batch *batch, size_t i, const box *b,
                                                 int n, int first, int end, double right_weight,
                                                 tap_kind kind, bool reversed) {
    SHB_ALIGN int32_t columns[BOX_PITCH];
    int32_t shadowed = 0;
    int start = 0;
    do {
        const W(wi) count = W(count_rows)(batch, i, b, n, start, first, end, kind, reversed);
        W(wi_store)(columns + start, count);
        shadowed += W(wi_sum)(count);
    } while ((start += LANES) < n);
    const int32_t rows = end - first;
    const int32_t left = rows - columns[0], right = rows - columns[n - 1];
    const int32_t inner = n * rows - shadowed - left - right;
    return ((1 - right_weight) * left + right_weight * right) + inner;
}

static inline ALWAYS_INLINE void W(weigh_boxes)(box_batch *batch, size_t first, size_t end, int n,
                                                tap_kind kind, bool reversed) {
    for (size_t i = first; i < end; i++) {
        box b;
        batch->lit[i] = (n - 1) * (n - 1);
        if (!find_box(batch, i, n, (n + LANES - 1) / LANES * LANES, &b))
            continue;
        if (kind == TAPS_GIVEN)
            give_taps(batch, i, &b, n);
        const double right = last_weight(batch->receivers->to_center_x[i], n);
        const double bottom = last_weight(batch->receivers->to_center_y[i], n);
        const double top_row = W(weigh_rows)(batch, i, &b, n, 0, 1, right, kind, reversed);
        const double rows = W(weigh_rows)(batch, i, &b, n, 1, n - 1, right, kind, reversed);
        const double last_row = W(weigh_rows)(batch, i, &b, n, n - 1, n, right, kind, reversed);
        batch->lit[i] = ((1 - bottom) * top_row + bottom * last_row) + rows;
    }
}

/* Lit taps by their weights, of a sum of (n - 1)^2. */
static inline ALWAYS_INLINE void W(weigh_run)(box_batch *batch, size_t first, size_t end, int n,
                                              tap_kind kind) {
    if (batch->reversed)
        W(weigh_boxes)(batch, first, end, n, kind, true);
    else
        W(weigh_boxes)(batch, first, end, n, kind, false);
}

#undef W
