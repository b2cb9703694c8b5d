/* The exact method on maps that keep triangles, as far as the nearest sample's triangle and one
 * step over the mesh tell it: most fragments lie on what is found there, or behind it. All of it
 * says what ways from all samples would. */

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
        for (int k = 0; k < 3; k++)
            wd_store(g->by_position[k] + i, by_position * wd_abs(wd_load(g->at.world[k] + i)));
        wd_store(g->error_x + i, noise * (by_x + wd_abs(wd_load(g->at.x + i)) * by_w));
        wd_store(g->error_y + i, noise * (by_y + wd_abs(wd_load(g->at.y + i)) * by_w));
        wd_store(g->error_z + i, noise * (by_z + wd_abs(wd_load(g->at.depth + i)) * by_w));
    }
}

/* Texels and triangles come from all over the memory: they are asked for before any is read. */
static inline ALWAYS_INLINE void fetch_samples(const shb_map *map, shb_walk_group *g) {
    for (size_t i = 0; i < SHB_LIST_GROUP; i++) {
        g->beside[i] = g->at.x[i] - g->at.column[i] < 0.5 ? -1 : 1;
        g->above[i] = g->at.y[i] - g->at.row[i] < 0.5 ? -1 : 1;
    }
    for (size_t i = 0; i < g->count; i++) {
        const int32_t column = g->at.column[i] > 0 ? g->at.column[i] : 0, row = g->at.row[i];
        const int32_t other = row + g->above[i];
        __builtin_prefetch(shb_occluder_row(map, row) + column);
        __builtin_prefetch(shb_occluder_row(map, other > 0 ? other : 0) + column);
    }
}

static NEVER_INLINE void read_samples_at_border(const shb_map *map, shb_walk_group *g, size_t i) {
    for (int k = 0; k < 4; k++) {
        const int32_t column = g->at.column[i] + (k & 1 ? g->beside[i] : 0);
        const int32_t row = g->at.row[i] + (k & 2 ? g->above[i] : 0);
        const bool inside = (uint32_t)column < map->info.width && (uint32_t)row < map->info.height;
        g->samples[k][i] = inside ? shb_occluder_row(map, row)[column] : SHB_ID_NONE;
    }
}

static inline ALWAYS_INLINE void read_samples(const shb_map *map, shb_walk_group *g) {
    const uint32_t last_column = map->info.width - 1, last_row = map->info.height - 1;
    const ptrdiff_t stride = (ptrdiff_t)(map->occluders.stride / sizeof(uint32_t));
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i++) {
        const uint32_t column = (uint32_t)g->at.column[i], row = (uint32_t)g->at.row[i];
        if (column - 1 < last_column - 1 && row - 1 < last_row - 1) {
            const uint32_t *texel = shb_occluder_row(map, (int32_t)row) + column;
            const uint32_t *other = texel + g->above[i] * stride;
            const ptrdiff_t beside = g->beside[i];
            g->samples[0][i] = texel[0];
            g->samples[1][i] = texel[beside];
            g->samples[2][i] = other[0];
            g->samples[3][i] = other[beside];
        } else {
            read_samples_at_border(map, g, i);
        }
        const uint32_t id = g->samples[0][i];
        if (id != SHB_ID_NONE) {
            __builtin_prefetch(&map->occluders.mesh.triangles[id]);
            __builtin_prefetch(&map->occluders.planes[id]);
        }
    }
}

/* A triangle for each point, field by field. */
typedef struct triangle_lanes {
    SHB_ALIGN double x[3][SHB_LIST_GROUP];
    double y[3][SHB_LIST_GROUP];
    double z[SHB_LIST_GROUP], slope_x[SHB_LIST_GROUP], slope_y[SHB_LIST_GROUP];
    double error[SHB_LIST_GROUP];
    uint32_t marks[SHB_LIST_GROUP], beyond[3][SHB_LIST_GROUP];
} triangle_lanes;

/* In place of SHB_ID_NONE the first triangle is read. */
static inline ALWAYS_INLINE void read_triangles(const shb_map *map, const uint32_t *ids,
                                                size_t count, triangle_lanes *lanes) {
    for (size_t i = 0; i < shb_round_to_lanes(count); i += DOUBLES) {
        const double *x[DOUBLES], *y_1[DOUBLES];
        wd first[4], last[4];
        for (size_t k = 0; k < DOUBLES; k++) {
            const uint32_t id = ids[i + k] == SHB_ID_NONE ? 0 : ids[i + k];
            const shb_walk_triangle *t = &map->occluders.mesh.triangles[id];
            x[k] = t->x;
            y_1[k] = t->y + 1;
            for (int edge = 0; edge < 3; edge++)
                lanes->beyond[edge][i + k] = t->beyond[edge];
            lanes->marks[i + k] = t->marks;
        }
        wd_read_quads(x, first);
        wd_read_quads(y_1, last);
        for (int k = 0; k < 3; k++)
            wd_store(lanes->x[k] + i, first[k]);
        wd_store(lanes->y[0] + i, first[3]);
        wd_store(lanes->y[1] + i, last[0]);
        wd_store(lanes->y[2] + i, last[1]);
    }
}

static inline ALWAYS_INLINE void read_planes(const shb_map *map, const uint32_t *ids, size_t count,
                                             triangle_lanes *lanes) {
    for (size_t i = 0; i < shb_round_to_lanes(count); i += DOUBLES) {
        const double *planes[DOUBLES];
        wd fields[4];
        for (size_t k = 0; k < DOUBLES; k++)
            planes[k] = &map->occluders.planes[ids[i + k] == SHB_ID_NONE ? 0 : ids[i + k]].z;
        wd_read_quads(planes, fields);
        wd_store(lanes->z + i, fields[0]);
        wd_store(lanes->slope_x + i, fields[1]);
        wd_store(lanes->slope_y + i, fields[2]);
        wd_store(lanes->error + i, fields[3]);
    }
}

/* Of the places of lanes in their triangles, as shb_edges_before tells it. */
typedef struct place_lanes {
    wd to_x[3], to_y[3]; /* from the places to the corners */
    wd beyond[3];        /* positive beyond an ordered edge */
    wd area;             /* of any sign; 0: the triangle covers nothing */
} place_lanes;

static inline ALWAYS_INLINE place_lanes find_places(const shb_walk_group *g,
                                                    const triangle_lanes *lanes, size_t i) {
    const wd zero = wd_splat(0.0), x = wd_load(g->at.x + i), y = wd_load(g->at.y + i);
    place_lanes p;
    for (int k = 0; k < 3; k++) {
        p.to_x[k] = wd_load(lanes->x[k] + i) - x;
        p.to_y[k] = wd_load(lanes->y[k] + i) - y;
    }
    const wd side_0 = p.to_x[1] * p.to_y[2] - p.to_y[1] * p.to_x[2];
    const wd side_1 = p.to_x[0] * p.to_y[2] - p.to_y[0] * p.to_x[2];
    const wd side_2 = p.to_x[0] * p.to_y[1] - p.to_y[0] * p.to_x[1];
    p.area = (side_0 - side_1) + side_2;
    p.beyond[0] = wd_where_greater(zero, p.area, side_0, -side_0);
    p.beyond[1] = wd_where_greater(zero, p.area, -side_1, side_1);
    p.beyond[2] = wd_where_greater(zero, p.area, side_2, -side_2);
    return p;
}

/* Bits of the lanes whose triangles cover the places. */
static inline ALWAYS_INLINE uint32_t covered_bits(const place_lanes *p) {
    const wd zero = wd_splat(0.0);
    const wd farthest = wd_max(wd_max(p->beyond[0], p->beyond[1]), p->beyond[2]);
    return wd_greater_bits(wd_abs(p->area), zero) & ~wd_greater_bits(farthest, zero);
}

/* Of edges one and other of the triangles, the number of the one that ways cross to places beyond
 * both, as shb_edge_crossed. */
static inline ALWAYS_INLINE wd crossed(const wd left[3], int one, int other) {
    return wd_where_greater(left[3 - one - other] * left[one], wd_splat(0.0), wd_splat(one),
                            wd_splat(other));
}

/* The numbers of the edges that ways go on over; 3: none. */
static inline ALWAYS_INLINE wd edges_ahead(const place_lanes *p, wd way_x, wd way_y) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), two = wd_splat(2.0), none = wd_splat(3.0);
    wd left[3]; /* 1 or -1 */
    for (int k = 0; k < 3; k++)
        left[k] = wd_where_greater(zero, way_x * p->to_y[k] - way_y * p->to_x[k], one, -one);
    const wd beyond_0 = wd_where_greater(
        p->beyond[1], zero, wd_where_greater(p->beyond[2], zero, none, crossed(left, 0, 1)),
        wd_where_greater(p->beyond[2], zero, crossed(left, 0, 2), zero));
    const wd within_0 = wd_where_greater(
        p->beyond[1], zero, wd_where_greater(p->beyond[2], zero, crossed(left, 1, 2), one),
        wd_where_greater(p->beyond[2], zero, two, none));
    return wd_where_greater(wd_abs(p->area), zero,
                            wd_where_greater(p->beyond[0], zero, beyond_0, within_0), none);
}

/* The triangles that follow on the ways from samples k, as shb_sheet_next. */
static inline ALWAYS_INLINE void step_over(const shb_walk_group *g, const triangle_lanes *lanes,
                                           int k, uint32_t *next) {
    int32_t edges[SHB_LIST_GROUP];
    const wd half = wd_splat(0.5), one = wd_splat(1.0);
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += DOUBLES) {
        const wd to_x = wd_load(g->at.x + i), to_y = wd_load(g->at.y + i);
        wd from_x = wd_floor(to_x), from_y = wd_floor(to_y);
        if (k & 1)
            from_x += wd_where_greater(half, to_x - from_x, -one, one);
        if (k & 2)
            from_y += wd_where_greater(half, to_y - from_y, -one, one);
        const place_lanes places = find_places(g, lanes, i);
        wd_store_ints(edges + i,
                      edges_ahead(&places, to_x - (from_x + 0.5), to_y - (from_y + 0.5)));
    }
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += WIDE) {
        const vi edge = vi_load(edges + i), marks = vi_load((const int32_t *)lanes->marks + i);
        const vi id = vi_load((const int32_t *)g->samples[k] + i);
        vi to = id;
        for (int e = 0; e < 3; e++) {
            const vi goes = (edge == e) & ((marks & (int32_t)SHB_EDGE_JOINED << e) != 0) &
                            (id != (int32_t)SHB_ID_NONE);
            to = ((vi)(vu_load(lanes->beyond[e] + i) >> 3) & goes) | (to & ~goes);
        }
        vi_store((int32_t *)next + i, to);
    }
}

/* A triangle for each point, and those that go on beyond its edges, or itself. */
typedef struct joined_lanes {
    uint32_t ids[4][SHB_LIST_GROUP];
} joined_lanes;

static inline ALWAYS_INLINE void find_joined(const shb_walk_group *g, const uint32_t *ids,
                                             const triangle_lanes *lanes, joined_lanes *joined) {
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += WIDE) {
        const vu id = vu_load(ids + i), marks = vu_load(lanes->marks + i);
        vi_store((int32_t *)joined->ids[0] + i, (vi)id);
        for (uint32_t k = 0; k < 3; k++) {
            const vu ends = (vu)((marks & SHB_EDGE_JOINED << k) == 0);
            const vu beyond = vu_load(lanes->beyond[k] + i) >> 3;
            vi_store((int32_t *)joined->ids[1 + k] + i, (vi)((beyond & ~ends) | (id & ends)));
        }
    }
}

/* Bits of a vector of a group's points, from i on. */
static inline ALWAYS_INLINE uint64_t bits_at(uint32_t bits, size_t i) {
    return (uint64_t)bits << i % SHB_LIST_GROUP;
}

/* Bits of the points whose triangles are among the joined ones. */
static inline ALWAYS_INLINE uint64_t joined_bits(const shb_walk_group *g,
                                                 const joined_lanes *joined,
                                                 const uint32_t *triangles) {
    uint64_t bits = 0;
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += WIDE) {
        const vu triangle = vu_load(triangles + i);
        vi is_among = {0};
        for (int k = 0; k < 4; k++)
            is_among |= triangle == vu_load(joined->ids[k] + i);
        bits |= bits_at(vi_bits(is_among), i);
    }
    return bits;
}

/* The vectors C - slope_x A - slope_y B of (1) have Tz - slope_x Tx - slope_y Ty - (Z - slope_x X -
 * slope_y Y) Tw. */
static inline ALWAYS_INLINE wd plane_error(const shb_light_rows *rows, bool affine,
                                           const shb_walk_group *g, const triangle_lanes *lanes,
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
                 wd_load(g->by_position[k] + i);
    }
    return error;
}

/* Bits of the points whose triangles are seen as a whole, and of those that lie on their own. */
typedef struct triangle_bits {
    uint64_t whole, own;
} triangle_bits;

static inline ALWAYS_INLINE triangle_bits find_whole(const shb_walk_group *g, const uint32_t *ids,
                                                     const triangle_lanes *lanes) {
    const uint32_t seen = 7 * SHB_CORNER_SEEN;
    triangle_bits bits = {0, 0};
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += WIDE) {
        const vu id = vu_load(ids + i), marks = vu_load(lanes->marks + i);
        const vi whole = ((marks & seen) == seen) & (id != SHB_ID_NONE);
        bits.whole |= bits_at(vi_bits(whole), i);
        bits.own |= bits_at(vi_bits(id == vu_load(g->own_ids + i)), i);
    }
    return bits;
}

/* What the triangles are to the points whose places they cover. */
static inline ALWAYS_INLINE void compare_depths(const shb_map *map, bool affine,
                                                const uint32_t *ids, const triangle_lanes *lanes,
                                                shb_walk_group *g) {
    const shb_light_rows rows = map->rows;
    const triangle_bits are = find_whole(g, ids, lanes);
    uint64_t covered = 0, in_front = 0, behind = 0, known = 0;
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += DOUBLES) {
        const place_lanes places = find_places(g, lanes, i);
        const wd plane =
            (wd_load(lanes->z + i) + wd_load(lanes->slope_x + i) * wd_load(g->at.x + i)) +
            wd_load(lanes->slope_y + i) * wd_load(g->at.y + i);
        const wd depth = wd_load(g->at.depth + i) - plane;
        const wd error = plane_error(&rows, affine, g, lanes, i);
        covered |= bits_at(covered_bits(&places), i);
        known |= bits_at(wd_greater_bits(wd_splat((double)INFINITY), error), i);
        in_front |= bits_at(wd_greater_bits(depth, error), i);
        behind |= bits_at(wd_greater_bits(-error, depth), i);
    }
    covered &= are.whole;
    known &= ~are.own;
    g->in_front = covered & known & in_front;
    g->behind = covered & known & behind;
    g->own = covered & (are.own | (known & ~in_front & ~behind));
}

static inline ALWAYS_INLINE void ask_nearest_as(const shb_map *map, bool affine, double rounding,
                                                shb_walk_group *g) {
    triangle_lanes lanes;
    joined_lanes joined;
    fetch_samples(map, g);
    bound_errors(map, affine, rounding, g);
    read_samples(map, g);
    read_triangles(map, g->samples[0], g->count, &lanes);
    read_planes(map, g->samples[0], g->count, &lanes);
    compare_depths(map, affine, g->samples[0], &lanes, g);
    find_joined(g, g->samples[0], &lanes, &joined);
    g->joined = g->own;
    for (int k = 1; k < 4; k++)
        g->joined &= joined_bits(g, &joined, g->samples[k]);
}

static void ask_nearest(const shb_map *map, double rounding, shb_walk_group *g) {
    if (map->projection.affine)
        ask_nearest_as(map, true, rounding, g);
    else
        ask_nearest_as(map, false, rounding, g);
}

/* Bits of the points whose sample k holds the triangle of one before it. */
static inline ALWAYS_INLINE uint64_t repeated_bits(const shb_walk_group *g, int k) {
    uint64_t bits = 0;
    for (size_t i = 0; i < shb_round_to_lanes(g->count); i += WIDE) {
        const vu triangle = vu_load(g->samples[k] + i);
        vi is_there = {0};
        for (int before = 0; before < k; before++)
            is_there |= triangle == vu_load(g->samples[before] + i);
        bits |= bits_at(vi_bits(is_there), i);
    }
    return bits;
}

static inline ALWAYS_INLINE void ask_beside_as(const shb_map *map, bool affine, shb_walk_group *g) {
    triangle_lanes lanes;
    joined_lanes joined;
    read_triangles(map, g->samples[0], g->count, &lanes);
    step_over(g, &lanes, 0, g->ends[0]);
    read_triangles(map, g->ends[0], g->count, &lanes);
    read_planes(map, g->ends[0], g->count, &lanes);
    compare_depths(map, affine, g->ends[0], &lanes, g);
    find_joined(g, g->ends[0], &lanes, &joined);
    g->joined = g->own;
    for (int k = 1; k < 4; k++) {
        uint32_t next[SHB_LIST_GROUP];
        const uint64_t arrived = joined_bits(g, &joined, g->samples[k]) | repeated_bits(g, k);
        memcpy(g->ends[k], g->samples[k], sizeof g->ends[k]);
        if (!(g->joined & ~arrived))
            continue;
        read_triangles(map, g->samples[k], g->count, &lanes);
        step_over(g, &lanes, k, next);
        const uint64_t arrives = joined_bits(g, &joined, next) & g->joined & ~arrived;
        for (size_t i = 0; i < g->count; i++)
            g->ends[k][i] = arrives >> i & 1 ? next[i] : g->ends[k][i];
        g->joined &= arrived | arrives;
    }
}

static void ask_beside(const shb_map *map, shb_walk_group *g) {
    if (map->projection.affine)
        ask_beside_as(map, true, g);
    else
        ask_beside_as(map, false, g);
}
