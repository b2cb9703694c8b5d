/* Walks over the mesh of a map's occluders, along the line where an upright plane of the light cuts
 * it: from triangle to triangle, over folds and back under them.
 *
 * The line that the light sees from one place of the map to another lies under one straight line of
 * the mesh, its section by a plane. On a closed mesh that section is a closed curve, which may fold
 * over and pass the same place several times, each time on a triangle that the light's ray meets
 * there. It leaves a triangle by the one other edge whose ends lie on different sides of the plane,
 * so that a walk cannot go astray whatever is rounded.
 *
 * A walk ends where it has come round, or gone too far from both places for what it meets to come
 * back to them; or it is cut: where no single triangle goes on, or at the light's near plane, or
 * because it was too long. Walks do not know of each other, so many go on side by side, each by one
 * triangle at a time, and what they meet is compared when there is enough of it. */

/* Walks that are under way at a time, and those that vectors may read beyond them. */
enum { WALKING_MAX = 64, WALKING_ROOM = WALKING_MAX + SHB_LANES };

/* The ends of the edge that a walk leaves its triangle by come in the order left, right: how far
 * they lie across the line, negative on the left, and along it beyond the point's place; both times
 * the line's length. */
typedef struct walking {
    size_t count;
    SHB_ALIGN double from_x[WALKING_ROOM], from_y[WALKING_ROOM];
    double to_x[WALKING_ROOM], to_y[WALKING_ROOM];
    double way_x[WALKING_ROOM], way_y[WALKING_ROOM];
    double nearest[WALKING_ROOM], farthest[WALKING_ROOM]; /* what lies farther off is too far */
    double across[2][WALKING_ROOM], along[2][WALKING_ROOM];
    double crossing[WALKING_ROOM]; /* of line and edge, along the line, times the edge's extent */
    uint32_t first[WALKING_ROOM];  /* triangle */
    uint32_t beyond[WALKING_ROOM]; /* the neighbour at the edge */
    uint32_t lower[WALKING_ROOM];  /* which of the ends is the lower vertex */
    uint32_t last[WALKING_ROOM];   /* the step that it is cut at */
    uint32_t points[WALKING_ROOM]; /* in the batch */
} walking;

static inline ALWAYS_INLINE wd corner_of(wd number, const wd corners[3]) {
    return wd_where_equal(number, wd_splat(0.0), corners[0],
                          wd_where_equal(number, wd_splat(1.0), corners[1], corners[2]));
}

/* Where a walk leaves its first triangle. */
typedef struct exit_lanes {
    wd across[2], along[2], crossing, lower;
    wd edge; /* 3: the line crosses none */
} exit_lanes;

/* Of the two edges of the first triangle that the line crosses, which meet in the corner that lies
 * alone on its side, the one that is crossed farther ahead; or the other one if the place lies
 * before both. */
static inline ALWAYS_INLINE exit_lanes choose_exits(const wd to_x[3], const wd to_y[3], wd way_x,
                                                    wd way_y) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), two = wd_splat(2.0), three = wd_splat(3.0);
    wd across[3], along[3], left[3];
    for (int k = 0; k < 3; k++) {
        across[k] = way_x * to_y[k] - way_y * to_x[k];
        along[k] = way_x * to_x[k] + way_y * to_y[k];
        left[k] = wd_where_greater(zero, across[k], one, zero);
    }
    const wd alone = wd_where_equal(left[0], left[1], wd_where_equal(left[0], left[2], three, two),
                                    wd_where_equal(left[0], left[2], one, zero));
    /* The corners opposite of the two edges. */
    const wd low = wd_where_equal(alone, zero, one, zero);
    const wd high = wd_where_equal(alone, two, one, two);
    const wd across_alone = corner_of(alone, across), along_alone = corner_of(alone, along);
    const wd across_low = corner_of(low, across), along_low = corner_of(low, along);
    const wd across_high = corner_of(high, across), along_high = corner_of(high, along);
    const wd side = wd_where_greater(zero, across_alone, one, -one);
    const wd low_crossing = side * (across_high * along_alone - across_alone * along_high);
    const wd high_crossing = side * (across_low * along_alone - across_alone * along_low);
    const wd low_extent = side * (across_high - across_alone);
    const wd high_extent = side * (across_low - across_alone);
    const wd is_farther =
        wd_where_greater(high_crossing * low_extent, low_crossing * high_extent, one, zero);
    const wd is_before = wd_where_greater(low_crossing, zero,
                                          wd_where_greater(high_crossing, zero, one, zero), zero);
    /* Equal: it leaves by the edge opposite of low, which ends at high. */
#define BY_EDGE(if_low, if_high) wd_where_equal(is_farther, is_before, if_low, if_high)
#define ON_LEFT(if_alone, if_other) wd_where_greater(side, zero, if_alone, if_other)
    const wd end = BY_EDGE(high, low);
    const wd across_end = BY_EDGE(across_high, across_low);
    const wd along_end = BY_EDGE(along_high, along_low);
    exit_lanes e;
    e.across[0] = ON_LEFT(across_alone, across_end);
    e.across[1] = ON_LEFT(across_end, across_alone);
    e.along[0] = ON_LEFT(along_alone, along_end);
    e.along[1] = ON_LEFT(along_end, along_alone);
    e.crossing = BY_EDGE(low_crossing, high_crossing);
    e.lower = wd_where_greater(ON_LEFT(alone, end), ON_LEFT(end, alone), one, zero);
    e.edge = wd_where_equal(alone, three, three, BY_EDGE(low, high));
#undef BY_EDGE
#undef ON_LEFT
    return e;
}

/* Walks that vectors of WIDE read. */
static inline ALWAYS_INLINE size_t whole_vectors(const walking *w) {
    return (w->count + WIDE - 1) / WIDE * WIDE;
}

/* Begins walks from number start on. Where snapping covered a sample just outside the triangle, its
 * middle is a better start. Returns bits of those that go on. */
static inline ALWAYS_INLINE uint64_t begin_walking(const shb_map *map, size_t start, walking *w) {
    const uint32_t whole = 7 * SHB_CORNER_SEEN;
    const wd three = wd_splat(3.0), reach = wd_splat(SHB_WALK_REACH);
    const shb_walk_triangle *triangles = map->occluders.mesh.triangles;
    int32_t edges[WALKING_ROOM];
    uint64_t going = 0;
    for (size_t i = start; i < whole_vectors(w); i += DOUBLES) {
        const double *corners_x[DOUBLES], *last_y[DOUBLES];
        wd first[4], last[4], to_x[3], to_y[3];
        const wd x = wd_load(w->to_x + i), y = wd_load(w->to_y + i);
        for (size_t k = 0; k < DOUBLES; k++) {
            corners_x[k] = triangles[w->first[i + k]].x;
            last_y[k] = triangles[w->first[i + k]].y + 1;
        }
        wd_read_quads(corners_x, first);
        wd_read_quads(last_y, last);
        for (int k = 0; k < 3; k++) {
            to_x[k] = first[k] - x;
            to_y[k] = (k == 0 ? first[3] : last[k - 1]) - y;
        }
        wd way_x = x - wd_load(w->from_x + i), way_y = y - wd_load(w->from_y + i);
        exit_lanes exit = choose_exits(to_x, to_y, way_x, way_y);
        const wd none = exit.edge;
        if (wd_greater_bits(none, wd_splat(2.0))) {
            const wd middle_x = x - ((first[0] + first[1]) + first[2]) / three;
            const wd middle_y = y - ((first[3] + last[0]) + last[1]) / three;
            const exit_lanes again = choose_exits(to_x, to_y, middle_x, middle_y);
#define AGAIN(name) name = wd_where_equal(none, three, again.name, exit.name)
            way_x = wd_where_equal(none, three, middle_x, way_x);
            way_y = wd_where_equal(none, three, middle_y, way_y);
            for (int k = 0; k < 2; k++) {
                exit.AGAIN(across[k]);
                exit.AGAIN(along[k]);
            }
            exit.AGAIN(crossing);
            exit.AGAIN(lower);
            exit.AGAIN(edge);
#undef AGAIN
        }
        const wd squared = way_x * way_x + way_y * way_y, farthest = reach * wd_sqrt(squared);
        wd_store(w->way_x + i, way_x);
        wd_store(w->way_y + i, way_y);
        wd_store(w->nearest + i, -(squared + farthest));
        wd_store(w->farthest + i, farthest);
        for (int k = 0; k < 2; k++) {
            wd_store(w->across[k] + i, exit.across[k]);
            wd_store(w->along[k] + i, exit.along[k]);
        }
        wd_store(w->crossing + i, exit.crossing);
        wd_store_ints((int32_t *)w->lower + i, exit.lower);
        wd_store_ints(edges + i, exit.edge);
    }
    for (size_t i = start; i < w->count; i++) {
        const shb_walk_triangle *t = &triangles[w->first[i]];
        const bool goes = (edges[i] < 3) & ((t->marks & whole) == whole);
        w->beyond[i] = t->beyond[goes ? edges[i] : 0];
        going |= (uint64_t)goes << i;
    }
    return going;
}

/* Walk i in the place of walk n. */
static void move_walk(size_t n, size_t i, walking *w) {
    w->to_x[n] = w->to_x[i];
    w->to_y[n] = w->to_y[i];
    w->way_x[n] = w->way_x[i];
    w->way_y[n] = w->way_y[i];
    w->nearest[n] = w->nearest[i];
    w->farthest[n] = w->farthest[i];
    for (int k = 0; k < 2; k++) {
        w->across[k][n] = w->across[k][i];
        w->along[k][n] = w->along[k][i];
    }
    w->crossing[n] = w->crossing[i];
    w->first[n] = w->first[i];
    w->beyond[n] = w->beyond[i];
    w->lower[n] = w->lower[i];
    w->last[n] = w->last[i];
    w->points[n] = w->points[i];
}

/* Leaves no gaps between the walks that go on. */
static uint64_t close_ranks(uint64_t going, walking *w) {
    size_t n = 0;
    for (; going; going &= going - 1)
        move_walk(n++, (size_t)__builtin_ctzll(going), w);
    w->count = n;
    return bits_below(n);
}

/* Begins walks of the crowd from number next on, as many as there is room for behind those that go
 * on; returns bits of all that go on. */
static uint64_t admit(const shb_map *map, const shb_walk_crowd *crowd, size_t *next, uint32_t step,
                      walking *w) {
    const size_t start = w->count, waiting = crowd->count - *next;
    const size_t room = WALKING_MAX - start, count = waiting < room ? waiting : room;
    for (size_t n = 0; n < count + SHB_LANES; n++) { /* vectors read some more */
        const size_t i = start + n, from = *next + (n < count ? n : count - 1);
        w->from_x[i] = crowd->from_x[from];
        w->from_y[i] = crowd->from_y[from];
        w->to_x[i] = crowd->to_x[from];
        w->to_y[i] = crowd->to_y[from];
        w->first[i] = crowd->triangles[from];
        w->beyond[i] = SHB_TWIN;
        w->lower[i] = 0;
        w->last[i] = step + SHB_WALK_MAX - 1;
        w->points[i] = crowd->points[from];
    }
    *next += count;
    w->count = start + count;
    return bits_below(start) | begin_walking(map, start, w);
}

/* What a step of all walks comes to, one bit a walk. */
typedef struct step_bits {
    uint64_t going, cut, covers;
} step_bits;

/* Over the exits to the next triangles, whose own exits are found: a third corner takes the place
 * of the exit's end on the same side of the line. */
static inline ALWAYS_INLINE step_bits step_walking(const shb_map *map, uint64_t going,
                                                   uint32_t step, walking *w, uint32_t *ids) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0);
    const shb_walk_triangle *triangles = map->occluders.mesh.triangles;
    const size_t count = w->count, whole = whole_vectors(w);
    SHB_ALIGN uint32_t third[WALKING_ROOM], quads[WALKING_ROOM][4];
    SHB_ALIGN double x[WALKING_ROOM], y[WALKING_ROOM];
    SHB_ALIGN int32_t sides[WALKING_ROOM];
    uint64_t ends = 0, round = 0, over = 0, passes = 0, seen = 0;
    for (size_t i = 0; i < count; i += WIDE) {
        const vu beyond = vu_load(w->beyond + i), first = vu_load(w->first + i);
        const vi is_open = beyond >= SHB_TWIN;
        const vu readable = ((vu)is_open & first << 3) | (~(vu)is_open & beyond);
        vi_store((int32_t *)ids + i, (vi)(readable >> 3));
        vi_store((int32_t *)third + i, (vi)(readable & 3));
        ends |= bits_at(vi_bits(is_open | (vu_load(w->last + i) == step)), i);
        round |= bits_at(vi_bits(readable >> 3 == first), i);
    }
    for (size_t i = 0; i < whole; i++) {
        const shb_walk_triangle *t = &triangles[ids[i]];
        x[i] = t->x[third[i]];
        y[i] = t->y[third[i]];
        memcpy(quads[i], t->beyond, sizeof quads[i]);
    }
    for (size_t i = 0; i < whole; i += DOUBLES) {
        const wd way_x = wd_load(w->way_x + i), way_y = wd_load(w->way_y + i);
        const wd to_x = wd_load(x + i) - wd_load(w->to_x + i);
        const wd to_y = wd_load(y + i) - wd_load(w->to_y + i);
        const wd aside = way_x * to_y - way_y * to_x, ahead = way_x * to_x + way_y * to_y;
        const wd before = wd_load(w->crossing + i);
        wd across[2], along[2];
        for (int k = 0; k < 2; k++) {
            across[k] = wd_load(w->across[k] + i);
            along[k] = wd_load(w->along[k] + i);
        }
        const wd extent = across[1] - across[0];
        over |= bits_at(wd_greater_bits(before, wd_load(w->farthest + i) * extent) |
                            wd_greater_bits(wd_load(w->nearest + i) * extent, before),
                        i);
        across[0] = wd_where_greater(zero, aside, aside, across[0]);
        across[1] = wd_where_greater(zero, aside, across[1], aside);
        along[0] = wd_where_greater(zero, aside, ahead, along[0]);
        along[1] = wd_where_greater(zero, aside, along[1], ahead);
        const wd crossing = across[1] * along[0] - across[0] * along[1];
        /* 0 <= crossing and so on, where no number is a NaN */
        const uint32_t is_zero = wd_greater_bits(wd_where_equal(crossing, zero, one, zero), zero);
        const uint32_t was_zero = wd_greater_bits(wd_where_equal(before, zero, one, zero), zero);
        const uint32_t is_ahead = wd_greater_bits(crossing, zero) | is_zero;
        const uint32_t is_behind = wd_greater_bits(zero, crossing) | is_zero;
        const uint32_t was_ahead = wd_greater_bits(before, zero) | was_zero;
        const uint32_t was_behind = wd_greater_bits(zero, before) | was_zero;
        passes |= bits_at((was_behind & is_ahead) | (was_ahead & is_behind), i);
        for (int k = 0; k < 2; k++) {
            wd_store(w->across[k] + i, across[k]);
            wd_store(w->along[k] + i, along[k]);
        }
        wd_store(w->crossing + i, crossing);
        wd_store_ints(sides + i, wd_where_greater(zero, aside, zero, one));
    }
    for (size_t i = 0; i < count; i += WIDE) {
        vf columns[4];
        SHB_ALIGN uint32_t ahead[WIDE];
        const vi corner = vi_load((const int32_t *)third + i), side = vi_load(sides + i);
        const vi keeps_lower = vi_load((const int32_t *)w->lower + i) ^ side;
        const vi rises = -(corner + keeps_lower >= 2); /* from the kept end to the third corner */
        vi_store((int32_t *)w->lower + i, side ^ rises);
        vf_read_quads((const float *)quads[i], 4 * (vu)vi_numbers(), columns);
        /* as shb_ends_of_edges[keeps_lower][corner] */
        const vi keeps = -keeps_lower;
        const vi is_middle = corner == (2 & keeps);
        const vi other = (keeps & (vi)columns[2]) | (~keeps & (vi)columns[0]);
        const vu beyond = (vu)((is_middle & (vi)columns[1]) | (~is_middle & other));
        vu_store(w->beyond + i, beyond);
        const vi mark = corner + 1 - (corner == 2); /* SHB_CORNER_SEEN << corner */
        seen |= bits_at(vi_bits(((vi)columns[3] & mark) != 0), i);
        vu_store(ahead, (vu)(beyond < SHB_TWIN) & beyond >> 3);
        for (size_t n = 0; n < WIDE; n++) /* while what was met is compared */
            __builtin_prefetch(&triangles[ahead[n]]);
    }
    over |= round;
    const uint64_t cut = ends | (~over & ~seen), goes_on = going & ~cut & ~over;
    return (step_bits){goes_on, going & cut, goes_on & passes};
}

static void tell_met(const shb_map *map, double rounding, met_triangles *met,
                     shb_walk_crowd *crowd) {
    const side_bits sides = compare_met(map, rounding, met);
    for (uint64_t left = sides.in_front; left; left &= left - 1)
        crowd->are_shadowed[met->points[__builtin_ctzll(left)]] = true;
    for (uint64_t left = sides.in_front | sides.own | sides.behind; left; left &= left - 1)
        crowd->are_known[met->points[__builtin_ctzll(left)]] = true;
    met->count = 0;
    met->own = 0;
}

static void take_met(const shb_map *map, double rounding, const shb_exact_points *points,
                     const walking *w, uint64_t covers, const uint32_t *ids, met_triangles *met,
                     shb_walk_crowd *crowd) {
    for (; covers; covers &= covers - 1) {
        const size_t i = (size_t)__builtin_ctzll(covers);
        add_met(points, w->points[i], ids[i], met);
        if (met->count == SHB_LIST_GROUP)
            tell_met(map, rounding, met, crowd);
    }
}

static void walk_on(const shb_map *map, double rounding, const shb_exact_points *points,
                    shb_walk_crowd *crowd) {
    walking w;
    met_triangles met;
    uint32_t ids[WALKING_ROOM];
    size_t next = 0;
    uint64_t going = 0;
    met.count = 0;
    met.own = 0;
    w.count = 0;
    for (uint32_t step = 1; going || next < crowd->count; step++) {
        const size_t left = (size_t)__builtin_popcountll(going);
        const bool is_waiting = next < crowd->count;
        if (left <= w.count / 2 || (is_waiting && left <= WALKING_MAX / 2))
            going = close_ranks(going, &w);
        if (is_waiting && w.count <= WALKING_MAX / 2)
            going = admit(map, crowd, &next, step, &w);
        const step_bits made = step_walking(map, going, step, &w, ids);
        for (uint64_t over = going & ~made.going & ~made.cut; over; over &= over - 1)
            crowd->are_known[w.points[__builtin_ctzll(over)]] = true;
        take_met(map, rounding, points, &w, made.covers, ids, &met, crowd);
        going = made.going;
    }
    if (met.count)
        tell_met(map, rounding, &met, crowd);
    crowd->count = 0;
}
