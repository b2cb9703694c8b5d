/* The hard test in float: quick_test.c derives what is sure. */

/* The least and the most of each coordinate. NaN are left out: they are never sure. INFINITY and
 * -INFINITY if all are. */
static inline ALWAYS_INLINE void find_ranges(size_t lanes, const float *x, const float *y,
                                             const float *z, float least[3], float most[3]) {
    const float *const from[3] = {x, y, z};
    vf low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = vf_splat(INFINITY);
        high[k] = vf_splat(-INFINITY);
    }
    for (size_t i = 0; i < lanes; i += WIDE)
        for (int k = 0; k < 3; k++) {
            low[k] = vf_min(vf_load(from[k] + i), low[k]);
            high[k] = vf_max(vf_load(from[k] + i), high[k]);
        }
    for (int k = 0; k < 3; k++) {
        least[k] = vf_least(low[k]);
        most[k] = -vf_least(-high[k]);
    }
}

static inline ALWAYS_INLINE float largest_element(size_t lanes, const shb_receivers *r) {
    float least[3], most[3], largest = 0;
    find_ranges(lanes, r->normal_x, r->normal_y, r->normal_z, least, most);
    for (int k = 0; k < 3; k++)
        largest = fmaxf(largest, fmaxf(-least[k], most[k]));
    return largest;
}

static inline ALWAYS_INLINE shb_quick_extent extent_of(size_t count, bool plane,
                                                       const shb_receivers *r) {
    const size_t lanes = shb_round_to_lanes(count);
    shb_quick_extent extent = {.normal = plane ? largest_element(lanes, r) : 0};
    find_ranges(lanes, r->x, r->y, r->z, extent.least, extent.most);
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
static inline ALWAYS_INLINE vf quick_run(const shb_quick_test *t, bool affine,
                                         const shb_receivers *r, size_t i, vf x, vf y, vf z,
                                         vf to_center_x, vf to_center_y, vf *error) {
    const vf nx = vf_load(r->normal_x + i), ny = vf_load(r->normal_y + i);
    const vf nz = vf_load(r->normal_z + i);
    vf xy = quick_dot(t->xy, nx, ny, nz);
    vf zy = quick_dot(t->zy, nx, ny, nz);
    vf xz = quick_dot(t->xz, nx, ny, nz);
    if (!affine) {
        const vf xw = quick_dot(t->xw, nx, ny, nz);
        const vf yw = quick_dot(t->yw, nx, ny, nz);
        const vf zw = quick_dot(t->zw, nx, ny, nz);
        xy = xy - y * xw + x * yw;
        zy = zy - y * zw + z * yw;
        xz = xz - z * xw + x * zw;
    }
    const vf inverse = 1.0f / xy, size = vf_abs(inverse);
    const vf slope_x = zy * inverse, slope_y = xz * inverse;
    const vf slopes = vf_abs(slope_x) + vf_abs(slope_y);
    const vf slopes_error = size * (t->error_other + slopes * t->error_xy);
    const vi is_sure = (size * t->error_xy < 0.5f) & (slopes + slopes_error < 0.99f);
    *error = vf_where(is_sure, slopes_error + slopes * t->error_slope, vf_splat(INFINITY));
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
    SHB_ALIGN int32_t place[SHB_BATCH];
    float ref[SHB_BATCH]; /* from the test's depth on; NaN: not sure, -infinity: outside the map */
    float error[SHB_BATCH];
} quick_receivers;

/* Asks for the texels, too: they lie anywhere in memory. */
static inline ALWAYS_INLINE void project_quickly(const shb_map *map, const shb_quick_test *test,
                                                 bool affine, bool plane, size_t count,
                                                 const shb_receivers *restrict r,
                                                 quick_receivers *restrict out) {
    const shb_quick_test t = *test;
    const float *texels = map->depth.texels;
    const uint32_t stride = (uint32_t)(map->depth.stride / 4);
    const uint32_t width = map->info.width, height = map->info.height;
    const float ox = t.origin[0], oy = t.origin[1], oz = t.origin[2];
    const vf outside = vf_splat(-INFINITY), unsure = vf_splat(NAN);
    for (size_t i = 0; i < count; i += WIDE) {
        const vf px = vf_load(r->x + i) - ox, py = vf_load(r->y + i) - oy;
        const vf pz = vf_load(r->z + i) - oz;
        vf x = quick_dot(t.x, px, py, pz) + t.x[3];
        vf y = quick_dot(t.y, px, py, pz) + t.y[3];
        vf z = quick_dot(t.z, px, py, pz) + t.z[3];
        vf epsilon = vf_splat(t.epsilon[0]);
        if (!affine) {
            const vf inverse = 1.0f / (quick_dot(t.w, px, py, pz) + t.w[3]);
            x *= inverse;
            y *= inverse;
            z *= inverse;
            epsilon += inverse * (t.epsilon[1] + inverse * t.epsilon[2]);
        }
        vi texel_x, texel_y;
        const vf center_x = split_texel(x, t.texel_x, &texel_x);
        const vf center_y = split_texel(y, t.texel_y, &texel_y);
        /* Both ways are NaN or none. */
        const vi is_sure = vf_max(vf_abs(center_x), vf_abs(center_y)) < t.sure;
        const vi inside = (vi)((vu)texel_x < width) & (vi)((vu)texel_y < height);
        const vi place = inside & (vi)((vu)texel_y * stride + (vu)texel_x);
        vi_store(out->place + i, place);
        for (size_t lane = i; lane < i + WIDE; lane++)
            __builtin_prefetch(texels + out->place[lane]);
        if (plane) {
            vf error;
            z += quick_run(&t, affine, r, i, x, y, z, center_x, center_y, &error);
            vf_store(out->error + i, error + t.error);
        }
        const vf ref = vf_min(vf_splat(t.farthest), z - epsilon);
        vf_store(out->ref + i, vf_where(is_sure, vf_where(inside, ref, outside), unsure));
    }
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
        float texel[WIDE];
        for (int lane = 0; lane < WIDE; lane++)
            texel[lane] = texels[r->place[i + (size_t)lane]];
        const vf stored = sign * vf_load(texel);
        const vf difference = (stored - depth) - vf_load(r->ref + i);
        const vf error = plane ? vf_load(r->error + i) : vf_splat(test->error);
        vf_store(visibility + i, vf_keep(~(difference < 0.0f), one));
        found = add_doubtful(vi_bits(~(vf_abs(difference) > error)), i, count, doubtful, found);
    }
    return found;
}

static inline ALWAYS_INLINE size_t test_lanes_quickly(const shb_map *map,
                                                      const shb_quick_test *test, bool affine,
                                                      bool plane, size_t count,
                                                      const shb_receivers *r, float *visibility,
                                                      uint16_t *doubtful) {
    quick_receivers projected;
    project_quickly(map, test, affine, plane, count, r, &projected);
    return compare_quickly(map, test, plane, count, &projected, visibility, doubtful);
}

static size_t test_quickly(const shb_map *map, const shb_quick_bias *bias, size_t count,
                           const shb_receivers *r, float *visibility, uint16_t *doubtful) {
    const shb_quick_extent extent = extent_of(count, bias->plane, r);
    shb_quick_test t;
    if (!can_gather(map) || !shb_quick_test_of(map, bias, &extent, &t))
        return SIZE_MAX;
    if (map->projection.affine)
        return bias->plane
                   ? test_lanes_quickly(map, &t, true, true, count, r, visibility, doubtful)
                   : test_lanes_quickly(map, &t, true, false, count, r, visibility, doubtful);
    return bias->plane ? test_lanes_quickly(map, &t, false, true, count, r, visibility, doubtful)
                       : test_lanes_quickly(map, &t, false, false, count, r, visibility, doubtful);
}
