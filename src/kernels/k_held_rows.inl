/* The sheets of fragments whose taps are held, for squares whose rows have at most ROW_BITS texels.
 * Included once for each number. */

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_LANES (sizeof(R(rows)) / sizeof(R(row)))

/* Shadowed taps of fragment i that are not on its sheet; half: texels on each side of the own one.
 */
static inline ALWAYS_INLINE uint64_t R(off_sheet)(const held_taps *held, size_t i, int half,
                                                  const R(sheet_rows) * sheets, size_t lane) {
    uint64_t off = held->shadowed[i];
    for (uint64_t left = off; left; left &= left - 1) {
        const int k = __builtin_ctzll(left);
        const R(row) row = sheets->rows[1 + half + held->row[k][i]].sheet[lane];
        off &= ~((uint64_t)(row >> (half + held->column[k][i]) & 1) << k);
    }
    return off;
}

/* Of count fragments, whose squares have up to half texels on each side of the own one. */
static NEVER_INLINE void R(light_squares)(const mutual_batch *mutual, const uint16_t *fragments,
                                          const int32_t *sides, size_t count, int half,
                                          held_taps *held) {
    R(sheet_rows) sheets;
    for (size_t first = 0; first < count; first += ROW_LANES) {
        const size_t lanes = count - first < ROW_LANES ? count - first : ROW_LANES;
        R(follow_squares)(mutual, fragments + first, sides + first, lanes, half, &sheets);
        for (size_t lane = 0; lane < lanes; lane++) {
            const size_t i = fragments[first + lane];
            held->shadowed[i] = R(off_sheet)(held, i, half, &sheets, lane);
        }
    }
}

#undef ROW_LANES
#undef R
