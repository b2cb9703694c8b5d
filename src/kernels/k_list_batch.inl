/* A batch of triangles as linear functions over a tile. */

/* Where a texel's triangles are counted, from its corner: where no edge passes by because a mesh
 * and the map are aligned. */
#define LIST_SAMPLE_X 0x1.1p-1f
#define LIST_SAMPLE_Y 0x1.bp-2f

/* Triangles that are put into cells one after the other, as linear functions over the tile, from
 * its corner: the weights at the best corner of a cell, which are negative where the triangle
 * misses the cell for sure; what they gain for each cell that a window is larger, and what their
 * worst corner has less; and depths at which the triangle begins and ends in a cell. */
typedef struct list_batch {
    SHB_ALIGN float x[3][LIST_LANES];
    float y[3][LIST_LANES], best[3][LIST_LANES], more[3][LIST_LANES], worst[3][LIST_LANES];
    float slope_x[LIST_LANES], slope_y[LIST_LANES], begin[LIST_LANES], end[LIST_LANES];
    float clear[LIST_LANES];
    /* The same of texels, for sheets: the weights at their best corner, and below what an edge's
     * line may pass them; what their sample has more, and where that is surely covered. */
    float met[3][LIST_LANES], passed[3][LIST_LANES], sample[3][LIST_LANES], sure[LIST_LANES];
    float texel_begin[LIST_LANES], texel_end[LIST_LANES];
    /* numbers of texels, from 1 on: a byte for the box of each edge, the uppermost for all */
    int32_t first_column[LIST_LANES], last_column[LIST_LANES];
    int32_t first_row[LIST_LANES], last_row[LIST_LANES];
    int32_t edges[3][2][LIST_LANES], covers[2][LIST_LANES]; /* what they add to the sums */
    /* as they waited */
    int count;
    uint32_t *numbers;
    const int32_t *first_columns, *first_rows, *columns, *rows;
    const float *nearest;
    int32_t small_columns[LIST_LANES]; /* of small triangles; of others -1 */
} list_batch;

/* Words of records, WIDE lanes of each four. */
static inline void read_words(const float *records, int lane, uint32_t word, vf out[4]) {
    vf_read_quads(records + (size_t)lane * 16, (vu)vi_numbers() * 16 + word, out);
}

static inline vf positive(vf v) {
    return vf_max(v, vf_splat(0));
}

/* The weights of WIDE triangles from lane i on, and the rounding of their depths. */
static inline void put_weights(const shb_list_cover *cover, bool with_sheets, float rim,
                               const float *records, int i, list_batch *b) {
    const float column = (float)cover->column, row = (float)cover->row;
    const float size = (float)(1 << cover->cell_bits);
    vf u[4], v[4], rest[4]; /* the first word of v comes with u */
    read_words(records, i, offsetof(shb_list_triangle, u) / 4, u);
    read_words(records, i, offsetof(shb_list_triangle, v) / 4, v);
    read_words(records, i, offsetof(shb_list_triangle, rest) / 4, rest);
    const vf margin = rest[1];
    const vf x[3] = {-(u[0] + v[0]), u[0], v[0]}, y[3] = {-(u[1] + v[1]), u[1], v[1]};
    const vf first[3] = {(rest[0] - u[2]) - v[2], u[2], v[2]};
    for (int k = 0; k < 3; k++) {
        const vf one = ((x[k] * column + y[k] * row) + first[k]) + margin;
        const vf sizes = vf_abs(x[k]) + vf_abs(y[k]);
        const vf across = positive(x[k]) + positive(y[k]);
        vf_store(b->x[k] + i, x[k]);
        vf_store(b->y[k] + i, y[k]);
        vf_store(b->best[k] + i, one + (size * across + rim * sizes));
        vf_store(b->more[k] + i, size * across);
        vf_store(b->worst[k] + i, -(size + 2 * rim) * sizes - 4 * margin);
        if (with_sheets) {
            vf_store(b->met[k] + i, one + (across + rim * sizes));
            vf_store(b->passed[k] + i, (1 + 2 * rim) * sizes + 4 * margin);
            vf_store(b->sample[k] + i,
                     ((LIST_SAMPLE_X * x[k] + LIST_SAMPLE_Y * y[k]) - across) - rim * sizes);
        }
    }
    vf_store(b->sure + i, 4 * margin);
    vf_store(b->clear + i, rest[3]);
}

/* The planes at the tile's corner. */
static inline void put_planes(const shb_list_cover *cover, list_batch *b, float at[LIST_LANES]) {
    const wd column = wd_splat((double)cover->column), row = wd_splat((double)cover->row);
    for (int i = 0; i < LIST_LANES; i += DOUBLES) {
        const double *from[DOUBLES];
        wd plane[4];
        for (int lane = 0; lane < DOUBLES; lane++)
            from[lane] = cover->triangles[b->numbers[i + lane]].plane;
        wd_read_quads(from, plane);
        const wd none = wd_splat(0);
        const wd behind = (plane[0] * column + plane[1] * row) + plane[2];
        wd_store_floats(at + i, none - behind);
        wd_store_floats(b->slope_x + i, none - plane[0]);
        wd_store_floats(b->slope_y + i, none - plane[1]);
    }
}

/* Depths of all lanes. */
static inline void put_cell_depths(const shb_list_cover *cover, bool with_sheets, float rim,
                                   list_batch *b) {
    const float size = (float)(1 << cover->cell_bits);
    SHB_ALIGN float z[LIST_LANES];
    put_planes(cover, b, z);
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vf x = vf_load(b->slope_x + i), y = vf_load(b->slope_y + i), at = vf_load(z + i);
        const vf steep = vf_abs(x) + vf_abs(y), none = vf_splat(0);
        const vf rounding =
            (0x1p-20f * (vf_abs(at) + SHB_LIST_TILE * steep) + rim * steep) + vf_load(b->clear + i);
        vf_store(b->begin + i, (at + size * (vf_min(x, none) + vf_min(y, none))) - rounding);
        vf_store(b->end + i, (at + size * (vf_max(x, none) + vf_max(y, none))) + rounding);
        if (with_sheets) {
            vf_store(b->texel_begin + i, (at + (vf_min(x, none) + vf_min(y, none))) - rounding);
            vf_store(b->texel_end + i, (at + (vf_max(x, none) + vf_max(y, none))) + rounding);
        }
    }
}

/* The texels that the boxes of edges reach, of columns or rows. */
static inline void put_reach(const vf middle[3], const vf reach[3], int32_t *first, int32_t *last) {
    const vf none = vf_splat(0), all = vf_splat(SHB_LIST_TILE + 1);
    vf lo = all, hi = none;
    vi firsts = {0}, lasts = {0};
    for (int k = 0; k < 4; k++) {
        const vf from = k < 3 ? vf_min(vf_max((middle[k] - reach[k]) + 1.5f, none), all) : lo;
        const vf to = k < 3 ? vf_min(vf_max((middle[k] + reach[k]) + 0.5f, none), all) : hi;
        firsts |= __builtin_convertvector(from, vi) << 8 * k;
        lasts |= __builtin_convertvector(to, vi) << 8 * k;
        lo = vf_min(lo, from);
        hi = vf_max(hi, to);
    }
    vi_store(first, firsts);
    vi_store(last, lasts);
}

/* What WIDE triangles from lane i on add to sheets, and where. */
static inline void put_outlines_of(const shb_list_cover *cover, const float *records, int i,
                                   list_batch *b) {
    const float column = (float)cover->column, row = (float)cover->row;
    const float around = 0.5f + (float)cover->frame->rim + 0x1p-21f * (column + row);
    vf places[8], edges[8], middle_x[3], middle_y[3], reach_x[3], reach_y[3];
    read_words(records, i, 0, places);
    read_words(records, i, 4, places + 4);
    read_words(records, i, 6, edges);
    read_words(records, i, 10, edges + 4); /* two of edges, and is_known */
    const vi known = -(vi)edges[6];
    for (int k = 0; k < 3; k++) {
        const vf x_0 = places[(k + 1) % 3] - column, x_1 = places[(k + 2) % 3] - column;
        const vf y_0 = places[3 + (k + 1) % 3] - row, y_1 = places[3 + (k + 2) % 3] - row;
        const vf width = vf_abs(x_1 - x_0), height = vf_abs(y_1 - y_0);
        middle_x[k] = 0.5f * (x_0 + x_1);
        middle_y[k] = 0.5f * (y_0 + y_1);
        reach_x[k] = (0.5f * width + around) + 0x1p-20f * (width + vf_abs(middle_x[k]));
        reach_y[k] = (0.5f * height + around) + 0x1p-20f * (height + vf_abs(middle_y[k]));
        vi_store(b->edges[k][0] + i, (vi)edges[2 * k] & known);
        vi_store(b->edges[k][1] + i, (vi)edges[2 * k + 1] & known);
        vf_store(b->sample[k] + i, vf_where(known, vf_load(b->sample[k] + i), vf_splat(HUGE_VALF)));
    }
    put_reach(middle_x, reach_x, b->first_column + i, b->last_column + i);
    put_reach(middle_y, reach_y, b->first_row + i, b->last_row + i);
    vi_store(b->covers[0] + i, vi_splat((int32_t)SHB_LIST_SHEET_0) & known);
    vi_store(b->covers[1] + i, (vi_splat((int32_t)SHB_LIST_SHEET_1) & known) |
                                   (vi_splat((int32_t)SHB_LIST_UNKNOWN_1) & ~known));
}

/* Makes the functions of a batch whose numbers are there. */
static void put_functions(const shb_list_cover *cover, bool with_sheets, list_batch *b) {
    SHB_ALIGN float records[LIST_LANES * 16];
    const float rim = with_sheets ? (float)cover->frame->rim : 0;
    for (int i = b->count; i < LIST_LANES; i++)
        b->numbers[i] = b->numbers[0];
    for (int i = 0; i < LIST_LANES; i++)
        memcpy(records + 16 * i, &cover->triangles[b->numbers[i]], sizeof *cover->triangles);
    for (int i = 0; i < LIST_LANES; i += WIDE)
        put_weights(cover, with_sheets, rim, records, i, b);
    put_cell_depths(cover, with_sheets, rim, b);
    if (!with_sheets)
        return;
    for (int i = 0; i < LIST_LANES; i++)
        memcpy(records + 16 * i, &cover->outlines[b->numbers[i]], sizeof *cover->outlines);
    for (int i = 0; i < LIST_LANES; i += WIDE)
        put_outlines_of(cover, records, i, b);
}
