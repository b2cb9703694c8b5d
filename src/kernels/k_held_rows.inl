/* The sheets of fragments whose taps are held, for squares whose rows have at most ROW_BITS texels.
 * Included once for each number. */

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_LANES (sizeof(R(rows)) / sizeof(R(row)))

/* Shadowed taps of fragment i that are not on its sheet; side: texels beside its own one. */
static inline ALWAYS_INLINE uint64_t R(off_sheet)(const held_taps *held, size_t i, int side,
                                                  const R(sheet_rows) * sheets, size_t lane) {
    uint64_t off = held->shadowed[i];
    for (uint64_t left = off; left; left &= left - 1) {
        const int k = __builtin_ctzll(left);
        const R(row) row = sheets->rows[1 + side + held->row[k][i]].sheet[lane];
        off &= ~((uint64_t)(row >> (side + held->column[k][i]) & 1) << k);
    }
    return off;
}

/* Of count fragments with squares of one size. */
static NEVER_INLINE void R(light_squares)(const mutual_batch *mutual, const uint16_t *fragments,
                                          size_t count, int side, held_taps *held) {
    const int32_t *own_x = mutual->receivers.texel_x, *own_y = mutual->receivers.texel_y;
    const int n = 2 * side + 1;
    R(sheet_rows) sheets;
    for (size_t first = 0; first < count; first += ROW_LANES) {
        const size_t lanes = count - first < ROW_LANES ? count - first : ROW_LANES;
        R(clear_sheets)(&sheets, n);
        for (size_t lane = 0; lane < lanes; lane++) {
            const size_t i = fragments[first + lane];
            R(enter_sheet)
            (mutual->map, own_x[i] - side, own_y[i] - side, own_x[i], own_y[i], n, lane, &sheets);
        }
        R(follow_sheets)(&sheets, lanes, n);
        for (size_t lane = 0; lane < lanes; lane++) {
            const size_t i = fragments[first + lane];
            held->shadowed[i] = R(off_sheet)(held, i, side, &sheets, lane);
        }
    }
}

#undef ROW_LANES
#undef R
