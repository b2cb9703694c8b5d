/* The exact method on maps that keep triangles, as far as the samples themselves tell it: most
 * fragments lie on what is found there, or behind it. All of it says what ways from all samples
 * would. */

/* True if one of so many points from i on is wanted. */
static inline ALWAYS_INLINE bool wants_some(uint64_t wanted, size_t i, size_t lanes) {
    return (wanted >> i & ((1u << lanes) - 1)) != 0;
}

/* Bits of a vector of a group's points, from i on. */
static inline ALWAYS_INLINE uint64_t bits_at(uint32_t bits, size_t i) {
    return (uint64_t)bits << i % SHB_LIST_GROUP;
}

/* The first so many bits. */
static inline ALWAYS_INLINE uint64_t bits_below(size_t count) {
    return count ? UINT64_MAX >> (64 - count) : 0;
}

/* Where in the map's texels the samples of points lie. */
typedef struct sample_places {
    int32_t near[SHB_LIST_GROUP];     /* the left one of those in the point's own row */
    int32_t far[SHB_LIST_GROUP];      /* and in the other */
    int32_t is_right[SHB_LIST_GROUP]; /* 1: the point's own texel is the right one */
    uint64_t are_known; /* one bit each: the others are not in the view, or near the map's border */
} sample_places;

/* Places that are not known stand for those of a point between the first texels. */
static inline ALWAYS_INLINE void find_samples(const shb_map *map, bool affine, shb_walk_group *g,
                                              sample_places *places) {
    const shb_list_frame *frame = &map->occluders.mesh.frame;
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), unseen = wd_splat((double)NAN);
    const double half_width = frame->width / 2, half_height = frame->height / 2;
    const wd limit_x = wd_splat(half_width - 1), limit_y = wd_splat(half_height - 1);
    const double stride = (double)(map->occluders.stride / sizeof(uint32_t));
    places->are_known = 0;
    for (size_t i = 0; i < SHB_LIST_GROUP; i += DOUBLES) {
        const wd px = wd_load(g->world[0] + i), py = wd_load(g->world[1] + i);
        const wd pz = wd_load(g->world[2] + i);
        wd x = row_at(frame->rows[0], px, py, pz), y = row_at(frame->rows[1], px, py, pz);
        if (!affine) {
            const wd w = row_at(frame->rows[3], px, py, pz), inverse = 1.0 / w;
            x = wd_where_greater(w, zero, x * inverse, unseen);
            y *= inverse;
        }
        wd_store(g->x + i, x);
        wd_store(g->y + i, y);
        wd known = wd_where_greater(limit_x, wd_abs(x - half_width), one, zero);
        known = wd_where_greater(limit_y, wd_abs(y - half_height), known, zero);
        x = wd_where_greater(known, zero, x, one);
        y = wd_where_greater(known, zero, y, one);
        const wd left = wd_floor(x - 0.5), top = wd_floor(y - 0.5);
        const wd first = top * stride + left, down = (wd_floor(y) - top) * stride;
        wd_store_ints(places->near + i, first + down);
        wd_store_ints(places->far + i, first + (stride - down));
        wd_store_ints(places->is_right + i, wd_floor(x) - left);
        places->are_known |= bits_at(wd_greater_bits(known, zero), i);
    }
}

/* Two neighbours of a row, the left one in the low half. */
static inline ALWAYS_INLINE uint64_t read_pair(const uint32_t *texel) {
    return texel[0] | (uint64_t)texel[1] << 32;
}

/* False: the point is not in the view, and sees nothing. */
static NEVER_INLINE bool read_samples_at_border(const shb_map *map, shb_walk_group *g, size_t i) {
    const double x = g->x[i], y = g->y[i];
    const bool seen = x >= 0 && x < map->info.width && y >= 0 && y < map->info.height;
    const int32_t own_column = seen ? (int32_t)x : 0, own_row = seen ? (int32_t)y : 0;
    for (int k = 0; k < 4; k++) {
        const int32_t column = own_column + (k & 1 ? x - own_column < 0.5 ? -1 : 1 : 0);
        const int32_t row = own_row + (k & 2 ? y - own_row < 0.5 ? -1 : 1 : 0);
        const bool inside =
            seen && (uint32_t)column < map->info.width && (uint32_t)row < map->info.height;
        g->samples[k][i] = inside ? shb_occluder_row(map, row)[column] : SHB_ID_NONE;
    }
    return seen;
}

/* Bits of the points in the view. */
static inline ALWAYS_INLINE uint64_t read_samples(const shb_map *map, const sample_places *places,
                                                  shb_walk_group *g) {
    const uint32_t *texels = map->occluders.texels;
    uint64_t near[SHB_LIST_GROUP], far[SHB_LIST_GROUP], seen = places->are_known;
    for (size_t i = 0; i < SHB_LIST_GROUP && places->are_known; i++) {
        near[i] = read_pair(texels + places->near[i]);
        far[i] = read_pair(texels + places->far[i]);
    }
    for (size_t i = 0; i < SHB_LIST_GROUP && places->are_known; i++) {
        const uint32_t near_left = (uint32_t)near[i], near_right = (uint32_t)(near[i] >> 32);
        const uint32_t far_left = (uint32_t)far[i], far_right = (uint32_t)(far[i] >> 32);
        const bool is_right = places->is_right[i];
        g->samples[0][i] = is_right ? near_right : near_left;
        g->samples[1][i] = is_right ? near_left : near_right;
        g->samples[2][i] = is_right ? far_right : far_left;
        g->samples[3][i] = is_right ? far_left : far_right;
    }
    for (uint64_t left = ~places->are_known; left; left &= left - 1) {
        const size_t i = (size_t)__builtin_ctzll(left);
        seen |= (uint64_t)read_samples_at_border(map, g, i) << i;
    }
    return seen;
}

/* What triangles of these numbers are to points; one bit a point. */
typedef struct id_bits {
    uint64_t held; /* there is one */
    uint64_t own;  /* the point is known to lie on it */
} id_bits;

/* Also makes numbers that can be read, in place of SHB_ID_NONE that of the first triangle. */
static inline ALWAYS_INLINE id_bits look_at_ids(const shb_walk_group *g, const uint32_t *ids,
                                                uint32_t *readable) {
    id_bits bits = {0, 0};
    for (size_t i = 0; i < SHB_LIST_GROUP; i += WIDE) {
        const vu id = vu_load(ids + i);
        const vi held = id != SHB_ID_NONE;
        vi_store((int32_t *)readable + i, held & (vi)id);
        bits.held |= bits_at(vi_bits(held), i);
        bits.own |= bits_at(vi_bits(id == vu_load(g->own_ids + i)), i);
    }
    bits.own &= bits.held;
    return bits;
}

/* Bits of the points whose samples are all the same. */
static inline ALWAYS_INLINE uint64_t equal_bits(const shb_walk_group *g) {
    uint64_t bits = 0;
    for (size_t i = 0; i < SHB_LIST_GROUP; i += WIDE) {
        const vu first = vu_load(g->samples[0] + i);
        const vi equal = (first == vu_load(g->samples[1] + i)) &
                         (first == vu_load(g->samples[2] + i)) &
                         (first == vu_load(g->samples[3] + i));
        bits |= bits_at(vi_bits(equal), i);
    }
    return bits;
}

/* The sides of planes that points lie on, as far as rounding can tell; one bit a point. */
typedef struct side_bits {
    uint64_t in_front; /* the plane is, as the light sees it */
    uint64_t own;      /* the point is within what rounding may move it by */
    uint64_t behind;
} side_bits;

/* As compare_depth of the asking of single points. */
static inline ALWAYS_INLINE side_bits find_sides(const shb_map *map, double rounding,
                                                 const double *const world[3],
                                                 const uint32_t *readable, uint64_t wanted) {
    const wd unit = wd_splat(rounding + SHB_PLANE_ROUNDING);
    const wd zero = wd_splat(0.0), one = wd_splat(1.0);
    side_bits bits = {0, 0, 0};
    uint64_t known = 0; /* no NaN */
    for (size_t i = 0; i < SHB_LIST_GROUP; i += DOUBLES) {
        if (!wants_some(wanted, i, DOUBLES))
            continue;
        const double *planes[DOUBLES];
        wd plane[4];
        for (size_t k = 0; k < DOUBLES; k++)
            planes[k] = map->occluders.world_planes[readable[i + k]].normal;
        wd_read_quads(planes, plane);
        for (int k = 0; k < 3; k++)
            plane[k] *= wd_load(world[k] + i);
        const wd distance = ((plane[0] + plane[1]) + plane[2]) + plane[3];
        const wd error = unit * ((wd_abs(plane[0]) + wd_abs(plane[1])) + wd_abs(plane[2])) + one;
        bits.in_front |= bits_at(wd_greater_bits(distance, error), i);
        known |= bits_at(wd_greater_bits(wd_where_equal(distance, distance, one, zero), zero), i);
        bits.behind |= bits_at(wd_greater_bits(-error, distance), i);
    }
    bits.in_front &= wanted;
    bits.behind &= wanted;
    bits.own = wanted & known & ~bits.in_front & ~bits.behind;
    return bits;
}

/* What lies beyond the edges of a triangle for each point. */
typedef struct link_lanes {
    SHB_ALIGN uint32_t beyond[3][SHB_LIST_GROUP], marks[SHB_LIST_GROUP];
    uint64_t whole; /* one bit each: it is all of it behind the light's near plane */
} link_lanes;

static inline ALWAYS_INLINE void read_links(const shb_map *map, const uint32_t *readable,
                                            uint64_t wanted, link_lanes *links) {
    const uint32_t seen = 7 * SHB_CORNER_SEEN;
    SHB_ALIGN uint32_t quads[SHB_LIST_GROUP][4];
    links->whole = 0;
    for (size_t i = 0; i < SHB_LIST_GROUP; i += WIDE)
        if (wants_some(wanted, i, WIDE))
            for (size_t k = i; k < i + WIDE; k++)
                memcpy(quads[k], map->occluders.mesh.triangles[readable[k]].beyond,
                       sizeof quads[k]);
    for (size_t i = 0; i < SHB_LIST_GROUP; i += WIDE) {
        if (!wants_some(wanted, i, WIDE))
            continue;
        vf columns[4];
        vf_read_quads((const float *)quads[i], 4 * (vu)vi_numbers(), columns);
        for (int k = 0; k < 3; k++)
            vi_store((int32_t *)links->beyond[k] + i, (vi)columns[k]);
        vi_store((int32_t *)links->marks + i, (vi)columns[3]);
        links->whole |= bits_at(vi_bits(((vu)columns[3] & seen) == seen), i);
    }
}

/* A triangle for each point, and those that go on beyond its edges, or itself. */
typedef struct joined_lanes {
    uint32_t ids[4][SHB_LIST_GROUP];
} joined_lanes;

static inline ALWAYS_INLINE void find_joined(const uint32_t *ids, const link_lanes *links,
                                             joined_lanes *joined) {
    for (size_t i = 0; i < SHB_LIST_GROUP; i += WIDE) {
        const vu id = vu_load(ids + i), marks = vu_load(links->marks + i);
        vi_store((int32_t *)joined->ids[0] + i, (vi)id);
        for (uint32_t k = 0; k < 3; k++) {
            const vu ends = (vu)((marks & SHB_EDGE_JOINED << k) == 0);
            const vu beyond = vu_load(links->beyond[k] + i) >> 3;
            vi_store((int32_t *)joined->ids[1 + k] + i, (vi)((beyond & ~ends) | (id & ends)));
        }
    }
}

/* Bits of the points whose triangles are among the joined ones. */
static inline ALWAYS_INLINE uint64_t joined_bits(const joined_lanes *joined,
                                                 const uint32_t *triangles) {
    uint64_t bits = 0;
    for (size_t i = 0; i < SHB_LIST_GROUP; i += WIDE) {
        const vu triangle = vu_load(triangles + i);
        vi is_among = {0};
        for (int k = 0; k < 4; k++)
            is_among |= triangle == vu_load(joined->ids[k] + i);
        bits |= bits_at(vi_bits(is_among), i);
    }
    return bits;
}

/* Of the places of lanes in their triangles, as shb_edges_before tells it. */
typedef struct place_lanes {
    wd to_x[3], to_y[3]; /* from the places to the corners */
    wd beyond[3];        /* positive beyond an ordered edge */
    wd area;             /* of any sign; 0: the triangle covers nothing */
} place_lanes;

static inline ALWAYS_INLINE place_lanes find_places(const shb_map *map, const double *places_x,
                                                    const double *places_y,
                                                    const uint32_t *readable) {
    const wd zero = wd_splat(0.0), x = wd_load(places_x), y = wd_load(places_y);
    const double *corners_x[DOUBLES], *last_y[DOUBLES];
    wd first[4], last[4];
    for (size_t k = 0; k < DOUBLES; k++) {
        const shb_walk_triangle *t = &map->occluders.mesh.triangles[readable[k]];
        corners_x[k] = t->x;
        last_y[k] = t->y + 1;
    }
    wd_read_quads(corners_x, first);
    wd_read_quads(last_y, last);
    place_lanes p;
    for (int k = 0; k < 3; k++) {
        p.to_x[k] = first[k] - x;
        p.to_y[k] = (k == 0 ? first[3] : last[k - 1]) - y;
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

/* Bits of the points whose triangles cover their places. */
static inline ALWAYS_INLINE uint64_t covered_bits(const shb_map *map, const shb_walk_group *g,
                                                  const uint32_t *readable, uint64_t wanted) {
    const wd zero = wd_splat(0.0);
    uint64_t bits = 0;
    for (size_t i = 0; i < SHB_LIST_GROUP; i += DOUBLES) {
        if (!wants_some(wanted, i, DOUBLES))
            continue;
        const place_lanes p = find_places(map, g->x + i, g->y + i, readable + i);
        const wd farthest = wd_max(wd_max(p.beyond[0], p.beyond[1]), p.beyond[2]);
        bits |=
            bits_at(wd_greater_bits(wd_abs(p.area), zero) & ~wd_greater_bits(farthest, zero), i);
    }
    return bits & wanted;
}

/* Between four samples of one triangle a fragment on its plane is lit, whatever of the triangle is
 * known; and so is one that is known to lie on a triangle that the other samples are joined to.
 * Else its place must be covered. */
static inline ALWAYS_INLINE void ask_nearest_as(const shb_map *map, bool affine, double rounding,
                                                shb_walk_group *g) {
    sample_places places;
    SHB_ALIGN uint32_t readable[SHB_LIST_GROUP];
    link_lanes links;
    joined_lanes joined;
    find_samples(map, affine, g, &places);
    const uint64_t seen = read_samples(map, &places, g);
    id_bits are = look_at_ids(g, g->samples[0], readable);
    are.held &= seen;
    const uint64_t equal = equal_bits(g);
    uint64_t lit = ~seen | (equal & are.own);
    const side_bits sides = find_sides(map, rounding, g->world, readable, are.held & ~lit);
    lit |= equal & sides.own;
    g->in_front = 0;
    g->joined = lit;
    const uint64_t left = are.held & ~lit;
    if (!left)
        return;
    read_links(map, readable, left, &links);
    uint64_t arrived = left & links.whole & (are.own | sides.own);
    if (arrived)
        find_joined(g->samples[0], &links, &joined);
    for (int k = 1; k < 4 && arrived; k++)
        arrived &= joined_bits(&joined, g->samples[k]);
    lit |= arrived & are.own;
    const uint64_t covered = covered_bits(
        map, g, readable, links.whole & ~lit & ((arrived & sides.own) | (left & sides.in_front)));
    g->joined = lit | (covered & arrived & sides.own);
    g->in_front = covered & sides.in_front & ~are.own;
}

static void ask_nearest(const shb_map *map, double rounding, shb_walk_group *g) {
    if (map->projection.affine)
        ask_nearest_as(map, true, rounding, g);
    else
        ask_nearest_as(map, false, rounding, g);
}
