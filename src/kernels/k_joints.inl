/* Which neighbouring texels hold one sheet. Two planes alone know nothing of what turns between
 * them: on a relief, a terrain or a saddle a tap's plane may pass in front of the fragment though
 * the surface goes on from the one to the other. So one goes from texel to texel, where planes meet
 * between the two centres, within their rounding. The planes of an occluder's edge and of what lies
 * behind it do not: each lies in front of the other, or behind it, at both centres. */

/* What a depth may be off by: of the depth itself what drawing and the sums here leave, and a step
 * of the map's format between two of them. */
#define SHEET_DEPTH_ERROR (8 * (float)SHB_FLOAT_ROUNDING)

/* The texels of a block's row and those to the right of it, in whole vectors. */
#define SHEET_ROW (SHB_JOINT_COLUMNS + WIDE)

/* Their planes, reversed depths negated; z is NaN where a texel holds no occluder, whose slopes may
 * be anything. */
typedef struct sheet_row {
    float z[SHEET_ROW], slope_x[SHEET_ROW], slope_y[SHEET_ROW];
    float beside[SHEET_ROW], askew[SHEET_ROW]; /* what depths are off by in the next texels */
} sheet_row;

/* From a column on; empty beyond the map. */
static inline ALWAYS_INLINE void read_sheet_row(const shb_map *map, int32_t column, int32_t row,
                                                sheet_row *out) {
    const bool reversed = map->info.view.reversed;
    const float far_depth = shb_far_depth(reversed), unit = step_unit(map);
    const float least = shb_format_step(map->info.format) / 2;
    const int32_t left = (int32_t)map->info.width - column;
    const int32_t count = row >= (int32_t)map->info.height ? 0
                          : left < SHEET_ROW               ? left
                                                           : SHEET_ROW;
    float depths[SHEET_ROW];
    uint32_t occluders[SHEET_ROW];
    for (int i = 0; i < SHEET_ROW; i++) {
        depths[i] = far_depth;
        occluders[i] = 0;
    }
    if (count) {
        decode_texels(map, row, column, count, depths);
        memcpy(occluders, shb_occluder_row(map, row) + column, (size_t)count * sizeof *occluders);
    }
    for (int i = 0; i < SHEET_ROW; i += WIDE) {
        const vf depth = vf_load(depths + i), z = reversed ? -depth : depth;
        const vu texels = vu_load(occluders + i);
        const texel_slopes slopes = slopes_of_texels(texels, unit);
        const vi known = (z < far_depth) & have_slopes(texels);
        vf_store(out->z + i, vf_where(known, z, vf_splat(NAN)));
        vf_store(out->slope_x + i, slopes.x);
        vf_store(out->slope_y + i, slopes.y);
        const vf error = (SHEET_DEPTH_ERROR * vf_abs(z) + least) + slopes.error;
        vf_store(out->beside + i, error);
        vf_store(out->askew + i, error + slopes.error);
    }
}

/* Planes of WIDE texels. */
typedef struct sheet_planes {
    vf z, slope_x, slope_y, beside, askew;
} sheet_planes;

static inline ALWAYS_INLINE sheet_planes sheet_planes_at(const sheet_row *row, int i) {
    return (sheet_planes){vf_load(row->z + i), vf_load(row->slope_x + i), vf_load(row->slope_y + i),
                          vf_load(row->beside + i), vf_load(row->askew + i)};
}

/* A bit where the planes meet between the centres, not where one is NaN. to_b: what a's plane rises
 * from its centre to b's; by_b: what b's does; error: what both are off by. */
static inline ALWAYS_INLINE uint64_t planes_meet(const sheet_planes *a, vf to_b,
                                                 const sheet_planes *b, vf by_b, vf error) {
    const vf b_behind = b->z - (a->z + to_b), a_behind = a->z - (b->z - by_b);
    const vf apart = vf_min(vf_max(a_behind, b_behind), -vf_min(a_behind, b_behind));
    return vi_bits(apart <= error);
}

/* Of a block's row with itself and the next one. */
static inline ALWAYS_INLINE void join_row(const sheet_row *upper, const sheet_row *lower,
                                          _Atomic uint64_t *words) {
    uint64_t to_right = 0, down = 0, falling = 0, rising = 0;
    for (int i = 0; i < SHB_JOINT_COLUMNS; i += WIDE) {
        const sheet_planes left = sheet_planes_at(upper, i), right = sheet_planes_at(upper, i + 1);
        const sheet_planes below = sheet_planes_at(lower, i),
                           across = sheet_planes_at(lower, i + 1);
        to_right |=
            planes_meet(&left, left.slope_x, &right, right.slope_x, left.beside + right.beside)
            << i;
        down |= planes_meet(&left, left.slope_y, &below, below.slope_y, left.beside + below.beside)
                << i;
        falling |= planes_meet(&left, left.slope_x + left.slope_y, &across,
                               across.slope_x + across.slope_y, left.askew + across.askew)
                   << i;
        rising |= planes_meet(&right, right.slope_y - right.slope_x, &below,
                              below.slope_y - below.slope_x, right.askew + below.askew)
                  << i;
    }
    for (int i = 0; i < SHB_JOINT_COLUMNS / SHB_JOINT_WORD; i++) {
        const int from = i * SHB_JOINT_WORD;
        const uint64_t word = (to_right >> from & 0xffff) | (down >> from & 0xffff) << 16 |
                              (falling >> from & 0xffff) << 32 | (rising >> from & 0xffff) << 48;
        atomic_store_explicit(&words[i], word, memory_order_relaxed);
    }
}

static NEVER_INLINE void find_block(const shb_map *map, int32_t column, int32_t row) {
    const shb_joints *joints = &map->occluders.joints;
    const int32_t x = column * SHB_JOINT_COLUMNS, y = row * SHB_JOINT_ROWS;
    const int32_t left = (int32_t)map->info.height - y;
    const int32_t count = left < SHB_JOINT_ROWS ? left : SHB_JOINT_ROWS;
    _Atomic uint64_t *words =
        joints->words + (size_t)y * joints->pitch + SHB_JOINT_MARGIN + x / SHB_JOINT_WORD;
    sheet_row rows[2];
    read_sheet_row(map, x, y, &rows[0]);
    for (int32_t k = 0; k < count; k++) {
        read_sheet_row(map, x, y + k + 1, &rows[(k + 1) % 2]);
        join_row(&rows[k % 2], &rows[(k + 1) % 2], words + (size_t)k * joints->pitch);
    }
    atomic_store_explicit(&joints->found[(size_t)row * joints->columns + (size_t)column], 1,
                          memory_order_release);
}

static inline ALWAYS_INLINE uint8_t is_found(const shb_joints *joints, size_t column, size_t row) {
    return atomic_load_explicit(&joints->found[row * joints->columns + column],
                                memory_order_acquire);
}

/* The blocks that hold texels of the map in these columns and rows are found from here on. */
static inline ALWAYS_INLINE void need_joints(const shb_map *map, uint32_t left, uint32_t right,
                                             uint32_t top, uint32_t bottom) {
    const shb_joints *joints = &map->occluders.joints;
    const uint32_t first_x = left / SHB_JOINT_COLUMNS, last_x = right / SHB_JOINT_COLUMNS;
    const uint32_t first_y = top / SHB_JOINT_ROWS, last_y = bottom / SHB_JOINT_ROWS;
    if (last_y - first_y < 2 &&
        is_found(joints, first_x, first_y) & is_found(joints, last_x, first_y) &
            is_found(joints, first_x, last_y) & is_found(joints, last_x, last_y))
        return;
    for (uint32_t row = first_y; row <= last_y; row++)
        for (uint32_t column = first_x; column <= last_x; column++)
            if (!is_found(joints, column, row))
                find_block(map, (int32_t)column, (int32_t)row);
}
