/* The hard test in float: quick_test.c derives what is sure. */

static inline ALWAYS_INLINE float largest_lane(vf v) {
    float largest = 0;
    for (int i = 0; i < WIDE; i++)
        largest = v[i] > largest ? v[i] : largest;
    return largest;
}

/* The largest way from an origin among lanes. NaN may be left out: its lane is never sure. */
static inline ALWAYS_INLINE float largest_way(size_t lanes, const float *x, const float *y,
                                              const float *z, const float *origin) {
    const float ox = origin[0], oy = origin[1], oz = origin[2];
    vf reach_x = vf_splat(0), reach_y = reach_x, reach_z = reach_x;
    for (size_t i = 0; i < lanes; i += WIDE) {
        reach_x = vf_max(vf_abs(vf_load(x + i) - ox), reach_x);
        reach_y = vf_max(vf_abs(vf_load(y + i) - oy), reach_y);
        reach_z = vf_max(vf_abs(vf_load(z + i) - oz), reach_z);
    }
    return largest_lane(vf_max(vf_max(reach_x, reach_y), reach_z));
}

static inline ALWAYS_INLINE shb_quick_extent extent_of(size_t count, bool plane,
                                                       const shb_receivers *r) {
    static const float none[3] = {0, 0, 0};
    const size_t middle = count / 2, lanes = shb_round_to_lanes(count);
    shb_quick_extent extent = {.origin = {r->x[middle], r->y[middle], r->z[middle]}};
    extent.reach = largest_way(lanes, r->x, r->y, r->z, extent.origin);
    if (plane)
        extent.normal = largest_way(lanes, r->normal_x, r->normal_y, r->normal_z, none);
    return extent;
}

static inline ALWAYS_INLINE vf quick_dot(const float *row, vf x, vf y, vf z) {
    return (row[0] * x + row[1] * y) + row[2] * z;
}

/* The texel of a coordinate and the way to its centre, which is as far as a border where it is not
 * sure: NaN counts as such. */
static inline ALWAYS_INLINE vf split_texel(vf value, vi *texel) {
    value = vf_where(value < 0x1p23f, value, vf_splat(0));
    *texel = __builtin_convertvector(value, vi);
    return 0.5f - (value - __builtin_convertvector(*texel, vf));
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
    const int32_t stride = (int32_t)(map->depth.stride / 4);
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
        const vf center_x = split_texel(x, &texel_x), center_y = split_texel(y, &texel_y);
        const vi is_sure = (vf_abs(center_x) < t.sure_x) & (vf_abs(center_y) < t.sure_y);
        texel_x += t.texel_x;
        texel_y += t.texel_y;
        const vi inside = (vi)((vu)texel_x < width) & (vi)((vu)texel_y < height);
        vi_store(out->place + i, inside & (texel_y * stride + texel_x));
        for (size_t lane = 0; lane < WIDE; lane++)
            __builtin_prefetch(texels + out->place[i + lane]);
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
