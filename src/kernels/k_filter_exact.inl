/* Boxes of texels by the exact method. */

/* How far taps of a box lie from the fragment on an axis, texels. */
static inline float box_reach(int32_t n) {
    return (float)(n / 2 + 1);
}

/* The planes of fragments are written for the reach of their boxes. */
static void exact_boxes_init(const shb_filter_args *args, float least, mutual_batch *mutual,
                             box_batch *batch) {
    mutual_batch_init(args, mutual);
    box_batch_init(args, &mutual->receivers, TAPS_PLANE, least, batch);
    batch->mutual = mutual;
    for (size_t i = 0; i < shb_round_to_lanes(args->count); i++)
        mutual->reach[i] = box_reach(batch->size[i]);
    mutual_batch_finish(mutual, args->count);
}

/* False: the box lies outside the map. */
static bool find_box(box_batch *batch, size_t i, texel_box *b) {
    if (!batch->inside[i])
        return copy_box(batch, i, b);
    *b = box_in_place(batch, i);
    b->given = batch->given;
    b->occluders = (const char *)(shb_occluder_row(batch->map, batch->top[i]) + batch->left[i]);
    b->occluder_stride = batch->map->occluders.stride;
    return true;
}

/* WIDE columns of a box, from start on. */
typedef struct box_columns {
    vf to_x;  /* from the fragment, texels; NaN beyond the box */
    vf plane; /* of the fragment, in its own row */
} box_columns;

static inline ALWAYS_INLINE box_columns box_columns_of(const box_batch *batch, size_t i,
                                                       const texel_box *b, int start) {
    const shb_receivers *r = batch->receivers;
    const int n = batch->size[i];
    const vf m = vf_load(columns_from_end + BOX_PITCH - n + start) + (float)(n + b->column);
    return (box_columns){r->to_center_x[i] + m, r->ref[i] + m * r->step_x[i]};
}

/* Taps of a row: what the map holds there, and which of them lie in front of the fragment's plane.
 */
typedef struct box_taps_row {
    vf tap, stored;
    vu occluders;
    vi hits;
} box_taps_row;

static inline ALWAYS_INLINE box_taps_row read_taps_row(const box_batch *batch, size_t i,
                                                       const texel_box *b, vf plane, int start,
                                                       int row) {
    const size_t down = (size_t)row;
    const float *texels = (const float *)(const void *)(b->texels + down * b->stride);
    const uint32_t *occluders =
        (const uint32_t *)(const void *)(b->occluders + down * b->occluder_stride);
    box_taps_row taps;
    taps.tap = plane + (float)(b->row + row) * batch->receivers->step_y[i];
    taps.stored = (batch->reversed ? -1.0f : 1.0f) * vf_load(texels + start);
    memcpy(&taps.occluders, occluders + start, sizeof taps.occluders);
    taps.hits = taps.stored < taps.tap;
    if (batch->map->info.occluders == SHB_OCCLUDERS_PLANES)
        taps.hits &= taps.stored < shb_far_depth(batch->reversed);
    return taps;
}

/* The fragment's plane, as the map stores depth, at taps whose occluder shadows the fragment. */
static void give_mutual_taps(box_batch *batch, size_t i, const texel_box *b) {
    const shb_receivers *r = batch->receivers;
    const int n = batch->size[i];
    const float sign = batch->reversed ? -1.0f : 1.0f;
    const bool triangles = batch->map->info.occluders == SHB_OCCLUDERS_TRIANGLES;
    const mutual_lanes own = mutual_lanes_of_one(batch->mutual, i);
    for (int start = 0; start < n; start += WIDE) {
        const box_columns columns = box_columns_of(batch, i, b, start);
        const mutual_way to_x = mutual_way_of(&own, own.moved_x, columns.to_x);
        for (int row = 0; row < n; row++) {
            const box_taps_row taps = read_taps_row(batch, i, b, columns.plane, start, row);
            const float down = r->to_center_y[i] + (float)(b->row + row);
            vi shadowed = taps.hits;
            if (vi_any(shadowed) && triangles)
                shadowed = shadowed_by_triangles(batch->mutual, i, 0, shadowed, taps.occluders,
                                                 columns.to_x, vf_splat(down));
            else if (vi_any(shadowed))
                shadowed &=
                    passes_in_front(&own, to_x, mutual_way_of(&own, own.moved_y, vf_splat(down)),
                                    taps.stored, taps.occluders);
            vf_store(batch->given + row * BOX_PITCH + start,
                     vf_where(shadowed, sign * taps.tap, vf_splat(NAN)));
        }
    }
}

/* True if the steepest and the deepest of the taps in front of the fragment's plane tell for all of
 * them that their planes pass in front of the fragment, column by column. Each operation grows with
 * what it works on, and so does its rounding: the answer is that of passes_in_front for each tap.
 */
static bool all_pass_in_front(const box_batch *batch, size_t i, const texel_box *b) {
    const int n = batch->size[i];
    const float *to_center_y = &batch->receivers->to_center_y[i];
    const mutual_lanes own = mutual_lanes_of_one(batch->mutual, i);
    const float above = fabsf(*to_center_y + (float)b->row);
    const float below = fabsf(*to_center_y + (float)(b->row + n - 1));
    const mutual_way to_y =
        mutual_way_of(&own, own.moved_y, vf_splat(above > below ? above : below));
    for (int start = 0; start < n; start += WIDE) {
        const box_columns columns = box_columns_of(batch, i, b, start);
        const mutual_way to_x = mutual_way_of(&own, own.moved_x, columns.to_x);
        vf deepest = vf_splat(-INFINITY), steep_x = {0}, steep_y = {0};
        for (int row = 0; row < n; row++) {
            const box_taps_row taps = read_taps_row(batch, i, b, columns.plane, start, row);
            const vu occluders = taps.occluders & (vu)taps.hits;
            deepest = vf_max(deepest, vf_where(taps.hits, taps.stored, vf_splat(-INFINITY)));
            steep_x = vf_max(steep_x, (vf)(occluders << 16 & HALF_SIZE));
            steep_y = vf_max(steep_y, (vf)(occluders & HALF_SIZE));
        }
        const vf size_x = half_size((vu)steep_x), size_y = half_size((vu)steep_y);
        const vf fall = size_x * (vf_abs(to_x.to) + to_x.miss) + size_y * (to_y.to + to_y.miss);
        const vi pass =
            ((own.z - deepest) - fall > own.base) & (vf_max(size_x, size_y) < HALF_INFINITY);
        if (vi_any(~pass & (deepest > -INFINITY)))
            return false;
    }
    return true;
}

static NEVER_INLINE float count_mutual(box_batch *batch, size_t i) {
    texel_box b;
    if (!find_box(batch, i, &b))
        return 1;
    give_mutual_taps(batch, i, &b);
    return count_given(batch, i, &b);
}

/* Boxes whose texels all lie behind the fragment's plane are lit, and many others are told by their
 * extremes. */
static void count_planes(box_batch *batch, size_t count, float *visibility) {
    count_inside(batch, count, visibility);
    for (size_t i = 0; i < count; i++) {
        texel_box b;
        if (batch->inside[i] && visibility[i] == 1)
            continue;
        if (!batch->inside[i] || !find_box(batch, i, &b) || !all_pass_in_front(batch, i, &b))
            visibility[i] = count_mutual(batch, i);
    }
}

static void pcf_exact(const shb_filter_args *args) {
    mutual_batch mutual;
    box_batch batch;
    exact_boxes_init(args, 1, &mutual, &batch);
    if (args->map->info.occluders == SHB_OCCLUDERS_PLANES)
        count_planes(&batch, args->count, args->visibility);
    else
        for (size_t i = 0; i < args->count; i++)
            args->visibility[i] = count_mutual(&batch, i);
    fill_lanes(args->count, args->visibility);
}

static void pcf_smooth_exact(const shb_filter_args *args) {
    mutual_batch mutual;
    box_batch batch;
    exact_boxes_init(args, 2, &mutual, &batch);
    batch.kind = TAPS_GIVEN;
    for (size_t i = 0; i < args->count; i++) {
        texel_box b;
        const bool inside = find_box(&batch, i, &b);
        if (inside)
            give_mutual_taps(&batch, i, &b);
        args->visibility[i] = inside ? weigh_one(&batch, i, &b) : 1.0f;
    }
    fill_lanes(args->count, args->visibility);
}
