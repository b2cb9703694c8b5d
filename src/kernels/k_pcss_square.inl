/* Every texel of a square as a tap of pcss, WIDE texels of one fragment at a time. */

#define SQUARE SHB_SQUARE_LANES
#define SQUARE_PARTS (SQUARE / WIDE)

/* SQUARE texels of a row, as they are stored, from a column on that may lie outside the map. */
static const float *read_row(const shb_map *map, int32_t column, int32_t row, float *texels) {
    const int32_t width = (int32_t)map->info.width;
    const char *start = (const char *)map->depth.texels + (size_t)row * map->depth.stride;
    if (map->info.format == SHB_FORMAT_FLOAT32 && column >= 0 && column + SQUARE <= width)
        return (const float *)(const void *)start + column;
    int32_t columns[SQUARE], rows[SQUARE];
    for (int i = 0; i < SQUARE; i++) {
        const bool inside = column + i >= 0 && column + i < width;
        columns[i] = inside ? column + i : 0;
        rows[i] = row;
    }
    read_texels(map, SQUARE, columns, rows, texels);
    for (int i = 0; i < SQUARE; i++)
        if (column + i < 0 || column + i >= width)
            texels[i] = map->info.view.reversed ? 0.0f : 1.0f;
    return texels;
}

/* The part of a texel that the square covers along the axis. */
static inline ALWAYS_INLINE vf cover_lanes(const shb_square_axis *axis, vf texel) {
    const vf off = texel - axis->center;
    const vf covered = axis->reach - vf_max(off, -off);
    return vf_min(vf_max(covered, vf_splat(0)), vf_splat(1));
}

static float sum_square(const vf *parts) {
    float lanes[SQUARE];
    memcpy(lanes, parts, sizeof lanes);
    return shb_square_sum(lanes);
}

/* Of hits, by the exact method, taps that are shadowed, in a row of fragment number lane. */
static vi pcss_shadowed_in_row(const pcss_lanes *own, int lane, vi hits, int32_t m, int32_t n,
                               vf stored) {
    const size_t i = own->first + (size_t)lane;
    if (own->sheets)
        hits &= ~on_sheet(own->sheets, i, m, n);
    return vi_any(hits) ? shadowed_taps_of_one(own->mutual, i, hits, m, n, stored) : hits;
}

/* Every texel that the square about fragment number lane covers, weighed by the part covered. */
static inline ALWAYS_INLINE void ask_square(const shb_pcss *pcss, const shb_map *map,
                                            const pcss_lanes *own, int lane, float radius_x,
                                            float radius_y, bool sums, pcss_blocked *blocked) {
    const shb_square_axis across = shb_square_axis_of(own->to_center_x[lane], radius_x);
    const shb_square_axis down = shb_square_axis_of(own->to_center_y[lane], radius_y);
    const int32_t own_x = own->texel_x[lane], own_y = own->texel_y[lane];
    const float ref = own->ref[lane], step_x = own->step_x[lane], step_y = own->step_y[lane];
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    const vf far_depth = vf_splat(pcss->far_depth);
    float height = 0;
    for (int32_t n = down.first; n <= down.last; n++)
        height += shb_square_cover(&down, n);
    const int32_t top = down.first < -own_y ? -own_y : down.first;
    const int32_t rows_below = (int32_t)map->info.height - 1 - own_y;
    const int32_t bottom = down.last < rows_below ? down.last : rows_below;
    vf weight[SQUARE_PARTS] = {{0}}, depth[SQUARE_PARTS] = {{0}}, all[SQUARE_PARTS] = {{0}};
    float lanes[SQUARE], texels[SQUARE];
    for (int32_t first = across.first; first <= across.last; first += SQUARE) {
        vf width[SQUARE_PARTS], tap[SQUARE_PARTS];
        vf row_weight[SQUARE_PARTS] = {{0}}, row_depth[SQUARE_PARTS] = {{0}};
        for (int i = 0; i < SQUARE; i++)
            lanes[i] = (float)(first + i);
        for (int p = 0; p < SQUARE_PARTS; p++) {
            const vf m = vf_load(lanes + p * WIDE);
            width[p] = cover_lanes(&across, m);
            tap[p] = vf_where(width[p] > 0, ref + m * step_x, vf_splat(-INFINITY));
        }
        for (int32_t n = top; n <= bottom; n++) {
            const float *stored = read_row(map, own_x + first, own_y + n, texels);
            const vf part = vf_splat(shb_square_cover(&down, n));
            const float run = (float)n * step_y;
            for (int p = 0; p < SQUARE_PARTS; p++) {
                const vf texel = sign * vf_load(stored + p * WIDE);
                vi hit = texel < vf_min(tap[p] + run, far_depth);
                if (own->mutual && vi_any(hit))
                    hit = pcss_shadowed_in_row(own, lane, hit, first + p * WIDE, n, texel);
                row_weight[p] += vf_keep(hit, part);
                if (sums)
                    row_depth[p] += vf_keep(hit, part * texel);
            }
        }
        for (int p = 0; p < SQUARE_PARTS; p++) {
            weight[p] += width[p] * row_weight[p];
            depth[p] += width[p] * row_depth[p];
            all[p] += width[p] * height;
        }
    }
    blocked->weight[lane] = sum_square(weight);
    blocked->depth[lane] = sum_square(depth);
    blocked->all[lane] = sum_square(all);
}
