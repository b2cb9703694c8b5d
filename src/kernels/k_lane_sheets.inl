/* Sheets of a vector of fragments, found through squares whose rows have at most ROW_BITS texels.
 * Included once for each number. */

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_LANES (sizeof(R(rows)) / sizeof(R(row)))

/* Of count fragments of a vector, base is the first one; sides: of their squares. */
static void R(keep_sheets)(const mutual_batch *mutual, size_t base, const uint16_t *fragments,
                           size_t count, const int32_t *sides, lane_sheets *out) {
    R(sheet_rows) sheets;
    for (size_t first = 0; first < count; first += ROW_LANES) {
        const size_t lanes = count - first < ROW_LANES ? count - first : ROW_LANES;
        R(follow_squares)(mutual, fragments + first, sides + first, lanes, out->half, &sheets);
        for (int k = 0; k <= 2 * out->half; k++)
            for (size_t lane = 0; lane < lanes; lane++) {
                const uint32_t row = sheets.rows[1 + k].sheet[lane];
                memcpy(&out->rows[(size_t)k * WIDE + (fragments[first + lane] - base)], &row,
                       sizeof row);
            }
    }
}

#undef ROW_LANES
#undef R
