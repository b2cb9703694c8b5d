/* The hard test in float: quick_test.c derives what is sure. */

/* Positions or normals from number i on. */
static inline ALWAYS_INLINE void read_points(const float *const from[3], bool packed, size_t i,
                                             vf v[3]) {
    if (packed)
        vf_read_triples(from[0] + 3 * i, v);
    else
        for (int k = 0; k < 3; k++)
            v[k] = vf_load(from[k] + i);
}

/* The least and the most of each coordinate. NaN are left out: they are never sure. INFINITY and
 * -INFINITY if all are. */
static inline ALWAYS_INLINE void find_ranges(size_t lanes, const float *const from[3], bool packed,
                                             float least[3], float most[3]) {
    vf low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = vf_splat(INFINITY);
        high[k] = vf_splat(-INFINITY);
    }
    for (size_t i = 0; i < lanes; i += WIDE) {
        vf v[3];
        read_points(from, packed, i, v);
        for (int k = 0; k < 3; k++) {
            low[k] = vf_min(v[k], low[k]);
            high[k] = vf_max(v[k], high[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        least[k] = vf_least(low[k]);
        most[k] = -vf_least(-high[k]);
    }
}

static NEVER_INLINE shb_quick_extent extent_of(size_t count, bool plane,
                                               const shb_quick_points *points) {
    const size_t lanes = shb_round_to_lanes(count);
    float least[3], most[3];
    shb_quick_extent extent = {.normal = 0};
    find_ranges(lanes, points->position, points->packed, extent.least, extent.most);
    if (!plane)
        return extent;
    find_ranges(lanes, points->normal, points->packed, least, most);
    for (int k = 0; k < 3; k++)
        extent.normal = fmaxf(extent.normal, fmaxf(-least[k], most[k]));
    return extent;
}

static inline ALWAYS_INLINE vf quick_dot(const float *row, vf x, vf y, vf z) {
    return (row[0] * x + row[1] * y) + row[2] * z;
}

/* Added to a number below 2^22, it leaves the nearest integer in the lowest bits. */
#define ROUNDER 0x1.8p23f
#define ROUNDER_BITS 0x4b400000u

/* The texel of a coordinate that is counted from the centre of texel first on, and the way to its
 * centre. Of other numbers any. */
static inline ALWAYS_INLINE vf split_texel(vf value, int32_t first, vi *texel) {
    const vf rounded = value + ROUNDER;
    *texel = (vi)((vu)rounded + ((uint32_t)first - ROUNDER_BITS));
    return (rounded - ROUNDER) - value;
}

/* The depth of the plane from the fragment to the texel's centre, and its error. */
static inline ALWAYS_INLINE vf quick_run(const shb_quick_test *t, bool affine, const vf n[3], vf x,
                                         vf y, vf z, vf to_center_x, vf to_center_y, vf *error) {
    vf xy = quick_dot(t->xy, n[0], n[1], n[2]);
    vf zy = quick_dot(t->zy, n[0], n[1], n[2]);
    vf xz = quick_dot(t->xz, n[0], n[1], n[2]);
    if (!affine) {
        const vf xw = quick_dot(t->xw, n[0], n[1], n[2]);
        const vf yw = quick_dot(t->yw, n[0], n[1], n[2]);
        const vf zw = quick_dot(t->zw, n[0], n[1], n[2]);
        xy = xy - y * xw + x * yw;
        zy = zy - y * zw + z * yw;
        xz = xz - z * xw + x * zw;
    }
    const vf inverse = 1.0f / xy, size = vf_abs(inverse);
    const vf slope_x = zy * inverse, slope_y = xz * inverse;
    const vf slopes = vf_abs(slope_x) + vf_abs(slope_y);
    *error = size * (t->error_other + slopes * t->error_xy) + slopes * t->error_slope;
    return slope_x * to_center_x + slope_y * to_center_y;
}

/* Appends the lanes that are not sure. */
static inline ALWAYS_INLINE size_t add_doubtful(uint32_t lanes, size_t i, size_t end,
                                                uint16_t *doubtful, size_t found) {
    for (; lanes; lanes &= lanes - 1) {
        const size_t lane = i + (size_t)__builtin_ctz(lanes);
        if (lane < end)
            doubtful[found++] = (uint16_t)lane;
    }
    return found;
}

/* What fragments are compared with, at which texel. */
typedef struct quick_receivers {
    SHB_ALIGN uint32_t place[SHB_BATCH];
    float ref[SHB_BATCH]; /* from the test's depth on; NaN: not sure, -infinity: outside the map */
    float error[SHB_BATCH];
} quick_receivers;

/* Asks for what the next batch reads and writes at the places that it keeps these lanes at. */
static inline ALWAYS_INLINE void prefetch_next_batch(const shb_quick_points *points, bool plane,
                                                     size_t i) {
    enum { LINE = 64 / sizeof(float) };
    if (i % LINE)
        return;
    for (size_t k = 0; k < 3 * LINE; k += LINE)
        __builtin_prefetch(points->next_position + 3 * i + k);
    for (size_t k = 0; plane && k < 3 * LINE; k += LINE)
        __builtin_prefetch(points->next_normal + 3 * i + k);
    __builtin_prefetch(points->next_visibility + i, 1);
}

/* Larger elements so far. NaN are left out. */
static inline ALWAYS_INLINE void keep_largest(const vf v[3], vf largest[3]) {
    for (int k = 0; k < 3; k++)
        largest[k] = vf_max(vf_abs(v[k]), largest[k]);
}

/* Asks for the texels, too: they lie anywhere in memory. For those of the vector before: their
 * places can be read at once only when they have left the units that store whole vectors. False:
 * some fragments lie outside of the test's box. */
static inline ALWAYS_INLINE bool project_quickly(const shb_map *map, const shb_quick_test *test,
                                                 bool affine, bool plane, bool packed, size_t count,
                                                 const shb_quick_points *points,
                                                 quick_receivers *restrict out) {
    const shb_quick_test t = *test;
    const shb_quick_points from = *points;
    const float *texels = map->depth.texels;
    const uint32_t stride = (uint32_t)(map->depth.stride / 4);
    const uint32_t width = map->info.width, height = map->info.height;
    vf ways[3] = {{0}}, largest[3] = {{0}};
    for (size_t i = 0, before = 0; i < count; i += WIDE) {
        vf p[3];
        if (packed)
            prefetch_next_batch(&from, plane, i);
        read_points(from.position, packed, i, p);
        for (int k = 0; k < 3; k++)
            p[k] -= t.origin[k];
        keep_largest(p, ways);
        vf x = quick_dot(t.x, p[0], p[1], p[2]) + t.x[3];
        vf y = quick_dot(t.y, p[0], p[1], p[2]) + t.y[3];
        vf z = quick_dot(t.z, p[0], p[1], p[2]) + t.z[3];
        vf epsilon = vf_splat(t.epsilon[0]);
        if (!affine) {
            const vf inverse = 1.0f / (quick_dot(t.w, p[0], p[1], p[2]) + t.w[3]);
            x *= inverse;
            y *= inverse;
            z *= inverse;
            epsilon += inverse * (t.epsilon[1] + inverse * t.epsilon[2]);
        }
        vi texel_x, texel_y;
        const vf center_x = split_texel(x, t.texel_x, &texel_x);
        const vf center_y = split_texel(y, t.texel_y, &texel_y);
        /* Both ways are NaN or none. */
        vi unsure = ~(vf_max(vf_abs(center_x), vf_abs(center_y)) < t.sure);
        const vi inside = (vi)((vu)texel_x < width) & (vi)((vu)texel_y < height);
        const vu place = (vu)inside & (vu_times_short((vu)texel_y, stride) + (vu)texel_x);
        vu_store(out->place + i, place);
        for (size_t lane = before; lane < before + WIDE; lane++)
            __builtin_prefetch(texels + out->place[lane]);
        before = i;
        if (plane) {
            vf n[3], error;
            read_points(from.normal, packed, i, n);
            keep_largest(n, largest);
            z += quick_run(&t, affine, n, x, y, z, center_x, center_y, &error);
            unsure |= ~(error < t.most_error);
            vf_store(out->error + i, error + t.error);
        }
        const vf most = vf_where(inside, vf_splat(t.farthest), vf_splat(-INFINITY));
        vf_store(out->ref + i, (vf)((vi)vf_min(most, z - epsilon) | unsure));
    }
    vi beyond = {0};
    for (int k = 0; k < 3; k++)
        beyond |= (ways[k] > t.reach[k]) | (largest[k] > t.normal);
    return !vi_any(beyond);
}

static inline ALWAYS_INLINE size_t compare_quickly(const shb_map *map, const shb_quick_test *test,
                                                   bool plane, size_t count,
                                                   const quick_receivers *restrict r,
                                                   float *restrict visibility,
                                                   uint16_t *restrict doubtful) {
    const float sign = map->info.view.reversed ? -1.0f : 1.0f, depth = test->depth;
    const float *texels = map->depth.texels;
    const vf one = vf_splat(1.0f);
    size_t found = 0;
    for (size_t i = 0; i < count; i += WIDE) {
        const vf stored = sign * vf_read(texels, r->place + i);
        const vf difference = (stored - depth) - vf_load(r->ref + i);
        const vf error = plane ? vf_load(r->error + i) : vf_splat(test->error);
        vf_store(visibility + i, vf_keep(~(difference < 0.0f), one));
        found = add_doubtful(vi_bits(~(vf_abs(difference) > error)), i, count, doubtful, found);
    }
    return found;
}

static inline ALWAYS_INLINE bool project_points(const shb_map *map, const shb_quick_test *test,
                                                bool affine, bool plane, size_t count,
                                                const shb_quick_points *points,
                                                quick_receivers *projected) {
    return points->packed
               ? project_quickly(map, test, affine, plane, true, count, points, projected)
               : project_quickly(map, test, affine, plane, false, count, points, projected);
}

static bool project_any(const shb_map *map, const shb_quick_test *test, bool plane, size_t count,
                        const shb_quick_points *points, quick_receivers *projected) {
    if (map->projection.affine)
        return plane ? project_points(map, test, true, true, count, points, projected)
                     : project_points(map, test, true, false, count, points, projected);
    return plane ? project_points(map, test, false, true, count, points, projected)
                 : project_points(map, test, false, false, count, points, projected);
}

/* A test that leaves more than one in so many in doubt is made anew for the next batch. */
enum { DOUBTFUL_FEW = 32 };

static size_t test_quickly(const shb_map *map, const shb_quick_bias *bias, size_t count,
                           const shb_quick_points *points, shb_quick_test *test, float *visibility,
                           uint16_t *doubtful) {
    const bool plane = bias->plane;
    quick_receivers projected;
    if (!can_gather(map) || map->depth.stride / 4 > INT16_MAX)
        return SIZE_MAX;
    if (!test->known || !project_any(map, test, plane, count, points, &projected)) {
        const shb_quick_extent extent = extent_of(count, plane, points);
        test->known = shb_quick_test_of(map, bias, &extent, test);
        if (!test->known)
            return SIZE_MAX;
        project_any(map, test, plane, count, points, &projected);
    }
    const size_t found =
        plane ? compare_quickly(map, test, true, count, &projected, visibility, doubtful)
              : compare_quickly(map, test, false, count, &projected, visibility, doubtful);
    test->known = found <= count / DOUBTFUL_FEW;
    return found;
}
