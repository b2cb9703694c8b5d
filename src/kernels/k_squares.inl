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
