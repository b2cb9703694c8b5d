/* Projection of a batch: world positions and planes as the light's map sees them. */

static inline ALWAYS_INLINE wd dot(const double *row, wd x, wd y, wd z) {
    return (row[0] * x + row[1] * y) + row[2] * z;
}

static inline ALWAYS_INLINE wd row_at(const double *row, wd x, wd y, wd z) {
    return dot(row, x, y, z) + row[3];
}

/* Cut off at both ends; NaN becomes the lower one. */
static inline ALWAYS_INLINE wd limited(wd value, double limit) {
    return wd_min(wd_max(value, wd_splat(-limit)), wd_splat(limit));
}

typedef uint64_t wd_bits __attribute__((vector_size(8 * DOUBLES)));

static inline ALWAYS_INLINE wd_bits bits_of(wd v) {
    wd_bits bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

static inline ALWAYS_INLINE bool any_signed(wd_bits bits) {
    wd numbers;
    memcpy(&numbers, &bits, sizeof numbers);
    return wd_any_signed(numbers);
}

/* Signed in lanes where a number without sign is NaN or beyond the limit. Such numbers are ordered
 * as their bits are, which spares the few units that add and compare doubles. */
static inline ALWAYS_INLINE wd_bits beyond(wd value, double limit) {
    return bits_of(wd_splat(limit)) - bits_of(value);
}

/* Cut off at one map depth per texel; 0 if undefined. */
static inline ALWAYS_INLINE wd limited_slope(wd slope) {
    return wd_where_equal(slope, slope, limited(slope, 1.0), wd_splat(0.0));
}

/* The rows' first three elements act on directions. A step v in the world moves the point by
 * a.v / w, b.v / w, c.v / w in x, y, z, where a = row_x - x row_w, and b and c likewise. Within the
 * plane at constant y the step is b x n, so dz/dx = n.(c x b) / n.(a x b); at constant x it is a x
 * n, so dz/dy = n.(a x c) / n.(a x b). Written out, the cross products are sums of constant
 * vectors, of which those with row_w are zero in an affine map. */
static inline ALWAYS_INLINE void write_slopes(const shb_projection *p, bool affine, wd x, wd y,
                                              wd z, shb_receivers *restrict r, size_t i) {
    const wd nx = wd_load_floats(r->normal_x + i), ny = wd_load_floats(r->normal_y + i);
    const wd nz = wd_load_floats(r->normal_z + i);
    wd ab = dot(p->x_cross_y, nx, ny, nz);
    wd cb = dot(p->z_cross_y, nx, ny, nz);
    wd ac = dot(p->x_cross_z, nx, ny, nz);
    if (!affine) {
        const wd n_xw = dot(p->x_cross_w, nx, ny, nz);
        const wd n_yw = dot(p->y_cross_w, nx, ny, nz);
        const wd n_zw = dot(p->z_cross_w, nx, ny, nz);
        ab = ab - y * n_xw + x * n_yw;
        cb = cb - y * n_zw + z * n_yw;
        ac = ac - z * n_xw + x * n_zw;
    }
    wd slope_x = cb / ab, slope_y = ac / ab;
    if (!affine || any_signed(beyond(wd_abs(slope_x), 1.0) | beyond(wd_abs(slope_y), 1.0))) {
        slope_x = limited_slope(slope_x);
        slope_y = limited_slope(slope_y);
    }
    wd_store_floats(r->slope_x + i, slope_x);
    wd_store_floats(r->slope_y + i, slope_y);
}

static inline ALWAYS_INLINE void write_scales(const shb_projection *p, wd w,
                                              shb_receivers *restrict r, size_t i) {
    const wd largest = wd_splat((double)FLT_MAX);
    wd_store_floats(r->texel_size + i, wd_min(p->texel_scale * w, largest));
    wd_store_floats(r->depth_per_world + i, wd_min(p->depth_scale / (w * w), largest));
}

/* Neither a conversion to int nor a filter's walk from there may overflow. */
static const double texel_limit = -(double)SHB_TEXEL_NONE;

/* True if in all lanes x and y have no sign and nothing is NaN or beyond the limit. */
static inline ALWAYS_INLINE bool are_ordinary(wd x, wd y, wd z) {
    return !any_signed(bits_of(x) | beyond(x, texel_limit) | bits_of(y) | beyond(y, texel_limit) |
                       beyond(wd_abs(z), texel_limit));
}

static inline ALWAYS_INLINE void write_texels(wd column, wd row, wd depth, bool centers,
                                              shb_receivers *restrict r, size_t i) {
    const wd texel_x = wd_floor(column), texel_y = wd_floor(row);
    wd_store_ints(r->texel_x + i, texel_x);
    wd_store_ints(r->texel_y + i, texel_y);
    if (centers) {
        wd_store_floats(r->to_center_x + i, texel_x + 0.5 - column);
        wd_store_floats(r->to_center_y + i, texel_y + 0.5 - row);
    }
    wd_store_floats(r->depth + i, depth);
}

/* A point that has no coordinates, behind the light or not finite, gets NaN for all three. */
static inline ALWAYS_INLINE void project(const shb_map *map, bool affine, bool scale, bool slope,
                                         bool centers, size_t count, const shb_next_batch *next,
                                         shb_receivers *restrict r) {
    const shb_projection p = map->projection;
    const shb_light_rows rows = map->rows;
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), none = wd_splat((double)NAN);
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        if (i % SHB_LINE_FLOATS == 0)
            shb_prefetch_next(next, i);
        const wd px = wd_load_floats(r->x + i), py = wd_load_floats(r->y + i);
        const wd pz = wd_load_floats(r->z + i);
        wd x = row_at(rows.x, px, py, pz);
        wd y = row_at(rows.y, px, py, pz);
        wd z = row_at(rows.z, px, py, pz);
        wd w = one;
        if (!affine) {
            w = row_at(rows.w, px, py, pz);
            const wd inverse = wd_where_greater(w, zero, 1.0 / w, none);
            x *= inverse;
            y *= inverse;
            z *= inverse;
        }
        if (are_ordinary(x, y, z)) {
            z += 0.0; /* what good does to -0 */
            write_texels(x, y, z, centers, r, i);
        } else {
            const wd good = (x + y + z) * 0.0; /* or NaN */
            x += good;
            y += good;
            z += good;
            w = wd_where_equal(good, zero, w, one);
            write_texels(limited(x, texel_limit), limited(y, texel_limit), limited(z, texel_limit),
                         centers, r, i);
        }
        if (scale)
            write_scales(&p, w, r, i);
        if (slope)
            write_slopes(&p, affine, x, y, z, r, i);
    }
}

/* The scales of an affine map are those of w = 1 everywhere. */
static void fill_scales(const shb_projection *projection, size_t count, shb_receivers *restrict r) {
    const double largest = (double)FLT_MAX;
    const float texel_size = (float)fmin(projection->texel_scale, largest);
    const float depth_per_world = (float)fmin(projection->depth_scale, largest);
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        r->texel_size[i] = texel_size;
        r->depth_per_world[i] = depth_per_world;
    }
}

static inline ALWAYS_INLINE void project_perspective(const shb_map *map, bool scale, bool slope,
                                                     bool centers, size_t count,
                                                     const shb_next_batch *next,
                                                     shb_receivers *receivers) {
    if (scale)
        project(map, false, true, slope, centers, count, next, receivers);
    else
        project(map, false, false, slope, centers, count, next, receivers);
}

/* Slopes are asked for together with centres. */
static void project_batch(const shb_map *map, uint32_t needs, size_t count,
                          const shb_next_batch *next, shb_receivers *receivers) {
    const bool scale = (needs & SHB_NEEDS_SCALE) != 0, slope = (needs & SHB_NEEDS_SLOPE) != 0;
    const bool centers = (needs & SHB_NEEDS_CENTERS) != 0;
    if (map->projection.affine) {
        if (slope)
            project(map, true, false, true, true, count, next, receivers);
        else if (centers)
            project(map, true, false, false, true, count, next, receivers);
        else
            project(map, true, false, false, false, count, next, receivers);
        if (scale)
            fill_scales(&map->projection, count, receivers);
    } else if (slope) {
        project_perspective(map, scale, true, true, count, next, receivers);
    } else if (centers) {
        project_perspective(map, scale, false, true, count, next, receivers);
    } else {
        project_perspective(map, scale, false, false, count, next, receivers);
    }
}

static void turn_normals(const shb_projection *projection, size_t count,
                         shb_receivers *restrict r) {
    const shb_projection p = *projection;
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), none = wd_splat((double)NAN);
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        const wd away_x = p.light[0] - p.light_w * wd_load_floats(r->x + i);
        const wd away_y = p.light[1] - p.light_w * wd_load_floats(r->y + i);
        const wd away_z = p.light[2] - p.light_w * wd_load_floats(r->z + i);
        const wd length = wd_sqrt((away_x * away_x + away_y * away_y) + away_z * away_z);
        const wd scale = 1.0 / wd_where_greater(length, zero, length, one);
        const wd light_x = away_x * scale, light_y = away_y * scale, light_z = away_z * scale;
        const wd nx = wd_load_floats(r->normal_x + i), ny = wd_load_floats(r->normal_y + i);
        const wd nz = wd_load_floats(r->normal_z + i);
        const wd squared = (nx * nx + ny * ny) + nz * nz;
        const wd usable = wd_where_greater(squared, zero, squared, none) * 0.0; /* 0 or NaN */
        const wd cosine = (nx * light_x + ny * light_y) + nz * light_z;
        const wd side = wd_where_greater(zero, cosine, wd_splat(-1.0), one);
        const wd size = wd_min(cosine * side, one);
        wd_store_floats(r->normal_x + i, wd_where_equal(usable, zero, side * nx, light_x));
        wd_store_floats(r->normal_y + i, wd_where_equal(usable, zero, side * ny, light_y));
        wd_store_floats(r->normal_z + i, wd_where_equal(usable, zero, side * nz, light_z));
        wd_store_floats(r->cosine + i, wd_where_equal(usable, zero, size, one));
    }
}

static void load_triples(const float *restrict triples, size_t count, float *restrict x,
                         float *restrict y, float *restrict z) {
    size_t i = 0;
    for (; i + WIDE <= count; i += WIDE) {
        vf t[3];
        vf_read_triples(triples + 3 * i, t);
        vf_store(x + i, t[0]);
        vf_store(y + i, t[1]);
        vf_store(z + i, t[2]);
    }
    for (; i < shb_round_to_lanes(count); i++) {
        const float *triple = triples + 3 * (i < count ? i : count - 1);
        x[i] = triple[0];
        y[i] = triple[1];
        z[i] = triple[2];
    }
}
