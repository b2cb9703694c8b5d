/* The sheet that a fragment stands on, followed through its box of texels. Two planes alone know
 * nothing of what turns between them: on a relief, a terrain or a saddle a tap's plane may pass in
 * front of the fragment though the surface goes on from the one to the other. So a tap does not
 * shadow the fragment if it is reached from the fragment's own texel by steps to one of eight
 * neighbours whose planes meet between the two centres, within their rounding. The planes of an
 * occluder's edge and of what lies behind it do not: each lies in front of the other, or behind it,
 * at both centres. */

/* A set of columns in each row of a box. */
typedef struct box_bits {
    uint64_t rows[BOX_MAX];
} box_bits;

/* What a depth may be off by: its slope's rounding to half floats, and of the depth itself what
 * drawing and the sums here leave, and a step of the map's format between two of them. */
#define SHEET_SLOPE_ERROR ((float)SHB_HALF_RELATIVE + 0x1p-20f)
#define SHEET_DEPTH_ERROR (8 * (float)SHB_FLOAT_ROUNDING)

static inline float format_step(shb_format format) {
    return format == SHB_FORMAT_UNORM16   ? 1.0f / UNORM16_MAX
           : format == SHB_FORMAT_UNORM24 ? 1.0f / UNORM24_MAX
                                          : 0;
}

/* Planes of WIDE texels, reversed depths negated; NaN where a texel holds no occluder, whose slopes
 * may be anything. */
typedef struct sheet_planes {
    vf z, slope_x, slope_y;
    vf error;
} sheet_planes;

static inline ALWAYS_INLINE sheet_planes sheet_planes_at(const texel_box *b, int column, int row,
                                                         const shb_map *map, bool reversed) {
    const size_t at = (size_t)column, down = (size_t)row;
    const char *texels = b->texels + at * sizeof(float) + down * b->stride;
    const char *occluders = b->occluders + at * sizeof(uint32_t) + down * b->occluder_stride;
    const float unit = length_unit(map);
    const float least = 2 * (float)(SHB_HALF_ABSOLUTE * map->occluders.slope_unit) +
                        format_step(map->info.format) / 2;
    const vf depth = vf_load((const float *)(const void *)texels), z = reversed ? -depth : depth;
    const vu halves = vu_load((const uint32_t *)(const void *)occluders);
    const vf slope_y = half_high(halves);
    const vi known = (z < shb_far_depth(reversed)) & is_finite_half(slope_y);
    return (sheet_planes){vf_where(known, z, vf_splat(NAN)), half_low(halves) * unit,
                          slope_y * unit, SHEET_DEPTH_ERROR * vf_abs(z) + least};
}

/* -1 where the planes meet between the centres, not where one is NaN. rise_a: of a's plane from its
 * centre to b's. */
static inline ALWAYS_INLINE vi planes_meet(const sheet_planes *a, vf rise_a, const sheet_planes *b,
                                           vf rise_b) {
    const vf b_behind = b->z - (a->z + rise_a), a_behind = a->z - (b->z - rise_b);
    const vf apart = vf_min(vf_max(a_behind, b_behind), -vf_min(a_behind, b_behind));
    return apart <= SHEET_SLOPE_ERROR * (vf_abs(rise_a) + vf_abs(rise_b)) + (a->error + b->error);
}

/* Which neighbours hold one sheet. Each is a bit of its left column, in the upper row. */
typedef struct box_joints {
    box_bits right, below, falling, rising; /* the last two: diagonals, downwards and upwards */
} box_joints;

/* Of WIDE columns from start on, and one more. */
static inline ALWAYS_INLINE void find_joints_from(const shb_map *map, const texel_box *b, int n,
                                                  int start, bool reversed, box_joints *joints) {
    sheet_planes left = sheet_planes_at(b, start, 0, map, reversed);
    sheet_planes right = sheet_planes_at(b, start + 1, 0, map, reversed);
    for (int k = 0; k < n; k++) {
        const int next = k < n - 1 ? k + 1 : k;
        const sheet_planes below = sheet_planes_at(b, start, next, map, reversed);
        const sheet_planes across = sheet_planes_at(b, start + 1, next, map, reversed);
        const vi to_right = planes_meet(&left, left.slope_x, &right, right.slope_x);
        const vi down = planes_meet(&left, left.slope_y, &below, below.slope_y);
        const vi falling = planes_meet(&left, left.slope_x + left.slope_y, &across,
                                       across.slope_x + across.slope_y);
        const vi rising = planes_meet(&right, right.slope_y - right.slope_x, &below,
                                      below.slope_y - below.slope_x);
        joints->right.rows[k] |= (uint64_t)vi_bits(to_right) << start;
        joints->below.rows[k] |= (uint64_t)vi_bits(down) << start;
        joints->falling.rows[k] |= (uint64_t)vi_bits(falling) << start;
        joints->rising.rows[k] |= (uint64_t)vi_bits(rising) << start;
        left = below;
        right = across;
    }
}

/* Texels beyond the box are joined to none. */
static inline ALWAYS_INLINE void find_joints(const shb_map *map, const texel_box *b, int n,
                                             bool reversed, box_joints *joints) {
    const uint64_t all = ~(uint64_t)0 >> (64 - n), inner = all >> 1;
    for (int k = 0; k < n; k++)
        joints->right.rows[k] = joints->below.rows[k] = joints->falling.rows[k] =
            joints->rising.rows[k] = 0;
    for (int start = 0; start < n; start += WIDE)
        find_joints_from(map, b, n, start, reversed, joints);
    for (int k = 0; k < n; k++) {
        joints->right.rows[k] &= inner;
        joints->below.rows[k] &= all;
        joints->falling.rows[k] &= inner;
        joints->rising.rows[k] &= inner;
    }
}

/* Boxes of up to 8 rows, each a byte of one word. */
static inline ALWAYS_INLINE uint64_t pack_rows(const box_bits *bits, int n) {
    uint64_t packed = 0;
    for (int k = 0; k < 8 && k < n; k++)
        packed |= bits->rows[k] << 8 * k;
    return packed;
}

static inline ALWAYS_INLINE uint64_t grow_packed(const box_joints *joints, int n, uint64_t sheet) {
    const uint64_t right = pack_rows(&joints->right, n), below = pack_rows(&joints->below, n - 1);
    const uint64_t falling = pack_rows(&joints->falling, n - 1);
    const uint64_t rising = pack_rows(&joints->rising, n - 1);
    uint64_t before;
    do {
        before = sheet;
        sheet |= (sheet & right) << 1 | (sheet >> 1 & right);
        sheet |= (sheet & below) << 8 | (sheet >> 8 & below) | (sheet & falling) << 9 |
                 (sheet >> 9 & falling) | (sheet >> 1 & rising) << 8 | (sheet >> 8 & rising) << 1;
    } while (sheet != before);
    return sheet;
}

/* All that some of a row reaches along it. right: a bit joins its column with the next. A sum
 * carries the lowest of each run of joints up to the run's end; steps of twice the length lead down
 * again. */
static inline uint64_t reach_along(uint64_t some, uint64_t right) {
    some |= (right + (some & right)) ^ right;
    for (int step = 1; step < 64; step *= 2) {
        some |= some >> step & right;
        right &= right >> step;
    }
    return some;
}

/* All that some of a row reaches in it, and through the rows beside it. */
static inline bool grow_row(const box_joints *joints, int n, int k, box_bits *sheet) {
    uint64_t *rows = sheet->rows, some = rows[k];
    if (k > 0) {
        const uint64_t above = rows[k - 1];
        some |= (above & joints->below.rows[k - 1]) | (above & joints->falling.rows[k - 1]) << 1 |
                (above >> 1 & joints->rising.rows[k - 1]);
    }
    if (k < n - 1) {
        const uint64_t under = rows[k + 1];
        some |= (under & joints->below.rows[k]) | (under >> 1 & joints->falling.rows[k]) |
                (under & joints->rising.rows[k]) << 1;
    }
    some = reach_along(some, joints->right.rows[k]);
    const bool grown = some != rows[k];
    rows[k] = some;
    return grown;
}

static inline bool has_more(const box_bits *bits, const box_bits *than, int n) {
    uint64_t more = 0;
    for (int k = 0; k < n; k++)
        more |= bits->rows[k] & ~than->rows[k];
    return more != 0;
}

/* Down and up again, until nothing is added or all that is shadowed is reached. */
static void grow_rows(const box_joints *joints, int n, const box_bits *shadowed, box_bits *sheet) {
    bool grown = true;
    while (grown && has_more(shadowed, sheet, n)) {
        grown = false;
        for (int step = 1 - n; step < n; step++)
            grown |= grow_row(joints, n, n - 1 - (step < 0 ? -step : step), sheet);
    }
}

/* Whether the fragment's plane meets that of its own texel between its own place and the centre. */
static bool stands_on_own_texel(const box_batch *batch, size_t i, const texel_box *b,
                                bool reversed) {
    const mutual_batch *mutual = batch->mutual;
    const shb_receivers *r = batch->receivers;
    const size_t column = (size_t)-b->column, row = (size_t)-b->row;
    float depth;
    uint32_t halves;
    memcpy(&depth, b->texels + column * sizeof depth + row * b->stride, sizeof depth);
    memcpy(&halves, b->occluders + column * sizeof halves + row * b->occluder_stride,
           sizeof halves);
    const float stored = reversed ? -depth : depth;
    const float unit = (float)batch->map->occluders.slope_unit;
    const float to_x = r->to_center_x[i], to_y = r->to_center_y[i];
    const float slope_x = shb_half_to_float((uint16_t)halves) * unit;
    const float slope_y = shb_half_to_float((uint16_t)(halves >> 16)) * unit;
    const float own = r->step_x[i] * to_x + r->step_y[i] * to_y;
    const float occluder = slope_x * to_x + slope_y * to_y;
    const float error = (mutual->error[i] + mutual->slope_error[i]) +
                        (SHEET_DEPTH_ERROR * (fabsf(r->depth[i]) + fabsf(stored)) +
                         format_step(batch->map->info.format));
    const float occluder_error =
        mutual->base[i] + (fabsf(slope_x) * (mutual->moved_x[i] + SHEET_SLOPE_ERROR) +
                           fabsf(slope_y) * (mutual->moved_y[i] + SHEET_SLOPE_ERROR));
    const float behind = stored - (r->depth[i] + own),
                fragment_behind = r->depth[i] - (stored - occluder);
    const bool in_front = behind < -error && fragment_behind > occluder_error;
    const bool far_behind = behind > error && fragment_behind < -occluder_error;
    return stored < shb_far_depth(reversed) && slope_y < INFINITY && !in_front && !far_behind;
}

/* Takes the taps that lie on the fragment's sheet out of those that are shadowed. */
static NEVER_INLINE void light_sheet(const box_batch *batch, size_t i, const texel_box *b,
                                     bool reversed, box_bits *shadowed) {
    const int n = batch->size[i], column = -b->column, row = -b->row;
    box_joints joints;
    if (!stands_on_own_texel(batch, i, b, reversed))
        return;
    find_joints(batch->map, b, n, reversed, &joints);
    if (n <= 8) {
        const uint64_t sheet = grow_packed(&joints, n, (uint64_t)1 << (8 * row + column));
        for (int k = 0; k < 8 && k < n; k++)
            shadowed->rows[k] &= ~(sheet >> 8 * k);
        return;
    }
    box_bits sheet = {0};
    sheet.rows[row] = (uint64_t)1 << column;
    grow_rows(&joints, n, shadowed, &sheet);
    for (int k = 0; k < n; k++)
        shadowed->rows[k] &= ~sheet.rows[k];
}
