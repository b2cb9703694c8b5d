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

/* The sheets of WIDE fragments are followed through so many texels on each side of their own ones.
 */
#define LANE_SHEET_MOST 15

typedef struct lane_sheets {
    int32_t half;                                 /* so many are kept */
    float rows[(2 * LANE_SHEET_MOST + 1) * WIDE]; /* bits of a row of each, for vf_gather */
} lane_sheets;

#define ROW_BITS 16
#include "k_lane_sheets.inl"
#undef ROW_BITS
#define ROW_BITS 32
#include "k_lane_sheets.inl"
#undef ROW_BITS

/* Of WIDE fragments from first on those that are wanted, through squares with these sides, not more
 * than LANE_SHEET_MOST; false: they stand on none. */
static NEVER_INLINE bool find_lane_sheets(mutual_batch *mutual, size_t first, vi wanted, vi sides,
                                          lane_sheets *sheets) {
    uint16_t fragments[WIDE + 1];
    int32_t lane_sides[WIDE], listed[WIDE];
    own_texel own[WIDE + 1];
    const size_t count = keep_on_own(mutual, own, fragments,
                                     list_lit_by_own(mutual, first, wanted, fragments, own, 0));
    vi_store(lane_sides, sides);
    sheets->half = 0;
    for (size_t k = 0; k < count; k++) {
        listed[k] = lane_sides[fragments[k] - first];
        sheets->half = listed[k] > sheets->half ? listed[k] : sheets->half;
    }
    memset(sheets->rows, 0, (size_t)(2 * sheets->half + 1) * WIDE * sizeof *sheets->rows);
    if (row_bits_of(2 * sheets->half + 1) == 16)
        keep_sheets16(mutual, first, fragments, count, listed, sheets);
    else
        keep_sheets32(mutual, first, fragments, count, listed, sheets);
    return count > 0;
}

/* Whether texels, one of each fragment, m columns to the right and n rows below the own ones, lie
 * on the sheets. */
static inline ALWAYS_INLINE vi on_sheets(const lane_sheets *sheets, vf m, vf n) {
    const vi column = __builtin_convertvector(m, vi) + sheets->half;
    const vi row = __builtin_convertvector(n, vi) + sheets->half;
    const uint32_t size = 2 * (uint32_t)sheets->half + 1;
    const vi inside = ((vu)column < size) & ((vu)row < size);
    const vu bits = (vu)vf_gather(sheets->rows, (row & inside) * WIDE + vi_numbers());
    return inside & -(vi)(bits >> (vu)(column & inside) & 1);
}

/* The same for WIDE texels in a row of one fragment, from m columns to the right on. */
static vi on_sheet(const lane_sheets *sheets, int lane, int32_t m, int32_t n) {
    const int32_t column = m + sheets->half, row = n + sheets->half;
    uint32_t bits;
    if (row < 0 || row > 2 * sheets->half || column <= -WIDE || column > 2 * sheets->half)
        return vi_splat(0);
    memcpy(&bits, &sheets->rows[row * WIDE + lane], sizeof bits);
    return -(vi)((column < 0 ? bits << -column : bits >> column) >> (vu)vi_numbers() & 1);
}
