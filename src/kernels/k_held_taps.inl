/* Scattered taps of the exact method where a map keeps planes: some of each fragment are held until
 * the sheets that fragments stand on are found, which are followed through squares around their own
 * texels that hold all taps. */

/* So many of each fragment. */
#define HELD_TAPS 64

typedef struct held_taps {
    int count;
    int32_t side[SHB_BATCH];             /* of the square: texels on each side of the own one */
    uint64_t shadowed[SHB_BATCH];        /* taps, a bit each */
    int8_t column[HELD_TAPS][SHB_BATCH]; /* of taps, from the own texel on */
    int8_t row[HELD_TAPS][SHB_BATCH];
} held_taps;

#define ROW_BITS 16
#include "k_held_rows.inl"
#undef ROW_BITS
#define ROW_BITS 64
#include "k_held_rows.inl"
#undef ROW_BITS

static void drop_taps(held_taps *held) {
    held->count = 0;
    memset(held->shadowed, 0, sizeof held->shadowed);
}

static void hold_tap(const int32_t *column, const int32_t *row, const int32_t *shadowed,
                     size_t lanes, held_taps *held) {
    const int k = held->count++;
    for (size_t i = 0; i < lanes; i++) {
        held->column[k][i] = (int8_t)column[i];
        held->row[k][i] = (int8_t)row[i];
        held->shadowed[i] |= (uint64_t)shadowed[i] << k;
    }
}

/* Those with shadowed taps, in squares that are not too large for sheets, whose own texel is none
 * of these. */
static size_t list_held(mutual_batch *mutual, size_t lanes, const held_taps *held,
                        uint16_t *fragments, own_texel *own) {
    const shb_receivers *r = &mutual->receivers;
    const shb_map_info *info = &mutual->map->info;
    const float far_depth = shb_far_depth(info->view.reversed);
    float depths[SHB_BATCH];
    size_t found = 0;
    fetch(mutual->map, lanes, r->texel_x, r->texel_y, depths);
    for (size_t i = 0; i < lanes; i += WIDE) {
        const vi x = vi_load(r->texel_x + i), y = vi_load(r->texel_y + i);
        const vf stored = vf_load(depths + i);
        int32_t shadowed[WIDE];
        for (size_t lane = 0; lane < WIDE; lane++)
            shadowed[lane] = held->shadowed[i + lane] != 0;
        vi open = (vi_load(shadowed) != 0) & (vi_load(held->side + i) <= BOX_MAX / 2) &
                  (stored < far_depth) & ((vu)x < info->width) & ((vu)y < info->height);
        if (!vi_any(open))
            continue;
        const vu slopes = gather_occluders(mutual->map, x & open, y & open);
        open &= ~shadowed_taps(mutual, i, open & (stored < vf_load(r->ref + i)), vf_splat(0),
                               vf_splat(0), stored);
        for (size_t lane = 0; lane < WIDE; lane++) {
            fragments[found] = (uint16_t)(i + lane);
            own[found] = (own_texel){stored[lane], slopes[lane]};
            found += open[lane] & 1;
        }
    }
    return found;
}

/* Taps on the sheets of their fragments are shadowed no more. */
static void light_held(mutual_batch *mutual, size_t lanes, held_taps *held) {
    uint16_t fragments[SHB_BATCH + 1], listed[SHB_BATCH];
    own_texel own[SHB_BATCH + 1];
    size_t count = list_held(mutual, lanes, held, fragments, own);
    for (size_t k = 0; k < count; k++)
        listed[k] = (uint16_t)k;
    count = keep_standing(mutual, fragments, own, listed, count);
    for (size_t k = 0; k < count; k++)
        listed[k] = fragments[listed[k]];
    for (size_t first = 0, end; first < count; first = end) {
        const int side = held->side[listed[first]];
        for (end = first + 1; end < count && held->side[listed[end]] == side;)
            end++;
        if (2 * side < 16)
            light_squares16(mutual, listed + first, end - first, side, held);
        else
            light_squares64(mutual, listed + first, end - first, side, held);
    }
}
