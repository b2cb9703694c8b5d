/* Vertices to the world and to the light, as mat4_transform_point and shb_list_row do it. */

typedef struct seen_vertices {
    wd seen[4]; /* x, y, z, inverse_w */
    wd flaw;    /* 0, or NaN: drawing would leave out what has this vertex */
} seen_vertices;

static inline wd list_row_of(const double row[4], const wd p[3]) {
    return ((wd_splat(row[0]) * p[0] + wd_splat(row[1]) * p[1]) + wd_splat(row[2]) * p[2]) +
           wd_splat(row[3]);
}

/* What is too large becomes NaN, and all that is not finite does by the difference with itself. */
static inline wd list_flaw(wd value) {
    const wd usable =
        wd_where_greater(wd_abs(value), wd_splat(SHB_CLIP_MAX), wd_splat((double)NAN), value);
    return usable - usable;
}

static inline seen_vertices see(const shb_list_frame *frame, const wd world[3]) {
    const wd none = wd_splat(0);
    wd clip[4];
    for (int r = 0; r < 4; r++)
        clip[r] = list_row_of(frame->rows[r], world);
    const wd flaw =
        (list_flaw(clip[0]) + list_flaw(clip[1])) + (list_flaw(clip[2]) + list_flaw(clip[3]));
    const wd behind = clip[2] - wd_splat(frame->near_depth) * clip[3];
    wd inverse = wd_splat(1) / clip[3];
    inverse = wd_where_greater(wd_splat(SHB_W_MIN), clip[3], none, inverse);
    inverse = wd_where_greater(none, behind, none, inverse);
    inverse = wd_where_equal(flaw, none, inverse, none);
    seen_vertices out = {.flaw = flaw};
    for (int k = 0; k < 3; k++)
        out.seen[k] = wd_where_greater(inverse, none, clip[k] * inverse, none);
    out.seen[3] = inverse + flaw;
    return out;
}

/* The least lane of each of a vector. */
static inline double least_lane(wd v) {
    SHB_ALIGN double lanes[LIST_LANES];
    wd_store(lanes, v);
    double least = lanes[0];
    for (int i = 1; i < DOUBLES; i++)
        least = double_min(lanes[i], least);
    return least;
}

static void see_vertices(const shb_list_frame *frame, const shb_mat4 *transform,
                         shb_list_places *restrict places, shb_list_vertex *restrict vertices,
                         shb_list_extent *extent) {
    const shb_list_frame f = *frame;
    const wd none = wd_splat(0);
    wd m[4][3], reach = none, nearest = wd_splat(DBL_MAX), farthest = wd_splat(-DBL_MAX);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            m[i][k] = wd_splat(transform->m[4 * i + k]);
    for (int i = 0; i < SHB_LIST_GROUP; i += DOUBLES) {
        wd mesh[3], world[3];
        for (int k = 0; k < 3; k++)
            mesh[k] = wd_load_floats(places->mesh[k] + i);
        for (int k = 0; k < 3; k++) {
            world[k] = ((m[0][k] * mesh[0] + m[1][k] * mesh[1]) + m[2][k] * mesh[2]) + m[3][k];
            wd_store(places->world[k] + i, world[k]);
        }
        const seen_vertices v = see(&f, world);
        wd_store_quads((double *)(void *)&vertices[i], sizeof *vertices / sizeof(double), v.seen[0],
                       v.seen[1], v.seen[2], v.seen[3]);
        for (int k = 0; k < 3; k++)
            reach = wd_max(wd_where_equal(v.flaw, none, wd_abs(world[k]), none), reach);
        nearest = wd_min(wd_where_greater(v.seen[3], none, v.seen[2], nearest), nearest);
        farthest = wd_max(wd_where_greater(v.seen[3], none, v.seen[2], farthest), farthest);
    }
    extent->reach = double_max(-least_lane(none - reach), extent->reach);
    extent->nearest = double_min(least_lane(nearest), extent->nearest);
    extent->farthest = double_max(-least_lane(none - farthest), extent->farthest);
}
