/* Points that name their triangle and weights, placed on it in double. */

/* A triangle's first corner and the ways from there to the others, and how far positions may be
 * off. */
typedef struct triangle_lanes {
    wd corner[3], way_1[3], way_2[3], slack[3];
} triangle_lanes;

/* The fourth double that is read of a vertex belongs to the next one. */
static inline ALWAYS_INLINE triangle_lanes read_triangles(const shb_drawn_mesh *mesh,
                                                          const uint32_t *ids) {
    const double *from[3][DOUBLES];
    wd a[4], b[4], c[4];
    for (size_t i = 0; i < DOUBLES; i++)
        for (int k = 0; k < 3; k++)
            from[k][i] = mesh->vertices[mesh->corners[ids[i]][k]];
    wd_read_quads(from[0], a);
    wd_read_quads(from[1], b);
    wd_read_quads(from[2], c);
    triangle_lanes t;
    for (int k = 0; k < 3; k++) {
        t.corner[k] = a[k];
        t.way_1[k] = b[k] - a[k];
        t.way_2[k] = c[k] - a[k];
        t.slack[k] = SHB_POSITION_SLACK * (wd_abs(a[k]) + wd_abs(b[k]) + wd_abs(c[k])) +
                     SHB_POSITION_STEP;
    }
    return t;
}

/* The last weight fills up the lanes. */
static inline ALWAYS_INLINE wd read_weights(const float *weights, size_t left) {
    SHB_ALIGN float last[DOUBLES];
    if (left >= DOUBLES)
        return wd_load_floats(weights);
    for (size_t i = 0; i < DOUBLES; i++)
        last[i] = weights[i < left ? i : left - 1];
    return wd_load_floats(last);
}

/* Whole vectors are read. */
static inline ALWAYS_INLINE bool are_below(const uint32_t *ids, size_t count, uint32_t limit) {
    vi beyond = {0};
    for (size_t i = 0; i < count; i += WIDE)
        beyond |= vu_load(ids + i) >= limit;
    return !vi_any(beyond);
}

/* Neighbours often share their triangles. */
static bool place_on_triangles(const shb_drawn_mesh *mesh, const float *weight_1,
                               const float *weight_2, const shb_receivers *restrict r,
                               shb_exact_points *restrict points) {
    const float *const positions[3] = {r->x, r->y, r->z};
    double *const places[3] = {points->x, points->y, points->z};
    const uint32_t *ids = points->own_ids;
    if (!are_below(ids, points->count, (uint32_t)mesh->triangle_count))
        return false;
    triangle_lanes t = read_triangles(mesh, ids);
    wd agreed = wd_splat(1.0);
    for (size_t i = 0; i < points->count; i += DOUBLES) {
        if (i > 0 && memcmp(ids + i, ids + i - DOUBLES, DOUBLES * sizeof *ids) != 0)
            t = read_triangles(mesh, ids + i);
        const wd one = read_weights(weight_1 + i, points->count - i);
        const wd two = read_weights(weight_2 + i, points->count - i);
        for (int k = 0; k < 3; k++) {
            const wd place = t.corner[k] + (t.way_1[k] * one + t.way_2[k] * two);
            const wd off = wd_abs(place - wd_load_floats(positions[k] + i));
            wd_store(places[k] + i, place);
            agreed = wd_where_equal(wd_max(t.slack[k], off), t.slack[k], agreed, wd_splat(0.0));
        }
    }
    return wd_greater_bits(agreed, wd_splat(0.0)) == (1u << DOUBLES) - 1;
}
