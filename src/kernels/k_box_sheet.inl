/* The sheets that fragments stand on, followed through boxes of texels: what lies on texels that
 * are joined to the fragment's own one, by steps to one of eight neighbours in the box, does not
 * shadow it. Rows of boxes are bits of ROW_BITS; those of many fragments are followed at a time.
 * Included once for each number. */

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_LANES (32 * WIDE > ROW_BITS ? 32 * WIDE / ROW_BITS : 1)

typedef SHB_JOIN(SHB_JOIN(uint, ROW_BITS), _t) R(row);
typedef R(row) R(rows) __attribute__((vector_size(ROW_LANES * ROW_BITS / 8)));

/* One row of the boxes of ROW_LANES fragments: which texels are joined to others (bits of the left
 * and upper ones), and which are reached. */
typedef struct R(sheet_row) {
    R(rows) right, below, falling, rising; /* the last two: diagonals, downwards and upwards */
    R(rows) sheet;
} R(sheet_row);

/* The rows of boxes, after one that is empty, and their columns. */
typedef struct R(sheet_rows) {
    R(sheet_row) rows[1 + ROW_BITS];
    R(rows) columns;
} R(sheet_rows);

/* Joints of n texels of a row from one of the first word's on. */
static inline ALWAYS_INLINE void R(load_joint_row)(const _Atomic uint64_t *from, int shift, int n,
                                                   size_t lane, R(sheet_row) * out) {
    const uint64_t kept = (uint64_t)(0xffff >> shift) * 0x0001000100010001u;
    const uint64_t up = (uint64_t)(0x10000 >> shift); /* a factor, as a second shift is slow */
    R(row) right = 0, below = 0, falling = 0, rising = 0;
    uint64_t word = atomic_load_explicit(from, memory_order_relaxed);
    for (int to = 0; to < (ROW_BITS == SHB_JOINT_WORD ? 1 : n); to += SHB_JOINT_WORD) {
        const uint64_t next = atomic_load_explicit(++from, memory_order_relaxed);
        const uint64_t joints = (word >> shift & kept) | (next * up & ~kept);
        right |= (R(row))((R(row))(joints & 0xffff) << to);
        below |= (R(row))((R(row))(joints >> 16 & 0xffff) << to);
        falling |= (R(row))((R(row))(joints >> 32 & 0xffff) << to);
        rising |= (R(row))((R(row))(joints >> 48) << to);
        word = next;
    }
    out->right[lane] = right;
    out->below[lane] = below;
    out->falling[lane] = falling;
    out->rising[lane] = rising;
}

static inline ALWAYS_INLINE void R(clear_joint_row)(size_t lane, R(sheet_row) * out) {
    out->right[lane] = out->below[lane] = out->falling[lane] = out->rising[lane] = 0;
}

static inline ALWAYS_INLINE void R(clear_sheets)(R(sheet_rows) * sheets, int n) {
    memset(&sheets->rows[0], 0, sizeof sheets->rows[0]);
    for (int k = 1; k <= n; k++)
        sheets->rows[k].sheet = (R(rows)){0};
    sheets->columns = (R(rows)){0} + (R(row))((R(row)) ~(R(row))0 >> (ROW_BITS - n));
}

/* A box of n x n texels whose first one is that at left and top, around one in the map that is
 * reached; nothing is joined beyond the map. */
static inline ALWAYS_INLINE void R(enter_sheet)(const shb_map *map, int32_t left, int32_t top,
                                                int32_t own_x, int32_t own_y, int n, size_t lane,
                                                R(sheet_rows) * sheets) {
    const shb_joints *joints = &map->occluders.joints;
    const int32_t width = (int32_t)map->info.width, height = (int32_t)map->info.height;
    const int32_t right = left + n < width ? left + n : width;
    const int32_t first = top < 0 ? -top : 0, end = height - top < n ? height - top : n;
    const uint32_t place = (uint32_t)(left + SHB_JOINT_MARGIN * SHB_JOINT_WORD);
    const int shift = (int)(place % SHB_JOINT_WORD);
    R(sheet_row) *rows = sheets->rows + 1;
    need_joints(map, (uint32_t)(left < 0 ? 0 : left), (uint32_t)right - 1, (uint32_t)(top + first),
                (uint32_t)(top + end) - 1);
    const _Atomic uint64_t *from =
        joints->words + (size_t)(top + first) * joints->pitch + place / SHB_JOINT_WORD;
    for (int k = 0; k < first; k++)
        R(clear_joint_row)(lane, &rows[k]);
    for (int k = first; k < end; k++) {
        R(load_joint_row)(from, shift, n, lane, &rows[k]);
        from += joints->pitch;
    }
    for (int k = end; k < n; k++)
        R(clear_joint_row)(lane, &rows[k]);
    rows[own_y - top].sheet[lane] = (R(row))((R(row))1 << (own_x - left));
}

/* Leaves of a box with half texels on each side of its middle one a square with side of them. */
static inline ALWAYS_INLINE void R(narrow_sheet)(int half, int side, size_t lane,
                                                 R(sheet_rows) * sheets) {
    R(sheet_row) *rows = sheets->rows + 1, *last = &rows[half + side];
    const int first = half - side;
    sheets->columns[lane] = (R(row))((R(row)) ~(R(row))0 >> (ROW_BITS - 1 - 2 * side) << first);
    R(clear_joint_row)(lane, &rows[first - 1]);
    last->below[lane] = last->falling[lane] = last->rising[lane] = 0;
}

/* All that some of a row reaches along it. right: a bit joins its column with the next. A sum
 * carries the lowest of each run of joints up to the run's end; steps of twice the length lead down
 * again. */
static inline ALWAYS_INLINE R(rows) R(reach_along)(R(rows) some, R(rows) right, int n) {
    some |= (right + (some & right)) ^ right;
    some |= some >> 1 & right;
    right &= right >> 1;
    some |= some >> 2 & right;
    if (n > 4) {
        right &= right >> 2;
        some |= some >> 4 & right;
    }
    if (n > 8) {
        right &= right >> 4;
        some |= some >> 8 & right;
    }
#if ROW_BITS > 16
    right &= right >> 8;
    some |= some >> 16 & right;
#endif
#if ROW_BITS > 32
    right &= right >> 16;
    some |= some >> 32 & right;
#endif
    return some;
}

/* Adds to a row what it reaches, entered from another one; returns what is new. */
static inline ALWAYS_INLINE R(rows)
    R(grow_row)(R(sheet_row) * row, R(rows) entered, R(rows) all, int n) {
    const R(rows) before = row->sheet;
    row->sheet = all & R(reach_along)(before | (entered & all), row->right, n);
    return row->sheet ^ before;
}

static inline ALWAYS_INLINE R(rows) R(grow_down)(R(sheet_row) * row, R(rows) all, int n) {
    const R(sheet_row) *above = row - 1;
    const R(rows) entered = (above->sheet & above->below) | (above->sheet & above->falling) << 1 |
                            (above->sheet >> 1 & above->rising);
    return R(grow_row)(row, entered, all, n);
}

static inline ALWAYS_INLINE R(rows) R(grow_up)(R(sheet_row) * row, R(rows) all, int n) {
    const R(rows) under = row[1].sheet;
    const R(rows) entered =
        (under & row->below) | (under >> 1 & row->falling) | (under & row->rising) << 1;
    return R(grow_row)(row, entered, all, n);
}

static inline ALWAYS_INLINE bool R(has_grown)(R(rows) grown) {
    int32_t news[sizeof(R(rows)) / sizeof(int32_t)];
    memcpy(news, &grown, sizeof news);
    return any_set(news, sizeof news / sizeof *news);
}

/* From what is reached on, down and up by turns, until nothing is new; of count lanes. What was
 * just gone through in one direction has nothing new before the other has. */
static NEVER_INLINE void R(follow_sheets)(R(sheet_rows) * sheets, size_t count, int n) {
    const R(rows) all = sheets->columns;
    R(sheet_row) *rows = sheets->rows + 1;
    for (size_t lane = count; lane < ROW_LANES; lane++)
        for (int k = 0; k < n; k++)
            R(clear_joint_row)(lane, &rows[k]);
    int first = (n - 1) / 2; /* nothing is reached above that row yet */
    for (bool again = false;; again = true) {
        R(rows) grown = {0};
        for (int k = first; k < n; k++)
            grown |= R(grow_down)(&rows[k], all, n);
        if (again && !R(has_grown)(grown))
            return;
        grown = (R(rows)){0};
        for (int k = n - 2; k >= 0; k--)
            grown |= R(grow_up)(&rows[k], all, n);
        if (!R(has_grown)(grown))
            return;
        first = 0;
    }
}

#undef ROW_LANES
#undef R
