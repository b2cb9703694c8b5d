/* The sheets that fragments stand on, followed through boxes of texels: what lies on texels that
 * are joined to the fragment's own one, by steps to one of eight neighbours in the box, does not
 * shadow it. Rows of boxes are bits of ROW_BITS; those of many fragments are followed at a time.
 * Included once for each number. */

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_WORDS (ROW_BITS / SHB_JOINT_WORD)
#define ROW_QUADS (WIDE > 2 ? WIDE / 2 : 1)
#define ROW_LANES (4 * ROW_QUADS / ROW_WORDS)

typedef SHB_JOIN(SHB_JOIN(uint, ROW_BITS), _t) R(row);
typedef R(row) R(rows) __attribute__((vector_size(8 * ROW_QUADS)));
typedef uint64_t R(quads) __attribute__((vector_size(8 * ROW_QUADS)));

/* One row of the boxes of ROW_LANES fragments: which texels are joined to others (bits of the left
 * and upper ones), and which are reached. */
typedef struct R(sheet_row) {
    union {
        uint64_t words[4][ROW_QUADS]; /* at first: as the map keeps them, by turns in these four */
        struct {
            R(rows) right, below, falling, rising; /* the last two: diagonals, down and up */
        };
    };
    R(rows) sheet;
} R(sheet_row);

/* The rows of boxes, after one that is empty, and their columns. */
typedef struct R(sheet_rows) {
    R(sheet_row) rows[1 + ROW_BITS];
    R(rows) columns;
} R(sheet_rows);

static inline ALWAYS_INLINE uint64_t *R(word_of)(R(sheet_row) * row, size_t lane, size_t word) {
    const size_t place = lane * ROW_WORDS + word;
    return &row->words[place % 4][place / 4];
}

/* Joints of a row from a texel of the first word on. */
static inline ALWAYS_INLINE void R(load_joint_row)(const _Atomic uint64_t *from, int shift,
                                                   size_t lane, R(sheet_row) * out) {
    const uint64_t kept = (uint64_t)(0xffff >> shift) * 0x0001000100010001u;
    const uint64_t up = (uint64_t)(0x10000 >> shift); /* a factor, as a second shift is slow */
    uint64_t word = atomic_load_explicit(from, memory_order_relaxed);
    for (size_t k = 0; k < ROW_WORDS; k++) {
        const uint64_t next = atomic_load_explicit(++from, memory_order_relaxed);
        *R(word_of)(out, lane, k) = (word >> shift & kept) | (next * up & ~kept);
        word = next;
    }
}

static inline ALWAYS_INLINE void R(clear_joint_row)(size_t lane, R(sheet_row) * out) {
    for (size_t k = 0; k < ROW_WORDS; k++)
        *R(word_of)(out, lane, k) = 0;
}

static inline ALWAYS_INLINE R(quads) R(load_words)(const R(sheet_row) * row, int turn) {
    R(quads) words;
    memcpy(&words, row->words[turn], sizeof words);
    return words;
}

/* Words of four kinds become rows of each kind, by pairs of 16 and then of 32 bits. */
static inline ALWAYS_INLINE void R(sort_joints)(R(sheet_row) * row) {
    const uint64_t even = 0x0000ffff0000ffffu, low = 0xffffffffu;
    const R(quads) a = R(load_words)(row, 0), b = R(load_words)(row, 1);
    const R(quads) c = R(load_words)(row, 2), d = R(load_words)(row, 3);
    const R(quads) even_ab = (a & even) | (b & even) << 16, odd_ab = (a >> 16 & even) | (b & ~even);
    const R(quads) even_cd = (c & even) | (d & even) << 16, odd_cd = (c >> 16 & even) | (d & ~even);
    row->right = (R(rows))((even_ab & low) | even_cd << 32);
    row->below = (R(rows))((odd_ab & low) | odd_cd << 32);
    row->falling = (R(rows))(even_ab >> 32 | (even_cd & ~low));
    row->rising = (R(rows))(odd_ab >> 32 | (odd_cd & ~low));
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
        R(load_joint_row)(from, shift, lane, &rows[k]);
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
    for (size_t k = 0; k < ROW_WORDS; k++)
        *R(word_of)(last, lane, k) &= 0xffff; /* joints to the right */
}

/* All that some of a row reaches along it. right: a bit joins its column with the next. A sum
 * carries the lowest of each run of joints up to the run's end; steps of twice the length lead
 * down. */
static inline ALWAYS_INLINE R(rows) R(reach_along)(R(rows) some, R(rows) right, int n) {
    const R(rows) up = (right + (some & right)) ^ right;
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
    return some | up;
}

static inline ALWAYS_INLINE R(rows) R(entered_from_above)(const R(sheet_row) * row) {
    const R(sheet_row) *above = row - 1;
    return (above->sheet & above->below) | (above->sheet & above->falling) << 1 |
           (above->sheet >> 1 & above->rising);
}

static inline ALWAYS_INLINE R(rows) R(entered_from_below)(const R(sheet_row) * row) {
    const R(rows) under = row[1].sheet;
    return (under & row->below) | (under >> 1 & row->falling) | (under & row->rising) << 1;
}

/* Adds to a row what it reaches, entered from another one. */
static inline ALWAYS_INLINE void R(grow_row)(R(sheet_row) * row, R(rows) entered, R(rows) all,
                                             int n) {
    row->sheet = all & R(reach_along)(row->sheet | (entered & all), row->right, n);
}

static inline ALWAYS_INLINE bool R(has_some)(R(rows) rows) {
    int32_t some[sizeof(R(rows)) / sizeof(int32_t)];
    memcpy(some, &rows, sizeof some);
    return any_set(some, sizeof some / sizeof *some);
}

/* From the row in the middle up and down; true if rows would reach more on the way back. Both ways
 * side by side, as every row waits for the one before it. Of even numbers of rows the own one may
 * be the one below the middle, and the last one above is the empty one. */
static inline ALWAYS_INLINE bool R(grow_outward)(R(sheet_row) * middle, R(rows) all, int n) {
    R(rows) more = {0};
    R(grow_row)(middle, n % 2 ? more : R(entered_from_below)(middle), all, n);
    for (int k = 1; k <= n / 2; k++) {
        R(sheet_row) *under = middle + k, *above = middle - k;
        R(grow_row)(under, R(entered_from_above)(under), all, n);
        R(grow_row)(above, R(entered_from_below)(above), all, n);
        more |= R(entered_from_below)(under - 1) & ~under[-1].sheet;
        more |= R(entered_from_above)(above + 1) & ~above[1].sheet;
    }
    return R(has_some)(more & all);
}

/* The other way. */
static inline ALWAYS_INLINE bool R(grow_inward)(R(sheet_row) * middle, R(rows) all, int n) {
    R(rows) more = {0};
    for (int k = n / 2; k > 0; k--) {
        R(sheet_row) *under = middle + k - 1, *above = middle - k + 1;
        R(grow_row)(under, R(entered_from_below)(under), all, n);
        R(grow_row)(above, R(entered_from_above)(above), all, n);
    }
    for (int k = 1; k <= n / 2; k++) {
        const R(sheet_row) *under = middle + k, *above = middle - k;
        more |= R(entered_from_above)(under) & ~under->sheet;
        more |= R(entered_from_below)(above) & ~above->sheet;
    }
    return R(has_some)(more & all);
}

/* From what is reached in the middle on, until nothing is new; of count lanes. */
static NEVER_INLINE void R(follow_sheets)(R(sheet_rows) * sheets, size_t count, int n) {
    R(sheet_row) *rows = sheets->rows + 1, *middle = &rows[(n - 1) / 2];
    for (size_t lane = count; lane < ROW_LANES; lane++)
        for (int k = 0; k < n; k++)
            R(clear_joint_row)(lane, &rows[k]);
    for (int k = 0; k < n; k++)
        R(sort_joints)(&rows[k]);
    while (R(grow_outward)(middle, sheets->columns, n) &&
           R(grow_inward)(middle, sheets->columns, n))
        continue;
}

#undef ROW_WORDS
#undef ROW_QUADS
#undef ROW_LANES
#undef R
