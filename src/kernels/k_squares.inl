/* Squares of texels around fragments' own ones, through which their sheets are followed where a map
 * keeps planes and taps are not boxes. */

#define ROW_BITS 16
#include "k_square_rows.inl"
#undef ROW_BITS
#define ROW_BITS 32
#include "k_square_rows.inl"
#undef ROW_BITS
#define ROW_BITS 64
#include "k_square_rows.inl"
#undef ROW_BITS

/* Adds to found fragments and what their own texels hold those of WIDE fragments from i on that are
 * wanted, in the map, and not shadowed by their own texels. There is room for one more. */
static size_t list_lit_by_own(mutual_batch *mutual, size_t i, vi wanted, uint16_t *fragments,
                              own_texel *own, size_t found) {
    const shb_receivers *r = &mutual->receivers;
    const shb_map *map = mutual->map;
    const bool reversed = map->info.view.reversed;
    if (!vi_any(wanted))
        return found;
    const vi x = vi_load(r->texel_x + i), y = vi_load(r->texel_y + i);
    vi in_map;
    const vf depth = read_lanes(map, can_gather(map), x, y, &in_map);
    const vf stored = reversed ? -depth : depth;
    vi open = wanted & in_map & (stored < shb_far_depth(reversed));
    const vu slopes = gather_occluders(map, x & open, y & open);
    open &= ~shadowed_taps(mutual, i, open & (stored < vf_load(r->ref + i)), vf_splat(0),
                           vf_splat(0), stored);
    for (size_t lane = 0; lane < WIDE; lane++) {
        fragments[found] = (uint16_t)(i + lane);
        own[found] = (own_texel){stored[lane], slopes[lane]};
        found += open[lane] & 1;
    }
    return found;
}

/* Leaves those that stand on what their own texels hold. */
static size_t keep_on_own(const mutual_batch *mutual, const own_texel *own, uint16_t *fragments,
                          size_t count) {
    uint16_t listed[SHB_BATCH];
    for (size_t k = 0; k < count; k++)
        listed[k] = (uint16_t)k;
    count = keep_standing(mutual, fragments, own, listed, count);
    for (size_t k = 0; k < count; k++)
        fragments[k] = fragments[listed[k]];
    return count;
}

/* The sheets of a batch's fragments are followed through so many texels on each side of their own
 * ones, and kept in so many rows. */
#define SHEET_MOST 15
#define SHEET_ROWS 32

typedef struct kept_sheets {
    SHB_ALIGN int32_t rows_of[SHB_BATCH];     /* where a fragment's own ones begin */
    float rows[(1 + SHB_BATCH) * SHEET_ROWS]; /* bits, for vf_gather; the first sheet is empty */
} kept_sheets;

#define ROW_BITS 16
#include "k_kept_sheets.inl"
#undef ROW_BITS
#define ROW_BITS 32
#include "k_kept_sheets.inl"
#undef ROW_BITS

/* Leaves one of fragments next to each other whose squares are the same, and tells each of them
 * which sheet will be its own. Returns how many are left. */
static size_t number_sheets(const shb_receivers *r, uint16_t *fragments, size_t count,
                            const int32_t *sides, int32_t *left_sides, kept_sheets *kept) {
    size_t left = 0;
    for (size_t k = 0; k < count; k++) {
        const size_t i = fragments[k], last = fragments[left > 0 ? left - 1 : 0];
        const bool same = left > 0 && r->texel_x[i] == r->texel_x[last] &&
                          r->texel_y[i] == r->texel_y[last] && sides[i] == sides[last];
        if (!same) {
            fragments[left] = (uint16_t)i;
            left_sides[left++] = sides[i];
        }
        kept->rows_of[i] = (int32_t)left * SHEET_ROWS;
    }
    return left;
}

/* Finds the sheets of fragments through squares with these sides, not more than SHEET_MOST. */
static NEVER_INLINE void find_kept_sheets(const mutual_batch *mutual, uint16_t *fragments,
                                          size_t count, const int32_t *sides, kept_sheets *kept) {
    int32_t left_sides[SHB_BATCH];
    memset(kept->rows_of, 0, sizeof kept->rows_of);
    memset(kept->rows, 0, SHEET_ROWS * sizeof *kept->rows);
    const size_t left =
        number_sheets(&mutual->receivers, fragments, count, sides, left_sides, kept);
    for (size_t first = 0, end; first < left; first = end) {
        const int bits = row_bits_of(2 * left_sides[first] + 1);
        int32_t half = left_sides[first];
        for (end = first + 1; end < left && row_bits_of(2 * left_sides[end] + 1) == bits; end++)
            half = left_sides[end] > half ? left_sides[end] : half;
        if (bits == 16)
            keep_sheets16(mutual, fragments + first, left_sides + first, end - first, half,
                          1 + first, kept);
        else
            keep_sheets32(mutual, fragments + first, left_sides + first, end - first, half,
                          1 + first, kept);
    }
}

static inline ALWAYS_INLINE bool have_sheets(const kept_sheets *kept, size_t i) {
    return vi_any(vi_load(kept->rows_of + i) != 0);
}

/* Whether texels, one of each of WIDE fragments from i on, m columns to the right and n rows below
 * the own ones, lie on their sheets. */
static inline ALWAYS_INLINE vi on_sheets(const kept_sheets *kept, size_t i, vf m, vf n) {
    const vi column = __builtin_convertvector(m, vi) + SHEET_MOST;
    const vi row = __builtin_convertvector(n, vi) + SHEET_MOST;
    const vi inside = ((vu)column <= 2 * SHEET_MOST) & ((vu)row <= 2 * SHEET_MOST);
    const vu bits = (vu)vf_gather(kept->rows, vi_load(kept->rows_of + i) + (row & inside));
    return inside & -(vi)(bits >> (vu)(column & inside) & 1);
}

/* The same for WIDE texels in a row of fragment i, from m columns to the right on. */
static vi on_sheet(const kept_sheets *kept, size_t i, int32_t m, int32_t n) {
    const int32_t column = m + SHEET_MOST, row = n + SHEET_MOST;
    uint32_t bits;
    if (row < 0 || row > 2 * SHEET_MOST || column <= -WIDE || column > 2 * SHEET_MOST)
        return vi_splat(0);
    memcpy(&bits, &kept->rows[kept->rows_of[i] + row], sizeof bits);
    return -(vi)((column < 0 ? bits << -column : bits >> column) >> (vu)vi_numbers() & 1);
}
