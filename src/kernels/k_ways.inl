/* Ways over the sheets of a mesh that are seen at the samples around points. What one has found
 * tells the next one where to end, so samples have their turns; but the ways of all points from one
 * of their samples go on side by side, each by one triangle at a time. */

#include "kept_lanes.h"

/* Of edges one and other of the triangles, the number of the one that ways cross to places beyond
 * both, as shb_edge_crossed. */
static inline ALWAYS_INLINE wd crossed(const wd left[3], int one, int other) {
    return wd_where_greater(left[3 - one - other] * left[one], wd_splat(0.0), wd_splat(one),
                            wd_splat(other));
}

/* No edge: the triangle has no area, or it covers the place. */
enum { EDGE_NONE = 3, EDGE_COVERED = 4 };

/* The numbers of the edges that ways go on over. */
static inline ALWAYS_INLINE wd edges_ahead(const place_lanes *p, wd way_x, wd way_y) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), two = wd_splat(2.0);
    const wd none = wd_splat(EDGE_NONE), covered = wd_splat(EDGE_COVERED);
    wd left[3]; /* 1 or -1 */
    for (int k = 0; k < 3; k++)
        left[k] = wd_where_greater(zero, way_x * p->to_y[k] - way_y * p->to_x[k], one, -one);
    const wd beyond_0 = wd_where_greater(
        p->beyond[1], zero, wd_where_greater(p->beyond[2], zero, none, crossed(left, 0, 1)),
        wd_where_greater(p->beyond[2], zero, crossed(left, 0, 2), zero));
    const wd within_0 = wd_where_greater(
        p->beyond[1], zero, wd_where_greater(p->beyond[2], zero, crossed(left, 1, 2), one),
        wd_where_greater(p->beyond[2], zero, two, covered));
    return wd_where_greater(wd_abs(p->area), zero,
                            wd_where_greater(p->beyond[0], zero, beyond_0, within_0), none);
}

/* From the centres of the texels of sample k, one axis. */
static inline ALWAYS_INLINE wd way_along(wd to, bool is_other) {
    const wd half = wd_splat(0.5), one = wd_splat(1.0);
    wd from = wd_floor(to);
    if (is_other)
        from += wd_where_greater(half, to - from, -one, one);
    return to - (from + half);
}

/* Triangles that cover points' places, to be compared. */
typedef struct met_triangles {
    size_t count;
    SHB_ALIGN double world[3][SHB_LIST_GROUP]; /* the points */
    uint32_t ids[SHB_LIST_GROUP];
    uint32_t points[SHB_LIST_GROUP]; /* in the batch */
    uint64_t own;                    /* one bit each: the point is known to lie on it */
} met_triangles;

static inline ALWAYS_INLINE void add_met(const shb_exact_points *points, uint32_t point,
                                         uint32_t triangle, met_triangles *met) {
    const size_t n = met->count++;
    met->world[0][n] = points->x[point];
    met->world[1][n] = points->y[point];
    met->world[2][n] = points->z[point];
    met->own |= (uint64_t)(triangle == points->own_ids[point]) << n;
    met->ids[n] = triangle;
    met->points[n] = point;
}

/* There are some. */
static inline ALWAYS_INLINE side_bits compare_met(const shb_map *map, double rounding,
                                                  met_triangles *met) {
    const uint64_t all = bits_below(met->count);
    for (size_t i = met->count; i % SHB_LANES; i++) {
        for (int k = 0; k < 3; k++)
            met->world[k][i] = met->world[k][met->count - 1];
        met->ids[i] = met->ids[met->count - 1];
    }
    const double *const world[3] = {met->world[0], met->world[1], met->world[2]};
    side_bits sides = find_sides(map, rounding, world, met->ids, all & ~met->own);
    sides.own |= met->own;
    return sides;
}

/* By point: a triangle that is its surface, and those that its sheet goes on with. */
typedef struct point_surfaces {
    SHB_ALIGN uint32_t ids[SHB_BATCH][4];
} point_surfaces;

static inline ALWAYS_INLINE void take_surface(const shb_map *map, uint32_t triangle,
                                              uint32_t surface[4]) {
    const shb_walk_triangle *t = &map->occluders.mesh.triangles[triangle];
    surface[3] = triangle;
    for (uint32_t k = 0; k < 3; k++)
        surface[k] = t->marks & SHB_EDGE_JOINED << k ? shb_neighbour_of(t->beyond[k]) : triangle;
}

/* Lanes whose triangles are among their points' surfaces. */
static inline ALWAYS_INLINE vi are_surfaces(const point_surfaces *surfaces, vu points,
                                            vu triangles) {
    vf ids[4];
    vf_read_quads((const float *)surfaces->ids, 4 * points, ids);
    return ((vu)ids[0] == triangles) | ((vu)ids[1] == triangles) | ((vu)ids[2] == triangles) |
           ((vu)ids[3] == triangles);
}

/* Ways of a sample that go on, without gaps, and what they need for a step. */
typedef struct open_ways {
    size_t count;
    SHB_ALIGN uint32_t points[SHB_BATCH + SHB_LANES], triangles[SHB_BATCH + SHB_LANES];
    double to_x[SHB_BATCH], to_y[SHB_BATCH];
    uint32_t links[SHB_BATCH][4]; /* what is beyond the triangle's edges, and its marks */
    int32_t edges[SHB_BATCH];
} open_ways;

static inline ALWAYS_INLINE void append_ways(vu points, vu triangles, vi lanes, open_ways *w) {
    const uint32_t bits = vi_bits(lanes);
    vi_append((int32_t *)w->points, w->count, (vi)points, bits);
    vi_append((int32_t *)w->triangles, w->count, (vi)triangles, bits);
    w->count += (size_t)__builtin_popcount(bits);
}

/* The ways of sample k, but for those that begin beside where an earlier one has met the point's
 * surface: they lead there, too. */
static inline ALWAYS_INLINE void begin_ways(int k, const point_surfaces *surfaces,
                                            shb_way_points *p, open_ways *w) {
    w->count = 0;
    for (size_t i = 0; i < p->points.count; i += WIDE) {
        const vu points = (uint32_t)i + (vu)vi_numbers();
        const vu triangles = vu_load(p->samples[k] + i), found = vu_load(p->found + i);
        const vi is_empty = triangles == SHB_ID_NONE;
        vi is_none = is_empty | ((found & SHB_WAY_IN_FRONT) != 0);
        for (int before = 0; before < k; before++)
            is_none |= triangles == vu_load(p->samples[before] + i);
        const vi has_arrived = are_surfaces(surfaces, points, triangles);
        vu_store(p->ends[k] + i, triangles);
        vu_store(p->found + i, found | ((vu)is_empty & SHB_WAY_EMPTY) |
                                   ((vu)~is_none & SHB_WAY_GONE << k) |
                                   ((vu)(has_arrived & ~is_none) & SHB_WAY_OWN << k));
        append_ways(points, triangles, ~(is_none | has_arrived), w);
    }
}

/* The last one fills up vectors of WIDE; returns how many there are then. */
static inline ALWAYS_INLINE size_t read_ways(const shb_map *map, const shb_way_points *p,
                                             open_ways *w) {
    const size_t whole = (w->count + WIDE - 1) / WIDE * WIDE;
    for (size_t n = w->count; n < whole; n++) {
        w->points[n] = w->points[w->count - 1];
        w->triangles[n] = w->triangles[w->count - 1];
    }
    for (size_t n = 0; n < whole; n++) {
        w->to_x[n] = p->x[w->points[n]];
        w->to_y[n] = p->y[w->points[n]];
        memcpy(w->links[n], map->occluders.mesh.triangles[w->triangles[n]].beyond,
               sizeof w->links[n]);
    }
    return whole;
}

/* The edges that ways of sample k leave their triangles by. */
static inline ALWAYS_INLINE void find_edges(const shb_map *map, int k, size_t whole, open_ways *w) {
    for (size_t i = 0; i < whole; i += DOUBLES) {
        const place_lanes places = find_places(map, w->to_x + i, w->to_y + i, w->triangles + i);
        const wd way_x = way_along(wd_load(w->to_x + i), k & 1);
        const wd way_y = way_along(wd_load(w->to_y + i), k & 2);
        wd_store_ints(w->edges + i, edges_ahead(&places, way_x, way_y));
    }
}

/* Ways that have ended at triangles that cover their places. */
typedef struct ended_ways {
    size_t count;
    uint32_t points[SHB_BATCH + SHB_LANES];
} ended_ways;

/* As shb_sheet_next. */
static inline ALWAYS_INLINE void step_ways(const shb_map *map, int k,
                                           const point_surfaces *surfaces, shb_way_points *p,
                                           open_ways *w, ended_ways *ended) {
    const uint32_t seen = 7 * SHB_CORNER_SEEN;
    const size_t count = w->count;
    find_edges(map, k, read_ways(map, p, w), w);
    w->count = 0;
    for (size_t i = 0; i < count; i += WIDE) {
        SHB_ALIGN uint32_t next[WIDE], own[WIDE];
        vf links[4];
        const vu points = vu_load(w->points + i), from = vu_load(w->triangles + i);
        const vi edges = vi_load(w->edges + i);
        vf_read_quads((const float *)w->links[i], 4 * (vu)vi_numbers(), links);
        const vu marks = (vu)links[3];
        vi goes = {0};
        vu to = from;
        for (int e = 0; e < 3; e++) {
            const vi over = (edges == e) & ((marks & SHB_EDGE_JOINED << e) != 0);
            to = ((vu)over & (vu)links[e] >> 3) | (~(vu)over & to);
            goes |= over;
        }
        const vi is_there = (int32_t)i + vi_numbers() < (int32_t)count;
        const vi arrives = goes & are_surfaces(surfaces, points, to);
        const vi covers = (edges == EDGE_COVERED) & ((marks & seen) == seen) & is_there;
        vu_store(next, to);
        vu_store(own, (vu)arrives & SHB_WAY_OWN << k);
        for (size_t n = 0; n < WIDE; n++) {
            const uint32_t point = w->points[i + n];
            p->ends[k][point] = next[n];
            p->found[point] |= own[n];
            __builtin_prefetch(&map->occluders.mesh.triangles[next[n]]);
        }
        append_ways(points, to, goes & ~arrives & is_there, w);
        const uint32_t bits = vi_bits(covers);
        vi_append((int32_t *)ended->points, ended->count, (vi)points, bits);
        ended->count += (size_t)__builtin_popcount(bits);
    }
}

/* What the triangles are that the ways of sample k have led to. */
static inline ALWAYS_INLINE void end_ways(const shb_map *map, double rounding, int k,
                                          const ended_ways *ended, shb_way_points *p,
                                          point_surfaces *surfaces) {
    for (size_t start = 0; start < ended->count; start += SHB_LIST_GROUP) {
        const uint32_t *points = ended->points + start;
        const size_t left = ended->count - start;
        met_triangles met = {.count = 0};
        for (size_t n = 0; n < (left < SHB_LIST_GROUP ? left : SHB_LIST_GROUP); n++)
            add_met(&p->points, points[n], p->ends[k][points[n]], &met);
        const side_bits sides = compare_met(map, rounding, &met);
        for (uint64_t bits = sides.in_front; bits; bits &= bits - 1)
            p->found[points[__builtin_ctzll(bits)]] |= SHB_WAY_IN_FRONT;
        for (uint64_t bits = sides.behind; bits; bits &= bits - 1)
            p->found[points[__builtin_ctzll(bits)]] |= SHB_WAY_BEHIND;
        for (uint64_t bits = sides.own; bits; bits &= bits - 1) {
            const uint32_t point = points[__builtin_ctzll(bits)];
            p->found[point] |= SHB_WAY_OWN << k;
            take_surface(map, p->ends[k][point], surfaces->ids[point]);
        }
    }
}

/* Triangles of a way. */
enum { WAY_MAX = 64 };

static void go_ways(const shb_map *map, double rounding, shb_way_points *p) {
    point_surfaces surfaces;
    open_ways w;
    ended_ways ended;
    for (size_t n = p->points.count; n % SHB_LANES; n++) /* vectors are read as a whole */
        for (int k = 0; k < 4; k++)
            p->samples[k][n] = SHB_ID_NONE;
    memset(&surfaces, 0xff, sizeof surfaces); /* SHB_ID_NONE */
    memset(p->found, 0, sizeof p->found);
    for (int k = 0; k < 4; k++) {
        begin_ways(k, &surfaces, p, &w);
        ended.count = 0;
        for (int steps = 0; w.count && steps < WAY_MAX; steps++)
            step_ways(map, k, &surfaces, p, &w, &ended);
        end_ways(map, rounding, k, &ended, p, &surfaces);
    }
}
