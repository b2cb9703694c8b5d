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
    store_planes(&mutual->receivers, false, shb_round_to_lanes(args->count), batch);
}

/* One fragment's box. */
typedef struct exact_box {
    mutual_batch *mutual;
    size_t fragment;
    int n;
    texel_box texels;
    mutual_lanes own;
    float ref, step_x, step_y, to_center_x, to_center_y;
} exact_box;

/* False: the box lies outside the map. */
static inline ALWAYS_INLINE bool find_box(box_batch *batch, size_t i, exact_box *box) {
    const shb_receivers *r = batch->receivers;
    if (batch->place[i] >= 0) {
        texel_box *b = &box->texels;
        *b = box_in_place(batch, i);
        b->given = batch->given;
        b->occluders = (const char *)(shb_occluder_row(batch->map, batch->top[i]) + batch->left[i]);
        b->occluder_stride = batch->map->occluders.stride;
    } else if (!copy_box(batch, i, &box->texels)) {
        return false;
    }
    box->mutual = batch->mutual;
    box->fragment = i;
    box->n = batch->size[i];
    box->own = mutual_lanes_of_one(batch->mutual, i);
    box->ref = r->ref[i];
    box->step_x = r->step_x[i];
    box->step_y = r->step_y[i];
    box->to_center_x = r->to_center_x[i];
    box->to_center_y = r->to_center_y[i];
    return true;
}

/* WIDE columns of a box. */
typedef struct box_columns {
    int start;
    vf plane; /* of the fragment, in its own row; NaN beyond the box */
    vf to_x;  /* from the fragment, texels */
    mutual_way way_x;
} box_columns;

static inline ALWAYS_INLINE box_columns box_columns_from(const exact_box *box, int start) {
    const vf m = vf_load(columns_from_end + BOX_PITCH - box->n + start) +
                 (float)(box->n + box->texels.column);
    const vf to_x = box->to_center_x + m;
    return (box_columns){start, box->ref + m * box->step_x, to_x,
                         mutual_way_of(&box->own, box->own.moved_x, to_x)};
}

/* Taps of a row: what the map holds there, and which of them lie in front of the fragment's plane
 * (where the map keeps triangles: and are to be asked). */
typedef struct box_row {
    float to_y;
    vf tap, stored;
    vu occluders;
    vi hits;
} box_row;

static inline ALWAYS_INLINE box_row read_box_row(const exact_box *box, const box_columns *columns,
                                                 int row, bool triangles, bool reversed) {
    const texel_box *b = &box->texels;
    const size_t below = (size_t)row;
    const float *texels = (const float *)(const void *)(b->texels + below * b->stride);
    const char *occluders = b->occluders + below * b->occluder_stride;
    const float n = (float)(b->row + row);
    box_row made = {.to_y = box->to_center_y + n, .tap = columns->plane + n * box->step_y};
    const vf stored = vf_load(texels + columns->start);
    made.stored = reversed ? -stored : stored;
    memcpy(&made.occluders, occluders + (size_t)columns->start * sizeof(uint32_t),
           sizeof made.occluders);
    made.hits = made.stored < made.tap;
    if (triangles)
        made.hits = open_to_triangles(box->mutual, box->fragment, 0, made.hits, made.occluders);
    else
        made.hits &= made.stored < shb_far_depth(reversed);
    return made;
}

static inline ALWAYS_INLINE vi shadowed_in_row(const exact_box *box, const box_columns *columns,
                                               const box_row *row, bool triangles) {
    if (!vi_any(row->hits))
        return row->hits;
    const vf to_y = vf_splat(row->to_y);
    if (triangles)
        return shadowed_by_triangles(box->mutual, box->fragment, 0, row->hits, row->occluders,
                                     columns->to_x, to_y);
    return row->hits & passes_in_front(&box->own, columns->way_x,
                                       mutual_way_of(&box->own, box->own.moved_y, to_y),
                                       row->stored, row->occluders);
}

static inline ALWAYS_INLINE float count_exact(const exact_box *box, bool triangles, bool reversed) {
    vi shadowed = {0};
    for (int start = 0; start < box->n; start += WIDE) {
        const box_columns columns = box_columns_from(box, start);
        for (int k = 0; k < box->n; k++) {
            const box_row row = read_box_row(box, &columns, k, triangles, reversed);
            shadowed -= shadowed_in_row(box, &columns, &row, triangles);
        }
    }
    return box_share(box->n, WIDELY(wi_sum)((WIDELY(wi))shadowed));
}

/* True if the steepest and the deepest of the taps in front of the fragment's plane tell for all of
 * them that their planes pass in front of the fragment, column by column. Each operation grows with
 * what it works on, and so does its rounding: the answer is that of passes_in_front for each tap.
 */
static inline ALWAYS_INLINE bool all_pass_in_front(const exact_box *box, bool reversed) {
    const float above = fabsf(box->to_center_y + (float)box->texels.row);
    const float below = fabsf(box->to_center_y + (float)(box->texels.row + box->n - 1));
    const mutual_way way_y =
        mutual_way_of(&box->own, box->own.moved_y, vf_splat(above > below ? above : below));
    for (int start = 0; start < box->n; start += WIDE) {
        const box_columns columns = box_columns_from(box, start);
        const mutual_way way_x = columns.way_x;
        vf deepest = vf_splat(-INFINITY), steep_x = {0}, steep_y = {0};
        for (int k = 0; k < box->n; k++) {
            const box_row row = read_box_row(box, &columns, k, false, reversed);
            const vu occluders = row.occluders & (vu)row.hits;
            deepest = vf_max(deepest, vf_where(row.hits, row.stored, vf_splat(-INFINITY)));
            steep_x = vf_max(steep_x, (vf)(occluders << 16 & HALF_SIZE));
            steep_y = vf_max(steep_y, (vf)(occluders & HALF_SIZE));
        }
        const vf size_x = half_size((vu)steep_x), size_y = half_size((vu)steep_y);
        const vf fall = size_x * (vf_abs(way_x.to) + way_x.miss) + size_y * (way_y.to + way_y.miss);
        const vi pass = ((box->own.z - deepest) - fall > box->own.base) &
                        (vf_max(size_x, size_y) < HALF_INFINITY);
        if (vi_any(~pass & (deepest > -INFINITY)))
            return false;
    }
    return true;
}

/* Boxes whose texels all lie behind the fragment's plane are lit, and most dark ones are told by
 * their extremes. */
static inline ALWAYS_INLINE void count_planes(box_batch *batch, size_t count, bool reversed,
                                              float *visibility) {
    count_inside(batch, count, visibility);
    for (size_t i = 0; i < count; i++) {
        exact_box box;
        const bool inside = batch->place[i] >= 0;
        if (inside && visibility[i] == 1)
            continue;
        if (!find_box(batch, i, &box))
            visibility[i] = 1;
        else if (!(inside && visibility[i] < 0.5f && all_pass_in_front(&box, reversed)))
            visibility[i] = count_exact(&box, false, reversed);
    }
}

static inline ALWAYS_INLINE void count_triangles(box_batch *batch, size_t count, bool reversed,
                                                 float *visibility) {
    for (size_t i = 0; i < count; i++) {
        exact_box box;
        visibility[i] = find_box(batch, i, &box) ? count_exact(&box, true, reversed) : 1.0f;
    }
}

static void pcf_exact(const shb_filter_args *args) {
    const bool triangles = args->map->info.occluders == SHB_OCCLUDERS_TRIANGLES;
    mutual_batch mutual;
    box_batch batch;
    exact_boxes_init(args, 1, &mutual, &batch);
    if (triangles && batch.reversed)
        count_triangles(&batch, args->count, true, args->visibility);
    else if (triangles)
        count_triangles(&batch, args->count, false, args->visibility);
    else if (batch.reversed)
        count_planes(&batch, args->count, true, args->visibility);
    else
        count_planes(&batch, args->count, false, args->visibility);
    fill_lanes(args->count, args->visibility);
}

/* The fragment's plane, as the map stores depth, at taps whose occluder shadows the fragment. */
static void give_exact_taps(const exact_box *box, bool triangles, bool reversed, float *given) {
    for (int start = 0; start < box->n; start += WIDE) {
        const box_columns columns = box_columns_from(box, start);
        for (int k = 0; k < box->n; k++) {
            const box_row row = read_box_row(box, &columns, k, triangles, reversed);
            const vi shadowed = shadowed_in_row(box, &columns, &row, triangles);
            vf_store(given + k * BOX_PITCH + start,
                     vf_where(shadowed, reversed ? -row.tap : row.tap, vf_splat(NAN)));
        }
    }
}

static void pcf_smooth_exact(const shb_filter_args *args) {
    const bool triangles = args->map->info.occluders == SHB_OCCLUDERS_TRIANGLES;
    mutual_batch mutual;
    box_batch batch;
    exact_boxes_init(args, 2, &mutual, &batch);
    batch.kind = TAPS_GIVEN;
    for (size_t i = 0; i < args->count; i++) {
        exact_box box;
        const bool inside = find_box(&batch, i, &box);
        if (inside)
            give_exact_taps(&box, triangles, batch.reversed, batch.given);
        args->visibility[i] = inside ? weigh_one(&batch, i, &box.texels) : 1.0f;
    }
    fill_lanes(args->count, args->visibility);
}
