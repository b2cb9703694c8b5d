/* Boxes of texels by the exact method: where a map keeps planes, k_plane_boxes.inl; and where it
 * keeps triangles. */

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
    store_planes(&mutual->receivers, shb_round_to_lanes(args->count), batch);
}

/* One fragment's box, where the map keeps triangles. */
typedef struct exact_box {
    mutual_batch *mutual;
    size_t fragment;
    int n;
    texel_box texels;
    float ref, step_x, step_y, to_center_x, to_center_y;
} exact_box;

/* False: the box lies outside the map. */
static inline ALWAYS_INLINE bool find_box(box_batch *batch, size_t i, exact_box *box) {
    const shb_receivers *r = batch->receivers;
    if (batch->place[i] >= 0) {
        box->texels = exact_box_in_place(batch, i);
        box->texels.given = batch->given;
    } else if (!copy_box(batch, i, &box->texels)) {
        return false;
    }
    box->mutual = batch->mutual;
    box->fragment = i;
    box->n = batch->size[i];
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
} box_columns;

static inline ALWAYS_INLINE box_columns box_columns_from(const exact_box *box, int start) {
    const vf m = vf_load(columns_from_end + BOX_PITCH - box->n + start) +
                 (float)(box->n + box->texels.column);
    return (box_columns){start, box->ref + m * box->step_x, box->to_center_x + m};
}

/* Taps of a row; tap: the fragment's plane there. */
static inline ALWAYS_INLINE vi shadowed_in_row(const exact_box *box, const box_columns *columns,
                                               int row, bool reversed, vf *tap) {
    const texel_box *b = &box->texels;
    const size_t below = (size_t)row;
    const float *texels = (const float *)(const void *)(b->texels + below * b->stride);
    const char *occluders = b->occluders + below * b->occluder_stride;
    const float n = (float)(b->row + row);
    const vf stored = vf_load(texels + columns->start);
    vu triangles;
    memcpy(&triangles, occluders + (size_t)columns->start * sizeof(uint32_t), sizeof triangles);
    *tap = columns->plane + n * box->step_y;
    const vi open = open_to_triangles(box->mutual, box->fragment, 0,
                                      (reversed ? -stored : stored) < *tap, triangles);
    if (!vi_any(open))
        return open;
    return shadowed_by_triangles(box->mutual, box->fragment, 0, open, triangles, columns->to_x,
                                 vf_splat(box->to_center_y + n));
}

static inline ALWAYS_INLINE float count_box_of_triangles(const exact_box *box, bool reversed) {
    vi shadowed = {0};
    for (int start = 0; start < box->n; start += WIDE) {
        const box_columns columns = box_columns_from(box, start);
        vf tap;
        for (int k = 0; k < box->n; k++)
            shadowed -= shadowed_in_row(box, &columns, k, reversed, &tap);
    }
    return box_share(box->n, WIDELY(wi_sum)((WIDELY(wi))shadowed));
}

static inline ALWAYS_INLINE void count_triangles(box_batch *batch, size_t count, bool reversed,
                                                 float *visibility) {
    for (size_t i = 0; i < count; i++) {
        exact_box box;
        visibility[i] = find_box(batch, i, &box) ? count_box_of_triangles(&box, reversed) : 1.0f;
    }
}

static void pcf_exact(const shb_filter_args *args) {
    mutual_batch mutual;
    box_batch batch;
    exact_boxes_init(args, 1, &mutual, &batch);
    if (args->map->info.occluders != SHB_OCCLUDERS_TRIANGLES)
        ask_plane_boxes(&batch, false, args->count, args->visibility);
    else if (batch.reversed)
        count_triangles(&batch, args->count, true, args->visibility);
    else
        count_triangles(&batch, args->count, false, args->visibility);
    fill_lanes(args->count, args->visibility);
}

/* The fragment's plane, as the map stores depth, at taps whose occluder shadows the fragment. */
static void give_exact_taps(const exact_box *box, bool reversed, float *given) {
    for (int start = 0; start < box->n; start += WIDE) {
        const box_columns columns = box_columns_from(box, start);
        for (int k = 0; k < box->n; k++) {
            vf tap;
            const vi shadowed = shadowed_in_row(box, &columns, k, reversed, &tap);
            vf_store(given + k * BOX_PITCH + start,
                     vf_where(shadowed, reversed ? -tap : tap, vf_splat(NAN)));
        }
    }
}

static void weigh_triangles(box_batch *batch, size_t count, float *visibility) {
    batch->kind = TAPS_GIVEN;
    for (size_t i = 0; i < count; i++) {
        exact_box box;
        const bool inside = find_box(batch, i, &box);
        if (inside)
            give_exact_taps(&box, batch->reversed, batch->given);
        visibility[i] = inside ? weigh_one(batch, i, &box.texels) : 1.0f;
    }
}

static void pcf_smooth_exact(const shb_filter_args *args) {
    mutual_batch mutual;
    box_batch batch;
    exact_boxes_init(args, 2, &mutual, &batch);
    if (args->map->info.occluders == SHB_OCCLUDERS_TRIANGLES)
        weigh_triangles(&batch, args->count, args->visibility);
    else
        ask_plane_boxes(&batch, true, args->count, args->visibility);
    fill_lanes(args->count, args->visibility);
}
