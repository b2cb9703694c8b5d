/* The sheets of fragments through squares around their own texels, whose rows have at most ROW_BITS
 * texels. Included once for each number. */

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_LANES (sizeof(R(rows)) / sizeof(R(row)))

/* Of count fragments, not more than ROW_LANES, whose squares have so many texels on each side of
 * the own one, not more than half; the own ones are in the middle of boxes with half. */
static NEVER_INLINE void R(follow_squares)(const mutual_batch *mutual, const uint16_t *fragments,
                                           const int32_t *sides, size_t count, int half,
                                           R(sheet_rows) * sheets) {
    const int32_t *own_x = mutual->receivers.texel_x, *own_y = mutual->receivers.texel_y;
    const int n = 2 * half + 1;
    R(clear_sheets)(sheets, n);
    for (size_t lane = 0; lane < count; lane++) {
        const size_t i = fragments[lane];
        R(enter_sheet)
        (mutual->map, own_x[i] - half, own_y[i] - half, own_x[i], own_y[i], n, lane, sheets);
        if (sides[lane] < half)
            R(narrow_sheet)(half, sides[lane], lane, sheets);
    }
    R(follow_sheets)(sheets, count, n);
}

#undef ROW_LANES
#undef R
