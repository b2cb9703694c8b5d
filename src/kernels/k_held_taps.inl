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
#define ROW_BITS 32
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

/* Those with shadowed taps, in squares that are not too large for sheets. */
static size_t list_held(mutual_batch *mutual, size_t lanes, const held_taps *held,
                        uint16_t *fragments) {
    own_texel own[SHB_BATCH + 1];
    size_t found = 0;
    for (size_t i = 0; i < lanes; i += WIDE) {
        int32_t shadowed[WIDE];
        for (size_t lane = 0; lane < WIDE; lane++)
            shadowed[lane] = held->shadowed[i + lane] != 0;
        const vi open = (vi_load(shadowed) != 0) & (vi_load(held->side + i) <= SHB_BOX_MAX / 2);
        found = list_lit_by_own(mutual, i, open, fragments, own, found);
    }
    return keep_on_own(mutual, own, fragments, found);
}

/* Taps on the sheets of their fragments are shadowed no more. */
static void light_held(mutual_batch *mutual, size_t lanes, held_taps *held) {
    uint16_t fragments[SHB_BATCH + 1];
    int32_t sides[SHB_BATCH];
    const size_t count = list_held(mutual, lanes, held, fragments);
    for (size_t k = 0; k < count; k++)
        sides[k] = held->side[fragments[k]];
    for (size_t first = 0, end; first < count; first = end) {
        const int bits = row_bits_of(2 * sides[first] + 1);
        int32_t half = sides[first];
        for (end = first + 1; end < count && row_bits_of(2 * sides[end] + 1) == bits; end++)
            half = sides[end] > half ? sides[end] : half;
        if (bits == 16)
            light_squares16(mutual, fragments + first, sides + first, end - first, half, held);
        else if (bits == 32)
            light_squares32(mutual, fragments + first, sides + first, end - first, half, held);
        else
            light_squares64(mutual, fragments + first, sides + first, end - first, half, held);
    }
}
