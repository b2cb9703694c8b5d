/* Sheets of a batch's fragments, found through squares whose rows have at most ROW_BITS texels.
 * Included once for each number. */

#define R(name) SHB_JOIN(name, ROW_BITS)
#define ROW_LANES (sizeof(R(rows)) / sizeof(R(row)))

/* Of count fragments, whose squares have up to half texels on each side of the own one; their
 * sheets are kept one after the other from number first on. */
static void R(keep_sheets)(const mutual_batch *mutual, const uint16_t *fragments,
                           const int32_t *sides, size_t count, int half, size_t first,
                           kept_sheets *kept) {
    R(sheet_rows) sheets;
    const int more = SHEET_MOST - half;
    for (size_t done = 0; done < count; done += ROW_LANES) {
        float *rows = kept->rows + (first + done) * SHEET_ROWS;
        const size_t lanes = count - done < ROW_LANES ? count - done : ROW_LANES;
        R(follow_squares)(mutual, fragments + done, sides + done, lanes, half, &sheets);
        memset(rows, 0, lanes * SHEET_ROWS * sizeof *rows);
        for (int k = 0; k <= 2 * half; k++)
            for (size_t lane = 0; lane < lanes; lane++) {
                const uint32_t row = (uint32_t)sheets.rows[1 + k].sheet[lane] << more;
                memcpy(&rows[lane * SHEET_ROWS + (size_t)(more + k)], &row, sizeof row);
            }
    }
}

#undef ROW_LANES
#undef R
