/* The exact method on maps that keep triangles, as far as the nearest sample's triangle tells it:
 * most fragments lie on it, or behind it. All of it says what a walk from there would. */

/* What the rows' products can be off by at a place of the scene: 8 roundings of double each. */
static inline ALWAYS_INLINE double row_error(const shb_list_frame *frame, int k) {
    return 8 * SHB_DOUBLE_ROUNDING * shb_list_row_size(frame->rows[k], frame->reach);
}

/* (1) and (2) of light_point.h, for points that may be off by rounding. */
static inline ALWAYS_INLINE void bound_errors(const shb_map *map, bool affine, double rounding,
                                              shb_walk_group *g) {
    const shb_list_frame *frame = &map->occluders.mesh.frame;
    const double *row_w = map->rows.w;
    const double by_x = row_error(frame, 0), by_y = row_error(frame, 1);
    const double by_z = row_error(frame, 2), by_w = row_error(frame, 3);
    const wd zero = wd_splat(0.0), one = wd_splat(1.0);
    for (size_t i = 0; i < SHB_LIST_GROUP; i += DOUBLES) {
        const wd inverse_w = wd_load(g->at.inverse_w + i);
        wd by_position = rounding * inverse_w * (1 + 0x1p-10);
        if (!affine) {
            const wd size = wd_abs(row_w[0] * wd_load(g->at.world[0] + i)) +
                            wd_abs(row_w[1] * wd_load(g->at.world[1] + i)) +
                            wd_abs(row_w[2] * wd_load(g->at.world[2] + i));
            const wd moved_w = rounding * inverse_w * size;
            const wd left = wd_where_greater(one, moved_w, one - moved_w, zero);
            by_position = rounding * inverse_w * ((1 + 0x1p-10 + 2.0 * moved_w) / left);
        }
        const wd noise = inverse_w * wd_load(g->at.scale + i);
        wd_store(g->by_position + i, by_position);
        wd_store(g->error_x + i, noise * (by_x + wd_abs(wd_load(g->at.x + i)) * by_w));
        wd_store(g->error_y + i, noise * (by_y + wd_abs(wd_load(g->at.y + i)) * by_w));
        wd_store(g->error_z + i, noise * (by_z + wd_abs(wd_load(g->at.depth + i)) * by_w));
    }
}

static NEVER_INLINE void read_samples_at_border(const shb_map *map, shb_walk_group *g, size_t i) {
    for (int k = 0; k < 4; k++) {
        const int32_t column = g->left[i] + (k & 1), row = g->top[i] + (k >> 1);
        const bool inside = (uint32_t)column < map->info.width && (uint32_t)row < map->info.height;
        g->samples[k][i] = inside ? shb_occluder_row(map, row)[column] : SHB_ID_NONE;
    }
}

/* Texels and triangles come from all over the memory: they are asked for before any is read. */
static inline ALWAYS_INLINE void fetch_samples(const shb_map *map, shb_walk_group *g) {
    for (size_t i = 0; i < SHB_LIST_GROUP; i++) {
        g->left[i] = g->at.column[i] - (g->at.x[i] - g->at.column[i] < 0.5);
        g->top[i] = g->at.row[i] - (g->at.y[i] - g->at.row[i] < 0.5);
    }
    for (size_t i = 0; i < g->count; i++) {
        const int32_t column = g->left[i] > 0 ? g->left[i] : 0, row = g->top[i] > 0 ? g->top[i] : 0;
        const uint32_t *texel = shb_occluder_row(map, row) + column;
        __builtin_prefetch(texel);
        __builtin_prefetch((const char *)texel + map->occluders.stride);
    }
}

/* The triangles of the nearest samples, field by field. */
typedef struct nearest_lanes {
    SHB_ALIGN double x[3][SHB_LIST_GROUP];
    double y[3][SHB_LIST_GROUP];
    double z[SHB_LIST_GROUP], slope_x[SHB_LIST_GROUP], slope_y[SHB_LIST_GROUP];
    double error[SHB_LIST_GROUP];
    uint32_t ids[SHB_LIST_GROUP], marks[SHB_LIST_GROUP], beyond[3][SHB_LIST_GROUP];
    uint64_t whole; /* one bit each: there is one that is seen as a whole */
    uint64_t named; /* it is known to be the point's own */
} nearest_lanes;

static inline ALWAYS_INLINE void read_samples(const shb_map *map, shb_walk_group *g,
                                              nearest_lanes *lanes) {
    const uint32_t last_column = map->info.width - 1, last_row = map->info.height - 1;
    const size_t stride = map->occluders.stride / sizeof(uint32_t);
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i++) {
        const int32_t left = g->left[i], top = g->top[i];
        if ((uint32_t)left < last_column && (uint32_t)top < last_row) {
            const uint32_t *texel = shb_occluder_row(map, top) + left;
            g->samples[0][i] = texel[0];
            g->samples[1][i] = texel[1];
            g->samples[2][i] = texel[stride];
            g->samples[3][i] = texel[stride + 1];
        } else {
            read_samples_at_border(map, g, i);
        }
        g->nearest[i] = (uint8_t)((g->at.column[i] - left) + 2 * (g->at.row[i] - top));
        const uint32_t id = g->samples[g->nearest[i]][i];
        lanes->ids[i] = id;
        if (id != SHB_ID_NONE) {
            __builtin_prefetch(&map->occluders.mesh.triangles[id]);
            __builtin_prefetch(&map->occluders.planes[id]);
        }
    }
}

static inline ALWAYS_INLINE void read_triangles(const shb_map *map, const shb_walk_group *g,
                                                nearest_lanes *lanes) {
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i++) {
        const uint32_t id = lanes->ids[i] == SHB_ID_NONE ? 0 : lanes->ids[i];
        const shb_walk_triangle *t = &map->occluders.mesh.triangles[id];
        const shb_occluder_plane *plane = &map->occluders.planes[id];
        for (int k = 0; k < 3; k++) {
            lanes->x[k][i] = t->x[k];
            lanes->y[k][i] = t->y[k];
            lanes->beyond[k][i] = t->beyond[k];
        }
        lanes->marks[i] = t->marks;
        lanes->z[i] = plane->z;
        lanes->slope_x[i] = plane->slope_x;
        lanes->slope_y[i] = plane->slope_y;
        lanes->error[i] = plane->error;
    }
}

/* Of WIDE points those whose samples are all the same triangle, or go on beyond its edges. */
static inline ALWAYS_INLINE vi joined_mask(const shb_walk_group *g, const nearest_lanes *lanes,
                                           size_t i) {
    const vu ids = vu_load(lanes->ids + i), marks = vu_load(lanes->marks + i);
    vu joined[3];
    vi strange = {0};
    for (uint32_t k = 0; k < 3; k++) {
        const vu ends = (vu)((marks & SHB_EDGE_JOINED << k) == 0);
        joined[k] = ((vu_load(lanes->beyond[k] + i) >> 3) & ~ends) | (ids & ends);
    }
    for (int k = 0; k < 4; k++) {
        const vu sample = vu_load(g->samples[k] + i);
        strange |=
            (sample != ids) & (sample != joined[0]) & (sample != joined[1]) & (sample != joined[2]);
    }
    return ~strange;
}

static inline ALWAYS_INLINE void judge_triangles(shb_walk_group *g, nearest_lanes *lanes) {
    const uint32_t seen = 7 * SHB_CORNER_SEEN;
    lanes->whole = lanes->named = g->joined = g->inside = 0;
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += WIDE) {
        const vu ids = vu_load(lanes->ids + i), marks = vu_load(lanes->marks + i);
        const vi inside = vi_load(g->at.column + i) >= 0;
        const vi whole = inside & ((marks & seen) == seen) & (ids != SHB_ID_NONE);
        g->inside |= (uint64_t)vi_bits(inside) << i;
        lanes->whole |= (uint64_t)vi_bits(whole) << i;
        lanes->named |= (uint64_t)vi_bits(ids == vu_load(g->own_ids + i)) << i;
        g->joined |= (uint64_t)vi_bits(joined_mask(g, lanes, i)) << i;
    }
    g->inside &= UINT64_MAX >> (SHB_LIST_GROUP - g->count);
    lanes->whole &= g->inside;
}

/* Positive on the left of the way from a to b. */
static inline ALWAYS_INLINE wd side_at(const nearest_lanes *lanes, size_t i, int a, int b, wd x,
                                       wd y) {
    const wd a_x = wd_load(lanes->x[a] + i), a_y = wd_load(lanes->y[a] + i);
    return (wd_load(lanes->x[b] + i) - a_x) * (y - a_y) -
           (wd_load(lanes->y[b] + i) - a_y) * (x - a_x);
}

/* Bits of the lanes whose triangles cover the points' places, as exact_walk.c tells it. */
static inline ALWAYS_INLINE uint32_t covered_bits(const nearest_lanes *lanes, size_t i, wd x,
                                                  wd y) {
    const wd zero = wd_splat(0.0);
    const wd area = side_at(lanes, i, 0, 1, wd_load(lanes->x[2] + i), wd_load(lanes->y[2] + i));
    const wd u = side_at(lanes, i, 0, 1, x, y), v = side_at(lanes, i, 1, 2, x, y);
    const wd w = -side_at(lanes, i, 0, 2, x, y);
    const wd least = wd_min(wd_min(u, v), w), most = wd_max(wd_max(u, v), w);
    return (wd_greater_bits(area, zero) & ~wd_greater_bits(zero, least)) |
           (wd_greater_bits(zero, area) & ~wd_greater_bits(most, zero));
}

/* The vectors C - slope_x A - slope_y B of (1) have Tz - slope_x Tx - slope_y Ty - (Z - slope_x X -
 * slope_y Y) Tw. */
static inline ALWAYS_INLINE wd plane_error(const shb_light_rows *rows, bool affine,
                                           const shb_walk_group *g, const nearest_lanes *lanes,
                                           size_t i) {
    const wd slope_x = wd_load(lanes->slope_x + i), slope_y = wd_load(lanes->slope_y + i);
    const wd at_origin = (wd_load(g->at.depth + i) - slope_x * wd_load(g->at.x + i)) -
                         slope_y * wd_load(g->at.y + i);
    wd error = wd_load(lanes->error + i) +
               ((wd_load(g->error_z + i) + wd_abs(slope_x) * wd_load(g->error_x + i)) +
                wd_abs(slope_y) * wd_load(g->error_y + i));
    for (int k = 0; k < 3; k++) {
        wd row = wd_splat(rows->z[k]);
        if (!affine)
            row -= at_origin * rows->w[k];
        error += wd_abs(row - (slope_x * rows->x[k] + slope_y * rows->y[k])) *
                 (wd_load(g->by_position + i) * wd_abs(wd_load(g->at.world[k] + i)));
    }
    return error;
}

static inline ALWAYS_INLINE void compare_nearest(const shb_map *map, bool affine,
                                                 const nearest_lanes *lanes, shb_walk_group *g) {
    const shb_light_rows rows = map->rows;
    uint64_t covered = 0, in_front = 0, behind = 0, known = 0;
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += DOUBLES) {
        const wd x = wd_load(g->at.x + i), y = wd_load(g->at.y + i);
        const wd plane = (wd_load(lanes->z + i) + wd_load(lanes->slope_x + i) * x) +
                         wd_load(lanes->slope_y + i) * y;
        const wd depth = wd_load(g->at.depth + i) - plane;
        const wd error = plane_error(&rows, affine, g, lanes, i);
        covered |= (uint64_t)covered_bits(lanes, i, x, y) << i;
        known |= (uint64_t)wd_greater_bits(wd_splat((double)INFINITY), error) << i;
        in_front |= (uint64_t)wd_greater_bits(depth, error) << i;
        behind |= (uint64_t)wd_greater_bits(-error, depth) << i;
    }
    covered &= lanes->whole;
    known &= ~lanes->named;
    g->in_front = covered & known & in_front;
    g->behind = covered & known & behind;
    g->own = covered & (lanes->named | (known & ~in_front & ~behind));
}

static inline ALWAYS_INLINE void ask_nearest_as(const shb_map *map, bool affine, double rounding,
                                                shb_walk_group *g) {
    nearest_lanes lanes;
    fetch_samples(map, g);
    bound_errors(map, affine, rounding, g);
    read_samples(map, g, &lanes);
    read_triangles(map, g, &lanes);
    judge_triangles(g, &lanes);
    compare_nearest(map, affine, &lanes, g);
}

static void ask_nearest(const shb_map *map, double rounding, shb_walk_group *g) {
    if (map->projection.affine)
        ask_nearest_as(map, true, rounding, g);
    else
        ask_nearest_as(map, false, rounding, g);
}
