/* The exact method on maps that keep planes: the test of mutual planes (shb_exact_is_shadowed) of
 * each fragment and the texel that holds it. Most lit fragments are told by less, a part of the
 * bound: the texel's depth does not lie in front of their own planes, or they do not lie behind the
 * texel's plane, by more than their positions are rounded, (1) of light_point.h without its
 * factor. */

/* Fragments and the texels that hold them. */
typedef struct plane_batch {
    SHB_ALIGN double limit[SHB_BATCH]; /* depths from here on do not shadow the fragment */
    double x[SHB_BATCH], y[SHB_BATCH], z[SHB_BATCH], inverse_w[SHB_BATCH];
    double center_x[SHB_BATCH], center_y[SHB_BATCH]; /* of the texel */
    int32_t column[SHB_BATCH], row[SHB_BATCH];
    float depth[SHB_BATCH]; /* infinite where there is no occluder */
    float slope_x[SHB_BATCH], slope_y[SHB_BATCH];
} plane_batch;

/* How far a plane of these slopes through the rounded point misses the true one, to first order. */
static inline ALWAYS_INLINE wd moved_by(const shb_light_rows *rows, bool affine,
                                        const wd position[3], wd x, wd y, wd z, wd inverse_w,
                                        wd slope_x, wd slope_y) {
    wd moved = wd_splat(0.0);
    for (int k = 0; k < 3; k++) {
        wd a = wd_splat(rows->x[k]), b = wd_splat(rows->y[k]), c = wd_splat(rows->z[k]);
        if (!affine) {
            a -= x * rows->w[k];
            b -= y * rows->w[k];
            c -= z * rows->w[k];
        }
        moved += wd_abs(c - slope_x * a - slope_y * b) * wd_abs(position[k]);
    }
    moved *= SHB_FLOAT_ROUNDING;
    if (!affine)
        moved *= inverse_w;
    return moved;
}

/* A fragment's own plane at the centre of its texel, less what is taken of the bound; all of it
 * also covers that slopes are not calculated as here. */
static inline ALWAYS_INLINE wd own_limit(const shb_projection *p, const shb_light_rows *rows,
                                         bool affine, const wd position[3], const wd n[3], wd x,
                                         wd y, wd z, wd inverse_w, wd to_x, wd to_y) {
    const wd zero = wd_splat(0.0);
    wd ab = dot(p->x_cross_y, n[0], n[1], n[2]);
    wd cb = dot(p->z_cross_y, n[0], n[1], n[2]);
    wd ac = dot(p->x_cross_z, n[0], n[1], n[2]);
    if (!affine) {
        const wd n_xw = dot(p->x_cross_w, n[0], n[1], n[2]);
        const wd n_yw = dot(p->y_cross_w, n[0], n[1], n[2]);
        const wd n_zw = dot(p->z_cross_w, n[0], n[1], n[2]);
        ab = ab - y * n_xw + x * n_yw;
        cb = cb - y * n_zw + z * n_yw;
        ac = ac - z * n_xw + x * n_zw;
    }
    const wd inverse = 1.0 / ab;
    const wd squared = SHB_DOT(n, n);
    const wd usable = wd_where_greater(wd_splat((double)INFINITY), squared, squared, zero);
    const wd slope_x = wd_where_greater(usable, zero, cb * inverse, zero);
    const wd slope_y = wd_where_greater(usable, zero, ac * inverse, zero);
    const wd moved = moved_by(rows, affine, position, x, y, z, inverse_w, slope_x, slope_y);
    return z + (slope_x * to_x + slope_y * to_y) - moved;
}

/* Fragments behind the light come to lie outside of the map. */
static inline ALWAYS_INLINE void place_as(const shb_map *map, bool affine, size_t lanes,
                                          const shb_receivers *restrict r,
                                          plane_batch *restrict batch) {
    const shb_projection p = map->projection;
    const shb_light_rows rows = map->rows;
    const double limit = -(double)SHB_TEXEL_NONE;
    const wd zero = wd_splat(0.0), none = wd_splat((double)SHB_TEXEL_NONE);
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        const wd position[3] = {wd_load_floats(r->x + i), wd_load_floats(r->y + i),
                                wd_load_floats(r->z + i)};
        const wd normal[3] = {wd_load_floats(r->normal_x + i), wd_load_floats(r->normal_y + i),
                              wd_load_floats(r->normal_z + i)};
        wd x = row_at(rows.x, position[0], position[1], position[2]);
        wd y = row_at(rows.y, position[0], position[1], position[2]);
        wd z = row_at(rows.z, position[0], position[1], position[2]);
        wd inverse_w = wd_splat(1.0);
        if (!affine) {
            const wd w = row_at(rows.w, position[0], position[1], position[2]);
            inverse_w = 1.0 / w;
            x = wd_where_greater(w, zero, x * inverse_w, none);
            y *= inverse_w;
            z *= inverse_w;
        }
        const wd column = wd_floor(limited(x, limit)), row = wd_floor(limited(y, limit));
        const wd center_x = column + 0.5, center_y = row + 0.5;
        wd_store(batch->x + i, x);
        wd_store(batch->y + i, y);
        wd_store(batch->z + i, z);
        if (!affine)
            wd_store(batch->inverse_w + i, inverse_w);
        wd_store(batch->center_x + i, center_x);
        wd_store(batch->center_y + i, center_y);
        wd_store_ints(batch->column + i, column);
        wd_store_ints(batch->row + i, row);
        wd_store(batch->limit + i, own_limit(&p, &rows, affine, position, normal, x, y, z,
                                             inverse_w, center_x - x, center_y - y));
    }
}

static NEVER_INLINE void place_fragments(const shb_map *map, size_t lanes, const shb_receivers *r,
                                         plane_batch *batch) {
    if (map->projection.affine)
        place_as(map, true, lanes, r, batch);
    else
        place_as(map, false, lanes, r, batch);
}

/* Two halves a lane, x in the lower one, as shb_half_to_float. */
static inline ALWAYS_INLINE vf widen_halves(vu halves) {
    const vu magnitude = (halves & 0x7fff) << 13;
    const vu size = (vu)((vf)magnitude * 0x1p112f);
    const vu infinite = (vu)(magnitude >= 0x7c00u << 13) & 0x7f800000u;
    return (vf)(size | (halves & 0x8000) << 16 | infinite);
}

/* Bits of WIDE fragments whose own planes their texels' depths lie in front of. */
static inline ALWAYS_INLINE uint32_t in_front_at(const plane_batch *batch, size_t i) {
    uint32_t in_front = 0;
    for (size_t k = 0; k < WIDE; k += DOUBLES)
        in_front |=
            wd_greater_bits(wd_load(batch->limit + i + k), wd_load_floats(batch->depth + i + k))
            << k;
    return in_front;
}

/* The slopes that WIDE texels hold, where they are asked for. */
static inline ALWAYS_INLINE void read_slopes(const shb_map *map, bool gathers, plane_batch *batch,
                                             size_t i, uint32_t asked) {
    const char *texels = (const char *)map->occluders.texels;
    const size_t stride = map->occluders.stride;
    const vf far_depth = vf_splat(shb_far_depth(map->info.view.reversed));
    const vf depth = vf_load(batch->depth + i);
    const vi holds = (vi)(depth < far_depth);
    const vi read = holds & ((vi_splat((int32_t)asked) >> vi_numbers() & 1) != 0);
    const vi column = vi_load(batch->column + i) & read, row = vi_load(batch->row + i) & read;
    vu slopes;
    if (gathers)
        slopes = (vu)vf_gather((const float *)(const void *)texels,
                               row * (int32_t)(stride / 4) + column);
    else
        for (int k = 0; k < WIDE; k++)
            slopes[k] = shb_occluder_row(map, row[k])[column[k]];
    vf_store(batch->depth + i, vf_where(holds, depth, vf_splat(INFINITY)));
    vf_store(batch->slope_x + i, widen_halves(slopes));
    vf_store(batch->slope_y + i, widen_halves(slopes >> 16));
}

static inline ALWAYS_INLINE wide_exact_sample samples_at(const plane_batch *batch, double unit,
                                                         size_t i) {
    const double smallest = SHB_HALF_ABSOLUTE * unit;
    const wd slope_x = wd_load_floats(batch->slope_x + i) * unit;
    const wd slope_y = wd_load_floats(batch->slope_y + i) * unit;
    return (wide_exact_sample){.center_x = wd_load(batch->center_x + i),
                               .center_y = wd_load(batch->center_y + i),
                               .depth = wd_load_floats(batch->depth + i),
                               .slope_x = slope_x,
                               .slope_y = slope_y,
                               .slope_error_x = wd_abs(slope_x) * SHB_HALF_RELATIVE + smallest,
                               .slope_error_y = wd_abs(slope_y) * SHB_HALF_RELATIVE + smallest};
}

/* Bits of fragments that lie behind their texels' planes. */
static inline ALWAYS_INLINE uint32_t behind_at(const shb_map *map, bool affine,
                                               const shb_receivers *r, const plane_batch *batch,
                                               size_t i) {
    const wd position[3] = {wd_load_floats(r->x + i), wd_load_floats(r->y + i),
                            wd_load_floats(r->z + i)};
    const wide_exact_sample samples = samples_at(batch, map->occluders.slope_unit, i);
    const wd x = wd_load(batch->x + i), y = wd_load(batch->y + i), z = wd_load(batch->z + i);
    const wd inverse_w = affine ? wd_splat(1.0) : wd_load(batch->inverse_w + i);
    const wd to_x = samples.center_x - x, to_y = samples.center_y - y;
    const wd plane = samples.depth - (samples.slope_x * to_x + samples.slope_y * to_y);
    const wd moved = moved_by(&map->rows, affine, position, x, y, z, inverse_w, samples.slope_x,
                              samples.slope_y);
    return wd_greater_bits(z - plane, moved + (samples.slope_error_x * wd_abs(to_x) +
                                               samples.slope_error_y * wd_abs(to_y)));
}

static NEVER_INLINE void test_planes(const shb_map *map, const shb_receivers *restrict r,
                                     const plane_batch *restrict batch, size_t i,
                                     float *restrict visibility) {
    const wd position[3] = {wd_load_floats(r->x + i), wd_load_floats(r->y + i),
                            wd_load_floats(r->z + i)};
    const wd normal[3] = {wd_load_floats(r->normal_x + i), wd_load_floats(r->normal_y + i),
                          wd_load_floats(r->normal_z + i)};
    const wide_exact_sample samples = samples_at(batch, map->occluders.slope_unit, i);
    const wide_light_point points = wide_light_point_at(&map->rows, position, SHB_FLOAT_ROUNDING);
    const wide_light_slopes slopes = wide_exact_slopes_of(&map->rows, &points, normal);
    const wd errors = wide_exact_error_of(&points, &slopes);
    const uint32_t shadowed = wide_exact_shadowed_bits(&points, &slopes, errors, &samples);
    for (size_t k = 0; k < DOUBLES; k++)
        visibility[i + k] = shadowed >> k & 1 ? 0.0f : 1.0f;
}

static inline ALWAYS_INLINE void ask_planes_as(const shb_map *map, bool affine, bool gathers,
                                               size_t lanes, const shb_receivers *receivers,
                                               float *visibility) {
    plane_batch batch;
    uint16_t near[SHB_BATCH], unsure[SHB_BATCH];
    size_t near_count = 0, unsure_count = 0;
    place_fragments(map, lanes, receivers, &batch);
    fetch_whole(map, lanes, batch.column, batch.row, batch.depth);
    for (size_t i = 0; i < lanes; i += WIDE) {
        near[near_count] = (uint16_t)i;
        near_count += in_front_at(&batch, i) != 0;
        vf_store(visibility + i, vf_splat(1.0f));
    }
    for (size_t n = 0; n < near_count; n++)
        read_slopes(map, gathers, &batch, near[n], in_front_at(&batch, near[n]));
    for (size_t n = 0; n < near_count; n++)
        for (size_t i = near[n]; i < near[n] + (size_t)WIDE; i += DOUBLES) {
            const uint32_t in_front =
                wd_greater_bits(wd_load(batch.limit + i), wd_load_floats(batch.depth + i));
            unsure[unsure_count] = (uint16_t)i;
            unsure_count += (in_front & behind_at(map, affine, receivers, &batch, i)) != 0;
        }
    for (size_t n = 0; n < unsure_count; n++)
        test_planes(map, receivers, &batch, unsure[n], visibility);
}

static void ask_planes(const shb_map *map, size_t count, const shb_receivers *receivers,
                       float *visibility) {
    const size_t lanes = shb_round_to_lanes(count);
    const bool gathers = map->occluders.stride / 4 <= (size_t)INT32_MAX / map->info.height;
    if (!gathers)
        ask_planes_as(map, false, false, lanes, receivers, visibility);
    else if (map->projection.affine)
        ask_planes_as(map, true, true, lanes, receivers, visibility);
    else
        ask_planes_as(map, false, true, lanes, receivers, visibility);
}
